/* Remembered loads: their polynomial, the choice of step and order, and the results in the paper's
   cage. */

#include "checks.h"
#include "follow.h"
#include "scenes.h"

using namespace Drive;

namespace {

/// The body of the paper's cage.
struct Following : Follower {
  CageScene scene;

  Following(double eps, double first_step) :
      Follower(eps, false, first_step, {{CageScene(1, true).body, 1.0}}, {}), scene(1, true)
  {
    loads = [this](const vector<One> &ones) {
      return vector<Load>{scene.load(ones[0].state, 1.0)};
    };
    bodies[0].state = scene.start;
    begin();
  }
  Following(const Following &) = delete;

  double *rows() { return bodies[0].rows.data(); }
  BodyState state() const { return bodies[0].state; }

  /// Returns the largest error of the energy.
  double run(double end)
  {
    const double e0 = scene.total_energy(scene.start);
    double worst = 0.0;
    Follower::run(end, [&] {
      worst = std::max(worst, std::fabs(scene.total_energy(state()) - e0));
    });
    return worst;
  }
};

/// Steps of different lengths, with `loads` loads, if it can have as many.
template <class Seen> void vary(Follower &follower, int loads, double h, int steps, Seen seen)
{
  const double ratios[] = {1.0, 1.3, 0.8, 0.5, 1.2, 0.9};
  for (int n = 0; n < steps; ++n) {
    follower.step();
    seen();
    const int now = follower.remembered.loads();
    follower.change({h * ratios[n % 6], now < loads ? now + 1 : now > loads ? now - 1 : now});
  }
}

/// A body on which a force acts that is a function of time.
Follower driven(double h, const std::function<double(double)> &force)
{
  BodyState start = {};
  start.q[3] = 1.0;
  return {1.0,
          false,
          h,
          {{{2.0, {0.7, 1.1, 1.3}}, 0.5, start}},
          [=](const vector<Follower::One> &ones) {
            Load load = {};
            load.force[1] = force(ones[0].state.center[0]);    // this coordinate is the time
            return vector<Load>{load};
          }};
}

}    // namespace

TEST(RememberedLoads, LoadsThatArePolynomialsHaveNoError)
{
  for (const int loads : {1, 2, 3, 5, 8, 13}) {
    // the force is t^(loads - 1), and the first coordinate is the time
    Follower follower = driven(0.1, [loads](double t) {
      return std::pow(t, loads - 1);
    });
    follower.bodies[0].state.velocity[0] = 1.0;
    follower.control.eps = 1e30;
    follower.begin();
    vary(follower, loads, 0.1, 40, [] {
    });
    const double t0 = follower.t;
    const BodyState before = follower.bodies[0].state;
    vary(follower, loads, 0.1, 20, [] {
    });
    const BodyState &after = follower.bodies[0].state;
    const auto rate = [loads](double t) {
      return std::pow(t, loads) / (2.0 * loads);
    };
    const double change = rate(follower.t) - rate(t0);
    EXPECT_NEAR((after.velocity[1] - before.velocity[1]) / change, 1.0, 1e-9) << loads;
  }
}

TEST(RememberedLoads, FreeRotationIsExact)
{
  RigidBody body = {2.0, {0.5, 0.9, 1.2}};
  BodyState start = {};
  start.q[3] = 1.0;
  start.omega_body[0] = 0.3;
  start.omega_body[1] = 2.0;
  start.omega_body[2] = 0.2;
  const auto end = [&](double step) {
    Follower follower(1e30, false, step, {{body, 1.0, start}}, [](const vector<Follower::One> &) {
      return vector<Load>(1);
    });
    follower.control.shortest = follower.control.longest = step;
    follower.begin();
    follower.run(20.0, [] {
    });
    return follower.bodies[0].state;
  };
  const BodyState fine = end(0.05);
  for (const double step : {0.4, 4.0, 20.0}) {    // up to 40 radians
    const BodyState coarse = end(step);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(coarse.q[i], fine.q[i], 3e-13);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(coarse.omega_body[i], fine.omega_body[i], 1e-12);
  }
}

TEST(RememberedLoads, OrdersOfErrors)
{
  // with k loads a position has an error of h^(k + 1)
  for (const int loads : {2, 3, 4, 5, 6}) {
    const auto missed = [&](double h) {
      Follower follower = driven(h, [](double t) {
        return std::cos(t);
      });
      follower.bodies[0].state.velocity[0] = 1.0;
      follower.control.eps = 1e30;
      follower.begin();
      follower.set_step(1e-4 * h);
      while (follower.t < 10.0) {
        follower.step();
        follower.change(
            {std::min(h, 1.3 * follower.h), std::min(loads, follower.remembered.loads() + 1)});
      }
      const BodyState &s = follower.bodies[0].state;
      return std::fabs(s.velocity[1] - 0.5 * std::sin(s.center[0]));
    };
    const double slope = 0.5 * std::log2(missed(0.4) / missed(0.1));
    EXPECT_GT(slope, loads + 0.5) << loads;
    EXPECT_LT(slope, loads + 2.0) << loads;
  }
}

TEST(RememberedLoads, OneLoadIsNotVelocityVerlet)
{
  // which has as many rows, and shows the forces velocities of half a step before
  const Scheme one = RememberedLoads::scheme(false);
  EXPECT_EQ(one.values(), VERLET);
  EXPECT_FALSE(one.is_verlet());
  EXPECT_TRUE(scheme_of(MOMENTUM, VERLET).is_verlet());
}

TEST(RememberedLoads, LoadsComeAndGoWithoutAnError)
{
  Following body(1e-9, 0.05);
  for (int n = 0; n < 60; ++n) body.follow(body.step());
  const int loads = body.remembered.loads();
  ASSERT_GT(loads, 5);
  const vector<double> before = body.bodies[0].rows;
  const double h = body.h;
  for (const bool more : {false, true})
    body.remembered.change(more, h, [&](const auto &act) {
      act(body.rows());
    });
  EXPECT_EQ(body.remembered.loads(), loads);
  const int size = (loads + 2) * Scheme::SECOND_WIDTH;
  EXPECT_LT(Check::largest_difference(body.rows(), before.data(), size), 1e-15);
}

TEST(StepControl, TheLaw)
{
  StepControl control;
  control.eps = 1e-6;
  const double big = 1e30;
  RememberedLoads remembered(true);
  const auto next = [&](double error, double step, Growth growing = Growth::STEADY) {
    StepErrors errors;
    errors.error = error;
    return control.next(errors, step, remembered, growing);
  };
  // the error of a step that could be longer by this factor
  const auto error = [&](double ratio) {
    return 1e-6 * std::pow(StepControl::SAFETY / ratio, 3);
  };
  EXPECT_DOUBLE_EQ(next(error(0.8), 0.1).step, 0.08);
  EXPECT_DOUBLE_EQ(next(error(1.2), 0.1).step, 0.12);
  EXPECT_DOUBLE_EQ(next(0.0, 0.1).step, 0.1 * StepControl::GROWTH);
  EXPECT_DOUBLE_EQ(next(big, -0.1).step, -0.1 * StepControl::SHRINK);
  EXPECT_DOUBLE_EQ(next(0.0, 0.1, Growth::START).step, 0.1 * StepControl::GROWTH_OF_START);
  EXPECT_DOUBLE_EQ(next(0.0, 0.1, Growth::FAILED).step, 0.1);
  EXPECT_EQ(next(0.0, 0.1, Growth::START).loads, 2);
  EXPECT_EQ(next(0.0, 0.1).loads, 1);

  StepErrors none;
  Growth growing = Growth::STEADY;
  EXPECT_DOUBLE_EQ(control.next(none, -0.1, remembered, growing, 0.03).step,
                   -0.03 * StepControl::CLEAR_OF_LIMIT);
  EXPECT_DOUBLE_EQ(control.next(none, 0.029, remembered, growing, 0.03).step, 0.029);
  control.shortest = 0.09;
  control.longest = 0.101;
  EXPECT_DOUBLE_EQ(next(big, -0.1).step, -0.09);
  EXPECT_DOUBLE_EQ(next(0.0, 0.1).step, 0.101);
}

TEST(StepControl, AStepThatFails)
{
  StepControl control;
  control.eps = 1e-6;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(control.fails(1e-6, 0.1));
  EXPECT_TRUE(control.fails(1.01e-6, 0.1));
  EXPECT_TRUE(control.fails(nan, 0.1));

  Growth growing = Growth::START;
  EXPECT_DOUBLE_EQ(control.repeat(256e-6, -0.1, 6, growing).step, -0.1 * StepControl::SAFETY / 2.0);
  EXPECT_EQ(growing, Growth::FAILED);
  EXPECT_EQ(control.repeat(256e-6, 0.1, 6, growing).loads, 5);    // again
  EXPECT_EQ(control.repeat(256e-6, 0.1, 1, growing).loads, 1);
  growing = Growth::STEADY;
  EXPECT_EQ(control.repeat(256e-6, 0.1, 6, growing).loads, 6);
  EXPECT_DOUBLE_EQ(control.repeat(nan, 0.1, 6, growing).step, 0.1 * StepControl::SHRINK_FAILED);
  EXPECT_LT(control.repeat(1.0001e-6, 0.1, 6, growing).step, 0.09);

  control.shortest = 0.05;
  EXPECT_DOUBLE_EQ(control.repeat(1e30, 0.1, 6, growing).step, 0.05);
  EXPECT_FALSE(control.fails(1e30, 0.05));
}

TEST(StepControl, EvenSteps)
{
  EXPECT_EQ(even_step(0.1, 1.01), 0.1);    // far in the future
  EXPECT_DOUBLE_EQ(even_step(0.1, 0.35), 0.35 / 4);
  EXPECT_DOUBLE_EQ(even_step(0.1, 0.1), 0.1);
  EXPECT_DOUBLE_EQ(even_step(0.1, 0.3), 0.1);    // rounding does not cause a fourth step
  EXPECT_DOUBLE_EQ(even_step(0.1, 0.02), 0.02);
}

TEST(StepControl, AFailedStepLeavesNoTrace)
{
  // a step that is far too long, repeated until it is accepted, compared with the same motion with
  // the final length from the beginning
  Following body(1e-9, 0.01), other(1e-9, 0.01);
  for (int n = 0; n < 40; ++n) {
    body.follow(body.step());
    other.follow(other.step());
  }
  const long before = body.repeated;
  body.set_step(3.0 * body.h);
  body.step();
  EXPECT_GT(body.repeated, before);
  EXPECT_LE(body.largest, 1.0);
  other.change_loads(body.remembered.loads());
  other.set_step(body.h);
  other.step();
  EXPECT_EQ(other.repeated, before);
  EXPECT_LT(Check::largest_difference(body.rows(), other.rows(), 3 * body.scheme.width()),
            1e-11);    // up to the rounding of several changes of the step
}

TEST(StepControl, TheErrorFollowsEps)
{
  const vector<double> eps = {1e-7, 1e-9, 1e-11, 1e-13};
  vector<double> errors;
  vector<long> evaluations;
  for (const double e : eps) {
    Following body(e, 0.1);
    body.run(200.0);
    errors.push_back(cage(body.scene).missed(body.state()));
    evaluations.push_back(body.evaluations);
    EXPECT_LE(body.largest, 1.0);
    EXPECT_LT(body.repeated, 0.1 * body.steps);
  }
  const double slope =
      std::log(errors.front() / errors.back()) / std::log(eps.front() / eps.back());
  EXPECT_GT(slope, 0.75);
  EXPECT_LT(slope, 1.4);
  EXPECT_GT(evaluations.back(), evaluations.front());
}

TEST(StepControl, EvaluationsInTestCase1)
{
  // the largest numbers with which the errors 1e-4, 1e-6, 1e-8 and 1e-10 are reached
  const double targets[] = {1e-4, 1e-6, 1e-8, 1e-10};
  const long most[] = {310, 420, 560, 730};
  double eps = 1e-3;
  for (int k = 0; k < 4; ++k) {
    long needed = 0;
    for (;; eps /= 1.8) {
      Following body(eps, 1e-3);
      body.run(200.0);
      needed = body.evaluations;
      if (cage(body.scene).missed(body.state()) < targets[k]) break;
    }
    EXPECT_LT(needed, most[k]) << targets[k];
  }
}

TEST(StepControl, RoundedCoordinatesMakeNoStepShorter)
{
  // an ellipse about a charge at 100 from the origin, down to a distance of 0.005: the energy is
  // known to 4e-10 there, and a smaller tolerance is useless
  const double nearest = 0.005, far = 100.0;
  RigidBody body = {1.0, {1.0, 1.0, 1.0}};
  BodyState start = {};
  start.q[3] = 1.0;
  start.center[0] = far + 1.0;
  start.velocity[1] = std::sqrt(2.0 - 2.0 / (1.0 + nearest));
  const double period = 2.0 * std::acos(-1.0) * std::pow(0.5 * (1.0 + nearest), 1.5);
  const double rounding = far * std::numeric_limits<double>::epsilon() / (nearest * nearest);
  vector<long> steps;
  for (const double eps : {1e-11, 1e-13, 1e-15}) {
    double at[3];
    const auto place = [&](const BodyState &s) {
      std::copy_n(s.center, 3, at);
      at[0] -= far;
      return length(at);
    };
    Follower follower(eps, true, 1e-4, {{body, 0.0, start}},
                      [&](const vector<Follower::One> &ones) {
                        Load load = {};
                        const double r = place(ones[0].state);
                        for (int i = 0; i < 3; ++i) load.force[i] = -at[i] / (r * r * r);
                        return vector<Load>{load};
                      });
    const auto energy = [&] {
      const BodyState &s = follower.bodies[0].state;
      return translational_energy(body, s.velocity) - 1.0 / place(s);
    };
    const double e0 = energy();
    follower.begin();
    follower.run(period, [] {
    });
    EXPECT_LT(std::fabs(energy() - e0), 10.0 * rounding);
    steps.push_back(follower.steps);
  }
  EXPECT_LT(steps[2], 50 * steps[0]) << steps[0] << " " << steps[1] << " " << steps[2];
}

TEST(StepControl, EncountersKeepTheEnergy)
{
  // the first 2000 of case 1, with a dozen close encounters; fixed steps of the mean length have an
  // error ten thousand times as large
  Following body(1e-13, 0.1);
  EXPECT_LT(body.run(2000.0), 1e-8);
  EXPECT_LE(body.largest, 1.0);

  const double mean = body.t / body.steps;
  Following fixed(1e-13, mean);
  fixed.control.shortest = fixed.control.longest = mean;
  EXPECT_GT(fixed.run(2000.0), 1e-6);
}
