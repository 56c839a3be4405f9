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

class Bodies;

/// A body as a line of the file has it.
struct GivenBody {
  double mass;
  double center[3];     ///< wrapped, as in the file
  double inertia[6];    ///< ixx iyy izz ixy ixz iyz, space frame
  double velocity[3];
  double angular_momentum_space[3];
  int image[3];
};

using GivenBodies = std::map<tagint, GivenBody>;

/// Read on rank 0, return on all ranks; none for an empty filename.  Any fault of the file ends the
/// run on all ranks with a message that names file and line.
GivenBodies read_given_bodies(LAMMPS *lmp, const std::string &filename);

/// Write all bodies, sorted by ID, with all digits; a file that cannot be written ends the run.
/// A file of this name is whole at any time: it is written under another name and then renamed.
/// rows: those of BodyTable for this rank's owned bodies.  fix_id: for the comment on line 1.
/// Collective.
void write_given_bodies(LAMMPS *lmp, const std::string &filename, const std::string &fix_id,
                        const Bodies &bodies, double **rows);

}    // namespace LAMMPS_NS::GearQuat

#endif
