/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* gear_quat_startup.h: the rows a history starts from, against exact Taylor coefficients, under
   translation and reversal of time, and for the shorter starts. */

#include "checks.h"
#include "drive.h"
#include "oracles/cage_scene.h"
#include "oracles/swinging_top.h"

using namespace Drive;
using Check::slopes;
using Oracle::exact_rows;
using Oracle::swing;
using Oracle::TOP;
using Oracle::top_state;
using std::vector;

namespace {

double distance(const vector<double> &a, const vector<double> &b)
{
  return Check::largest_difference(a.data(), b.data(), int(a.size()));
}

const Formulation BOTH[] = {Formulation::FIRST, Formulation::SECOND};

}    // namespace

TEST(Startup, EveryRowIsItsTaylorCoefficient)
{
  // row by row against its own size; spacings at which truncation is below 0.3 % in the highest row
  // and rounding as well
  for (const Scheme &scheme : every_scheme()) {
    const double h = scheme.first() ? 0.02 : scheme.values() > 10 ? 0.07 : 0.05;
    const vector<double> exact = exact_rows(scheme, h);
    Check::holds_and_refuses_one_percent(
        started(scheme, TOP, top_state(0.0), swing, h, Start::BOOTSTRAP, h),
        [&](const vector<double> &rows) {
          for (std::size_t i = 0; i < rows.size(); ++i)
            if (!(std::fabs(rows[i] - exact[i]) <= 0.005 * std::fabs(exact[i]))) return false;
          return true;
        });
  }
}

TEST(Startup, RowsHaveTheOrderTheMethodNeeds)
{
  // an error d of a row costs d in a position of the first formulation, and d/h in a velocity of
  // the second: the start must not be what limits the order
  for (const Scheme &scheme : every_scheme()) {
    const int n = scheme.values();
    const vector<double> h = n > 8 ? vector<double>{0.15, 0.12} : vector<double>{0.2, 0.1, 0.05};
    vector<double> error;
    for (double step : h)
      error.push_back(
          distance(started(scheme, TOP, top_state(0.0), swing, step, Start::BOOTSTRAP, step),
                   exact_rows(scheme, step)));
    const double needed = scheme.order() + (scheme.first() ? 0 : 1);
    std::printf("rows of %-6s %2d: error %.1e at %g, slopes", name(scheme), n, error[0], h[0]);
    for (double p : slopes(h, error)) std::printf(" %.2f", p);
    std::printf(", needed %g\n", needed);
    EXPECT_GT(Check::smallest(slopes(h, error)), needed - 0.2);
  }
}

TEST(Startup, FoundAtALargeStepAndSeededToASmallOne)
{
  for (const Scheme &scheme : every_scheme()) {
    const double tight = scheme.values() < 5 ? 1e-9 : 3e-15;
    const vector<double> exact = exact_rows(scheme, 0.001);
    auto at = [&](double spacing, double h) {
      return started(scheme, TOP, top_state(0.0), swing, h, Start::BOOTSTRAP, spacing);
    };
    vector<double> large = at(0.05, 0.05);
    const vector<double> small = at(0.05, 0.001);
    Integrator(scheme, 0.05).rescale(large.data(), 0.001 / 0.05);
    EXPECT_LT(distance(large, small), 1e-16);    // seeding at h is rescaling to h
    EXPECT_LT(distance(small, exact), tight);
    EXPECT_GT(distance(at(0.0505, 0.00101), small), 1e-6);
  }
}

TEST(Startup, TwoTermsAreThePapersZeroStart)
{
  for (const Scheme &scheme : every_scheme()) {
    const int width = scheme.width(), quat = scheme.quaternion();
    const vector<double> exact = exact_rows(scheme, 0.1);
    auto is_zero_start = [&](const vector<double> &rows) {
      for (int i = 0; i < scheme.size(); ++i) {
        const int row = i / width, column = i % width;
        const bool rate = scheme.first() && ((column >= 3 && column < 6) || column >= 10);
        const bool known = row == 0 || (row == 1 && !rate);    // p' and omega' are derivatives too
        if (!known && rows[i] != 0.0) return false;
        if (known && !(std::fabs(rows[i] - exact[i]) <= 1e-15)) return false;
      }
      return true;
    };
    const vector<double> zero = started(scheme, TOP, top_state(0.0), swing, 0.1, Start::ZERO, 0.1);
    Check::holds_and_refuses_one_percent(zero, is_zero_start);

    // with forces: one derivative more of everything, and no further
    const vector<double> forces =
        started(scheme, TOP, top_state(0.0), swing, 0.1, Start::FORCES, 0.1);
    EXPECT_FALSE(is_zero_start(forces));
    for (int i = 0; i < scheme.size(); ++i) {
      const int row = i / width, column = i % width;
      const bool rate = scheme.first() && ((column >= 3 && column < 6) || column >= 10);
      EXPECT_NEAR(forces[i], row < (rate ? 2 : 3) ? exact[i] : 0.0, 1e-15) << i;
    }
    EXPECT_NE(forces[2 * width + quat], 0.0);
  }
}

TEST(Startup, TimeTranslation)
{
  // rows carried from an earlier start, against a start from the exact state at the later time:
  // they differ by the truncation of the method, N in the rows the corrector settles
  for (Formulation f : BOTH) {
    const Scheme scheme = scheme_of(f);
    auto differences = [&](double later) {
      vector<double> d;
      for (double h : {0.04, 0.02, 0.01}) {
        Motion motion(TOP, top_state(0.0), swing, scheme, h, Start::BOOTSTRAP, 0.05);
        motion.steps(int(std::lround(0.8 / h)));
        d.push_back(
            distance({motion.rows, motion.rows + scheme.size()},
                     started(scheme, TOP, top_state(later), swing, h, Start::BOOTSTRAP, 0.05)));
      }
      return d;
    };
    const vector<double> d = differences(0.8), p = slopes({0.04, 0.02, 0.01}, d);
    std::printf("translation, %d values: %.1e %.1e %.1e  slopes %.2f %.2f\n", scheme.values(), d[0],
                d[1], d[2], p[0], p[1]);
    EXPECT_GT(Check::smallest(p), 4.6);
    EXPECT_LT(d[2], 1e-8);
    EXPECT_LT(slopes({0.04, 0.02, 0.01}, differences(0.808))[1], 0.1);    // 1 % later
  }
}

TEST(Startup, SeriesOfLaterStartIsTheShiftedSeries)
{
  const double H = 0.05;
  const TaylorSeries early = bootstrap(8, TOP, top_state(0.0), swing, H).series;
  auto shifted = [&](double t) {
    TaylorSeries s = bootstrap(8, TOP, top_state(t), swing, H).series;
    Nordsieck<7>::rescale(s.c[0], s.terms, -1.0);
    Nordsieck<7>::predict(s.c[0], s.terms);    // back by one node
    Nordsieck<7>::rescale(s.c[0], s.terms, -1.0);
    return Check::largest_difference(s.c[0], early.c[0], 6 * 7);
  };
  EXPECT_LT(shifted(H), 2e-14);
  EXPECT_GT(shifted(1.01 * H), 1e-5);
}

TEST(Startup, TimeReversal)
{
  // in the cage, where forces and torques depend on everything
  const Oracle::CageScene scene(1, true);
  auto load = [&](const BodyState &s, double norm2) {
    return scene.load(s, norm2);
  };
  BodyState back = scene.start;
  for (int i = 0; i < 3; ++i) {
    back.velocity[i] = -back.velocity[i];
    back.omega_body[i] = -back.omega_body[i];
  }
  for (Formulation f : BOTH) {
    const Scheme scheme = scheme_of(f);
    auto start = [&](const BodyState &s, double sense) {
      return started(scheme, scene.body, s, load, sense * 0.02, Start::BOOTSTRAP, sense * 0.05);
    };
    const vector<double> forward = start(scene.start, 1.0);
    auto reversed = [&](vector<double> rows, bool velocities) {
      for (int i = 0; i < scheme.size(); ++i) {
        const int row = i / scheme.width(), column = i % scheme.width();
        const bool rate = scheme.first() && ((column >= 3 && column < 6) || column >= 10);
        if ((row + (velocities && rate)) % 2) rows[i] = -rows[i];
      }
      return distance(rows, forward);
    };
    EXPECT_LT(reversed(start(back, 1.0), true), 1e-14);
    EXPECT_LT(reversed(start(scene.start, -1.0), false), 1e-14);    // the same by a negative step
    BodyState off = back;
    off.omega_body[0] *= 1.01;
    EXPECT_GT(reversed(start(off, 1.0), true), 1e-8);
  }
}

TEST(Startup, OfBodiesThatCannotTurn)
{
  for (const RigidBody &body : {RigidBody{2.0, {0.0, 0.0, 0.0}}, RigidBody{2.0, {1.0, 0.0, 1.0}}})
    for (Formulation f : BOTH) {
      BodyState s = top_state(0.0);
      for (double &w : s.omega_body) w = 0.0;
      const Scheme scheme = scheme_of(f);
      const vector<double> rows = started(scheme, body, s, swing, 0.02, Start::BOOTSTRAP, 0.05);
      for (int j = 0; j < scheme.values(); ++j)
        for (int i = 0; i < 4; ++i)
          EXPECT_NEAR(rows[j * scheme.width() + scheme.quaternion() + i], j ? 0.0 : s.q[i], 1e-17);
    }
}
