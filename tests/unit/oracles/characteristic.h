/* The characteristic equation of a corrector for y' = s y or y'' = s^2 y with the step 1, as a
   power series in s whose principal root is e^s; exact if R is exact, or in floating point.

   With rows Y lambda^n and forces at the predicted y, (lambda - P) Y = c r, where r is the residual
   and P Pascal's triangle.  Eliminating r gives, with R = (lambda - P)^-1 and the unit rows e_j,

     y'  = s y      s c_0 + lambda (e_1 - s e_0) R c = 0
     y'' = s^2 y    s^2/2 c_0 + lambda (e_2 - s^2/2 e_0) R c = 0

   and R = sum_k (P - 1)^k / (lambda - 1)^(k+1), which becomes a power series with a factor (lambda
   - 1)^N. For a method of order p, s^(p+1) and higher powers remain (y'), or s^(p+2) and higher
   ones (y''). */

#pragma once

#include <cstddef>
#include <vector>

namespace Oracle {

/// Power series in s, ascending, truncated after `terms`.
template <class R> std::vector<R> product(const std::vector<R> &a, const std::vector<R> &b)
{
  std::vector<R> c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; i + j < a.size(); ++j) c[i + j] = c[i + j] + a[i] * b[j];
  return c;
}

/// e^s to `terms` terms, from the given constant term on.
template <class R> std::vector<R> exponential(R constant, int terms)
{
  std::vector<R> e = {constant};
  R term = R(1);
  for (int i = 1; i < terms; ++i) e.push_back(term = term / R(i));
  return e;
}

/// (P - 1) c.
template <class R> std::vector<R> advanced(const std::vector<R> &c)
{
  std::vector<R> next(c.size());
  for (std::size_t j = 0; j < c.size(); ++j)
    for (std::size_t l = j + 1; l < c.size(); ++l) {
      R b = R(1);
      for (std::size_t i = 0; i < j; ++i) b = b * R(int(l - i)) / R(int(i + 1));
      next[j] = next[j] + b * c[l];
    }
  return next;
}

/// The coefficients of s^0 ... s^(terms-1) in the characteristic equation of c, times (e^s - 1)^N.
template <class R> std::vector<R> characteristic(const std::vector<R> &c, int order, int terms)
{
  const int n = int(c.size());
  const std::vector<R> lambda = exponential(R(1), terms), u = exponential(R(0), terms);
  std::vector<std::vector<R>> powers = {std::vector<R>(terms)};    // of u
  powers[0][0] = R(1);
  for (int k = 1; k <= n; ++k) powers.push_back(product(powers.back(), u));

  std::vector<R> found(terms), held(terms), row = c;    // row: (P - 1)^k c
  for (int k = 0; k < n; ++k, row = advanced(row))
    for (int i = 0; i < terms; ++i) {
      found[i] = found[i] + row[order] * powers[n - k - 1][i];
      held[i] = held[i] + row[0] * powers[n - k - 1][i];
    }
  found = product(lambda, found);
  held = product(lambda, held);
  for (int i = order; i < terms; ++i)
    found[i] = found[i] + (c[0] * powers[n][i - order] - held[i - order]) / R(order);
  return found;
}

/// N coefficients with the rows from `order` on given, and the lower ones determined by the order:
/// powers up to s^N (y') or s^(N+1) (y'') vanish.
template <class R> std::vector<R> with_head(std::vector<R> c, int order)
{
  const int n = int(c.size());
  for (int j = order - 1; j >= 0; --j) {    // s^N is linear in the higher one, s^(N+1) in c_0
    const int power = j == order - 1 ? n : n + 1;
    c[j] = R(0);
    const R without = characteristic(c, order, power + 1)[power];
    c[j] = R(1);
    c[j] = -without / (characteristic(c, order, power + 1)[power] - without);
  }
  return c;
}

}    // namespace Oracle
