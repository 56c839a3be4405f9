/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Nordsieck history of one body: n rows of WIDTH components, row after row,
   row j = h^j/j! d^j y/dt^j.  Every routine works on one body; the caller loops over bodies.

   Compensated sums: the first CARRIES rows are integrated, not set by the differential equation, so
   their rounding errors accumulate.  Each has a carry after the n rows with the rounding error of
   its sum so far (W. Kahan, Commun. ACM 8, 40 (1965)); the value is row + carry.  Compilers that
   treat additions as associative (-ffast-math) undo this.

   The scheme defines the numbers of rows and carries, and the columns.

   Corrector coefficients: after prediction the residual r of the differential equation is fed back
   into every row, y_j += c_j r, with
     first-order equation   r = h y' - y_1           c_1 = 1
     second-order equation  r = h^2/2 y'' - y_2      c_2 = 1 */

#ifndef GEAR_QUAT_HISTORY_H
#define GEAR_QUAT_HISTORY_H

#include "gear_quat_math.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace LAMMPS_NS::GearQuat {

// values kept: rows of a history

constexpr int FIRST_FEWEST = 3, FIRST_MOST = 8, FIRST_PAPER = 5;
constexpr int SECOND_FEWEST = 4, SECOND_MOST = 12, SECOND_PAPER = 6;
constexpr int MAX_VALUES = SECOND_MOST;

/// Loads remembered with keyword tolerance, and rows of the longest history.
constexpr int MOST_LOADS = 13, MOST_ROWS = MOST_LOADS + 2;

/// Three values have the coefficients of velocity Verlet, c = (0, 1, 1).  Where velocities are read
/// with the forces, they are then those of half a step before.
constexpr int VERLET = 3;

/// MOMENTUM: positions as in SECOND, and angular momenta.  FIRST and SECOND: those of the paper.
enum class Formulation { MOMENTUM, SECOND, FIRST };

/// The word of keyword formulation.
inline const char *word_of(Formulation formulation)
{
  constexpr const char *WORDS[] = {"momentum", "second", "first"};
  return WORDS[(int) formulation];
}

/// The coefficients: Gear's; tuned ones, for formulation momentum (gear_quat_coefficients.cpp); of
/// remembered loads, with two more rows (gear_quat_remembered_loads.h).
enum class Method { GEAR, TUNED, ADAMS };

/// Settings common to all bodies of a run.
struct Scheme {
  Formulation formulation = Formulation::SECOND;
  int rows = 0;      ///< values kept; 0: as many as the paper
  int passes = 1;    ///< first, second: corrections with the same forces
  Method method = Method::GEAR;
  bool velocity_c0 = false;        ///< second: c_0 for velocity-dependent right sides (the paper's)
  bool predicted_omega = false;    ///< first: omega that feeds Eq. 5
  bool predicted_momentum = false;    ///< first: momentum that feeds Eq. 13 (the paper's)
  bool project = true;                ///< first, second: onto |q| = 1 after every step
  bool compensate = false;            ///< compensated sums of the rows that are integrated

  bool tuned() const { return method == Method::TUNED; }
  bool remembers() const { return method == Method::ADAMS; }
  bool first() const { return formulation == Formulation::FIRST; }
  bool momentum() const { return formulation == Formulation::MOMENTUM; }
  int values() const { return rows ? rows : first() ? FIRST_PAPER : SECOND_PAPER; }
  int width() const { return first() ? FIRST_WIDTH : SECOND_WIDTH; }
  int carries() const { return compensate ? (first() ? 1 : 2) : 0; }
  /// Doubles of a history: rows, carries, trial rows.
  int size() const { return (values() + carries() + (remembers() ? 2 : 0)) * width(); }
  int trial_row() const { return (values() + carries()) * width(); }
  /// One remembered load has as many rows, and is another method.
  bool is_verlet() const { return !first() && !remembers() && values() == VERLET; }
  /// Order of the error of positions in time, if forces vary slowly along the trajectory (otherwise
  /// N for even N, and N - 1 with velocity_c0).  See gear_quat_coefficients.cpp.
  int order() const;
  /// The number of values for which a start has the order required by this scheme.
  int start_values() const { return tuned() ? std::min(values(), order()) : values(); }

  // columns of a row

  static constexpr int FIRST_WIDTH = 13, SECOND_WIDTH = 7;
  static constexpr int POSITION = 0;
  static constexpr int MOMENTUM = 3;    ///< first only
  static constexpr int FIRST_QUATERNION = 6, SECOND_QUATERNION = 3;
  int quaternion() const { return first() ? FIRST_QUATERNION : SECOND_QUATERNION; }
  static constexpr int OMEGA = 10;    ///< first only
  /// MOMENTUM: row 0 has the quaternion, as in SECOND, and row j > 0 has h^j/j! L^(j-1) in the
  /// first three of these columns, with the angular momentum L along the axes of space.
  static constexpr int ANGULAR_MOMENTUM = SECOND_QUATERNION;

  /// The divisor of q for a unit quaternion.  Without projection, the paper's formulas are used as
  /// they are, and a body is rigid only to the accuracy of |q| = 1.
  double norm2(const double *q) const { return project ? dot4(q, q) : 1.0; }
};

/// Doubles of the longest history, compensated and with trial rows.
constexpr int MAX_SIZE = (FIRST_MOST + 2) * Scheme::FIRST_WIDTH >
        (MOST_ROWS + 4) * Scheme::SECOND_WIDTH
    ? (FIRST_MOST + 2) * Scheme::FIRST_WIDTH
    : (MOST_ROWS + 4) * Scheme::SECOND_WIDTH;

/* ---------------------------------------------------------------------- */

/// gamma_k, the magnitude of the weight of the k-th backward difference in the formulas of Adams
/// and Moulton, k >= 1: sum over i = 0..k of signed weights / (k + 1 - i) vanishes.
long double adams_moulton(int k);

/// Gear's coefficients of a first-order equation, N values; of order N, and of order N + 1 for even
/// N if the motion is slow.
std::vector<long double> first_order_coefficients(int values);

/// Gear's coefficients of a second-order equation, N values. velocity_c0: for right-hand sides that
/// depend on velocities, of order N - 1; otherwise for right-hand sides of positions alone, of order
/// N, and of order N + 1 for even N if the motion is slow.
std::vector<long double> second_order_coefficients(int values, bool velocity_c0);

/// All N tuned coefficients, from SECOND_FEWEST to SECOND_MOST values; empty for other numbers.
std::vector<long double> tuned_coefficients(int values);

/// Coefficients of all columns, and the weight of residuals in the local error.
struct CorrectorCoefficients {
  using Array = std::array<double, MOST_ROWS>;

  Array c = {};            ///< first: of all columns, which have equations of the first order
  double weight2 = 0.0;    ///< of the residuals of positions and quaternions, squared
  double moment = 0.0;    ///< momentum: of the error of the predicted L, see gear_quat_integrator.h

  CorrectorCoefficients() = default;
  /// Throws std::domain_error if the scheme is tuned and has a number of values without a tuned
  /// set.
  explicit CorrectorCoefficients(const Scheme &scheme);
};

/* ---------------------------------------------------------------------- */

template <int WIDTH, int CARRIES = 0> struct Nordsieck {
  static double *carry_of(double *rows, int n, int row) { return rows + (n + row) * WIDTH; }

  /// rows[row] += value for COUNT components from `component` on, compensated where applicable.
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
  /// n: 3 to 15.  COUNT: components from the first on; the others do not change.
  template <int COUNT = WIDTH> static void predict(double *rows, int n)
  {
    // a number of rows known at compile time, so that a column stays in registers
    static constexpr auto by_rows =
        predictors<COUNT>(std::make_integer_sequence<int, MOST_ROWS - 2>());
    by_rows[n - 3](rows);
  }

  /// Feed the residual of COUNT components, the first at `component`, back into every row from row
  /// LOWEST on.
  template <int COUNT, int LOWEST = 0>
  static void correct(double *rows, int n, const double *coefficients, int component,
                      const double *residual)
  {
    double r[COUNT];    // a copy: residual may alias `rows`
#pragma GCC unroll 7
    for (int c = 0; c < COUNT; ++c) r[c] = residual[c];
    for (int j = LOWEST; j < CARRIES; ++j) {
      double value[COUNT];
      for (int c = 0; c < COUNT; ++c) value[c] = coefficients[j] * r[c];
      add<COUNT>(rows, n, j, component, value);
    }
    for (int j = LOWEST > CARRIES ? LOWEST : CARRIES; j < n; ++j) {
      const double coefficient = coefficients[j];
      double *row = rows + j * WIDTH + component;
#pragma GCC unroll 7
      for (int c = 0; c < COUNT; ++c) row[c] += coefficient * r[c];
    }
  }

  /// Rescales the polynomial for another step: ratio = new step / old step.
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
  /// sum += value; carry receives the rounding error (Knuth's two-sum, exact).
  static void add_exactly(double &sum, double &carry, double value)
  {
    const double b = value + carry, a = sum;
    sum = a + b;
    const double rounded = sum - a;
    carry = (a - (sum - rounded)) + (b - rounded);
  }

  template <int COUNT, int... N>
  static constexpr std::array<void (*)(double *), sizeof...(N)>
  predictors(std::integer_sequence<int, N...>)
  {
    return {pascal<N + 3, COUNT>...};
  }

  // unrolled by name: LAMMPS is mostly built with -O2, which does not unroll loops
  template <int N, int COUNT> static void pascal(double *rows)
  {
    for (int c = 0; c < COUNT; ++c) {
      double y[N], carry[CARRIES + 1];
#pragma GCC unroll 15
      for (int j = 0; j < N; ++j) y[j] = rows[j * WIDTH + c];
#pragma GCC unroll 2
      for (int j = 0; j < CARRIES; ++j) carry[j] = carry_of(rows, N, j)[c];
#pragma GCC unroll 15
      for (int pass = 0; pass < N - 1; ++pass)
#pragma GCC unroll 15
        for (int j = N - 2; j >= pass; --j)
          if (j < CARRIES)
            add_exactly(y[j], carry[j], y[j + 1]);
          else
            y[j] += y[j + 1];
#pragma GCC unroll 15
      for (int j = 0; j < N; ++j) rows[j * WIDTH + c] = y[j];
#pragma GCC unroll 2
      for (int j = 0; j < CARRIES; ++j) carry_of(rows, N, j)[c] = carry[j];
    }
  }
};

/// A scalar y with the equation y' = rate that is integrated with the bodies.  A bath uses it for
/// variables common to all bodies, such as the heat removed by a thermostat.
class ScalarHistory {
 public:
  using Rows = std::array<double, MAX_VALUES>;

  double value() const { return rows[0]; }
  void add(double change) { rows[0] += change; }

  /// Sets the derivatives from `terms` terms of a series in units of series_step; the value stays.
  void seed(const double *series, int terms, double series_step, double h, int values)
  {
    double power = 1.0;
    for (int j = 1; j < values; ++j) {
      power *= h / series_step;
      rows[j] = j < terms ? power * series[j] : 0.0;
    }
  }

  /// Changes the step; ratio = new step / old step.
  void rescale(double ratio, int values) { Nordsieck<1>::rescale(rows.data(), values, ratio); }

  /// One step with the coefficients of a first-order equation, to its end, where y' = rate.
  void advance(const double *coefficients, int values, double h, double rate)
  {
    Nordsieck<1>::predict(rows.data(), values);
    const double residual = h * rate - rows[1];
    Nordsieck<1>::correct<1>(rows.data(), values, coefficients, 0, &residual);
  }

  template <class V> void fields(V &v) { v(rows); }

 private:
  Rows rows = {};
};

}    // namespace LAMMPS_NS::GearQuat

#endif
