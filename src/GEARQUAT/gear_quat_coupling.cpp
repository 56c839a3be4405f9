/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_coupling.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

// a kinetic energy less than this part of the whole is rounding of velocities

static constexpr double NOTHING = 1.0e-24;

const char *Coupling::part_at_rest(const double (&energies)[2], const bool (&moves)[2],
                                   bool separate)
{
  static const char *const names[] = {"translational ", "rotational "};
  const double all = energies[0] + energies[1];
  if (all <= 0.0) return "";
  for (int part = 0; separate && part < 2; ++part)
    if (moves[part] && energies[part] <= NOTHING * all) return names[part];
  return nullptr;
}
