/* The paper's test system, checked before it is used in runs: both printed energies, the body, the
   symmetry of the charges, forces and torques as gradients. */

#include "checks.h"
#include "gear_quat_math.h"
#include "oracles/cage_scene.h"

using namespace LAMMPS_NS::GearQuat;
using Oracle::CageScene;
using std::vector;

namespace {

/// State displaced by dx and rotated by a small rotation vector about the space axes.
BodyState moved(const BodyState &s, const double *dx, const double *angle_space)
{
  BodyState out = s;
  const double length = std::sqrt(dot3(angle_space, angle_space));
  const double f = length > 0.0 ? std::sin(0.5 * length) / length : 0.5;
  const double turn[4] = {f * angle_space[0], f * angle_space[1], f * angle_space[2],
                          std::cos(0.5 * length)};
  w_times(turn, s.q, out.q);    // a rotation about space axes multiplies from the left
  for (int i = 0; i < 3; ++i) out.center[i] += dx[i];
  return out;
}

}    // namespace

TEST(CageScene, BothEnergiesOfThePaperForBothBodies)
{
  for (bool consistent : {true, false})
    for (int test_case : {1, 3}) {
      const double known = test_case == 1 ? -0.72360304 : 3.99270832;
      CageScene scene(test_case, consistent);
      EXPECT_NEAR(scene.total_energy(scene.start), known, 5e-9);
    }
}

TEST(CageScene, ChargesAreOddUnderInversion)
{
  const CageScene scene(1, true);
  double sum = 0.0;
  int plus = 0;
  for (int c = 0; c < 26; ++c) {
    sum += scene.cage_charge[c];
    EXPECT_EQ(scene.cage_charge[c], -scene.cage_charge[25 - c]);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(scene.cage[c][i], -scene.cage[25 - c][i]);
    if (scene.cage[c][0] == 100 && scene.cage[c][1] == 0 && scene.cage[c][2] == 0) plus = c;
  }
  EXPECT_EQ(sum, 0.0);
  EXPECT_EQ(scene.cage_charge[plus], 1.0);
}

TEST(CageScene, BothBodiesHaveTheSameSitesInSpace)
{
  const CageScene consistent(1, true), unrotated(1, false);
  for (int k = 0; k < 4; ++k) {
    double a[9], one[3], other[3];
    rotation_matrix(consistent.start.q, 1.0, a);
    to_space(a, consistent.site_body[k], one);
    rotation_matrix(unrotated.start.q, 1.0, a);
    to_space(a, unrotated.site_body[k], other);
    EXPECT_LT(Check::largest_difference(one, other, 3), 1e-14);
  }
  // and differ in the frame of their moments by 5.6 degrees
  const double cosine = std::fabs(dot4(consistent.start.q, unrotated.start.q));
  EXPECT_NEAR(2.0 * std::acos(cosine) * 180.0 / std::acos(-1.0), 5.6, 0.01);
}

TEST(CageScene, ForceAndTorqueAreTheGradientOfTheEnergy)
{
  const CageScene scene(1, true);
  BodyState s = scene.start;
  s.center[0] = 86.0;    // closer to the sphere at (100, 0, 0), where all terms are large
  s.center[1] = -1.5;
  const Load load = scene.load(s, dot4(s.q, s.q));
  double gradient[6];
  for (int i = 0; i < 6; ++i) {
    auto along = [&](double t, double *energy) {
      double change[6] = {};
      change[i] = t;
      const BodyState there = moved(s, change, change + 3);
      *energy = scene.potential(there, 1.0);
    };
    Check::derivative(along, 1, i < 3 ? 1e-2 : 1e-3, gradient + i);
  }
  vector<double> both(load.force, load.force + 3);
  both.insert(both.end(), load.torque_space, load.torque_space + 3);
  Check::holds(both, [&](const vector<double> &f) {
    for (int i = 0; i < 6; ++i)
      if (!(std::fabs(f[i] + gradient[i]) <= 1e-8 * std::max(1.0, std::fabs(f[i])))) return false;
    return true;
  });
}
