/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A step and a number of values that follow the error.

   Behind its n rows and their carries a history has a trial row, the row n it would have with one
   value more:  a_n = h^n/n! y^(n),  found from how the last row changes in a step.  Then

     error of a step with k values    e_k = gamma_(k-1) |h^k y^(k)| = gamma_(k-1) k! |a_k|

   is known for k = n - 1 from the last row, for n from the trial row, and for n + 1 from the change
   of the trial row.  e_n is the estimate of Integrator::correct() (with one pass exactly).  A row less
   makes the last row the trial row, a row more the trial row the last one.
   Source: C. W. Gear, "Numerical Initial Value Problems in Ordinary Differential Equations" (1971),
   chapter 9, for the comparison of three orders.

   The host calls, for every body and once a step: correct() in place of Integrator::correct(); then,
   with the largest errors of all bodies, StepControl::next(); if values change, add_row() or
   drop_row() for every body; then Integrator::rescale(). */

#ifndef GEAR_QUAT_STEP_CONTROL_H
#define GEAR_QUAT_STEP_CONTROL_H

#include "gear_quat_integrator.h"

#include <algorithm>
#include <limits>

namespace LAMMPS_NS::GearQuat {

/// Largest values with which a shrinking step is stable: from 11 on the rescaled rows of the
/// second-order form grow by themselves (tests/unit/test_step_control.cpp).
constexpr int VARIABLE_MOST = 10;

/// Local errors (lengths: of the position, or of the orientation times the reach of the body, whichever
/// is larger) with one value fewer, the present number,
/// one more.
struct StepErrors {
  double fewer = 0.0, same = 0.0, more = 0.0;

  void include(const StepErrors &other)
  {
    fewer = std::max(fewer, other.fewer);
    same = std::max(same, other.same);
    more = std::max(more, other.more);
  }
};

/// Histories with a trial row; the scheme's number of values is the present one.
class VariableOrder {
 public:
  explicit VariableOrder(const Scheme &scheme) : scheme(scheme), n(scheme.values())
  {
    double factorial = 1.0;
    for (int k = 1; k <= n; ++k) factorial *= k;
    fewer = adams_moulton(n - 2).value() * factorial / n;
    same = adams_moulton(n - 1).value() * factorial;
    more = adams_moulton(n).value() * factorial;
  }

  /// Integrator::correct(), and the errors of the step that ends with it.  reach: how far a rotation
  /// by a radian moves what is far out on the body.
  Correction correct(const Integrator &integrator, const RigidBody &body, double reach,
                     const Load &load, const double *axes, double *rows, StepErrors &errors) const
  {
    const double *last = rows + (n - 1) * scheme.width();
    double *trial = rows + scheme.trial_row();
    double before[Scheme::FIRST_WIDTH], change[Scheme::FIRST_WIDTH];
    std::copy_n(last, scheme.width(), before);
    const Correction correction = integrator.correct(body, load, axes, rows);
    for (int i = 0; i < scheme.width(); ++i) {
      const double found = (last[i] - before[i]) / n;
      change[i] = found - trial[i];
      trial[i] = found;
    }
    errors = {fewer * size(last, reach), same * size(trial, reach), more * size(change, reach)};
    return correction;
  }

  /// Error of a step from the rows alone.
  double error(const double *rows, double reach) const
  {
    return same * size(rows + scheme.trial_row(), reach);
  }

  /// One value more.  After the call the rows are those of n + 1 values; their trial row is zero
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
  Scheme scheme;
  int n;
  double fewer, same, more;    ///< gamma_(k-1) k! / the part of a_k that is measured

  double size(const double *row, double reach) const
  {
    const double *x = row + Scheme::POSITION, *q = row + scheme.quaternion();
    return std::max(length(x), 2.0 * reach * std::sqrt(dot4(q, q)));
  }
};

/// The law.  No step can be redone, so growth is held back.
class StepControl {
 public:
  static constexpr double GROWTH = 1.05, SHRINK = 0.5;    ///< limits of new step / old step
  /// What an other number of values has to promise: an error smaller by this.
  static constexpr double FEWER = 4.0, MORE = 10.0;

  double eps = 0.0;                        ///< error a step may make
  double shortest = 0.0, longest = 0.0;    ///< limits of the step; longest 0: none
  int fewest = 0, most = 0;                ///< limits of the number of values

  struct Next {
    double step;    ///< with the sign of the present one
    int values;
    bool held;    ///< would be shorter, but for the limit
  };

  /// step, values: of the step that made these errors.  steady: steps made with that number.
  /// farthest: the step is not longer, whatever the errors are.  Numbers of values are compared by
  /// what they allow as far as a step may grow.
  Next next(const StepErrors &errors, double step, int values, int steady,
            double farthest = std::numeric_limits<double>::infinity()) const
  {
    Next choice = {step, values, false};
    const double same = std::min(GROWTH, allowed(errors.same, values));
    double ratio = same;
    if (values > fewest) {
      const double fewer = std::min(GROWTH, allowed(FEWER * errors.fewer, values - 1));
      if (fewer > same) {
        ratio = fewer;
        choice.values = values - 1;
      }
    }
    if (values < most && steady > values) {
      const double more = std::min(GROWTH, allowed(MORE * errors.more, values + 1));
      if (more > ratio) {
        ratio = more;
        choice.values = values + 1;
      }
    }
    double size = std::min(farthest, std::fabs(step) * std::max(SHRINK, ratio));
    choice.held = size < shortest;
    size = std::max(size, shortest);
    if (longest > 0.0) size = std::min(size, longest);
    choice.step = std::copysign(size, step);
    return choice;
  }

  /// By what factor the step may change so that the error becomes eps.
  double allowed(double error, int values) const
  {
    return error > 0.0 ? std::pow(eps / error, 1.0 / values) : 2.0 * GROWTH;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
