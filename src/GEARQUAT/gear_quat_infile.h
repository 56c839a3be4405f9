/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies stated in a file, in the format of fix rigid's infile keyword:
     N
     ID mass x y z ixx iyy izz ixy ixz iyz vx vy vz lx ly lz ix iy iz      (N lines)
   The inertia tensor and the angular momentum are in the space frame, the center of mass is in the
   box and ix iy iz are its image flags.  Lines may end in a # comment; empty lines are ignored. */

#ifndef LMP_GEAR_QUAT_INFILE_H
#define LMP_GEAR_QUAT_INFILE_H

#include "lmptype.h"

#include <map>
#include <string>

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// A body as a line of the file has it.
struct GivenBody {
  double mass;
  double center[3];     ///< wrapped, as in the file
  double inertia[6];    ///< ixx iyy izz ixy ixz iyz, space frame
  double velocity[3];
  double angular_momentum_space[3];
  int image[3];

  static constexpr int NUMBERS = 16;    ///< before the image flags, in the order of the file
};

using GivenBodies = std::map<tagint, GivenBody>;

/// Reads on rank 0, returns on all ranks; none for an empty filename.  Any error in the file ends
/// the run on all ranks with a message that gives the file and line.
GivenBodies read_given_bodies(LAMMPS *lmp, const std::string &filename);

}    // namespace LAMMPS_NS::GearQuat

#endif
