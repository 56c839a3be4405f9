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
#include <functional>
#include <limits>

namespace LAMMPS_NS::GearQuat {

/// Of a step of one body, or the largest of all bodies.
struct StepErrors {
  double error = 0.0;    ///< in the measure of the tolerance
  /// The effect of the last term of the polynomial with one load fewer, as many, and one more.
  double fewer = 0.0, same = 0.0, more = 0.0;

  void include(const StepErrors &other)
  {
    error = std::max(error, other.error);
    fewer = std::max(fewer, other.fewer);
    same = std::max(same, other.same);
    more = std::max(more, other.more);
  }
};

struct StepControl;

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
    scheme.method = Method::ADAMS;
    return scheme;
  }

  /// Only the present load is known; or as many at equal intervals.
  void begin(int loads = 1, double interval = 0.0);

  int loads() const { return k; }
  /// Rows of a history.
  int values() const { return k + 2; }

  /// The weights for a step of h.
  void prepare(double h);
  const CorrectorCoefficients &coefficients() const { return corrector; }

  /// The accelerations in a predicted history.
  using Row = std::array<double, Scheme::SECOND_WIDTH>;
  static Row accelerations(const double *rows)
  {
    Row row;
    std::copy_n(rows + 2 * Scheme::SECOND_WIDTH, Scheme::SECOND_WIDTH, row.begin());
    return row;
  }

  /// What happens to the last steps when a body is corrected.  A bath depends on all poses: KEPT.
  enum class Last { KEPT, INTEGRATED_AGAIN };

  /// The errors of a step whose predicted accelerations were `before`, after Integrator::correct().
  /// reach: displacement of the outermost part of the body per radian.  axes: of any pose of the step.
  StepErrors finish(const StepControl &control, const Integrator &integrator, const RigidBody &body,
                    double reach, const Load &load, const double *axes, const Row &before,
                    double *rows, Last last = Last::INTEGRATED_AGAIN) const;

  /// A step of h is complete.
  void conclude(double h);

  /// The number of loads for which the last term has the least effect.
  int better(const StepErrors &errors) const
  {
    if (k < MOST_LOADS && of_more > 0.0 && errors.more < errors.same) return k + 1;
    return k > 2 && errors.same > errors.fewer ? k - 1 : k;
  }

  /// One load more, after a step, or one fewer, between steps of h.  each(act) calls act(rows) for
  /// all histories.
  using Act = std::function<void(double *)>;
  void change(bool more, double h, const std::function<void(const Act &)> &each);

  template <class V> void fields(V &v) { v(k, known, compares, ages); }

 private:
  using Ages = std::array<double, MOST_LOADS + 1>;
  int carries;
  int k = 1, known = 1;     ///< loads; times
  bool compares = false;    ///< trial rows are those of the last step
  Ages ages = {};           ///< how long ago, the latest first

  // weights of the present step

  CorrectorCoefficients corrector;
  double to_trial = 0.0, of_fewer = 0.0, of_more = 0.0;
  std::array<double, 2> lag = {}, lag_of_dropped = {};    ///< of places, of rates

  double *trial_of(double *rows) const
  {
    return rows + (values() + carries) * Scheme::SECOND_WIDTH;
  }
};

/// What limits the growth of the next step.  START: the number of loads increases in every step;
/// FAILED: the present step was repeated.
enum class Growth { START, STEADY, FAILED };

/// The control law.  A step whose error exceeds eps fails; if the host can undo it, it repeats it
/// with a shorter one.  An error is a length, of the position or of the orientation times the reach
/// of the body, whichever is larger; or an energy, the change due to the errors of pose and velocities.
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

  /// The part of the error of a corrected body that counts.  No step is short enough to remove the
  /// rest: forces are evaluated at rounded coordinates.
  double counted(const Integrator &integrator, const RigidBody &body, double reach,
                 const Load &load, const double *rows) const;

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
  };

  /// Another try.
  Next repeat(double error, double step, int loads, Growth &growing) const;

  /// The step after one with these errors; `shortest` if they require a shorter one.  farthest:
  /// longest step, for any errors.
  Next next(const StepErrors &errors, double step, const RememberedLoads &remembered,
            Growth &growing, double farthest = std::numeric_limits<double>::infinity()) const;

  /// The step of a history without the third derivative of positions, `jerk`.
  double first_step(double jerk, double speed, double mass) const;
};

/// Equal steps, at most as long as the given one, that end exactly at a time in the near future: a
/// shortened last step would be useless for the following steps.  way: time until then, positive.
double even_step(double step, double way);

}    // namespace LAMMPS_NS::GearQuat

#endif
