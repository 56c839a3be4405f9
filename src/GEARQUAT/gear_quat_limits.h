/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What a method follows in steps of h: vibrations and friction, found by trial with the method
   itself, and forces without derivatives.

   Forces without derivatives are random, or due to collisions that last a single step.  The
   derivatives that a history computes from them heat the bodies.

   A step of h maps the rows of a free body under the constant friction xi of a coupling: it
   predicts, then adds c_j times the residual of Integrator::correct_pass().  This map is linear and
   depends on h xi alone.  If its spectral radius is 1 or less, the method is stable.  Far from its
   target a chain has a friction of several times 1/tau. */

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

/// A row of the table of rates: a motion that every step has to resolve.
struct Rate {
  std::string what;      ///< "the angle of the oscillation of the box is"
  double radians;        ///< in a step; of a friction the part of a velocity
  double limit;          ///< radians that the method follows for long
  std::string remedy;    ///< "use a Pdamp of 3 or longer"

  double part() const { return radians / limit; }
};

/// Forces without derivatives: random ones, as of fix langevin or a DPD fluid, and those of
/// contacts and of pair styles with friction alone.
enum class Noise { NONE, RANDOM, DISSIPATIVE };

/// False if such forces heat or cool bodies.  With friction alone four of Gear's values follow any
/// part up to half of a momentum in a step.  With random forces only velocity Verlet gives bodies
/// the temperature of the forces, as it does for atoms; formulation first has no such method.
inline bool suits_noise(const Scheme &scheme, Noise noise)
{
  if (noise == Noise::NONE || scheme.is_verlet()) return true;
  if (noise == Noise::RANDOM && !scheme.first()) return false;
  return !scheme.tuned && scheme.values() <= (scheme.first() ? 3 : 4);
}

/// The largest part h xi of a velocity that the friction of a coupling may take in a step.
class FrictionLimit {
 public:
  static constexpr double MOST = 4.0, ACCURATE = 0.5;

  /// The largest h xi that is stable and is not a large part of a momentum in a step.
  static double of(const Scheme &scheme) { return std::min(stable(scheme), ACCURATE); }

  /// The smallest unstable h xi, positive; MOST if there is none below.
  static double stable(const Scheme &scheme)
  {
    constexpr double LEAST = 0.02, RATIO = 1.05;
    constexpr int HALVINGS = 8;
    const CorrectorCoefficients c(scheme);
    double stable = LEAST;
    while (stable < MOST && !grows(scheme, c, stable * RATIO)) stable *= RATIO;
    if (stable >= MOST) return MOST;
    double unstable = stable * RATIO;
    for (int n = 0; n < HALVINGS; ++n) {
      const double middle = 0.5 * (stable + unstable);
      (grows(scheme, c, middle) ? unstable : stable) = middle;
    }
    return stable;
  }

 private:
  using Map = std::array<std::array<double, MAX_VALUES>, MAX_VALUES>;

  /// The rows of a velocity v in the second formulation are the rows of a position after the first
  /// row, times (j + 1) and divided by h.
  static Map map(bool first, const CorrectorCoefficients &c, double friction, int n)
  {
    Map a = {};
    const double share = friction * (first ? c.c[0] : 0.5 * c.c[1]);
    for (int column = 0; column < n; ++column) {
      double predicted[MAX_VALUES] = {1.0};    // binomial coefficients
      for (int j = 1; j < n; ++j) predicted[j] = predicted[j - 1] * (column - j + 1) / j;
      const double residual = (-friction * predicted[0] - predicted[1]) / (1.0 + share);
      for (int j = 0; j < n; ++j) {
        const double feeds = first ? c.c[j] : 0.5 * (j + 1) * c.c[j + 1];
        a[j][column] = predicted[j] + feeds * residual;
      }
    }
    return a;
  }

  /// True if the powers of the map up to 2^16 grow; those of a stable map grow at most by TRANSIENT.
  static bool grows(const Scheme &scheme, const CorrectorCoefficients &c, double friction)
  {
    constexpr int SQUARINGS = 16;
    constexpr double TRANSIENT = 1.0e6;
    const int n = scheme.values() - !scheme.first();    // rows of momenta, or of velocities
    Map a = map(scheme.first(), c, friction, n);
    for (int k = 0; k < SQUARINGS; ++k) {
      Map squared = {};
      double largest = 0.0;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          for (int l = 0; l < n; ++l) squared[i][j] += a[i][l] * a[l][j];
          largest = std::max(largest, std::fabs(squared[i][j]));
          if (!std::isfinite(squared[i][j])) return true;
        }
      if (largest > TRANSIENT) return true;
      if (largest < 1.0e-3) return false;
      a = squared;
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

}    // namespace LAMMPS_NS::GearQuat

#endif
