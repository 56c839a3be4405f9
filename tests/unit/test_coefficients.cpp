/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* gear_quat_coefficients.h: every entry as an exact fraction, derived again, compared with the
   printed tables, and judged by what the corrector must do.  A slope would not notice an entry that
   is wrong by 1 %; these do. */

#include "gear_quat_coefficients.h"
#include "oracles/gear_coefficients.h"
#include "oracles/modular.h"
#include "oracles/predict_correct.h"

#include <gtest/gtest.h>

using namespace LAMMPS_NS::GearQuat;
using Oracle::Exact;
using R = Oracle::Rational;

namespace {

R exact(const Fraction &f)
{
  return {f.numerator, f.denominator};
}

Exact exact(const Fractions &table)
{
  Exact c;
  for (const Fraction &f : table) c.push_back(exact(f));
  return c;
}

Exact first(int values)
{
  return exact(first_order_coefficients(values));
}
Exact second(int values, bool velocity_c0)
{
  return exact(second_order_coefficients(values, velocity_c0));
}

template <class Check> void expect_each_entry_to_matter(const Exact &good, Check check)
{
  ASSERT_TRUE(check(good)) << good.size();
  for (std::size_t j = 0; j < good.size(); ++j)
    for (int percent : {99, 101}) {
      Exact bad = good;
      bad[j] = bad[j] * R(percent, 100);
      EXPECT_FALSE(check(bad)) << good.size() << ", entry " << j << " at " << percent << " %";
    }
}

/// The same for a criterion of predict_correct.h: it holds exactly, and is refuted modulo a prime.
template <class Check> void expect_criterion(const Exact &good, Check check)
{
  ASSERT_TRUE(check(good)) << good.size();
  const Oracle::Row<Oracle::Modular> same(good.begin(), good.end());
  ASSERT_TRUE(check(same)) << good.size();
  for (std::size_t j = 0; j < good.size(); ++j)
    for (int percent : {99, 101}) {
      Oracle::Row<Oracle::Modular> bad = same;
      bad[j] = bad[j] * Oracle::Modular(percent, 100);
      EXPECT_FALSE(check(bad)) << good.size() << ", entry " << j << " at " << percent << " %";
    }
}

}    // namespace

TEST(Coefficients, EqualTheExactDerivation)
{
  for (int n = FIRST_FEWEST; n <= FIRST_MOST; ++n)
    expect_each_entry_to_matter(first(n), [&](const Exact &c) {
      return c == Oracle::first_order(n);
    });
  for (int n = SECOND_FEWEST; n <= SECOND_MOST; ++n) {
    expect_each_entry_to_matter(second(n, false), [&](const Exact &c) {
      return c == Oracle::second_order(n, Oracle::position_c0(n));
    });
    expect_each_entry_to_matter(second(n, true), [&](const Exact &c) {
      return c == Oracle::second_order(n, Oracle::velocity_c0(n));
    });
  }
}

TEST(Coefficients, EqualTheTablesOfTheLiteratureForFirstOrder)
{
  const Exact table[] = {
      {{5, 12}, 1, {1, 2}},
      {{3, 8}, 1, {3, 4}, {1, 6}},
      {{251, 720}, 1, {11, 12}, {1, 3}, {1, 24}},
      {{95, 288}, 1, {25, 24}, {35, 72}, {5, 48}, {1, 120}},
      {{19087, 60480}, 1, {137, 120}, {5, 8}, {17, 96}, {1, 40}, {1, 720}},
      {{5257, 17280}, 1, {49, 40}, {203, 270}, {49, 192}, {7, 144}, {7, 1440}, {1, 5040}}};
  for (int n = 3; n <= 8; ++n) EXPECT_EQ(first(n), table[n - 3]) << n;
}

TEST(Coefficients, EqualTheTablesOfTheLiteratureForSecondOrder)
{
  const Exact table[] = {
      {{1, 6}, {5, 6}, 1, {1, 3}},
      {{19, 120}, {3, 4}, 1, {1, 2}, {1, 12}},
      {{3, 20}, {251, 360}, 1, {11, 18}, {1, 6}, {1, 60}},
      {{863, 6048}, {95, 144}, 1, {25, 36}, {35, 144}, {1, 24}, {1, 360}},
      {{275, 2016}, {19087, 30240}, 1, {137, 180}, {5, 16}, {17, 240}, {1, 120}, {1, 2520}}};
  const R velocity_c0[] = {{1, 4}, {19, 90}, {3, 16}, {863, 5040}, {275, 1728}};
  for (int n = 4; n <= 8; ++n) {
    Exact expected = table[n - 4];
    EXPECT_EQ(second(n, false), expected) << n;
    expected[0] = velocity_c0[n - 4];
    EXPECT_EQ(second(n, true), expected) << n;
  }
}

TEST(Coefficients, FirstOrderIsNilpotentAndKeepsDegreeN)
{
  for (int n = FIRST_FEWEST; n <= FIRST_MOST; ++n)
    expect_criterion(first(n), [](const auto &c) {
      return Oracle::is_first_order_corrector(c);
    });
}

TEST(Coefficients, SecondOrderPositionIsNilpotentAndKeepsDegreeNPlus1)
{
  for (int n = SECOND_FEWEST; n <= SECOND_MOST; ++n)
    expect_criterion(second(n, false), [](const auto &c) {
      return Oracle::is_position_corrector(c);
    });
}

TEST(Coefficients, SecondOrderVelocityIsNilpotentAndKeepsDegreeN)
{
  for (int n = SECOND_FEWEST; n <= SECOND_MOST; ++n)
    expect_criterion(second(n, true), [](const auto &c) {
      return Oracle::is_velocity_corrector(c);
    });
}

// from exact rows nothing at all is lost up to degree N - 1: the predictor alone sees to it

TEST(Coefficients, PolynomialsBelowDegreeNStayExact)
{
  auto judge = [](const Exact &c, int order) {
    const int n = int(c.size());
    const Exact none(n);
    for (int degree = 0; degree < n; ++degree)
      EXPECT_EQ(Oracle::error_after(c, order, degree, 0, 5, none), none) << n << ' ' << degree;
    EXPECT_NE(Oracle::error_after(c, order, n, 0, 5, none), none) << n;
  };
  for (int n = FIRST_FEWEST; n <= FIRST_MOST; ++n) judge(first(n), 1);
  for (int n = SECOND_FEWEST; n <= SECOND_MOST; ++n)
    for (bool velocity_c0 : {false, true}) judge(second(n, velocity_c0), 2);
}

TEST(Coefficients, ErrorWeightsAreThoseOfTheOracle)
{
  for (int n = FIRST_FEWEST; n <= FIRST_MOST; ++n)
    expect_each_entry_to_matter({exact(first_order_error_weight(n))}, [&](const Exact &w) {
      return w[0] == Oracle::first_order_error(n);
    });
  for (int n = SECOND_FEWEST; n <= SECOND_MOST; ++n)
    expect_each_entry_to_matter({exact(second_order_error_weight(n))}, [&](const Exact &w) {
      return w[0] == Oracle::second_order_local_error(n);
    });
}

TEST(Coefficients, WeightsOfAdamsAndMoulton)
{
  const R known[] = {{1, 2}, {1, 12}, {1, 24}, {19, 720}, {3, 160}, {863, 60480}, {275, 24192}};
  for (int k = 1; k <= 7; ++k) EXPECT_EQ(exact(adams_moulton(k)), known[k - 1]) << k;
}

TEST(Coefficients, AsDoublesTheyAreRoundedOnce)
{
  EXPECT_EQ(first_order_coefficients(5)[0].value(), 251.0 / 720.0);
  EXPECT_EQ(second_order_coefficients(6, false)[0].value(), 0.15);
  EXPECT_EQ(second_order_coefficients(6, true)[0].value(), 0.1875);
}
