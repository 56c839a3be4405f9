/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_census.h"

#include "gear_quat_images.h"
#include "gear_quat_rigid_body.h"

#include "comm.h"
#include "domain.h"
#include "lammps.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr int IRREGULAR = 0;
static constexpr double SAME_MASS = 1.0e-11;      // relative; sums run in another order
static constexpr double SAME_MOMENTS = 1.0e-9;    // relative; arms have the rounding of positions
static constexpr double ROUNDING = 1.0e-13;       // of positions

Census::Census(LAMMPS *lmp, std::vector<SiteCount> &sites, const double *box) :
    domain(lmp->domain), box_before(box)
{
  const int n = (int) sites.size();
  std::vector<int> ranks;
  for (const auto &site : sites) ranks.push_back((int) (site.owner % lmp->comm->nprocs));
  sites.emplace_back();    // no null pointers on a rank without sites
  ranks.push_back(0);
  char *unused = nullptr;
  lmp->comm->rendezvous(IRREGULAR, n, (char *) sites.data(), sizeof(SiteCount), 0, ranks.data(),
                        count_sites, 0, unused, sizeof(SiteCount), this);

  Census here = *this;
  MPI_Comm world = lmp->world;
  MPI_Allreduce(&here.removed_freedoms, &removed_freedoms, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  MPI_Allreduce(&here.mass_changed, &mass_changed, 1, MPI_INT, MPI_MAX, world);
  MPI_Allreduce(&here.torn, &torn, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  MPI_Allreduce(&here.cut, &cut, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  MPI_Allreduce(&here.broken, &broken, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (here.broken != broken) here.left = here.had = 0;
  MPI_Allreduce(&here.left, &left, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  MPI_Allreduce(&here.had, &had, 1, MPI_LMP_TAGINT, MPI_MAX, world);
}

int Census::count_sites(int n, char *in, int &flag, int *&ranks, char *&out, void *census)
{
  auto *sites = (SiteCount *) in;
  std::sort(sites, sites + n, [](const SiteCount &a, const SiteCount &b) {
    return a.owner < b.owner;
  });
  for (int first = 0, last; first < n; first = last) {
    for (last = first; last < n && sites[last].owner == sites[first].owner;) ++last;
    ((Census *) census)->count_body(sites + first, last - first);
  }
  flag = 0;    // no reply
  ranks = nullptr;
  out = nullptr;
  return 0;
}

void Census::count_body(const SiteCount *sites, int n)
{
  tagint natoms = 0;
  int freedoms = 0, own_freedoms = 0, in_group = 0;
  double mass = 0.0, body_mass = 0.0;
  const SiteCount *owner = nullptr;
  bool mixed = false;
  for (int i = 0; i < n; ++i) {
    if (sites[i].id != sites[0].id) mixed = true;
    if (sites[i].natoms > 0) owner = sites + i;
    natoms += sites[i].natoms;
    freedoms += sites[i].freedoms;
    own_freedoms += sites[i].own_freedoms;
    in_group += sites[i].in_group;
    mass += sites[i].mass;
    body_mass += sites[i].body_mass;
  }
  if (n != natoms || mixed) {
    broken = sites[0].id;
    left = n;
    had = natoms;
  }
  if (body_mass > 0.0 && std::fabs(mass - body_mass) > SAME_MASS * body_mass) mass_changed = 1;
  if (owner && body_mass > 0.0 && !same_masses(sites, n, *owner)) mass_changed = 1;
  if (owner) look_for_tears(sites, n, *owner);
  if (in_group == n) removed_freedoms += (bigint) domain->dimension * n + own_freedoms - freedoms;
}

/// Center and principal moments change if masses move from one atom of a body to another.
bool Census::same_masses(const SiteCount *sites, int n, const SiteCount &owner) const
{
  double first[3] = {}, second[6] = {};
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) first[k] += sites[i].first[k];
    for (int k = 0; k < 6; ++k) second[k] += sites[i].second[k];
  }
  const double *moments = owner.body_moments, *x = owner.found;
  const double trace = second[0] + second[1] + second[2];
  const double size = std::sqrt(trace / owner.body_mass);
  const double rounding =
      ROUNDING * (domain->xprd + domain->yprd + domain->zprd + std::sqrt(dot3(x, x)));
  const double limit = owner.body_mass * (SAME_MOMENTS * size + rounding);
  for (int k = 0; k < 3; ++k) {
    const double vanishing = moments[k] > 0.0 ? 0.0 : 2.0 * LINEAR_FRACTION * trace;
    if (std::fabs(first[k]) > limit) return false;
    if (std::fabs(second[k] - moments[k]) > limit * size + vanishing) return false;
    if (std::fabs(second[3 + k]) > limit * size) return false;
  }
  return true;
}

/// The user may have moved, rotated or deformed a body between two runs.  It is torn if its atoms are
/// whole periods further apart than before, or if parts of it have moved with the faces of the box.
void Census::look_for_tears(const SiteCount *sites, int n, const SiteCount &owner)
{
  for (int i = 0; i < n; ++i) {
    double before[3], now[3], change[3];
    for (int k = 0; k < 3; ++k) {
      before[k] = sites[i].expected[k] - owner.expected[k];
      now[k] = sites[i].found[k] - owner.found[k];
      change[k] = now[k] - before[k];
    }
    const double further = std::sqrt(dot3(now, now)) - std::sqrt(dot3(before, before));
    if (whole_periods_away(domain, change, further)) torn = owner.id;
    if (box_before && moved_with_faces(domain, box_before, change)) cut = owner.id;
  }
}
