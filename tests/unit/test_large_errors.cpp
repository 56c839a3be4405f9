/* LargeErrors: which errors of a step are counted, and which counts mean collisions. */

#include "gear_quat_large_errors.h"

#include <algorithm>
#include <gtest/gtest.h>

using namespace LAMMPS_NS::GearQuat;

namespace {

constexpr double H = 0.1, REACH = 1.5;

struct Body {
  RigidBody rigid = {2.0, {3.0, 4.0, 5.0}};
  double reach() const { return REACH; }
  double length(const Correction &error) const
  {
    return std::max(error.position_error(), REACH * error.angle_error());
  }
};

BodyState at_rest()
{
  BodyState state = BodyState();
  state.q[3] = 1.0;
  return state;
}

/// The errors of a position and of an angle.
Correction errors(double position, double angle)
{
  return {0.0, position * position, 0.25 * angle * angle};
}

/// Large errors among one step with this error.
double counted(const BodyState &state, const Load &load, const Correction &error)
{
  LargeErrors large;
  large.begin_step(-H);
  large.note(Body(), state, load, error);
  EXPECT_EQ(large.counted().all, 1.0);
  return large.counted().large;
}

/// An error is counted from this part of a step's motion on, to within 1 %.
void counted_beyond_a_tenth(const BodyState &state, const Load &load, double motion)
{
  const double limit = LargeErrors::LARGE * motion;
  EXPECT_EQ(counted(state, load, errors(0.99 * limit, 0.0)), 0.0);
  EXPECT_EQ(counted(state, load, errors(1.01 * limit, 0.0)), 1.0);
  EXPECT_EQ(counted(state, load, errors(0.0, 0.99 * limit / REACH)), 0.0);
  EXPECT_EQ(counted(state, load, errors(0.0, 1.01 * limit / REACH)), 1.0);
}

}    // namespace

TEST(LargeErrors, AreComparedWithTheMotionInTheStep)
{
  BodyState state = at_rest();
  state.velocity[1] = 2.0;
  counted_beyond_a_tenth(state, Load(), H * 2.0);
  state.omega_body[0] = 3.0;    // about a principal axis, so it does not change
  counted_beyond_a_tenth(state, Load(), H * (2.0 + REACH * 3.0));
}

TEST(LargeErrors, AreComparedWithTheAccelerationWhereABodyTurnsBack)
{
  Load load = Load();
  load.force[2] = 7.0;
  counted_beyond_a_tenth(at_rest(), load, H * H * 7.0 / 2.0);
  load.torque_space[1] = 6.0;
  counted_beyond_a_tenth(at_rest(), load, H * H * (7.0 / 2.0 + REACH * 6.0 / 4.0));
}

TEST(LargeErrors, OfRestingBodiesAreRounding)
{
  const double limit = LargeErrors::ROUNDING * REACH;
  EXPECT_EQ(counted(at_rest(), Load(), errors(0.99 * limit, 0.0)), 0.0);
  EXPECT_EQ(counted(at_rest(), Load(), errors(1.01 * limit, 0.0)), 1.0);
}

TEST(LargeErrors, AreNotCountedWhileHistoriesSettle)
{
  constexpr int VALUES = 7;
  LargeErrors large;
  const auto step = [&] {
    large.begin_step(H);
    large.note(Body(), at_rest(), Load(), errors(1.0, 1.0));
    return large.counted().large;
  };
  for (const bool again : {false, true}) {
    if (again)
      large.settle(VALUES);
    else
      large.begin(VALUES);
    const double before = large.counted().large;
    for (int n = 1; n < 2 * VALUES; ++n) EXPECT_EQ(step(), before);
    EXPECT_EQ(step(), before + 1.0);
  }
  large.begin_run();
  EXPECT_EQ(large.counted().all, 0.0);
  EXPECT_EQ(step(), 1.0);
}

TEST(LargeErrors, InFewStepsAreCollisions)
{
  const auto collisions = [](double large, double all) {
    return LargeErrors::Counts{large, all}.show_collisions();
  };
  EXPECT_FALSE(collisions(0.0, 0.0));
  EXPECT_FALSE(collisions(0.0, 1e6));
  EXPECT_FALSE(collisions(9.9, 1e6));
  EXPECT_TRUE(collisions(10.1, 1e6));
  EXPECT_TRUE(collisions(4.99e4, 1e6));
  EXPECT_FALSE(collisions(5.01e4, 1e6));
}
