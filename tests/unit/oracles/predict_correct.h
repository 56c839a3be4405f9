/* The predictor-corrector in exact fractions, for any set of coefficients, and a test of the
   properties of the method.  The correct coefficients are not used here.

   With exact right-hand sides for y = t^d (step 1), the errors of the rows obey
     e(n+1) = (I - c e_k^T) (P e(n) - b(n)),
   with the order k of the equation, Pascal's triangle P, and the part b of y beyond N rows.

   R: Rational proves equality; Modular proves inequality, where fractions become too long. */

#pragma once

#include "rational.h"

#include <vector>

namespace Oracle {

template <class R> using Row = std::vector<R>;

template <class R> R binomial(int n, int k)
{
  if (k > n) return 0;
  R b = 1;
  for (int i = 0; i < k; ++i) b = b * R(n - i, i + 1);
  return b;
}

template <class R> Row<R> pascal_predict(const Row<R> &rows)
{
  Row<R> next(rows.size());
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (std::size_t l = j; l < rows.size(); ++l)
      next[j] = next[j] + binomial<R>(int(l), int(j)) * rows[l];
  return next;
}

/// Row j of t^degree, exact.
template <class R> R power_row(int degree, int j, int t)
{
  R row = binomial<R>(degree, j);
  for (int i = 0; i < degree - j; ++i) row = row * R(t);
  return row;
}

/// The errors of the rows after one step from time t, with an exact right-hand side and y =
/// t^degree.
template <class R>
Row<R> error_step(const Row<R> &c, int order, int degree, int t, const Row<R> &error)
{
  Row<R> rows(error);
  for (std::size_t j = 0; j < rows.size(); ++j) rows[j] = rows[j] + power_row<R>(degree, int(j), t);
  rows = pascal_predict(rows);
  const R residual = power_row<R>(degree, order, t + 1) - rows[order];
  for (std::size_t j = 0; j < rows.size(); ++j)
    rows[j] = rows[j] + c[j] * residual - power_row<R>(degree, int(j), t + 1);
  return rows;
}

template <class R>
Row<R> error_after(const Row<R> &c, int order, int degree, int from, int steps, Row<R> error)
{
  for (int n = 0; n < steps; ++n) error = error_step(c, order, degree, from + n, error);
  return error;
}

/// True if an error of the rows from `order` on vanishes in as many steps as there are such rows.
/// A characteristic polynomial has as many coefficients as there are such c_j, so only one set
/// fits.
template <class R> bool higher_rows_are_nilpotent(const Row<R> &c, int order)
{
  const int n = int(c.size());
  for (int start = order; start < n; ++start) {
    Row<R> e(n);
    e[start] = 1;
    for (int step = 0; step < n - order; ++step) {
      e = pascal_predict(e);
      const R residual = -e[order];
      for (int j = 0; j < n; ++j) e[j] = e[j] + c[j] * residual;
      for (int j = 0; j < order; ++j) e[j] = 0;    // only the higher rows
    }
    for (const R &left : e)
      if (left != R(0)) return false;
  }
  return true;
}

/// First-order equation: after the higher rows have settled, y = t^N accumulates no error.
template <class R> bool first_order_keeps_degree_n(const Row<R> &c)
{
  const int n = int(c.size());
  const Row<R> settled = error_after(c, 1, n, 0, n, Row<R>(n));
  return error_step(c, 1, n, n, settled) == settled;
}

/// Second-order equation: after the higher rows have settled, the velocity row of y = t^N
/// accumulates no error.
template <class R> bool velocity_row_keeps_degree_n(const Row<R> &c)
{
  const int n = int(c.size());
  const Row<R> settled = error_after(c, 2, n, 0, n, Row<R>(n));
  return error_step(c, 2, n, n, settled)[1] == settled[1];
}

/// c_0 for positions: for y = t^(N+1) the error of the position row grows no faster than the error
/// of one step (its second difference vanishes), while the velocity row is free.
template <class R> bool position_row_keeps_degree_n_plus_1(const Row<R> &c)
{
  const int n = int(c.size());
  const Row<R> a = error_after(c, 2, n + 1, 0, n, Row<R>(n));
  const Row<R> b = error_step(c, 2, n + 1, n, a), d = error_step(c, 2, n + 1, n + 1, b);
  return d[0] - b[0] == b[0] - a[0];
}

/// c_0 for velocities: if the velocity row is exact, y = t^N accumulates no error of position.
template <class R> bool exact_velocity_keeps_degree_n(const Row<R> &c)
{
  const int n = int(c.size());
  Row<R> settled = error_after(c, 2, n, 0, n, Row<R>(n));
  settled[0] = settled[1] = 0;
  return error_step(c, 2, n, n, settled) == settled;
}

template <class R> bool is_first_order_corrector(const Row<R> &c)
{
  return higher_rows_are_nilpotent(c, 1) && first_order_keeps_degree_n(c);
}

template <class R> bool is_position_corrector(const Row<R> &c)
{
  return higher_rows_are_nilpotent(c, 2) && velocity_row_keeps_degree_n(c) &&
      position_row_keeps_degree_n_plus_1(c);
}

template <class R> bool is_velocity_corrector(const Row<R> &c)
{
  return higher_rows_are_nilpotent(c, 2) && velocity_row_keeps_degree_n(c) &&
      exact_velocity_keeps_degree_n(c);
}

}    // namespace Oracle
