/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A free flight on trial: does a method follow the rotation that a body has, at a given step?  The
   limit depends on the number of values, on the passes and on the moments; flown it needs no table. */

#ifndef GEAR_QUAT_FLIGHT_H
#define GEAR_QUAT_FLIGHT_H

#include "gear_quat_limits.h"
#include "gear_quat_startup.h"

#include <limits>
#include <vector>

namespace LAMMPS_NS::GearQuat {

constexpr int FLIGHT_STEPS = 100;

/// Radians in a step; whatever the method, a slower rotation survives.
constexpr double FLIGHT_SLOW = 0.1;

/// False if the body goes astray within FLIGHT_STEPS steps without any load.
inline bool survives_flight(const Scheme &scheme, const RigidBody &body, const BodyState &state,
                            double h)
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
  for (int step = 0; step < FLIGHT_STEPS; ++step) {
    integrator.predict(rows);
    if (!limits.keep_velocities(integrator.body_state(body, rows))) return false;
    integrator.correct(body, none, rows);
    if (!limits.keep(integrator.body_state(body, rows))) return false;
  }
  return true;
}

/// The longest step, of h and its halves, thirds, ..., that the flight survives.
inline double longest_step(const Scheme &scheme, const RigidBody &body, const BodyState &state,
                           double h)
{
  int parts = 1;
  while (parts < 1000 && !survives_flight(scheme, body, state, h / parts))
    parts += parts < 10 ? 1 : parts / 5;
  return h / parts;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
