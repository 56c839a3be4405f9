// Masks: the acting part of a load, and the work of the full load.

#include "drive.h"
#include "gear_quat_math.h"

#include <gtest/gtest.h>

using namespace Drive;

namespace {

const RigidBody BODY = {2.0, {3.0, 2.0, 1.5}};
const Load MET = {{1.0, -2.0, 3.0}, {0.5, 0.25, -4.0}};

/// Predicts and corrects once from a start of order 2; the states before and after.
struct Step {
  Correction result;
  BodyState before, after;

  explicit Step(Formulation formulation, Mask off = 0)
  {
    BodyState state = {{1.0, 2.0, -0.5}, {0.1, -0.7, 0.3, 0.6}, {0.2, -0.1, 0.4}, {1.0, 0.3, -0.8}};
    project_norm(state.q);
    const Load load = acting_load(MET, off);
    Motion motion(BODY, state, constant(load), scheme_of(formulation), 0.1, Start::FORCES, 0.1);
    motion.predict();
    before = motion.state();
    result = motion.correct(load);
    after = motion.state();
  }
};

}    // namespace

TEST(Mask, EveryBitTurnsOffItsComponent)
{
  for (int k = 0; k <= 6; ++k) {    // 6: no component is off
    const Load acting = acting_load(MET, k == 6 ? 0 : k < 3 ? force_off(k) : torque_off(k - 3));
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(acting.force[i], i == k ? 0.0 : MET.force[i]);
      EXPECT_EQ(acting.torque_space[i], 3 + i == k ? 0.0 : MET.torque_space[i]);
    }
  }
}

TEST(Mask, WorkIsTheCorrectorsWhereEverythingActs)
{
  for (const auto formulation : {FIRST, SECOND}) {
    const Step step(formulation);
    const double work = work_between(MET, step.before, step.after);
    EXPECT_GT(std::fabs(step.result.work), 1.0e-5);
    EXPECT_NEAR(work, step.result.work, 1.0e-14);
  }
}

TEST(Mask, WorkIsThatOfTheLoadThatWasMet)
{
  // about x the body turns without a torque: Euler's equations couple the axes
  const Step step(SECOND, torque_off(0));
  const Load rest = {{}, {MET.torque_space[0], 0.0, 0.0}};
  const double missing = work_between(rest, step.before, step.after);
  EXPECT_GT(std::fabs(missing), 1.0e-7);
  EXPECT_NEAR(work_between(MET, step.before, step.after), step.result.work + missing, 1.0e-14);
}
