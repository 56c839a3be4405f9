/* gear_quat_history.h: every entry as an exact fraction, derived again, and compared with the printed tables. */

#include "gear_quat_history.h"
#include "oracles/gear_coefficients.h"

#include <gtest/gtest.h>

using namespace LAMMPS_NS::GearQuat;
using namespace Oracle;
using R = Rational;
using std::vector;

namespace {

Exact exact(const vector<long double> &table)
{
  Exact c;
  for (const long double x : table) c.push_back(rational_of(x));
  return c;
}

/// The coefficients of the kernel, and the derivation of the oracle.
struct FirstOrder {
  static constexpr int FEWEST = FIRST_FEWEST, MOST = FIRST_MOST;
  static Exact kernel(int n) { return exact(first_order_coefficients(n)); }
  static Exact derived(int n) { return first_order(n); }
};
struct SecondOrderPosition {
  static constexpr int FEWEST = SECOND_FEWEST, MOST = SECOND_MOST;
  static Exact kernel(int n) { return exact(second_order_coefficients(n, false)); }
  static Exact derived(int n) { return second_order(n, position_c0(n)); }
};
struct SecondOrderVelocity : SecondOrderPosition {
  static Exact kernel(int n) { return exact(second_order_coefficients(n, true)); }
  static Exact derived(int n) { return second_order(n, velocity_c0(n)); }
};

template <class Kind> class Coefficients : public testing::Test {
};
using Kinds = testing::Types<FirstOrder, SecondOrderPosition, SecondOrderVelocity>;
TYPED_TEST_SUITE(Coefficients, Kinds);

}    // namespace

TYPED_TEST(Coefficients, EqualTheExactDerivation)
{
  for (int n = TypeParam::FEWEST; n <= TypeParam::MOST; ++n)
    EXPECT_EQ(TypeParam::kernel(n), TypeParam::derived(n)) << n;
}

TEST(Tables, OfTheLiteratureForFirstOrder)
{
  const Exact table[] = {
      {{5, 12}, 1, {1, 2}},
      {{3, 8}, 1, {3, 4}, {1, 6}},
      {{251, 720}, 1, {11, 12}, {1, 3}, {1, 24}},
      {{95, 288}, 1, {25, 24}, {35, 72}, {5, 48}, {1, 120}},
      {{19087, 60480}, 1, {137, 120}, {5, 8}, {17, 96}, {1, 40}, {1, 720}},
      {{5257, 17280}, 1, {49, 40}, {203, 270}, {49, 192}, {7, 144}, {7, 1440}, {1, 5040}}};
  for (int n = 3; n <= 8; ++n) EXPECT_EQ(FirstOrder::kernel(n), table[n - 3]) << n;
}

TEST(Tables, OfTheLiteratureForSecondOrder)
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
    EXPECT_EQ(SecondOrderPosition::kernel(n), expected) << n;
    expected[0] = velocity_c0[n - 4];
    EXPECT_EQ(SecondOrderVelocity::kernel(n), expected) << n;
  }
}

TEST(ErrorWeights, AreThoseOfTheDerivationAndDifferencesOfNeighboringC0)
{
  const auto weight2 = [](Formulation formulation, int n) {
    Scheme scheme;
    scheme.formulation = formulation;
    scheme.rows = n;
    return CorrectorCoefficients(scheme).weight2;
  };
  for (int n = FIRST_FEWEST; n <= FIRST_MOST; ++n)
    EXPECT_EQ(weight2(Formulation::FIRST, n), std::pow(first_order_error(n).value(), 2)) << n;
  for (int n = SECOND_FEWEST; n <= SECOND_MOST; ++n)
    EXPECT_EQ(weight2(Formulation::SECOND, n), std::pow(second_order_local_error(n).value(), 2))
        << n;
  for (int n = 3; n <= 12; ++n)
    EXPECT_EQ(first_order_error(n), first_order(n - 1)[0] - first_order(n)[0]) << n;
  EXPECT_EQ(first_order_error(4), R(5, 12) - R(3, 8));    // from the printed table
  EXPECT_EQ(first_order_error(5), R(3, 8) - R(251, 720));
  EXPECT_EQ(second_order_local_error(5), R(2) * (R(3, 8) - R(251, 720)));
}
