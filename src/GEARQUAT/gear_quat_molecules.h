/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Molecules that are only partly in bodies.  This is intended if another fix moves the rest, such as
   flexible chains on a rigid core.  If nothing moves it, the group of the fix is probably wrong. */

#ifndef LMP_GEAR_QUAT_MOLECULES_H
#define LMP_GEAR_QUAT_MOLECULES_H

namespace LAMMPS_NS {
class Fix;
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Ownership;
struct Arguments;
struct Fleet;

/// Rank 0 warns if molecules have atoms in bodies and others that no fix moves: it says how many,
/// names one, and says what to change.  Before a run, when all fixes are defined.  Collective.
void warn_of_partial_molecules(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                               const Fleet &fleet, const Ownership &ownership);

}    // namespace LAMMPS_NS::GearQuat

#endif
