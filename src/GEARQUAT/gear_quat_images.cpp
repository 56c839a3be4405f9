/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_images.h"

#include "domain.h"

#include <cmath>

using namespace LAMMPS_NS;

void LAMMPS_NS::gear_quat_add_turns_of_flags(const Domain *domain, const double *expected,
                                             double *unwrapped)
{
  const double range = (double) IMGMASK + 1.0;    // so many boxes, then flags begin again
  const double *to_box = domain->h_inv, *box = domain->h;
  const int periodic[3] = {domain->xperiodic, domain->yperiodic, domain->zperiodic};
  const double away[3] = {expected[0] - unwrapped[0], expected[1] - unwrapped[1],
                          expected[2] - unwrapped[2]};
  const double boxes[3] = {to_box[0] * away[0] + to_box[5] * away[1] + to_box[4] * away[2],
                           to_box[1] * away[1] + to_box[3] * away[2], to_box[2] * away[2]};
  double lost[3];
  bool any = false;
  for (int k = 0; k < 3; ++k) {
    lost[k] = periodic[k] ? range * std::round(boxes[k] / range) : 0.0;
    any = any || lost[k] != 0.0;
  }
  if (!any) return;
  unwrapped[0] += box[0] * lost[0] + box[5] * lost[1] + box[4] * lost[2];
  unwrapped[1] += box[1] * lost[1] + box[3] * lost[2];
  unwrapped[2] += box[2] * lost[2];
}
