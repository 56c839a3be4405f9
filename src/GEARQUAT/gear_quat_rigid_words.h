/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Words of LAMMPS' rigid fixes that fix gear/quat does not have, and what to write instead. */

#ifndef LMP_GEAR_QUAT_RIGID_WORDS_H
#define LMP_GEAR_QUAT_RIGID_WORDS_H

#include <string>

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// What to write instead of a keyword of fix rigid and its kin; empty for any other word.
std::string instead_of_rigid_keyword(const std::string &keyword);

/// The words of fix_modify that the rigid fixes have: returns how many were used, and ends the run
/// on all ranks where this fix cannot do what they ask for.
int modify_like_rigid(LAMMPS *lmp, int narg, char **arg);

}    // namespace LAMMPS_NS::GearQuat

#endif
