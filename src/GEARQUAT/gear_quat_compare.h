/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The atoms of all bodies compared with what the bodies know of them: their number, masses and
   places.  Once per run, not per step. */

#ifndef LMP_GEAR_QUAT_COMPARE_H
#define LMP_GEAR_QUAT_COMPARE_H

#include "lmptype.h"

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Bodies;
class Ownership;
class Sites;

/// What a comparison has found, the same on all ranks; bodies are named by their IDs, 0 for none.
struct Comparison {
  bigint removed_freedoms = 0;    ///< that rigidity takes from bodies wholly in the group
  tagint broken = 0;              ///< a body that has lost atoms, or that several IDs name
  bigint left = 0, had = 0;       ///< its atoms now and before
  tagint mass_changed = 0;        ///< one whose atoms have another mass, center or inertia
  tagint torn = 0;                ///< one whose atoms are whole periods further apart than before
  tagint cut = 0;                 ///< one that another box has torn at the faces of the box
};

/// Numbers and masses alone.  Needs no ghost atoms, so it can be called at any time.  groupbit: the
/// group that degrees of freedom are asked for, 0 for none.  Collective.
Comparison count_atoms(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership,
                       int groupbit = 0);

/// True if masses, positions and velocities of all atoms are those of their bodies.  Ends the run
/// if image flags or another box have torn a body.  Sites are listed, and ownership.box() is the
/// box before.  Collective.
bool atoms_match(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership, const Sites &sites);

}    // namespace LAMMPS_NS::GearQuat

#endif
