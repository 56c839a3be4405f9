/* Collisions from free flight under a tolerance: none becomes unstable, and the error of the energy
   is within the tolerance. */

#include "checks.h"
#include "collisions.h"

#include <cstdlib>

using namespace Drive;

namespace {

/// The environment may request more: GEARQUAT_COLLISIONS=10000 takes some minutes.
int number_of_collisions()
{
  const char *asked = std::getenv("GEARQUAT_COLLISIONS");
  return asked ? std::atoi(asked) : 80;
}

/// Each eps has its own collisions.
void expect_all(bool energy, double most_for_eps)
{
  const double eps[] = {1e-6, 1e-8, 1e-10, 1e-12};
  double largest[4] = {};
  for (int which = 0; which < number_of_collisions(); ++which) {
    const int k = which / 2 % 4;
    const Outcome met = collide(Collision(which), eps[k], energy, 20000);
    ASSERT_TRUE(met.arrived && std::isfinite(met.error)) << "collision " << which;
    EXPECT_LE(met.worst, 1.0) << "collision " << which;
    EXPECT_LT(met.repeated, 0.2 * met.evaluations + 10) << "collision " << which;
    largest[k] = std::max(largest[k], met.error / met.depth);
  }
  for (int k = 0; k < 4; ++k) EXPECT_LT(largest[k], most_for_eps * eps[k]) << "eps " << eps[k];
  EXPECT_LT(largest[3], 1e-8);
}

}    // namespace

TEST(Collisions, ToleranceIsALength)
{
  expect_all(false, 1e5);
}

TEST(Collisions, ToleranceIsAnEnergy)
{
  expect_all(true, 1e3);
}
