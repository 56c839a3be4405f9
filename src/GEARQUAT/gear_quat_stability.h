/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What a method follows in steps of h, and the number of values for a motion.

   The fast edge z of a motion is the frequency of its fastest vibrations times the step.  With the
   accelerations y'' of all bodies, and for rotations I^-1 times the torques along the axes of space,
   weighted by masses and the mean moments of inertia,

     z^4 = sum (|h^4 y''''|^2 + |h^5 y'''''|^2) / sum (|h^2 y''|^2 + |h^3 y'''|^2).

   For a single vibration z is exact at any phase; for many vibrations z corresponds to the upper
   end of their spectrum.  A free rotation has none.  Accelerations that change velocities by less
   than rounding count as none.  A start has computed these derivatives.  The rows of a history
   cannot replace them: with tuned coefficients the errors of the higher rows make z up to twice as
   large.  Where derivatives are unknown, as beside atoms that other fixes move, five values are
   taken, which conserve energy up to the longest steps.

   More values give a higher order, but a narrower range of frequencies that conserves energy.
   The crossover from nine to five values follows from measured drifts of liquids (doc/theory.md).

   Forces without derivatives are random, or due to collisions that last a single step.  The
   derivatives that a history computes from them heat the bodies, with many values for any motion. */

#ifndef GEAR_QUAT_STABILITY_H
#define GEAR_QUAT_STABILITY_H

#include "gear_quat_startup.h"

#include <string>

namespace LAMMPS_NS::GearQuat {

/// No step can be right if a body turns by half a turn in it (the poses alone do not determine the
/// direction of the turn), if it crosses the whole simulation box, or if its motion is not finite.
/// All these limits are far outside of the stable range, so only unstable runs end here:
/// the quaternion of a free rotation is a harmonic motion with omega/2, half a turn is omega/2 h =
/// 1.57, and all methods here are unstable beyond 1.42.
struct MotionLimits {
  static constexpr double TURN = 3.14159265358979323846;    ///< radians in a step

  double speed2 = 0.0, rate2 = 0.0;

  MotionLimits() = default;
  /// h: the time step, not zero.  length: of the scene, infinite for none.
  MotionLimits(double h, double length) :
      speed2((length / h) * (length / h)), rate2((TURN / h) * (TURN / h))
  {
  }

  /// False for velocities that are beyond the limits or not finite.
  bool keep(const BodyState &s) const
  {
    return dot3(s.velocity, s.velocity) < speed2 && dot3(s.omega_body, s.omega_body) < rate2;
  }
};

/// The fastest harmonic motion that is stable, in radians per step, from a trial of each method in
/// tests/unit/test_limits.cpp.
double fastest_oscillation(const Scheme &scheme);

/// The vibrations, in radians per step, whose energy a scheme conserves for long.
inline double longest_edge(const Scheme &scheme)
{
  return 2.0 / 3.0 * fastest_oscillation(scheme);
}

/// A row of the table of rates: a motion that every step has to resolve.
struct Rate {
  std::string what;      ///< "the angle of the oscillation of the box is"
  double radians;        ///< in a step; of a friction the part of a velocity
  double limit;          ///< radians that the method follows for long
  std::string remedy;    ///< "use a Pdamp of 3 or longer"

  double part() const { return radians / limit; }
};

/// Sums over bodies, and over ranks by the host, that measure the frequencies of a motion.
struct MotionSums {
  /// numerator and denominator of (z/h)^4, and twice the kinetic energy
  double sums[3] = {};

  /// A body at the beginning of a series with steps of this length.
  void add(const RigidBody &body, const BodyState &state, const TaylorSeries &series, double step);

  /// Radians in a step, 0 without accelerations.
  double fast_edge(double h) const;
};

/// Forces without derivatives: random ones, as of fix langevin or a DPD fluid, and those of
/// contacts and of pair styles with friction alone.
enum class Noise { NONE, RANDOM, DISSIPATIVE };

/// False if such forces heat or cool bodies.  With friction alone four of Gear's values follow any
/// part up to a fifth of a momentum in a step.  With random forces only velocity Verlet gives
/// bodies the temperature of the forces, as it does for atoms; formulation first has no such
/// method.
bool suits_noise(const Scheme &scheme, Noise noise);

/// The scheme for a motion, and the reason of its number of values.
struct Choice {
  enum Reason { FORMULATION, MOTION, NOISE };
  Scheme scheme;
  Reason reason;

  /// Tuned: radians in a step up to which nine values are best, and the factor of the hysteresis of
  /// a present choice.
  static constexpr double EDGE_OF_NINE = 0.25, BAND = 1.3;

  /// scheme: with the number of values for smooth motion; its corrector is kept if `stated`.  edge:
  /// radians in a step.  present: the current number, 0 for none.
  Choice(const Scheme &scheme, double edge, Noise noise, bool stated, int present = 0);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
