/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_box.h"

#include "domain.h"
#include "force.h"
#include "kspace.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

void Box::refer()
{
  std::copy_n(domain->h, 6, reference.begin());
  std::copy_n(domain->boxlo, 3, reference.begin() + 6);
  std::copy_n(domain->boxhi, 3, reference.begin() + 9);
  const double *h = domain->h, *corner = domain->boxlo;
  const double half[3] = {0.5 * (h[0] + h[5] + h[4]), 0.5 * (h[1] + h[3]), 0.5 * h[2]};
  for (int k = 0; k < 3; ++k) origin[k] = fixed.empty() ? corner[k] + half[k] : fixed[k];
  derive();
  set(Upper::one());
}

void Box::derive()
{
  reference_volume = reference[0] * reference[1];
  if (domain->dimension == 3) reference_volume *= reference[2];
}

void Box::set(const Upper &deformation)
{
  m = deformation;
  inverse = m.inverse();
  change = m - Upper::one();
  inverse_change = inverse - Upper::one();
}

/// Directions that M leaves alone keep the bits of their faces.
void Box::show(bool forces)
{
  Upper before;
  std::copy_n(reference.begin(), 6, before.m.begin());
  const Upper cell = before + change * before;
  double way[3], corner[3];
  for (int k = 0; k < 3; ++k) way[k] = reference[6 + k] - origin[k];
  for (int k = 0; k < 3; ++k) corner[k] = reference[6 + k] + change.row_times(k, way);
  for (int k = 0; k < 3; ++k) {
    const bool as_before = corner[k] == reference[6 + k] && cell[k] == before[k];
    domain->boxlo[k] = corner[k];
    domain->boxhi[k] = as_before ? reference[9 + k] : corner[k] + cell[k];
  }
  if (domain->triclinic) {
    domain->yz = cell[Upper::YZ];
    domain->xz = cell[Upper::XZ];
    domain->xy = cell[Upper::XY];
  }
  domain->set_global_box();
  domain->set_local_box();
  if (forces && force->kspace) force->kspace->setup();
}

Box::Record Box::record() const
{
  Record all;
  std::copy(reference.begin(), reference.end(), all.begin());
  std::copy_n(origin, 3, all.begin() + 12);
  return all;
}

void Box::restore(const double *saved, const Upper &deformation)
{
  std::copy_n(saved, 12, reference.begin());
  std::copy_n(saved + 12, 3, origin);
  derive();
  set(deformation);
}
