/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The kernel in the paper's scene: the reference trajectory, the orders of both formulations, and
   what a start-up with less than the full series costs. */

#include "checks.h"
#include "drive.h"
#include "oracles/cage_scene.h"

using namespace Drive;
using Check::slopes;
using std::vector;

namespace {

constexpr Formulation FIRST = Formulation::FIRST, SECOND = Formulation::SECOND;
const char *name(Formulation f)
{
  return f == FIRST ? "first" : "second";
}

/// Center of mass in extended precision, good to the last digit but one.
struct Reference {
  int test_case;
  bool consistent;
  double t, center[3];
};
const Reference REFERENCES[] = {
    {1, true, 100, {85.43010788464767, -1.784299103660877, 1.14360193088973}},
    {1, true, 200, {85.56573248988141, -6.06135624295223, 6.86227956266460}},
    {1, false, 100, {86.693409428, -1.437897239, 0.844779738}},
    {1, false, 200, {84.82167549249749, -5.03225661408319, 7.72730548267065}},
    {3, true, 200, {74.503045115, 0.054749072, 0.083234521}}};
const Reference &CASE_1 = REFERENCES[1];

double error(const Reference &r, Oracle::CageScene scene, Formulation formulation, Start start,
             double h)
{
  auto load = [&](const BodyState &s, double norm2) {
    return scene.load(s, norm2);
  };
  // the series is found at a large step, whatever the step is
  const double spacing = start == Start::BOOTSTRAP ? 0.05 : h;
  Motion motion(scene.body, scene.start, load, scheme_of(formulation), h, start, spacing);
  motion.steps(int(std::lround(r.t / h)));
  double d[3];
  for (int i = 0; i < 3; ++i) d[i] = motion.rows[i] - r.center[i];
  return std::sqrt(dot3(d, d));
}

vector<double> errors(const Oracle::CageScene &scene, Formulation formulation, Start start,
                      const vector<double> &h)
{
  vector<double> e;
  for (double step : h) e.push_back(error(CASE_1, scene, formulation, start, step));
  std::printf("case 1, t = 200, %-6s start %d:", name(formulation), int(start));
  for (double x : e) std::printf(" %.2e", x);
  std::printf("  slopes");
  for (double p : slopes(h, e)) std::printf(" %.2f", p);
  std::printf("\n");
  return e;
}

}    // namespace

TEST(CageRuns, ReferenceTrajectoryAtStep002)
{
  for (const Reference &r : REFERENCES)
    for (Formulation formulation : {FIRST, SECOND}) {
      const double limit = formulation == FIRST ? 1e-7 : 1e-9;
      const Oracle::CageScene scene(r.test_case, r.consistent);
      const double e = error(r, scene, formulation, Start::BOOTSTRAP, 0.02);
      std::printf("case %d, %s, t = %g, %-6s: error %.2e\n", r.test_case,
                  r.consistent ? "consistent" : "unrotated", r.t, name(formulation), e);
      EXPECT_LT(e, limit);
    }
}

TEST(CageRuns, ReferenceTrajectoryRefusesOnePercent)
{
  auto off_by = [](int what) {
    Oracle::CageScene scene(1, true);
    double *numbers[] = {
        &scene.body.mass,           &scene.body.inertia[0], &scene.body.inertia[1],
        &scene.body.inertia[2],     &scene.site_charge[3],  &scene.site_epsilon[3],
        &scene.site_sigma[3],       &scene.site_body[3][2], &scene.start.velocity[0],
        &scene.start.omega_body[1], &scene.cage_charge[13]};
    if (what >= int(std::size(numbers))) return -1.0;
    *numbers[what] *= 1.01;
    return error(CASE_1, scene, SECOND, Start::BOOTSTRAP, 0.1);
  };
  for (int what = 0; off_by(what) >= 0.0; ++what) EXPECT_GT(off_by(what), 1e-3) << what;
}

TEST(CageRuns, OrdersWithTheFullStart)
{
  const Oracle::CageScene scene(1, true);
  const vector<double> first = {0.1, 0.05, 0.02}, second = {0.1, 0.05};
  EXPECT_GE(Check::smallest(slopes(first, errors(scene, FIRST, Start::BOOTSTRAP, first))), 4.7);
  EXPECT_GE(Check::smallest(slopes(second, errors(scene, SECOND, Start::BOOTSTRAP, second))), 6.6);

  Oracle::CageScene off = scene;    // 1 % in one charge: no order is left
  off.site_charge[0] *= 1.01;
  EXPECT_LT(slopes(second, errors(off, SECOND, Start::BOOTSTRAP, second))[0], 0.1);
}

TEST(CageRuns, OrdersOfTheShorterStarts)
{
  const Oracle::CageScene scene(1, true);
  const vector<double> h = {0.05, 0.02, 0.01};
  for (Formulation formulation : {FIRST, SECOND}) {
    const vector<double> zero = slopes(h, errors(scene, formulation, Start::ZERO, h));
    EXPECT_GT(zero[0], 0.9);    // the paper's start: first order for the whole run
    EXPECT_LT(zero[0], 1.2);
    EXPECT_NEAR(zero[1], 1.0, 0.1);
    const vector<double> forces = slopes(h, errors(scene, formulation, Start::FORCES, h));
    EXPECT_NEAR(forces[0], 2.0, 0.1);
    EXPECT_NEAR(forces[1], 2.0, 0.1);
  }
}

TEST(CageRuns, EnergyIsKept)
{
  const Oracle::CageScene scene(1, true);
  auto load = [&](const BodyState &s, double norm2) {
    return scene.load(s, norm2);
  };
  const double e0 = scene.total_energy(scene.start);
  for (Formulation formulation : {FIRST, SECOND}) {
    Motion motion(scene.body, scene.start, load, scheme_of(formulation), 0.02, Start::BOOTSTRAP,
                  0.05);
    double worst = 0.0, kinetic = 0.0;
    for (int n = 0; n < 10000; ++n) {
      motion.step();
      const BodyState s = motion.state();
      worst = std::max(worst, std::fabs(scene.total_energy(s) - e0));
      kinetic = std::max(kinetic, translational_energy(scene.body, s.velocity));
    }
    std::printf("case 1 to t = 200, dt 0.02, %-6s: energy off by %.1e\n", name(formulation), worst);
    EXPECT_LT(worst, formulation == FIRST ? 1e-7 : 1e-9);
    EXPECT_GT(0.01 * kinetic, 1e-4);    // 1 % of what is exchanged would be seen
  }
}
