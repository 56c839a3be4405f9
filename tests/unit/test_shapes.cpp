/* gear_quat_shapes.h: own inertia of extended sites, and orientations fixed to a body. */

#include "checks.h"
#include "gear_quat_shapes.h"

using namespace LAMMPS_NS::GearQuat;
using Check::largest_difference;
using Check::quaternion_distance;
using std::vector;

namespace {

/// Moments of a body of many equal points.
struct Points {
  double second[3] = {0, 0, 0};
  int count = 0;

  void add(double x, double y, double z)
  {
    second[0] += x * x;
    second[1] += y * y;
    second[2] += z * z;
    ++count;
  }

  void expect_moments(const double (&made)[3], double mass, double tolerance) const
  {
    double sum[3];
    for (int k = 0; k < 3; ++k) sum[k] = mass * (second[(k + 1) % 3] + second[(k + 2) % 3]) / count;
    Check::relatively_near(made, sum, tolerance);
  }
};

/// A triangle with its center at the origin, in a frame turned by q from the frame of its corners.
struct Triangle {
  double c[3][3], mass = 3.0;

  Triangle(const vector<double> &q, double ax, double ay, double bx, double by)
  {
    const double flat[3][3] = {{ax, ay, 0.0}, {bx, by, 0.0}, {-ax - bx, -ay - by, 0.0}};
    double a[9];
    rotation_matrix(q.data(), 1.0, a);
    for (int n = 0; n < 3; ++n) to_space(a, flat[n], c[n]);
  }

  /// Inertia tensor, integrated with the midpoints of the edges, exact for squares of coordinates.
  void integrate(double tensor[9]) const
  {
    for (int i = 0; i < 9; ++i) tensor[i] = 0.0;
    for (int n = 0; n < 3; ++n) {
      double p[3];
      for (int k = 0; k < 3; ++k) p[k] = 0.5 * (c[n][k] + c[(n + 1) % 3][k]);
      for (int i = 0; i < 9; ++i)
        tensor[i] += mass / 3.0 * ((i % 4 == 0) * dot3(p, p) - p[i / 3] * p[i % 3]);
    }
  }

  void own(double moments[3], double principal[4]) const
  {
    triangle_moments(mass, c[0], c[1], c[2], moments, principal);
  }
};

/// The tensor in the frame of the corners.
void own_tensor(const double moments[3], const double *principal, double tensor[9])
{
  double a[9];
  rotation_matrix(principal, 1.0, a);
  for (int i = 0; i < 9; ++i) tensor[i] = 0.0;
  add_tensor(moments, a, tensor);
}

}    // namespace

TEST(Moments, EllipsoidAndSphereAreThoseOfPoints)
{
  const double axes[3] = {0.5, 1.0, 2.0}, ball[3] = {0.7, 0.7, 0.7};
  const int n = 40;
  Points points;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = -n; k <= n; ++k)
        if (i * i + j * j + k * k <= n * n)
          points.add(axes[0] * i / n, axes[1] * j / n, axes[2] * k / n);
  double made[3], sphere[3];
  ellipsoid_moments(1.0, axes, made);
  points.expect_moments(made, 1.0, 2e-3);
  sphere_moments(3.0, 0.7, sphere);
  ellipsoid_moments(3.0, ball, made);
  EXPECT_LT(largest_difference(sphere, made, 3), 1e-15);
}

TEST(Moments, LineIsThatOfPoints)
{
  const int n = 1000;
  Points points;
  for (int i = 0; i < n; ++i) points.add(1.6 * ((i + 0.5) / n - 0.5), 0.0, 0.0);
  double made[3];
  line_moments(2.5, 1.6, made);
  EXPECT_EQ(made[0], 0.0);
  points.expect_moments(made, 2.5, 1e-5);
}

TEST(Moments, TriangleIsThatOfPoints)
{
  const double c1[3] = {-1.0, -0.5, 0.0}, c2[3] = {1.0, -0.5, 0.0}, c3[3] = {0.0, 1.0, 0.0};
  const int n = 200;
  Points points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n - i; ++j)    // centers of equal pieces, even and odd ones
      for (int odd = 0; odd < (j < n - i - 1 ? 2 : 1); ++odd) {
        const double u = (i + (1 + odd) / 3.0) / n, v = (j + (1 + odd) / 3.0) / n;
        double p[3];
        for (int k = 0; k < 3; ++k) p[k] = c1[k] + u * (c2[k] - c1[k]) + v * (c3[k] - c1[k]);
        points.add(p[0], p[1], p[2]);
      }
  double made[3], principal[4];
  triangle_moments(3.0, c1, c2, c3, made, principal);
  points.expect_moments(made, 3.0, 1e-3);
  const double unturned[4] = {0.0, 0.0, 0.0, 1.0};
  EXPECT_EQ(largest_difference(principal, unturned, 4), 0.0);
}

TEST(Moments, TriangleHasItsTensorInAnyFrame)
{
  Check::Numbers numbers(7);
  for (int n = 0; n < 20; ++n) {
    const Triangle triangle(numbers.unit_quaternion(), -1.0, -0.4, 0.9, 0.1 * n - 1.0);
    double expected[9], moments[3], principal[4], made[9];
    triangle.integrate(expected);
    triangle.own(moments, principal);
    EXPECT_NEAR(dot4(principal, principal), 1.0, 1e-14);
    Check::holds({moments, moments + 3}, [&](const vector<double> &given) {
      own_tensor(given.data(), principal, made);
      return largest_difference(made, expected, 9) < 1e-14;
    });
    const double unturned[4] = {0.0, 0.0, 0.0, 1.0};
    own_tensor(moments, unturned, made);    // the frame of the corners is not principal
    EXPECT_GT(largest_difference(made, expected, 9), 1e-2);
  }
}

TEST(Moments, TriangleHasAnOwnFrameThatDependsOnCornersOnly)
{
  Check::Numbers numbers(8);
  // equilateral: every direction in its plane is principal
  Triangle triangle(numbers.unit_quaternion(), -0.5, -0.5 / std::sqrt(3.0), 0.5,
                    -0.5 / std::sqrt(3.0));
  double moments[3], principal[4], other_moments[3], other[4];
  triangle.own(moments, principal);
  triangle.mass *= 1.7;
  triangle.own(other_moments, other);
  EXPECT_EQ(largest_difference(principal, other, 4), 0.0);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(other_moments[k], 1.7 * moments[k], 1e-15);

  // products of inertia at the level of rounding do not turn it
  const double c1[3] = {-0.5, -0.5 / std::sqrt(3.0), 1e-16},
               c3[3] = {0.0, 1.0 / std::sqrt(3.0), 0.0};
  const double c2[3] = {0.5 + 1e-16, c1[1], -1e-16}, unturned[4] = {0.0, 0.0, 0.0, 1.0};
  triangle_moments(1.0, c1, c2, c3, moments, principal);
  EXPECT_EQ(largest_difference(principal, unturned, 4), 0.0);
}

TEST(Orientations, FollowTheBodyAndComeBack)
{
  Check::Numbers numbers(5);
  const vector<double> body = numbers.unit_quaternion(), own = numbers.unit_quaternion();
  double relative[4], again[4], a_body[9], a_own[9], a_relative[9];
  relative_orientation(body.data(), own.data(), relative);
  site_orientation(body.data(), relative, again);
  EXPECT_LT(quaternion_distance(own.data(), again), 1e-15);

  // own -> body -> space, by matrices
  const vector<double> e = numbers.list(3);
  double in_body[3], in_space[3], expected[3];
  rotation_matrix(body.data(), 1.0, a_body);
  rotation_matrix(own.data(), 1.0, a_own);
  rotation_matrix(relative, 1.0, a_relative);
  to_space(a_relative, e.data(), in_body);
  to_space(a_body, in_body, in_space);
  to_space(a_own, e.data(), expected);
  EXPECT_LT(largest_difference(in_space, expected, 3), 1e-15);

  // of unit length for a body quaternion of any length, but not for any relative orientation
  vector<double> longer = body;
  for (double &x : longer) x *= 1.01;
  site_orientation(longer.data(), relative, again);
  EXPECT_LT(quaternion_distance(own.data(), again), 1e-15);
  site_orientation(body.data(), own.data(), again);
  EXPECT_GT(quaternion_distance(own.data(), again), 1e-2);
}

TEST(Orientations, TensorAndAngularMomentumAgree)
{
  Check::Numbers numbers(6);
  const vector<double> q = numbers.unit_quaternion(), omega = numbers.list(3);
  const double moments[3] = {3.0, 2.0, 0.5};
  double a[9], tensor[9] = {0, 0, 0, 0, 0, 0, 0, 0, 0}, momentum[3], expected[3];
  rotation_matrix(q.data(), 1.0, a);
  add_tensor(moments, a, tensor);
  own_angular_momentum(moments, a, omega.data(), momentum);
  for (int k = 0; k < 3; ++k) expected[k] = dot3(tensor + 3 * k, omega.data());
  EXPECT_LT(largest_difference(momentum, expected, 3), 1e-14);
  EXPECT_NEAR(tensor[0] + tensor[4] + tensor[8], 5.5, 1e-14);
}

TEST(Orientations, AnglesAboutZ)
{
  const double pi = 3.14159265358979323846;
  for (const double angle : {-3.1, -1.0, 0.0, 0.3, 2.0, 3.1}) {
    double q[4], minus[4];
    quaternion_about_z(angle, q);
    for (int k = 0; k < 4; ++k) minus[k] = -q[k];
    EXPECT_NEAR(angle_about_z(q), angle, 1e-15 * 4);
    EXPECT_NEAR(angle_about_z(minus), angle, 1e-15 * 4);
    quaternion_about_z(angle + 2 * pi, q);
    EXPECT_NEAR(angle_about_z(q), angle, 1e-14);
  }
  double x[3], a[9], q[4];
  const double e[3] = {1, 0, 0};
  quaternion_about_z(0.3, q);
  rotation_matrix(q, 1.0, a);
  to_space(a, e, x);
  EXPECT_NEAR(x[0], std::cos(0.3), 1e-15);
  EXPECT_NEAR(x[1], std::sin(0.3), 1e-15);
}
