/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_scene.h"

#include "gear_quat_bodies.h"

#include "comm.h"
#include "compute.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace GearQuat;

// where other fixes may read the velocities of predicted sites

static constexpr int WITHIN_STEP = POST_INTEGRATE | PRE_EXCHANGE | PRE_NEIGHBOR | POST_NEIGHBOR |
    PRE_FORCE | PRE_REVERSE | POST_FORCE | POST_INTEGRATE_RESPA | PRE_FORCE_RESPA |
    POST_FORCE_RESPA;

std::string GearQuat::reader_of_predicted_velocities(LAMMPS *lmp, const Fix *owner)
{
  if (lmp->comm->ghost_velocity) return "velocities are sent to ghost atoms";
  for (auto *other : lmp->modify->get_fix_list())
    if (other != owner && (lmp->modify->get_fix_mask(other) & WITHIN_STEP))
      return std::string("fix ") + other->id + " (" + other->style + ") may read them";
  return "";
}

bool GearQuat::makes_forces(LAMMPS *lmp, const Fix *owner)
{
  constexpr int AROUND_FORCES = PRE_FORCE | PRE_REVERSE | POST_FORCE | FINAL_INTEGRATE |
      PRE_FORCE_RESPA | POST_FORCE_RESPA | FINAL_INTEGRATE_RESPA;
  const Force *force = lmp->force;
  const auto acts = [](const void *style, const char *name) {
    return style && std::strcmp(name, "zero") != 0;
  };
  if (acts(force->pair, force->pair_style) || acts(force->bond, force->bond_style) ||
      acts(force->angle, force->angle_style) || acts(force->dihedral, force->dihedral_style) ||
      acts(force->improper, force->improper_style) || force->kspace)
    return true;
  for (auto *other : lmp->modify->get_fix_list())
    if (other != owner && (lmp->modify->get_fix_mask(other) & AROUND_FORCES)) return true;
  return false;
}

// LAMMPS' own fixes that read local data of other fixes through computes only, and the computes

static const char *const NO_LOCAL_DATA[] = {
    "^ave/atom",  "^ave/chunk", "^ave/correlate", "^ave/grid", "^ave/time", "^balance", "^ehex",
    "^enforce2d", "^halt",      "^heat",          "^momentum", "^print",    "^temp/",   "^vector"};
static constexpr char LOCAL_COMPUTES[] = "^reduce";

Readers GearQuat::readers_at_end(LAMMPS *lmp, const Fix *owner)
{
  const auto add = [](std::vector<int> &periods, int period) {
    if (!std::count(periods.begin(), periods.end(), period)) periods.push_back(period);
  };
  const auto &computes = lmp->modify->get_compute_list();
  const bool reduced = std::any_of(computes.begin(), computes.end(), [](const Compute *compute) {
    return utils::strmatch(compute->style, LOCAL_COMPUTES);
  });
  Readers readers;
  for (auto *other : lmp->modify->get_fix_list()) {
    if (other == owner || other->nevery <= 0 ||
        !(lmp->modify->get_fix_mask(other) & FixConst::END_OF_STEP))
      continue;
    add(readers.of_atoms, other->nevery);
    const bool known =
        std::any_of(std::begin(NO_LOCAL_DATA), std::end(NO_LOCAL_DATA), [other](const char *style) {
          return utils::strmatch(other->style, style);
        });
    if (reduced || !known) add(readers.of_local_data, other->nevery);
  }
  return readers;
}

bool GearQuat::is_due(const std::vector<int> &periods, bigint step)
{
  return std::any_of(periods.begin(), periods.end(), [step](int period) {
    return step % period == 0;
  });
}

/* ---------------------------------------------------------------------- */

static Scene::Top top_of(const RigidBody &rigid, int dimension)
{
  double i[3];
  std::copy_n(rigid.inertia, 3, i);
  std::sort(i, i + 3);
  if (i[2] <= 0.0) return Scene::POINT;
  if (dimension == 2) return Scene::PLANAR;
  if (i[0] <= 0.0) return Scene::LINEAR;
  const bool low = i[1] - i[0] < LINEAR_FRACTION * i[2],
             high = i[2] - i[1] < LINEAR_FRACTION * i[2];
  if (low && high) return Scene::SPHERICAL;
  return low || high ? Scene::SYMMETRIC : Scene::ASYMMETRIC;
}

Scene::Scene(LAMMPS *lmp, const Bodies &store)
{
  enum { SITES, ARMS, EXTENDED, GHOSTS, FREEDOMS, KINDS, COUNTS = KINDS + TOPS };
  bigint here[COUNTS] = {}, all[COUNTS];
  double largest_here[3] = {0.0, -(double) MAXTAGINT, 0.0}, largest[3];

  for (int ibody = 0; ibody < store.nowned(); ++ibody) {
    const Body &one = store.body[ibody];
    ++here[KINDS + top_of(one.rigid, lmp->domain->dimension)];
    here[FREEDOMS] += lmp->domain->dimension == 2 ? 2 + (one.rigid.inertia[2] > 0.0)
                                                  : 3 + one.rigid.rotational_freedoms();
    for (const double x : store.state_of(ibody).center)
      largest_here[0] = std::max(largest_here[0], std::fabs(x));
    largest_here[1] = std::max(largest_here[1], -(double) one.natoms);
    largest_here[2] = std::max(largest_here[2], (double) one.natoms);
  }
  for (const auto &site : store.sites) {
    ++here[SITES];
    if (dot3(site.arm_body, site.arm_body) > 0.0) ++here[ARMS];
    if (site.body >= store.nowned()) ++here[GHOSTS];
  }
  here[EXTENDED] = store.number_of_extended_here();

  MPI_Allreduce(here, all, COUNTS, MPI_LMP_BIGINT, MPI_SUM, lmp->world);
  MPI_Allreduce(largest_here, largest, 3, MPI_DOUBLE, MPI_MAX, lmp->world);
  sites = all[SITES];
  arms = all[ARMS];
  extended = all[EXTENDED];
  ghosts = all[GHOSTS];
  large = store.number_of_large();
  freedoms = all[FREEDOMS];
  for (int top = 0; top < TOPS; ++top) bodies += tops[top] = all[KINDS + top];
  farthest = largest[0];
  if (bodies) {
    fewest_sites = (bigint) -largest[1];
    most_sites = (bigint) largest[2];
  }
}
