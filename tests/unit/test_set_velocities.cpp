/* Integrator::set_velocities(): a thermostat scales the velocities of a body repeatedly.  With the
   remaining rows of the history the motion afterwards is of second order, not first, and the
   function does not act as a corrector. */

#include "checks.h"
#include "drive.h"
#include "oracles/free_top.h"

using namespace Drive;
using std::vector;

namespace {

constexpr double FACTOR = 0.9, EVERY = 0.5;
constexpr int KICKS = 6;
const vector<double> STEPS = {0.05, 0.025, 0.0125, 0.00625};

const Scheme SCHEMES[] = {scheme_of(FIRST, 0, 2), scheme_of(FIRST, 0, 2, true),
                          scheme_of(SECOND, 0, 2), scheme_of(SECOND, 0, 2, true)};

/// The state after KICKS times EVERY steps, with velocities scaled at the end of each.
BodyState kicked_motion(const RigidBody &body, const BodyState &start, const LoadOf &load,
                        const Scheme &scheme, double h)
{
  Motion motion(body, start, load, scheme, h, Start::BOOTSTRAP, 0.05);
  for (int n = 0; n < KICKS; ++n) {
    motion.run(EVERY);
    BodyState state = motion.state();
    for (int k = 0; k < 3; ++k) {
      state.velocity[k] *= FACTOR;
      state.omega_body[k] *= FACTOR;
    }
    motion.integrator.set_velocities(body, state, load(state, 1.0), motion.rows);
    const BodyState kept = motion.state();
    EXPECT_LT(Check::largest_difference(kept.velocity, state.velocity, 3), 1e-15);
    EXPECT_LT(Check::largest_difference(kept.omega_body, state.omega_body, 3), 1e-14);
    EXPECT_EQ(Check::largest_difference(kept.q, state.q, 4), 0.0);
  }
  return motion.state();
}

}    // namespace

/// When the angular velocity of a free top is scaled, it continues along the same path, more
/// slowly.
TEST(SetVelocities, FreeTop)
{
  const RigidBody body = {1.0, {3.0, 2.0, 1.2}};
  BodyState start = {{}, {}, {1.0, 0.0, 0.0}, {1.0, 0.4, 0.5}};
  Oracle::euler_quaternion(0.7, 0.4, 0.0, start.q);
  const long double moments[3] = {3.0L, 2.0L, 1.2L}, w[3] = {1.0L, 0.4L, 0.5L};
  const Oracle::FreeTop top(moments, w, Oracle::euler_matrix(0.7L, 0.4L, 0.0L));
  double way = 0.0, slower = 1.0;
  for (int n = 0; n < KICKS; ++n, slower *= FACTOR) way += slower * EVERY;
  const Oracle::Matrix exact = top.attitude(way);

  for (const Scheme &scheme : SCHEMES) {
    vector<double> error;
    for (const double h : STEPS) {
      const BodyState s = kicked_motion(body, start, free_of_load, scheme, h);
      error.push_back(std::max(std::fabs(s.center[0] - way), Check::attitude_distance(s.q, exact)));
    }
    EXPECT_GT(Check::smallest(Check::slopes(STEPS, error)), 1.8) << scheme;
  }
}

/// A rod under a constant torque about its axis of rotation.
TEST(SetVelocities, RodUnderTorque)
{
  const RigidBody rod = {1.0, {2.0, 0.0, 2.0}};
  const double torque = 0.9;
  const BodyState start = {{}, {0.0, 0.0, 0.0, 1.0}, {}, {1.5, 0.0, 0.0}};
  const LoadOf load = constant({{}, {torque, 0.0, 0.0}});
  double angle = 0.0, omega = start.omega_body[0];
  for (int n = 0; n < KICKS; ++n) {
    angle += omega * EVERY + 0.25 * torque * EVERY * EVERY;
    omega = FACTOR * (omega + 0.5 * torque * EVERY);
  }
  const double exact[4] = {std::sin(0.5 * angle), 0.0, 0.0, std::cos(0.5 * angle)};

  for (const Scheme &scheme : SCHEMES) {
    vector<double> error;
    for (const double h : STEPS) {
      error.push_back(
          Check::quaternion_distance(kicked_motion(rod, start, load, scheme, h).q, exact));
    }
    EXPECT_GT(Check::smallest(Check::slopes(STEPS, error)), 1.8) << scheme;
  }
}

/// A thermostat with a factor of one does not change the motion: velocities are set to their own
/// values after every step of a spinning top.
TEST(SetVelocities, TheSameInEveryStep)
{
  constexpr double H = 0.05;    // few values are less accurate than this test requires
  const RigidBody body = {1.0, {3.0, 2.0, 1.2}};
  const BodyState start = {{}, {0.0, 0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}, {1.0, 0.4, 0.5}};
  for (const Formulation formulation : FORMULATIONS)
    for (const Scheme &scheme : schemes_of(formulation, 2)) {
      if (scheme.first() ? scheme.values() < 5 : scheme.values() < 6) continue;
      Motion left(body, start, free_of_load, scheme, H, Start::BOOTSTRAP, H);
      Motion set(body, start, free_of_load, scheme, H, Start::BOOTSTRAP, H);
      for (int n = 0; n < 2000; ++n) {
        left.step();
        set.step();
        set.integrator.set_velocities(body, set.state(), Load{}, set.rows);
      }
      EXPECT_LT(Check::quaternion_distance(left.state().q, set.state().q), 1e-6) << scheme;
    }
}
