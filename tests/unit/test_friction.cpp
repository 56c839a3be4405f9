/* Bodies under a constant friction, which is taken implicitly. */

#include "drive.h"

#include <gtest/gtest.h>

using namespace Drive;

namespace {

/// The speed and the angular velocity of a free body after this many steps of 1 under a constant
/// friction, relative to the start; both have to decay.
double remains(const Scheme &scheme, double friction)
{
  const RigidBody body = {1.3, {0.7, 0.7, 0.7}};
  const BodyState start = {{}, {0, 0, 0, 1}, {0.01, 0.0, 0.0}, {0.0, 0.01, 0.0}};
  const Integrator integrator(scheme, 1.0);
  std::vector<double> rows(scheme.size());
  seed(scheme, body, local_series(body, start, Load{}, 1.0), 1.0, 1.0, rows.data());
  Friction implicit = Multipliers{friction, friction};
  implicit.implicit = true;
  BodyState state = start;
  for (int step = 0; step < 5000; ++step) {
    integrator.predict(body, rows.data());
    integrator.correct(body, Load{}, rows.data(), implicit);
    state = integrator.body_state(body, rows.data());
    const double most = std::max(std::fabs(state.velocity[0]), std::fabs(state.omega_body[1]));
    if (!(most < 1.0e3)) return HUGE_VAL;
  }
  return std::max(std::fabs(state.velocity[0]), std::fabs(state.omega_body[1])) / 0.01;
}

}    // namespace

TEST(Friction, AFreeBodyComesToRest)
{
  for (int values = 5; values <= SECOND_MOST; ++values) {
    const Scheme scheme = scheme_of(MOMENTUM, values);
    EXPECT_LT(remains(scheme, 0.1), 1.0e-3) << scheme;
  }
}
