/* gear_quat_integrator.h: invariants of a step - the constraints on q, and the work that converts
   the potential at the predicted pose to the corrected one. */

#include "scenes.h"

using namespace Drive;

namespace {

Motion cage_motion(const CageScene &scene, const Scheme &scheme, double h)
{
  return Motion(scene.body, scene.start, scene, scheme, h, Start::BOOTSTRAP, 0.05);
}

/// Energy that is missing after the correction `factor` * -work, when the corrector moves the body
/// by about `size` (a perturbation of row 2 that it removes).
double missing_energy(Formulation formulation, double size, double factor, bool turn)
{
  const CageScene scene(1, true);
  Scheme scheme = scheme_of(formulation);
  Motion motion = cage_motion(scene, scheme, 0.05);
  motion.predict();
  double *pose = motion.rows + (turn ? scheme.quaternion() : 0);
  for (int i = 0; i < 3; ++i) {
    pose[scheme.width() + i] += size;    // first: the residual depends on rows 1 and 2
    pose[2 * scheme.width() + i] += size;
  }
  const BodyState predicted = motion.state();
  const Load load = scene.load(predicted, dot4(predicted.q, predicted.q));
  const double correction = -motion.correct(load).work;
  const BodyState corrected = motion.state();
  const double kinetic = translational_energy(scene.body, corrected.velocity) +
      rotational_energy(scene.body, corrected.omega_body);
  const double reported =
      scene.potential(predicted, dot4(predicted.q, predicted.q)) + kinetic + factor * correction;
  return std::fabs(reported - scene.total_energy(corrected));
}

}    // namespace

TEST(Energy, IsThatOfThePaperForBothBodies)
{
  for (bool consistent : {true, false})
    for (int test_case : {1, 3}) {
      const CageScene scene(test_case, consistent);
      EXPECT_NEAR(scene.total_energy(scene.start), test_case == 1 ? -0.72360304 : 3.99270832, 5e-9);
    }
}

TEST(Energy, IsKeptInTheCage)
{
  const CageScene scene(1, true);
  const double e0 = scene.total_energy(scene.start);
  for (Formulation formulation : {FIRST, SECOND}) {
    Motion motion = cage_motion(scene, scheme_of(formulation), 0.02);
    double worst = 0.0;
    for (int n = 0; n < 10000; ++n) {
      motion.step();
      const BodyState s = motion.state();
      worst = std::max(worst, std::fabs(scene.total_energy(s) - e0));
    }
    EXPECT_LT(worst, formulation == FIRST ? 1e-7 : 1e-9);
  }
}

TEST(Energy, CorrectionIsRightToSecondOrderInTheShift)
{
  for (Formulation formulation : {FIRST, SECOND})
    for (bool turn : {false, true}) {
      auto slope = [&](double factor) {
        const double size = turn ? 0.02 : 0.5;
        return std::log2(missing_energy(formulation, size, factor, turn) /
                         missing_energy(formulation, size / 16, factor, turn)) /
            4;
      };
      EXPECT_NEAR(slope(1.0), 2.0, 0.1);
      EXPECT_LT(slope(0.0), 1.3);     // without it
      EXPECT_LT(slope(-1.0), 1.3);    // with the wrong sign
    }
}

TEST(Energy, WorkIsThatOfTheLoadFromPredictedToCorrectedPose)
{
  // each component of force and torque separately, strong enough to move the body
  const CageScene scene(1, true);
  for (Formulation formulation : {FIRST, SECOND})
    for (bool compensate : {false, true})
      for (int component = 0; component < 6; ++component) {
        Motion motion = cage_motion(scene, scheme_of(formulation, 0, 1, compensate), 0.5);
        motion.predict();
        const BodyState before = motion.state();
        Load load = {};
        (component < 3 ? load.force : load.torque_space - 3)[component] = 10.0;
        const double work = motion.correct(load).work;
        const BodyState after = motion.state();

        double old_a[9], new_a[9], turn[9] = {}, angle[3];    // pose before -> after
        rotation_matrix(before.q, dot4(before.q, before.q), old_a);
        rotation_matrix(after.q, dot4(after.q, after.q), new_a);
        for (int i = 0; i < 9; ++i)
          for (int k = 0; k < 3; ++k) turn[i] += new_a[3 * k + i / 3] * old_a[3 * k + i % 3];
        for (int i = 0; i < 3; ++i) {
          const int j = (i + 1) % 3, k = (i + 2) % 3;
          angle[i] = 0.5 * (turn[3 * k + j] - turn[3 * j + k]);
        }
        const double moved = component < 3 ? after.center[component] - before.center[component]
                                           : angle[component - 3];
        ASSERT_GT(std::fabs(moved), 1e-6);
        EXPECT_NEAR(work / (10.0 * moved), 1.0, 2e-3);
      }
}

TEST(Projection, KeepsBothConstraintsAndItsAbsenceShows)
{
  const CageScene scene(1, true);
  for (Formulation formulation : {FIRST, SECOND}) {
    Scheme scheme = scheme_of(formulation);
    double worst[2] = {0.0, 0.0}, radial[2] = {0.0, 0.0};
    for (bool project : {false, true}) {
      scheme.project = project;
      Motion motion = cage_motion(scene, scheme, 0.1);
      for (int n = 0; n < 3000; ++n) {
        motion.step();
        const double *q = motion.q(), *rate = q + scheme.width();
        worst[project] = std::max(worst[project], std::fabs(dot4(q, q) - 1.0));
        radial[project] = std::max(radial[project], std::fabs(dot4(q, rate)));
      }
    }
    EXPECT_LE(worst[1], 1e-15);
    EXPECT_GT(worst[0], 1e-10);
    if (formulation == SECOND) {
      EXPECT_LE(radial[1], 1e-17);    // of rows of h qdot, about 2e-3
      EXPECT_GT(radial[0], 1e-14);
    }
  }
}
