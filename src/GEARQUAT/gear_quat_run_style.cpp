/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

// access to LAMMPS' run styles

#include "gear_quat_forces.h"

#include "respa.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

std::vector<double> RespaForces::steps(LAMMPS *lmp)
{
  const auto *respa = dynamic_cast<Respa *>(lmp->update->integrate);
  if (!respa) return {};
  return std::vector<double>(respa->step, respa->step + respa->nlevels);
}

void Forces::clear()
{
  update->integrate->force_clear();
}
