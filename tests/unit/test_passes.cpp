/* Scheme::passes: effect of repeated corrections with the same load on a rotation, absence of an
   effect on the translation, the limit of many passes, and the step for which they are needed. */

#include "scenes.h"

using namespace Drive;

namespace {

Scheme passing(Scheme scheme, int passes)
{
  scheme.passes = passes;
  return scheme;
}

double top_error(const RigidBody &body, const Scheme &scheme, int passes)
{
  return error(free_top(body), passing(scheme, passes), 0.05, 0.05);
}

/// A load with all components.
Load some_load(const BodyState &s, double norm2)
{
  Load l = swing(s, norm2);
  for (int i = 0; i < 3; ++i) l.torque_space[i] = 0.4 - 0.3 * i + 0.2 * s.q[i];
  return l;
}

/// Deviation of the corrected rows of a step from the equations of motion, with constant load and
/// constant body-frame torque.  Unprojected, since a projection moves q afterwards.
double missed(const RigidBody &judge, Scheme scheme, int passes, double h)
{
  scheme.project = false;
  Motion motion(TOP, top_state(0.0), some_load, passing(scheme, passes), h, Start::BOOTSTRAP, h);
  motion.steps(3);
  motion.predict();
  const Load load = some_load(motion.state(), 1.0);
  double a[9], torque_body[3], omegadot[3], rate[4], worst = 0.0;
  rotation_matrix(motion.q(), 1.0, a);
  to_body(a, load.torque_space, torque_body);
  motion.correct(load);

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

// found: a second pass makes the error 5 to 30 times smaller, further ones gain nothing

TEST(Passes, TheSecondOneIsWorthAFactorAndTheThirdIsNot)
{
  for (const Scheme &scheme : every_scheme()) {
    if (scheme.values() > (scheme.first() ? 7 : 8)) continue;    // one pass is unstable here
    double e[4];
    for (int passes : {1, 2, 3}) e[passes] = top_error(TOP, scheme, passes);
    EXPECT_GT(e[1] / e[2], 5.0) << scheme;
    EXPECT_LT(e[1] / e[2], 40.0) << scheme;
    EXPECT_GT(e[2] / e[3], 0.5) << scheme;
    EXPECT_LT(e[2] / e[3], 3.0) << scheme;
  }
}

TEST(Passes, WithManyValuesOneIsUnstableAndTwoAreNot)
{
  for (const Scheme &scheme : every_scheme()) {
    if (scheme.values() <= (scheme.first() ? 7 : 8)) continue;
    EXPECT_FALSE(top_error(TOP, scheme, 1) < 1e-2) << scheme;    // may be NaN
    EXPECT_LT(top_error(TOP, scheme, 2), 1e-9) << scheme;
  }
}

TEST(Passes, ManySolveTheEquationsOfTheStep)
{
  for (const Scheme &scheme : every_scheme()) {
    const double h = 0.2, once = missed(TOP, scheme, 1, h);
    EXPECT_LT(missed(TOP, scheme, 2, h), 0.5 * once) << scheme;
    EXPECT_LT(missed(TOP, scheme, 40, h), 1e-16) << scheme;
    EXPECT_GT(once, 1e-8) << scheme;
  }
}
