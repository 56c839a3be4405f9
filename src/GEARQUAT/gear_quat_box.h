/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* LAMMPS' box at any time of a start or a step, as the deformation M of a reference box:
   R = o + M (X - o), where R is a position, X the scaled position in histories, and o a fixed
   point.  If M = 1, positions, velocities and the box are the same to the last bit as without a
   moving box.

   Periodic images of atoms and positions in LAMMPS' box. */

#ifndef LMP_GEAR_QUAT_BOX_H
#define LMP_GEAR_QUAT_BOX_H

#include "gear_quat_cell.h"

#include "lmptype.h"
#include "pointers.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {
class Domain;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

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
  bool is_tilted() const;
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
