/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Limits of a method with steps of h: free rotations, forces without derivatives and friction, each
   found by trial with the method itself, and vibrations, whose trials are too long for a run.

   The fastest rotation depends on the number of values, on the passes and on the moments of
   inertia; it is found by a trial of a free rotation.

   Forces without derivatives are random, or due to collisions that last a single step.  The
   derivatives that a history computes from them heat the bodies.  A force that acts in one step
   only changes the velocity in the following steps by d_1, d_2, ..., whose sum is 1 in units of h
   F/m.  Forces that are independent from step to step change the velocity in a step by sum d_k^2
   times the correct mean square.

   The friction of a coupling is treated separately.  A step of h maps the rows of a free body under
   the constant friction xi: it predicts, then adds c_j times the residual of
   Integrator::correct_pass().  This map is linear and depends on h xi alone.  If its spectral
   radius is 1 or less, the method is stable.  Far from its target a chain has a friction of several
   times 1/tau. */

#ifndef GEAR_QUAT_LIMITS_H
#define GEAR_QUAT_LIMITS_H

#include "gear_quat_chain.h"
#include "gear_quat_startup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// The state with the velocities that result from a load in a step h.
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

/// Radians in a step; a slower rotation is stable with all methods.
constexpr double FLIGHT_SLOW = 0.1;

/// False if the body becomes unstable within this number of steps without any load.
inline bool survives_flight(const Scheme &scheme, const RigidBody &body, const BodyState &state,
                            double h, int steps = FLIGHT_STEPS)
{
  const Integrator integrator(scheme, h);
  const MotionLimits limits(h, std::numeric_limits<double>::infinity());
  const Load none = Load();
  std::vector<double> history(scheme.size());    // allocated at run time: a fixed array would need
                                                 // the largest size
  double *rows = history.data();
  BodyState still = state;
  for (double &component : still.velocity) component = 0.0;
  if (!limits.keep(still)) return false;
  seed(scheme, body, local_series(body, still, none, h), h, h, rows);
  for (int step = 0; step < steps; ++step) {
    integrator.predict(body, rows);
    if (!limits.keep_velocities(integrator.body_state(body, rows))) return false;
    integrator.correct(body, none, rows);
    if (!limits.keep(integrator.body_state(body, rows))) return false;
  }
  return true;
}

/// The longest step, among h, h/2, h/3, ..., that is stable in the long trial.
inline double longest_step(const Scheme &scheme, const RigidBody &body, const BodyState &state,
                           double h)
{
  int parts = 1;
  while (parts < 1000 && !survives_flight(scheme, body, state, h / parts, LONG_FLIGHT_STEPS))
    parts += parts < 10 ? 1 : parts / 5;
  return h / parts;
}

/// The fastest harmonic motion that is stable, in radians per step, from a trial of each method in
/// tests/unit/test_limits.cpp.
inline double fastest_oscillation(const Scheme &scheme)
{
  constexpr int FEWEST = 3;    // values of the first column
  constexpr double FASTEST[][MAX_VALUES - FEWEST + 1] = {
      {2.0, 1.40, 0.36, 0.42, 0.62, 0.46, 0.32, 0.24, 0.16, 0.12},     // Gear's
      {0.0, 0.24, 0.32, 0.44, 0.60, 0.44, 0.32, 0.22, 0.16, 0.12},     // with c0 of velocities
      {1.00, 0.92, 0.28, 0.34, 0.24, 0.12},                            // first formulation
      {0.72, 0.42, 0.22, 0.10, 0.04, 0.02},                            // with predicted momentum
      {2.00, 1.04, 0.96, 0.54, 0.70, 0.66, 0.60, 0.56, 0.60, 0.50},    // tuned
  };
  const int row = scheme.tuned
      ? 4
      : 2 * scheme.first() + (scheme.first() ? scheme.predicted_momentum : scheme.velocity_c0);
  return FASTEST[row][scheme.values() - FEWEST];
}

/// Two significant digits, rounded down.
inline double rounded_down(double number)
{
  if (!std::isfinite(number) || number <= 0.0) return number;
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return std::floor(number / unit * (1.0 + 1.0e-12)) * unit;
}

/// Up to two digits.
inline double rounded_up(double number)
{
  if (!std::isfinite(number) || number <= 0.0) return number;
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return std::ceil(number / unit * (1.0 - 1.0e-12)) * unit;
}

/* ---------------------------------------------------------------------- */

/// Forces without derivatives: random ones, as of fix langevin or a DPD fluid, and those of
/// contacts and of pair styles with friction alone.
enum class Noise { NONE, RANDOM, DISSIPATIVE };

/// sum d_k^2 of the center of mass, with these coefficients.
inline double noise_gain(const Scheme &scheme, const CorrectorCoefficients &c)
{
  constexpr int STEPS = 1000;    // roots of 0.99 have decayed
  const int n = scheme.values(), order = scheme.first() ? 1 : 2;
  double rows[MAX_VALUES] = {}, gain = 0.0;
  for (int step = 0; step < STEPS; ++step) {
    const double before = rows[order - 1];
    Nordsieck<1>::predict(rows, n);
    const double residual = (step == 0 ? 1.0 / order : 0.0) - rows[order];
    Nordsieck<1>::correct<1>(rows, n, c.c.data(), 0, &residual);
    const double change = rows[order - 1] - before;
    gain += change * change;
  }
  return gain;
}

/// The noise gain with the coefficients of the scheme.
inline double noise_gain(const Scheme &scheme)
{
  return noise_gain(scheme, CorrectorCoefficients(scheme));
}

/// False if such forces heat or cool bodies.  With friction alone four of Gear's values follow any
/// part up to half of a momentum in a step.  With random forces only velocity Verlet gives bodies
/// the temperature of the forces, as it does for atoms; formulation first has no such method.
inline bool suits_noise(const Scheme &scheme, Noise noise)
{
  if (noise == Noise::NONE || scheme.is_verlet()) return true;
  if (noise == Noise::RANDOM && !scheme.first()) return false;
  return !scheme.tuned && scheme.values() <= (scheme.first() ? 3 : 4);
}

using RowMap = std::array<std::array<double, MAX_VALUES>, MAX_VALUES>;

inline RowMap product(const RowMap &a, const RowMap &b, int n)
{
  RowMap ab = {};
  for (int i = 0; i < n; ++i)
    for (int l = 0; l < n; ++l)
      for (int j = 0; j < n; ++j) ab[i][j] += a[i][l] * b[l][j];
  return ab;
}

inline double largest_of(const RowMap &a, int n)
{
  double largest = 0.0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) largest = std::max(largest, std::fabs(a[i][j]));
  return std::isfinite(largest) ? largest : std::numeric_limits<double>::infinity();
}

/* ---------------------------------------------------------------------- */

class FrictionLimit {
 public:
  /// The largest h xi that is stable and is not a large part of a momentum in a step.
  static double of(const Scheme &scheme) { return std::min(stable(scheme), ACCURATE); }

  /// The smallest unstable h xi, positive; MOST if there is none below.
  static double stable(const Scheme &scheme)
  {
    const FrictionLimit map(scheme);
    double stable = LEAST;
    while (stable < MOST && !map.grows(stable * RATIO)) stable *= RATIO;
    if (stable >= MOST) return MOST;
    double unstable = stable * RATIO;
    for (int n = 0; n < HALVINGS; ++n) {
      const double middle = 0.5 * (stable + unstable);
      (map.grows(middle) ? unstable : stable) = middle;
    }
    return stable;
  }

  static constexpr double MOST = 4.0, ACCURATE = 0.5;

 private:
  static constexpr double LEAST = 0.02, RATIO = 1.05;
  static constexpr int HALVINGS = 8;
  // powers of the map up to 2^16; the powers of a stable map grow at most by this factor
  static constexpr int SQUARINGS = 16;
  static constexpr double TRANSIENT = 1.0e6;

  const bool first;
  const int n;    ///< rows of momenta, or of velocities
  CorrectorCoefficients c;

  explicit FrictionLimit(const Scheme &scheme) :
      first(scheme.first()), n(scheme.values() - !first), c(scheme)
  {
  }

  /// The rows of a velocity v in the second formulation are the rows of a position after the first
  /// row, times (j + 1) and divided by h.
  RowMap map(double friction) const
  {
    RowMap a = {};
    const double share = friction * (first ? c.c[0] : 0.5 * c.c[1]);
    for (int column = 0; column < n; ++column) {
      double predicted[MAX_VALUES];
      for (int j = 0; j < n; ++j) predicted[j] = j > column ? 0.0 : binomial(column, j);
      const double residual = (-friction * predicted[0] - predicted[1]) / (1.0 + share);
      for (int j = 0; j < n; ++j) {
        const double feeds = first ? c.c[j] : 0.5 * (j + 1) * c.c[j + 1];
        a[j][column] = predicted[j] + feeds * residual;
      }
    }
    return a;
  }

  static double binomial(int n, int k)
  {
    double product = 1.0;
    for (int i = 0; i < k; ++i) product *= double(n - i) / (i + 1);
    return product;
  }

  bool grows(double friction) const
  {
    RowMap a = map(friction);
    for (int k = 0; k < SQUARINGS; ++k) {
      a = product(a, a, n);
      const double largest = largest_of(a, n);
      if (largest > TRANSIENT) return true;
      if (largest < 1.0e-3) return false;
    }
    return false;
  }
};

/// The largest |xi_1| (1/time) that a chain with a single variable reaches with an ideal gas, from
/// its first integral (xi tau)^2 + f - ln f with f = 2K/(g kT); longer chains stay below it.
inline double friction_bound(const Chain &chain, const ChainTarget &target, double twice_kinetic)
{
  const double part = twice_kinetic / (target.freedoms * target.kt);
  const double begun = chain.friction() * target.period;
  return std::sqrt(begun * begun + std::max(0.0, part - 1.0 - std::log(part))) / target.period;
}

/// The largest |xi_1| (1/time) that this chain reaches with an ideal gas in steps of h, from a trial
/// over two damping times; infinite if the steps are too long for the chain.  The friction of bodies
/// with potential energy is not larger, because an ideal gas stores heat only as kinetic energy.
inline double friction_on_trial(Chain chain, const ChainTarget &target, double twice_kinetic,
                                double h)
{
  constexpr int VALUES = 5, PASSES = 2;
  const double size = std::fabs(h);
  double largest = std::fabs(chain.friction());
  for (double time = 0.0; time < 2.0 * target.period; time += size) {
    const double before = chain.friction();
    double twice = twice_kinetic;
    for (int pass = 0; pass < PASSES; ++pass) {
      if (!chain.advance(target, twice, size, VALUES)) return HUGE_VAL;
      twice = twice_kinetic * std::exp(-size * (before + chain.friction()));
    }
    chain.conclude();
    twice_kinetic = twice;
    largest = std::max(largest, std::fabs(chain.friction()));
  }
  return largest;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
