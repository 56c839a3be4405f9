/* gear_quat_history.h and gear_quat_stability.h: the orders and estimates of every tuned set, and random forces. */

#include "gear_quat_stability.h"
#include "oracles/exact_flow.h"
#include "scenes.h"

#include <random>

using namespace Drive;

namespace {

/// Every number of values that has tuned coefficients.
vector<Scheme> tuned_schemes()
{
  return schemes_of(MOMENTUM, 1, true);
}

}    // namespace

// --- the table

TEST(TunedSets, ForgetErrorsOfTheHigherRows)
{
  for (int n = SECOND_FEWEST; n <= SECOND_MOST; ++n) {
    const vector<long double> exact = tuned_coefficients(n);
    const vector<double> c(exact.begin(), exact.end());
    double rows[MAX_VALUES] = {};
    for (int j = 2; j < n; ++j) rows[j] = 1.0;
    for (int step = 0; step < 800; ++step) {
      Nordsieck<1>::predict(rows, n);
      const double residual = -rows[2];
      Nordsieck<1>::correct<1>(rows, n, c.data(), 0, &residual);
    }
    for (int j = 2; j < n; ++j) EXPECT_LT(std::fabs(rows[j]), 1e-6) << n;
  }
}

TEST(TunedSets, NoneMeansAnError)
{
  EXPECT_THROW(Integrator(scheme_of(MOMENTUM, MAX_VALUES + 1), 0.1), std::domain_error);
  for (const Formulation formulation : {FIRST, SECOND}) {
    Scheme scheme = scheme_of(formulation, 6);
    scheme.method = Method::TUNED;
    EXPECT_THROW(Integrator(scheme, 0.1), std::domain_error);
  }
}

// --- their properties

namespace {

/// The exponent of the error, far from both rounding and the largest steps.
double slope_seen(const Scene &scene, const Scheme &scheme)
{
  vector<double> h, e;
  for (double step = 0.25; step > 0.01; step *= 0.9) {
    const double rounded = scene.time / std::ceil(scene.time / step);
    const double missed = error(scene, scheme, rounded, rounded);
    if (missed < 1e-5) h.push_back(rounded), e.push_back(missed);
    if (missed < 1e-13) break;
  }
  if (h.size() < 5) return 0.0;
  const size_t last = h.size() - 2;    // the finest may be rounding
  return Check::slopes({h[last - 3], h[last]}, {e[last - 3], e[last]})[0];
}

}    // namespace

TEST(TunedOrders, PositionOfTheOscillator)
{
  for (const Scheme &scheme : tuned_schemes()) {
    if (scheme.values() < 5) continue;    // errors are large for all of these steps
    EXPECT_GT(slope_seen(oscillator(200.0), scheme), scheme.order() - 0.5) << scheme;
  }
}

namespace {

/// Ratio of estimated and true local error of the position of the oscillating top, root mean
/// squares over a run.
double estimated_by_true(const Scheme &scheme, double h)
{
  const Oracle::ExactFlow flow(TOP, swing);
  Motion motion(TOP, top_state(0.0), swing, scheme, h, Start::BOOTSTRAP, std::min(h, 0.1));
  motion.steps(300);
  double estimated = 0.0, missed = 0.0;
  for (int n = 0; n < 60; ++n) {
    const BodyState exact = flow(motion.state(), h);
    estimated += std::pow(motion.step().position_error(), 2);
    const BodyState after = motion.state();
    for (int i = 0; i < 3; ++i) missed += std::pow(after.center[i] - exact.center[i], 2);
  }
  return std::sqrt(estimated / missed);
}

}    // namespace

TEST(TunedEstimates, AreTheLocalErrorOrAboveIt)
{
  for (const Scheme &scheme : tuned_schemes()) {
    if (scheme.values() > 9) continue;    // rounding of the state is close
    const double h = scheme.values() > 7 ? 0.12 : 0.1, wide = estimated_by_true(scheme, h);
    const double narrow = estimated_by_true(scheme, 0.75 * h);
    const double limit = (narrow - 0.5625 * wide) / (1.0 - 0.5625);    // without the term of h^2
    EXPECT_NEAR(limit, 1.0, 0.02) << scheme;
  }
}

// --- noise

TEST(Noise, RandomForcesHaveVelocityVerlet)
{
  // a vibration with the same kicks as the method of Swope et al.
  const Scheme scheme = scheme_of(MOMENTUM, VERLET);
  const RigidBody body = {2.0, {1.0, 1.0, 1.0}};
  const double h = 0.1;
  BodyState start = {};
  start.q[3] = 1.0;
  start.velocity[1] = 0.3;
  std::mt19937 random(4711);
  double x = 0.0, v = 0.3, a = 0.0;
  Motion motion(body, start, free_of_load, scheme, h, Start::FORCES, h);
  motion.load = [&](const BodyState &s, double) {
    return Load{{0.0, -5.0 * s.center[1] + 1e-9 * double(random()), 0.0}, {}};
  };
  std::mt19937 same(4711);
  for (int n = 0; n < 1000; ++n) {
    motion.step();
    const double before = a;
    x += h * v + 0.5 * h * h * before;
    a = (-5.0 * x + 1e-9 * double(same())) / body.mass;
    v += 0.5 * h * (before + a);
    ASSERT_NEAR(motion.state().center[1], x, 1e-11);
    ASSERT_NEAR(motion.state().velocity[1], v, 1e-11);
  }
}

TEST(Noise, SuitsFewValues)
{
  for (const Scheme &scheme : {scheme_of(SECOND, 7), scheme_of(SECOND, 5), scheme_of(SECOND, 4),
                               scheme_of(FIRST, 5), scheme_of(FIRST, 4), scheme_of(FIRST, 3)}) {
    EXPECT_EQ(suits_noise(scheme, Noise::DISSIPATIVE), scheme.values() <= (scheme.first() ? 3 : 4));
    EXPECT_EQ(suits_noise(scheme, Noise::RANDOM), scheme.first() && scheme.values() == 3);
  }
  for (const Scheme &scheme : tuned_schemes()) {
    EXPECT_TRUE(suits_noise(scheme, Noise::NONE));
    EXPECT_FALSE(suits_noise(scheme, Noise::DISSIPATIVE));
    EXPECT_FALSE(suits_noise(scheme, Noise::RANDOM));
  }
  for (const Noise noise : {Noise::RANDOM, Noise::DISSIPATIVE})
    EXPECT_TRUE(suits_noise(scheme_of(MOMENTUM, VERLET), noise));
}
