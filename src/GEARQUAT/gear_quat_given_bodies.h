/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies stated in a file, in the format of fix rigid's infile keyword:
     N
     ID mass x y z ixx iyy izz ixy ixz iyz vx vy vz lx ly lz ix iy iz      (N lines)
   The inertia tensor and the angular momentum are in the space frame, the center of mass is in the
   box and ix iy iz are its image flags.  Lines may end in a # comment; empty lines are ignored.

   Insertion of bodies: molecules of a template, inserted by another fix (deposit, pour).  The body
   is made from its atoms, as at the start, unless the template gives a mass, a center or an inertia
   tensor that differ from the sums over its atoms. */

#ifndef LMP_GEAR_QUAT_GIVEN_BODIES_H
#define LMP_GEAR_QUAT_GIVEN_BODIES_H

#include "lmptype.h"

#include <map>
#include <string>

namespace LAMMPS_NS {
class LAMMPS;
class Molecule;
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

/// Properties given in a molecule template, in the frame of the template.
struct StatedMolecule {
  double mass;
  double center[3];    ///< of mass, from the geometric center
  double inertia[9];
};

/// The molecules of a template, for comparison in LAMMPS' inserting fixes; null for an empty ID.  A
/// template that does not exist ends the run.
Molecule **find_template(LAMMPS *lmp, const std::string &template_id);

/// The properties given in a template, of the molecules for which they differ from the sums over
/// atoms, by their numbers; none for an empty ID.  Rank 0 reports differences from the atoms, or, in
/// a plugin for a LAMMPS without the header, that they cannot be read.
std::map<int, StatedMolecule> read_stated(LAMMPS *lmp, const std::string &template_id);

/// A molecule that is inserted with its geometric center at a position, with a velocity, and rotated
/// by a quaternion with the scalar part first.
GivenBody given_at(const StatedMolecule &stated, const double *center, const double *velocity,
                   const double *wxyz);

}    // namespace LAMMPS_NS::GearQuat

#endif
