/* Tools for the tests: distances, slopes and derivatives. */

#pragma once

#include "gear_quat_math.h"
#include "numbers.h"
#include "oracles/euler_angles.h"

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
    if (!(d <= largest)) largest = d;    // keeps a NaN
  }
  return largest;
}

inline double largest_difference(const std::vector<double> &a, const std::vector<double> &b)
{
  return largest_difference(a.data(), b.data(), int(a.size()));
}

/// q and -q are the same orientation.
inline double quaternion_distance(const double *a, const double *b)
{
  const double minus[4] = {-b[0], -b[1], -b[2], -b[3]};
  const double same = largest_difference(a, b, 4), opposite = largest_difference(a, minus, 4);
  return same < opposite ? same : opposite;
}

/// Largest difference of the rotation matrices, for quaternions of any lengths.
inline double attitude_distance(const double *p, const double *q)
{
  using namespace LAMMPS_NS::GearQuat;
  double a[9], b[9];
  rotation_matrix(p, dot4(p, p), a);
  rotation_matrix(q, dot4(q, q), b);
  return largest_difference(a, b, 9);
}

inline double attitude_distance(const double *q, const Oracle::Matrix &m)
{
  double a[9], b[9];
  LAMMPS_NS::GearQuat::rotation_matrix(q, LAMMPS_NS::GearQuat::dot4(q, q), a);
  for (int i = 0; i < 9; ++i) b[i] = double(m.m[i / 3][i % 3]);
  return largest_difference(a, b, 9);
}

/// Deviation of a matrix from a right-handed rotation.
inline double not_orthogonal(const double *a)
{
  using namespace LAMMPS_NS::GearQuat;
  double third[3];
  cross3(a, a + 3, third);
  double worst = largest_difference(third, a + 6, 3);
  for (int i = 0; i < 9; ++i)
    worst = std::max(worst, std::fabs(dot3(a + i / 3 * 3, a + i % 3 * 3) - (i / 3 == i % 3)));
  return worst;
}

/// Exponent p of error ~ h^p between neighboring runs.
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

}    // namespace Check
