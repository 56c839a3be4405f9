/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What the fix refuses to run in, looked at before every run. */

#ifndef LMP_GEAR_QUAT_CHECKS_H
#define LMP_GEAR_QUAT_CHECKS_H

namespace LAMMPS_NS {

class FixGearQuat;
class GearQuatBodies;
class LAMMPS;

/// Ends the run on all ranks, naming what is in the way: minimization, a time step of zero, a box
/// that changes, r-RESPA with different steps, atoms of a kind that cannot be followed, atoms
/// that another fix moves too.  Warns of granular walls that do not know the masses of the bodies.
void refuse_scene(LAMMPS *lmp, const FixGearQuat *fix, const GearQuatBodies &bodies);

}    // namespace LAMMPS_NS

#endif
