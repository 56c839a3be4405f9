/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies that come while the fix exists: molecules of a template, inserted by another fix (deposit,
   pour).  The body is made from its atoms, as at the start, so that nothing of the template itself
   has to be known. */

#ifndef LMP_GEAR_QUAT_TEMPLATE_H
#define LMP_GEAR_QUAT_TEMPLATE_H

#include <string>

namespace LAMMPS_NS {

class GearQuatBodies;
class LAMMPS;
class Molecule;

/// The molecules of a template as LAMMPS' inserting fixes compare them; null for an empty ID.  A
/// template that does not exist ends the run.
Molecule **find_template(LAMMPS *lmp, const std::string &template_id);

/// One body of the atoms that were just created on all ranks, from index `first` on; its ID is the
/// smallest molecule ID of its atoms.  It is fresh: its history begins with the forces of this step.
/// Collective.
void add_molecule(LAMMPS *lmp, GearQuatBodies &bodies, int first);

}    // namespace LAMMPS_NS

#endif
