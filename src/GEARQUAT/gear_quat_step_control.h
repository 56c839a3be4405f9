/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A step and a number of values that adapt to the error.

   After its n rows and their carries a history has a trial row, the row n of a history with one
   more value: a_n = h^n/n! y^(n).  It is computed from the change of the last row in a step.  Then

     error of a step with k values    e_k = gamma_(k-1) |h^k y^(k)| = gamma_(k-1) k! |a_k|

   is known for k = n - 1 from the last row, for n from the trial row, and for n + 1 from the change
   of the trial row.  e_n is the estimate of Integrator::correct() (exactly so with one pass).  When
   the number of values decreases, the last row becomes the trial row; when it increases, vice
   versa.

   Source: C. W. Gear, "Numerical Initial Value Problems in Ordinary Differential Equations" (1971),
   chapter 9, for the comparison of three orders.

   Once per step the host calls, for every body, correct() instead of Integrator::correct(), or
   last_row() and errors() around a correction of all bodies together.  It then calls
   StepControl::fails() with the largest errors of all bodies.  If the step fails, and the host has
   saved the histories, it restores them and repeats the step as given by StepControl::repeat().
   Otherwise it calls Steady::count() and StepControl::next().  If the number of values changes, it
   calls add_row() or drop_row() for every body, and finally Integrator::rescale(). */

#ifndef GEAR_QUAT_STEP_CONTROL_H
#define GEAR_QUAT_STEP_CONTROL_H

#include "gear_quat_chain.h"
#include "gear_quat_integrator.h"

#include <algorithm>
#include <array>
#include <limits>

namespace LAMMPS_NS::GearQuat {

/// Largest number of values with which a shrinking step is stable
/// (tests/unit/test_step_control.cpp).
constexpr int VARIABLE_MOST = 10;

/// Local errors of a step with one value fewer, the present number, and one more.
struct StepErrors {
  double fewer = 0.0, same = 0.0, more = 0.0;

  void include(const StepErrors &other)
  {
    fewer = std::max(fewer, other.fewer);
    same = std::max(same, other.same);
    more = std::max(more, other.more);
  }
};

/// Errors as a length: of the position, or of the orientation times the reach of the body,
/// whichever is larger.  Errors as an energy: the largest change of energy due to the errors of
/// position, orientation and velocities.
struct StepMeasures {
  StepErrors length, energy;
  struct Rounding {
    double length = 0.0, energy = 0.0;
  } rounding;    ///< part of the errors that is due to rounding of the state of a body

  void include(const StepMeasures &other)
  {
    length.include(other.length);
    energy.include(other.energy);
  }
};

/// Histories with a trial row; the scheme has the present number of values.
class VariableOrder {
 public:
  explicit VariableOrder(const Scheme &scheme) : scheme(scheme), n(scheme.values())
  {
    double factorial = 1.0;
    for (int k = 2; k < n; ++k) factorial *= k;
    fewer = weights(n - 1, factorial);
    same = weights(n, factorial * n);
    more = weights(n + 1, factorial * n);    // the change is one of a row n, not n + 1
    chain = {adams_moulton(n - 1).value(), adams_moulton(n).value(), adams_moulton(n + 1).value()};
  }

  /// Integrator::correct(), and the errors of the completed step.  reach: displacement of the
  /// outermost part of the body per radian.
  Correction correct(const Integrator &integrator, const RigidBody &body, double reach,
                     const Load &load, const double *axes, double *rows, StepMeasures &found) const
  {
    const Row before = last_row(rows);
    const Correction correction = integrator.correct(body, load, axes, rows);
    found = errors(integrator, body, reach, load, axes, before, rows);
    return correction;
  }

  /// The last row of a predicted history.
  using Row = std::array<double, Scheme::FIRST_WIDTH>;
  Row last_row(const double *rows) const
  {
    Row row;
    std::copy_n(rows + (n - 1) * scheme.width(), scheme.width(), row.begin());
    return row;
  }

  /// The errors of the step of a history that was corrected since last_row().  After the call it
  /// has a trial row.  axes: of any pose of the step.
  StepMeasures errors(const Integrator &integrator, const RigidBody &body, double reach,
                      const Load &load, const double *axes, const Row &before, double *rows) const
  {
    const double *last = rows + (n - 1) * scheme.width();
    double *trial = rows + scheme.trial_row(), change[Scheme::FIRST_WIDTH];
    for (int i = 0; i < scheme.width(); ++i) {
      const double found = (last[i] - before[i]) / n;
      change[i] = found - trial[i];
      trial[i] = found;
    }
    StepMeasures errors;
    const Worth worth = worth_of(integrator, body, load, axes, rows);
    errors.length = {fewer.pose * size(worth, last, reach), same.pose * size(worth, trial, reach),
                     more.pose * size(worth, change, reach)};
    errors.energy = {energy(worth, fewer, last), energy(worth, same, trial),
                     energy(worth, more, change)};
    errors.rounding = rounding(worth, reach, rows);
    return errors;
  }

  /// The part of the errors of a step that no step is short enough to remove.
  StepMeasures::Rounding rounding(const Integrator &integrator, const RigidBody &body, double reach,
                                  const Load &load, const double *axes, const double *rows) const
  {
    return rounding(worth_of(integrator, body, load, axes, rows), reach, rows);
  }

  /// Errors of a step from the rows alone, for the present number of values.
  StepMeasures measures(const Integrator &integrator, const RigidBody &body, double reach,
                        const Load &load, const double *axes, const double *rows) const
  {
    const double *trial = rows + scheme.trial_row();
    const Worth worth = worth_of(integrator, body, load, axes, rows);
    StepMeasures errors;
    errors.length.same = same.pose * size(worth, trial, reach);
    errors.energy.same = energy(worth, same, trial);
    return errors;
  }

  /// The effect of the error of a chain in this step on a body of this mass in thermal motion: an
  /// error d of the friction causes the error h d v of a velocity v.  A cold body is insensitive to
  /// the friction, so its errors do not show whether the chain is accurate.  left_out: by the
  /// polynomial through 2K.
  StepMeasures errors_of_chain(const Chain::LeftOut &left_out, double kt, double mass,
                               double h) const
  {
    const double way = h * h * std::sqrt(3.0 * kt / mass), worth = std::fabs(h) * 3.0 * kt;
    const StepErrors errors = {chain.fewer * left_out.fewer, chain.same * left_out.same,
                               chain.more * left_out.more};
    StepMeasures found;
    found.length = {way * errors.fewer, way * errors.same, way * errors.more};
    found.energy = {worth * errors.fewer, worth * errors.same, worth * errors.more};
    return found;
  }

  /// One value more.  After the call there are the rows of n + 1 values; the trial row is zero
  /// until the next step.
  void add_row(double *rows) const
  {
    const int width = scheme.width();
    double *behind = rows + n * width, *trial = rows + scheme.trial_row();
    double row[Scheme::FIRST_WIDTH];
    std::copy_n(trial, width, row);
    std::copy_backward(behind, trial, trial + width);
    std::copy_n(row, width, behind);
    std::fill_n(trial + width, width, 0.0);
  }

  /// One value fewer.
  void drop_row(double *rows) const
  {
    const int width = scheme.width();
    double *last = rows + (n - 1) * width, *trial = rows + scheme.trial_row();
    double row[Scheme::FIRST_WIDTH];
    std::copy_n(last, width, row);
    std::copy(last + width, trial, last);
    std::copy_n(row, width, trial - width);
  }

 private:
  /// k! gamma divided by the measured part of a_k: for poses, and for velocities times the step.
  /// In the second formulation velocities have one value less.
  struct Weights {
    double pose, rate;
  };
  /// Change of energy per unit of error; rates: of the velocities times the step.
  struct Worth {
    double position, rate, angle, turn[3], q[4], norm2, twice_kinetic;
    double axes[9], per_inertia[3];
  };
  static constexpr double LAST_DIGIT = std::numeric_limits<double>::epsilon();

  Scheme scheme;
  int n;
  Weights fewer, same, more;
  StepErrors chain;    ///< weights of the terms not represented by a polynomial of 2K

  Weights weights(int k, double factorial) const
  {
    return {factorial * adams_moulton(k - 1).value(),
            factorial * adams_moulton(scheme.first() ? k - 1 : k - 2).value()};
  }

  double size(const Worth &worth, const double *row, double reach) const
  {
    const double *x = row + Scheme::POSITION, *q = row + scheme.quaternion();
    if (!scheme.momentum()) return std::max(length(x), 2.0 * reach * std::sqrt(dot4(q, q)));
    double turn[3];
    angle_of(worth, row, turn);
    return std::max(length(x), reach * length(turn));
  }

  /// The rotation in a row, along the principal axes.
  void angle_of(const Worth &worth, const double *row, double *turn) const
  {
    if (!scheme.momentum())
      return angular_velocity(worth.q, worth.norm2, row + scheme.quaternion(), turn);
    to_body(worth.axes, row + Scheme::ANGULAR_MOMENTUM, turn);
    for (int i = 0; i < 3; ++i) turn[i] *= worth.per_inertia[i];
  }

  /// Forces are evaluated at rounded coordinates, so the energy has an error of the rounding times
  /// the force, for any length of the step.
  double rounding_of_sites(double reach, const double *rows) const
  {
    const double *x = rows + Scheme::POSITION;
    return LAST_DIGIT * (std::max({std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])}) + reach);
  }

  StepMeasures::Rounding rounding(const Worth &worth, double reach, const double *rows) const
  {
    const double of_sites = rounding_of_sites(reach, rows);
    return {of_sites, worth.position * of_sites + LAST_DIGIT * worth.twice_kinetic};
  }

  Worth worth_of(const Integrator &integrator, const RigidBody &body, const Load &load,
                 const double *axes, const double *rows) const
  {
    const BodyState state = integrator.body_state(body, rows);
    const double per_h = 1.0 / std::fabs(integrator.step());
    Worth worth;
    double torque_body[3];
    to_body(axes, load.torque_space, torque_body);
    worth.position = length(load.force);
    worth.angle = length(torque_body);
    worth.rate = length(state.velocity) * (scheme.first() ? 1.0 : body.mass * per_h);
    for (int i = 0; i < 3; ++i)
      worth.turn[i] =
          body.inertia[i] * std::fabs(state.omega_body[i]) * (scheme.first() ? 1.0 : per_h);
    worth.twice_kinetic = body.mass * dot3(state.velocity, state.velocity);
    for (int i = 0; i < 3; ++i)
      worth.twice_kinetic += body.inertia[i] * state.omega_body[i] * state.omega_body[i];
    std::copy_n(axes, 9, worth.axes);
    inverse_moments(body, worth.per_inertia);
    std::copy_n(state.q, 4, worth.q);
    worth.norm2 = scheme.norm2(state.q);
    return worth;
  }

  double energy(const Worth &worth, const Weights &weights, const double *row) const
  {
    const double *x = row + Scheme::POSITION;
    double turn[3], sum = 0.0;
    angle_of(worth, row, turn);
    const double pose = worth.position * length(x) + worth.angle * length(turn);
    const double *p = scheme.first() ? row + Scheme::MOMENTUM : x;
    const double *w = scheme.first() ? row + Scheme::OMEGA : turn;
    for (int i = 0; i < 3; ++i) sum += worth.turn[i] * std::fabs(w[i]);
    return weights.pose * pose + weights.rate * (worth.rate * length(p) + sum);
  }
};

/// Steps made so far with the present number of values, with the present length, and since the last
/// repetition.
struct Steady {
  int values = 0, step = 0, repeat = 0;

  template <class V> void fields(V &v) { v(values, step, repeat); }
  void count()
  {
    for (int *one : {&values, &step, &repeat}) *one = std::min(*one + 1, FOR_LONG);
  }

  static constexpr int FOR_LONG = 1000000;
};

/// The control law.  A step whose error exceeds eps fails; if the host can undo it, it calls
/// repeat() for another length.
class StepControl {
 public:
  static constexpr double SAFETY = 0.9;    ///< relative to a step with the error eps
  /// Limits of new step / old step.  For a growing step the limit is a factor of the last row,
  /// since the errors of the rows grow with it.  The step grows once in as many steps as there are
  /// values.
  static constexpr double GROWTH_OF_LAST_ROW = 25.0, SHRINK = 0.5, SHRINK_FAILED = 0.2;
  static double largest_growth(int values)
  {
    return std::pow(GROWTH_OF_LAST_ROW, 1.0 / (values - 1));
  }
  /// Between these ratios nothing changes, to avoid rescaling the rows in every step.
  static constexpr double NO_SHORTER = 0.97, NO_LONGER = 1.1;
  /// Factor applied to the longest step that the motion allows, whenever a step is limited by it.
  static constexpr double CLEAR_OF_LIMIT = 0.9;
  /// A change of the number of values requires an error that is smaller by this factor.
  static constexpr double FEWER = 2.0, MORE = 3.0;
  /// After this many steps per value with the same number of values, one more value requires only a
  /// smaller error.  In a uniform rotation the derivatives of even order do not turn the body, so
  /// with an even number of values the next error is about as large as the present one, and only
  /// the one after it is much smaller.
  static constexpr int PATIENCE = 25;
  /// If the step does not change, another value requires that the step could be longer by this
  /// factor.
  static constexpr double CLEARLY_MORE = 1.02;
  /// If a step fails within this many steps of another failure, the rows are unusable.
  static constexpr int SOON = 4;
  /// With ten values, errors of rows grow if each step is shorter by a factor of 0.78 to 0.88, and
  /// decay for this factor and larger factors.  An accepted step is therefore not made much shorter
  /// within this many steps of another change.
  static constexpr double GENTLE = 0.95;
  static constexpr int FADED = 5;

  double eps = 0.0;                        ///< accepted error of a step, a length or an energy
  bool energy = false;                     ///< which of the two
  double shortest = 0.0, longest = 0.0;    ///< limits of the step; longest 0: none
  int fewest = 0, most = 0;                ///< limits of the number of values
  /// Difference between the number of values and the order of the error in the step: 1 for energies
  /// in the second formulation, whose velocities have one value less.
  int short_of = 0;

  struct Next {
    double step;    ///< with the sign of the current step
    int values;
    bool held;    ///< limited from below: the error requires a shorter step
  };

  /// Errors of a body that count, after subtraction of rounding: no step is short enough to remove
  /// rounding.
  StepMeasures counted(StepMeasures of_body) const
  {
    StepErrors &errors = energy ? of_body.energy : of_body.length;
    const double rounding = energy ? of_body.rounding.energy : of_body.rounding.length;
    for (double *one : {&errors.fewer, &errors.same, &errors.more}) *one *= eps / (eps + rounding);
    return of_body;
  }

  const StepErrors &measured(const StepMeasures &both) const
  {
    return energy ? both.energy : both.length;
  }

  /// True if a step must be repeated with a shorter step.
  bool fails(double error, double step) const
  {
    return !(error <= eps) && std::fabs(step) > shortest;
  }

  /// Length and number of values of another try.
  Next repeat(double error, double step, int values, const Steady &steady) const
  {
    const bool again = steady.repeat < SOON;
    double ratio = SHRINK_FAILED;
    if (std::isfinite(error))
      ratio = std::max(ratio,
                       std::min(again ? SHRINK : SAFETY, SAFETY * SAFETY * allowed(error, values)));
    const double size = std::max(shortest, ratio * std::fabs(step));
    return {std::copysign(size, step), again && values > fewest ? values - 1 : values, false};
  }

  /// step, values: of the step with these errors.  farthest: upper limit of the step, for any
  /// errors.  Numbers of values are compared by the steps that they allow, up to the limit of
  /// growth.
  Next next(const StepErrors &errors, double step, int values, const Steady &steady,
            double farthest = std::numeric_limits<double>::infinity()) const
  {
    Next choice = {step, values, false};
    const double growth = std::min(steady.step, steady.repeat) > values ? largest_growth(values)
                                                                        : 1.0;
    const double same = std::min(growth, SAFETY * allowed(errors.same, values));
    double ratio = same;
    if (values > fewest) {
      const double fewer = std::min(growth, SAFETY * allowed(FEWER * errors.fewer, values - 1));
      if (fewer > same) {
        ratio = fewer;
        choice.values = values - 1;
      }
    }
    if (values < most && steady.values > values) {
      const double factor = steady.values > PATIENCE * values ? 1.0 : MORE;
      const double more = std::min(growth, SAFETY * allowed(factor * errors.more, values + 1));
      if (more > ratio) {
        ratio = more;
        choice.values = values + 1;
      }
    }
    double size = std::fabs(step);
    const bool recent = steady.step < FADED, holds = errors.same <= eps;
    if (ratio < NO_SHORTER)
      size *= std::max(recent && holds ? GENTLE : SHRINK, ratio);
    else if (ratio > NO_LONGER)
      size *= ratio;
    else if (choice.values < values || ratio < CLEARLY_MORE * same)
      choice.values = values;
    if (recent && !holds && values > fewest) choice.values = values - 1;    // it was not repeated
    if (size > farthest || (ratio > NO_LONGER && size > CLEAR_OF_LIMIT * farthest))
      size = std::min(
          size,
          std::max(CLEAR_OF_LIMIT * farthest, std::fabs(step) > farthest ? 0.0 : std::fabs(step)));
    choice.held = size < shortest;
    size = std::max(size, shortest);
    if (longest > 0.0) size = std::min(size, longest);
    choice.step = std::copysign(size, step);
    return choice;
  }

  /// The step of a history without the third derivative of positions, `jerk`.
  double low_order_step(double jerk, double speed, double mass) const
  {
    if (!energy) return std::cbrt(6.0 * eps / jerk);
    const double rest = std::sqrt(2.0 * eps / mass);    // change of velocity with the energy eps,
                                                        // from rest
    return std::sqrt(2.0 / jerk * std::min(rest, speed > 0.0 ? eps / (mass * speed) : rest));
  }

  /// The factor of the step for which the error becomes eps.
  double allowed(double error, int values) const
  {
    return error > 0.0 ? std::pow(eps / error, 1.0 / (values - short_of)) : HUGE_VAL;
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
