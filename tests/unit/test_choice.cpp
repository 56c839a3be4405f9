/* gear_quat_stability.h: the fast edge of known motions, and the number of values for each case. */

#include "gear_quat_stability.h"
#include "scenes.h"

using namespace Drive;

namespace {

Scheme automatic(Formulation formulation)
{
  Scheme scheme = scheme_of(formulation);
  scheme.rows = formulation == FIRST ? 6 : formulation == SECOND ? 8 : 9;
  return scheme;
}

/// A body on a spring that vibrates with this angular frequency in any direction and about any
/// axis.
constexpr double OMEGA = 3.0;
const RigidBody BALL = {2.0, {0.7, 0.7, 0.7}};

BodyState swinging(double phase)
{
  BodyState s = {};
  const double angle = 1e-4;    // small, so that the motion is harmonic
  s.center[1] = 0.01 * std::cos(phase);
  s.velocity[1] = -0.01 * OMEGA * std::sin(phase);
  s.q[2] = 0.5 * angle * std::cos(phase);
  s.q[3] = std::sqrt(1.0 - s.q[2] * s.q[2]);
  s.omega_body[2] = -angle * OMEGA * std::sin(phase);
  return s;
}

Load springs(const BodyState &s, double norm2)
{
  Load l = {};
  for (int i = 0; i < 3; ++i) l.force[i] = -BALL.mass * OMEGA * OMEGA * s.center[i];
  l.torque_space[2] = -BALL.inertia[2] * OMEGA * OMEGA * 2.0 * s.q[2] / std::sqrt(norm2);
  return l;
}

MotionSums sums_of_start(const RigidBody &body, const BodyState &s, const LoadOf &load, double step)
{
  MotionSums sums;
  sums.add(body, s, settled_series(9, body, s, load, step), step);
  return sums;
}

Choice choose(const Scheme &scheme, double edge, int present = 0)
{
  return Choice(scheme, edge, Noise::NONE, false, present);
}

}    // namespace

// --- the fast edge

TEST(FastEdge, IsTheFrequencyOfAVibrationAtAnyPhaseAndSpacing)
{
  for (const double phase : {0.0, 0.1, 0.8, 1.57, 1.5707963267948966})
    for (const double step : {0.02, 0.05})
      for (const double h : {0.04, -0.1}) {
        const double z = sums_of_start(BALL, swinging(phase), springs, step).fast_edge(h);
        EXPECT_NEAR(z, std::fabs(h) * OMEGA, 0.002 * std::fabs(h) * OMEGA) << phase;
      }
}

TEST(FastEdge, IsNoneOfAFreeRotation)
{
  BodyState s = {};
  s.q[3] = 1.0;
  s.omega_body[0] = 2.0;
  const MotionSums sums = sums_of_start(BALL, s, free_of_load, 0.05);
  EXPECT_EQ(sums.fast_edge(0.1), 0.0);
}

TEST(FastEdge, OfManyIsThatOfTheFastOnes)
{
  // equal energies in a slow and a fast vibration
  MotionSums both;
  for (const double omega : {1.0, 3.0}) {
    BodyState state = {};
    state.q[3] = 1.0;
    TaylorSeries series = {};
    series.terms = 9;
    series.c[2][0] = 0.5 * omega;    // amplitude 1/omega
    series.c[4][0] = omega * omega * omega / 24.0;
    both.add({1.0, {0.0, 0.0, 0.0}}, state, series, 1.0);
  }
  EXPECT_GT(both.fast_edge(1.0), 2.7);
  EXPECT_LT(both.fast_edge(1.0), 3.0);
}

// --- the choice

TEST(Choice, SlowMotionHasNineAndFastMotionFive)
{
  const Scheme scheme = automatic(MOMENTUM);
  const double edge = Choice::EDGE_OF_NINE;
  EXPECT_EQ(choose(scheme, 0.99 * edge).scheme.values(), 9);
  EXPECT_EQ(choose(scheme, 1.01 * edge).scheme.values(), 5);
  EXPECT_EQ(choose(scheme, INFINITY).scheme.values(), 5);
  EXPECT_EQ(choose(scheme, 0.1).reason, Choice::MOTION);
}

TEST(Choice, APresentNumberStaysWithinABand)
{
  const Scheme scheme = automatic(MOMENTUM);
  const double edge = Choice::EDGE_OF_NINE, band = Choice::BAND;
  for (const double part : {0.99 / band, 1.01 / band, 0.99 * band, 1.01 * band}) {
    EXPECT_EQ(choose(scheme, part * edge, 9).scheme.values(), part < band ? 9 : 5);
    EXPECT_EQ(choose(scheme, part * edge, 5).scheme.values(), part < 1.0 / band ? 9 : 5);
  }
}

TEST(Choice, OtherMethodsHaveTheirOwnNumber)
{
  for (const double edge : {0.0, 0.3, 0.9}) {
    EXPECT_EQ(choose(automatic(FIRST), edge).scheme.values(), 6);
    EXPECT_EQ(choose(automatic(SECOND), edge).scheme.values(), 8);
    EXPECT_EQ(choose(automatic(FIRST), edge).reason, Choice::FORMULATION);
  }
}

TEST(Choice, WithRandomAndDissipativeForcesNothingHeats)
{
  for (const Formulation formulation : FORMULATIONS)
    for (const Noise noise : {Noise::RANDOM, Noise::DISSIPATIVE})
      for (const double edge : {0.0, 0.5}) {
        const Choice choice(automatic(formulation), edge, noise, false);
        EXPECT_TRUE(suits_noise(choice.scheme, noise));
        EXPECT_EQ(choice.reason, Choice::NOISE);
        EXPECT_EQ(choice.scheme.is_verlet(), noise == Noise::RANDOM && formulation != FIRST);
      }
  const Choice noisy(automatic(MOMENTUM), 0.0, Noise::DISSIPATIVE, false);
  EXPECT_EQ(noisy.scheme.values(), 4);
  EXPECT_FALSE(noisy.scheme.tuned());
  // a given corrector is kept in any case
  EXPECT_TRUE(Choice(automatic(MOMENTUM), 0.0, Noise::DISSIPATIVE, true).scheme.tuned());
}

TEST(Choice, AVibrationIsFollowedUpToTwoThirdsOfTheFastest)
{
  const auto longest = [](int values, bool is_tuned) {
    Scheme scheme = automatic(is_tuned ? MOMENTUM : SECOND);
    scheme.rows = values;
    return longest_edge(scheme);
  };
  EXPECT_NEAR(longest(9, true), 0.40, 0.001);
  EXPECT_NEAR(longest(7, true), 0.47, 0.004);
  EXPECT_NEAR(longest(5, true), 0.64, 0.001);
  EXPECT_NEAR(longest(8, false), 0.31, 0.004);
}

TEST(FastEdge, IsNoneOfForcesThatCancelUpToRounding)
{
  BodyState s = {};
  s.q[3] = 1.0;
  s.velocity[0] = 1.0;
  for (const double size : {1e-18, 1e-6}) {
    TaylorSeries series = {};
    series.terms = 9;
    series.c[2][0] = series.c[4][0] = size;
    MotionSums sums;
    sums.add(BALL, s, series, 0.01);
    EXPECT_EQ(sums.fast_edge(0.01) > 0.0, size > 1e-12) << size;
  }
}

// --- is it the better choice?

TEST(Choice, ConservesTheEnergyOfAVibrationAtBothSidesOfTheEdge)
{
  // energy lost by a harmonic motion in 20 000 steps, compared with the other number
  const auto drift = [](int values, double z) {
    Scheme scheme = automatic(MOMENTUM);
    scheme.rows = values;
    const double h = z / OMEGA;
    BodyState s = swinging(0.3);
    for (double &w : s.omega_body) w = 0.0;
    Motion motion(BALL, s, springs, scheme, h, Start::BOOTSTRAP, h);
    const auto energy = [&motion] {
      const BodyState now = motion.state();
      return dot3(now.velocity, now.velocity) + OMEGA * OMEGA * dot3(now.center, now.center);
    };
    const double before = energy();
    motion.steps(20000);
    return std::fabs(energy() / before - 1.0);
  };
  const double low = 0.5 * Choice::EDGE_OF_NINE, high = 2.6 * Choice::EDGE_OF_NINE;
  EXPECT_LT(drift(9, low), drift(5, low));
  EXPECT_FALSE(drift(9, high) <= drift(5, high));    // nine values are unstable: not a number
}
