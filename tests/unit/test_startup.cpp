/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* gear_quat_startup.h: the rows a history starts from, against exact Taylor coefficients, under
   translation and reversal of time, and for the shorter starts. */

#include "checks.h"
#include "drive.h"
#include "oracles/cage_scene.h"
#include "oracles/free_top.h"
#include "oracles/taylor_top.h"

using namespace Drive;
using Check::slopes;
using std::vector;

namespace {

const long double MOMENTS[3] = {3.0L, 2.0L, 1.2L};
const RigidBody TOP = {2.0, {3.0, 2.0, 1.2}};

/// A top that swings as a whole: x'' = -x, free rotation.  Everything about it is known.
BodyState top_state(double t)
{
  const double q0[4] = {0.1, -0.3, 0.5, 0.8}, w0[3] = {1.0, 0.4, 0.5};
  double unit[4] = {q0[0], q0[1], q0[2], q0[3]}, a[9];
  project_norm(unit);
  rotation_matrix(unit, 1.0, a);
  Oracle::Matrix start;
  for (int i = 0; i < 9; ++i) start.m[i / 3][i % 3] = a[i];
  const long double w[3] = {w0[0], w0[1], w0[2]};
  const Oracle::FreeTop exact(MOMENTS, w, start);

  BodyState s = {};
  long double omega[3];
  exact.omega(t, omega);
  const Oracle::Matrix m = exact.attitude(t);
  for (int i = 0; i < 9; ++i) a[i] = double(m.m[i / 3][i % 3]);
  quaternion_from_matrix(a, s.q);
  if (dot4(s.q, unit) < 0.0 && std::fabs(t) < 1.0)
    for (double &x : s.q) x = -x;
  for (int i = 0; i < 3; ++i) {
    s.omega_body[i] = double(omega[i]);
    s.center[i] = std::cos(t + i + 0.3);
    s.velocity[i] = -std::sin(t + i + 0.3);
  }
  return s;
}

Load swing(const BodyState &s, double)
{
  Load l = {};
  for (int i = 0; i < 3; ++i) l.force[i] = -TOP.mass * s.center[i];
  return l;
}

/// Exact rows of that motion at t = 0 for a step h: x q (and p, omega) in the columns of the scheme.
vector<double> exact_rows(const Scheme &scheme, double h)
{
  const BodyState s = top_state(0.0);
  const Oracle::TaylorTop top(MOMENTS, s.q, s.omega_body);
  vector<double> rows(scheme.size());
  double factor = 1.0, quarter = std::acos(0.0);
  for (int j = 0; j < scheme.values(); ++j) {
    double *row = rows.data() + j * scheme.width();
    for (int i = 0; i < 3; ++i) {
      row[i] = factor * std::cos(i + 0.3 + j * quarter);
      if (scheme.first()) {
        row[3 + i] = factor * TOP.mass * std::cos(i + 0.3 + (j + 1) * quarter);
        row[10 + i] = std::pow(h, j) * double(top.w[j][i]);
      }
    }
    double *q = row + scheme.quaternion();
    for (int i = 0; i < 4; ++i) q[i] = std::pow(h, j) * double(top.q[j][i]);
    factor *= h / (j + 1);
  }
  return rows;
}

vector<double> started(const Scheme &scheme, const BodyState &s, Start start, double spacing,
                       double h, const LoadOf &load = swing, const RigidBody &body = TOP)
{
  const Motion motion(body, s, load, scheme, h, start, spacing);
  return {motion.rows, motion.rows + scheme.size()};
}

double distance(const vector<double> &a, const vector<double> &b)
{
  return Check::largest_difference(a.data(), b.data(), int(a.size()));
}

const Formulation BOTH[] = {Formulation::FIRST, Formulation::SECOND};

}    // namespace

TEST(Startup, RowsAreTheTaylorCoefficients)
{
  for (Formulation f : BOTH) {
    const Scheme scheme = scheme_of(f);
    const vector<double> exact = exact_rows(scheme, 0.05);
    // found: 3e-16, and 3e-14 in rows of omega; 1 % of the highest rows is far above that
    Check::holds_and_refuses_one_percent(
        started(scheme, top_state(0.0), Start::BOOTSTRAP, 0.05, 0.05),
        [&](const vector<double> &rows) {
          return distance(rows, exact) <= 5e-14;
        });
  }
}

TEST(Startup, SeriesApproachesTheExactOneWithTheOrderOfItsNodes)
{
  // nine nodes: third and higher terms are of order 11 in the spacing, before rounding
  vector<double> error, spacing = {0.4, 0.2, 0.1};
  const BodyState s = top_state(0.0);
  const Oracle::TaylorTop top(MOMENTS, s.q, s.omega_body);
  for (double H : spacing) {
    const TaylorSeries series = series_at(TOP, s, swing, Start::BOOTSTRAP, H);
    EXPECT_EQ(series.terms, Collocation::NODES + 2);
    double worst = 0.0;
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 4; ++i) {
        const double exact = double(top.q[j][i]) * std::pow(H, j);
        worst = std::max(worst, std::fabs(series.c[j][3 + i] - exact));
      }
    error.push_back(worst);
  }
  std::printf("series, first six terms, H = 0.4 0.2 0.1: %.1e %.1e %.1e  slopes %.2f %.2f\n",
              error[0], error[1], error[2], slopes(spacing, error)[0], slopes(spacing, error)[1]);
  EXPECT_GT(Check::smallest(slopes(spacing, error)), 9.5);
  EXPECT_LT(error.back(), 1e-11);
}

TEST(Startup, FoundAtALargeStepAndSeededToASmallOne)
{
  for (Formulation f : BOTH) {
    const Scheme scheme = scheme_of(f);
    const vector<double> exact = exact_rows(scheme, 0.001);
    vector<double> large = started(scheme, top_state(0.0), Start::BOOTSTRAP, 0.05, 0.05);
    const vector<double> small = started(scheme, top_state(0.0), Start::BOOTSTRAP, 0.05, 0.001);
    nordsieck_rescale(large.data(), scheme.values(), scheme.width(), 0.001 / 0.05);
    EXPECT_LT(distance(large, small), 1e-16);    // seeding at h is rescaling to h
    EXPECT_LT(distance(small, exact), 1e-15);
    const vector<double> off = started(scheme, top_state(0.0), Start::BOOTSTRAP, 0.0505, 0.00101);
    EXPECT_GT(distance(off, small), 1e-6);
  }
}

TEST(Startup, TwoTermsAreThePapersZeroStart)
{
  for (Formulation f : BOTH) {
    const Scheme scheme = scheme_of(f);
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
    const vector<double> zero = started(scheme, top_state(0.0), Start::ZERO, 0.1, 0.1);
    Check::holds_and_refuses_one_percent(zero, is_zero_start);

    // with forces: one derivative more of everything, and no further
    const vector<double> forces = started(scheme, top_state(0.0), Start::FORCES, 0.1, 0.1);
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
        d.push_back(distance({motion.rows, motion.rows + scheme.size()},
                             started(scheme, top_state(later), Start::BOOTSTRAP, 0.05, h)));
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
  const TaylorSeries early = series_at(TOP, top_state(0.0), swing, Start::BOOTSTRAP, H);
  auto shifted = [&](double t) {
    TaylorSeries s = series_at(TOP, top_state(t), swing, Start::BOOTSTRAP, H);
    nordsieck_rescale(s.c[0], s.terms, 7, -1.0);
    nordsieck_predict(s.c[0], s.terms, 7);    // back by one node
    nordsieck_rescale(s.c[0], s.terms, 7, -1.0);
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
      return started(scheme, s, Start::BOOTSTRAP, sense * 0.05, sense * 0.02, load, scene.body);
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
      const vector<double> rows = started(scheme, s, Start::BOOTSTRAP, 0.05, 0.02, swing, body);
      for (int j = 0; j < scheme.values(); ++j)
        for (int i = 0; i < 4; ++i)
          EXPECT_NEAR(rows[j * scheme.width() + scheme.quaternion() + i], j ? 0.0 : s.q[i], 1e-17);
    }
}
