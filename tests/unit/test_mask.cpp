// Masks: what acts of a load, and the work of what was met.

#include "gear_quat_integrator.h"
#include "gear_quat_mask.h"
#include "gear_quat_startup.h"

#include <gtest/gtest.h>

using namespace LAMMPS_NS::GearQuat;

namespace {

const RigidBody BODY = {2.0, {3.0, 2.0, 1.5}};
const Load MET = {{1.0, -2.0, 3.0}, {0.5, 0.25, -4.0}};

BodyState some_state()
{
  BodyState state = {{1.0, 2.0, -0.5}, {0.1, -0.7, 0.3, 0.6}, {0.2, -0.1, 0.4}, {1.0, 0.3, -0.8}};
  project_norm(state.q);
  return state;
}

/// Predict and correct once from a start of order 2; the state before and after.
Correction step(const Scheme &scheme, double h, Mask off, BodyState &before, BodyState &after)
{
  double rows[MAX_SIZE];
  const Integrator integrator(scheme, h);
  seed(scheme, BODY, local_series(BODY, some_state(), acting_load(MET, off), h), h, h, rows);
  integrator.predict(rows);
  before = integrator.body_state(BODY, rows);
  const Correction result = integrator.correct(BODY, acting_load(MET, off), rows);
  after = integrator.body_state(BODY, rows);
  return result;
}

}    // namespace

TEST(Mask, EveryBitTurnsOffItsComponent)
{
  for (int k = 0; k < 6; ++k) {
    const Load acting = acting_load(MET, k < 3 ? force_off(k) : torque_off(k - 3));
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(acting.force[i], i == k ? 0.0 : MET.force[i]);
      EXPECT_EQ(acting.torque_space[i], 3 + i == k ? 0.0 : MET.torque_space[i]);
    }
  }
  const Load all = acting_load(MET, 0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(all.force[i], MET.force[i]);
    EXPECT_EQ(all.torque_space[i], MET.torque_space[i]);
  }
}

TEST(Mask, WorkIsTheCorrectorsWhereEverythingActs)
{
  for (const auto formulation : {Formulation::FIRST, Formulation::SECOND}) {
    Scheme scheme;
    scheme.formulation = formulation;
    BodyState before, after;
    const Correction result = step(scheme, 0.1, 0, before, after);
    const double work = work_between(MET, before, after);
    EXPECT_GT(std::fabs(result.work), 1.0e-5);
    EXPECT_NEAR(work, result.work, 1.0e-14);
    EXPECT_GT(std::fabs(1.01 * work - result.work), 1.0e-7);
  }
}

TEST(Mask, WorkIsThatOfTheLoadThatWasMet)
{
  // about x the body turns although no torque acts: Euler's equations couple the axes
  Scheme scheme;
  BodyState before, after;
  const Mask off = torque_off(0);
  const Correction result = step(scheme, 0.1, off, before, after);
  Load rest = MET;
  for (int i = 0; i < 3; ++i) {
    rest.force[i] = 0.0;
    if (i > 0) rest.torque_space[i] = 0.0;
  }
  const double missing = work_between(rest, before, after);
  EXPECT_GT(std::fabs(missing), 1.0e-7);
  EXPECT_NEAR(work_between(MET, before, after), result.work + missing, 1.0e-14);
}
