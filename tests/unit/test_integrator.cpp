/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* gear_quat_integrator.h along motions that are known exactly: the error falls with the order of
   the method, down to rounding.  Single steps are compared in test_paper_step.cpp. */

#include "checks.h"
#include "drive.h"
#include "oracles/free_top.h"

using namespace Drive;
using Check::slopes;
using std::vector;

namespace {

const vector<Scheme> SCHEMES = [] {
  Scheme first = scheme_of(Formulation::FIRST), second = scheme_of(Formulation::SECOND);
  Scheme velocity = second;
  velocity.velocity_c0 = true;
  return vector<Scheme>{first, second, velocity};
}();
const char *NAMES[] = {"first", "second 3/20", "second 3/16"};

/// Errors at `time` for steps time/n, time/2n, ...
template <class Distance>
vector<double> errors(const RigidBody &body, const BodyState &start, const LoadOf &load,
                      const Scheme &scheme, double time, const vector<double> &h, Distance distance)
{
  vector<double> error;
  for (double step : h) {
    Motion motion(body, start, load, scheme, step, Start::BOOTSTRAP, 0.05);
    motion.steps(int(std::lround(time / step)));
    error.push_back(distance(motion.state()));
  }
  return error;
}

void report(const char *what, const char *scheme, const vector<double> &h, const vector<double> &e)
{
  std::printf("%-24s %-12s", what, scheme);
  for (double x : e) std::printf(" %.1e", x);
  std::printf("  slopes");
  for (double p : slopes(h, e)) std::printf(" %.2f", p);
  std::printf("\n");
}

vector<double> halvings(double h, int n)
{
  vector<double> list = {h};
  while (int(list.size()) <= n) list.push_back(list.back() / 2);
  return list;
}

vector<double> head(const vector<double> &v, int n)
{
  return {v.begin(), v.begin() + n};
}

/// Distance of a state from the exact free top in omega and attitude.
double from_top(const Oracle::FreeTop &top, double t, const BodyState &s)
{
  double a[9], worst = 0.0;
  long double w[3];
  rotation_matrix(s.q, dot4(s.q, s.q), a);
  top.omega(t, w);
  const Oracle::Matrix exact = top.attitude(t);
  for (int i = 0; i < 9; ++i)
    worst = std::max(worst, std::fabs(a[i] - double(exact.m[i / 3][i % 3])));
  for (int i = 0; i < 3; ++i) worst = std::max(worst, std::fabs(s.omega_body[i] - double(w[i])));
  return worst;
}

}    // namespace

TEST(Integrator, FreeAsymmetricTopFromThetaZeroInBothRegimes)
{
  const RigidBody body = {1.0, {3.0, 2.0, 1.2}};
  const double spins[2][3] = {{1.0, 0.4, 0.5}, {-0.3, 0.2, 1.1}};
  for (const auto &spin : spins)
    for (int n = 0; n < 3; ++n) {
      BodyState start = {};
      Oracle::euler_quaternion(0.7, 0.4, 0.0, start.q);    // Euler's equations of angles fail here
      std::copy(spin, spin + 3, start.omega_body);
      const long double moments[3] = {3.0L, 2.0L, 1.2L}, w[3] = {spin[0], spin[1], spin[2]};
      const Oracle::FreeTop top(moments, w, Oracle::euler_matrix(0.7L, 0.4L, 0.0L));
      const vector<double> h = halvings(0.1, 8);
      auto distance = [&](const BodyState &s) {
        return from_top(top, 6.0, s);
      };
      const vector<double> e = errors(body, start, free_of_load, SCHEMES[n], 6.0, h, distance);
      report(top.about_largest() ? "free top, largest axis" : "free top, smallest axis", NAMES[n],
             h, e);
      EXPECT_GT(Check::smallest(slopes(head(h, 5), head(e, 5))), 4.7);
      EXPECT_LT(*std::min_element(e.begin(), e.end()), 1e-13);    // down to rounding
      EXPECT_LT(e.back(), 5e-13);                                 // and not up again far

      RigidBody heavier = body;    // 1 % in a moment: no order is left
      heavier.inertia[1] *= 1.01;
      const vector<double> bad =
          errors(heavier, start, free_of_load, SCHEMES[n], 6.0, head(h, 5), distance);
      EXPECT_LT(slopes(head(h, 5), bad).back(), 0.1);
    }
}

TEST(Integrator, RodTurnsUniformlyAndUnderTorque)
{
  // torque along body x from rest about it: angle = omega t + torque/(2 I) t^2, from theta = 0
  const double torque = 0.9, omega = 1.5, time = 4.0;
  for (int none : {1, 2})    // the axis without inertia
    for (double push : {0.0, torque})
      for (int n = 0; n < 3; ++n) {
        RigidBody rod = {1.0, {2.0, 2.0, 2.0}};
        rod.inertia[none] = 0.0;
        BodyState start = {};
        start.q[3] = 1.0;
        start.omega_body[0] = omega;
        auto load = [&](const BodyState &, double) {
          Load l = {};
          l.torque_space[0] = push;    // x of the body stays x of space
          return l;
        };
        auto distance = [&](const BodyState &s) {
          const double angle = omega * time + 0.5 * push / 2.0 * time * time;
          const double q[4] = {std::sin(angle / 2), 0.0, 0.0, std::cos(angle / 2)};
          const double w = omega + push / 2.0 * time;
          return std::max(Check::quaternion_distance(q, s.q), std::fabs(s.omega_body[0] - w));
        };
        const vector<double> h = halvings(0.05, 4);
        const vector<double> e = errors(rod, start, load, SCHEMES[n], time, h, distance);
        report(push > 0.0 ? "driven rod" : "free rod", NAMES[n], h, e);
        // over all: terms of order 5 and 6 of opposite sign make single slopes uneven here
        EXPECT_GT(slopes({h[0], h[3]}, {e[0], e[3]})[0], 4.7);
        EXPECT_LT(e.back(), 1e-11);
        start.omega_body[0] *= 1.01;    // 1 % in the spin: no order is left
        EXPECT_LT(slopes(h, errors(rod, start, load, SCHEMES[n], time, h, distance)).back(), 0.1);
      }
}

TEST(Integrator, PointFallsAndNeverTurns)
{
  const RigidBody point = {2.0, {0.0, 0.0, 0.0}};
  BodyState start = {};
  start.q[0] = 0.6;
  start.q[3] = 0.8;
  start.velocity[1] = 0.25;
  auto load = [](const BodyState &, double) {
    return Load{{0.0, -3.0, 0.0}, {1.0, 1.0, 1.0}};
  };
  for (const Scheme &scheme : SCHEMES) {
    Motion motion(point, start, load, scheme, 0.125, Start::FORCES, 0.125);
    motion.steps(80);
    const BodyState s = motion.state();
    EXPECT_NEAR(s.center[1], 2.5 - 75.0, 1e-12);
    EXPECT_NEAR(s.velocity[1], 0.25 - 15.0, 1e-12);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(s.q[i], start.q[i]);
    for (double w : s.omega_body) EXPECT_EQ(w, 0.0);
  }
}

TEST(Integrator, HarmonicForceHasTheOrderOfItsCoefficients)
{
  const RigidBody body = {2.5, {1.0, 1.0, 1.0}};
  const double time = 10.0, least[3] = {4.7, 5.8, 4.7};
  BodyState start = {};
  start.q[3] = 1.0;
  start.center[0] = 1.0;    // cosine, sine and both
  start.velocity[1] = 1.0;
  start.center[2] = start.velocity[2] = 0.7;
  auto spring = [&](double k) {
    return [&body, k](const BodyState &s, double) {
      Load l = {};
      for (int i = 0; i < 3; ++i) l.force[i] = -k * body.mass * s.center[i];
      return l;
    };
  };
  const double c = std::cos(time), d = std::sin(time);
  const double x[3] = {c, d, 0.7 * (c + d)}, v[3] = {-d, c, 0.7 * (c - d)};
  auto distance = [&](const BodyState &s) {
    return Check::largest_difference(x, s.center, 3);
  };
  auto in_velocity = [&](const BodyState &s) {
    return Check::largest_difference(v, s.velocity, 3);
  };
  const vector<double> h = halvings(0.1, 4);
  for (int n = 0; n < 3; ++n) {
    const vector<double> e = errors(body, start, spring(1.0), SCHEMES[n], time, h, distance);
    report("oscillator", NAMES[n], h, e);
    EXPECT_GT(Check::smallest(slopes(head(h, 4), head(e, 4))), least[n]);
    // the velocity row of the second formulation keeps an error of order 5 with either c_0
    const vector<double> ev = errors(body, start, spring(1.0), SCHEMES[n], time, h, in_velocity);
    report("oscillator, velocity", NAMES[n], h, ev);
    EXPECT_GT(Check::smallest(slopes(head(h, 4), head(ev, 4))), 4.7);
    const vector<double> bad = errors(body, start, spring(1.01), SCHEMES[n], time, h, distance);
    EXPECT_LT(Check::smallest(slopes(h, bad)), 0.1);
  }
}

TEST(Integrator, RunsBackToWhereItStarted)
{
  // the same history rescaled by -1, step -h: the motion returns, to the order of the method
  const RigidBody body = {1.0, {3.0, 2.0, 1.2}};
  BodyState start = {};
  start.q[3] = 1.0;
  start.omega_body[0] = 1.0;
  start.omega_body[1] = 0.4;
  for (const Scheme &scheme : SCHEMES) {
    vector<double> error, h = halvings(0.1, 3);
    for (double step : h) {
      const int n = int(std::lround(3.0 / step));
      Motion there(body, start, free_of_load, scheme, step, Start::BOOTSTRAP, 0.05);
      there.steps(n);
      Motion back(body, start, free_of_load, scheme, -step, Start::BOOTSTRAP, 0.05);
      std::copy(there.rows, there.rows + scheme.size(), back.rows);
      back.integrator.rescale(back.rows, -1.0);
      back.steps(n);
      error.push_back(Check::quaternion_distance(back.q(), start.q));
    }
    EXPECT_GT(Check::smallest(slopes(h, error)), 4.5);
    EXPECT_LT(error.back(), 1e-7);
  }
}
