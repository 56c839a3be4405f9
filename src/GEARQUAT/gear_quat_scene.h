/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The look at the scene: what bodies there are, and what in the scene calls for which effect.
   Taken once, before a run; nothing of it is done in a step. */

#ifndef LMP_GEAR_QUAT_SCENE_H
#define LMP_GEAR_QUAT_SCENE_H

#include "lmptype.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Fix;
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Bodies;

/// Who reads velocities between prediction and correction, empty for nobody.  owner: the fix that asks.
std::string reader_of_predicted_velocities(LAMMPS *lmp, const Fix *owner);

/// Whether anything may make a force: styles other than "zero", fixes that act around the forces.
bool makes_forces(LAMMPS *lmp, const Fix *owner);

/// Every how many steps other fixes may read something at the end of a step; each number once.
struct Readers {
  std::vector<int> of_atoms;
  std::vector<int> of_local_data;    ///< of the fix that asks; a part of the above
};
Readers readers_at_end(LAMMPS *lmp, const Fix *owner);

/// True if one of the periods ends with this step.
bool is_due(const std::vector<int> &periods, bigint step);

/// The same on all ranks.
struct Scene {
  /// Bodies by their principal moments; two are equal that differ by less than 1e-7 of the largest.
  enum Top { POINT, LINEAR, SPHERICAL, SYMMETRIC, ASYMMETRIC, PLANAR, TOPS };

  bigint bodies = 0, sites = 0;
  bigint freedoms = 0;                        ///< of all bodies, translation and rotation
  bigint tops[TOPS] = {};                     ///< bodies of each kind
  bigint fewest_sites = 0, most_sites = 0;    ///< of a body
  bigint arms = 0;                            ///< sites away from the center of mass
  bigint extended = 0;                        ///< sites that are more than points
  bigint ghosts = 0;                          ///< sites whose body another rank owns
  bigint large = 0;                           ///< bodies that every rank has
  double farthest = 0.0;                      ///< largest coordinate of a center of mass, unwrapped

  /// Collective; bodies: after their ghosts were updated.
  Scene(LAMMPS *lmp, const Bodies &bodies);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
