/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The method of Adams with a step and an order that adapt to the error: of every body the last k
   loads, at any times, are remembered as the polynomial through them.

   A history of formulation momentum has this polynomial in its rows 2 to k + 1, and its integrals
   in the rows 0 and 1.  The times are the same for all bodies, so the coefficients of the corrector
   are computed once per step:

     predict  under the polynomial through the last k loads
     correct  under the one that has the new load in addition; the error is the change of the pose
     lag      the last steps are integrated again under this polynomial: they are inside of it

   Two more rows, a_j = h^j/j! y^(j) like all others, are the trial row j = k + 2, from the
   difference of order k of the loads, and the row j = k + 3 that was dropped after the last step,
   under which the last steps were integrated.  The order is as high as differences of the loads
   decrease.  A history begins with k = 1, so no other loads than those of the steps are necessary.

   Sources: F. T. Krogh, in Lecture Notes in Mathematics 362 (1974), p. 22, for variable steps;
   L. F. Shampine and M. K. Gordon, "Computer Solution of Ordinary Differential Equations" (1975),
   for the start and the choice of the order. */

#ifndef GEAR_QUAT_REMEMBERED_LOADS_H
#define GEAR_QUAT_REMEMBERED_LOADS_H

#include "gear_quat_integrator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace LAMMPS_NS::GearQuat {

/// Of a step of one body, or the largest of all bodies.
struct StepErrors {
  /// As a length: of the position, or of the orientation times the reach of the body, whichever is
  /// larger.  As an energy: the change of energy due to the errors of pose and velocities.
  double length = 0.0, energy = 0.0;
  /// The effect of the last term of the polynomial with one load fewer, as many, and one more.
  double fewer = 0.0, same = 0.0, more = 0.0;

  void include(const StepErrors &other)
  {
    length = std::max(length, other.length);
    energy = std::max(energy, other.energy);
    fewer = std::max(fewer, other.fewer);
    same = std::max(same, other.same);
    more = std::max(more, other.more);
  }
};

class RememberedLoads {
 public:
  /// Steps that are integrated again, unless they are longer than the present one by this factor:
  /// then loads may have jumped.
  static constexpr int LAG = 3;
  static constexpr double LONGER = 2.0;
  /// Rows of a history after its n rows and their carries.
  static constexpr int MORE_ROWS = 2;

  /// compensate: as in the scheme of the histories.
  explicit RememberedLoads(bool compensate) : carries(compensate ? 2 : 0) {}

  /// Of histories with the present load, or with the largest number of loads.
  static Scheme scheme(bool compensate, int loads = 1)
  {
    Scheme scheme;
    scheme.formulation = Formulation::MOMENTUM;
    scheme.rows = loads + 2;
    scheme.compensate = compensate;
    scheme.remembers = true;
    return scheme;
  }

  /// Only the present load is known; or as many at equal intervals.
  void begin(int loads = 1, double interval = 0.0)
  {
    k = known = loads;
    compares = false;
    for (int j = 0; j <= MOST_LOADS; ++j) ages[j] = j * interval;
  }

  int loads() const { return k; }
  /// Rows of a history.
  int values() const { return k + 2; }

  /// The weights for a step of h.
  void prepare(double h)
  {
    const int n = values();
    const Nodal all(ages, k, h), fewer(ages, k - 1, h), more(ages, k + 1, h);
    corrector = CorrectorCoefficients();
    corrector.c[0] = 2.0 * all.twice(0.0, 1.0);
    corrector.c[1] = 2.0 * all.once(0.0, 1.0);
    corrector.weight2 = corrector.c[0] * corrector.c[0];
    corrector.moment = -all.thrice(0.0, 1.0);
    const auto next = fewer.about(1.0);    // the new load replaces the oldest one
    for (int j = 2; j < n; ++j) corrector.c[j] = 2.0 * next[j - 2] / (j * (j - 1));

    const double from_trial = n * (n - 1) * all.scale, from_dropped = (n + 1) * n * more.scale;
    to_trial = 2.0 / from_trial;
    of_fewer = (n - 1) * (n - 2) * fewer.scale * fewer.once(0.0, 1.0);
    of_more = k < known && compares ? from_trial * more.once(0.0, 1.0) : 0.0;
    int steps = 0;
    while (steps < std::min({LAG, (k - 2) / 2, known - 1}) &&
           ages[steps + 1] - ages[steps] < LONGER * std::fabs(h))
      ++steps;
    const double back = steps > 0 ? -ages[steps] / std::fabs(h) : 0.0;
    lag = {from_trial * all.twice(back, 0.0), from_trial * all.once(back, 0.0)};
    lag_of_dropped = {from_dropped * more.twice(back, 0.0), from_dropped * more.once(back, 0.0)};
    if (k >= known) lag_of_dropped = {};
  }
  const CorrectorCoefficients &coefficients() const { return corrector; }

  /// The accelerations in a predicted history.
  using Row = std::array<double, Scheme::SECOND_WIDTH>;
  static Row accelerations(const double *rows)
  {
    Row row;
    std::copy_n(rows + 2 * Scheme::SECOND_WIDTH, Scheme::SECOND_WIDTH, row.begin());
    return row;
  }

  /// Integrator::correct(), and the errors of the step.  reach: displacement of the outermost part
  /// of the body per radian.
  Correction correct(const Integrator &integrator, const RigidBody &body, double reach,
                     const Load &load, const double *axes, double *rows, StepErrors &found) const
  {
    const Row before = accelerations(rows);
    const Correction correction = integrator.correct(body, load, axes, rows);
    Row dropped, change, place, rate;
    std::copy_n(trial_of(rows) + Scheme::SECOND_WIDTH, Scheme::SECOND_WIDTH, dropped.begin());
    found = errors(integrator, body, reach, load, axes, before, rows, change);
    for (int i = 0; i < Scheme::SECOND_WIDTH; ++i) {
      place[i] = lag[0] * change[i] - lag_of_dropped[0] * dropped[i];
      rate[i] = lag[1] * change[i] - lag_of_dropped[1] * dropped[i];
    }
    integrator.displace(body, place.data(), rate.data(), rows);
    return correction;
  }

  /// The errors of a step whose predicted accelerations were `before`.  axes: of any pose of the
  /// step.  change: of the trial row.
  StepErrors errors(const Integrator &integrator, const RigidBody &body, double reach,
                    const Load &load, const double *axes, const Row &before, double *rows) const
  {
    Row change;
    return errors(integrator, body, reach, load, axes, before, rows, change);
  }
  StepErrors errors(const Integrator &integrator, const RigidBody &body, double reach,
                    const Load &load, const double *axes, const Row &before, double *rows,
                    Row &change) const
  {
    double *trial = trial_of(rows), turn[3];
    const auto size = [&](const double *row) {
      return RememberedLoads::size(body, reach, axes, row);
    };
    const double *now = rows + 2 * Scheme::SECOND_WIDTH;
    Row residual;
    for (int i = 0; i < Scheme::SECOND_WIDTH; ++i) {
      residual[i] = now[i] - before[i];
      change[i] = to_trial * residual[i] - trial[i];
      trial[i] += change[i];
      trial[Scheme::SECOND_WIDTH + i] = 0.0;
    }
    StepErrors found;
    found.fewer = std::fabs(of_fewer) * size(rows + (k + 1) * Scheme::SECOND_WIDTH);
    found.more = std::fabs(of_more) * size(change.data());
    const double most = size(residual.data());
    found.same = std::fabs(corrector.c[1]) * most;
    found.length = std::fabs(corrector.c[0]) * most;

    const BodyState state = integrator.body_state(body, rows);
    Integrator::turn_of(body, axes, &residual[Scheme::ANGULAR_MOMENTUM], turn);
    const double way = GearQuat::length(residual.data()), per_h = 1.0 / integrator.step();
    double rates = body.mass * GearQuat::length(state.velocity) * way;
    for (int i = 0; i < 3; ++i) rates += body.inertia[i] * std::fabs(state.omega_body[i] * turn[i]);
    found.energy = std::fabs(corrector.c[0]) *
            (GearQuat::length(load.force) * way +
             GearQuat::length(load.torque_space) * GearQuat::length(turn)) +
        std::fabs(corrector.c[1] * per_h) * rates;
    return found;
  }

  /// The part of the errors that no step is short enough to remove: forces are evaluated at rounded
  /// coordinates.
  static StepErrors rounding(const Integrator &integrator, const RigidBody &body, double reach,
                             const Load &load, const double *rows)
  {
    constexpr double LAST_DIGIT = std::numeric_limits<double>::epsilon();
    const double *x = rows + Scheme::POSITION;
    const BodyState state = integrator.body_state(body, rows);
    StepErrors found;
    found.length =
        LAST_DIGIT * (std::max({std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])}) + reach);
    found.energy = found.length * GearQuat::length(load.force) +
        2.0 * LAST_DIGIT *
            (translational_energy(body, state.velocity) +
             rotational_energy(body, state.omega_body));
    return found;
  }

  /// A step of h is complete.
  void conclude(double h)
  {
    for (int j = std::min(known, (int) ages.size() - 1); j > 0; --j)
      ages[j] = ages[j - 1] + std::fabs(h);
    known = std::min(known + 1, (int) ages.size());
    compares = true;
  }

  /// The number of loads for which the last term has the least effect.
  int better(const StepErrors &errors) const
  {
    if (k < MOST_LOADS && of_more > 0.0 && errors.more < errors.same) return k + 1;
    return k > 2 && errors.same > errors.fewer ? k - 1 : k;
  }

  /// One load more, after a step, or one fewer, between steps of h.  each(act) calls act(rows) for
  /// all histories.
  template <class Each> void change(bool more, double h, Each each)
  {
    constexpr int WIDTH = Scheme::SECOND_WIDTH;
    const int n = values(), top = more ? n : n - 1;
    const Nodal nodes(ages, top - 2, h);
    double part[MOST_ROWS];    // of the top row in the rows below it
    for (int j = 2; j < top; ++j)
      part[j] = (more ? top : -top) * (top - 1) * nodes.scale * nodes.c[j - 2] / (j * (j - 1));
    each([&](double *rows) {
      double *behind = rows + n * WIDTH, *trial = trial_of(rows);
      const double *row = more ? behind : trial - WIDTH;
      if (more) {
        std::rotate(behind, trial, trial + WIDTH);
        std::fill_n(trial + WIDTH, MORE_ROWS * WIDTH, 0.0);
      } else {
        std::rotate(behind - WIDTH, behind, trial);    // the trial row becomes the dropped one
      }
      for (int j = 2; j < top; ++j)
        for (int i = 0; i < WIDTH; ++i) rows[j * WIDTH + i] += part[j] * row[i];
    });
    k += more ? 1 : -1;
    if (more) compares = false;
  }

  template <class V> void fields(V &v) { v(k, known, compares, ages); }

 private:
  int carries;
  int k = 1, known = 1;                            ///< loads; times
  bool compares = false;                           ///< trial rows are those of the last step
  std::array<double, MOST_LOADS + 1> ages = {};    ///< how long ago, the latest first

  // weights of the present step

  CorrectorCoefficients corrector;
  double to_trial = 0.0, of_fewer = 0.0, of_more = 0.0;
  std::array<double, 2> lag = {}, lag_of_dropped = {};    ///< of places, of rates

  /// The product of (s - s_j)/(1 - s_j) over the times s_j of the latest loads, where s is the time
  /// since the last load in units of h: 1 at the new load.
  struct Nodal {
    using Array = std::array<double, MOST_LOADS + 2>;
    int terms = 1;
    Array c = {1.0};
    double scale = 1.0;    ///< product of 1 - s_j

    Nodal(const std::array<double, MOST_LOADS + 1> &ages, int count, double h)
    {
      for (int k = 0; k < count; ++k, ++terms) {
        const double back = ages[std::min(k, MOST_LOADS)] / std::fabs(h), way = 1.0 + back;
        for (int j = terms; j > 0; --j) c[j] = (c[j - 1] + back * c[j]) / way;
        c[0] *= back / way;
        scale *= way;
      }
    }
    double once(double from, double to) const { return integral(c, terms, from, to); }
    /// Weighted by the time until the end of the step, or by its square.
    double twice(double from, double to) const { return weighted(1, from, to); }
    double thrice(double from, double to) const { return weighted(2, from, to); }
    Array about(double s) const
    {
      Array p = c;
      for (int i = 0; i + 1 < terms; ++i)
        for (int j = terms - 2; j >= i; --j) p[j] += s * p[j + 1];
      return p;
    }

   private:
    double weighted(int times, double from, double to) const
    {
      std::array<double, MOST_LOADS + 4> p = {};
      std::copy_n(c.begin(), terms, p.begin());
      for (int k = 1; k <= times; ++k)
        for (int j = terms + k - 1; j > 0; --j) p[j] -= p[j - 1];
      return integral(p, terms + times, from, to);
    }
    template <class P> static double integral(const P &p, int terms, double from, double to)
    {
      double a = 0.0, b = 0.0;
      for (int j = terms - 1; j >= 0; --j) {
        a = a * from + p[j] / (j + 1);
        b = b * to + p[j] / (j + 1);
      }
      return b * to - a * from;
    }
  };

  double *trial_of(double *rows) const
  {
    return rows + (values() + carries) * Scheme::SECOND_WIDTH;
  }

  /// The displacement of the outermost part of a body in a row.
  static double size(const RigidBody &body, double reach, const double *axes, const double *row)
  {
    double turn[3];
    Integrator::turn_of(body, axes, row + Scheme::ANGULAR_MOMENTUM, turn);
    return std::max(GearQuat::length(row), reach * GearQuat::length(turn));
  }
};

/// What limits the growth of the next step.
struct Growth {
  bool starts = true;     ///< the number of loads increases in every step
  bool failed = false;    ///< the present step was repeated

  template <class V> void fields(V &v) { v(starts, failed); }
};

/// The control law.  A step whose error exceeds eps fails; if the host can undo it, it repeats it
/// with a shorter one.
struct StepControl {
  static constexpr double SAFETY = 0.9;    ///< relative to a step with the error eps
  /// Limits of new step / old step: of an accepted step, of a start, and of a failed step.
  static constexpr double GROWTH = 1.3, GROWTH_OF_START = 3.0, SHRINK = 0.4;
  static constexpr double SHRINK_FAILED = 0.3, SHRINK_AT_LEAST = 0.8;
  /// A start ends with a step that should not grow by this factor.
  static constexpr double GROWS_FAST = 1.5;
  /// Part of the longest step that the motion allows.
  static constexpr double CLEAR_OF_LIMIT = 0.9;

  double eps = 0.0;                        ///< accepted error of a step, a length or an energy
  bool energy = false;                     ///< which of the two
  double shortest = 0.0, longest = 0.0;    ///< limits of the step; longest 0: none

  double error(const StepErrors &errors) const { return energy ? errors.energy : errors.length; }

  /// The errors that count: rounding does not decrease with the step.
  StepErrors counted(StepErrors errors, const StepErrors &rounding) const
  {
    const double part = eps / (eps + error(rounding));
    errors.length *= part;
    errors.energy *= part;
    return errors;
  }

  /// True if a step must be repeated with a shorter step.
  bool fails(double error, double step) const
  {
    return !(error <= eps) && std::fabs(step) > shortest;
  }

  /// The factor of the step for which the error becomes eps.
  double allowed(double error, int loads) const
  {
    return error > 0.0 ? std::pow(eps / error, 1.0 / (loads + 2 - energy)) : HUGE_VAL;
  }

  struct Next {
    double step;
    int loads;
    bool held;    ///< limited from below: the error requires a shorter step
  };

  /// Another try.
  Next repeat(double error, double step, int loads, Growth &growing) const
  {
    double ratio = SHRINK_FAILED;
    if (std::isfinite(error))
      ratio = std::clamp(SAFETY * allowed(error, loads), SHRINK_FAILED, SHRINK_AT_LEAST);
    const bool again = growing.failed;    // the loads are of little use
    growing = {false, true};
    return {std::copysign(std::max(shortest, ratio * std::fabs(step)), step),
            again && loads > 1 ? loads - 1 : loads, false};
  }

  /// The step after one with these errors.  farthest: longest step, for any errors.
  Next next(const StepErrors &errors, double step, const RememberedLoads &remembered,
            Growth &growing, double farthest = std::numeric_limits<double>::infinity()) const
  {
    const int now = remembered.loads();
    const double ratio = SAFETY * allowed(error(errors), now);
    const int loads = growing.starts ? std::min(now + 1, MOST_LOADS) : remembered.better(errors);
    growing.starts = growing.starts && ratio >= GROWS_FAST;
    const double growth = growing.failed ? 1.0 : growing.starts ? GROWTH_OF_START : GROWTH;
    growing.failed = false;
    const double before = std::fabs(step), clear = CLEAR_OF_LIMIT * farthest;
    double size = std::min(std::clamp(ratio, SHRINK, growth) * before,
                           before > farthest ? clear : std::max(clear, before));
    const bool held = size < shortest;
    size = std::max(size, shortest);
    if (longest > 0.0) size = std::min(size, longest);
    return {std::copysign(size, step), loads, held};
  }

  /// The step of a history without the third derivative of positions, `jerk`.
  double first_step(double jerk, double speed, double mass) const
  {
    if (!energy) return std::cbrt(6.0 * eps / jerk);
    const double rest = std::sqrt(2.0 * eps / mass);    // change of velocity with the energy eps,
                                                        // from rest
    return std::sqrt(2.0 / jerk * std::min(rest, speed > 0.0 ? eps / (mass * speed) : rest));
  }
};

/// Equal steps, at most as long as the given one, that end exactly at a time in the near future: a
/// shortened last step would be useless for the following steps.  way: time until then, positive.
inline double even_step(double step, double way)
{
  constexpr double FAR = 10.0, ROUNDING = 1.0e-9;
  const double size = std::fabs(step), number = way / size;
  if (!(number < FAR)) return step;
  return std::copysign(way / std::max(1.0, std::ceil(number - ROUNDING)), step);
}

}    // namespace LAMMPS_NS::GearQuat

#endif
