/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What users see of all bodies together: the fix's scalar and vector.  All calls are collective. */

#ifndef LMP_GEAR_QUAT_SUMS_H
#define LMP_GEAR_QUAT_SUMS_H

#include "gear_quat_bodies.h"

namespace LAMMPS_NS::GearQuat {

class Sums : protected Pointers {
 public:
  /// Elements of the vector, as the manual lists them.
  enum {
    KE_TRANSLATION,
    KE_ROTATION,
    NORM,
    RADIAL,
    MAX_POSITION,
    RMS_POSITION,
    MAX_ANGLE,
    RMS_ANGLE,
    ELEMENTS
  };

  Sums(LAMMPS *lmp, const Bodies &bodies) : Pointers(lmp), bodies(bodies) {}

  /// Energy that takes thermo's potential energy from the predicted to the corrected pose; zero if
  /// it is less than rounding of the centers alone can make of the loads.
  double energy_correction() const;
  /// An element; integrator: null as long as there are no histories.
  double element(int n, const Integrator *integrator) const;

 private:
  const Bodies &bodies;

  double of_body(int n, int ibody, const Integrator *integrator) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
