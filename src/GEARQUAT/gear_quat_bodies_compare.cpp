/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Body store, before a run: the atoms compared with what bodies know of them. */

#include "gear_quat_bodies.h"

#include "gear_quat_gather.h"

#include "atom.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace GearQuat;

// atoms count as moved by the user when they are off by more than rounding of coordinates and
// velocities, relative to box and body

static constexpr double SAME = 1.0e-11;

/* ---------------------------------------------------------------------- */

Bodies::Placed Bodies::placed(const Site &site) const
{
  const double box = std::max({domain->xprd, domain->yprd, domain->zprd});
  const BodyState &s = state[site.body];
  double arm[3], spin[3];
  Placed there;
  to_space(frame[site.body].axes, site.arm_body, arm);
  cross3(frame[site.body].omega_space, arm, spin);
  for (int k = 0; k < 3; ++k) {
    there.x[k] = s.center[k] + arm[k] - site.wrap[k];
    there.v[k] = s.velocity[k] + spin[k];
  }
  there.length = box + std::sqrt(dot3(s.center, s.center) + dot3(site.wrap, site.wrap));
  there.speed = std::sqrt(dot3(s.velocity, s.velocity)) + std::sqrt(dot3(spin, spin));
  return there;
}

bool Bodies::atoms_match()
{
  int moved = 0;
  for (const Site &site : sites) {
    const double *x = atom->x[site.atom], *v = atom->v[site.atom];
    const Placed there = placed(site);
    for (int k = 0; k < 3; ++k) {
      if (std::fabs(there.x[k] - x[k]) > SAME * there.length) moved = 1;
      if (std::fabs(there.v[k] - v[k]) > SAME * there.speed) moved = 1;
    }
    if (!extended.match(site.atom, atom_mass(site.atom), state[site.body])) moved = 1;
  }
  int any = 0;
  MPI_Allreduce(&moved, &any, 1, MPI_INT, MPI_MAX, world);
  const Census found = compare_sites();
  if (any) refuse_tears(found);
  box.assign(domain->h, domain->h + 6);
  return !any && !found.mass_changed;
}

/// A census with places and masses.
Census Bodies::compare_sites() const
{
  std::vector<SiteCount> counts = count_sites(0);
  std::vector<SiteCount *> of_atom(atom->nlocal, nullptr);
  size_t n = 0;
  for (int i = 0; i < atom->nlocal; ++i)
    if (body_id[i] != 0) of_atom[i] = &counts[n++];
  for (const Site &site : sites) describe(site, *of_atom[site.atom]);
  return Census(lmp, counts, box.empty() ? nullptr : box.data());
}

void Bodies::describe(const Site &site, SiteCount &count) const
{
  const double *arm = site.arm_body, *axes = frame[site.body].axes;
  const double mass = atom_mass(site.atom), r2 = dot3(arm, arm);
  if (owned[site.atom] >= 0)
    std::copy_n(body[owned[site.atom]].rigid.inertia, 3, count.body_moments);
  const Placed there = placed(site);
  for (int k = 0; k < 3; ++k) {
    count.first[k] = mass * arm[k];
    count.expected[k] = there.x[k] + site.wrap[k];
    count.found[k] = atom->x[site.atom][k] + site.wrap[k];
  }
  double own_space[9] = {}, unused[3], own[9];
  if (extended.has_records()) extended.own_momenta(site.atom, mass, own_space, unused);
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) {
      double sum = 0.0;
      for (int m = 0; m < 9; ++m) sum += axes[3 * k + m / 3] * own_space[m] * axes[3 * l + m % 3];
      own[3 * k + l] = sum + mass * ((k == l ? r2 : 0.0) - arm[k] * arm[l]);
    }
  const int order[6] = {0, 4, 8, 1, 2, 5};
  for (int k = 0; k < 6; ++k) count.second[k] = own[order[k]];
}

void Bodies::refuse_tears(const Census &found) const
{
  if (found.torn)
    error->all(
        FLERR,
        "Fix gear/quat: some atoms of body {} are whole periods of the box away from where the "
        "others are; image flags of a body's atoms have to change together (set image, "
        "read_dump or rerun with ix iy iz), or define the fix after they have changed",
        found.torn);
  if (found.cut)
    error->all(
        FLERR,
        "Fix gear/quat: the box was changed while body {} lies across its faces, which tears "
        "it; use change_box with remap, or first move the body inside with displace_atoms",
        found.cut);
}

void Bodies::check_whole()
{
  const Census found = census(0);
  if (found.broken) {
    const std::string had = found.had
        ? fmt::format("has {} of its {} atoms left", found.left, found.had)
        : fmt::format("has {} of its atoms left, without its owner atom", found.left);
    error->all(FLERR,
               "Fix gear/quat: body {} {}; a body must be removed as a whole, and no atom "
               "of it may leave the box through a face that is not periodic",
               found.broken, had);
  }
  follow_atom_ids();
}

/// Owners may have got other atom IDs (reset_atoms id, delete_atoms compress yes): told to their sites.
void Bodies::follow_atom_ids()
{
  std::vector<tagint> changed;    // before and now
  for (int ibody = 0; ibody < nown; ++ibody) {
    const int owner = owner_atom[ibody];
    if (owner_tag[owner] != atom->tag[owner])
      changed.insert(changed.end(), {owner_tag[owner], atom->tag[owner]});
  }
  const std::vector<tagint> all = gather(changed, world);
  std::unordered_map<tagint, tagint> now;
  for (size_t n = 0; n < all.size(); n += 2) now[all[n]] = all[n + 1];
  for (int i = 0; i < atom->nlocal && !now.empty(); ++i) {
    const auto found = now.find(owner_tag[i]);
    if (in_body(i) && found != now.end()) owner_tag[i] = found->second;
  }
}

bigint Bodies::removed_freedoms(int groupbit)
{
  return census(groupbit).removed_freedoms;
}

Census Bodies::census(int groupbit) const
{
  std::vector<SiteCount> counts = count_sites(groupbit);
  return Census(lmp, counts);
}

/// In the order of the atoms.
std::vector<SiteCount> Bodies::count_sites(int groupbit) const
{
  std::vector<SiteCount> sites;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body_id[i] == 0) continue;
    SiteCount site = SiteCount();
    site.owner = owner_tag[i];
    site.id = body_id[i];
    site.in_group = (atom->mask[i] & groupbit) ? 1 : 0;
    site.mass = atom_mass(i);
    site.own_freedoms = extended.freedoms(i);
    if (owned[i] >= 0) {
      const Body &mine = body[owned[i]];
      site.natoms = mine.natoms;
      site.body_mass = mine.from_file ? 0.0 : mine.rigid.mass;
      site.freedoms = domain->dimension == 2 ? 2 + (mine.rigid.inertia[2] > 0.0)
                                             : 3 + mine.rigid.rotational_freedoms();
    }
    sites.push_back(site);
  }
  return sites;
}
