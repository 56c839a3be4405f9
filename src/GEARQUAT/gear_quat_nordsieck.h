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

  /// rows[row] += value for COUNT components from `component` on, compensated where it counts.
  template <int COUNT>
  static void add(double *rows, int n, int row, int component, const double *value)
  {
    double *sum = rows + row * WIDTH + component;
    if (row >= CARRIES) {
      for (int c = 0; c < COUNT; ++c) sum[c] += value[c];
      return;
    }
    double *carry = carry_of(rows, n, row) + component;
    for (int c = 0; c < COUNT; ++c) {
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
    switch (n) {    // a number of rows that the compiler knows is worth a third of the time
      case 5:
        return pascal<5>(rows, n);
      case 6:
        return pascal<6>(rows, n);
      case 8:
        return pascal<8>(rows, n);
      default:
        return pascal<0>(rows, n);
    }
  }

  /// Feed the residual of COUNT components, the first at `component`, back into every row.
  template <int COUNT>
  static void correct(double *rows, int n, const double *coefficients, int component,
                      const double *residual)
  {
    for (int j = 0; j < CARRIES; ++j) {
      double value[COUNT];
      for (int c = 0; c < COUNT; ++c) value[c] = coefficients[j] * residual[c];
      add<COUNT>(rows, n, j, component, value);
    }
    for (int j = CARRIES; j < n; ++j) {
      double *row = rows + j * WIDTH + component;
      for (int c = 0; c < COUNT; ++c) row[c] += coefficients[j] * residual[c];
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

 private:
  /// N: rows if known when compiling, or 0.
  template <int N> static void pascal(double *rows, int rows_kept)
  {
    const int n = N ? N : rows_kept;
    for (int pass = 0; pass < n - 1; ++pass)
      for (int j = n - 2; j >= pass; --j) { add<WIDTH>(rows, n, j, 0, rows + (j + 1) * WIDTH); }
  }
};

}    // namespace GearQuat

#endif
