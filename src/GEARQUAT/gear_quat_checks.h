/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Checks before a run: what is refused, and probable mistakes, of which rank 0 warns.  All are
   collective. */

#ifndef LMP_GEAR_QUAT_CHECKS_H
#define LMP_GEAR_QUAT_CHECKS_H

namespace LAMMPS_NS {
class Fix;
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Bodies;
class Ownership;
struct Arguments;
struct Fleet;

/// Ends the run on all ranks with a reason: a time step of zero, r-RESPA with different steps,
/// atoms of an unsupported kind, or atoms that another fix moves too.
void refuse_scene(LAMMPS *lmp, const Fix *fix, const Fleet &fleet, const Ownership &ownership);

// when bodies have been made from atoms

/// Warns of bodies whose atoms are in two groups, more than half of a periodic box apart: two plates
/// may be one body, but two halves of a molecule at opposite faces of the box may not.
void warn_of_gaps(LAMMPS *lmp, const Ownership &ownership);
/// Warns of bodies with the same numbers and masses of atoms, and different shapes: molecules that
/// were flexible until then keep the shapes they had.
void warn_of_shapes(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership);

// before the first run, when all fixes are defined

/// Warns of molecules with atoms in bodies and others that no fix moves.
void warn_of_partial_molecules(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                               const Fleet &fleet, const Ownership &ownership);

}    // namespace LAMMPS_NS::GearQuat

#endif
