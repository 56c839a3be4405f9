/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Compensated histories: a row stands for row + carry.  Judged in 113 bits, and by what is left
   after a million small steps, in both formulations. */

#include "checks.h"
#include "drive.h"
#include "oracles/swinging_top.h"

using namespace Drive;
using std::vector;

namespace {

__extension__ typedef __float128 Quad;

constexpr double HALF_ULP = 1.1102230246251565e-16;

double magnitude(Quad x)
{
  return std::fabs(double(x));
}

/// n rows of one component, each `ratio` times the one before, and a carry of a part of the last
/// digit behind them for each of the first rows.
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

/// Largest error of the first rows after `change`, against the same in 113 bits, in half units of
/// the last digit of the row above (what a carry may lose), and relative to the rows themselves.
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
    EXPECT_LT(after(start).of_row, 1e-4) << n;    // of what a sum in double may lose
    for (int j = 0; j < CARRIES; ++j) {           // 1 % of a carry, or 1 % of a row
      vector<double> bad = start;
      bad[n + j] *= 1.01;
      EXPECT_GT(after(bad).of_upper, 100.0) << n << ' ' << j;
      bad = start;
      bad[j] *= 1.01;
      EXPECT_GT(after(bad).of_row, 1e10);
    }
  }
}

/// Columns of x alone: a body that flies freely, in 1e6 steps; error relative to the way.
struct Flight {
  double error, of_one_percent;
};

Flight free_flight(Scheme scheme, bool compensate)
{
  scheme.compensate = compensate;
  const RigidBody body = {3.0, {1.0, 1.0, 1.0}};
  BodyState start = {};
  start.q[3] = 1.0;
  start.center[0] = 1000.1;
  start.velocity[0] = 0.7;
  const double h = 1e-4;
  const int n = 1000000;
  Motion motion(body, start, free_of_load, scheme, h, Start::FORCES, h);
  // the way of one step as the start has rounded it: first p/m is one, second row 1
  const Quad step = motion.rows[scheme.width()];
  const Quad end = Quad(motion.rows[0]) + n * step;
  motion.steps(n);
  return {magnitude(motion.rows[0] - end), magnitude(0.01 * n * step)};
}

double oscillation(Scheme scheme, bool compensate, double k)
{
  scheme.compensate = compensate;
  const RigidBody body = {1.0, {1.0, 1.0, 1.0}};
  BodyState start = {};
  start.q[3] = start.center[0] = start.velocity[1] = 1.0;
  auto spring = [k](const BodyState &s, double) {
    Load l = {};
    for (int i = 0; i < 2; ++i) l.force[i] = -k * s.center[i];
    return l;
  };
  const double h = 0.00048828125;    // 2^-11: times are exact
  const int n = 1000000;
  Motion motion(body, start, spring, scheme, h, Start::BOOTSTRAP, 0.0625);
  motion.steps(n);
  const long double t = (long double) h * n;
  return std::max(std::fabs(double(motion.rows[0] - std::cos(t))),
                  std::fabs(double(motion.rows[1] - std::sin(t))));
}

double spin(Scheme scheme, bool compensate)
{
  scheme.compensate = compensate;
  static const BodyState end = Oracle::top_state(24.0);
  const int n = 200000;
  Motion motion(Oracle::TOP, Oracle::top_state(0.0), free_of_load, scheme, 24.0 / n,
                Start::BOOTSTRAP, 0.06);
  motion.steps(n);
  return Check::quaternion_distance(motion.q(), end.q);
}

const Scheme BOTH[] = {scheme_of(Formulation::FIRST), scheme_of(Formulation::SECOND)};

}    // namespace

TEST(Compensated, PredictionLosesNoMoreThanTheLastDigitOfTheIncrement)
{
  expect_predict_to_keep_digits<1>();
  expect_predict_to_keep_digits<2>();
}

TEST(Compensated, PlainPredictionLosesTheLastDigitOfTheRow)
{
  double worst = 0.0;
  for (int n = 3; n <= MAX_VALUES; ++n) {
    vector<double> rows = some_rows<0>(n, 1e-4);
    const vector<Quad> truth = predicted(exact<0>(rows, n));
    Nordsieck<1>::predict(rows.data(), n);
    worst = std::max(worst, lost<0>(rows, truth, n).of_row);
  }
  EXPECT_GT(worst, 0.3);
}

TEST(Compensated, CorrectionLosesNoMoreThanTheLastDigitOfTheIncrement)
{
  const int n = 6;
  const vector<double> c = {0.15, 0.7, 1.0, 0.6, 0.2, 0.02}, start = some_rows<2>(n, 1e-4);
  const double residual = 3.7e-9;
  auto check = [&](const vector<double> &from) {
    vector<double> rows = from;
    Nordsieck<1, 2>::correct<1>(rows.data(), n, c.data(), 0, &residual);
    const vector<Quad> before = exact<2>(start, n), after = exact<2>(rows, n);
    for (int j = 0; j < n; ++j) {
      const double way = c[j] * residual,
                   e = magnitude(after[j] - before[j] - Quad(c[j]) * residual);
      // a carry takes part in the sum, which rounds away a part in 1e16 of both
      if (j < 2 && !(e <= 2 * HALF_ULP * way)) return false;
      if (j >= 2 && !(e <= HALF_ULP * (std::fabs(start[j]) + way) * 1.01)) return false;
    }
    return true;
  };
  Check::holds_and_refuses_one_percent(start, check);
}

TEST(Compensated, SumAndCarryAreOneNumberBrokenAtTheLastDigit)
{
  // after any addition the carry is below half of the last digit: nothing is left to move over
  vector<double> rows = some_rows<2>(6, 1e-3);
  for (int k = 0; k < 1000; ++k) Nordsieck<1, 2>::predict(rows.data(), 6);
  for (int j = 0; j < 2; ++j) EXPECT_EQ(rows[j] + rows[6 + j], rows[j]);
  EXPECT_NE(rows[6], 0.0);
}

TEST(Compensated, AddTouchesItsComponentsOnly)
{
  vector<double> rows = Check::Numbers(3).list((5 + 2) * 3), before = rows;
  const double value[2] = {1e-3, -2e-3};
  Nordsieck<3, 2>::add<2>(rows.data(), 5, 1, 1, value);
  for (int i = 0; i < int(rows.size()); ++i) {
    const bool own = i == 4 || i == 5 || i == 6 * 3 + 1 || i == 6 * 3 + 2;    // row 1, its carry
    EXPECT_EQ(rows[i] != before[i], own) << i;
  }
}

TEST(Compensated, RescalingKeepsRowAndCarry)
{
  // row 1 is the only scaled row with a carry; factors that are no powers of two
  const int n = 5;
  for (double ratio : {0.3, -1.0, 1.7, 0.001}) {
    const vector<double> start = some_rows<2>(n, 0.5);
    const vector<Quad> before = exact<2>(start, n);
    auto check = [&](const vector<double> &from) {
      vector<double> rows = from;
      Nordsieck<1, 2>::rescale(rows.data(), n, ratio);
      const vector<Quad> after = exact<2>(rows, n);
      Quad factor = 1;
      for (int j = 0; j < n; ++j, factor *= ratio) {
        const double limit = j == 0 ? 0.0 : j == 1 ? 1e-31 : 5e-16;
        if (!(magnitude(after[j] - before[j] * factor) <= limit * magnitude(before[j] * factor)))
          return false;
      }
      return true;
    };
    Check::holds_and_refuses_one_percent(start, check);
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

TEST(Compensated, MillionStepsOfFreeFlight)
{
  for (const Scheme &scheme : BOTH) {
    const Flight plain = free_flight(scheme, false), kept = free_flight(scheme, true);
    std::printf("1e6 steps of free flight, %-6s: %.1e, compensated %.1e\n", name(scheme),
                plain.error, kept.error);
    EXPECT_LE(kept.error, 1000.1 * HALF_ULP * 1.1);    // the position's own last digit
    EXPECT_GT(plain.error, 1e-11);
    EXPECT_GT(kept.of_one_percent, 0.5);
  }
}

TEST(Compensated, MillionStepsOfAnOscillator)
{
  for (const Scheme &scheme : BOTH) {
    const double plain = oscillation(scheme, false, 1.0), kept = oscillation(scheme, true, 1.0);
    std::printf("1e6 steps of an oscillator, %-6s: %.1e, compensated %.1e\n", name(scheme), plain,
                kept);
    EXPECT_LT(kept, 1e-13);
    EXPECT_GT(plain, 5 * kept);
  }
  EXPECT_GT(oscillation(BOTH[1], true, 1.01), 0.1);
}

TEST(Compensated, ManyStepsOfTheFreeTop)
{
  for (const Scheme &scheme : BOTH) {
    const double plain = spin(scheme, false), kept = spin(scheme, true);
    std::printf("2e5 steps of the free top, %-6s: %.1e, compensated %.1e\n", name(scheme), plain,
                kept);
    EXPECT_LT(kept, 2e-15);
    EXPECT_GT(plain, 5 * kept);
  }
}
