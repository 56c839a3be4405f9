/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Predict-correct in exact fractions: what a set of corrector coefficients does, and the judgement
   whether it does what the method promises.  Nothing here knows the right coefficients.

   Fed with exact right sides on y = t^d (step 1), the errors of the rows obey
     e(n+1) = (I - c e_k^T) (P e(n) - b(n)),
   k the order of the equation, P Pascal's triangle, b the part of y that N rows cannot hold. */

#ifndef GEAR_QUAT_ORACLE_PREDICT_CORRECT_H
#define GEAR_QUAT_ORACLE_PREDICT_CORRECT_H

#include "rational.h"

#include <vector>

namespace Oracle {

using Exact = std::vector<Rational>;

inline Rational binomial(int n, int k)
{
  if (k > n) return 0;
  Rational b = 1;
  for (int i = 0; i < k; ++i) b = b * Rational(n - i, i + 1);
  return b;
}

inline Exact pascal_predict(const Exact &rows)
{
  Exact next(rows.size());
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (std::size_t l = j; l < rows.size(); ++l)
      next[j] = next[j] + binomial(int(l), int(j)) * rows[l];
  return next;
}

/// Row j of t^degree, exact.
inline Rational power_row(int degree, int j, int t)
{
  Rational row = binomial(degree, j);
  for (int i = 0; i < degree - j; ++i) row = row * Rational(t);
  return row;
}

/// The errors of the rows after one step from time t, exact right side, y = t^degree.
inline Exact error_step(const Exact &c, int order, int degree, int t, const Exact &error)
{
  Exact rows(error);
  for (std::size_t j = 0; j < rows.size(); ++j) rows[j] = rows[j] + power_row(degree, int(j), t);
  rows = pascal_predict(rows);
  const Rational residual = power_row(degree, order, t + 1) - rows[order];
  for (std::size_t j = 0; j < rows.size(); ++j)
    rows[j] = rows[j] + c[j] * residual - power_row(degree, int(j), t + 1);
  return rows;
}

inline Exact error_after(const Exact &c, int order, int degree, int from, int steps, Exact error)
{
  for (int n = 0; n < steps; ++n) error = error_step(c, order, degree, from + n, error);
  return error;
}

/// Does an error of the rows from `order` upwards vanish in as many steps as there are such rows?
/// A characteristic polynomial has as many coefficients as there are such c_j: one set alone fits.
inline bool higher_rows_are_nilpotent(const Exact &c, int order)
{
  const int n = int(c.size());
  for (int start = order; start < n; ++start) {
    Exact e(n);
    e[start] = 1;
    for (int step = 0; step < n - order; ++step) {
      e = pascal_predict(e);
      const Rational residual = -e[order];
      for (int j = 0; j < n; ++j) e[j] = e[j] + c[j] * residual;
      for (int j = 0; j < order; ++j) e[j] = 0;    // watch the higher rows alone
    }
    for (const Rational &left : e)
      if (left != Rational(0)) return false;
  }
  return true;
}

/// First-order equation: after the higher rows have settled, y = t^N gathers no error.
inline bool first_order_keeps_degree_n(const Exact &c)
{
  const int n = int(c.size());
  const Exact settled = error_after(c, 1, n, 0, n, Exact(n));
  return error_step(c, 1, n, n, settled) == settled;
}

/// Second-order equation: after the higher rows have settled, the velocity row of y = t^N gathers
/// no error.
inline bool velocity_row_keeps_degree_n(const Exact &c)
{
  const int n = int(c.size());
  const Exact settled = error_after(c, 2, n, 0, n, Exact(n));
  return error_step(c, 2, n, n, settled)[1] == settled[1];
}

/// c_0 of the position kind: on y = t^(N+1) the error of the position row grows no faster than the
/// error of one step does (its second difference vanishes), with the velocity row left to itself.
inline bool position_row_keeps_degree_n_plus_1(const Exact &c)
{
  const int n = int(c.size());
  const Exact a = error_after(c, 2, n + 1, 0, n, Exact(n));
  const Exact b = error_step(c, 2, n + 1, n, a), d = error_step(c, 2, n + 1, n + 1, b);
  return d[0] - b[0] == b[0] - a[0];
}

/// c_0 of the velocity kind: with the velocity row exact, y = t^N gathers no error of position.
inline bool exact_velocity_keeps_degree_n(const Exact &c)
{
  const int n = int(c.size());
  Exact settled = error_after(c, 2, n, 0, n, Exact(n));
  settled[0] = settled[1] = 0;
  return error_step(c, 2, n, n, settled) == settled;
}

inline bool is_first_order_corrector(const Exact &c)
{
  return higher_rows_are_nilpotent(c, 1) && first_order_keeps_degree_n(c);
}

inline bool is_position_corrector(const Exact &c)
{
  return higher_rows_are_nilpotent(c, 2) && velocity_row_keeps_degree_n(c) &&
      position_row_keeps_degree_n_plus_1(c);
}

inline bool is_velocity_corrector(const Exact &c)
{
  return higher_rows_are_nilpotent(c, 2) && velocity_row_keeps_degree_n(c) &&
      exact_velocity_keeps_degree_n(c);
}

}    // namespace Oracle

#endif
