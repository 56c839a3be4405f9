/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What the fix refuses to run in, looked at before every run. */

#ifndef LMP_GEAR_QUAT_CHECKS_H
#define LMP_GEAR_QUAT_CHECKS_H

namespace LAMMPS_NS {
class Fix;
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Bodies;

/// Ends the run on all ranks, naming what is in the way: minimization, a time step of zero, a box
/// that changes, r-RESPA with different steps, atoms of a kind that cannot be followed, atoms
/// that another fix moves too.  Warns of granular walls that do not know the masses of the bodies.
void refuse_scene(LAMMPS *lmp, const Fix *fix, const Bodies &bodies);

}    // namespace LAMMPS_NS::GearQuat

#endif
