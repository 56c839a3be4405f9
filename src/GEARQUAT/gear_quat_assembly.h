/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Assembly: from sites with positions and velocities to rigid bodies.

   Owner, mass properties, pose and velocities of a body follow from sums, extremes and counts over
   its sites.  Every rank sums over the sites that it owns, and a few numbers per body and rank are
   sent (gear_quat_ranks.h), so that memory and messages do not grow with the sites of a body.  The
   sums do not depend on the order of the sites (gear_quat_exact_sum.h), so bodies are the same, to
   the last bit, on any number of ranks.

   Bodies stated in a file, in the format of fix rigid's infile keyword:
     N
     ID mass x y z ixx iyy izz ixy ixz iyz vx vy vz lx ly lz ix iy iz      (N lines)
   The inertia tensor and the angular momentum are in the space frame, the center of mass is in the
   box and ix iy iz are its image flags.  Lines may end in a # comment; empty lines are ignored.

   Insertion of bodies: molecules of a template, inserted by another fix (deposit, pour).  The body
   is made from its atoms, as at the start, unless the template gives a mass, a center or an inertia
   tensor. */

#ifndef LMP_GEAR_QUAT_ASSEMBLY_H
#define LMP_GEAR_QUAT_ASSEMBLY_H

#include "gear_quat_bodies.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
class Molecule;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Extended;

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

/// The properties of the molecules of a template that gives some, by their numbers; none for an empty
/// ID.  In a plugin for a LAMMPS without the header, rank 0 reports that they cannot be read.
std::map<int, StatedMolecule> read_stated(LAMMPS *lmp, const std::string &template_id);

/// A molecule that is inserted with its geometric center at a position, with a velocity, and rotated
/// by a quaternion with the scalar part first.
GivenBody given_at(const StatedMolecule &stated, const double *center, const double *velocity,
                   const double *wxyz);

/* ---------------------------------------------------------------------- */

/// A body with sites on this rank.
struct AssembledBody {
  tagint owner;             ///< atom ID of the owner atom
  int owner_rank, local;    ///< where the owner atom is, and its index there
  Body body;
  BodyState state;
  double axes[9];    ///< principal, rotation matrix space -> body
};

/// Of a body, an atom in it, and its place: from the center of mass, along the principal axes.
using OfSite = std::function<void(const AssembledBody &body, int atom, const double *arm_body)>;

/// Creates the bodies.  ids: of every owned atom, 0 for none.  extended: null if all atoms are
/// points.  Massless bodies, and bodies in the infile that no atom belongs to, end the run on all
/// ranks.  Rank 0 warns of a body in two parts, which wrong image flags may have made.  Collective.
/// Returns the bodies with sites on this rank, and calls act for all of these sites.
std::vector<AssembledBody> assemble(LAMMPS *lmp, const GivenBodies &given, const Extended *extended,
                                    const std::vector<tagint> &ids, const OfSite &act);

}    // namespace LAMMPS_NS::GearQuat

#endif
