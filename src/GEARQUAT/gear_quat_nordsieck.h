/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Nordsieck history of one body: n rows of WIDTH components, row after row,
   row j = h^j/j! d^j y/dt^j.  Every routine works on one body; loops over bodies live in the caller.

   Compensated: the first CARRIES rows are integrated, not set anew by the differential equation,
   so their rounding adds up over a run.  Each has a carry behind the n rows that holds what its sum
   has lost so far (W. Kahan, Commun. ACM 8, 40 (1965)); a row stands for row + carry.  Compilers
   that are told to treat additions as associative (-ffast-math) undo this. */

#ifndef GEAR_QUAT_NORDSIECK_H
#define GEAR_QUAT_NORDSIECK_H

#include <cmath>

namespace GearQuat {

template <int WIDTH, int CARRIES = 0> struct Nordsieck {
  static double *carry_of(double *rows, int n, int row) { return rows + (n + row) * WIDTH; }

  /// rows[row] += value for `count` components from `component` on, compensated where it counts.
  static void add(double *rows, int n, int row, int component, int count, const double *value)
  {
    double *sum = rows + row * WIDTH + component;
    if (row >= CARRIES) {
      for (int c = 0; c < count; ++c) sum[c] += value[c];
      return;
    }
    double *carry = carry_of(rows, n, row) + component;
    for (int c = 0; c < count; ++c) {
      const double b = value[c] + carry[c], a = sum[c];
      sum[c] = a + b;
      const double rounded = sum[c] - a;    // exact error of a + b (Knuth's two-sum)
      carry[c] = (a - (sum[c] - rounded)) + (b - rounded);
    }
  }

  /// Advance the history by one step: the Taylor series (Eq. 11) as additions of Pascal's triangle.
  /// After the call row j holds h^j/j! times the j-th derivative of the same polynomial at t + h.
  static void predict(double *rows, int n)
  {
    for (int pass = 0; pass < n - 1; ++pass)
      for (int j = n - 2; j >= pass; --j) {
        const double *upper = rows + (j + 1) * WIDTH;
        if (j >= CARRIES) {
          double *lower = rows + j * WIDTH;
          for (int c = 0; c < WIDTH; ++c) lower[c] += upper[c];
        } else {
          double value[WIDTH];
          for (int c = 0; c < WIDTH; ++c) value[c] = upper[c];
          if (j + 1 < CARRIES)
            for (int c = 0; c < WIDTH; ++c) value[c] += carry_of(rows, n, j + 1)[c];
          add(rows, n, j, 0, WIDTH, value);
        }
      }
  }

  /// Feed the residual of `count` components, the first at `component`, back into every row.
  static void correct(double *rows, int n, const double *coefficients, int component, int count,
                      const double *residual)
  {
    for (int j = 0; j < CARRIES; ++j) {
      double value[WIDTH];
      for (int c = 0; c < count; ++c) value[c] = coefficients[j] * residual[c];
      add(rows, n, j, component, count, value);
    }
    for (int j = CARRIES; j < n; ++j) {
      double *row = rows + j * WIDTH + component;
      for (int c = 0; c < count; ++c) row[c] += coefficients[j] * residual[c];
    }
  }

  /// The same polynomial for another step: ratio = new step / old step.
  static void rescale(double *rows, int n, double ratio)
  {
    double factor = 1.0;
    for (int j = 1; j < n; ++j) {
      factor *= ratio;
      double *row = rows + j * WIDTH;
      for (int c = 0; c < WIDTH; ++c) {
        const double before = row[c];
        row[c] *= factor;
        if (j < CARRIES) {
          double &carry = carry_of(rows, n, j)[c];
          carry = carry * factor + std::fma(before, factor, -row[c]);
        }
      }
    }
  }
};

}    // namespace GearQuat

#endif
