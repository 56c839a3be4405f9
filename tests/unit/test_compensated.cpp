/* Compensated histories: the value of a row is row + carry.  Compared with 113 bits, and by the
   error after many small steps, in both formulations. */

#include "scenes.h"

using namespace Drive;

namespace {

__extension__ typedef __float128 Quad;

constexpr double HALF_ULP = 1.1102230246251565e-16;

double magnitude(Quad x)
{
  return std::fabs(double(x));
}

/// n rows of one component, each `ratio` times the previous one, followed by a carry for each of
/// the first rows, a part of the last digit.
template <int CARRIES> vector<double> some_rows(int n, double ratio)
{
  Check::Numbers numbers(17 + n);
  vector<double> rows(n + CARRIES);
  for (int j = 0; j < n; ++j) rows[j] = (1.25 + 0.5 * numbers.next()) * std::pow(ratio, j);
  for (int j = 0; j < CARRIES; ++j) rows[n + j] = (0.6 + 0.3 * numbers.next()) * HALF_ULP * rows[j];
  return rows;
}

template <int CARRIES> vector<Quad> exact(const vector<double> &rows, int n)
{
  vector<Quad> sum(rows.begin(), rows.begin() + n);
  for (int j = 0; j < CARRIES; ++j) sum[j] += rows[n + j];
  return sum;
}

/// Largest error of the first rows after `change`, compared with 113 bits, in half units of the
/// last digit of the row above (the loss allowed for a carry), and relative to the rows themselves.
struct Lost {
  double of_upper, of_row;
};
template <int CARRIES> Lost lost(const vector<double> &rows, const vector<Quad> &truth, int n)
{
  const vector<Quad> sum = exact<CARRIES>(rows, n);
  Lost worst = {0.0, 0.0};
  for (int j = 0; j < std::max(CARRIES, 1); ++j) {
    const double e = magnitude(sum[j] - truth[j]);
    worst.of_upper = std::max(worst.of_upper, e / (HALF_ULP * magnitude(truth[j + 1])));
    worst.of_row = std::max(worst.of_row, e / (HALF_ULP * magnitude(truth[j])));
  }
  return worst;
}

vector<Quad> predicted(vector<Quad> rows)
{
  const int n = int(rows.size());
  for (int pass = 0; pass < n - 1; ++pass)
    for (int j = n - 2; j >= pass; --j) rows[j] += rows[j + 1];
  return rows;
}

template <int CARRIES> void expect_predict_to_keep_digits()
{
  for (int n = 3; n <= MAX_VALUES; ++n) {
    const vector<double> start = some_rows<CARRIES>(n, 1e-5);
    const vector<Quad> truth = predicted(exact<CARRIES>(start, n));
    auto after = [&](vector<double> rows) {
      Nordsieck<1, CARRIES>::predict(rows.data(), n);
      return lost<CARRIES>(rows, truth, n);
    };
    EXPECT_LT(after(start).of_upper, 4.0) << n;
    EXPECT_LT(after(start).of_row, 1e-4) << n;    // of the loss allowed for a sum in double
  }
}

}    // namespace

TEST(Compensated, PredictionLosesNoMoreThanTheLastDigitOfTheIncrement)
{
  expect_predict_to_keep_digits<1>();
  expect_predict_to_keep_digits<2>();
}

TEST(Compensated, CorrectionLosesNoMoreThanTheLastDigitOfTheIncrement)
{
  const int n = 6;
  const vector<double> c = {0.15, 0.7, 1.0, 0.6, 0.2, 0.02}, start = some_rows<2>(n, 1e-4);
  const double residual = 3.7e-9;
  vector<double> rows = start;
  Nordsieck<1, 2>::correct<1>(rows.data(), n, c.data(), 0, &residual);
  const vector<Quad> before = exact<2>(start, n), after = exact<2>(rows, n);
  for (int j = 0; j < n; ++j) {
    // a carry is part of the sum, which loses a part in 1e16 of both by rounding
    const double way = c[j] * residual,
                 limit = j < 2 ? 2 * way : 1.01 * (std::fabs(start[j]) + way);
    EXPECT_LE(magnitude(after[j] - before[j] - Quad(c[j]) * residual), HALF_ULP * limit);
  }
}

TEST(Compensated, RescalingKeepsRowAndCarry)
{
  // row 1 is the only scaled row with a carry; factors that are not powers of two
  const int n = 5;
  for (double ratio : {0.3, -1.0, 1.7, 0.001}) {
    const vector<double> start = some_rows<2>(n, 0.5);
    vector<double> rows = start;
    Nordsieck<1, 2>::rescale(rows.data(), n, ratio);
    const vector<Quad> before = exact<2>(start, n), after = exact<2>(rows, n);
    Quad factor = 1;
    for (int j = 0; j < n; ++j, factor *= ratio) {
      const double limit = j == 0 ? 0.0 : j == 1 ? 1e-31 : 5e-16;
      EXPECT_LE(magnitude(after[j] - before[j] * factor), limit * magnitude(before[j] * factor));
    }
  }
}

TEST(Compensated, PlainHistoriesHaveNoCarries)
{
  for (Scheme scheme : every_scheme()) {
    EXPECT_EQ(scheme.size(), scheme.values() * scheme.width());
    scheme.compensate = true;
    const int carries = scheme.first() ? 1 : 2;    // rows that are integrated
    EXPECT_EQ(scheme.size(), (scheme.values() + carries) * scheme.width());
    EXPECT_LE(scheme.size(), MAX_SIZE);
  }
}

TEST(Compensated, ManyStepsOfAnOscillatorAndOfTheFreeTop)
{
  const double h = 0.00048828125;    // 2^-11: times are exact
  for (Formulation formulation : {FIRST, SECOND}) {
    const Scheme plain = scheme_of(formulation), kept = scheme_of(formulation, 0, 1, true);
    const double swings = error(oscillator(1000000 * h), kept, h, 0.0625);
    EXPECT_LT(swings, 1e-13);
    EXPECT_GT(error(oscillator(1000000 * h), plain, h, 0.0625), 5 * swings);
    const double spins = error(free_top(), kept, 24.0 / 200000, 0.06);
    EXPECT_LT(spins, 8e-15);    // of the matrix: twice the quaternion's
    EXPECT_GT(error(free_top(), plain, 24.0 / 200000, 0.06), 5 * spins);
  }
}
