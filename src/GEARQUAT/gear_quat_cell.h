/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A periodic cell that moves with the bodies in it (doc/theory.md, Eqs. P1 to P8).

   Let h be the cell of LAMMPS, an upper triangular matrix, and M = h h_ref^-1 its deformation since a
   reference.  Histories hold scaled centers of mass X, with R = o + M (X - o), so that neither the
   fixed point o nor the acceleration of the cell appears in the equation of motion:

     X'' = M^-1 [F/m - (2 G + b.G + xi) v],   v = M X',   G = M' M^-1,   b.G = sum_a b_a G_aa     (P3)
     M'' = (G' + G^2) M                                                                           (P4)

   The host provides the drive, G' without its friction.

   Sources: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994), section II.
   For an upper triangular cell the weights b follow from the requirement that the flow conserves
   the measure V^(1-d) dh. */

#ifndef GEAR_QUAT_CELL_H
#define GEAR_QUAT_CELL_H

#include "gear_quat_integrator.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace LAMMPS_NS::GearQuat {

/// The friction of the scaled momentum p = m X' in a moving cell: the terms of Eq. P3 that depend on
/// velocities.  A constant common velocity V = M c of all bodies is excluded from b.G and xi:
///   p' = M^-1 F - damping (p - m c) - drag m c
///   damping = M^-1 (2 G + b.G + xi) M,   drag = M^-1 G M
/// alpha: of the thermostat, the same along all axes.  weights: b.
inline Friction friction_in_cell(const Friction &alpha, const Upper &matrix, const Upper &rate,
                                 const double (&weights)[3])
{
  Friction found = alpha;
  const Upper inverse = matrix.inverse();
  double trace = alpha.damping[0];
  for (int k = 0; k < 3; ++k) trace += weights[k] * rate[k];
  found.drag = inverse * rate * matrix;
  found.damping = found.drag.scaled(2.0) + Upper::one().scaled(trace);
  inverse.times(alpha.common, found.common);
  return found;
}

/* ---------------------------------------------------------------------- */

/// The history of M, with as many values as the histories of the bodies.
class CellHistory {
 public:
  static constexpr int WIDTH = Upper::SIZE;
  using Rows = std::array<double, WIDTH * MAX_VALUES>;

  void set_scheme(const Scheme &of_bodies)
  {
    n = of_bodies.values();
    set_coefficients(CorrectorCoefficients(of_bodies));
  }
  /// For the next step.
  void set_coefficients(const CorrectorCoefficients &all)
  {
    c = all.c;
    weight = std::sqrt(all.weight2);
  }

  /// M = 1 with this rate; higher derivatives are not known.
  void begin(const Upper &rate, double h)
  {
    rows = {};
    put(0, Upper::one());
    put(1, rate.scaled(h));
    total = Upper();
  }

  // in the present pass; before the first pass and in a completed step, from the rows

  Upper matrix() const { return row(0) + total.scaled(c[0]); }
  /// G = M' M^-1
  Upper rate(double h) const
  {
    return (row(1) + total.scaled(c[1])).scaled(1.0 / h) * matrix().inverse();
  }

  /// M'' from the drive, by Eq. P4.
  static Upper acceleration(const Upper &matrix, const Upper &rate, const Upper &drive,
                            double friction)
  {
    return (drive - rate.scaled(friction) + rate * rate) * matrix;
  }

  void predict() { Nordsieck<WIDTH>::predict(rows.data(), n); }

  /// One pass in a step of h.  It is implicit in the friction, which may be strong.
  void pass(const Upper &drive, double friction, double h)
  {
    const Upper now = matrix(), rate = this->rate(h);
    const Upper without = (drive + rate * rate) * now;
    const double half_h2 = 0.5 * h * h, divisor = 1.0 / (1.0 + 0.5 * h * friction * c[1]);
    const Upper first = row(1), second = row(2);
    for (int k = 0; k < WIDTH; ++k)
      total[k] = divisor * (half_h2 * without[k] - 0.5 * h * friction * first[k] - second[k]);
  }
  /// Completes the step.
  void finish()
  {
    Nordsieck<WIDTH>::correct<WIDTH>(rows.data(), n, c.data(), 0, total.m.data());
    total = Upper();
  }
  /// The change of M by the corrector up to the present pass.
  Upper correction() const { return total.scaled(c[0]); }
  /// The local error of M in the present step.
  Upper local_error() const { return total.scaled(weight); }

  void rescale(double ratio) { Nordsieck<WIDTH>::rescale(rows.data(), n, ratio); }

  /// All rows from `terms` terms of a series, series[6 j + k], in units of series_step.
  void seed(const double *series, int terms, double series_step, double h)
  {
    double power = 1.0;
    rows = {};
    for (int j = 0; j < n && j < terms; ++j, power *= h / series_step)
      for (int k = 0; k < WIDTH; ++k) rows[WIDTH * j + k] = power * series[WIDTH * j + k];
    total = Upper();
  }

  /// Between steps.
  template <class V> void fields(V &v) { v(rows); }

 private:
  int n = 0;
  CorrectorCoefficients::Array c = {};
  double weight = 0.0;
  Rows rows = {};
  Upper total;    ///< the residual after the present pass

  Upper row(int j) const
  {
    Upper found;
    std::copy_n(&rows[(size_t) WIDTH * j], WIDTH, found.m.begin());
    return found;
  }
  void put(int j, const Upper &value)
  {
    std::copy_n(value.m.begin(), WIDTH, &rows[(size_t) WIDTH * j]);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
