/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Box: LAMMPS' box at any time of a start or a step, as the deformation M of a reference box:
   R = o + M (X - o), where R is a position, X the scaled position in histories, and o a fixed
   point.  If M = 1, positions, velocities and the box are the same to the last bit as without a
   moving box.

   Functions for the periodic images of atoms, and for positions in LAMMPS' box.

   CellHistory: a periodic cell that moves with the bodies in it (doc/theory.md, Eqs. P1 to P8).

   Let h be the cell of LAMMPS, an upper triangular matrix, and M = h h_ref^-1 its deformation since a
   reference.  Histories hold scaled centers of mass X, with R = o + M (X - o), so that neither the
   fixed point o nor the acceleration of the cell appears in the equation of motion:

     X'' = M^-1 [F/m - (2 G + b.G + xi) v],   v = M X',   G = M' M^-1,   b.G = sum_a b_a G_aa     (P3)
     M'' = (G' + G^2) M                                                                           (P4)

   The host provides the drive, G' without its friction.

   Sources: G. J. Martyna, D. J. Tobias, M. L. Klein, J. Chem. Phys. 101, 4177 (1994), section II.
   For an upper triangular cell the weights b follow from the requirement that the flow conserves
   the measure V^(1-d) dh. */

#ifndef LMP_GEAR_QUAT_BOX_H
#define LMP_GEAR_QUAT_BOX_H

#include "gear_quat_integrator.h"

#include "lmptype.h"
#include "pointers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {
class Domain;
}    // namespace LAMMPS_NS

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

/* ---------------------------------------------------------------------- */

class Box : protected Pointers {
 public:
  /// fixed: coordinates of the fixed point; empty: the center of the box.
  Box(LAMMPS *lmp, const std::vector<double> &fixed) : Pointers(lmp), fixed(fixed) {}

  /// Makes the current box of LAMMPS the reference: M = 1.
  void refer();
  /// Sets M for the mapping of states.
  void set(const Upper &deformation);
  const Upper &matrix() const { return m; }
  const Upper &inverse_matrix() const { return inverse; }
  double volume() const;

  /// Sets LAMMPS' box to the deformation M, with all quantities that LAMMPS derives from it.
  /// forces: true if forces will be evaluated in this box.
  void show(bool forces);

  /// True if flip() is possible on this number of ranks.
  bool can_flip() const;
  /// True if a tilt exceeds half of the corresponding period.
  bool is_tilted() const { return can_flip() && flips() != std::array<int, 3>(); }
  /// Replaces the box by the least tilted cell of the same lattice; atoms get their images in it.
  /// M and histories do not change.  To be called before atoms are exchanged.
  void flip();

  // between scaled and unscaled centers, with their velocities

  void to_space(BodyState &s) const { map(m, change, s); }
  void to_scaled(BodyState &s) const { map(inverse, inverse_change, s); }

  /// The reference and the fixed point.
  template <class V> void fields(V &v) { v(reference, origin); }

 private:
  std::vector<double> fixed;
  /// The reference box: h as in Domain::h, followed by boxlo and boxhi.
  std::array<double, 12> reference = {};
  double origin[3] = {};
  Upper m = Upper::one(), inverse = Upper::one();
  Upper change, inverse_change;    ///< M - 1 and M^-1 - 1

  std::array<int, 3> flips() const;
  void map(const Upper &matrix, const Upper &less_one, BodyState &s) const
  {
    double way[3], velocity[3];
    for (int k = 0; k < 3; ++k) {
      way[k] = s.center[k] - origin[k];
      velocity[k] = s.velocity[k];
    }
    for (int k = 0; k < 3; ++k) s.center[k] += less_one.row_times(k, way);
    matrix.times(velocity, s.velocity);
  }
};

// LAMMPS counts the periodic box crossings of an atom in image flags of few bits.  The flags of an
// atom that crosses more boxes than they can count wrap around.

/// The periods by which a position `unwrapped`, computed from the flags, must be shifted to be nearest
/// to `expected`; 0 unless the flags have overflowed.
std::array<double, 3> image_flag_overflow(const Domain *domain, const double *expected,
                                          const double *unwrapped);

/// The image of an unwrapped position in another box: its coordinates in units of the periods stay.
/// box_before: as Domain::h, followed by the corner of the box.
void follow_box(const Domain *domain, const double *box_before, const double *position,
                double *moved);

/// Converts a displacement (3) to units of the periods.
void to_periods(const Domain *domain, const double *way, double *periods);

/// The displacement for this number of periods of a box, h as in Domain::h, with the operations of
/// Domain::unmap(); or, from the rates of h, its velocity.
template <class Number> void through(const double *h, const Number *periods, double *way)
{
  way[0] = h[0] * periods[0] + h[5] * periods[1] + h[4] * periods[2];
  way[1] = h[1] * periods[1] + h[3] * periods[2];
  way[2] = h[2] * periods[2];
}

/// The periods between the wrapped and the unwrapped position of an atom with these flags.
std::array<int, 3> periods_of(imageint flags);

}    // namespace LAMMPS_NS::GearQuat

#endif
