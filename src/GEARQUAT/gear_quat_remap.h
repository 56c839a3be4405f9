/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies in a box that has changed between two runs.

   change_box remap takes every atom to the same place of the new box, relative to its faces, and so
   stretches bodies. */

#ifndef LMP_GEAR_QUAT_REMAP_H
#define LMP_GEAR_QUAT_REMAP_H

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Bodies;
class Ownership;

/// Before a run, and before atoms are exchanged: where change_box has remapped the atoms of bodies
/// from ownership.box() to the present box, these get back their shapes and orientations, and their
/// centers are remapped.  True, with a warning, if there are any; warns of bodies that another box
/// has deformed otherwise.  Needs no ghosts.  Collective.
bool remap_bodies(LAMMPS *lmp, Bodies &bodies, const Ownership &ownership);

}    // namespace LAMMPS_NS::GearQuat

#endif
