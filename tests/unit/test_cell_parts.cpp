/* The parts of a moving cell: its matrices, friction and history. */

#include "checks.h"
#include "drive.h"
#include "gear_quat_cell.h"

using namespace Drive;
using std::vector;

namespace {

/// All nine components, row by row.
vector<double> full(const Upper &u)
{
  return {u[Upper::XX], u[Upper::XY], u[Upper::XZ], 0.0,         u[Upper::YY],
          u[Upper::YZ], 0.0,          0.0,          u[Upper::ZZ]};
}

Upper some_matrix()
{
  return {{1.1, 0.9, 1.3, 0.2, -0.15, 0.3}};
}
Upper some_rate()
{
  return {{0.3, -0.2, 0.15, 0.1, -0.25, 0.35}};
}

vector<double> product(const vector<double> &a, const vector<double> &b)
{
  vector<double> all(9, 0.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) all[3 * i + j] += a[3 * i + k] * b[3 * k + j];
  return all;
}

}    // namespace

TEST(Upper, IsTheAlgebraOfMatrices)
{
  const Upper a = some_matrix(), b = some_rate();
  const double v[3] = {0.7, -1.1, 0.4};
  EXPECT_LT(Check::largest_difference(full(a * b), product(full(a), full(b))), 1e-15);
  EXPECT_LT(Check::largest_difference(full(a * a.inverse()), full(Upper::one())), 1e-15);
  EXPECT_LT(Check::largest_difference(full(a + b - a), full(b)), 1e-15);
  EXPECT_LT(Check::largest_difference(full(a.scaled(2.0)), full(a + a)), 1e-15);
  double forward[3], rows[3], sum = 0.0, trace = 0.0;
  a.times(v, forward);
  const vector<double> all = full(a);
  for (int i = 0; i < 3; ++i) {
    rows[i] = a.row_times(i, v);
    double expected = 0.0;
    for (int k = 0; k < 3; ++k) {
      expected += all[3 * i + k] * v[k];
      sum += all[3 * i + k] * full(b)[3 * i + k];
    }
    trace += all[4 * i];
    EXPECT_NEAR(forward[i], expected, 1e-15);
    EXPECT_NEAR(rows[i], expected, 1e-15);
  }
  EXPECT_NEAR(a.contracted(b), sum, 1e-15);
  EXPECT_NEAR(a.trace(), trace, 1e-15);
  EXPECT_NEAR(a.determinant(), 1.1 * 0.9 * 1.3, 1e-15);
}

TEST(FrictionInCell, ItsImplicitResidualIsTheFixedPointOfTheExplicitOne)
{
  Friction alpha = Multipliers{0.8, 0.5};
  for (int k = 0; k < 3; ++k) alpha.common[k] = 0.2 * (k - 1.3);
  const double b[3] = {0.5, 0.1, -0.2}, mass = 1.7, share = 0.4;
  const Friction friction = friction_in_cell(alpha, some_matrix(), some_rate(), b);
  const double predicted[3] = {0.9, -0.6, 0.35}, met[3] = {0.3, 0.8, -1.1};
  double momentum[3], residual[3] = {}, solved[3];
  for (int round = 0; round < 200; ++round) {
    for (int i = 0; i < 3; ++i) momentum[i] = predicted[i] + share * residual[i];
    friction.add_to(met, momentum, mass, residual);
  }
  friction.add_to(met, predicted, mass, solved);
  friction.solve(share, solved);
  EXPECT_LT(Check::largest_difference(solved, residual, 3), 1e-13);
  EXPECT_EQ(friction.implicit_torque(0.4), 1.0 / (1.0 + 0.4 * 0.5));
  EXPECT_EQ(friction.torque(0.3, 0.7), 0.3 - 0.5 * 0.7);
}

TEST(FrictionInCell, ACommonMotionIsConstantInSpace)
{
  // V = M c with a constant V: c' = -M^-1 G M c, for any friction and b
  Friction alpha = Multipliers{0.8, 0.5};
  const double velocity[3] = {0.4, -0.7, 0.9}, b[3] = {0.5, 0.1, -0.2}, mass = 1.7;
  std::copy_n(velocity, 3, alpha.common);
  const Friction friction = friction_in_cell(alpha, some_matrix(), some_rate(), b);
  const double none[3] = {};
  double c[3], p[3], rate[3], change[3], drift[3];
  some_matrix().inverse().times(velocity, c);
  for (int k = 0; k < 3; ++k) p[k] = mass * c[k];
  friction.add_to(none, p, mass, rate);
  for (double &one : rate) one /= mass;
  some_matrix().times(rate, change);    // (M c)' = M c' + G M c
  some_rate().times(velocity, drift);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(change[k] + drift[k], 0.0, 1e-15);
}

TEST(CellHistory, ANewStepKeepsTheMotion)
{
  CellHistory cell(scheme_of(MOMENTUM, 5));
  cell.begin(some_rate(), 0.1);
  cell.rescale(0.5);
  EXPECT_LT(Check::largest_difference(full(cell.rate(0.05)), full(some_rate())), 1e-15);
  EXPECT_LT(Check::largest_difference(full(cell.matrix()), full(Upper::one())), 1e-15);
}
