/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Nordsieck history of one body: n rows of WIDTH components, row after row,
   row j = h^j/j! d^j y/dt^j.  Every routine works on one body; loops over bodies live in the
   caller.

   Compensated: the first CARRIES rows are integrated, not set anew by the differential equation,
   so their rounding adds up over a run.  Each has a carry behind the n rows that holds what its sum
   has lost so far (W. Kahan, Commun. ACM 8, 40 (1965)); a row stands for row + carry.  Compilers
   that are told to treat additions as associative (-ffast-math) undo this.

   The scheme says how many rows and carries there are, and which column holds what. */

#ifndef GEAR_QUAT_NORDSIECK_H
#define GEAR_QUAT_NORDSIECK_H

#include "gear_quat_coefficients.h"
#include "gear_quat_quaternion.h"

#include <algorithm>

namespace LAMMPS_NS::GearQuat {

enum class Formulation { FIRST, SECOND };

/// What is the same for all bodies of a run.
struct Scheme {
  Formulation formulation = Formulation::SECOND;
  int rows = 0;                    ///< values kept; 0: as many as the paper
  int passes = 1;                  ///< corrections with the same forces
  bool tuned = false;              ///< coefficients of gear_quat_tuned.h, otherwise Gear's
  bool velocity_c0 = false;        ///< second: c_0 for velocity-dependent right sides (the paper's)
  bool predicted_omega = false;    ///< first: omega that feeds Eq. 5
  bool predicted_momentum = false;    ///< first: momentum that feeds Eq. 13 (the paper's)
  bool project = true;                ///< keep |q| = 1 and q.qdot = 0
  bool compensate = false;            ///< compensated sums of the rows that are integrated
  bool trial = false;                 ///< one more row, see gear_quat_step_control.h

  bool first() const { return formulation == Formulation::FIRST; }
  int values() const { return rows ? rows : first() ? FIRST_PAPER : SECOND_PAPER; }
  int width() const { return first() ? FIRST_WIDTH : SECOND_WIDTH; }
  int carries() const { return compensate ? (first() ? 1 : 2) : 0; }
  /// Doubles of a history: rows, carries, trial row.
  int size() const { return (values() + carries() + trial) * width(); }
  int trial_row() const { return (values() + carries()) * width(); }
  /// Of the error of positions in time, while forces vary slowly along the way (otherwise even N
  /// keep N, and N - 1 with velocity_c0).  See gear_quat_tuned.h.
  int order() const;
  /// The number of values whose start has the order that this scheme needs.
  int start_values() const { return tuned ? std::min(values(), order()) : values(); }

  // columns of a row

  static constexpr int FIRST_WIDTH = 13, SECOND_WIDTH = 7;
  static constexpr int POSITION = 0;
  static constexpr int MOMENTUM = 3;    ///< first only
  static constexpr int FIRST_QUATERNION = 6, SECOND_QUATERNION = 3;
  int quaternion() const { return first() ? FIRST_QUATERNION : SECOND_QUATERNION; }
  static constexpr int OMEGA = 10;    ///< first only

  /// What q is divided by where a unit quaternion is meant: unprojected, the paper's formulas are
  /// taken as they stand, and a body is only as rigid as |q| = 1 holds.
  double norm2(const double *q) const { return project ? dot4(q, q) : 1.0; }
};

/// Doubles of the longest history, compensated and with a trial row.
constexpr int MAX_SIZE = (FIRST_MOST + 2) * Scheme::FIRST_WIDTH >
        (SECOND_MOST + 3) * Scheme::SECOND_WIDTH
    ? (FIRST_MOST + 2) * Scheme::FIRST_WIDTH
    : (SECOND_MOST + 3) * Scheme::SECOND_WIDTH;

template <int WIDTH, int CARRIES = 0> struct Nordsieck {
  static double *carry_of(double *rows, int n, int row) { return rows + (n + row) * WIDTH; }

  /// rows[row] += value for COUNT components from `component` on, compensated where it counts.
  template <int COUNT>
  static void add(double *rows, int n, int row, int component, const double *value)
  {
    double *sum = rows + row * WIDTH + component;
    if (row >= CARRIES) {
#pragma GCC unroll 13
      for (int c = 0; c < COUNT; ++c) sum[c] += value[c];
      return;
    }
    double *carry = carry_of(rows, n, row) + component;
    for (int c = 0; c < COUNT; ++c) add_exactly(sum[c], carry[c], value[c]);
  }

  /// Advance the history by one step: the Taylor series (Eq. 11) as additions of Pascal's triangle.
  /// After the call row j holds h^j/j! times the j-th derivative of the same polynomial at t + h.
  /// n: 3 to 12, those of both formulations.  COUNT: components from the first on; the others stay.
  template <int COUNT = WIDTH> static void predict(double *rows, int n)
  {
    switch (n) {    // a number of rows that the compiler knows, so that a column stays in registers
      case 3:
        return pascal<3, COUNT>(rows);
      case 4:
        return pascal<4, COUNT>(rows);
      case 5:
        return pascal<5, COUNT>(rows);
      case 6:
        return pascal<6, COUNT>(rows);
      case 7:
        return pascal<7, COUNT>(rows);
      case 8:
        return pascal<8, COUNT>(rows);
      case 9:
        return pascal<9, COUNT>(rows);
      case 10:
        return pascal<10, COUNT>(rows);
      case 11:
        return pascal<11, COUNT>(rows);
      case 12:
        return pascal<12, COUNT>(rows);
    }
  }

  /// Feed the residual of COUNT components, the first at `component`, back into every row.
  template <int COUNT>
  static void correct(double *rows, int n, const double *coefficients, int component,
                      const double *residual)
  {
    double r[COUNT];    // a copy: residual might be in `rows`, for all the compiler knows
#pragma GCC unroll 4
    for (int c = 0; c < COUNT; ++c) r[c] = residual[c];
    for (int j = 0; j < CARRIES; ++j) {
      double value[COUNT];
      for (int c = 0; c < COUNT; ++c) value[c] = coefficients[j] * r[c];
      add<COUNT>(rows, n, j, component, value);
    }
    for (int j = CARRIES; j < n; ++j) {
      const double coefficient = coefficients[j];
      double *row = rows + j * WIDTH + component;
#pragma GCC unroll 4
      for (int c = 0; c < COUNT; ++c) row[c] += coefficient * r[c];
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
  /// sum += value; carry takes what rounding takes away (Knuth's two-sum, exact).
  static void add_exactly(double &sum, double &carry, double value)
  {
    const double b = value + carry, a = sum;
    sum = a + b;
    const double rounded = sum - a;
    carry = (a - (sum - rounded)) + (b - rounded);
  }

  // unrolled by name: LAMMPS is mostly built with -O2, which leaves loops alone
  template <int N, int COUNT> static void pascal(double *rows)
  {
    for (int c = 0; c < COUNT; ++c) {
      double y[N], carry[CARRIES + 1];
#pragma GCC unroll 12
      for (int j = 0; j < N; ++j) y[j] = rows[j * WIDTH + c];
#pragma GCC unroll 2
      for (int j = 0; j < CARRIES; ++j) carry[j] = carry_of(rows, N, j)[c];
#pragma GCC unroll 12
      for (int pass = 0; pass < N - 1; ++pass)
#pragma GCC unroll 12
        for (int j = N - 2; j >= pass; --j)
          if (j < CARRIES)
            add_exactly(y[j], carry[j], y[j + 1]);
          else
            y[j] += y[j + 1];
#pragma GCC unroll 12
      for (int j = 0; j < N; ++j) rows[j * WIDTH + c] = y[j];
#pragma GCC unroll 2
      for (int j = 0; j < CARRIES; ++j) carry_of(rows, N, j)[c] = carry[j];
    }
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
