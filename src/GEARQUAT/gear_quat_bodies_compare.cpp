/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Body store, before a run: the atoms compared with what bodies know of them. */

#include "gear_quat_bodies.h"

#include "gear_quat_images.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
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

static constexpr double SAME_MASS = 1.0e-11;      // relative; sums run in another order
static constexpr double SAME_MOMENTS = 1.0e-9;    // relative; arms have the rounding of positions
static constexpr double ROUNDING = 1.0e-13;       // of positions

/* ----------------------------------------------------------------------
   the atoms of all bodies counted
------------------------------------------------------------------------- */

namespace LAMMPS_NS::GearQuat {

/// One atom of a body.
struct SiteCount {
  tagint owner, id;    ///< atom ID of the body's owner, the user's ID of the body
  tagint natoms;       ///< of the body, 0 unless this atom is its owner
  int freedoms;        ///< of the body, translation and rotation; 0 unless this atom is its owner
  int own_freedoms;    ///< rotational ones of the atom itself
  int in_group;        ///< 1 if the atom is in the group that is asked about
  double mass;
  double body_mass;    ///< 0 unless this atom is the owner and masses have to add up to it

  // zero unless places and masses are compared with those that the body has

  double body_moments[3];    ///< principal moments; of the owner
  double first[3];           ///< mass times the arm, body frame
  double second[6];          ///< what it adds to xx, yy, zz, xy, xz, yz of the inertia, body frame
  double found[3], expected[3];    ///< unwrapped positions: of the atom, and where the body has it
};

/// The sites of every body meet on one rank, which the atom ID of the owner names, and are counted.
/// Needs no ghost atoms, so it can be taken at any time; once per run, not per step.  The same on
/// all ranks; bodies are named by their IDs, 0 for none.
struct Census {
  bigint removed_freedoms = 0;    ///< that rigidity takes from bodies wholly in the group
  tagint broken = 0;              ///< a body that has lost atoms, or that several IDs name
  tagint left = 0, had = 0;       ///< its atoms now and before
  tagint mass_changed = 0;        ///< one whose atoms have another mass, center or inertia
  tagint torn = 0;                ///< one whose atoms are whole periods further apart than before
  tagint cut = 0;                 ///< one that another box has torn at the faces of the box

  /// Collective; mine: the sites of this rank's atoms.  box: shape of the box before, as Domain::h,
  /// null if it is not known or not asked for.
  Census(LAMMPS *lmp, const std::vector<SiteCount> &mine, const double *box = nullptr);

 private:
  const Domain *domain;
  const double *box_before;

  void count_body(const SiteCount *sites, int n);
  bool same_masses(const SiteCount *sites, int n, const SiteCount &owner) const;
  void look_for_tears(const SiteCount *sites, int n, const SiteCount &owner);
};

}    // namespace LAMMPS_NS::GearQuat

Census::Census(LAMMPS *lmp, const std::vector<SiteCount> &mine, const double *box) :
    domain(lmp->domain), box_before(box)
{
  std::vector<int> ranks;
  for (const auto &site : mine) ranks.push_back((int) (site.owner % lmp->comm->nprocs));
  std::vector<SiteCount> sites = send_to_ranks(lmp->comm, mine, ranks);
  std::sort(sites.begin(), sites.end(), [](const SiteCount &a, const SiteCount &b) {
    return a.owner < b.owner;
  });
  const int n = (int) sites.size();
  for (int first = 0, last; first < n; first = last) {
    for (last = first; last < n && sites[last].owner == sites[first].owner;) ++last;
    count_body(&sites[first], last - first);
  }

  removed_freedoms = over_ranks(MPI_SUM, removed_freedoms, lmp->world);
  const tagint broken_here = broken;
  broken = over_ranks(MPI_MAX, broken, lmp->world);
  if (broken_here != broken) left = had = 0;
  tagint here[] = {left, had, mass_changed, torn, cut};
  const auto all = over_ranks(MPI_MAX, here, lmp->world);
  left = all[0];
  had = all[1];
  mass_changed = all[2];
  torn = all[3];
  cut = all[4];
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
  if (body_mass > 0.0 && std::fabs(mass - body_mass) > SAME_MASS * body_mass)
    mass_changed = sites[0].id;
  if (owner && body_mass > 0.0 && !same_masses(sites, n, *owner)) mass_changed = owner->id;
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
  const double rounding = ROUNDING * (domain->xprd + domain->yprd + domain->zprd + length(x));
  const double limit = owner.body_mass * (SAME_MOMENTS * size + rounding);
  for (int k = 0; k < 3; ++k) {
    const double vanishing = moments[k] > 0.0 ? 0.0 : 2.0 * LINEAR_FRACTION * trace;
    if (std::fabs(first[k]) > limit) return false;
    if (std::fabs(second[k] - moments[k]) > limit * size + vanishing) return false;
    if (std::fabs(second[3 + k]) > limit * size) return false;
  }
  return true;
}

/// The user may have moved, rotated or deformed a body between two runs.  It is torn if its atoms
/// are whole periods further apart than before, or if parts of it have moved with the faces of the
/// box.
void Census::look_for_tears(const SiteCount *sites, int n, const SiteCount &owner)
{
  for (int i = 0; i < n; ++i) {
    double before[3], now[3], change[3];
    for (int k = 0; k < 3; ++k) {
      before[k] = sites[i].expected[k] - owner.expected[k];
      now[k] = sites[i].found[k] - owner.found[k];
      change[k] = now[k] - before[k];
    }
    const double further = length(now) - length(before);
    if (whole_periods_away(domain, change, further)) torn = owner.id;
    if (box_before && moved_with_faces(domain, box_before, change)) cut = owner.id;
  }
}

/* ----------------------------------------------------------------------
   what this rank knows of its atoms
------------------------------------------------------------------------- */

Bodies::Expected Bodies::expected_position(const Site &site) const
{
  const double box = std::max({domain->xprd, domain->yprd, domain->zprd});
  const double *center = state[site.body].center;
  double arm[3];
  Expected x;
  to_space(frame[site.body].axes, site.arm_body, arm);
  for (int k = 0; k < 3; ++k) x.value[k] = center[k] + arm[k] - site.wrap[k];
  x.size = box + std::sqrt(dot3(center, center) + dot3(site.wrap, site.wrap));
  return x;
}

Bodies::Expected Bodies::expected_velocity(const Site &site) const
{
  const double *velocity = state[site.body].velocity;
  double arm[3], spin[3];
  Expected v;
  to_space(frame[site.body].axes, site.arm_body, arm);
  cross3(frame[site.body].omega_space, arm, spin);
  for (int k = 0; k < 3; ++k) v.value[k] = velocity[k] + spin[k];
  v.size = length(velocity) + length(spin);
  return v;
}

static bool same(const double *a, const Bodies::Expected &expected)
{
  for (int k = 0; k < 3; ++k)
    if (!(std::fabs(a[k] - expected.value[k]) <= SAME * expected.size)) return false;
  return true;
}

bool Bodies::is_there(const Site &site) const
{
  return same(atom->x[site.atom], expected_position(site));
}

bool Bodies::is_as_fast(const Site &site) const
{
  return same(atom->v[site.atom], expected_velocity(site));
}

bool Bodies::atoms_match()
{
  int moved = 0;
  for (const Site &site : sites)
    if (!is_there(site) || !is_as_fast(site) ||
        !extended.match(site.atom, atom_mass(site.atom), state[site.body]))
      moved = 1;
  const int any = over_ranks(MPI_MAX, moved, world);
  const Census found = compare_sites();
  if (any) refuse_tears(found);
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
  const Expected there = expected_position(site);
  for (int k = 0; k < 3; ++k) {
    count.first[k] = mass * arm[k];
    count.expected[k] = there.value[k] + site.wrap[k];
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

Bodies::Resumed Bodies::resume(const std::vector<const double *> &packed, bool with_extended,
                               int group)
{
  const std::vector<tagint> ids(body_id.begin(),
                                body_id.begin() + atom->nlocal);    // as the command has them
  const bigint expected = nbodies;
  clear(with_extended);
  int here[2] = {0, 0};    // atoms that are in a body only here, only in the file
  for (int i = 0; i < atom->nlocal; ++i) {
    if (packed[i]) unpack_exchange(i, packed[i]);
    if (group && !(atom->mask[i] & group)) continue;
    if (body_id[i] == 0 && ids[i] != 0) here[0] = 1;
    if (body_id[i] != 0 && ids[i] == 0) here[1] = 1;
    body_id[i] = ids[i];
    if (owned[i] >= 0) body[owned[i]].id = ids[i];
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body_id[i] != 0) continue;    // left out, or in no body
    if (owned[i] >= 0) remove_owned(owned[i]);
    set_arrays(i);
  }
  count();
  const auto any = over_ranks(MPI_MAX, here, world);
  if (!any[0] && !census(0).broken && (group || nbodies == expected))
    return any[1] ? Resumed::FEWER : Resumed::ALL;
  clear();
  return Resumed::NONE;
}

/// Owners may have got other atom IDs (reset_atoms id, delete_atoms compress yes): told to their
/// sites.
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
  return Census(lmp, count_sites(groupbit));
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
      site.freedoms = mine.rigid.freedoms(domain->dimension);
    }
    sites.push_back(site);
  }
  return sites;
}
