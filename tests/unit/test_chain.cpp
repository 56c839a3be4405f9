/* Nose-Hoover chains: energy balance, other degrees of freedom, absurd input.  Chains of moving bodies, beside their equations,
   are in tests/lammps/test_equations.py and test_thermostat.py. */

#include "chain_record.h"
#include "checks.h"

using namespace LAMMPS_NS::GearQuat;

TEST(Chain, WhatItTakesIsWhatItsFrictionDoes)
{
  // E(1) - E(0) = integral of 2K xi_1, for every length, with a target that moves, forwards and
  // backwards
  for (int length = 1; length <= Chain::LONGEST; ++length)
    for (const double h : {0.3, -0.3}) {
      Check::Numbers numbers(length);
      const ChainTarget at = {0.7, 0.11, 9.0, 1.3};
      ChainRecord begun = {};
      for (int k = 0; k < length; ++k) begun.y[k] = numbers.next();
      Chain chain(length);
      begun.restore(chain);
      const double when[] = {-1.0, 0.0, 1.0}, twice[] = {4.2, 5.0, 4.7};
      const ChainDrive drive = ChainDrive::through(3, when, twice);
      const auto energy_after = [&](double until) {
        ChainTarget then = at;
        then.kt += at.kt_rate * h * until;
        Chain other(length);
        ChainRecord all = {};
        all.y = chain.flow(at, drive, h, until).y;
        all.restore(other);
        return other.energy(then);
      };
      // Gauss' rule of five points in ten pieces
      constexpr double NODES[] = {0.0, 0.5384693101056831, 0.9061798459386640},
                       WEIGHTS[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
      double work = 0.0;
      for (int piece = 0; piece < 10; ++piece)
        for (int i = 0; i < 5; ++i) {
          const int k = (i + 1) / 2;
          const double s = 0.1 * piece + 0.05 + 0.05 * (i % 2 ? NODES[k] : -NODES[k]);
          const double twice_then = drive.c[0] + s * (drive.c[1] + s * drive.c[2]);
          work += 0.05 * WEIGHTS[k] * h * twice_then * chain.flow(at, drive, h, s).y[0];
        }
      EXPECT_NEAR(energy_after(1.0) - energy_after(0.0), work, 1.0e-12);
    }
}

TEST(Chain, OtherDegreesOfFreedomLeaveItsEnergyAndItsFriction)
{
  const ChainTarget before = {0.5, 0.0, 12.0, 0.7}, more = {0.5, 0.0, 18.0, 0.7};
  Chain was(3);
  for (int step = 0; step < 50; ++step) {
    ASSERT_TRUE(was.advance(before, 4.0, 0.02, 8));
    was.conclude();
  }
  Chain joined = was;
  joined.join(before, more);
  EXPECT_DOUBLE_EQ(joined.energy(more), was.energy(before));
  EXPECT_EQ(joined.friction(), was.friction());
  EXPECT_GT(std::fabs(was.energy(more) - was.energy(before)), 1.0e-2);
  // 2K per degree of freedom is as before, and so is the motion
  ASSERT_TRUE(was.advance(before, 4.0, 0.02, 8));
  ASSERT_TRUE(joined.advance(more, 6.0, 0.02, 8));
  EXPECT_NEAR(joined.friction(), was.friction(), 1.0e-3 * std::fabs(was.friction()));
}

TEST(Chain, WithoutDegreesOfFreedomNothingMoves)
{
  Chain chain(3);
  ChainRecord some = {};
  some.y = {0.3, 0.2, 0.1, 7.0};
  some.restore(chain);
  EXPECT_TRUE(chain.advance({1.0, 0.0, 0.0, 1.0}, 0.0, 0.1, 8));
  EXPECT_EQ(chain.values(), some.y);
}

TEST(Chain, AKineticEnergyThatIsAbsurdIsNotFollowed)
{
  const ChainTarget target = {1.0, 0.0, 1.0e5, 1.0};
  for (const double twice : {1.0e25, 1.0e300}) {
    Chain chain(3);
    EXPECT_TRUE(chain.advance(target, 1.0e5, 0.1, 8));
    EXPECT_FALSE(chain.advance(target, twice, 0.1, 8)) << twice;
  }
}
