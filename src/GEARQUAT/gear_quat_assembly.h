/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Assembly: from sites with positions and velocities to rigid bodies.

   All sites of a body meet on one rank, which the body's ID names.  It sorts them by atom ID and
   computes owner, mass properties, pose and velocities.  Sums therefore run in the same order on
   any number of ranks, and nothing is communicated between all bodies. */

#ifndef LMP_GEAR_QUAT_ASSEMBLY_H
#define LMP_GEAR_QUAT_ASSEMBLY_H

#include "gear_quat_infile.h"
#include "gear_quat_integrator.h"
#include "gear_quat_rigid_body.h"
#include "pointers.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// The properties of a body, which travel with its owner atom.
struct Body {
  RigidBody rigid;
  tagint id;        ///< the user's: molecule ID, group number or custom value
  tagint natoms;    ///< sites
  double extent;    ///< largest distance of a site from the owner atom
  int from_file;    ///< mass and inertia were given, not summed
  int fresh;        ///< has come in this step: no history yet
  int large;        ///< on several ranks: not all of its sites can see their owner atom
  Mask off;         ///< components of the load that do not act

  /// The way of the outermost part of the body, a site or a part of a solid, per radian.
  double reach() const
  {
    const double *i = rigid.inertia;
    return std::max(extent, std::sqrt(std::max({i[0], i[1], i[2]}) / rigid.mass));
  }
  /// The error of a step as a length.
  double length(const Correction &error) const
  {
    return std::max(error.position_error(), reach() * error.angle_error());
  }
};

class Assembly : protected Pointers {
 public:
  struct Site {
    int rank, local;    ///< where the site came from
    tagint id, tag;     ///< body and atom
    double mass;
    double x[3], v[3];                                     ///< unwrapped
    double own_inertia_space[9], own_momentum_space[3];    ///< of the site about its own center
  };
  struct PlacedSite {
    int local;
    tagint owner;           ///< atom ID of the body's owner
    double site_body[3];    ///< from the center of mass, principal frame
    double q_body[4];       ///< orientation of the body
  };
  struct OwnedBody {
    int local;    ///< index of the owner atom
    Body body;
    BodyState state;
  };

  Assembly(LAMMPS *lmp, const GivenBodies &given) : Pointers(lmp), given(given) {}

  /// Makes the bodies, each on one rank, and returns where the sites of this rank are in them.
  /// Massless bodies, and bodies in the infile that no atom belongs to, end the run on all ranks.
  /// Collective.
  std::vector<PlacedSite> place_sites(const std::vector<Site> &mine);
  /// The bodies whose owner atoms are on this rank.  Collective.
  std::vector<OwnedBody> owned_bodies();

 private:
  const GivenBodies &given;
  enum { MASSLESS, NOT_FINITE, NEGATIVE, UNBALANCED, APART, FAULTS };
  tagint faulty[FAULTS] = {};    ///< a body met on this rank with each fault, 0 for none
  tagint in_clumps = 0;          ///< one whose sites are half a period apart, 0 for none
  std::vector<tagint> found;     ///< given bodies met on this rank

  OwnedBody make_body(const Site *sites, int n, double axes[9], int &owner);

  struct Momenta {
    double inertia_space[9];
    double angular_momentum_space[3];
  };
  void find_arm(const Site &site, const double *center, double arm[3]) const;
  Momenta average(const Site *sites, int n, OwnedBody &owned) const;
  Momenta take_given(const GivenBody &given_body, OwnedBody &owned) const;
  void find_frame(const Momenta &momenta, const Site *sites, int n, double axes[9],
                  OwnedBody &owned);
  void orient_axes(const Site *sites, int n, const double *center, double axes[9]) const;
  void check_place(const Site *sites, int n, const OwnedBody &owned);
  void check_moments(const OwnedBody &owned);
  void report_faults();
  void warn_of_clumps() const;

  std::vector<OwnedBody> made;     ///< on this rank, whoever owns them
  std::vector<int> owner_ranks;    ///< of these

  void place(const Site *sites, int n, PlacedSite *replies);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
