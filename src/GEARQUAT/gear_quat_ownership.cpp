/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies travel as streams of doubles: between ranks, to ghosts, and in restart files.  Some sites of
   large bodies cannot find their owner atom.  After an exchange of atoms their owners send them to
   all ranks, with their histories.  From then on every rank predicts and corrects large bodies, from
   the same loads and thus to the same bits.  The only message in a step is the sum of the loads. */

#include "gear_quat_ownership.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

Ownership::Ownership(LAMMPS *lmp, Fix *fix, Bodies &bodies) :
    Pointers(lmp), fix(fix), bodies(bodies), records(lmp)
{
  if (atom->map_style == Atom::MAP_NONE)
    error->all(FLERR,
               "Fix gear/quat requires an atom map: write atom_modify map yes before the box is "
               "created");
  if (!atom->tag_enable) error->all(FLERR, "Fix gear/quat requires atom IDs");
  grow_arrays(atom->nmax);
  clear();
}

double Ownership::mass_of(int i) const
{
  return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
}

/// On a single rank ghosts are images of its atoms; on several ranks ghosts receive the IDs.
tagint Ownership::id_of(int i) const
{
  return assigned[i < atom->nlocal ? i : atom->map(atom->tag[i])].id;
}

/* ----------------------------------------------------------------------
   life cycle
------------------------------------------------------------------------- */

void Ownership::clear(bool with_extended)
{
  large.clear();
  bodies.clear();
  owner_atom.clear();
  index.clear();
  records.reset(with_extended, (int) assigned.size());
  for (size_t i = 0; i < assigned.size(); ++i) set_arrays(i);
}

void Ownership::create(const std::vector<tagint> &ids, const GivenBodies &given)
{
  clear();
  add(ids, given, false);
}

void Ownership::count()
{
  bigint here[2] = {bodies.nowned(), 0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) here[1] += bodies.body[ibody].natoms;
  const auto all = over_ranks(MPI_SUM, here, world);
  bodies.set_number(all[0]);
  natoms = all[1];
  note_box();
}

void Ownership::note_box()
{
  last_box.assign(domain->h, domain->h + 6);
  last_box.insert(last_box.end(), domain->boxlo, domain->boxlo + 3);
}

void Ownership::add(const std::vector<tagint> &ids, const GivenBodies &given, bool fresh)
{
  std::vector<int> atoms;
  for (int i = 0; i < atom->nlocal; ++i)
    if (ids[i] != 0) atoms.push_back(i);
  records.refuse(atoms);
  const bool any_extended = records.any(atoms);
  if (any_extended && !records.has_records()) records.reset(true, (int) assigned.size());

  const auto act = [&](const AssembledBody &one, int i, const double *arm_body) {
    assigned[i].id = one.body.id;
    assigned[i].owner = one.owner;
    assigned[i].mass = mass_of(i);
    std::copy_n(arm_body, 3, assigned[i].arm);
    if (any_extended) records.attach(i, mass_of(i), one.state.q);
  };
  for (const auto &one : assemble(lmp, given, any_extended ? &records : nullptr, ids, act)) {
    if (one.owner_rank != comm->me) continue;
    const int ibody = add_owned(one.local);
    bodies.body[ibody] = one.body;
    bodies.body[ibody].fresh = fresh;
    bodies.state[ibody] = one.state;
  }
  count();
}

void Ownership::recreate()
{
  constexpr double PART = 0.25;             // of a period, by which an arm grows if flags are wrong
  constexpr double SAME_SHAPE = 1.0e-3;     // of distances; files may have few digits
  constexpr double SAME_LENGTH = 1.0e-9;    // of the box
  std::vector<tagint> ids(atom->nlocal);
  std::vector<double> before(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i) {
    ids[i] = assigned[i].id;
    before[i] = length(assigned[i].arm);
  }
  const bool same_box = std::equal(domain->h, domain->h + 6, last_box.begin());
  create(ids, GivenBodies());

  const double few = SAME_LENGTH * (domain->xprd + domain->yprd + domain->zprd);
  double far = HUGE_VAL;
  for (int k = 0; k < domain->dimension; ++k)
    if (domain->periodicity[k]) far = std::min(far, PART * domain->prd[k]);
  tagint changed = 0;
  for (int i = 0; i < atom->nlocal; ++i) {
    const double further = length(assigned[i].arm) - before[i];
    if (further > far || (!same_box && std::fabs(further) > SAME_SHAPE * before[i] + few))
      changed = ids[i];
  }
  changed = over_ranks(MPI_MAX, changed, world);
  if (changed)
    error->all(
        FLERR,
        "Fix gear/quat: body {} has another shape than before: some of its atoms were displaced, "
        "{}; to keep this shape, define the fix after the change",
        changed,
        same_box
            ? "or their image flags did not change together (set image, read_dump or rerun with "
              "ix iy iz)"
            : "or change_box moved each atom by itself, while fix deform moves bodies as a whole");
}

bool Ownership::resume(const std::vector<const double *> &packed, bool with_extended, int group)
{
  std::vector<tagint> ids;    // numbered by the command
  for (int i = 0; i < atom->nlocal; ++i) ids.push_back(assigned[i].id);
  const bigint expected = bodies.number();
  clear(with_extended);
  int differs = 0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (packed[i]) unpack_exchange(i, packed[i]);
    if (group && !(atom->mask[i] & group)) continue;
    Assigned &one = assigned[i];
    if ((one.id == 0) != (ids[i] == 0)) differs = 1;
    one.id = ids[i];
    if (one.owned >= 0) bodies.body[one.owned].id = ids[i];
  }
  count();
  const bool whole = !count_atoms().broken;
  differs = over_ranks(MPI_MAX, differs, world);
  if (!differs && whole && (group || bodies.number() == expected)) return true;
  clear();
  return false;
}

void Ownership::check_whole()
{
  if (const tagint broken = count_atoms().broken)
    error->all(FLERR,
               "Fix gear/quat: body {} has lost some of its atoms; a body must be removed as a "
               "whole, no edge of a box at constant pressure may become shorter than it, and no "
               "atom of it may leave the box through a face that is not periodic, as it does if "
               "the time step is too long or atoms overlap",
               broken);
  follow_atom_ids();
}

/// Owners may have new atom IDs (reset_atoms id, delete_atoms compress yes): sends them to their
/// sites.
void Ownership::follow_atom_ids()
{
  std::vector<tagint> changed;    // before and now
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const tagint before = assigned[owner_atom[ibody]].owner, now = atom->tag[owner_atom[ibody]];
    if (before != now) changed.insert(changed.end(), {before, now});
  }
  const std::vector<tagint> all = gather(changed, world);
  std::unordered_map<tagint, tagint> now;
  for (size_t n = 0; n < all.size(); n += 2) now[all[n]] = all[n + 1];
  for (int i = 0; i < atom->nlocal && !now.empty(); ++i) {
    const auto found = now.find(assigned[i].owner);
    if (in_body(i) && found != now.end()) assigned[i].owner = found->second;
  }
}

/* ----------------------------------------------------------------------
   comparison with the atoms
------------------------------------------------------------------------- */

namespace {

/// The atoms of a body on one rank, or on all; the data of its owner are 0 on other ranks.
struct AtomsOfBody {
  bigint natoms = 0;
  tagint smallest_id = MAXTAGINT, largest_id = 0;    ///< the user's, of the body
  bigint in_group = 0;                               ///< atoms in the group of the request
  bigint own_freedoms = 0;                           ///< rotations of the atoms themselves
  bigint had = 0, freedoms = 0;    ///< of the owner: atoms when the body was made, its freedoms

  void merge(const AtomsOfBody &other)
  {
    natoms += other.natoms;
    smallest_id = std::min(smallest_id, other.smallest_id);
    largest_id = std::max(largest_id, other.largest_id);
    in_group += other.in_group;
    own_freedoms += other.own_freedoms;
    had += other.had;
    freedoms += other.freedoms;
  }
};

}    // namespace

Comparison Ownership::count_atoms(int groupbit) const
{
  std::vector<tagint> owners;
  for (int i = 0; i < atom->nlocal; ++i) owners.push_back(assigned[i].owner);
  const Parts parts(comm, world, owners.data(), atom->nlocal);
  std::vector<AtomsOfBody> counts(parts.number());
  std::vector<int> owns(parts.number(), 0);
  for (int part = 0; part < parts.number(); ++part) {
    AtomsOfBody &count = counts[part];
    for (const int i : parts.atoms(part)) {
      ++count.natoms;
      count.smallest_id = std::min(count.smallest_id, id_of(i));
      count.largest_id = std::max(count.largest_id, id_of(i));
      count.in_group += (atom->mask[i] & groupbit) ? 1 : 0;
      count.own_freedoms += records.freedoms(i);
      if (owned_by(i) < 0) continue;
      const Body &mine = bodies.body[owned_by(i)];
      count.had = mine.natoms;
      count.freedoms = mine.rigid.freedoms(domain->dimension);
      owns[part] = 1;
    }
  }
  parts.merge(counts);

  Comparison found = {0, 0, 0};
  for (int part = 0; part < parts.number(); ++part) {
    const AtomsOfBody &body = counts[part];
    if (body.natoms != body.had || body.smallest_id != body.largest_id)
      found.broken = body.smallest_id;
    if (!owns[part]) continue;
    if (body.in_group > 0 && body.in_group < body.natoms) found.divided = body.smallest_id;
    if (body.in_group == body.natoms)
      found.removed_freedoms += domain->dimension * body.natoms + body.own_freedoms - body.freedoms;
  }
  tagint here[2] = {found.divided, found.broken};
  const auto largest = over_ranks(MPI_MAX, here, world);
  return {over_ranks(MPI_SUM, found.removed_freedoms, world), largest[0], largest[1]};
}

/* ----------------------------------------------------------------------
   ownership
------------------------------------------------------------------------- */

void Ownership::drop_copies()
{
  bodies.drop_copies();
  large.clear();
}

int Ownership::add_owned(int atom)
{
  drop_copies();
  const int ibody = bodies.add_owned();
  owner_atom.push_back(atom);
  return assigned[atom].owned = ibody;
}

void Ownership::remove_owned(int ibody)
{
  drop_copies();
  bodies.remove_owned(ibody);
  assigned[owner_atom.back()].owned = ibody;
  assigned[owner_atom[ibody]].owned = -1;
  owner_atom[ibody] = owner_atom.back();
  owner_atom.pop_back();
}

void Ownership::update()
{
  do {
    drop_copies();
    order_bodies();
    if (comm->nprocs > 1) {
      share_large();
      for (Assigned &one : assigned) one.shared = -1;
      for (size_t i = atom->nlocal; i < assigned.size(); ++i) assigned[i].owned = -1;
      if ((bigint) large.size() < bodies.number()) {
        share_owners();
        send(Content::GHOSTS);
      }
    }
    bodies.list();
    find_bodies();
  } while (!all_found());
}

/// Many bodies are sorted in the order of their atoms, so that a step accesses memory in one
/// direction.  A few may be out of order, after migration.
void Ownership::order_bodies()
{
  constexpr int MANY = 4000, FEW = 10;    // numbers of bodies; one in FEW
  const int n = bodies.nowned();
  int descents = 0;
  for (int ibody = 1; ibody < n; ++ibody) descents += owner_atom[ibody] < owner_atom[ibody - 1];
  if (n < MANY || descents < n / FEW) return;
  std::vector<int> from(n);
  std::iota(from.begin(), from.end(), 0);
  std::sort(from.begin(), from.end(), [this](int a, int b) {
    return owner_atom[a] < owner_atom[b];
  });
  bodies.permute(from);
  std::sort(owner_atom.begin(), owner_atom.end());
  for (int ibody = 0; ibody < n; ++ibody) assigned[owner_atom[ibody]].owned = ibody;
}

/// Owner atoms of bodies that are not large receive a request if sites on other ranks need them.
void Ownership::share_owners()
{
  std::vector<double> sought(atom->nlocal + atom->nghost, 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int owner = in_body(i) ? atom->map(assigned[i].owner) : -1;
    if (owner >= atom->nlocal) sought[owner] = 1.0;
  }
  add_from_ghosts(Content::OF_ATOMS, sought.data(), 1);
  for (int i = 0; i < atom->nlocal; ++i) {
    Assigned &one = assigned[i];
    if (sought[i] > 0.0 && one.owned >= 0 && !bodies.is_large(one.owned)) one.shared = one.owned;
  }
}

/// Finds the bodies of all owned atoms.
void Ownership::find_bodies()
{
  unseen.clear();
  index.assign(atom->nlocal, -1);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!in_body(i)) continue;
    index[i] = find_body(i);
    if (index[i] < 0) unseen.push_back(assigned[i].owner);
  }
}

/// False if bodies of which some atoms have not found the owner have become large: the update must
/// be repeated.  Collective.
bool Ownership::all_found()
{
  bigint here[5] = {bodies.nowned(), 0, 0, (bigint) unseen.size(), 0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) here[1] += bodies.body[ibody].natoms;
  for (int i = 0; i < atom->nlocal; ++i) {
    here[2] += in_body(i);
    here[4] += index[i] >= bodies.nmoved();
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  bodies.set_number(all[0]);
  natoms = all[1];
  any_ghosts = all[4] > 0;
  if (all[1] != all[2] || all[3] > 0) check_whole();
  if (all[3] > 0) promote();
  return all[3] == 0;
}

std::vector<tagint> Ownership::all_ids() const
{
  std::vector<tagint> mine;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) mine.push_back(bodies.body[ibody].id);
  return gather_sorted(mine, world);
}

bool Ownership::change_masks(const std::map<tagint, Mask> &masks)
{
  int changed = 0;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    Body &body = bodies.body[ibody];
    const auto place = masks.find(body.id);
    const Mask wanted = place == masks.end() ? 0 : place->second;
    if (body.off != wanted) changed = 1;
    body.off = wanted;
  }
  return over_ranks(MPI_MAX, changed, world) != 0;
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Ownership::spread_states()
{
  bodies.update_frames(bodies.tops);
  spread_moved();
}

void Ownership::spread_moved()
{
  if (!any_ghosts) return;
  spread(bodies.state);
  bodies.update_frames(bodies.ghost_tops);
}

void Ownership::sum(double *values, int size)
{
  if (any_ghosts) add_from_ghosts(Content::OF_BODIES, values, size);
  if (bodies.large.empty()) return;
  std::vector<double> part(bodies.large.size() * size), all(part.size());
  for (size_t n = 0; n < bodies.large.size(); ++n)
    std::copy_n(values + bodies.large[n] * size, size, &part[n * size]);
  reduce(MPI_SUM, part.data(), all.data(), part.size(), world);
  for (size_t n = 0; n < bodies.large.size(); ++n)
    std::copy_n(&all[n * size], size, values + bodies.large[n] * size);
}

/* ----------------------------------------------------------------------
   per-atom arrays
------------------------------------------------------------------------- */

void Ownership::grow_arrays(int n)
{
  assigned.reserve(n);    // LAMMPS chooses by how much arrays grow
  assigned.resize(n);
  records.grow(n);
}

void Ownership::set_arrays(int i)
{
  assigned[i] = Assigned();
  records.set(i);
}

void Ownership::copy_arrays(int from, int to, int delflag)
{
  if (delflag && assigned[to].owned >= 0) remove_owned(assigned[to].owned);
  assigned[to] = assigned[from];
  records.copy(from, to);
  if (assigned[to].owned >= 0) owner_atom[assigned[to].owned] = to;
}

double Ownership::memory_usage() const
{
  return bodies.memory_usage() + assigned.capacity() * sizeof(Assigned) +
      (owner_atom.capacity() + index.capacity()) * sizeof(int) + records.memory_usage();
}

/* ----------------------------------------------------------------------
   one atom, with its body if it owns one, as doubles: exchange between ranks and restart files
------------------------------------------------------------------------- */

int Ownership::pack_exchange(int i, double *buf) const
{
  const Assigned &one = assigned[i];
  std::memcpy(buf, &one, (in_body(i) ? ATOM_SIZE : 1) * sizeof(double));
  if (!in_body(i)) return 1;    // the ID is in the first number
  int m = ATOM_SIZE + records.pack(i, buf + ATOM_SIZE);
  const int size = one.owned < 0 ? 0 : bodies.packed_size(Bodies::MOVING);
  buf[m++] = size;
  return size == 0 ? m : m + bodies.pack(one.owned, Bodies::MOVING, buf + m);
}

/// In a restart file a history may have another scheme.
int Ownership::unpack_exchange(int i, const double *buf)
{
  set_arrays(i);
  Assigned &one = assigned[i];
  std::memcpy(static_cast<void *>(&one), buf, sizeof(double));
  if (!in_body(i)) return 1;
  std::memcpy(static_cast<void *>(&one), buf, ATOM_SIZE * sizeof(double));
  int m = ATOM_SIZE + records.unpack(i, buf + ATOM_SIZE);
  const int size = (int) buf[m++];
  if (size > 0) bodies.unpack(add_owned(i), Bodies::MOVING, buf + m, size);
  return m + size;
}

int Ownership::packed_size(int i) const
{
  if (!in_body(i)) return 1;
  const int body = assigned[i].owned < 0 ? 0 : bodies.packed_size(Bodies::MOVING);
  return ATOM_SIZE + records.packed_size() + 1 + body;
}

/* ----------------------------------------------------------------------
   messages from atoms to their ghosts and back: the data of atoms, or of the bodies that they own
------------------------------------------------------------------------- */

/// GHOSTS: the IDs of bodies, and the bodies themselves to ghosts of shared owner atoms.
void Ownership::send(Content what, double *values, int size)
{
  content = what, numbers = values, width = size;
  compare_calls(world);
  comm->forward_comm(fix, size);
}

/// Adds the values of ghosts to the values of their owners.
void Ownership::add_from_ghosts(Content what, double *values, int size)
{
  content = what, numbers = values, width = size;
  compare_calls(world);
  comm->reverse_comm(fix, size);
}

/// The numbers of an atom or of the body that it owns, null if it shares none.
double *Ownership::numbers_of(int i) const
{
  const int n = content == Content::OF_ATOMS ? i : assigned[i].shared;
  return n < 0 ? nullptr : numbers + (size_t) n * width;
}

int Ownership::pack_forward(int n, const int *list, double *buf)
{
  double *to = buf;
  for (int i = 0; i < n; ++i) {
    if (content != Content::GHOSTS) {
      if (const double *mine = numbers_of(list[i])) to = std::copy_n(mine, width, to);
      continue;
    }
    const Assigned &one = assigned[list[i]];
    *to++ = ubuf(one.id).d;
    *to++ = one.shared;
    if (one.shared >= 0) to += bodies.pack(one.shared, Bodies::OF_GHOST, to);
  }
  return (int) (to - buf);
}

void Ownership::unpack_forward(int n, int first, const double *buf)
{
  const int size = bodies.packed_size(Bodies::OF_GHOST);
  for (int i = first; i < first + n; ++i) {
    if (content != Content::GHOSTS) {
      double *mine = numbers_of(i);
      if (mine) std::copy_n(buf, width, mine), buf += width;
      continue;
    }
    Assigned &one = assigned[i];
    one.id = (tagint) ubuf(*buf++).i;
    if (*buf++ < 0.0) continue;
    one.owned = one.shared = bodies.add_ghost();
    bodies.unpack(one.shared, Bodies::OF_GHOST, buf, size);
    buf += size;
  }
}

int Ownership::pack_reverse(int n, int first, double *buf)
{
  double *to = buf;
  for (int i = first; i < first + n; ++i)
    if (const double *mine = numbers_of(i)) to = std::copy_n(mine, width, to);
  return (int) (to - buf);
}

void Ownership::unpack_reverse(int n, const int *list, const double *buf)
{
  for (int i = 0; i < n; ++i)
    if (double *mine = numbers_of(list[i]))
      for (int k = 0; k < width; ++k) mine[k] += *buf++;
}

/* ----------------------------------------------------------------------
   large bodies
------------------------------------------------------------------------- */

/// A site cannot find its owner atom, although it exists: its body becomes large.
void Ownership::promote()
{
  std::sort(unseen.begin(), unseen.end());
  unseen.erase(std::unique(unseen.begin(), unseen.end()), unseen.end());
  const std::vector<tagint> all = gather_sorted(unseen, world);
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    if (std::binary_search(all.begin(), all.end(), atom->tag[owner_atom[ibody]]))
      bodies.body[ibody].large = 1;
}

/// Adds large bodies of other ranks after the owned bodies.  Collective.
void Ownership::share_large()
{
  const int size = 1 + bodies.packed_size(Bodies::MOVING);
  std::vector<double> mine;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    if (!bodies.body[ibody].large) continue;
    mine.resize(mine.size() + size);
    double *buf = &mine[mine.size() - size];
    buf[0] = ubuf(atom->tag[owner_atom[ibody]]).d;
    bodies.pack(ibody, Bodies::MOVING, buf + 1);
  }
  const std::vector<double> all = gather(mine, world);
  for (size_t m = 0; m < all.size(); m += size) {
    const tagint tag = (tagint) ubuf(all[m]).i;
    const int owner = atom->map(tag);
    int ibody = owner >= 0 && owner < atom->nlocal ? assigned[owner].owned : -1;
    if (ibody < 0) {
      ibody = bodies.add_copy();
      bodies.unpack(ibody, Bodies::MOVING, &all[m + 1], size - 1);
    }
    large[tag] = ibody;
  }
  for (const auto &one : large) bodies.large.push_back(one.second);
}

/// The body of an owned atom, -1 if this rank cannot find it.
int Ownership::find_body(int i) const
{
  const tagint tag = assigned[i].owner;
  const auto found = large.find(tag);
  if (found != large.end()) return found->second;
  const int owner = atom->map(tag);
  return owner < 0 ? -1 : assigned[owner].owned;
}
