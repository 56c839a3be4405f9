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

/// A sum that carries what rounding takes off, so that a body of many atoms keeps its mass.
struct CarriedSum {
  double sum = 0.0, carried = 0.0;

  void add(double term)
  {
    const double next = sum + term;
    carried += std::fabs(sum) >= std::fabs(term) ? (sum - next) + term : (term - next) + sum;
    sum = next;
  }
  double value() const { return sum + carried; }
};

/// The atoms of a body on one rank, or on all; the owner's numbers are 0 where it is not among
/// them.
struct BodyCount {
  bigint natoms = 0;
  tagint smallest_id = MAXTAGINT, largest_id = 0;    ///< the user's, of the body
  bigint in_group = 0;                               ///< atoms in the group that is asked about
  bigint own_freedoms = 0;                           ///< rotational ones of the atoms themselves
  CarriedSum mass;

  // of the owner

  int rank = -1;
  bigint had = 0;            ///< atoms that the body had when it was made
  int freedoms = 0;          ///< of the body, translation and rotation
  double body_mass = 0.0;    ///< 0 unless masses have to add up to it

  // zero unless places and masses are compared with those that the body has

  double first[3] = {};                      ///< sum of mass times arm, body frame
  double second[6] = {};                     ///< xx, yy, zz, xy, xz, yz of the inertia, body frame
  double body_moments[3] = {};               ///< of the owner: principal moments
  double found[3] = {}, expected[3] = {};    ///< of the owner: unwrapped position, and where the
                                             ///< body has it

  void merge(const BodyCount &other);
};

/// The atoms of every body are counted.  Needs no ghost atoms, so it can be taken at any time; once
/// per run, not per step.  The same on all ranks; bodies are named by their IDs, 0 for none.
struct Census {
  bigint removed_freedoms = 0;    ///< that rigidity takes from bodies wholly in the group
  tagint broken = 0;              ///< a body that has lost atoms, or that several IDs name
  bigint left = 0, had = 0;       ///< its atoms now and before
  tagint mass_changed = 0;        ///< one whose atoms have another mass, center or inertia
  tagint torn = 0;                ///< one whose atoms are whole periods further apart than before
  tagint cut = 0;                 ///< one that another box has torn at the faces of the box

  explicit Census(const LAMMPS *lmp) : domain(lmp->domain), comm(lmp->comm), world(lmp->world) {}

  /// All atoms of a body.
  void count(const BodyCount &body);
  /// An atom has moved from `expected` to `found`, its owner is that of `body`.  box_before: shape
  /// of the box then, as Domain::h, null if it is not known.
  void look_for_tears(const BodyCount &body, const double *found, const double *expected,
                      const double *box_before);
  /// After the bodies of this rank.  Collective.
  void share();

 private:
  const Domain *domain;
  const Comm *comm;
  MPI_Comm world;

  bool same_masses(const BodyCount &body) const;
};

}    // namespace LAMMPS_NS::GearQuat

void BodyCount::merge(const BodyCount &other)
{
  natoms += other.natoms;
  smallest_id = std::min(smallest_id, other.smallest_id);
  largest_id = std::max(largest_id, other.largest_id);
  in_group += other.in_group;
  own_freedoms += other.own_freedoms;
  mass.add(other.mass.sum);
  mass.add(other.mass.carried);
  for (int k = 0; k < 3; ++k) first[k] += other.first[k];
  for (int k = 0; k < 6; ++k) second[k] += other.second[k];
  if (other.rank < 0) return;
  rank = other.rank;
  had += other.had;
  freedoms = other.freedoms;
  body_mass = other.body_mass;
  std::copy_n(other.body_moments, 3, body_moments);
  std::copy_n(other.found, 3, found);
  std::copy_n(other.expected, 3, expected);
}

void Census::count(const BodyCount &body)
{
  const tagint id = body.smallest_id;
  if (body.natoms != body.had || id != body.largest_id) {
    broken = id;
    left = body.natoms;
    had = body.had;
  }
  if (body.rank != comm->me) return;
  const double mass = body.mass.value();
  if (body.body_mass > 0.0 &&
      (std::fabs(mass - body.body_mass) > SAME_MASS * body.body_mass || !same_masses(body)))
    mass_changed = id;
  if (body.in_group == body.natoms)
    removed_freedoms += domain->dimension * body.natoms + body.own_freedoms - body.freedoms;
}

void Census::share()
{
  removed_freedoms = over_ranks(MPI_SUM, removed_freedoms, world);
  const tagint broken_here = broken;
  broken = over_ranks(MPI_MAX, broken, world);
  if (broken_here != broken) left = had = 0;
  bigint here[] = {left, had, mass_changed, torn, cut};
  const auto all = over_ranks(MPI_MAX, here, world);
  left = all[0];
  had = all[1];
  mass_changed = (tagint) all[2];
  torn = (tagint) all[3];
  cut = (tagint) all[4];
}

/// Center and principal moments change if masses move from one atom of a body to another.
bool Census::same_masses(const BodyCount &body) const
{
  const double *moments = body.body_moments, *second = body.second;
  const double trace = second[0] + second[1] + second[2];
  const double size = std::sqrt(trace / body.body_mass);
  const double rounding =
      ROUNDING * (domain->xprd + domain->yprd + domain->zprd + length(body.found));
  const double limit = body.body_mass * (SAME_MOMENTS * size + rounding);
  for (int k = 0; k < 3; ++k) {
    const double vanishing = moments[k] > 0.0 ? 0.0 : 2.0 * LINEAR_FRACTION * trace;
    if (std::fabs(body.first[k]) > limit) return false;
    if (std::fabs(second[k] - moments[k]) > limit * size + vanishing) return false;
    if (std::fabs(second[3 + k]) > limit * size) return false;
  }
  return true;
}

/// The user may have moved, rotated or deformed a body between two runs.  It is torn if its atoms
/// are whole periods further apart than before, or if parts of it have moved with the faces of the
/// box.
void Census::look_for_tears(const BodyCount &body, const double *found, const double *expected,
                            const double *box_before)
{
  double before[3], now[3], change[3];
  for (int k = 0; k < 3; ++k) {
    before[k] = expected[k] - body.expected[k];
    now[k] = found[k] - body.found[k];
    change[k] = now[k] - before[k];
  }
  const double further = length(now) - length(before);
  if (whole_periods_away(domain, change, further)) torn = body.smallest_id;
  if (box_before && moved_with_faces(domain, box_before, change)) cut = body.smallest_id;
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
  const Parts parts(comm, owner_tag.data(), atom->nlocal);
  std::vector<BodyCount> counts = count_atoms(parts, 0);
  std::vector<int> part_of(body.size(), -1);
  for (const Site &site : sites) {
    int &part = part_of[site.body];
    if (part < 0) part = parts.find(owner_tag[site.atom]);
    describe(site, counts[part]);
  }
  parts.merge(counts);
  Census census(lmp);
  for (const auto &count : counts) census.count(count);
  for (const Site &site : sites) {
    double found[3], expected[3];
    find_place(site, found, expected);
    census.look_for_tears(counts[part_of[site.body]], found, expected,
                          box.empty() ? nullptr : box.data());
  }
  census.share();
  return census;
}

/// Unwrapped positions: of the atom, and where its body has it.
void Bodies::find_place(const Site &site, double *found, double *expected) const
{
  const Expected there = expected_position(site);
  for (int k = 0; k < 3; ++k) {
    expected[k] = there.value[k] + site.wrap[k];
    found[k] = atom->x[site.atom][k] + site.wrap[k];
  }
}

/// Adds masses and place of an atom to the count of its body.
void Bodies::describe(const Site &site, BodyCount &count) const
{
  const double *arm = site.arm_body, *axes = frame[site.body].axes;
  const double mass = atom_mass(site.atom), r2 = dot3(arm, arm);
  if (owned[site.atom] >= 0) {
    std::copy_n(body[owned[site.atom]].rigid.inertia, 3, count.body_moments);
    find_place(site, count.found, count.expected);
  }
  for (int k = 0; k < 3; ++k) count.first[k] += mass * arm[k];
  static constexpr int ROW[6] = {0, 1, 2, 0, 0, 1}, COLUMN[6] = {0, 1, 2, 1, 2, 2};
  for (int m = 0; m < 6; ++m) {
    const int k = ROW[m], l = COLUMN[m];
    count.second[m] += mass * ((k == l ? r2 : 0.0) - arm[k] * arm[l]);
  }
  if (!extended.has_records()) return;
  double own_space[9], unused[3];
  extended.own_momenta(site.atom, mass, own_space, unused);
  for (int m = 0; m < 6; ++m)
    for (int n = 0; n < 9; ++n)
      count.second[m] += axes[3 * ROW[m] + n / 3] * own_space[n] * axes[3 * COLUMN[m] + n % 3];
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
  const Parts parts(comm, owner_tag.data(), atom->nlocal);
  std::vector<BodyCount> counts = count_atoms(parts, groupbit);
  parts.merge(counts);
  Census census(lmp);
  for (const auto &count : counts) census.count(count);
  census.share();
  return census;
}

/// The atoms of this rank.
std::vector<BodyCount> Bodies::count_atoms(const Parts &parts, int groupbit) const
{
  std::vector<BodyCount> counts(parts.number());
  for (int part = 0; part < parts.number(); ++part) {
    BodyCount &count = counts[part];
    for (const int i : parts.atoms(part)) {
      ++count.natoms;
      count.smallest_id = std::min(count.smallest_id, body_id[i]);
      count.largest_id = std::max(count.largest_id, body_id[i]);
      count.in_group += (atom->mask[i] & groupbit) ? 1 : 0;
      count.own_freedoms += extended.freedoms(i);
      count.mass.add(atom_mass(i));
      if (owned[i] < 0) continue;
      const Body &mine = body[owned[i]];
      count.rank = comm->me;
      count.had += mine.natoms;
      count.body_mass = mine.from_file ? 0.0 : mine.rigid.mass;
      count.freedoms = mine.rigid.freedoms(domain->dimension);
    }
  }
  return counts;
}
