/* Correction::position_error and angle_error: their origin, their units, the power of the step, and
   a comparison with the true local error of a step, that is, the distance from the exact solution
   through the previous state. */

#include "oracles/exact_flow.h"
#include "oracles/gear_coefficients.h"
#include "scenes.h"

using namespace Drive;

namespace {

/// Root mean squares over a run.
struct Errors {
  double position, angle;              ///< estimated
  double true_position, true_angle;    ///< of each step, against the exact flow
};

Errors run(const RigidBody &body, const BodyState &start, const LoadOf &load, const Scheme &scheme,
           double h, int skip, int steps)
{
  const Oracle::ExactFlow flow(body, load);
  Motion motion(body, start, load, scheme, h, Start::BOOTSTRAP, std::min(h, 0.1));
  motion.steps(skip);    // until the effect of the start on the higher rows has decayed
  Errors sum = {};
  for (int n = 0; n < steps; ++n) {
    const BodyState before = motion.state(), exact = flow(before, h);
    const Correction estimate = motion.step();
    const BodyState after = motion.state();
    double dx[3], dq[4];
    for (int i = 0; i < 3; ++i) dx[i] = after.center[i] - exact.center[i];
    for (int i = 0; i < 4; ++i) dq[i] = after.q[i] - exact.q[i];
    sum.position += estimate.position_error() * estimate.position_error() / steps;
    sum.angle += estimate.angle_error() * estimate.angle_error() / steps;
    sum.true_position += dot3(dx, dx) / steps;
    sum.true_angle += 4.0 * dot4(dq, dq) / steps;    // a rotation by an angle moves q by half of it
  }
  for (double *x : {&sum.position, &sum.angle, &sum.true_position, &sum.true_angle})
    *x = std::sqrt(*x);
  return sum;
}

/// The oscillating, spinning top: x'' = -x, |omega| = 1.2.
Errors top_run(const Scheme &scheme, double h)
{
  return run(TOP, top_state(0.0), swing, scheme, h, 30, 60);
}

/// The weight from the oracle.
double weight(const Scheme &scheme)
{
  const int n = scheme.values();
  return (scheme.first() ? Oracle::first_order_error(n) : Oracle::second_order_local_error(n))
      .value();
}

/// Limit of estimate/true error for small h: for the second formulation a number; for the first,
/// whose estimate is one order less than its error, this number divided by h d/dt.
double limit(const Scheme &scheme)
{
  const int n = scheme.values();
  return weight(scheme) /
      (scheme.first() ? Oracle::first_order_local_error(n) : Oracle::second_order_local_error(n))
          .value();
}

}    // namespace

// --- definition

TEST(ErrorEstimate, IsTheWeightTimesTheResiduals)
{
  // c = 1 in the row of the equation, so the change of this row is the sum of the residuals
  for (int passes : {1, 3})
    for (Scheme scheme : every_scheme(passes, true)) {
      scheme.project = false;
      Motion motion(TOP, top_state(0.0), swing, scheme, 0.2, Start::BOOTSTRAP, 0.1);
      motion.steps(5);
      motion.predict();
      const vector<double> before = motion.history;
      const Correction c = motion.correct(swing(motion.state(), 1.0));
      const int row = scheme.width() * (scheme.first() ? 1 : 2);
      double dx[3], dq[4];
      for (int i = 0; i < 3; ++i) dx[i] = motion.rows[row + i] - before[row + i];
      for (int i = 0; i < 4; ++i) {
        const int k = row + scheme.quaternion() + i;
        dq[i] = motion.rows[k] - before[k];
      }
      EXPECT_NEAR(c.position_error() / (weight(scheme) * std::sqrt(dot3(dx, dx))), 1.0, 1e-5);
      EXPECT_NEAR(c.angle_error() / (2.0 * weight(scheme) * std::sqrt(dot4(dq, dq))), 1.0, 1e-5);
    }
}

// --- accuracy

TEST(ErrorEstimate, SecondFormulationAgainstTheTrueLocalError)
{
  // of the true error, in the limit of small steps
  for (const Scheme &scheme : schemes_of(SECOND, 2, true)) {
    const double h = scheme.values() > 10 ? 0.12 : 0.1;
    const Errors e = top_run(scheme, h), f = top_run(scheme, 0.75 * h);
    const double wide = e.position / e.true_position, narrow = f.position / f.true_position;
    const double r = (narrow - 0.5625 * wide) / (1.0 - 0.5625);    // without the term of h^2
    const bool rounding_is_near = scheme.values() > 10;
    EXPECT_NEAR(r / limit(scheme), 1.0, rounding_is_near ? 0.02 : 0.0045) << scheme;
    EXPECT_NEAR(f.angle / f.true_angle / limit(scheme), 1.0, 0.15) << scheme;
  }
}

TEST(ErrorEstimate, FirstFormulationAgainstTheTrueLocalError)
{
  // too large by a factor that grows as 1/h: the estimate has one order less
  for (const Scheme &scheme : schemes_of(FIRST, 2, true)) {
    const double h = scheme.values() > 6 ? 0.08 : 0.04;
    const Errors e = top_run(scheme, h), f = top_run(scheme, h / 2);
    const double wide = h * e.position / e.true_position,
                 narrow = h / 2 * f.position / f.true_position;
    EXPECT_NEAR((2 * narrow - wide) / limit(scheme), 1.0, 0.1) << scheme;
  }
}
