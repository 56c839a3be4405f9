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
      Check::relatively_near({c.position_error(), c.angle_error()},
                             {weight(scheme) * std::sqrt(dot3(dx, dx)),
                              2.0 * weight(scheme) * std::sqrt(dot4(dq, dq))},
                             1e-5);
    }
}

TEST(ErrorEstimate, IsALengthAndAnAngleInWhateverUnits)
{
  // the cage in other units: of mass, time and length
  const CageScene scene(1, true);
  auto largest = [&](const Scheme &scheme, double mass, double time, double length) {
    const double force = mass * length / (time * time);
    RigidBody body = scene.body;
    body.mass *= mass;
    for (double &moment : body.inertia) moment *= mass * length * length;
    BodyState start = scene.start;
    for (int i = 0; i < 3; ++i) {
      start.center[i] *= length;
      start.velocity[i] *= length / time;
      start.omega_body[i] /= time;
    }
    auto load = [&](const BodyState &s, double norm2) {
      BodyState plain = s;
      for (double &x : plain.center) x /= length;
      Load l = scene.load(plain, norm2);
      for (double &f : l.force) f *= force;
      for (double &t : l.torque_space) t *= force * length;
      return l;
    };
    const double h = 0.2 * time;
    Motion motion(body, start, load, scheme, h, Start::BOOTSTRAP, h);
    motion.steps(20);
    std::array<double, 2> worst = {};
    for (int n = 0; n < 20; ++n) {
      const Correction c = motion.step();
      worst = {std::max(worst[0], c.position_error()), std::max(worst[1], c.angle_error())};
    }
    return worst;
  };
  for (const Scheme &scheme : {scheme_of(FIRST), scheme_of(SECOND)}) {
    const auto plain = largest(scheme, 1.0, 1.0, 1.0);
    ASSERT_GT(plain[0], 1e-10);
    ASSERT_GT(plain[1], 1e-11);
    const double units[][3] = {{8.0, 1.0, 1.0}, {1.0, 0.25, 1.0}, {1.0, 1.0, 2.0}, {3.0, 7.0, 0.1}};
    for (const auto &u : units) {
      const auto e = largest(scheme, u[0], u[1], u[2]);
      Check::relatively_near({e[0], e[1]}, {u[2] * plain[0], plain[1]}, 1e-3);
    }
  }
}

TEST(ErrorEstimate, FallsWithThePowerN)
{
  for (const Scheme &scheme : every_scheme(2, true)) {
    const double h = scheme.values() > 10 ? 0.08 : 0.05;
    const Errors wide = top_run(scheme, 1.5 * h), narrow = top_run(scheme, h);
    EXPECT_NEAR(std::log(wide.position / narrow.position) / std::log(1.5), scheme.values(), 0.1)
        << scheme;
    EXPECT_NEAR(std::log(wide.angle / narrow.angle) / std::log(1.5), scheme.values(), 0.6)
        << scheme;
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
    if (scheme.values() > 10)                                      // rounding of the state is near
      EXPECT_NEAR(r / limit(scheme), 1.0, 0.02) << scheme;
    else
      Check::relatively_near({r}, {limit(scheme)}, 0.0045);
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

TEST(ErrorEstimate, FirstFormulationIsOnTheSafeSideUpToAFifthOfARadian)
{
  for (const Scheme &scheme : schemes_of(FIRST, 2, true)) {
    const double h = scheme.values() == 8 ? 0.1 : 0.2;    // 8: oscillates with noise beyond
    const Errors e = top_run(scheme, h);
    EXPECT_GT(e.position / e.true_position, 2.0) << scheme;
    EXPECT_GT(e.angle / e.true_angle, 2.0) << scheme;
  }
}

TEST(ErrorEstimate, InTheCage)
{
  const CageScene scene(1, true);
  for (const Scheme &scheme : every_scheme(1, true)) {
    const Errors e = run(scene.body, scene.start, scene, scheme, 0.2, 30, 150);
    const double x = e.position / e.true_position, angle = e.angle / e.true_angle;
    if (scheme.first()) {
      EXPECT_GT(x, 2.0) << scheme;
      EXPECT_GT(angle, 2.0) << scheme;
    } else {
      EXPECT_NEAR(x / limit(scheme), 1.0, 0.05) << scheme;
      EXPECT_NEAR(angle / limit(scheme), 1.0, 0.1) << scheme;
    }
  }
}
