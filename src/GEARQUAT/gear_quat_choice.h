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
   large.  Where derivatives are unknown, the mean square frequency of rotations, the ratio of the
   sums of torque^2/I and I omega^2, is used instead.

   More values give a higher order, but a narrower range of frequencies that conserves energy.
   The crossover from nine to five values follows from measured drifts of liquids (doc/theory.md).
   Random and dissipative forces exclude large numbers of values for any motion
   (gear_quat_limits.h). */

#ifndef GEAR_QUAT_CHOICE_H
#define GEAR_QUAT_CHOICE_H

#include "gear_quat_limits.h"
#include "gear_quat_startup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// Sums over bodies, and over ranks by the host, that measure the frequencies of a motion.
class MotionSums {
 public:
  /// sums over bodies: numerator and denominator of (z/h)^4, torque^2/I and I omega^2, and twice the
  /// kinetic energy of bodies with derivatives
  static constexpr int SUMS = 5;
  double sums[SUMS] = {};

  static constexpr int LEVELS = 4;    ///< derivatives in use, from the second on
  /// h^j/j! y^(j) of a body, where the angular momentum along the axes of space is the y' of
  /// rotation: row j of a history of formulation momentum.
  using Derivative = std::array<double, 6>;
  static Derivative derivative(const TaylorSeries &series, int j)
  {
    const double *x = series.c[j], *rate = series.momentum[j - 1];
    return {x[0], x[1], x[2], rate[0] / j, rate[1] / j, rate[2] / j};
  }

  /// A body at the beginning of a series with steps of this length.
  void add(const RigidBody &body, const BodyState &state, const TaylorSeries &series, double step)
  {
    Derivative derivatives[LEVELS];
    const int known = std::min(series.terms - 2, LEVELS);
    for (int k = 0; k < known; ++k) derivatives[k] = derivative(series, k + 2);
    if (known > 2) add_derivatives(body, state, derivatives, known, step);
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

  /// A body with second derivatives after four steps of this length in a row.  Differences take the
  /// place of derivatives in the middle; true_edge() corrects for their length.
  void add(const RigidBody &body, const BodyState &state, const Derivative *seconds, double h)
  {
    Derivative derivatives[LEVELS];
    for (size_t i = 0; i < seconds->size(); ++i) {
      const double a = seconds[0][i], b = seconds[1][i], c = seconds[2][i], d = seconds[3][i];
      derivatives[0][i] = 0.5 * (b + c);
      derivatives[1][i] = (c - b) / 3.0;
      derivatives[2][i] = (a - b - c + d) / 24.0;
      derivatives[3][i] = (d - a + 3.0 * (b - c)) / 60.0;
    }
    add_derivatives(body, state, derivatives, LEVELS, h);
  }
  /// The fast edge from its value by differences, which is 2 sin(z/2) for a vibration of any phase.
  static double true_edge(double by_differences)
  {
    return 2.0 * std::asin(std::min(1.0, 0.5 * by_differences));
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

 private:
  /// 1.75 in SPC/E at 300 K, 4 and more in fluids whose bodies collide rarely.  A value that is too
  /// large costs only accuracy, which a start without derivatives does not have.
  static constexpr double EDGE_BY_MEAN = 3.0;
  /// Changes of velocities in a step, relative to the velocities, that are not larger than this are
  /// from rounding: the forces between atoms of a body cancel only up to rounding.
  static constexpr double LEAST_CHANGE = 1.0e-10;

  /// The first `known` derivatives.
  void add_derivatives(const RigidBody &body, const BodyState &state, const Derivative *derivatives,
                       int known, double h)
  {
    constexpr double FACTORIAL[] = {2.0, 6.0, 24.0, 120.0};
    const double *inertia = body.inertia;
    const int freedoms = std::max(1, body.rotational_freedoms());
    const double mean = (inertia[0] + inertia[1] + inertia[2]) / freedoms;
    double axes[9], per_inertia[3], size[LEVELS] = {};    // squares of h^k y^(k)
    rotation_matrix(state.q, dot4(state.q, state.q), axes);
    inverse_moments(body, per_inertia);
    for (int k = 0; k < known; ++k) {
      const double *x = derivatives[k].data();
      double along[3], all = body.mass * dot3(x, x);
      to_body(axes, x + 3, along);
      for (int i = 0; i < 3; ++i) along[i] *= per_inertia[i];
      all += mean * dot3(along, along);
      size[k] = FACTORIAL[k] * FACTORIAL[k] * all;
    }
    const double per_h4 = 1.0 / (h * h * h * h);    // in units of y''
    sums[0] += per_h4 * per_h4 * (size[2] + size[3]);
    sums[1] += per_h4 * (size[0] + size[1]);
    sums[4] += body.mass * dot3(state.velocity, state.velocity);
    for (int k = 0; k < 3; ++k) sums[4] += inertia[k] * state.omega_body[k] * state.omega_body[k];
  }
};

/// Input to the choice of the number of values.
struct ChoiceOfValues {
  double edge = 0.0;     ///< radians in a step, see MotionSums
  bool exact = false;    ///< from derivatives
  Noise noise = Noise::NONE;
  double friction = 0.0;      ///< of a coupling, times the step
  bool may_be_gear = true;    ///< the corrector may be changed, too
  bool automatic = true;      ///< the number of values may be chosen

  enum class Reason { FORMULATION, MOTION, NOISE, FRICTION };
  struct Choice {
    Scheme scheme;
    Reason reason;
  };

  // tuned: radians in a step up to which nine values are best; radians beyond which no number
  // conserves the energy for long; and the factor of the hysteresis of a present choice

  static constexpr double EDGE_OF_NINE = 0.25, LONGEST_EDGE = 0.6;

  // the longest edge of other schemes as a part of their fastest stable oscillation, which is
  // LONGEST_EDGE for the most permissive of the schemes above; and the advised edge as a part of the
  // longest one
  static constexpr double LONGEST_PART = 2.0 / 3.0, ADVISED_PART = 5.0 / 6.0;

  static constexpr double BAND = 1.3;

  /// scheme: with the number of values for smooth motion.  present: the current number, 0 for none.
  Choice choose(const Scheme &scheme, int present = 0) const
  {
    Choice choice = {scheme, Reason::FORMULATION};
    if (scheme.tuned) choice = {by_motion(scheme, present), Reason::MOTION};
    if (permits(choice.scheme)) return choice;
    choice.reason = suits_noise(choice.scheme, noise) ? Reason::FRICTION : Reason::NOISE;
    if (noise == Noise::RANDOM && !scheme.first()) {
      choice.scheme.rows = VERLET;
      return choice;
    }
    for (const Scheme &other : others(scheme)) {
      choice.scheme = other;
      if (permits(other)) break;
    }
    return choice;
  }

  /// True if a longer step does not require another number of values than the chosen one.
  bool chooses_longest(const Scheme &scheme) const { return automatic && scheme.tuned; }
  /// True if a step is too long for this scheme, or, if the number of values may be chosen, for any.
  bool too_long(const Scheme &scheme) const { return advised_part(scheme) < 1.0; }
  /// A step that is not too long, as a part of the current step.
  double advised_part(const Scheme &scheme) const
  {
    const double longest = shakes() ? longest_edge(scheme) : HUGE_VAL;
    return edge > longest ? ADVISED_PART * longest / edge : 1.0;
  }

 private:
  /// Random forces cause no vibrations.
  bool shakes() const { return exact && noise == Noise::NONE; }

  /// Radians in a step.
  double longest_edge(const Scheme &scheme) const
  {
    return chooses_longest(scheme) ? LONGEST_EDGE : LONGEST_PART * fastest_oscillation(scheme);
  }

  Scheme by_motion(Scheme scheme, int present) const
  {
    const double band = present == 9 ? BAND : present == 5 ? 1.0 / BAND : 1.0;
    scheme.rows = edge <= band * EDGE_OF_NINE ? 9 : 5;
    return scheme;
  }

  bool permits(const Scheme &scheme) const
  {
    return suits_noise(scheme, noise) && (friction == 0.0 || friction <= FrictionLimit::of(scheme));
  }

  /// Alternatives to a scheme, the best first, the most permissive last.
  std::vector<Scheme> others(const Scheme &scheme) const
  {
    std::vector<Scheme> list;
    const auto add = [&](bool tuned, int values) {
      Scheme other = scheme;
      other.tuned = tuned;
      other.rows = values;
      list.push_back(other);
    };
    const int fewest = scheme.first() ? FIRST_FEWEST : SECOND_FEWEST;
    if (scheme.tuned)
      for (const int n : {9, 7, 5, 4}) add(true, n);
    if (!scheme.tuned || may_be_gear)
      for (int n = scheme.first() ? 6 : 8; n >= fewest; --n) add(false, n);
    return list;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
