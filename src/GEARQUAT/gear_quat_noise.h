/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Forces without derivatives: random ones, or those of collisions, which last a single step.  What
   a history makes of their derivatives heats the bodies.

   A force in one step alone, and none afterwards, changes the velocity in the steps that follow by
   d_1, d_2, ..., whose sum is 1 in units of h F/m.  Forces that are independent from step to step
   change the velocity in a step by sum d_k^2 times the right mean square. */

#ifndef GEAR_QUAT_NOISE_H
#define GEAR_QUAT_NOISE_H

#include "gear_quat_tuned.h"

#include <string>

namespace LAMMPS_NS::GearQuat {

enum class Noise { NONE, RANDOM, COLLISIONS };

/// sum d_k^2 of the center of mass, with these coefficients.
inline double noise_gain(const Scheme &scheme, const CorrectorCoefficients &c)
{
  constexpr int STEPS = 1000;    // roots of 0.99 have faded
  const int n = scheme.values(), order = scheme.first() ? 1 : 2;
  double rows[MAX_VALUES] = {}, gain = 0.0;
  for (int step = 0; step < STEPS; ++step) {
    const double before = rows[order - 1];
    Nordsieck<1>::predict(rows, n);
    const double residual = (step == 0 ? 1.0 / order : 0.0) - rows[order];
    Nordsieck<1>::correct<1>(rows, n, c.driven.data(), 0, &residual);
    const double change = rows[order - 1] - before;
    gain += change * change;
  }
  return gain;
}

/// With the coefficients of the scheme.
inline double noise_gain(const Scheme &scheme)
{
  return noise_gain(scheme, CorrectorCoefficients(scheme));
}

/// Values that do not heat with Gear's coefficients (tests/lammps/test_other_fixes.py).
inline int most_with_noise(const Scheme &scheme, Noise noise)
{
  if (noise == Noise::NONE) return MAX_VALUES;
  if (noise == Noise::COLLISIONS) return scheme.first() ? 3 : 4;
  return scheme.first() ? 4 : 6;
}

/// False if such forces heat bodies more than they do with the largest of these numbers.
inline bool suits_noise(const Scheme &scheme, Noise noise)
{
  const int most = most_with_noise(scheme, noise);
  if (!scheme.tuned) return scheme.values() <= most;
  Scheme limit = scheme;
  limit.tuned = false;
  limit.rows = most;
  return noise == Noise::NONE || noise_gain(scheme) <= 1.001 * noise_gain(limit);
}

/// The keywords that suit this noise, in words; empty if those of the scheme do.
inline std::string remedy_for_noise(const Scheme &scheme, Noise noise)
{
  if (suits_noise(scheme, noise)) return "";
  const int most = most_with_noise(scheme, noise);
  if (!scheme.tuned) return "values " + std::to_string(most) + " at most";
  Scheme other = scheme;
  int suited = 0;
  for (const int values : tuned_values(scheme.formulation)) {
    other.rows = values;
    if (suits_noise(other, noise)) suited = values;
  }
  if (suited) return "values " + std::to_string(suited);
  return "corrector gear and values " + std::to_string(most) + " at most";
}

/// Whether the momentum of a free body fades under a friction that takes this part of it in a step.
/// The force is that of the predicted velocity, as in a step of the fix.
inline bool friction_fades(const Scheme &scheme, double part)
{
  constexpr int STEPS = 2000;
  const CorrectorCoefficients c(scheme);
  const int n = scheme.values(), order = scheme.first() ? 1 : 2;
  double rows[MAX_VALUES] = {};
  rows[order - 1] = 1.0;
  for (int step = 0; step < STEPS; ++step) {
    Nordsieck<1>::predict(rows, n);
    const double residual = -part / order * rows[order - 1] - rows[order];
    Nordsieck<1>::correct<1>(rows, n, c.driven.data(), 0, &residual);
  }
  return std::fabs(rows[order - 1]) < 1.0;
}

/// The largest part of a momentum, in hundredths, that friction may take in a step.
inline double largest_friction(const Scheme &scheme)
{
  int hundredths = 0;
  while (hundredths < 100 && friction_fades(scheme, 0.01 * (hundredths + 1))) ++hundredths;
  return 0.01 * hundredths;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
