/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Checks of the simulation before a run: unsupported settings, and other fixes and styles that read
   or change data of bodies.  No check is made during a step. */

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
class Ownership;
class Sites;
struct Arguments;
struct Fleet;

/// Ends the run on all ranks with a reason: a time step of zero, r-RESPA with different steps,
/// atoms of an unsupported kind, or atoms that another fix moves too.  Warns of granular walls that
/// do not use the masses of the bodies.
void refuse_scene(LAMMPS *lmp, const Fix *fix, const Fleet &fleet, const Ownership &ownership);

/// Rank 0 warns if molecules have atoms in bodies and others that no fix moves.  The message gives
/// their number, an example, and a remedy.  Before a run, when all fixes are defined.  Collective.
void warn_of_partial_molecules(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                               const Fleet &fleet, const Ownership &ownership);

/// Rank 0 warns if molecule IDs have changed since the bodies were made from them.  Returns true
/// then.  Collective.
bool warn_of_molecule_ids(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                          const Ownership &ownership);

/// Rank 0 warns if neigh_modify exclude leaves out pairs of a body with its own periodic images,
/// which turn it.  Ghost atoms exist.  Collective.
void warn_of_excluded_images(LAMMPS *lmp, const Fix *fix, const Bodies &bodies,
                             Ownership &ownership, const Sites &sites);

/// The name of a style that reads velocities between prediction and correction, or empty.  owner:
/// the calling fix.
std::string reader_of_predicted_velocities(LAMMPS *lmp, const Fix *owner);

/// True if there may be forces: styles other than "zero", or fixes called around the forces.
bool makes_forces(LAMMPS *lmp, const Fix *owner);

/// The intervals in steps at which other fixes may read data at the end of a step; each number
/// once.
std::vector<int> readers_at_end(LAMMPS *lmp, const Fix *owner);

}    // namespace LAMMPS_NS::GearQuat

#endif
