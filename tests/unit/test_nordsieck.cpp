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
  auto check = [&](const std::vector<double> &start) {
    std::vector<double> rows = start;
    Rows::predict(rows.data(), N);
    return rows == rows_of(a, 3.0, 1.0);
  };
  Check::holds(rows_of(a, 2.0, 1.0), check);
}

TEST(Nordsieck, PredictWorksForEveryNumberOfRows)
{
  for (int n = 3; n <= 12; ++n) {
    std::vector<double> rows(n, 1.0);
    const std::vector<double> expected = Check::polynomial_rows(rows, 1, 1.0, 1.0);
    Nordsieck<1>::predict(rows.data(), n);
    EXPECT_EQ(rows, expected) << n;
  }
}

TEST(Nordsieck, PredictBackwardsReturns)
{
  const std::vector<double> start = Check::Numbers(1).list(N * WIDTH);
  auto there_and_back = [&](double ratio) {
    std::vector<double> rows = start;
    Rows::predict(rows.data(), N);
    Rows::rescale(rows.data(), N, ratio);
    Rows::predict(rows.data(), N);
    Rows::rescale(rows.data(), N, 1.0 / ratio);
    return largest_difference(rows, start);
  };
  EXPECT_LT(there_and_back(-1.0), 1e-14);
}

TEST(Nordsieck, RescaledHistoryIsTheSamePolynomial)
{
  const std::vector<double> a = Check::Numbers(2).list(N * WIDTH);
  const std::vector<double> expected = rows_of(a, 0.7, 0.3);
  auto check = [&](const std::vector<double> &start) {
    std::vector<double> rows = start;
    Rows::rescale(rows.data(), N, 0.3 / 0.8);
    // row 5 is small after rescaling: each row is compared relative to its own size
    for (int i = 0; i < N * WIDTH; ++i)
      if (!(std::fabs(rows[i] - expected[i]) <= 1e-14 * std::fabs(expected[i]))) return false;
    return true;
  };
  Check::holds(rows_of(a, 0.7, 0.8), check);
}

TEST(Nordsieck, RescalesCompose)
{
  std::vector<double> twice = Check::Numbers(3).list(N * WIDTH), once = twice;
  Rows::rescale(twice.data(), N, 0.5);
  Rows::rescale(twice.data(), N, 0.25);
  Rows::rescale(once.data(), N, 0.125);
  EXPECT_EQ(twice, once);    // powers of two: bitwise equal
  Rows::rescale(twice.data(), N, 1.0);
  EXPECT_EQ(twice, once);
  Rows::rescale(once.data(), N, 1.01);
  EXPECT_NE(twice, once);
}

TEST(Nordsieck, CorrectTouchesItsColumnsOnly)
{
  const std::vector<double> start = Check::Numbers(4).list(N * WIDTH);
  const std::vector<double> c = {0.5, 1.0, 0.25, 2.0, -1.0, 4.0};
  auto check = [&](const std::vector<double> &residual) {
    std::vector<double> rows = start;
    Rows::correct<2>(rows.data(), N, c.data(), 1, residual.data());
    for (int j = 0; j < N; ++j) {
      if (rows[3 * j] != start[3 * j]) return false;
      if (rows[3 * j + 1] != start[3 * j + 1] + c[j] * 3.0) return false;
      if (rows[3 * j + 2] != start[3 * j + 2] + c[j] * -5.0) return false;
    }
    return true;
  };
  Check::holds({3.0, -5.0}, check);
}
