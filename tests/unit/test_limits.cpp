/* gear_quat_stability.h: motions beyond the limits, and non-finite ones. */

#include "checks.h"
#include "drive.h"
#include "gear_quat_stability.h"

#include <limits>
#include <string>

using namespace Drive;

namespace {

const double INFINITE = std::numeric_limits<double>::infinity();
const double NO_NUMBER = std::numeric_limits<double>::quiet_NaN();
constexpr double H = 0.01, LENGTH = 20.0;

BodyState at_rest()
{
  return {{1, 2, 3}, {0.5, 0.5, 0.5, 0.5}, {0, 0, 0}, {0, 0, 0}};
}

/// True if a harmonic motion of this many radians per step keeps its energy within a factor of two.
bool survives_oscillation(const Scheme &scheme, double radians)
{
  constexpr int STEPS = 5000;
  const double h = 1.0;
  const Integrator integrator(scheme, h);
  const RigidBody body = {1.0, {0.0, 0.0, 0.0}};
  BodyState state = {{1.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  Load load = Load();
  const auto pull = [&] {
    load.force[0] = -radians * radians * state.center[0];
  };
  std::vector<double> history(scheme.size());
  double *rows = history.data();
  pull();
  seed(scheme, body, local_series(body, state, load, h), h, h, rows);
  for (int step = 0; step < STEPS; ++step) {
    integrator.predict_center(rows);
    integrator.center_state(body, rows, state);
    pull();
    integrator.correct_center(body, load, rows);
    integrator.center_state(body, rows, state);
    const double x = state.center[0], v = state.velocity[0] / radians;
    if (!(x * x + v * v < 2.0)) return false;
  }
  return true;
}

/// The fastest harmonic motion that is stable, in radians per step.
double on_trial(const Scheme &scheme)
{
  constexpr double GRAIN = 0.02;
  int grains = 1;
  while (survives_oscillation(scheme, GRAIN * (grains + 1))) ++grains;
  return GRAIN * grains;
}

}    // namespace

TEST(Limits, HalfATurnAndTheSceneInOneStep)
{
  for (const double h : {H, -H}) {
    const MotionLimits limits(h, LENGTH);
    EXPECT_TRUE(limits.keep(at_rest()));
    for (int k = 0; k < 3; ++k)
      for (const double part : {0.99, 1.01}) {
        BodyState moves = at_rest(), turns = at_rest();
        moves.velocity[k] = -part * LENGTH / H;
        turns.omega_body[k] = part * std::acos(-1.0) / H;
        EXPECT_EQ(limits.keep(moves), part < 1.0);
        EXPECT_EQ(limits.keep(turns), part < 1.0);
      }
  }
}

TEST(Limits, WhatIsNoNumber)
{
  const MotionLimits limits(H, INFINITE);    // no limit in space either
  BodyState far = at_rest();
  far.velocity[0] = 1.0e100;
  EXPECT_TRUE(limits.keep(far));
  for (const double bad : {INFINITE, -INFINITE, NO_NUMBER}) {
    for (int k = 0; k < 3; ++k) {
      BodyState moves = at_rest(), turns = at_rest();
      moves.velocity[k] = turns.omega_body[k] = bad;
      EXPECT_FALSE(limits.keep(moves));
      EXPECT_FALSE(limits.keep(turns));
    }
  }
}

TEST(Limits, TheFastestOscillation)
{
  // the table is what a trial of every method gives; it fails with the row that the table should have
  for (const Formulation formulation : FORMULATIONS)
    for (const bool other : {false, true}) {
      std::string row, table;
      for (int n = formulation == MOMENTUM ? VERLET : fewest(formulation); n <= most(formulation);
           ++n) {
        Scheme scheme = scheme_of(formulation, n, formulation == MOMENTUM ? 1 : 2);
        if (formulation == FIRST) scheme.predicted_momentum = other;
        if (formulation == SECOND) scheme.velocity_c0 = other;
        row += " " + std::to_string(on_trial(scheme));
        table += " " + std::to_string(fastest_oscillation(scheme));
      }
      EXPECT_EQ(table, row) << word_of(formulation) << other;
    }
}
