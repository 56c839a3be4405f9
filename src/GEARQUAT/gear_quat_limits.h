/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What no step can be right about: a body that turns by half a turn in one step (from the poses
   alone nobody can tell which way round), that crosses the whole scene in one, whose quaternion is
   so far from unit length that unprojected sites are a hundred times too far out or in, or whose
   motion is no number.  All are far outside of what is stable, so only runs that are lost end here:
   the quaternion of a free rotation is a harmonic motion with omega/2, half a turn is omega/2 h =
   1.57, and no method here is stable beyond 1.42.

   Which of the slower rotations a method follows at a given step depends on the number of values,
   on the passes and on the moments: a free flight on trial tells, and needs no table. */

#ifndef GEAR_QUAT_LIMITS_H
#define GEAR_QUAT_LIMITS_H

#include "gear_quat_startup.h"

#include <limits>
#include <vector>

namespace LAMMPS_NS::GearQuat {

struct MotionLimits {
  static constexpr double TURN = 3.14159265358979323846;    ///< radians in a step
  static constexpr double NORM2 = 100.0;    ///< |q|^2 is less than this, and more than its inverse

  double speed2 = 0.0, rate2 = 0.0;

  MotionLimits() = default;
  /// h: the time step, not zero.  length: of the scene, infinite for none.
  MotionLimits(double h, double length) :
      speed2((length / h) * (length / h)), rate2((TURN / h) * (TURN / h))
  {
  }

  /// False for velocities beyond the limits, and for any that are no numbers.
  bool keep_velocities(const BodyState &s) const
  {
    return dot3(s.velocity, s.velocity) < speed2 && dot3(s.omega_body, s.omega_body) < rate2;
  }

  /// And for |q|.  Of a corrected state: a predicted q is not meant to have unit length.
  bool keep(const BodyState &s) const
  {
    const double norm2 = dot4(s.q, s.q);
    return keep_velocities(s) && norm2 < NORM2 && norm2 > 1.0 / NORM2;
  }
};

/// The state with the velocities that a load gives it in a step h.
inline BodyState kicked(const RigidBody &body, const BodyState &before, const Load &load, double h)
{
  BodyState s = before;
  double omegadot_body[3];
  angular_acceleration(body, before, dot4(s.q, s.q), load, omegadot_body);
  for (int k = 0; k < 3; ++k) {
    s.velocity[k] += h * load.force[k] / body.mass;
    s.omega_body[k] += h * omegadot_body[k];
  }
  return s;
}

constexpr int FLIGHT_STEPS = 100, LONG_FLIGHT_STEPS = 5000;

/// Radians in a step; whatever the method, a slower rotation survives.
constexpr double FLIGHT_SLOW = 0.1;

/// False if the body goes astray within so many steps without any load.
inline bool survives_flight(const Scheme &scheme, const RigidBody &body, const BodyState &state,
                            double h, int steps = FLIGHT_STEPS)
{
  const Integrator integrator(scheme, h);
  const MotionLimits limits(h, std::numeric_limits<double>::infinity());
  const Load none = Load();
  std::vector<double> history(scheme.size());    // an array would have to be as long as the longest
  double *rows = history.data();
  BodyState still = state;
  for (double &component : still.velocity) component = 0.0;
  if (!limits.keep(still)) return false;
  seed(scheme, body, local_series(body, still, none, h), h, h, rows);
  for (int step = 0; step < steps; ++step) {
    integrator.predict(rows);
    if (!limits.keep_velocities(integrator.body_state(body, rows))) return false;
    integrator.correct(body, none, rows);
    if (!limits.keep(integrator.body_state(body, rows))) return false;
  }
  return true;
}

/// The longest step, of h and its halves, thirds, ..., that the long flight survives.
inline double longest_step(const Scheme &scheme, const RigidBody &body, const BodyState &state,
                           double h)
{
  int parts = 1;
  while (parts < 1000 && !survives_flight(scheme, body, state, h / parts, LONG_FLIGHT_STEPS))
    parts += parts < 10 ? 1 : parts / 5;
  return h / parts;
}

/// True if a harmonic motion of so many radians in a step keeps its energy within a factor of two.
inline bool survives_oscillation(const Scheme &scheme, double radians)
{
  const double h = 1.0;
  const Integrator integrator(scheme, h);
  const RigidBody body = {1.0, {0.0, 0.0, 0.0}};
  BodyState state = {{1.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  Load load = Load();
  const auto pull = [&] {
    load.force[0] = -radians * radians * state.center[0];
  };
  std::vector<double> history(scheme.size());
  double *rows = history.data();
  pull();
  seed(scheme, body, local_series(body, state, load, h), h, h, rows);
  for (int step = 0; step < LONG_FLIGHT_STEPS; ++step) {
    integrator.predict_center(rows);
    integrator.center_state(body, rows, state);
    pull();
    integrator.correct_center(body, load, rows);
    integrator.center_state(body, rows, state);
    const double x = state.center[0], v = state.velocity[0] / radians;
    if (!(x * x + v * v < 2.0)) return false;
  }
  return true;
}

/// The fastest harmonic motion that is stable, in radians per step.
inline double fastest_oscillation(const Scheme &scheme)
{
  constexpr double GRAIN = 0.02;
  int grains = 1;
  while (grains < 200 && survives_oscillation(scheme, GRAIN * (grains + 1))) ++grains;
  return GRAIN * grains;
}

/// Two significant digits, rounded down.
inline double rounded_down(double number)
{
  if (!std::isfinite(number) || number <= 0.0) return number;
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return std::floor(number / unit * (1.0 + 1.0e-12)) * unit;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
