/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Comparison of the atoms of all bodies with the data of the bodies: number, masses and positions.
   Once per run, not per step. */

#include "gear_quat_sites.h"

#include "gear_quat_images.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double SAME_MASS = 1.0e-11;      // relative; sums run in another order
static constexpr double SAME_MOMENTS = 1.0e-9;    // relative; arms have the rounding of positions
static constexpr double ROUNDING = 1.0e-13;       // of positions
static constexpr double SAME_SHAPE = 1.0e-3;      // of distances; files may have few digits
static constexpr double SAME_PLACE = 1.0e-6;      // of positions

/* ----------------------------------------------------------------------
   counts of the atoms of all bodies
------------------------------------------------------------------------- */

namespace {

/// A sum with a carry for rounding errors, so that the mass of a body with many atoms is accurate.
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

/// The atoms of a body on one rank, or on all; numbers of the owner are 0 on other ranks.
struct AtomsOfBody {
  bigint natoms = 0;
  tagint smallest_id = MAXTAGINT, largest_id = 0;    ///< the user's, of the body
  bigint in_group = 0;                               ///< atoms in the group of the request
  bigint own_freedoms = 0;                           ///< rotations of the atoms themselves
  CarriedSum mass;

  // of the owner

  int rank = -1;
  bigint had = 0;            ///< atoms that the body had when it was made
  int freedoms = 0;          ///< of the body, translation and rotation
  double body_mass = 0.0;    ///< 0 unless the sum of masses must match it

  // zero unless positions and masses are compared with the body

  double first[3] = {};                      ///< sum of mass times arm, body frame
  double second[6] = {};                     ///< xx, yy, zz, xy, xz, yz of the inertia, body frame
  double body_moments[3] = {};               ///< of the owner: principal moments
  double found[3] = {}, expected[3] = {};    ///< of the owner: unwrapped position, actual and
                                             ///< according to the body

  void merge(const AtomsOfBody &other);
};

/// Compares body by body; all() returns the results of all ranks.
class Comparer : protected Pointers {
 public:
  /// Counts the atoms of this rank.
  Comparer(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership, int groupbit);

  /// Adds masses and positions of atoms to the counts.
  void describe(const Sites &sites);
  /// Merges the counts over all ranks that have atoms of a body, and compares them with the bodies.
  /// Collective.
  void merge();
  /// Examines the positions of sites in whole bodies.
  void look_for_tears(const Sites &sites);
  /// Collective.
  Comparison all();

 private:
  const Bodies &bodies;
  const Ownership &ownership;
  Parts parts;
  std::vector<AtomsOfBody> counts;
  std::vector<int> part_of;    ///< the part of each body on this rank, if positions are compared
  Comparison found;

  void count_atom(int i, int groupbit, AtomsOfBody &count) const;
  void describe(const Sites &sites, const Site &site, AtomsOfBody &count) const;
  void compare(const AtomsOfBody &body);
  bool same_masses(const AtomsOfBody &body) const;
  void look_for_tears(const AtomsOfBody &body, const double *there, const double *expected);
};

}    // namespace

void AtomsOfBody::merge(const AtomsOfBody &other)
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

/* ---------------------------------------------------------------------- */

Comparer::Comparer(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership, int groupbit) :
    Pointers(lmp), bodies(bodies), ownership(ownership),
    parts(lmp->comm, lmp->world, ownership.owner_tags().data(), lmp->atom->nlocal),
    counts(parts.number())
{
  for (int part = 0; part < parts.number(); ++part)
    for (const int i : parts.atoms(part)) count_atom(i, groupbit, counts[part]);
}

void Comparer::count_atom(int i, int groupbit, AtomsOfBody &count) const
{
  ++count.natoms;
  count.smallest_id = std::min(count.smallest_id, ownership.id_of(i));
  count.largest_id = std::max(count.largest_id, ownership.id_of(i));
  count.in_group += (atom->mask[i] & groupbit) ? 1 : 0;
  count.own_freedoms += ownership.extended().freedoms(i);
  count.mass.add(ownership.mass_of(i));
  const int ibody = ownership.owned_by(i);
  if (ibody < 0) return;
  const Body &mine = bodies.body_at(ibody);
  count.rank = comm->me;
  count.had += mine.natoms;
  count.body_mass = mine.from_file ? 0.0 : mine.rigid.mass;
  count.freedoms = mine.rigid.freedoms(domain->dimension);
}

void Comparer::describe(const Sites &sites)
{
  part_of.assign(bodies.nhere(), -1);
  for (const Site &site : sites) {
    int &part = part_of[site.body];
    if (part < 0) part = parts.find(ownership.owner_tag(site.atom));
    describe(sites, site, counts[part]);
  }
}

void Comparer::describe(const Sites &sites, const Site &site, AtomsOfBody &count) const
{
  const double *arm = site.arm_body, *axes = bodies.axes(site.body);
  const double mass = ownership.mass_of(site.atom), r2 = dot3(arm, arm);
  const int ibody = ownership.owned_by(site.atom);
  if (ibody >= 0) {
    std::copy_n(bodies.rigid_of(ibody).inertia, 3, count.body_moments);
    sites.unwrapped(site, count.found, count.expected);
  }
  for (int k = 0; k < 3; ++k) count.first[k] += mass * arm[k];
  static constexpr int ROW[6] = {0, 1, 2, 0, 0, 1}, COLUMN[6] = {0, 1, 2, 1, 2, 2};
  for (int m = 0; m < 6; ++m) {
    const int k = ROW[m], l = COLUMN[m];
    count.second[m] += mass * ((k == l ? r2 : 0.0) - arm[k] * arm[l]);
  }
  if (!ownership.extended().has_records()) return;
  double own_space[9], unused[3];
  ownership.extended().own_momenta(site.atom, mass, own_space, unused);
  for (int m = 0; m < 6; ++m)
    for (int n = 0; n < 9; ++n)
      count.second[m] += axes[3 * ROW[m] + n / 3] * own_space[n] * axes[3 * COLUMN[m] + n % 3];
}

void Comparer::merge()
{
  parts.merge(counts);
  for (const auto &count : counts) compare(count);
}

void Comparer::compare(const AtomsOfBody &body)
{
  const tagint id = body.smallest_id;
  if (body.natoms != body.had || id != body.largest_id) {
    found.broken = id;
    found.left = body.natoms;
    found.had = body.had;
  }
  if (body.rank != comm->me) return;
  const double mass = body.mass.value();
  if (body.body_mass > 0.0 &&
      (std::fabs(mass - body.body_mass) > SAME_MASS * body.body_mass || !same_masses(body)))
    found.mass_changed = id;
  if (body.in_group > 0 && body.in_group < body.natoms) found.divided = id;
  if (body.in_group == body.natoms)
    found.removed_freedoms += domain->dimension * body.natoms + body.own_freedoms - body.freedoms;
}

/// Center and principal moments change if mass moves from one atom of a body to another.
bool Comparer::same_masses(const AtomsOfBody &body) const
{
  const double *moments = body.body_moments, *second = body.second;
  const double trace = second[0] + second[1] + second[2];
  const double size = std::sqrt(trace / body.body_mass);
  const double rounding =
      ROUNDING * (domain->xprd + domain->yprd + domain->zprd + length(body.found));
  const double limit = body.body_mass * (SAME_MOMENTS * size + rounding);
  const int pairs = domain->dimension == 2 ? 1 : 3;    // of axes: without z
  for (int k = 0; k < 3; ++k) {
    const double vanishing = moments[k] > 0.0 ? 0.0 : 2.0 * LINEAR_FRACTION * trace;
    if (std::fabs(body.first[k]) > limit) return false;
    if (std::fabs(second[k] - moments[k]) > limit * size + vanishing) return false;
    if (k < pairs && std::fabs(second[3 + k]) > limit * size) return false;
  }
  return true;
}

void Comparer::look_for_tears(const Sites &sites)
{
  for (const Site &site : sites) {
    double there[3], expected[3];
    sites.unwrapped(site, there, expected);
    look_for_tears(counts[part_of[site.body]], there, expected);
  }
}

/// The user may have moved, rotated or deformed a body between two runs.  It is torn if its atoms
/// are whole periods further apart than before, or if parts of it have moved with the faces of the
/// box.
void Comparer::look_for_tears(const AtomsOfBody &body, const double *there, const double *expected)
{
  double before[3], now[3], change[3];
  for (int k = 0; k < 3; ++k) {
    before[k] = expected[k] - body.expected[k];
    now[k] = there[k] - body.found[k];
    change[k] = now[k] - before[k];
  }
  const double further = length(now) - length(before);
  const double few = SAME_MOMENTS * (domain->xprd + domain->yprd + domain->zprd);
  if (std::fabs(further) > SAME_SHAPE * length(before) + few) found.reshaped = body.smallest_id;
  if (whole_periods_away(domain, change, further)) found.torn = body.smallest_id;
  if (moved_with_faces(domain, ownership.box().data(), change)) found.cut = body.smallest_id;
}

Comparison Comparer::all()
{
  Comparison all = found;
  all.removed_freedoms = over_ranks(MPI_SUM, found.removed_freedoms, world);
  all.broken = over_ranks(MPI_MAX, found.broken, world);
  if (found.broken != all.broken) all.left = all.had = 0;
  bigint here[] = {all.left,  all.had,        found.mass_changed, found.torn,
                   found.cut, found.reshaped, found.divided};
  const auto largest = over_ranks(MPI_MAX, here, world);
  all.left = largest[0];
  all.had = largest[1];
  all.mass_changed = (tagint) largest[2];
  all.torn = (tagint) largest[3];
  all.cut = (tagint) largest[4];
  all.reshaped = (tagint) largest[5];
  all.divided = (tagint) largest[6];
  return all;
}

/* ---------------------------------------------------------------------- */

Comparison Ownership::count_atoms(int groupbit) const
{
  Comparer comparer(lmp, bodies, *this, groupbit);
  comparer.merge();
  return comparer.all();
}

static void refuse_tears(Error *error, const Comparison &found)
{
  if (found.torn)
    error->all(
        FLERR,
        "Fix gear/quat: some atoms of body {} are displaced from the others by whole periods of "
        "the box; image flags of a body's atoms have to change together (set image, read_dump or "
        "rerun with ix iy iz), or define the fix after they have changed",
        found.torn);
  if (found.cut)
    error->all(
        FLERR,
        "Fix gear/quat: the box was changed while body {} lies across its faces, which tears "
        "it; use change_box with remap, or first move the body inside with displace_atoms",
        found.cut);
}

bool Sites::match_bodies() const
{
  int moved = 0;
  for (const Site &site : sites)
    if (!is_there(site) || !is_as_fast(site) ||
        !ownership.extended().match(site.atom, ownership.mass_of(site.atom),
                                    bodies.state_of(site.body)))
      moved = 1;
  const int any = over_ranks(MPI_MAX, moved, world);
  Comparer comparer(lmp, bodies, ownership, 0);
  comparer.describe(*this);
  comparer.merge();
  comparer.look_for_tears(*this);
  const Comparison found = comparer.all();
  if (any) refuse_tears(error, found);
  if (any && found.reshaped && comm->me == 0)
    error->warning(
        FLERR,
        "Fix gear/quat: atoms of body {} were moved relative to each other since the fix "
        "was defined or last ran, as by displace_atoms or set on single atoms; the body "
        "is made again with this other shape",
        found.reshaped);
  return !any && !found.mass_changed;
}

void Sites::warn_of_other_places() const
{
  tagint atoms[2] = {0, 0};    // an atom, and its body
  for (const Site &site : sites) {
    const Expected there = expected_position(site);
    for (int k = 0; k < 3; ++k)
      if (std::fabs(atom->x[site.atom][k] - there.value[k]) > SAME_PLACE * there.size &&
          atom->tag[site.atom] > atoms[0]) {
        atoms[0] = atom->tag[site.atom];
        atoms[1] = ownership.id_of(site.atom);
      }
  }
  const tagint moved = over_ranks(MPI_MAX, atoms[0], world);
  const tagint body = over_ranks(MPI_MAX, moved == atoms[0] ? atoms[1] : 0, world);
  if (moved && comm->me == 0)
    error->warning(
        FLERR,
        "Fix gear/quat: atom {} was moved away from its place in body {}, and with reinit "
        "no, or infile, the body puts it back in the first step; use reinit yes, or "
        "define the fix after the change",
        moved, body);
}
