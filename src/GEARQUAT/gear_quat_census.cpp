/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_census.h"

#include "comm.h"
#include "domain.h"
#include "lammps.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static constexpr int IRREGULAR = 0;
static constexpr double SAME_MASS = 1.0e-11;    // relative; sums run in another order

GearQuatCensus::GearQuatCensus(LAMMPS *lmp, std::vector<GearQuatSiteCount> &sites) :
    dimension(lmp->domain->dimension)
{
  const int n = (int) sites.size();
  std::vector<int> ranks;
  for (const auto &site : sites) ranks.push_back((int) (site.owner % lmp->comm->nprocs));
  sites.emplace_back();    // no null pointers on a rank without sites
  ranks.push_back(0);
  char *unused = nullptr;
  lmp->comm->rendezvous(IRREGULAR, n, (char *) sites.data(), sizeof(GearQuatSiteCount), 0,
                        ranks.data(), count_sites, 0, unused, sizeof(GearQuatSiteCount), this);

  GearQuatCensus here = *this;
  MPI_Comm world = lmp->world;
  MPI_Allreduce(&here.removed_freedoms, &removed_freedoms, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  MPI_Allreduce(&here.mass_changed, &mass_changed, 1, MPI_INT, MPI_MAX, world);
  MPI_Allreduce(&here.broken, &broken, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (here.broken != broken) here.left = here.had = 0;
  MPI_Allreduce(&here.left, &left, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  MPI_Allreduce(&here.had, &had, 1, MPI_LMP_TAGINT, MPI_MAX, world);
}

int GearQuatCensus::count_sites(int n, char *in, int &flag, int *&ranks, char *&out, void *census)
{
  auto *sites = (GearQuatSiteCount *) in;
  std::sort(sites, sites + n, [](const GearQuatSiteCount &a, const GearQuatSiteCount &b) {
    return a.owner < b.owner;
  });
  for (int first = 0, last; first < n; first = last) {
    for (last = first; last < n && sites[last].owner == sites[first].owner;) ++last;
    ((GearQuatCensus *) census)->count_body(sites + first, last - first);
  }
  flag = 0;    // no reply
  ranks = nullptr;
  out = nullptr;
  return 0;
}

void GearQuatCensus::count_body(const GearQuatSiteCount *sites, int n)
{
  tagint natoms = 0;
  int freedoms = 0, own_freedoms = 0, in_group = 0;
  double mass = 0.0, body_mass = 0.0;
  for (int i = 0; i < n; ++i) {
    natoms += sites[i].natoms;
    freedoms += sites[i].freedoms;
    own_freedoms += sites[i].own_freedoms;
    in_group += sites[i].in_group;
    mass += sites[i].mass;
    body_mass += sites[i].body_mass;
  }
  if (n != natoms) {
    broken = sites[0].id;
    left = n;
    had = natoms;
  }
  if (body_mass > 0.0 && std::fabs(mass - body_mass) > SAME_MASS * body_mass) mass_changed = 1;
  if (in_group == n) removed_freedoms += (bigint) dimension * n + own_freedoms - freedoms;
}
