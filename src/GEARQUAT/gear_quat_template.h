/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Insertion of bodies: molecules of a template, inserted by another fix (deposit, pour).  The body
   is made from its atoms, as at the start, unless the template gives a mass, a center or an inertia
   tensor that differ from the sums over its atoms. */

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

/// Properties given in a molecule template, in the frame of the template.
struct StatedMolecule {
  bool differs;    ///< from the sums over its atoms; if false, these sums are used
  double mass;
  double center[3];    ///< of mass, from the geometric center
  double inertia[9];
};

/// Position of an inserted molecule: geometric center, velocity, rotation (scalar part first).
struct Insertion {
  const double *center, *velocity, *quat;
};

/// The molecules of a template, for comparison in LAMMPS' inserting fixes; null for an empty ID.  A
/// template that does not exist ends the run.
Molecule **find_template(LAMMPS *lmp, const std::string &template_id);

/// The properties given in a template, one entry for each molecule; none for an empty ID.  Ends the
/// run with the name of the template if a body cannot have these properties.  Rank 0 reports
/// differences from the atoms, or, in a plugin for a LAMMPS without the header, that they cannot be
/// read.
std::vector<StatedMolecule> read_stated(LAMMPS *lmp, const std::string &template_id);

/// True if one of them differs from the sums over its atoms.
inline bool any_differs(const std::vector<StatedMolecule> &stated)
{
  for (const auto &molecule : stated)
    if (molecule.differs) return true;
  return false;
}

/// Makes one body of the atoms that were just created on all ranks, from index `first` on; its ID
/// is the smallest molecule ID of its atoms.  It is fresh: its history starts with the forces of
/// this step.  Collective.
void add_molecule(LAMMPS *lmp, Ownership &ownership, int first, const StatedMolecule *stated,
                  const Insertion &insertion);

}    // namespace LAMMPS_NS::GearQuat

#endif
