/* The extrapolated flow, compared with the exact free top and an oscillator. */

#include "checks.h"
#include "oracles/exact_flow.h"
#include "oracles/swinging_top.h"

using namespace Oracle;

TEST(OracleExactFlow, FollowsTheSwingingTop)
{
  auto distance = [](const RigidBody &body, double from, double h) {
    const BodyState s = ExactFlow(body, swing)(top_state(from), h), e = top_state(from + h);
    double worst = Check::quaternion_distance(s.q, e.q);
    worst = std::max(worst, Check::largest_difference(s.center, e.center, 3));
    worst = std::max(worst, Check::largest_difference(s.velocity, e.velocity, 3));
    return std::max(worst, Check::largest_difference(s.omega_body, e.omega_body, 3));
  };
  for (double from : {0.0, 0.3, 0.6})
    for (double h : {-0.3, 0.05, 0.3}) EXPECT_LT(distance(TOP, from, h), 3e-15) << from << ' ' << h;
  EXPECT_LT(distance(TOP, 0.0, 0.9), 1e-13);
}

TEST(OracleExactFlow, TwoStepsAreOneUnderTorque)
{
  // a restoring torque along the space axes
  auto load = [](const BodyState &s, double norm2) {
    Load l = swing(s, norm2);
    for (int i = 0; i < 3; ++i) l.torque_space[i] = -s.q[3] * s.q[i] + 0.3 * s.center[i];
    return l;
  };
  const ExactFlow flow(TOP, load);
  const BodyState s = top_state(0.2), once = flow(s, 0.4), twice = flow(flow(s, 0.1), 0.3);
  EXPECT_LT(Check::largest_difference(once.q, twice.q, 4), 1e-15);
  EXPECT_LT(Check::largest_difference(once.omega_body, twice.omega_body, 3), 1e-15);
  EXPECT_LT(Check::largest_difference(once.center, twice.center, 3), 1e-15);
}
