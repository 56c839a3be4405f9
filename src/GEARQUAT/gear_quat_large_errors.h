/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Collisions that are too short for the time step.

   In a dilute gas, or with one body at a wall, collisions are rare, so the windows of
   gear_quat_vibrations.h contain none of them.  The error of every step is estimated anyway.  Where
   the error exceeds a tenth of the motion of the body in the step, the history does not follow the
   forces, and the energy changes.  With collisions this happens in few of all steps.  Where it
   happens in many steps, forces are not smooth, or bodies rest and their errors are rounding.

   Step calls begin() for new histories, begin_step() before and note() after the correction of
   every body.  Motion reads the counts at the ends of the windows. */

#ifndef GEAR_QUAT_LARGE_ERRORS_H
#define GEAR_QUAT_LARGE_ERRORS_H

#include "gear_quat_math.h"

#include <cmath>

namespace LAMMPS_NS::GearQuat {

class LargeErrors {
 public:
  /// An error is large if it exceeds this part of the motion in the step.
  static constexpr double LARGE = 0.1;
  /// Large errors in a smaller part of all steps of all bodies hardly change the energy; in a
  /// larger part, their cause is not collisions.
  static constexpr double LEAST = 1.0e-5, MOST = 0.05;

  /// Errors of resting bodies, by their size.
  static constexpr double ROUNDING = 1.0e-10;

  struct Counts {
    double large = 0.0, all = 0.0;    ///< steps of bodies

    bool show_collisions() const { return large > LEAST * all && large <= MOST * all; }
  };

  /// Histories begin; the first steps, in which they settle, are not counted.
  void begin(int values)
  {
    settling = 2 * values;
    counts = Counts();
  }
  /// Forgets the counts.
  void begin_run() { counts = Counts(); }
  /// Some bodies have new histories; the steps in which they settle are not counted.
  void settle(int values) { settling = 2 * values; }

  /// Before the corrections of a step of length h.
  void begin_step(double h)
  {
    if (settling > 0) --settling;
    size = std::fabs(h);
  }

  /// A body has been corrected.  body: as in gear_quat_bodies.h, with mass and inertia, its size,
  /// and the length of an error.  load: acts on it.
  template <class Body>
  void note(const Body &body, const BodyState &state, const Load &load, const Correction &last)
  {
    counts.all += 1.0;
    const double part2 = LARGE * LARGE * size * size;
    if (last.position_error2 <= part2 * dot3(state.velocity, state.velocity) &&
        4.0 * last.quaternion_error2 <= part2 * dot3(state.omega_body, state.omega_body))
      return;
    const double error = body.length(last);
    counts.large += settling == 0 && error > ROUNDING * body.reach() &&
        error > LARGE * motion(body, state, load);
  }

  const Counts &counted() const { return counts; }

 private:
  int settling = 0;    ///< steps
  double size = 0.0;
  Counts counts;

  /// The motion of a body in the step, a length; where it turns back, by its acceleration.
  template <class Body>
  double motion(const Body &body, const BodyState &state, const Load &load) const
  {
    double omegadot_body[3];
    angular_acceleration(body.rigid, state, dot4(state.q, state.q), load, omegadot_body);
    const double reach = body.reach();
    const double speed = length(state.velocity) + reach * length(state.omega_body);
    const double change = length(load.force) / body.rigid.mass + reach * length(omegadot_body);
    return size * (speed + size * change);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
