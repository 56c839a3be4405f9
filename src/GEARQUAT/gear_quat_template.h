/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies that come while the fix exists: molecules of a template, inserted by another fix (deposit,
   pour).  The body is made from its atoms, as at the start, unless the template states a mass, a
   center or a tensor of inertia that are not those of its atoms. */

#ifndef LMP_GEAR_QUAT_TEMPLATE_H
#define LMP_GEAR_QUAT_TEMPLATE_H

#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
class Molecule;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Ownership;

/// What a molecule of a template states of itself, in the frame of the template.
struct StatedMolecule {
  bool differs;    ///< from what its atoms add up to; if not, the atoms are what counts
  double mass;
  double center[3];    ///< of mass, from the geometric center
  double inertia[9];
};

/// Where an inserted molecule is: geometric center, velocity, rotation (scalar part first).
struct Insertion {
  const double *center, *velocity, *quat;
};

/// The molecules of a template as LAMMPS' inserting fixes compare them; null for an empty ID.  A
/// template that does not exist ends the run.
Molecule **find_template(LAMMPS *lmp, const std::string &template_id);

/// What the molecules of a template state, one entry each; none for an empty ID.  Ends the run,
/// naming the template, if no body can be so.  Rank 0 tells of what differs from the atoms, or, in
/// a plugin for a LAMMPS without the header, that it cannot be read.
std::vector<StatedMolecule> read_stated(LAMMPS *lmp, const std::string &template_id);

/// True if one of them is not what its atoms add up to.
inline bool any_differs(const std::vector<StatedMolecule> &stated)
{
  for (const auto &molecule : stated)
    if (molecule.differs) return true;
  return false;
}

/// One body of the atoms that were just created on all ranks, from index `first` on; its ID is the
/// smallest molecule ID of its atoms.  It is fresh: its history begins with the forces of this
/// step.  Collective.
void add_molecule(LAMMPS *lmp, Ownership &ownership, int first, const StatedMolecule *stated,
                  const Insertion &insertion);

}    // namespace LAMMPS_NS::GearQuat

#endif
