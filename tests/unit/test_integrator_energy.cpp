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
