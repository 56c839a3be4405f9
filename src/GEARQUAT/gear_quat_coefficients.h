/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Corrector coefficients of Gear's predictor-corrector in Nordsieck form, for any number of values.

   Row j of a history is y_j = h^j/j! d^j y/dt^j.  After prediction the residual r of the
   differential equation is fed back into every row, y_j += c_j r, with
     first-order equation   r = h y' - y_1           c_1 = 1
     second-order equation  r = h^2/2 y'' - y_2      c_2 = 1
   All coefficients follow from the polynomial P_n(s) = (1 + s)(1 + s/2)...(1 + s/n) and the weights
   gamma_k of Adams and Moulton, 1/2 1/12 1/24 19/720 3/160 ...  (their magnitudes).
   Source: C. W. Gear, "Numerical Initial Value Problems in Ordinary Differential Equations" (1971);
   for 5 and 6 values Pratt & Bin Mohamad Zaini, Tables 1 and 2 (beta_2 = 1: the printed 4 is a
   misprint). */

#ifndef GEAR_QUAT_COEFFICIENTS_H
#define GEAR_QUAT_COEFFICIENTS_H

#include <vector>

namespace LAMMPS_NS::GearQuat {

/// An exact coefficient, in lowest terms; the tests check the fractions themselves.
struct Fraction {
  long long numerator, denominator;

  Fraction(long long n = 0, long long d = 1)
  {
    const long long g = common_divisor(n < 0 ? -n : n, d);
    numerator = n / g;
    denominator = d / g;
  }
  double value() const { return double(numerator) / double(denominator); }

  Fraction operator+(const Fraction &o) const
  {
    const long long g = common_divisor(denominator, o.denominator);
    return {numerator * (o.denominator / g) + o.numerator * (denominator / g),
            denominator / g * o.denominator};
  }
  Fraction operator-(const Fraction &o) const
  {
    return *this + Fraction(-o.numerator, o.denominator);
  }
  Fraction operator*(const Fraction &o) const
  {
    const Fraction a(numerator, o.denominator), b(o.numerator, denominator);
    return {a.numerator * b.numerator, a.denominator * b.denominator};
  }

 private:
  static long long common_divisor(long long a, long long b)
  {
    return b ? common_divisor(b, a % b) : a;
  }
};

using Fractions = std::vector<Fraction>;

// values kept: rows of a history

constexpr int FIRST_FEWEST = 3, FIRST_MOST = 8, FIRST_PAPER = 5;
constexpr int SECOND_FEWEST = 4, SECOND_MOST = 12, SECOND_PAPER = 6;
constexpr int MAX_VALUES = SECOND_MOST;

/// Loads remembered with keyword tolerance, and rows of the longest history.
constexpr int MOST_LOADS = 13, MOST_ROWS = MOST_LOADS + 2;

/// gamma_k, the magnitude of the weight of the k-th backward difference in the formulas of Adams
/// and Moulton, k >= 1: sum over i = 0..k of signed weights / (k + 1 - i) vanishes.
inline Fraction adams_moulton(int k)
{
  Fractions signed_weight = {1};
  for (int m = 1; m <= k; ++m) {
    Fraction sum;
    for (int i = 0; i < m; ++i) sum = sum - signed_weight[i] * Fraction(1, m + 1 - i);
    signed_weight.push_back(sum);
  }
  return Fraction(0) - signed_weight[k];
}

/// First-order equation, N values; of order N, and of order N + 1 for even N if the motion is slow.
inline Fractions first_order_coefficients(int values)
{
  Fractions p = {1};    // P_(N-2)
  for (int i = 1; i <= values - 2; ++i) {
    p.emplace_back(0);
    for (int j = i; j > 0; --j) p[j] = p[j] + p[j - 1] * Fraction(1, i);
  }
  Fractions c = {1};
  for (int k = 1; k < values; ++k) c[0] = c[0] - adams_moulton(k);
  for (int j = 0; j < values - 1; ++j) c.push_back(p[j] * Fraction(1, j + 1));
  return c;
}

/// Second-order equation, N values. velocity_c0: for right-hand sides that depend on velocities, of
/// order N - 1; otherwise for right-hand sides of positions alone, of order N, and of order N + 1
/// for even N if the motion is slow.
inline Fractions second_order_coefficients(int values, bool velocity_c0)
{
  const Fractions a = first_order_coefficients(values - 1);
  Fractions c = {adams_moulton(values - 1) * Fraction(2 * (velocity_c0 ? values - 1 : values - 2))};
  for (int j = 0; j < values - 1; ++j) c.push_back(a[j] * Fraction(2, j + 1));
  return c;
}

/// The weight of a residual in the local error of row 0.  First-order equation: the difference from
/// the corrector of the next lower order, c_0(N - 1) - c_0(N); the error itself is one order
/// higher.
inline Fraction first_order_error_weight(int values)
{
  return adams_moulton(values - 1);
}

/// Second-order equation: the constant of the leading term itself.
inline Fraction second_order_error_weight(int values)
{
  return adams_moulton(values - 1) * Fraction(2);
}

}    // namespace LAMMPS_NS::GearQuat

#endif
