/* gear_quat_integrator.h along known motions: in the paper's cage, of the free top down to
   rounding, of a point, and back in time.  Orders are in test_orders.cpp, single steps in
   test_paper_step.cpp. */

#include "scenes.h"

using namespace Drive;

namespace {

const vector<Scheme> SCHEMES = {scheme_of(FIRST), scheme_of(SECOND),
                                with_velocity_c0(scheme_of(SECOND))};

}    // namespace

TEST(Integrator, FollowsTheReferencesInTheCage)
{
  for (const CageReference &reference : CAGE_REFERENCES)
    for (Formulation formulation : {FIRST, SECOND}) {
      const CageScene scene(reference.test_case, reference.consistent);
      EXPECT_LT(error(cage(scene, reference), scheme_of(formulation), 0.02, 0.05),
                formulation == FIRST ? 1e-7 : 1e-9)
          << "case " << reference.test_case << ", t = " << reference.time;
    }
}

TEST(Integrator, FreeAsymmetricTopFromThetaZeroInBothRegimes)
{
  const long double moments[3] = {3.0L, 2.0L, 1.2L};
  const double time = 6.0, spins[2][3] = {{1.0, 0.4, 0.5}, {-0.3, 0.2, 1.1}};
  const vector<double> h = Check::halvings(0.1, 8), first(h.begin(), h.begin() + 5);
  for (const auto &spin : spins)
    for (const Scheme &scheme : SCHEMES) {
      Scene scene = {{1.0, {3.0, 2.0, 1.2}}, {}, free_of_load, time, {}};
      // Euler's equations of angles are singular here
      Oracle::euler_quaternion(0.7, 0.4, 0.0, scene.start.q);
      std::copy(spin, spin + 3, scene.start.omega_body);
      const long double w[3] = {spin[0], spin[1], spin[2]};
      const Oracle::FreeTop top(moments, w, Oracle::euler_matrix(0.7L, 0.4L, 0.0L));
      scene.missed = [&](const BodyState &s) {
        long double omega[3];
        top.omega(time, omega);
        double worst = Check::attitude_distance(s.q, top.attitude(time));
        for (int i = 0; i < 3; ++i)
          worst = std::max(worst, std::fabs(s.omega_body[i] - double(omega[i])));
        return worst;
      };
      const vector<double> e = errors(scene, scheme, h, 0.05);
      EXPECT_GT(Check::smallest(Check::slopes(first, e)), 4.7) << scheme;
      EXPECT_LT(Check::smallest(e), 1e-13);    // down to rounding
      EXPECT_LT(e.back(), 5e-13);              // with little growth afterwards
    }
}

TEST(Integrator, PointFallsAndNeverTurns)
{
  const RigidBody point = {2.0, {0.0, 0.0, 0.0}};
  const BodyState start = {{}, {0.6, 0.0, 0.0, 0.8}, {0.0, 0.25, 0.0}, {}};
  const LoadOf load = constant({{0.0, -3.0, 0.0}, {1.0, 1.0, 1.0}});
  for (const Scheme &scheme : SCHEMES) {
    Motion motion(point, start, load, scheme, 0.125, Start::FORCES, 0.125);
    motion.run(10.0);
    const BodyState s = motion.state();
    EXPECT_NEAR(s.center[1], 2.5 - 75.0, 1e-12);
    EXPECT_NEAR(s.velocity[1], 0.25 - 15.0, 1e-12);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(s.q[i], start.q[i]);
    for (double w : s.omega_body) EXPECT_EQ(w, 0.0);
  }
}

TEST(Integrator, RunsBackToWhereItStarted)
{
  // the same history rescaled by -1, step -h: the motion is reversed, to the order of the method
  const RigidBody body = {1.0, {3.0, 2.0, 1.2}};
  const BodyState start = {{}, {0.0, 0.0, 0.0, 1.0}, {}, {1.0, 0.4, 0.0}};
  const vector<double> h = Check::halvings(0.1, 3);
  for (const Scheme &scheme : SCHEMES) {
    vector<double> error;
    for (double step : h) {
      Motion there(body, start, free_of_load, scheme, step, Start::BOOTSTRAP, 0.05);
      there.run(3.0);
      Motion back(body, free_of_load, scheme, -step, there.history);
      back.integrator.rescale(back.rows, -1.0);
      back.run(-3.0);
      error.push_back(Check::quaternion_distance(back.q(), start.q));
    }
    EXPECT_GT(Check::smallest(Check::slopes(h, error)), 4.5);
    EXPECT_LT(error.back(), 1e-7);
  }
}
