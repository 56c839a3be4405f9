/* Keyword langevin: random numbers, and the random step of a body. */

#include "gear_quat_friction.h"

#include <gtest/gtest.h>

using namespace LAMMPS_NS::GearQuat;

/// The published vectors of Philox4x32-10: counter, key, result.
TEST(Langevin, PublishedRandomNumbers)
{
  EXPECT_EQ(philox({0, 0, 0, 0}, 0, 0),
            (RandomWords{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, 0xffffffff, 0xffffffff),
            (RandomWords{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, 0xa4093822, 0x299f31d0),
            (RandomWords{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

/// Means, covariances and fourth moments of six numbers are those of independent normal numbers,
/// over steps and over bodies, within five errors.
TEST(Langevin, NormalNumbersAreIndependent)
{
  constexpr int MANY = 200000;
  for (const bool over_steps : {true, false}) {
    double sum[6] = {}, products[6][6] = {}, fourth[6] = {}, next[6] = {};
    auto last = normal_numbers(7, 0, 0);
    for (std::int64_t k = 1; k <= MANY; ++k) {
      const auto g = over_steps ? normal_numbers(7, k, 12) : normal_numbers(7, 12, k);
      for (int i = 0; i < 6; ++i) {
        sum[i] += g[i] / MANY;
        fourth[i] += g[i] * g[i] * g[i] * g[i] / MANY;
        next[i] += g[i] * last[i] / MANY;
        for (int j = 0; j < 6; ++j) products[i][j] += g[i] * g[j] / MANY;
      }
      last = g;
    }
    const double error = 1.0 / std::sqrt((double) MANY);
    for (int i = 0; i < 6; ++i) {
      EXPECT_NEAR(sum[i], 0.0, 5 * error);
      EXPECT_NEAR(next[i], 0.0, 5 * error);
      EXPECT_NEAR(fourth[i], 3.0, 5 * std::sqrt(96.0) * error);
      for (int j = 0; j < 6; ++j)
        EXPECT_NEAR(products[i][j], i == j ? 1.0 : 0.0,
                    5 * (i == j ? std::sqrt(2.0) : 1.0) * error);
    }
  }
  EXPECT_NE(normal_numbers(1, 2, 3), normal_numbers(2, 2, 3));
}

/// The mean and the variance of a momentum after many short steps are those of one long step.
TEST(Langevin, StepsOfAnyLength)
{
  const RigidBody body = {2.0, {1.5, 0.5, 0.0}};
  const std::array<bool, 6> all = {true, true, false, true, true, true};
  constexpr double KT = 0.8, TAU = 0.3, TIME = 0.4;
  constexpr int MANY = 20000;
  for (const int parts : {1, 16}) {
    double sum[6] = {}, square[6] = {}, gained = 0.0;
    for (int k = 0; k < MANY; ++k) {
      BodyState s = {{}, {0, 0, 0, 1}, {1.0, 0.0, 3.0}, {0.0, 2.0, 5.0}};
      const RandomStep step(TIME / parts, TAU, KT);
      for (int n = 0; n < parts; ++n)
        gained += step.take(body, all, normal_numbers(3, n, k), s) / MANY;
      for (int i = 0; i < 3; ++i) {
        sum[i] += s.velocity[i] / MANY;
        square[i] += s.velocity[i] * s.velocity[i] / MANY;
        sum[3 + i] += s.omega_body[i] / MANY;
        square[3 + i] += s.omega_body[i] * s.omega_body[i] / MANY;
      }
      EXPECT_EQ(s.velocity[2], 3.0);      // does not act
      EXPECT_EQ(s.omega_body[2], 5.0);    // has no moment of inertia
    }
    const double c = std::exp(-TIME / TAU), begun[6] = {1.0, 0.0, 3.0, 0.0, 2.0, 5.0};
    const double mass[6] = {2.0, 2.0, 2.0, 1.5, 0.5, 0.0};
    double expected = 0.0;
    for (const int i : {0, 1, 3, 4}) {
      const double variance = (1.0 - c * c) * KT / mass[i], error = std::sqrt(variance / MANY);
      EXPECT_NEAR(sum[i], c * begun[i], 5 * error);
      EXPECT_NEAR(square[i] - sum[i] * sum[i], variance,
                  5 * std::sqrt(2.0) * error * std::sqrt(variance));
      expected += 0.5 * (1.0 - c * c) * (KT - mass[i] * begun[i] * begun[i]);
    }
    EXPECT_NEAR(gained, expected, 0.03);
  }
}
