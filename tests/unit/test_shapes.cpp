/* gear_quat_shapes.h: own inertia of triangles, and angles in two dimensions.  Other extended sites are in
   tests/lammps/test_extended.py. */

#include "checks.h"
#include "gear_quat_shapes.h"

using namespace LAMMPS_NS::GearQuat;
using Check::largest_difference;
using std::vector;

namespace {

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

TEST(Moments, TriangleHasItsTensorInAnyFrame)
{
  Check::Numbers numbers(7);
  for (int n = 0; n < 20; ++n) {
    const Triangle triangle(numbers.unit_quaternion(), -1.0, -0.4, 0.9, 0.1 * n - 1.0);
    double expected[9], moments[3], principal[4], made[9];
    triangle.integrate(expected);
    triangle.own(moments, principal);
    EXPECT_NEAR(dot4(principal, principal), 1.0, 1e-14);
    own_tensor(moments, principal, made);
    EXPECT_LT(largest_difference(made, expected, 9), 1e-14);
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
