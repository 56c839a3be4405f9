/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Scheme::passes: what correcting again with the same load does for a spin, that it leaves the
   translation alone, where it leads to, and for how large a step it is needed. */

#include "checks.h"
#include "drive.h"
#include "oracles/swinging_top.h"

using namespace Drive;
using Oracle::swing;
using Oracle::TOP;
using Oracle::top_state;
using std::vector;

namespace {

Scheme passing(Scheme scheme, int passes)
{
  scheme.passes = passes;
  return scheme;
}

/// Error of the attitude of the free top after 480 steps of 0.05; |omega| is 1.2.
double top_error(const RigidBody &body, const Scheme &scheme)
{
  static const BodyState end = top_state(24.0);
  double a[9], exact[9];
  Motion motion(body, top_state(0.0), free_of_load, scheme, 0.05, Start::BOOTSTRAP, 0.05);
  motion.steps(480);
  rotation_matrix(motion.q(), dot4(motion.q(), motion.q()), a);
  rotation_matrix(end.q, dot4(end.q, end.q), exact);
  return Check::largest_difference(a, exact, 9);
}

/// A load that acts on everything.
Load some_load(const BodyState &s, double norm2)
{
  Load l = swing(s, norm2);
  for (int i = 0; i < 3; ++i) l.torque_space[i] = 0.4 - 0.3 * i + 0.2 * s.q[i];
  return l;
}

/// By how much the corrected rows of a step miss the equations of motion, load and its torque along
/// the body axes held as they were met.  Unprojected: a projection moves q afterwards.
double missed(const RigidBody &judge, Scheme scheme, int passes, double h)
{
  scheme.project = false;
  Motion motion(TOP, top_state(0.0), some_load, passing(scheme, passes), h, Start::BOOTSTRAP, h);
  motion.steps(3);
  motion.integrator.predict(motion.rows);
  const Load load = some_load(motion.state(), 1.0);
  double a[9], torque_body[3], omegadot[3], rate[4], worst = 0.0;
  rotation_matrix(motion.q(), 1.0, a);
  to_body(a, load.torque_space, torque_body);
  motion.integrator.correct(TOP, load, motion.rows);

  const BodyState s = motion.state();
  const double *q = motion.q(), *next = q + scheme.width(), *second = next + scheme.width();
  angular_acceleration(judge, torque_body, s.omega_body, omegadot);
  if (scheme.first()) {
    const double *row = motion.rows + scheme.width() + Scheme::OMEGA;
    quaternion_rate(q, s.omega_body, rate);
    for (int i = 0; i < 3; ++i) worst = std::max(worst, std::fabs(h * omegadot[i] - row[i]));
    for (int i = 0; i < 4; ++i) worst = std::max(worst, std::fabs(h * rate[i] - next[i]));
  } else {
    double qdot[4];
    for (int i = 0; i < 4; ++i) qdot[i] = next[i] / h;
    quaternion_acceleration(q, qdot, omegadot, rate);
    for (int i = 0; i < 4; ++i)
      worst = std::max(worst, std::fabs(0.5 * h * h * rate[i] - second[i]));
  }
  return worst;
}

}    // namespace

// found: between 5 and 30 times smaller, then nothing more to gain

TEST(Passes, TheSecondOneIsWorthAFactorAndTheThirdIsNot)
{
  for (const Scheme &scheme : every_scheme()) {
    if (scheme.values() > (scheme.first() ? 7 : 8)) continue;    // one pass is unstable here
    double e[4];
    for (int passes : {1, 2, 3}) e[passes] = top_error(TOP, passing(scheme, passes));
    std::printf("free top, h 0.05, %-6s %d: %.1e %.1e %.1e, factors %.1f %.1f\n", name(scheme),
                scheme.values(), e[1], e[2], e[3], e[1] / e[2], e[2] / e[3]);
    EXPECT_GT(e[1] / e[2], 5.0);
    EXPECT_LT(e[1] / e[2], 40.0);
    EXPECT_GT(e[2] / e[3], 0.5);
    EXPECT_LT(e[2] / e[3], 3.0);
    RigidBody off = TOP;
    off.inertia[0] *= 1.01;
    EXPECT_GT(top_error(off, passing(scheme, 2)), 1e-2);
  }
}

TEST(Passes, WithManyValuesOneIsUnstableAndTwoAreNot)
{
  for (const Scheme &scheme : every_scheme()) {
    if (scheme.values() <= (scheme.first() ? 7 : 8)) continue;
    const double once = top_error(TOP, passing(scheme, 1)),
                 twice = top_error(TOP, passing(scheme, 2));
    std::printf("free top, h 0.05, %-6s %d: %.1e with one pass, %.1e with two\n", name(scheme),
                scheme.values(), once, twice);
    EXPECT_FALSE(once < 1e-2);    // may be no number
    EXPECT_LT(twice, 1e-9);
  }
}

TEST(Passes, TranslationIsLeftAlone)
{
  for (Scheme scheme : every_scheme())
    for (bool compensate : {false, true}) {
      scheme.compensate = compensate;
      vector<vector<double>> rows;
      for (int passes : {1, 4}) {
        Motion motion(TOP, top_state(0.0), some_load, passing(scheme, passes), 0.1,
                      Start::BOOTSTRAP, 0.1);
        motion.integrator.predict(motion.rows);
        motion.integrator.correct(TOP, some_load(motion.state(), 1.0), motion.rows);
        rows.push_back(motion.history);
      }
      bool turned = false;
      const int carries = scheme.values() + scheme.carries();
      for (int row = 0; row < carries; ++row)
        for (int i = 0; i < scheme.width(); ++i) {
          const int k = row * scheme.width() + i;
          if (i < scheme.quaternion())
            EXPECT_EQ(rows[0][k], rows[1][k]);
          else
            turned = turned || rows[0][k] != rows[1][k];
        }
      EXPECT_TRUE(turned);
    }
}

TEST(Passes, ManySolveTheEquationsOfTheStep)
{
  RigidBody off = TOP;
  off.inertia[2] *= 1.01;
  for (const Scheme &scheme : every_scheme()) {
    const double h = 0.2, one = missed(TOP, scheme, 1, h), two = missed(TOP, scheme, 2, h),
                 many = missed(TOP, scheme, 40, h);
    std::printf(
        "%-6s %2d: equations missed by %.1e after one pass, %.1e after two, %.1e after 40\n",
        name(scheme), scheme.values(), one, two, many);
    EXPECT_LT(two, 0.5 * one);
    EXPECT_LT(many, 1e-16);
    EXPECT_GT(one, 1e-8);
    EXPECT_GT(missed(off, scheme, 40, h), 1e-5);
  }
}
