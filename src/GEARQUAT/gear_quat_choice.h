/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Choice of the number of values for a simulation.

   The fast edge z of a motion is the frequency of its fastest vibrations times the step.  With the
   accelerations y'' of all bodies, and for rotations I^-1 times the torques along the axes of space,
   weighted by masses and the mean moments of inertia,

     z^4 = sum (|h^4 y''''|^2 + |h^5 y'''''|^2) / sum (|h^2 y''|^2 + |h^3 y'''|^2).

   For a single vibration z is exact at any phase; for many vibrations z corresponds to the upper
   end of their spectrum.  A free rotation has none.  Accelerations that change velocities by less
   than rounding count as none.  A start has computed these derivatives.  The rows of a history
   cannot replace them: with tuned coefficients the errors of the higher rows make z up to twice as
   large.  Where derivatives are unknown, as beside atoms that other fixes move, five values are
   taken, which conserve energy up to the longest steps.  The table of rates then has the root mean
   square frequency of rotations, from the sums of torque^2/I and I omega^2.

   More values give a higher order, but a narrower range of frequencies that conserves energy.
   The crossover from nine to five values follows from measured drifts of liquids (doc/theory.md).
   Random and dissipative forces exclude large numbers of values for any motion
   (gear_quat_limits.h). */

#ifndef GEAR_QUAT_CHOICE_H
#define GEAR_QUAT_CHOICE_H

#include "gear_quat_limits.h"
#include "gear_quat_startup.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace LAMMPS_NS::GearQuat {

/// Sums over bodies, and over ranks by the host, that measure the frequencies of a motion.
class MotionSums {
 public:
  /// sums over bodies: numerator and denominator of (z/h)^4, torque^2/I and I omega^2, and twice the
  /// kinetic energy of bodies with derivatives
  static constexpr int SUMS = 5;
  double sums[SUMS] = {};

  /// Of bodies whose derivatives are not known: any vibrations are possible.
  static MotionSums unknown()
  {
    MotionSums all;
    all.sums[2] = 1.0;
    return all;
  }

  /// A body at the beginning of a series with steps of this length.
  void add(const RigidBody &body, const BodyState &state, const TaylorSeries &series, double step)
  {
    constexpr int LEVELS = 4;    // derivatives, from the second on
    const int known = std::min(series.terms - 2, LEVELS);
    if (known <= 2) return;
    const double *inertia = body.inertia;
    const int freedoms = std::max(1, body.rotational_freedoms());
    const double mean = (inertia[0] + inertia[1] + inertia[2]) / freedoms;
    double axes[9], per_inertia[3], size[LEVELS] = {};    // squares of step^k y^(k)
    rotation_matrix(state.q, dot4(state.q, state.q), axes);
    inverse_moments(body, per_inertia);
    double factorial = 1.0;
    for (int k = 0; k < known; ++k) {
      factorial *= k + 2;
      const double *x = series.c[k + 2], *rate = series.momentum[k + 1];
      double along[3], all = body.mass * dot3(x, x);
      to_body(axes, rate, along);
      for (int i = 0; i < 3; ++i) along[i] *= per_inertia[i] / (k + 2);
      all += mean * dot3(along, along);
      size[k] = factorial * factorial * all;
    }
    const double per_step4 = 1.0 / (step * step * step * step);    // in units of y''
    sums[0] += per_step4 * per_step4 * (size[2] + size[3]);
    sums[1] += per_step4 * (size[0] + size[1]);
    sums[4] += body.mass * dot3(state.velocity, state.velocity);
    for (int k = 0; k < 3; ++k) sums[4] += inertia[k] * state.omega_body[k] * state.omega_body[k];
  }
  /// A body with a known load and no derivatives.
  void add(const RigidBody &body, const BodyState &state, const double *torque_body)
  {
    for (int k = 0; k < 3; ++k) {
      if (!(body.inertia[k] > 0.0)) continue;
      sums[2] += torque_body[k] * torque_body[k] / body.inertia[k];
      sums[3] += body.inertia[k] * state.omega_body[k] * state.omega_body[k];
    }
  }

  /// Radians in a step; infinite if unknown, 0 without motion.
  double fast_edge(double h) const
  {
    const double size = std::fabs(h);
    if (knows_derivatives(h)) return size * std::pow(sums[0] / sums[1], 0.25);
    if (sums[3] > 0.0) return EDGE_BY_MEAN * size * std::sqrt(sums[2] / sums[3]);
    return sums[2] > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
  }
  /// True if the fast edge is from derivatives.
  bool knows_derivatives(double h) const
  {
    return sums[1] > 0.0 && h * h * sums[1] > LEAST_CHANGE * LEAST_CHANGE * sums[4];
  }

  // by the root mean square frequency: 1.75 times that in SPC/E at 300 K, which causes no false
  // warning, and 4 times and more in fluids whose bodies collide rarely; a step that is advised has
  // to be short enough for these, too
  static constexpr double EDGE_BY_MEAN = 3.0, LEAST_PART = 1.75 / EDGE_BY_MEAN;

 private:
  /// Changes of velocities in a step, relative to the velocities, that are not larger than this are
  /// from rounding: the forces between atoms of a body cancel only up to rounding.
  static constexpr double LEAST_CHANGE = 1.0e-10;
};

/// Input to the choice of the number of values.
struct ChoiceOfValues {
  double edge = 0.0;     ///< radians in a step, see MotionSums
  bool exact = false;    ///< from derivatives
  Noise noise = Noise::NONE;
  bool may_be_gear = true;    ///< the corrector may be changed, too

  enum class Reason { FORMULATION, MOTION, NOISE };
  struct Choice {
    Scheme scheme;
    Reason reason;
  };

  // tuned: radians in a step up to which nine values are best, and the factor of the hysteresis of a
  // present choice

  static constexpr double EDGE_OF_NINE = 0.25, BAND = 1.3;

  /// The vibrations, in radians per step, whose energy a scheme conserves for long.
  static double longest_edge(const Scheme &scheme)
  {
    return 2.0 / 3.0 * fastest_oscillation(scheme);
  }

  /// scheme: with the number of values for smooth motion.  present: the current number, 0 for none.
  Choice choose(const Scheme &scheme, int present = 0) const
  {
    Choice choice = {scheme, Reason::FORMULATION};
    if (scheme.tuned) {
      const double band = present == 9 ? BAND : present == 5 ? 1.0 / BAND : 1.0;
      choice.scheme.rows = edge <= band * EDGE_OF_NINE ? 9 : 5;
      choice.reason = Reason::MOTION;
    }
    if (suits_noise(choice.scheme, noise)) return choice;
    choice.reason = Reason::NOISE;
    if (noise == Noise::RANDOM && !scheme.first()) {
      choice.scheme.rows = VERLET;
    } else {
      choice.scheme.tuned = scheme.tuned && !may_be_gear;
      choice.scheme.rows = scheme.first() ? FIRST_FEWEST : SECOND_FEWEST;
    }
    return choice;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
