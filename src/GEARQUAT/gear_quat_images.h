/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* LAMMPS counts the periodic box crossings of an atom in image flags of few bits.  The flags of an
   atom that crosses more boxes than they can count wrap around. */

#ifndef LMP_GEAR_QUAT_IMAGES_H
#define LMP_GEAR_QUAT_IMAGES_H

#include "lmptype.h"

#include <array>

namespace LAMMPS_NS {
class Domain;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// True if image flags have overflowed: turns (3) are the periods by which `unwrapped` (3),
/// computed from the flags, must be shifted to be nearest to `expected` (3); 0 for flags without
/// overflow.
bool image_flag_overflow(const Domain *domain, const double *expected, const double *unwrapped,
                         double *turns);

/// Adds to `unwrapped` (3) the overflow of the image flags that brings it nearest to `expected`
/// (3).  Without an overflow `unwrapped` does not change.
void undo_image_flag_overflow(const Domain *domain, const double *expected, double *unwrapped);

/// True if the position of an atom relative to another atom has changed by whole periods and has
/// become longer by `further`.
bool whole_periods_away(const Domain *domain, const double *change, double further);

/// True if this relative position has changed by the effect of another box on atoms in different
/// images.
/// box_before: as Domain::h.
bool moved_with_faces(const Domain *domain, const double *box_before, const double *change);

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
