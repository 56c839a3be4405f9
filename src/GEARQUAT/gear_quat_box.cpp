/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_box.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "force.h"
#include "kspace.h"

#if __has_include("irregular.h")
#include "irregular.h"
#endif

#include <algorithm>
#include <cmath>

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
  set(Upper::one());
}

double Box::volume() const
{
  double found = reference[0] * reference[1];
  if (domain->dimension == 3) found *= reference[2];
  return found * m.determinant();
}

void Box::set(const Upper &deformation)
{
  m = deformation;
  inverse = m.inverse();
  change = m - Upper::one();
  inverse_change = inverse - Upper::one();
}

/// Directions that M does not change keep the bits of their faces.
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

/* ----------------------------------------------------------------------
   flips
------------------------------------------------------------------------- */

// a tilt must exceed half of a period by this part of it, so that it is not flipped back at once

static constexpr double BEYOND = 0.1;

// LAMMPS' class for moving atoms to any rank; its header is missing in some installations

#if __has_include("irregular.h")
static constexpr bool MIGRATES = true;
static void migrate_atoms(LAMMPS *lmp)
{
  Irregular(lmp).migrate_atoms();
}
#else
static constexpr bool MIGRATES = false;
static void migrate_atoms(LAMMPS *) {}
#endif

/// The number of periods that reduces a tilt to less than half a period.
static int flips_of(double tilt, double period)
{
  if (std::fabs(tilt) < (0.5 + BEYOND) * period) return 0;
  return -(int) std::lround(tilt / period);
}

bool Box::can_flip() const
{
  return MIGRATES || comm->nprocs == 1;
}

/// Of the tilts yz, xz and xy.
std::array<int, 3> Box::flips() const
{
  const double *h = domain->h;
  const int p = domain->yperiodic ? flips_of(h[3], h[1]) : 0;
  if (!domain->xperiodic) return {p, 0, 0};
  return {p, flips_of(h[4] + p * h[5], h[0]), flips_of(h[5], h[0])};
}

void Box::flip()
{
  const auto [p, n, m_xy] = flips();
  reference[3] += p * reference[1];
  reference[4] += p * reference[5] + n * reference[0];
  reference[5] += m_xy * reference[0];
  show(true);
  domain->image_flip(m_xy, n, p);
  for (int i = 0; i < atom->nlocal; ++i) domain->remap(atom->x[i], atom->image[i]);
  domain->x2lamda(atom->nlocal);
  migrate_atoms(lmp);
  domain->lamda2x(atom->nlocal);
}

/* ----------------------------------------------------------------------
   periodic images
------------------------------------------------------------------------- */

void GearQuat::to_periods(const Domain *domain, const double *way, double *periods)
{
  const double *to_box = domain->h_inv;
  periods[0] = to_box[0] * way[0] + to_box[5] * way[1] + to_box[4] * way[2];
  periods[1] = to_box[1] * way[1] + to_box[3] * way[2];
  periods[2] = to_box[2] * way[2];
}

std::array<int, 3> GearQuat::periods_of(imageint flags)
{
  return {(int) (flags & IMGMASK) - IMGMAX, (int) (flags >> IMGBITS & IMGMASK) - IMGMAX,
          (int) (flags >> IMG2BITS) - IMGMAX};
}

/* ---------------------------------------------------------------------- */

std::array<double, 3> GearQuat::image_flag_overflow(const Domain *domain, const double *expected,
                                                    const double *unwrapped)
{
  const double range = (double) IMGMASK + 1.0;    // number of boxes after which flags wrap around
  const double away[3] = {expected[0] - unwrapped[0], expected[1] - unwrapped[1],
                          expected[2] - unwrapped[2]};
  double boxes[3];
  to_periods(domain, away, boxes);
  std::array<double, 3> turns = {};
  for (int k = 0; k < 3; ++k)
    if (std::fabs(boxes[k]) > 0.5 * range && domain->periodicity[k])
      turns[k] = range * std::round(boxes[k] / range);
  return turns;
}

void GearQuat::follow_box(const Domain *domain, const double *box_before, const double *position,
                          double *moved)
{
  const double *h = box_before, *corner = box_before + 6;
  double periods[3];
  for (int k = 2; k >= 0; --k) {    // back substitution: tilts are h[3] yz, h[4] xz, h[5] xy
    double way = position[k] - corner[k];
    if (k == 0) way -= h[5] * periods[1] + h[4] * periods[2];
    if (k == 1) way -= h[3] * periods[2];
    periods[k] = way / h[k];
  }
  through(domain->h, periods, moved);
  for (int k = 0; k < 3; ++k) moved[k] += domain->boxlo[k];
}
