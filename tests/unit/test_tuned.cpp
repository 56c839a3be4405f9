/* gear_quat_tuned.h: the order conditions reproduce Gear's numbers from Gear's tails. */

#include "checks.h"
#include "gear_quat_tuned.h"

#include <gtest/gtest.h>

using namespace LAMMPS_NS::GearQuat;

namespace {

constexpr Formulation FIRST = Formulation::FIRST, SECOND = Formulation::SECOND;

std::vector<double> values_of(const Fractions &exact)
{
  std::vector<double> c;
  for (const Fraction &f : exact) c.push_back(f.value());
  return c;
}

std::vector<double> values_of(const std::vector<long double> &c)
{
  return std::vector<double>(c.begin(), c.end());
}

/// Gear's coefficients without those that order determines.
TunedSet without_head(Formulation formulation, const Fractions &c)
{
  TunedSet set = {formulation, {}, {}};
  for (std::size_t j = formulation == FIRST ? 2 : 3; j < c.size(); ++j)
    set.tail.push_back((long double) c[j].numerator / c[j].denominator);
  return set;
}

/// The conditions make of Gear's tail what Gear has, and of one that is 1 % off something else.
void make_gears_of(Formulation formulation, const Fractions &gear)
{
  const std::vector<double> right = values_of(gear);
  Check::holds_and_refuses_one_percent(values_of(without_head(formulation, gear).coefficients()),
                                       [&](const std::vector<double> &c) {
                                         for (std::size_t j = 0; j < c.size(); ++j)
                                           if (!(std::fabs(c[j] - right[j]) <= 2e-16)) return false;
                                         return c.size() == right.size();
                                       });
}

}    // namespace

TEST(OrderConditions, MakeGearsCoefficientsOfGearsTails)
{
  for (int n = FIRST_FEWEST; n <= FIRST_MOST; ++n)
    make_gears_of(FIRST, first_order_coefficients(n));
  for (int n = SECOND_FEWEST; n <= SECOND_MOST; ++n)
    make_gears_of(SECOND, second_order_coefficients(n, false));
}
