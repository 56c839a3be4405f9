/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The exact derivation of the corrector coefficients, checked against the tables of the literature
   and against the criteria that say what they are for, for more rows than the kernel uses. */

#include "oracles/gear_coefficients.h"
#include "oracles/modular.h"
#include "oracles/predict_correct.h"

#include <gtest/gtest.h>

using namespace Oracle;

using R = Rational;

TEST(Rational, IsExactAndRefusesOverflow)
{
  EXPECT_EQ(R(1, 3) + R(1, 6), R(1, 2));
  EXPECT_EQ(R(-2, 4), R(1, -2));
  EXPECT_EQ(R(3, 7) / R(9, 14), R(2, 3));
  EXPECT_NE(R(251, 720), R(251, 720) * R(101, 100));
  EXPECT_DOUBLE_EQ(R(-3, 8).value(), -0.375);
  R large(1, 3);
  EXPECT_THROW(for (int i = 0; i < 9; ++i) large = large * large, std::overflow_error);
  EXPECT_THROW(R(1, 0), std::domain_error);
}

TEST(Modular, CalculatesAsFractionsDo)
{
  using M = Modular;
  EXPECT_TRUE(M(1, 3) + M(1, 6) == M(1, 2));
  EXPECT_TRUE(M(-2, 4) == M(1, -2));
  EXPECT_TRUE(M(3, 7) * M(14, 9) - M(2, 3) == M(0));
  EXPECT_TRUE(-M(5, 8) + M(5, 8) == M(0));
  EXPECT_TRUE(M(251, 720) != M(251, 720) * M(101, 100));
  EXPECT_THROW(M(1, (1LL << 61) - 1), std::domain_error);
}

TEST(OracleCoefficients, FirstOrderTableOfTheLiterature)
{
  EXPECT_EQ(first_order(3), (Exact{{5, 12}, 1, {1, 2}}));
  EXPECT_EQ(first_order(4), (Exact{{3, 8}, 1, {3, 4}, {1, 6}}));
  EXPECT_EQ(first_order(5), (Exact{{251, 720}, 1, {11, 12}, {1, 3}, {1, 24}}));
  EXPECT_EQ(first_order(6), (Exact{{95, 288}, 1, {25, 24}, {35, 72}, {5, 48}, {1, 120}}));
  EXPECT_EQ(first_order(7),
            (Exact{{19087, 60480}, 1, {137, 120}, {5, 8}, {17, 96}, {1, 40}, {1, 720}}));
  EXPECT_EQ(
      first_order(8),
      (Exact{{5257, 17280}, 1, {49, 40}, {203, 270}, {49, 192}, {7, 144}, {7, 1440}, {1, 5040}}));
}

TEST(OracleCoefficients, SecondOrderTableOfTheLiterature)
{
  const R position[] = {{1, 6}, {19, 120}, {3, 20}, {863, 6048}, {275, 2016}};
  const R velocity[] = {{1, 4}, {19, 90}, {3, 16}, {863, 5040}, {275, 1728}};
  for (int n = 4; n <= 8; ++n) {
    EXPECT_EQ(position_c0(n), position[n - 4]) << n;
    EXPECT_EQ(velocity_c0(n), velocity[n - 4]) << n;
  }
  EXPECT_EQ(second_order(4, {1, 6}), (Exact{{1, 6}, {5, 6}, 1, {1, 3}}));
  EXPECT_EQ(
      second_order(8, {275, 2016}),
      (Exact{{275, 2016}, {19087, 30240}, 1, {137, 180}, {5, 16}, {17, 240}, {1, 120}, {1, 2520}}));
}

TEST(OracleCoefficients, ClosedFormsMeetTheCriteria)
{
  for (int n = 4; n <= 12; ++n) {
    EXPECT_TRUE(is_first_order_corrector(first_order(n))) << n;
    EXPECT_TRUE(is_position_corrector(second_order(n, position_c0(n)))) << n;
    EXPECT_TRUE(is_velocity_corrector(second_order(n, velocity_c0(n)))) << n;
  }
}

// the printed table again: neighbouring c_0 of it, and of the derivation beyond it

TEST(OracleCoefficients, ErrorWeightsAreDifferencesOfNeighbouringC0)
{
  EXPECT_EQ(first_order_error(4), R(5, 12) - R(3, 8));
  EXPECT_EQ(first_order_error(5), R(3, 8) - R(251, 720));
  EXPECT_EQ(second_order_local_error(5), R(2) * (R(3, 8) - R(251, 720)));
  for (int n = 3; n <= 12; ++n)
    EXPECT_EQ(first_order_error(n), first_order(n - 1)[0] - first_order(n)[0]) << n;
}

// the two kinds of c_0 are different, and each criterion wants its own

TEST(OracleCoefficients, CriteriaTellTheKindsApart)
{
  for (int n = 4; n <= 12; ++n) {
    EXPECT_FALSE(is_velocity_corrector(second_order(n, position_c0(n)))) << n;
    EXPECT_FALSE(is_position_corrector(second_order(n, velocity_c0(n)))) << n;
  }
  // Adams-Moulton with as many values as its order is another method, and refused
  EXPECT_FALSE(is_first_order_corrector(Exact{{3, 8}, 1, {11, 12}, {1, 3}, {1, 24}}));
}
