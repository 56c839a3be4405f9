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

/// Add to `unwrapped` (3) the turns of the image flags that bring it nearest to `expected` (3).
/// It is not touched where the flags have not turned over.
void gear_quat_add_turns_of_flags(const Domain *domain, const double *expected, double *unwrapped);

}    // namespace LAMMPS_NS

#endif
