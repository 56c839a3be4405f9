/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Assembly: from sites with positions and velocities to rigid bodies.

   Owner, mass properties, pose and velocities of a body follow from sums, extremes and counts over
   its sites.  Every rank sums over the sites that it owns, and a few numbers per body and rank are
   sent (gear_quat_ranks.h), so that memory and messages do not grow with the sites of a body.  The
   sums do not depend on the order of the sites (gear_quat_exact_sum.h), so bodies are the same, to
   the last bit, on any number of ranks. */

#ifndef LMP_GEAR_QUAT_ASSEMBLY_H
#define LMP_GEAR_QUAT_ASSEMBLY_H

#include "gear_quat_bodies.h"
#include "gear_quat_given_bodies.h"

#include <functional>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Extended;

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
