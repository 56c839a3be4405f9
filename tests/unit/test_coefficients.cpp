/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* gear_quat_coefficients.h: every entry as an exact fraction, derived again and judged by what the
   corrector must do.  A slope would not notice an entry that is wrong by 1 %; these do. */

#include "gear_quat_coefficients.h"
#include "oracles/gear_coefficients.h"
#include "oracles/predict_correct.h"

#include <gtest/gtest.h>

using namespace GearQuat;

namespace {

template <std::size_t N> Oracle::Exact exact(const std::array<Fraction, N> &table)
{
  Oracle::Exact c;
  for (const Fraction &f : table) c.emplace_back(f.numerator, f.denominator);
  return c;
}

template <class Check> void expect_each_entry_to_matter(const Oracle::Exact &good, Check check)
{
  ASSERT_TRUE(check(good));
  for (std::size_t j = 0; j < good.size(); ++j)
    for (int percent : {99, 101}) {
      Oracle::Exact bad = good;
      bad[j] = bad[j] * Oracle::Rational(percent, 100);
      EXPECT_FALSE(check(bad)) << "entry " << j << " at " << percent << " %";
    }
}

}    // namespace

TEST(Coefficients, EqualTheExactDerivation)
{
  EXPECT_EQ(exact(FIRST_ORDER), Oracle::first_order(5));
  EXPECT_EQ(exact(SECOND_ORDER_POSITION), Oracle::second_order(6, Oracle::position_c0(6)));
  EXPECT_EQ(exact(SECOND_ORDER_VELOCITY), Oracle::second_order(6, Oracle::velocity_c0(6)));
}

TEST(Coefficients, FirstOrderIsNilpotentAndKeepsDegreeN)
{
  expect_each_entry_to_matter(exact(FIRST_ORDER), Oracle::is_first_order_corrector);
}

TEST(Coefficients, SecondOrderPositionIsNilpotentAndKeepsDegreeNPlus1)
{
  expect_each_entry_to_matter(exact(SECOND_ORDER_POSITION), Oracle::is_position_corrector);
}

TEST(Coefficients, SecondOrderVelocityIsNilpotentAndKeepsDegreeN)
{
  expect_each_entry_to_matter(exact(SECOND_ORDER_VELOCITY), Oracle::is_velocity_corrector);
}

// from exact rows nothing at all is lost up to degree N - 1: the predictor alone sees to it

TEST(Coefficients, PolynomialsBelowDegreeNStayExact)
{
  const struct {
    Oracle::Exact c;
    int order;
  } sets[] = {{exact(FIRST_ORDER), 1},
              {exact(SECOND_ORDER_POSITION), 2},
              {exact(SECOND_ORDER_VELOCITY), 2}};
  for (const auto &set : sets) {
    const int n = int(set.c.size());
    const Oracle::Exact none(n);
    for (int degree = 0; degree < n; ++degree)
      EXPECT_EQ(Oracle::error_after(set.c, set.order, degree, 0, 5, none), none) << degree;
    EXPECT_NE(Oracle::error_after(set.c, set.order, n, 0, 5, none), none);
  }
}

TEST(Coefficients, AsDoublesTheyAreRoundedOnce)
{
  EXPECT_EQ(FIRST_ORDER[0].value(), 251.0 / 720.0);
  EXPECT_EQ(SECOND_ORDER_POSITION[0].value(), 0.15);
  EXPECT_EQ(SECOND_ORDER_VELOCITY[0].value(), 0.1875);
}
