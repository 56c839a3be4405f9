/* A body without moments of inertia: the omitted operations of a step change no bit of its
   motion. */

#include "drive.h"

#include <gtest/gtest.h>

using namespace Drive;

namespace {

const RigidBody POINT = {1.7, {0.0, 0.0, 0.0}};

Load pull(const double *x)
{
  return {{-x[0] + 0.1 * x[1], std::sin(x[1]), -2.0 * x[2]}, {0.3, -0.2, 0.1}};
}

/// History of a moving point, in a scheme.
std::vector<double> history(const Scheme &scheme, double h)
{
  BodyState s = {{0.4, -0.3, 1.0}, {0.0, 0.0, 0.0, 1.0}, {0.1, 0.7, -0.2}, {0.0, 0.0, 0.0}};
  std::vector<double> rows(scheme.size(), 0.0);
  seed(scheme, POINT, local_series(POINT, s, pull(s.center), h), h, h, rows.data());
  return rows;
}

}    // namespace

TEST(Points, MoveToTheBitAsWithRotation)
{
  const double h = 0.03;
  for (const bool compensate : {false, true})
    for (const Scheme &scheme : every_scheme(2, compensate)) {
      const Integrator integrator(scheme, h);
      std::vector<double> whole = history(scheme, h), center = whole, changed = whole;
      BodyState kept = integrator.body_state(POINT, center.data());
      for (int step = 0; step < 40; ++step) {
        integrator.predict(POINT, whole.data());
        const BodyState s = integrator.body_state(POINT, whole.data());
        const Correction told = integrator.correct(POINT, pull(s.center), whole.data());

        integrator.predict_center(center.data());
        integrator.center_state(POINT, center.data(), kept);
        for (int k = 0; k < 3; ++k) {
          EXPECT_EQ(kept.center[k], s.center[k]);
          EXPECT_EQ(kept.velocity[k], s.velocity[k]);
          EXPECT_EQ(kept.omega_body[k], 0.0);
        }
        const Correction short_told =
            integrator.correct_center(POINT, pull(kept.center), center.data());
        EXPECT_EQ(short_told.work, told.work);
        EXPECT_EQ(short_told.position_error(), told.position_error());
        EXPECT_EQ(short_told.angle_error(), told.angle_error());
      }
      for (size_t i = 0; i < whole.size(); ++i) EXPECT_EQ(whole[i], center[i]) << i;
    }
}
