/* gear_quat_limits.h: rotations that are unstable in the trial are unstable in long runs, and vice
   versa. */

#include "drive.h"
#include "gear_quat_limits.h"

#include <gtest/gtest.h>

using namespace Drive;

namespace {

const RigidBody CARBON_DIOXIDE = {43.98, {43.06, 43.057, 0.0035}};    // bent by 0.02 Angstrom

BodyState spinning(double omega)
{
  return {{0, 0, 0}, {0, 0, 0, 1}, {0.1, 0, 0}, {0.0, 0.002, omega}};
}

/// Slowest unstable rotation, in radians per step, to 1 %.
double limit(const Scheme &scheme, double h)
{
  double slow = 0.0, fast = 4.0;
  while (fast - slow > 0.01 * fast) {
    const double middle = 0.5 * (slow + fast);
    (survives_flight(scheme, CARBON_DIOXIDE, spinning(middle / h), h) ? slow : fast) = middle;
  }
  return fast;
}

}    // namespace

TEST(Flight, MoreValuesFollowSlowerSpins)
{
  for (const Formulation formulation : {FIRST, SECOND}) {
    double last = 4.0;
    for (const Scheme &scheme : schemes_of(formulation, 2)) {
      if (scheme.values() < 5) continue;
      const double now = limit(scheme, 1.0);
      EXPECT_LT(now, 1.02 * last) << scheme;
      EXPECT_GT(now, FLIGHT_SLOW) << scheme;    // slower rotations are stable without a trial
      EXPECT_NEAR(limit(scheme, -0.5), now, 0.02 * now);
      last = now;
    }
  }
}

TEST(Flight, EightValuesFollowAlmostHalfARadian)
{
  const Scheme scheme = scheme_of(SECOND, 8, 2);
  const double lost = limit(scheme, 1.0);
  EXPECT_GT(lost, 0.4);
  EXPECT_LT(lost, 0.55);
}

TEST(Flight, TheLongestStepIsOneThatIsFollowed)
{
  for (const Scheme &scheme : {scheme_of(SECOND, 8, 2), scheme_of(FIRST, 6, 2)})
    for (const double omega : {0.6, 2.7, 100.0}) {
      const BodyState state = spinning(omega);
      const double step = longest_step(scheme, CARBON_DIOXIDE, state, 1.0);
      EXPECT_TRUE(survives_flight(scheme, CARBON_DIOXIDE, state, step, 2000)) << scheme << omega;
      EXPECT_EQ(survives_flight(scheme, CARBON_DIOXIDE, state, 1.0), step == 1.0)
          << scheme << omega;
      EXPECT_GT(step * omega, 0.15);
    }
}
