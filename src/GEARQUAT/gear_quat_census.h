/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Census: the sites of every body meet on one rank (a rendezvous keyed by the owner's atom ID) and
   are counted.  Needs no ghost atoms, so it can be taken at any time; once per run, not per step. */

#ifndef LMP_GEAR_QUAT_CENSUS_H
#define LMP_GEAR_QUAT_CENSUS_H

#include "lmptype.h"

#include <vector>

namespace LAMMPS_NS {
class Domain;
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// One atom of a body.
struct SiteCount {
  tagint owner, id;    ///< atom ID of the body's owner, the user's ID of the body
  tagint natoms;       ///< of the body, 0 unless this atom is its owner
  int freedoms;        ///< of the body, translation and rotation; 0 unless this atom is its owner
  int own_freedoms;    ///< rotational ones of the atom itself
  int in_group;        ///< 1 if the atom is in the group that is asked about
  double mass;
  double body_mass;    ///< 0 unless this atom is the owner and masses have to add up to it

  // zero unless places and masses are compared with those that the body has

  double body_moments[3];    ///< principal moments; of the owner
  double first[3];           ///< mass times the arm, body frame
  double second[6];          ///< what it adds to xx, yy, zz, xy, xz, yz of the inertia, body frame
  double found[3], expected[3];    ///< unwrapped positions: of the atom, and where the body has it
};

/// The same on all ranks.
struct Census {
  bigint removed_freedoms = 0;    ///< that rigidity takes from bodies wholly in the group
  tagint broken = 0;           ///< a body that has lost atoms, or that several IDs name; 0 for none
  tagint left = 0, had = 0;    ///< its atoms now and before
  int mass_changed =
      0;    ///< 1 if mass, center or inertia of a body are not those of its atoms any more
  tagint torn =
      0;             ///< a body whose atoms are whole periods further apart than before, 0 for none
  tagint cut = 0;    ///< one that another box has torn at the faces of the box, 0 for none

  /// Collective; sites: those of this rank's atoms.  box: shape of the box before, as Domain::h, null
  /// if it is not known or not asked for.
  Census(LAMMPS *lmp, std::vector<SiteCount> &sites, const double *box = nullptr);

 private:
  const Domain *domain;
  const double *box_before;

  static int count_sites(int n, char *in, int &flag, int *&ranks, char *&out, void *census);
  void count_body(const SiteCount *sites, int n);
  bool same_masses(const SiteCount *sites, int n, const SiteCount &owner) const;
  void look_for_tears(const SiteCount *sites, int n, const SiteCount &owner);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
