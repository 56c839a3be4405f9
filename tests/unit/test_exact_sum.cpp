/* Sums that do not depend on the order of their terms. */

#include "checks.h"

#include "gear_quat_exact_sum.h"

#include <limits>

using LAMMPS_NS::GearQuat::ExactSum;
using std::vector;

namespace {

double sum(const vector<double> &terms, double scale, int parts = 1)
{
  vector<ExactSum> part(parts);
  for (size_t i = 0; i < terms.size(); ++i) part[i % parts].add(terms[i], scale);
  ExactSum all;
  for (const auto &one : part) all.add(one);
  return all.value();
}

/// Terms of very different sizes, like kinetic energies.
vector<double> energies(int n)
{
  Check::Numbers numbers(7);
  vector<double> terms;
  for (int i = 0; i < n; ++i) terms.push_back(std::pow(numbers.next(), 2) * std::pow(2.0, i % 7));
  return terms;
}

}    // namespace

TEST(ExactSum, NeitherOrderNorPartsMatter)
{
  vector<double> terms = energies(1000);
  const double scale = ExactSum::scale_of(700.0), first = sum(terms, scale);
  double plain = 0.0, reversed = 0.0;
  for (const double one : terms) plain += one;
  std::reverse(terms.begin(), terms.end());
  for (const double one : terms) reversed += one;
  EXPECT_NE(plain, reversed);    // plain sums do depend on the order
  for (const int parts : {1, 2, 4, 7}) EXPECT_EQ(sum(terms, scale, parts), first);
}

TEST(ExactSum, AsExactAsADouble)
{
  for (const double size : {1.0e-12, 1.0, 3.0e7}) {
    vector<double> terms = energies(1000);
    long double exact = 0.0L;
    double total = 0.0;
    for (double &one : terms) {
      one *= size;
      exact += one;
      total += one;
    }
    for (const double of : {0.01, 1.0, 100.0}) {    // the scale is only a size
      const double found = sum(terms, ExactSum::scale_of(of * total));
      EXPECT_LT(std::fabs(double((found - exact) / exact)), 2.5e-16);
    }
  }
}

TEST(ExactSum, WhatIsNotFiniteShows)
{
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double term : {infinite, infinite - infinite})
    for (const int parts : {1, 2}) EXPECT_FALSE(std::isfinite(sum({1.0, term, 2.0}, 1.0, parts)));
}

TEST(ExactSum, TermsFarAboveTheScaleHaveTheErrorsOfDoubles)
{
  for (const double term : {1.0e7, 1.0e20, 1.0e300})
    EXPECT_NEAR(sum({term, 0.5 * term, -0.25 * term}, 1.0), 1.25 * term, 1.0e-15 * term);
}
