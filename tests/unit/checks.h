/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Small tools of the tests: distances, slopes, derivatives, and the 1 % error every check must
   see. */

#ifndef GEAR_QUAT_TEST_CHECKS_H
#define GEAR_QUAT_TEST_CHECKS_H

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace Check {

inline double largest_difference(const double *a, const double *b, int n)
{
  double largest = 0.0;
  for (int i = 0; i < n; ++i) {
    const double d = std::fabs(a[i] - b[i]);
    if (!(d <= largest)) largest = d;    // a NaN is passed on, not passed over
  }
  return largest;
}

/// q and -q are the same orientation.
inline double quaternion_distance(const double *a, const double *b)
{
  const double minus[4] = {-b[0], -b[1], -b[2], -b[3]};
  const double same = largest_difference(a, b, 4), opposite = largest_difference(a, minus, 4);
  return same < opposite ? same : opposite;
}

/// Exponent p of error ~ h^p between neighbouring runs.
inline std::vector<double> slopes(const std::vector<double> &h, const std::vector<double> &error)
{
  std::vector<double> p;
  for (std::size_t i = 1; i < h.size(); ++i)
    p.push_back(std::log(error[i - 1] / error[i]) / std::log(h[i - 1] / h[i]));
  return p;
}

inline double smallest(const std::vector<double> &v)
{
  return *std::min_element(v.begin(), v.end());
}

/// Derivative at 0 of f(t, out), n components, by differences of fourth order.
template <class F> void derivative(F f, int n, double h, double *out)
{
  std::vector<double> m2(n), m1(n), p1(n), p2(n);
  f(-2.0 * h, m2.data());
  f(-h, m1.data());
  f(h, p1.data());
  f(2.0 * h, p2.data());
  for (int i = 0; i < n; ++i) out[i] = (8.0 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12.0 * h);
}

/// The check holds for the values, and for none of the sets with one value 1 % off (a zero: off
/// by 1 % of the largest).
template <class F> void holds_and_refuses_one_percent(std::vector<double> values, F check)
{
  ASSERT_TRUE(check(values));
  double largest = 0.0;
  for (double v : values) largest = std::max(largest, std::fabs(v));
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::vector<double> bad = values;
    bad[i] += 0.01 * (bad[i] == 0.0 ? largest : bad[i]);
    EXPECT_FALSE(check(bad)) << "value " << i << " 1 % off";
  }
}

/// Reproducible numbers in (-1, 1), the same with every standard library.
class Numbers {
 public:
  explicit Numbers(unsigned long long seed) : state(seed) {}
  double next()
  {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return double(state >> 11) / 4503599627370496.0 - 1.0;
  }
  std::vector<double> list(int n)
  {
    std::vector<double> v(n);
    for (double &x : v) x = next();
    return v;
  }
  std::vector<double> unit_quaternion()
  {
    std::vector<double> q = list(4);
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double &x : q) x /= norm;
    return q;
  }

 private:
  unsigned long long state;
};

}    // namespace Check

#endif
