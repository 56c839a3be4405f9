/* gear_quat_math.h: Euler's equations, energies, and the principal axes of any tensor. */

#include "checks.h"
#include "gear_quat_shapes.h"
#include "oracles/cage_scene.h"

using namespace LAMMPS_NS::GearQuat;
using Check::largest_difference;
using std::vector;

namespace {

/// Maximum of two deviations: A T A^T from the moments, relative; A from a right-handed rotation.
double not_principal(const double *tensor, const double *moments, const double *a)
{
  double scale = 0.0, worst = Check::not_orthogonal(a);
  for (int i = 0; i < 9; ++i) scale = std::max(scale, std::fabs(tensor[i]));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double element = 0.0;
      for (int k = 0; k < 9; ++k) element += a[3 * i + k / 3] * tensor[k] * a[3 * j + k % 3];
      worst = std::max(worst, std::fabs(element - (i == j ? moments[i] : 0.0)) / scale);
    }
  return worst;
}

}    // namespace

TEST(EulersEquations, AngularMomentumInSpaceChangesByTheTorque)
{
  Check::Numbers numbers(21);
  const RigidBody body = {1.0, {3.0, 2.0, 0.7}};
  const vector<double> q = numbers.unit_quaternion(), w = numbers.list(3), torque = numbers.list(3);
  double a[9], torque_body[3], wdot[3], qdot[4], rate[3];
  rotation_matrix(q.data(), 1.0, a);
  to_body(a, torque.data(), torque_body);
  angular_acceleration(body, torque_body, w.data(), wdot);
  quaternion_rate(q.data(), w.data(), qdot);

  const auto momentum = [&](double t, double *out) {    // d/dt (A^T I omega) = torque
    double p[4], turn[9], l[3];
    for (int i = 0; i < 4; ++i) p[i] = q[i] + t * qdot[i];
    for (int i = 0; i < 3; ++i) l[i] = body.inertia[i] * (w[i] + t * wdot[i]);
    rotation_matrix(p, dot4(p, p), turn);
    to_space(turn, l, out);
  };
  Check::derivative(momentum, 3, 1e-3, rate);
  EXPECT_LE(largest_difference(rate, torque.data(), 3), 1e-11);
}

TEST(EulersEquations, AnAxisWithoutInertiaHasNoAcceleration)
{
  const double torque[3] = {0.3, -0.2, 0.1}, w[3] = {0.5, 0.7, 0.0};
  double wdot[3];
  const RigidBody rod = {1.0, {2.0, 2.0, 0.0}}, point = {1.0, {0.0, 0.0, 0.0}};
  angular_acceleration(rod, torque, w, wdot);
  EXPECT_DOUBLE_EQ(wdot[0], 0.15);
  EXPECT_DOUBLE_EQ(wdot[1], -0.1);
  EXPECT_EQ(wdot[2], 0.0);
  angular_acceleration(point, torque, w, wdot);
  for (double x : wdot) EXPECT_EQ(x, 0.0);
  EXPECT_EQ(rod.rotational_freedoms(), 2);
  EXPECT_EQ(point.rotational_freedoms(), 0);
  EXPECT_EQ((RigidBody{1.0, {3.0, 2.0, 1.0}}).rotational_freedoms(), 3);
}

TEST(PrincipalAxes, OfRandomTensors)
{
  Check::Numbers numbers(23);
  for (int n = 0; n < 200; ++n) {
    const vector<double> r = numbers.list(6);
    const double scale = std::pow(10.0, 6 * numbers.next());
    double t[9] = {r[0], r[1], r[2], r[1], r[3], r[4], r[2], r[4], r[5]}, moments[3], a[9];
    for (double &x : t) x *= scale;
    principal_axes(t, moments, a);
    EXPECT_LT(not_principal(t, moments, a), 4e-15);
  }
}

TEST(PrincipalAxes, OfDegenerateTensors)
{
  // two equal moments, and three, in axes turned by a random rotation
  Check::Numbers numbers(24);
  for (int n = 0; n < 50; ++n) {
    const double d[3] = {2.0, n % 2 ? 2.0 : 5.0, n % 5 ? 5.0 : 2.0};
    const vector<double> q = numbers.unit_quaternion();
    double rotation[9], t[9], moments[3], a[9];
    rotation_matrix(q.data(), 1.0, rotation);
    for (int i = 0; i < 9; ++i) {
      t[i] = 0.0;
      for (int k = 0; k < 3; ++k) t[i] += rotation[3 * k + i / 3] * d[k] * rotation[3 * k + i % 3];
    }
    for (int i = 0; i < 3; ++i) t[3 * i + (i + 1) % 3] = t[3 * ((i + 1) % 3) + i];
    principal_axes(t, moments, a);
    EXPECT_LT(not_principal(t, moments, a), 4e-15);
    double known[3] = {d[0], d[1], d[2]};
    std::sort(moments, moments + 3);
    std::sort(known, known + 3);
    EXPECT_LT(largest_difference(moments, known, 3), 1e-14);
  }
}

TEST(PrincipalAxes, LeaveAnAxisThatIsPrincipalUntouched)
{
  const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double moments[3], a[9];
  const double diagonal[9] = {2, 0, 0, 0, 7, 0, 0, 0, 3}, sphere[9] = {5, 0, 0, 0, 5, 0, 0, 0, 5};
  for (const double *t : {diagonal, sphere}) {
    principal_axes(t, moments, a);
    for (int i = 0; i < 9; ++i) EXPECT_EQ(a[i], identity[i]);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(moments[i], t[4 * i]);    // not sorted
  }
  const double flat[9] = {2, 0.5, 0, 0.5, 3, 0, 0, 0, 5};    // in two dimensions: z does not change
  principal_axes(flat, moments, a);
  EXPECT_EQ(moments[2], 5.0);
  EXPECT_EQ(a[2], 0.0);
  EXPECT_EQ(a[5], 0.0);
  for (int i = 6; i < 9; ++i) EXPECT_EQ(a[i], identity[i]);
  EXPECT_LT(not_principal(flat, moments, a), 1e-15);
}

TEST(VanishingMoments, AreThoseBelowTheFractionOfTheLargest)
{
  const struct {
    double given[3], left[3];
  } cases[] = {{{4.0, 1e-9, 4.0}, {4.0, 0.0, 4.0}},                // a rod, but for rounding
               {{4.0, 4.0, -1e-16}, {4.0, 4.0, 0.0}},              // rounding below zero
               {{1.0, 5.05e-7, 1.0}, {1.0, 5.05e-7, 1.0}},         // 1 % above the limit: a body
               {{1.0, 4.95e-7, 1.0}, {1.0, 0.0, 1.0}},             // 1 % below: a rod
               {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}},                 // a point
               {{3e-20, 2e-20, 1e-20}, {3e-20, 2e-20, 1e-20}}};    // small, but a body
  for (const auto &c : cases) {
    double m[3] = {c.given[0], c.given[1], c.given[2]};
    drop_vanishing_moments(m);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(m[i], c.left[i]);
  }
}
