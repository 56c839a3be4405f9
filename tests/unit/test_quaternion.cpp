/* gear_quat_math.h: the paper's Eqs. 2 to 10 with the misprints of W and A corrected. */

#include "checks.h"
#include "gear_quat_shapes.h"
#include "oracles/paper_step.h"

using namespace LAMMPS_NS::GearQuat;
using Check::attitude_distance;
using Check::largest_difference;
using Check::not_orthogonal;
using Check::quaternion_distance;
using std::vector;

namespace {

const double PI = std::acos(-1.0);

}    // namespace

TEST(Quaternion, WIsThePrintedMatrixWithItsLastRowCorrected)
{
  Check::Numbers numbers(11);
  const vector<double> q = numbers.list(4), a = numbers.list(4);
  const auto w = Oracle::PaperStep::w(q.data());
  double expected[4], out[4];
  for (int i = 0; i < 4; ++i) expected[i] = dot4(w[i].data(), a.data());
  w_times(q.data(), a.data(), out);
  EXPECT_LE(largest_difference(out, expected, 4), 1e-15);
}

TEST(Quaternion, RotationMatrixIsThatOfEulerAngles)
{
  for (double phi : {0.0, 40 * PI / 180, 2.9, -1.3})
    for (double psi : {0.0, 100 * PI / 180, -2.2})
      for (double theta : {0.0, 1e-9, 85 * PI / 180, 3.0, PI}) {
        double q[4], a[9];
        Oracle::euler_quaternion(phi, psi, theta, q);
        EXPECT_NEAR(dot4(q, q), 1.0, 1e-15);
        rotation_matrix(q, dot4(q, q), a);
        EXPECT_LT(not_orthogonal(a), 1e-15);
        EXPECT_LE(attitude_distance(q, Oracle::euler_matrix(phi, psi, theta)), 1e-15);
        EXPECT_GT(attitude_distance(q, Oracle::euler_matrix(phi, psi, theta + 0.01)), 1e-3);
      }
}

TEST(Quaternion, MatrixOfAnyLengthIsARotationAndWithNormOneIsEq8)
{
  const vector<double> q = Check::Numbers(13).list(4);
  double a[9], unit[9], u[4] = {q[0], q[1], q[2], q[3]};
  project_norm(u);
  rotation_matrix(q.data(), dot4(q.data(), q.data()), a);
  rotation_matrix(u, 1.0, unit);
  EXPECT_LT(not_orthogonal(a), 1e-15);
  EXPECT_LT(largest_difference(a, unit, 9), 1e-15);

  const auto half = Oracle::PaperStep::half_a(q.data(), 1.0);
  rotation_matrix(q.data(), 1.0, a);
  EXPECT_GT(not_orthogonal(a), 1e-2);    // this q is not a unit quaternion
  for (double &x : a) x *= 0.5;
  EXPECT_LE(largest_difference(a, half.data(), 9), 0.5e-15);
}

TEST(Quaternion, FromMatrixReturnsInAllFourBranches)
{
  int met[4] = {0, 0, 0, 0};
  Check::Numbers numbers(14);
  auto back = [](const double *q, double *returned) {
    double a[9];
    rotation_matrix(q, dot4(q, q), a);
    quaternion_from_matrix(a, returned);
  };
  for (int i = 0; i < 400; ++i) {
    const vector<double> q = numbers.unit_quaternion();
    double returned[4];
    back(q.data(), returned);
    EXPECT_LT(quaternion_distance(q.data(), returned), 1e-15);
    auto smaller = [](double a, double b) {
      return std::fabs(a) < std::fabs(b);
    };
    ++met[std::max_element(q.begin(), q.end(), smaller) - q.begin()];
  }
  EXPECT_GT(*std::min_element(met, met + 4), 50);

  // a single component is a half turn (theta = pi) or no rotation; ties must not divide by zero
  // either
  const double half = std::sqrt(0.5);
  const double edges[][4] = {{1, 0, 0, 0},          {0, 1, 0, 0},         {0, 0, 1, 0},    //
                             {0, 0, 0, 1},          {0.5, 0.5, 0.5, 0.5}, {half, 0, half, 0},
                             {0.5, -0.5, 0.5, -0.5}};
  for (const auto &q : edges) {
    double returned[4];
    back(q, returned);
    EXPECT_LT(quaternion_distance(q, returned), 1e-15);
  }
}

TEST(Quaternion, RateTurnsTheMatrixAsOmegaDoes)
{
  // dA/dt = -omega x A, column by column: the definition of omega in the body frame
  Check::Numbers numbers(15);
  const vector<double> q = numbers.unit_quaternion(), w = numbers.list(3);
  double a[9], qdot[4], adot[9];
  rotation_matrix(q.data(), 1.0, a);
  quaternion_rate(q.data(), w.data(), qdot);
  const auto path = [&](double t, double *out) {
    double p[4];
    for (int i = 0; i < 4; ++i) p[i] = q[i] + t * qdot[i];
    rotation_matrix(p, dot4(p, p), out);
  };
  Check::derivative(path, 9, 1e-3, adot);
  for (int c = 0; c < 3; ++c) {
    const double column[3] = {a[c], a[3 + c], a[6 + c]};
    double turned[3];
    cross3(w.data(), column, turned);
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(adot[3 * r + c], -turned[r], 1e-11);
  }
  EXPECT_NEAR(dot4(q.data(), qdot), 0.0, 1e-15);
}

TEST(Quaternion, AngularVelocityInvertsTheRate)
{
  Check::Numbers numbers(16);
  const vector<double> q = numbers.list(4), omega = numbers.list(3);
  double qdot[4], back[3];
  quaternion_rate(q.data(), omega.data(), qdot);
  angular_velocity(q.data(), dot4(q.data(), q.data()), qdot, back);
  EXPECT_LE(largest_difference(back, omega.data(), 3), 1e-15);

  double radial[4], none[3], zero[3] = {0, 0, 0};    // growth of |q| is not a rotation
  for (int i = 0; i < 4; ++i) radial[i] = 0.3 * q[i];
  angular_velocity(q.data(), 1.0, radial, none);
  EXPECT_LT(largest_difference(none, zero, 3), 1e-16);
}

TEST(Quaternion, AccelerationIsTheDerivativeOfTheRate)
{
  Check::Numbers numbers(17);
  const vector<double> q = numbers.unit_quaternion(), w = numbers.list(3), wdot = numbers.list(3);
  double qdot[4], expected[4], qddot[4];
  quaternion_rate(q.data(), w.data(), qdot);
  auto path = [&](double t, double *out) {    // qdot along q + t qdot, w + t wdot
    double p[4], omega[3];
    for (int i = 0; i < 4; ++i) p[i] = q[i] + t * qdot[i];
    for (int i = 0; i < 3; ++i) omega[i] = w[i] + t * wdot[i];
    quaternion_rate(p, omega, out);
  };
  Check::derivative(path, 4, 1e-2, expected);
  quaternion_acceleration(q.data(), qdot, wdot.data(), qddot);
  EXPECT_LE(largest_difference(qddot, expected, 4), 1e-13);
}

TEST(Quaternion, ProjectionsMeetTheirConstraintAndNothingElse)
{
  Check::Numbers numbers(18);
  vector<double> q = numbers.list(4);
  const vector<double> before = q;
  project_norm(q.data());
  EXPECT_NEAR(dot4(q.data(), q.data()), 1.0, 4e-16);
  for (int i = 0; i < 4; ++i)    // along q
    EXPECT_NEAR(q[i] * std::sqrt(dot4(before.data(), before.data())), before[i], 1e-15);

  double legal[4] = {0.5, -0.5, 0.5, 0.5}, same[4] = {0.5, -0.5, 0.5, 0.5};
  project_norm(legal);
  EXPECT_EQ(largest_difference(legal, same, 4), 0.0);
}
