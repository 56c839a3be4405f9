/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The look at the scene before a run: what the fix refuses, and which other fixes and styles read
   or move what bodies have.  Nothing of it is done in a step. */

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

class Ownership;
struct Arguments;
struct Fleet;

/// Ends the run on all ranks, naming what is in the way: a time step of zero, r-RESPA with
/// different steps, atoms of a kind that cannot be followed, atoms that another fix moves too.
/// Warns of granular walls that do not know the masses of the bodies.
void refuse_scene(LAMMPS *lmp, const Fix *fix, const Fleet &fleet, const Ownership &ownership);

/// Rank 0 warns if molecules have atoms in bodies and others that no fix moves: it says how many,
/// names one, and says what to change.  Before a run, when all fixes are defined.  Collective.
void warn_of_partial_molecules(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                               const Fleet &fleet, const Ownership &ownership);

/// Who reads velocities between prediction and correction, empty for nobody.  owner: the fix that
/// asks.
std::string reader_of_predicted_velocities(LAMMPS *lmp, const Fix *owner);

/// Whether anything may make a force: styles other than "zero", fixes that act around the forces.
bool makes_forces(LAMMPS *lmp, const Fix *owner);

/// Every how many steps other fixes may read something at the end of a step; each number once.
struct Readers {
  std::vector<int> of_atoms;
  std::vector<int> of_local_data;    ///< of the fix that asks; a part of the above
};
Readers readers_at_end(LAMMPS *lmp, const Fix *owner);

}    // namespace LAMMPS_NS::GearQuat

#endif
