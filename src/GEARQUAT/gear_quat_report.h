/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Before a run: what is refused, and the report about the simulation: what is on, what is off and why, and which pairs of atoms cost time
   and move nothing.  All are collective. */

#ifndef LMP_GEAR_QUAT_REPORT_H
#define LMP_GEAR_QUAT_REPORT_H

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

/// Ends the run on all ranks with a reason: a time step of zero, r-RESPA with different steps, or
/// atoms that another fix moves too.
void refuse_scene(LAMMPS *lmp, const Fix *fix, const Fleet &fleet, const Ownership &ownership);

/// Writes the report to screen and log on rank 0, if args.report requests it, and in any case warns
/// of a pair style that acts between atoms of a body; to be called in setup(), when neighbor lists
/// are built and bodies have their ghosts.
void report_scene(LAMMPS *lmp, const Fix *fix, const Arguments &args, const Fleet &fleet,
                  const Bodies &bodies, Ownership &ownership, const Sites &sites);

}    // namespace LAMMPS_NS::GearQuat

#endif
