/* gear_quat_limits.h: motions beyond the limits, and non-finite ones. */

#include "checks.h"
#include "gear_quat_limits.h"

#include <limits>

using namespace LAMMPS_NS::GearQuat;

namespace {

const double INFINITE = std::numeric_limits<double>::infinity();
const double NO_NUMBER = std::numeric_limits<double>::quiet_NaN();
constexpr double H = 0.01, LENGTH = 20.0;

BodyState at_rest()
{
  return {{1, 2, 3}, {0.5, 0.5, 0.5, 0.5}, {0, 0, 0}, {0, 0, 0}};
}

}    // namespace

TEST(Limits, HalfATurnAndTheSceneInOneStep)
{
  for (const double h : {H, -H}) {
    const MotionLimits limits(h, LENGTH);
    EXPECT_TRUE(limits.keep(at_rest()));
    for (int k = 0; k < 3; ++k)
      for (const double part : {0.99, 1.01}) {
        BodyState moves = at_rest(), turns = at_rest();
        moves.velocity[k] = -part * LENGTH / H;
        turns.omega_body[k] = part * std::acos(-1.0) / H;
        EXPECT_EQ(limits.keep(moves), part < 1.0);
        EXPECT_EQ(limits.keep(turns), part < 1.0);
      }
  }
}

TEST(Limits, LengthOfTheQuaternion)
{
  const MotionLimits limits(H, LENGTH);
  for (const double part : {0.99, 1.01}) {
    BodyState longer = at_rest(), shorter = at_rest();
    for (double &component : longer.q) component *= part * 10.0;
    for (double &component : shorter.q) component /= part * 10.0;
    EXPECT_EQ(limits.keep(longer), part < 1.0);
    EXPECT_EQ(limits.keep(shorter), part < 1.0);
    EXPECT_TRUE(limits.keep_velocities(longer));
  }
}

TEST(Limits, WhatIsNoNumber)
{
  const MotionLimits limits(H, INFINITE);    // no limit in space either
  BodyState far = at_rest();
  far.velocity[0] = 1.0e100;
  EXPECT_TRUE(limits.keep(far));
  for (const double bad : {INFINITE, -INFINITE, NO_NUMBER}) {
    for (int k = 0; k < 3; ++k) {
      BodyState moves = at_rest(), turns = at_rest();
      moves.velocity[k] = turns.omega_body[k] = bad;
      EXPECT_FALSE(limits.keep(moves));
      EXPECT_FALSE(limits.keep(turns));
    }
    for (int k = 0; k < 4; ++k) {
      BodyState bent = at_rest();
      bent.q[k] = bad;
      EXPECT_FALSE(limits.keep(bent));
    }
  }
}

TEST(Limits, AKickIsWhatALoadMakesOfVelocities)
{
  const RigidBody body = {2.0, {3.0, 2.0, 1.0}};
  BodyState s = at_rest();
  s.velocity[1] = 5.0;
  s.omega_body[2] = 7.0;
  const Load load = {{4.0, 0.0, 0.0}, {6.0, 0.0, 0.0}};
  // this q permutes the axes: x in space is z in the body
  const BodyState after = kicked(body, s, load, 0.5);
  const double velocity[3] = {1.0, 5.0, 0.0}, omega_body[3] = {0.0, 0.0, 10.0};
  EXPECT_LT(Check::largest_difference(after.velocity, velocity, 3), 1e-14);
  EXPECT_LT(Check::largest_difference(after.omega_body, omega_body, 3), 1e-14);
}

TEST(Limits, TheFastestOscillation)
{
  // velocities of a stable motion are bounded, and velocities of a motion 5 % faster are not; the
  // limits are the ones in the manual, where spurious roots leave the unit circle
  for (const auto &[values, limit] : {std::pair{4, 1.05}, {7, 0.71}, {9, 0.61}}) {
    Scheme scheme;
    scheme.rows = values;
    scheme.tuned = true;
    const double found = fastest_oscillation(scheme);
    EXPECT_NEAR(found, limit, 0.03);
    EXPECT_TRUE(survives_oscillation(scheme, 0.9 * limit));
    EXPECT_FALSE(survives_oscillation(scheme, 1.1 * limit));
  }
}

TEST(Limits, RoundedDown)
{
  EXPECT_DOUBLE_EQ(rounded_down(1.299), 1.2);
  EXPECT_DOUBLE_EQ(rounded_down(0.0171), 0.017);
  EXPECT_DOUBLE_EQ(rounded_down(20.0), 20.0);
  EXPECT_DOUBLE_EQ(rounded_down(3.0e-17), 3.0e-17);
  EXPECT_EQ(rounded_down(INFINITE), INFINITE);
}
