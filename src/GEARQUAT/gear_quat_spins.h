/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies that turn faster than the method can follow, found before the first step: mostly nearly
   linear ones, whose smallest moment of inertia makes them spin about their axis. */

#ifndef LMP_GEAR_QUAT_SPINS_H
#define LMP_GEAR_QUAT_SPINS_H

#include "gear_quat_integrator.h"

#include <string>

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Bodies;

/// Ends the run on all ranks if a body turns faster than can be followed at a step h.  Rank 0 warns of
/// a nearly linear one that will, once it has its share of the kinetic energy.  Collective.
void check_spins(LAMMPS *lmp, const Bodies &bodies, const Scheme &scheme, double h);

/// What to do about a body that is lost while it turns so, if it is nearly linear and turns about
/// its axis; else empty.
std::string advice_on_spin(const RigidBody &body, const double *omega_body);

}    // namespace LAMMPS_NS::GearQuat

#endif
