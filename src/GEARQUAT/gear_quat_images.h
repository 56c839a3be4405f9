/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* LAMMPS counts how often an atom has crossed the periodic box in image flags of few bits.  An atom
   that has gone through more boxes than they can count begins again at the other end. */

#ifndef LMP_GEAR_QUAT_IMAGES_H
#define LMP_GEAR_QUAT_IMAGES_H

namespace LAMMPS_NS {
class Domain;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// True if image flags have turned over: turns (3) are the periods by which `unwrapped` (3), made of
/// the flags, has to be moved to be nearest to `expected` (3); 0 where flags have not turned over.
bool image_flag_overflow(const Domain *domain, const double *expected, const double *unwrapped,
                         double *turns);

/// Add to `unwrapped` (3) the turns of the image flags that bring it nearest to `expected` (3).
/// It is not touched where the flags have not turned over.
void undo_image_flag_overflow(const Domain *domain, const double *expected, double *unwrapped);

/// True if the place of an atom beside another one has changed by whole periods, to a place that is
/// `further` away from it.
bool whole_periods_away(const Domain *domain, const double *change, double further);

/// True if that place has changed by what another box makes of atoms in different images.
/// box_before: as Domain::h.
bool moved_with_faces(const Domain *domain, const double *box_before, const double *change);

/// Where another box takes an unwrapped position: its coordinates in units of the periods stay.
/// box_before: as Domain::h, and behind it the corner of the box.
void follow_box(const Domain *domain, const double *box_before, const double *position,
                double *moved);

/// A way (3) in units of the periods.
void to_periods(const Domain *domain, const double *way, double *periods);

}    // namespace LAMMPS_NS::GearQuat

#endif
