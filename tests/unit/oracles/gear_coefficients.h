/* Gear's corrector coefficients, derived from their conditions, in exact fractions.

   The higher rows follow from the roots of the corrector's polynomial: -1, -2, ..., -(N-2) for the
   first-order equation.  Row 0 (and, for the second-order equation, row 1) follows from weights of
   integration: Adams-Bashforth's, Stoermer's (positions alone, two steps) and Nystroem's (position
   from the present velocity, one step). */

#pragma once

#include "rational.h"

#include <vector>

namespace Oracle {

using Exact = std::vector<Rational>;    ///< coefficients of a polynomial, or of a corrector

inline Exact multiply(const Exact &a, const Exact &b)
{
  Exact product(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) product[i + j] = product[i + j] + a[i] * b[j];
  return product;
}

/// Product over i = 1..n of (1 + x/i).
inline Exact rising(int n)
{
  Exact p = {1};
  for (int i = 1; i <= n; ++i) p = multiply(p, {1, Rational(1, i)});
  return p;
}

/// Integral of p from `from` to 0.
inline Rational integral_to_zero(const Exact &p, const Rational &from)
{
  Rational sum, power = from;
  for (std::size_t j = 0; j < p.size(); ++j, power = power * from)
    sum = sum - p[j] * power / Rational(int(j) + 1);
  return sum;
}

/// First-order equation, N values; c_0 is Adams-Bashforth's weight of order N - 1.
inline Exact first_order(int values)
{
  const Exact rate = rising(values - 2);
  Exact c = {integral_to_zero(rising(values - 1), -1)};
  for (int j = 0; j < values - 1; ++j) c.push_back(rate[j] / Rational(j + 1));
  return c;
}

/// Second-order equation, N values, with the given c_0.
inline Exact second_order(int values, const Rational &c0)
{
  const Exact a = first_order(values - 1);
  Exact c = {c0};
  for (int j = 0; j < values - 1; ++j) c.push_back(Rational(2) * a[j] / Rational(j + 1));
  return c;
}

/// binomial(s + k - 1, k) as a polynomial in s: Newton's backward difference of order k at s.
inline Exact backward_difference(int k)
{
  Exact p = {1};
  for (int i = 0; i < k; ++i) p = multiply(p, {Rational(i, i + 1), Rational(1, i + 1)});
  return p;
}

/// Integral over 0..1 of (1 - s) p(sign s).
inline Rational weighted(Exact p, int sign)
{
  for (std::size_t j = 1; j < p.size(); j += 2) p[j] = Rational(sign) * p[j];
  return -integral_to_zero(multiply({1, -1}, p), 1);
}

/// c_0 for right-hand sides of positions alone: twice Stoermer's weight in x(h) - 2 x(0) + x(-h) =
/// h^2 sum_k sigma_k (backward difference of order k).
inline Rational position_c0(int values)
{
  const Exact p = backward_difference(values - 1);
  return Rational(2) * (weighted(p, 1) + weighted(p, -1));
}

/// c_0 for right-hand sides of velocities: twice Nystroem's weight, of one order less, in x(h) =
/// x(0) + h v(0) + h^2 sum_k nu_k (backward difference of order k).
inline Rational velocity_c0(int values)
{
  return Rational(2) * weighted(backward_difference(values - 2), 1);
}

/// Weight of a residual in the error of row 0, first-order equation: the difference between c_0 and
/// the one for one value less, as one integral, Adams-Bashforth's weight of order N - 2 minus order
/// N - 1.
inline Rational first_order_error(int values)
{
  return integral_to_zero(multiply(rising(values - 2), {0, Rational(-1, values - 1)}), -1);
}

// The change of row 0 in a step with N values minus the exact change from the same initial values,
// if the highest derivatives are constant.

/// First-order equation: this times h^(N + 1) y^(N + 1), Moulton's weight of order N.
inline Rational first_order_local_error(int values)
{
  return first_order(values)[0] - first_order(values + 1)[0];
}

/// Second-order equation: this times h^N y^(N)/2, through the velocity row; twice Moulton's weight
/// of order N - 1.  The residual is h^N y^(N)/2 itself, so this is also its weight.
inline Rational second_order_local_error(int values)
{
  return Rational(2) * first_order_local_error(values - 1);
}

}    // namespace Oracle
