/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_images.h"

#include "domain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

// a displacement that has grown by less than this part of a period has not changed by a period

static constexpr double PART = 0.25;

// coordinates count as equal if they differ by less than this part of the box

static constexpr double SAME = 1.0e-9;

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

static bool is_periodic(const Domain *domain, int direction)
{
  return (direction == 0       ? domain->xperiodic
              : direction == 1 ? domain->yperiodic
                               : domain->zperiodic) != 0;
}

/* ---------------------------------------------------------------------- */

bool GearQuat::image_flag_overflow(const Domain *domain, const double *expected,
                                   const double *unwrapped, double *turns)
{
  const double range = (double) IMGMASK + 1.0;    // number of boxes after which flags wrap around
  const double away[3] = {expected[0] - unwrapped[0], expected[1] - unwrapped[1],
                          expected[2] - unwrapped[2]};
  double boxes[3];
  to_periods(domain, away, boxes);
  bool any = false;
  for (int k = 0; k < 3; ++k) {
    turns[k] = 0.0;
    if (!(std::fabs(boxes[k]) > 0.5 * range) || !is_periodic(domain, k)) continue;
    turns[k] = range * std::round(boxes[k] / range);
    any = true;
  }
  return any;
}

void GearQuat::undo_image_flag_overflow(const Domain *domain, const double *expected,
                                        double *unwrapped)
{
  double turns[3], way[3];
  if (!image_flag_overflow(domain, expected, unwrapped, turns)) return;
  through(domain->h, turns, way);
  for (int k = 0; k < 3; ++k) unwrapped[k] += way[k];
}

bool GearQuat::whole_periods_away(const Domain *domain, const double *change, double further)
{
  double periods[3];
  to_periods(domain, change, periods);
  for (int k = 0; k < 3; ++k)
    if (is_periodic(domain, k) && std::round(periods[k]) != 0.0 && further > PART * domain->h[k])
      return true;
  return false;
}

bool GearQuat::moved_with_faces(const Domain *domain, const double *box_before,
                                const double *change)
{
  double box_change[6];
  bool changed = false;
  const double same = SAME * (domain->h[0] + domain->h[1] + domain->h[2]);
  for (int k = 0; k < 6; ++k) {
    box_change[k] = domain->h[k] - box_before[k];
    changed = changed || std::fabs(box_change[k]) > same;
  }
  if (!changed) return false;
  for (int code = 0; code < 27; ++code) {    // all combinations of -1, 0 and 1
    double images[3] = {code % 3 - 1.0, code / 3 % 3 - 1.0, code / 9 - 1.0};
    for (int k = 0; k < 3; ++k)
      if (!is_periodic(domain, k)) images[k] = 0.0;
    double way[3], longest = 0.0, off = 0.0;
    through(box_change, images, way);
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, std::fabs(way[k]));
      off = std::max(off, std::fabs(way[k] - change[k]));
    }
    if (longest > same && off < same) return true;
  }
  return false;
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
