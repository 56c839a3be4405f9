/* A step and a number of values that adapt to the error: the rows, the estimates, the control law,
   and the results in the paper's cage. */

#include "chain_record.h"
#include "checks.h"
#include "follow.h"
#include "scenes.h"

using namespace Drive;

namespace {

/// Growth factor per step of the rows set by a scheme when only the step changes.
double growth(const Scheme &scheme, double ratio)
{
  const int n = scheme.values(), order = scheme.first() ? 1 : 2;
  const Fractions exact = scheme.first() ? first_order_coefficients(n)
                                         : second_order_coefficients(n, false);
  double c[MAX_VALUES], rows[MAX_VALUES] = {}, before = 1.0;
  for (int j = 0; j < n; ++j) c[j] = exact[j].value();
  for (int j = order; j < n; ++j) rows[j] = 1.0 / (1 + j);
  const int settled = 300, steps = 400;
  for (int k = 0; k < steps; ++k) {
    Nordsieck<1>::predict(rows, n);
    const double residual = -rows[order];
    Nordsieck<1>::correct<1>(rows, n, c, 0, &residual);
    Nordsieck<1>::rescale(rows, n, ratio);
    double size = 0.0;
    for (int j = order; j < n; ++j) size = std::max(size, std::fabs(rows[j]));
    if (size == 0.0) return 0.0;
    if (k == settled) before = 1.0;
    if (k > settled) before *= size;
    for (int j = order; j < n; ++j) rows[j] /= size;
  }
  return std::pow(before, 1.0 / (steps - 1 - settled));
}

/// A polynomial of degree `degree` in every column, about t, as rows for the step h.
vector<double> polynomial(const Scheme &scheme, int degree, double t, double h)
{
  vector<double> a;    // p(t) = sum over k of (1 + c/10) t^k / (1 + k)
  for (int k = 0; k <= degree; ++k)
    for (int c = 0; c < scheme.width(); ++c) a.push_back((1.0 + 0.1 * c) / (1 + k));
  vector<double> rows = Check::polynomial_rows(a, scheme.width(), t, h);
  rows.resize(2 * MAX_SIZE);
  return rows;
}

/// The body of the paper's cage.
struct Following : Follower {
  CageScene scene;

  Following(Formulation formulation, double eps, double first_step, int values = 0) :
      Follower(formulation, eps, false, first_step, {{CageScene(1, true).body, 1.0}}, {}),
      scene(1, true)
  {
    loads = [this](const vector<One> &ones) {
      return vector<Load>{scene.load(ones[0].state, scheme.norm2(ones[0].state.q))};
    };
    if (values) {
      control.fewest = control.most = values;
      use(values);
    }
    Scheme above = scheme;
    above.trial = false;
    above.rows = scheme.values() + 1;
    const auto start = started(above, scene.body, scene.start, scene, h, Start::BOOTSTRAP, h);
    std::copy(start.begin(), start.end(), rows());
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

/// The error of a chain's step that n values estimate for n + more values, over the error of a step
/// with n + more values: of the position of a body in thermal motion, and of its energy.
std::array<double, 2> chain_estimate_over_error(int n, int more, double h, double mass)
{
  // 2K(t) = A exp(t): xi_1 is known, and so are all of its derivatives
  const ChainTarget target = {0.7, 0.0, 5.0, 1.1};
  constexpr int STEPS = 24;
  const double a = 6.0, per_freedom = a / (target.freedoms * target.kt);
  const auto xi = [&](double t) {
    return (per_freedom * std::expm1(t) - t) / (target.period * target.period);
  };
  const auto settled = [&](int values, double &error) {
    Chain chain(1);
    double now = a;
    chain.seed(&now, 0, 0.0, 1);
    ChainRecord known = ChainRecord::of(chain);
    known.known = values + 1;
    for (int k = 0; k <= values; ++k) {
      known.sums[k] = a * std::exp(-k * h);
      known.ages[k] = k * h;
    }
    known.restore(chain);
    double before = 0.0;
    for (int step = 1; step <= STEPS; ++step) {
      before = chain.friction() - xi((step - 1) * h);
      EXPECT_TRUE(chain.advance(target, a * std::exp(step * h), h, values));
      chain.conclude();
    }
    error = std::fabs(chain.friction() - xi(STEPS * h) - before);
    return chain.left_out(target, h, values);
  };
  double error, other;
  const Chain::LeftOut left_out = settled(n, other);
  settled(n + more, error);
  const StepMeasures found =
      VariableOrder(varying(SECOND, n)).errors_of_chain(left_out, target.kt, mass, h);
  const auto of = [&](const StepErrors &errors) {
    return more < 0 ? errors.fewer : more > 0 ? errors.more : errors.same;
  };
  const double speed = std::sqrt(3.0 * target.kt / mass);
  // a wrong friction for a step changes the velocity by h error speed
  return {of(found.length) / (h * h * error * speed),
          of(found.energy) / (mass * speed * h * error * speed)};
}

}    // namespace

TEST(StepControl, AShrinkingStepIsStable)
{
  // errors of rows must decay faster than the step shrinks: in the second formulation they count as
  // velocities, times the step

  const auto worst = [](const Scheme &scheme, double least) {
    double most = 0.0;
    for (double ratio = least; ratio < 1.0; ratio += 0.01)
      most = std::max(most, growth(scheme, ratio) / (scheme.first() ? 1.0 : ratio));
    return most;
  };
  for (const Scheme &scheme : every_scheme())
    if (scheme.values() <= VARIABLE_MOST) {
      EXPECT_LT(worst(scheme, StepControl::GENTLE), 0.85) << scheme;
    }
  for (const Scheme &scheme : every_scheme())
    if (scheme.values() < VARIABLE_MOST) {
      EXPECT_LT(worst(scheme, StepControl::SHRINK_FAILED), 0.85) << scheme;
    }
  EXPECT_GT(worst(scheme_of(SECOND, VARIABLE_MOST), StepControl::SHRINK_FAILED), 1.0);
  EXPECT_GT(worst(scheme_of(SECOND, VARIABLE_MOST + 1), StepControl::GENTLE), 0.95);
}

TEST(StepControl, RowsComeAndGoWithoutAnError)
{
  const double h = 0.1, ratio = 0.7;
  for (bool compensate : {false, true})
    for (const Scheme &scheme : every_scheme())
      for (int change : {-1, 1}) {
        const int n = scheme.values(), degree = change < 0 ? n - 2 : n;
        const Formulation formulation = scheme.formulation;
        if (n + change < fewest(formulation) || n + change > most(formulation)) continue;
        const Scheme from = varying(formulation, n, compensate),
                     to = varying(formulation, n + change, compensate);
        vector<double> rows = polynomial(from, degree, 0.3, h);
        if (change > 0) {    // its last row is the trial row
          std::copy_n(&rows[n * from.width()], from.width(), &rows[from.trial_row()]);
          if (compensate) std::fill_n(&rows[n * from.width()], from.width(), 0.0);
        }
        const VariableOrder order(from);
        change < 0 ? order.drop_row(rows.data()) : order.add_row(rows.data());
        Integrator integrator(to, h);
        integrator.rescale(rows.data(), ratio);
        integrator.set_step(ratio * h);
        integrator.predict(RigidBody(), rows.data());
        auto distance = [&](double later) {
          const vector<double> exact = polynomial(to, degree, 0.3 + later, ratio * h);
          return Check::largest_difference(rows.data(), exact.data(), (degree + 1) * to.width());
        };
        EXPECT_LT(distance(ratio * h), 1e-14) << from;
        EXPECT_GT(distance(1.01 * ratio * h), 1e-4);
      }
}

TEST(StepControl, ErrorsOfAChainAreThoseOfABodyInThermalMotion)
{
  for (int n = 5; n <= 7; ++n)
    for (const int more : {-1, 0, 1})
      for (int k = 0; k < 2; ++k) {
        const auto at = [&](double h) {
          return chain_estimate_over_error(n, more, h, 2.7)[k];
        };
        const double found = 2.0 * at(0.05) - at(0.1);    // without the term of h
        Check::relatively_near_and_refuses_one_percent({found}, {1.0}, 0.0045);
      }
}

TEST(StepControl, CarriesStayWithTheirRows)
{
  for (Formulation formulation : {FIRST, SECOND}) {
    const Scheme six = varying(formulation, 6, true), seven = varying(formulation, 7, true);
    const int width = six.width(), carries = six.carries() * width;
    vector<double> rows(2 * MAX_SIZE, 0.0), carry(carries), trial(width);
    for (int i = 0; i < six.size(); ++i) rows[i] = 1.0 + i;
    const vector<double> before = rows;
    VariableOrder(six).add_row(rows.data());
    for (int i = 0; i < carries; ++i) EXPECT_EQ(rows[7 * width + i], before[6 * width + i]);
    for (int i = 0; i < width; ++i) {
      EXPECT_EQ(rows[6 * width + i], before[six.trial_row() + i]);
      EXPECT_EQ(rows[seven.trial_row() + i], 0.0);
    }
    VariableOrder(seven).drop_row(rows.data());
    for (int i = 0; i < six.size(); ++i) EXPECT_EQ(rows[i], before[i]);
  }
}

TEST(StepControl, EstimatesAreThoseOfTheOtherNumbersOfValues)
{
  auto errors_at = [](Formulation formulation, int values, double h) {
    Following body(formulation, 1.0, h, values);
    body.rounded = false;
    StepErrors errors;
    for (int n = 0; n < 3 * values; ++n) errors = body.step();
    while (body.t < 8.0 - 0.5 * h) errors = body.step();
    return errors;
  };
  for (Formulation formulation : {FIRST, SECOND})
    for (int n : {6, 7}) {
      const double h = 0.1;
      const StepErrors here = errors_at(formulation, n, h), half = errors_at(formulation, n, h / 2);
      EXPECT_NEAR(std::log2(here.fewer / half.fewer), n - 1, 0.5);
      EXPECT_NEAR(std::log2(here.same / half.same), n, 0.5);
      EXPECT_NEAR(std::log2(here.more / half.more), n + 1, 1.0);
      const StepErrors below = errors_at(formulation, n - 1, h / 2);
      const StepErrors above = errors_at(formulation, n + 1, h / 2);
      EXPECT_NEAR(half.fewer / below.same, 1.0, 0.3);
      EXPECT_NEAR(half.more / above.same, 1.0, 0.3);
    }
}

TEST(StepControl, TheEstimateIsTheCorrectorsOwn)
{
  for (Scheme scheme : every_scheme()) {
    if (scheme.values() > VARIABLE_MOST) continue;
    scheme.trial = true;
    const CageScene scene(1, true);
    const Integrator integrator(scheme, 0.1);
    vector<double> rows(2 * MAX_SIZE, 0.0);
    seed(scheme, scene.body,
         local_series(scene.body, scene.start, scene.load(scene.start, 1.0), 0.1), 0.1, 0.1,
         rows.data());
    integrator.predict(scene.body, rows.data());
    for (const double reach :
         {1e-3, 1.0, 1e3}) {    // an angle counts as the displacement of the outermost part
      StepMeasures errors;
      vector<double> copy = rows;
      const Correction own = VariableOrder(scheme).correct(
          integrator, scene.body, reach, scene.load(scene.start, 1.0),
          integrator.axes_of(copy.data()).data(), copy.data(), errors);
      const double larger = std::max(own.position_error(), reach * own.angle_error());
      EXPECT_GT(larger, 0.0);
      EXPECT_NEAR(errors.length.same / larger, 1.0, 1e-9) << scheme;
    }
  }
}

TEST(StepControl, TheLaw)
{
  StepControl control;
  control.eps = 1e-6;
  control.fewest = 4;
  control.most = 9;
  const double big = 1e30, growth = StepControl::largest_growth(8);
  const Steady long_since = {100, 100, 100};
  auto next = [&](StepErrors errors, double step, int values = 8, Steady steady = {100, 100, 100}) {
    return control.next(errors, step, values, steady);
  };
  // the error of a step that could be longer by this factor
  auto error = [&](double ratio, int values = 8) {
    return 1e-6 * std::pow(StepControl::SAFETY / ratio, values);
  };

  EXPECT_DOUBLE_EQ(next({big, error(0.8), big}, 0.1).step, 0.08);
  EXPECT_DOUBLE_EQ(next({big, error(1.2), big}, 0.1).step, 0.12);
  EXPECT_DOUBLE_EQ(next({big, 0.0, big}, 0.1).step, 0.1 * growth);
  EXPECT_DOUBLE_EQ(next({big, big, big}, -0.1).step, -0.1 * StepControl::SHRINK);

  // small changes do not pay, and a step that was just changed or repeated does not grow

  for (const double ratio : {0.98, 1.0, 1.09})
    EXPECT_DOUBLE_EQ(next({big, error(ratio), big}, 0.1).step, 0.1);
  EXPECT_DOUBLE_EQ(next({big, 0.0, big}, 0.1, 8, {100, 8, 100}).step, 0.1);
  EXPECT_DOUBLE_EQ(next({big, 0.0, big}, 0.1, 8, {100, 100, 8}).step, 0.1);

  // an accepted step that was just changed is shortened gently; otherwise the last row is unusable

  EXPECT_DOUBLE_EQ(next({big, error(0.91), big}, 0.1, 8, {100, 4, 100}).step, 0.095);
  EXPECT_DOUBLE_EQ(next({big, error(0.91), big}, 0.1, 8, {100, 5, 100}).step, 0.091);
  EXPECT_DOUBLE_EQ(next({big, error(0.8), big}, 0.1, 8, {100, 1, 1}).step, 0.08);
  EXPECT_EQ(next({big, error(0.8), big}, 0.1, 8, {100, 1, 1}).values, 7);

  // another number of values must promise more than a smaller error

  EXPECT_EQ(next({error(0.7, 7) / 2.0, error(0.6), big}, 0.1).values, 7);
  EXPECT_EQ(next({error(0.7, 7) * 1.01, error(0.7), big}, 0.1).values, 8);
  EXPECT_EQ(next({big, error(0.6), error(0.7, 9) / 3.0}, 0.1).values, 9);
  EXPECT_EQ(next({big, error(0.7), error(0.7, 9) / 2.9}, 0.1).values, 8);
  EXPECT_EQ(next({big, error(1.0), error(1.3, 9) / 3.0}, 0.1).values, 9);
  EXPECT_EQ(next({big, error(0.6), 0.0}, 0.1, 8, {8, 100, 100}).values, 8);    // too early
  EXPECT_EQ(next({big, error(0.7), error(0.74, 9)}, 0.1, 8, {200, 100, 100}).values, 8);
  EXPECT_EQ(next({big, error(0.7), error(0.74, 9)}, 0.1, 8, {201, 100, 100}).values, 9);
  EXPECT_EQ(next({big, error(0.7), error(0.68, 9)}, 0.1, 8, {201, 100, 100}).values, 8);
  EXPECT_EQ(next({big, error(0.6), 0.0}, 0.1, 9).values, 9);
  EXPECT_EQ(next({0.0, error(0.6), big}, 0.1, 4).values, 4);

  // as far as the step may grow: without forces all numbers of values are equivalent

  for (const double small : {0.0, 1e-30, 1e-20}) {
    EXPECT_EQ(next({small, small, small}, 0.1).values, 8);
    EXPECT_EQ(next({small, 1e3 * small, small}, 0.1).values, 8);
  }

  // nor is it longer than the motion allows

  const double limit = 0.03, clear = StepControl::CLEAR_OF_LIMIT * limit;
  EXPECT_DOUBLE_EQ(control.next({big, error(1.0), big}, -0.1, 8, long_since, limit).step, -clear);
  EXPECT_DOUBLE_EQ(control.next({big, 0.0, big}, 0.026, 8, long_since, limit).step, clear);
  EXPECT_DOUBLE_EQ(control.next({big, 0.0, big}, 0.029, 8, long_since, limit).step, 0.029);
  EXPECT_DOUBLE_EQ(control.next({big, error(1.0), big}, 0.1, 8, long_since, 0.3).step, 0.1);

  control.shortest = 0.09;
  control.longest = 0.101;
  EXPECT_DOUBLE_EQ(next({big, big, big}, -0.1).step, -0.09);
  EXPECT_TRUE(next({big, big, big}, -0.1).held);
  EXPECT_FALSE(next({big, error(1.0), big}, 0.1).held);
  EXPECT_DOUBLE_EQ(next({big, 0.0, big}, 0.1).step, 0.101);
}

TEST(StepControl, AStepThatFails)
{
  StepControl control;
  control.eps = 1e-6;
  control.fewest = 4;
  control.most = 9;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(control.fails(1e-6, 0.1));
  EXPECT_TRUE(control.fails(1.01e-6, 0.1));
  EXPECT_TRUE(control.fails(nan, 0.1));

  const Steady before = {100, 100, 100}, soon = {100, 100, 2};
  const double safety = StepControl::SAFETY * StepControl::SAFETY;
  EXPECT_DOUBLE_EQ(control.repeat(1e-6 * 256.0, -0.1, 8, before).step, -0.1 * safety / 2.0);
  EXPECT_EQ(control.repeat(1e-6 * 256.0, 0.1, 8, before).values, 8);
  EXPECT_DOUBLE_EQ(control.repeat(nan, 0.1, 8, before).step, 0.1 * StepControl::SHRINK_FAILED);
  EXPECT_LT(control.repeat(1.0001e-6, 0.1, 8, before).step, 0.09);

  // a failure soon after another one: the last row is unusable

  EXPECT_LE(control.repeat(1.0001e-6, 0.1, 8, soon).step, 0.1 * StepControl::SHRINK);
  EXPECT_EQ(control.repeat(1.0001e-6, 0.1, 8, soon).values, 7);
  EXPECT_EQ(control.repeat(1.0001e-6, 0.1, 4, soon).values, 4);

  control.shortest = 0.05;
  EXPECT_DOUBLE_EQ(control.repeat(1e30, 0.1, 8, before).step, 0.05);
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
  Following body(SECOND, 1e-9, 0.1), other(SECOND, 1e-9, 0.1);
  for (int n = 0; n < 20; ++n) {
    body.follow(body.step());
    other.follow(other.step());
  }
  body.set_step(16.0 * body.h);
  body.step();
  EXPECT_GT(body.repeated, 0);
  EXPECT_LE(body.largest, 1.0);
  while (other.scheme.values() > body.scheme.values())
    other.change({other.h, other.scheme.values() - 1, false});
  other.set_step(body.h);
  other.step();
  EXPECT_EQ(other.repeated, 0);
  EXPECT_LT(Check::largest_difference(body.rows(), other.rows(), 3 * body.scheme.width()),
            1e-11);    // up to the rounding of several changes of the step
}

TEST(StepControl, TheErrorFollowsEps)
{
  for (Formulation formulation : {FIRST, SECOND}) {
    vector<double> eps = {1e-7, 1e-9, 1e-11, 1e-13}, errors;
    vector<long> steps;
    for (double e : eps) {
      Following body(formulation, e, 0.1);
      body.run(200.0);
      errors.push_back(cage(body.scene).missed(body.state()));
      steps.push_back(body.steps);
      EXPECT_LE(body.largest, 1.0);
      EXPECT_LT(body.repeated, 0.1 * body.steps);
    }
    const double slope =
        std::log(errors.front() / errors.back()) / std::log(eps.front() / eps.back());
    EXPECT_GT(slope, 0.75);
    EXPECT_LT(slope, 1.4);
    EXPECT_GT(steps.back(), steps.front());
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
  for (Formulation formulation : {FIRST, SECOND}) {
    vector<long> steps;
    for (const double eps : {1e-11, 1e-13, 1e-15}) {
      double at[3];
      const auto place = [&](const BodyState &s) {
        std::copy_n(s.center, 3, at);
        at[0] -= far;
        return length(at);
      };
      Follower follower(formulation, eps, true, 1e-4, {{body, 0.0, start}},
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
      follower.begin_with_loads();
      follower.run(period, [] {
      });
      EXPECT_LT(std::fabs(energy() - e0), 10.0 * rounding);
      steps.push_back(follower.steps);
    }
    EXPECT_LT(steps[2], 50 * steps[0]) << steps[0] << " " << steps[1] << " " << steps[2];
  }
}

TEST(StepControl, UniformRotationsDoNotKeepFewValues)
{
  // after many failed steps, or with inserted bodies, histories have the fewest values; the fourth
  // derivative does not turn a body that rotates uniformly, so the error of four values is small and
  // the error of five is not smaller
  const vector<std::pair<RigidBody, vector<double>>> bodies = {
      {{2.0, {0.5, 0.5, 0.0}}, {3.0, 2.0, 0.0}},    // a rod
      {{2.0, {0.5, 0.5, 0.5}}, {1.0, 2.0, 3.0}},
      {{2.0, {1.0, 0.7, 0.4}}, {4.0, 0.0, 0.0}}};
  for (const auto &[body, omega] : bodies)
    for (const double eps : {1e-7, 1e-9, 1e-12}) {
      BodyState start = {};
      start.q[3] = 1.0;
      std::copy(omega.begin(), omega.end(), start.omega_body);
      const Follower::One one = {body, 0.5, start};
      const auto steps_with = [&](int fewest) {
        Follower follower(SECOND, eps, true, 1e-4, {one}, [](const vector<Follower::One> &) {
          return vector<Load>(1);
        });
        follower.control.fewest = fewest;
        follower.begin_with_loads();
        follower.run(20.0, [] {
        });
        return follower.steps;
      };
      EXPECT_LT(steps_with(4), 1.5 * steps_with(9)) << eps;
    }
}

TEST(StepControl, EncountersKeepTheEnergy)
{
  // the first 2000 of case 1, with a dozen close encounters; fixed steps of the mean length have an
  // error ten thousand times as large
  for (Formulation formulation : {FIRST, SECOND}) {
    Following body(formulation, 1e-13, 0.1);
    EXPECT_LT(body.run(2000.0), 1e-8);
    EXPECT_LE(body.largest, 1.0);

    const double mean = body.t / body.steps;
    Following fixed(formulation, 1e-13, mean);
    fixed.control.shortest = fixed.control.longest = mean;
    EXPECT_GT(fixed.run(2000.0), 1e-6);
  }
}
