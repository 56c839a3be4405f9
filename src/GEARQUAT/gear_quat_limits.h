/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What a method follows in steps of h: vibrations, found by trial with the method itself, and
   forces without derivatives.

   Forces without derivatives are random, or due to collisions that last a single step.  The
   derivatives that a history computes from them heat the bodies. */

#ifndef GEAR_QUAT_LIMITS_H
#define GEAR_QUAT_LIMITS_H

#include "gear_quat_startup.h"

#include <cmath>
#include <string>

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

}    // namespace LAMMPS_NS::GearQuat

#endif
