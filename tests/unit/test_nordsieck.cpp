/* gear_quat_history.h: the history is a polynomial, and prediction moves along it exactly. */

#include "checks.h"
#include "gear_quat_history.h"

using namespace LAMMPS_NS::GearQuat;
using Check::largest_difference;

namespace {

constexpr int N = 6, WIDTH = 3;
using Rows = Nordsieck<WIDTH>;

std::vector<double> rows_of(const std::vector<double> &a, double t, double h)
{
  return Check::polynomial_rows(a, WIDTH, t, h);
}

}    // namespace

TEST(Nordsieck, PredictIsTaylorsSeriesExactly)
{
  // small integers: every sum is exact, so the comparison is bitwise
  const std::vector<double> a = {1, -2, 3, 4, 5, -6, 7, 1, -2, 3, -4, 5, 2, 2, -3, 1, -1, 2};
  std::vector<double> rows = rows_of(a, 2.0, 1.0);
  Rows::predict(rows.data(), N);
  EXPECT_EQ(rows, rows_of(a, 3.0, 1.0));
}

TEST(Nordsieck, RescaledHistoryIsTheSamePolynomial)
{
  const std::vector<double> a = Check::Numbers(2).list(N * WIDTH);
  const std::vector<double> expected = rows_of(a, 0.7, 0.3);
  std::vector<double> rows = rows_of(a, 0.7, 0.8);
  Rows::rescale(rows.data(), N, 0.3 / 0.8);
  for (int i = 0; i < N * WIDTH; ++i)
    EXPECT_NEAR(rows[i], expected[i], 1e-14 * std::fabs(expected[i]));
}

TEST(Nordsieck, CorrectTouchesItsColumnsOnly)
{
  const std::vector<double> start = Check::Numbers(4).list(N * WIDTH);
  const std::vector<double> c = {0.5, 1.0, 0.25, 2.0, -1.0, 4.0};
  const double residual[] = {3.0, -5.0};
  std::vector<double> rows = start;
  Rows::correct<2>(rows.data(), N, c.data(), 1, residual);
  for (int j = 0; j < N; ++j) {
    EXPECT_EQ(rows[3 * j], start[3 * j]);
    EXPECT_EQ(rows[3 * j + 1], start[3 * j + 1] + c[j] * 3.0);
    EXPECT_EQ(rows[3 * j + 2], start[3 * j + 2] + c[j] * -5.0);
  }
}
