/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The report on the features of this simulation: which are on, which are off and why, and which
   costs due to the surroundings of the bodies are avoidable. */

#ifndef LMP_GEAR_QUAT_REPORT_H
#define LMP_GEAR_QUAT_REPORT_H

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

/// The papers to cite, for the fix and for each feature in use.
void add_citations(LAMMPS *lmp, const Arguments &args);

/// Writes the report to screen and log on rank 0, if args.report requests it, and the warning of
/// advice_on_surroundings() in any case.  Collective; to be called in setup(), when neighbor lists
/// are built and bodies have their ghosts.
void report_scene(LAMMPS *lmp, const Fix *fix, const Arguments &args, const Fleet &fleet,
                  const Bodies &bodies, Ownership &ownership, const Sites &sites);

/// A part of the report: pairs of atoms that nothing moves, pairs within a body, and atoms of the
/// fix group that no body uses, found in the neighbor lists of the pair styles.  Each item is one
/// sentence, followed by a line for the input script as a remedy; the function changes nothing.
/// Rank 0 warns if the pair style acts between atoms of a body.  Collective.
std::vector<std::string> advice_on_surroundings(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                                                const Fleet &fleet, const Bodies &bodies,
                                                Ownership &ownership);

}    // namespace LAMMPS_NS::GearQuat

#endif
