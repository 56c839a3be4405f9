/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies travel as streams of doubles: between ranks, to ghosts and back, and in restart files.  Some
   sites of large bodies cannot find their owner atom.  Before a run, and when the number of large
   bodies changes, their owners send them to all ranks, with their histories.  From then on every
   rank predicts and corrects large bodies, from the same loads and thus to the same bits, and keeps
   them while atoms are exchanged.  The only message in a step is the sum of the loads. */

#include "gear_quat_ownership.h"

#include "gear_quat_assembly.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

Ownership::Ownership(LAMMPS *lmp, Fix *fix, Bodies &bodies, const Scheme &scheme) :
    Pointers(lmp), fix(fix), bodies(bodies), records(lmp, scheme)
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
  return body_id[i < atom->nlocal ? i : atom->map(atom->tag[i])];
}

/* ----------------------------------------------------------------------
   life cycle
------------------------------------------------------------------------- */

void Ownership::clear(bool with_extended)
{
  packed_large.clear();
  large_owners.clear();
  bodies.clear();
  owner_atom.clear();
  index.clear();
  records.reset(with_extended, (int) owned.size());
  for (size_t i = 0; i < owned.size(); ++i) set_arrays(i);
}

void Ownership::create(const std::vector<tagint> &ids, const GivenBodies &given)
{
  clear();
  add(ids, given, false);
}

void Ownership::count()
{
  bigint here[2] = {bodies.nowned(), 0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) here[1] += bodies.body_at(ibody).natoms;
  const auto all = over_ranks(MPI_SUM, here, world);
  bodies.set_number(all[0]);
  natoms = all[1];
  note_box();
}

void Ownership::note_box()
{
  note_box(domain->h, domain->boxlo);
}

void Ownership::note_box(const double *h, const double *corner)
{
  last_box.assign(h, h + 6);
  last_box.insert(last_box.end(), corner, corner + 3);
}

void Ownership::add(const std::vector<tagint> &ids, const GivenBodies &given, bool fresh,
                    const Former *former)
{
  std::vector<int> atoms;
  for (int i = 0; i < atom->nlocal; ++i)
    if (ids[i] != 0) atoms.push_back(i);
  records.refuse(atoms);
  const bool any_extended = records.any(atoms);
  if (any_extended && !records.has_records()) records.reset(true, (int) owned.size());

  const Assembly assembly(lmp, given, any_extended ? &records : nullptr, ids, former);
  note_scratch(assembly.memory_usage() + ids.capacity() * sizeof(tagint));
  assembly.for_sites([&](const Assembly::Made &one, int i, const double *arm_body) {
    body_id[i] = one.body.id;
    owner_tag[i] = one.owner;
    std::copy_n(arm_body, 3, arm[i].begin());
    free_atoms = free_atoms || one.moves_apart(atom->v[i], arm_body);
    if (any_extended) records.attach(i, mass_of(i), one.state.q);
  });
  if (!fresh && !warned_of_shapes) warned_of_shapes = assembly.warn_of_shapes();
  for (const auto &one : assembly.bodies()) {
    if (one.owner_rank != comm->me) continue;
    const int ibody = add_owned(one.local);
    bodies.change_body(ibody) = one.body;
    bodies.change_body(ibody).fresh = fresh;
    bodies.change_state(ibody) = one.state;
  }
  count();
}

void Ownership::recreate()
{
  const std::vector<tagint> ids(body_id.begin(), body_id.begin() + atom->nlocal);
  Former former = {arm, std::vector<std::array<double, 9>>(atom->nlocal)};
  for (int i = 0; i < atom->nlocal; ++i)
    if (index[i] >= 0) std::copy_n(bodies.axes(index[i]), 9, former.axes[i].begin());
  clear();
  add(ids, GivenBodies(), false, &former);
  choose_large();
}

Ownership::Resumed Ownership::resume(const std::vector<const double *> &packed, bool with_extended,
                                     int group)
{
  const std::vector<tagint> ids(body_id.begin(),
                                body_id.begin() + atom->nlocal);    // numbered by the command
  const bigint expected = bodies.number();
  clear(with_extended);
  int here[2] = {0, 0};    // atoms in a body only here, only in the file
  for (int i = 0; i < atom->nlocal; ++i) {
    if (packed[i]) unpack_exchange(i, packed[i]);
    if (group && !(atom->mask[i] & group)) continue;
    if (body_id[i] == 0 && ids[i] != 0) here[0] = 1;
    if (body_id[i] != 0 && ids[i] == 0) here[1] = 1;
    body_id[i] = ids[i];
    if (owned[i] >= 0) bodies.change_body(owned[i]).id = ids[i];
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body_id[i] != 0) continue;    // omitted, or in no body
    if (owned[i] >= 0) remove_owned(owned[i]);
    set_arrays(i);
  }
  count();
  const auto any = over_ranks(MPI_MAX, here, world);
  const bool whole = !count_atoms().broken;
  if (!any[0] && whole && (group || bodies.number() == expected))
    return any[1] ? Resumed::FEWER : Resumed::ALL;
  clear();
  return Resumed::NONE;
}

void Ownership::refuse_atoms() const
{
  std::vector<int> atoms;
  for (int i = 0; i < atom->nlocal; ++i)
    if (in_body(i)) atoms.push_back(i);
  records.refuse(atoms);
}

void Ownership::check_whole()
{
  const Comparison found = count_atoms();
  if (found.broken) {
    const std::string had = found.had
        ? fmt::format("has {} of its {} atoms left", found.left, found.had)
        : fmt::format("has {} of its atoms left, without its owner atom", found.left);
    error->all(FLERR,
               "Fix gear/quat: body {} {}; a body must be removed as a whole, and no atom "
               "of it may leave the box through a face that is not periodic, as it does if the "
               "time step is too long or atoms overlap",
               found.broken, had);
  }
  follow_atom_ids();
}

/// Owners may have new atom IDs (reset_atoms id, delete_atoms compress yes): sends them to their
/// sites.
void Ownership::follow_atom_ids()
{
  std::vector<tagint> changed;    // before and now
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
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

/* ----------------------------------------------------------------------
   ownership
------------------------------------------------------------------------- */

void Ownership::drop_copies()
{
  if (!bodies.large.empty()) pack_large();
  bodies.drop_copies();
  large_owners.clear();
}

int Ownership::add_owned(int atom)
{
  drop_copies();
  const int ibody = bodies.add_owned();
  owner_atom.push_back(atom);
  owned[atom] = ibody;
  return ibody;
}

void Ownership::remove_owned(int ibody)
{
  drop_copies();
  owned[owner_atom[ibody]] = -1;
  bodies.remove_owned(ibody);
  const int end = bodies.nowned();
  if (ibody != end) {
    owner_atom[ibody] = owner_atom[end];
    owned[owner_atom[ibody]] = ibody;
  }
  owner_atom.resize(end);
}

void Ownership::update()
{
  do {
    drop_copies();
    order_bodies();
    share_large();
    if (comm->nprocs > 1) {
      std::fill(owned.begin() + atom->nlocal, owned.end(), -1);
      std::fill(shared.begin(), shared.end(), -1);
      if (nlarge < bodies.number()) {
        share_owners();
        tell_ghosts();
      }
    }
    bodies.list();
    find_bodies();
  } while (!take_stock());
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
  for (int ibody = 0; ibody < n; ++ibody) owned[owner_atom[ibody]] = ibody;
}

/// Owner atoms of bodies that are not large receive a request if sites on other ranks need them.
void Ownership::share_owners()
{
  std::vector<double> sought(atom->nlocal + atom->nghost, 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int owner = in_body(i) ? atom->map(owner_tag[i]) : -1;
    if (owner >= atom->nlocal) sought[owner] = 1.0;
  }
  labels = sought.data();
  compare_calls(world);
  comm->reverse_comm(fix, 1);
  labels = nullptr;
  for (int i = 0; i < atom->nlocal; ++i)
    if (sought[i] > 0.0 && owned[i] >= 0 && !bodies.is_large(owned[i])) shared[i] = owned[i];
}

/// Sends the IDs of bodies to ghost atoms, and the bodies themselves to ghosts of shared owner
/// atoms.
void Ownership::tell_ghosts()
{
  message = Message::GHOSTS;
  compare_calls(world);
  comm->forward_comm(fix);
}

/// Finds the bodies of all owned atoms.
void Ownership::find_bodies()
{
  unseen.clear();
  index.assign(atom->nlocal, -1);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!in_body(i)) continue;
    index[i] = find_body(i);
    if (index[i] < 0) unseen.push_back(owner_tag[i]);
  }
}

/// Counts over all ranks.  False if some bodies have become large: the update must be repeated.
bool Ownership::take_stock()
{
  const bigint lost = (bigint) unseen.size();
  bigint here[7] = {bodies.nowned(), 0, 0, lost, outside_atoms, 0, 0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    here[1] += bodies.body_at(ibody).natoms;
    here[6] += bodies.is_large(ibody);
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    here[2] += in_body(i);
    here[5] += index[i] >= bodies.nmoved();
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  bodies.set_number(all[0]);
  natoms = all[1];
  any_ghosts = all[5] > 0;
  nlarge = all[6];
  bodies.set_copies(any_ghosts || nlarge > 0);
  if (all[1] != all[2] || all[3] > 0) check_whole();
  if (nlarge != (bigint) bodies.large.size()) return false;    // one was removed
  if (all[3] > 0) {
    promote();
    return false;
  }
  if (all[4] > 0 && !warned_outside) {
    warned_outside = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat: {} atoms of the fix group were created after the fix was "
                     "defined; they belong to no body and this fix does not move them",
                     all[4]);
  }
  return true;
}

std::vector<tagint> Ownership::all_ids() const
{
  std::vector<tagint> mine;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) mine.push_back(bodies.body_at(ibody).id);
  return gather_sorted(mine, world);
}

bool Ownership::change_masks(const std::map<tagint, Mask> &masks)
{
  int changed = 0;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    Body &body = bodies.change_body(ibody);
    const auto place = masks.find(body.id);
    const Mask wanted = place == masks.end() ? 0 : place->second;
    if (body.off != wanted) changed = 1;
    body.off = wanted;
  }
  return over_ranks(MPI_MAX, changed, world) != 0;
}

void Ownership::spread_labels(std::vector<double> &label)
{
  labels = label.data();
  message = Message::LABELS;
  compare_calls(world);
  comm->forward_comm(fix, 1);
  labels = nullptr;
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
  message = Message::STATES;
  compare_calls(world);
  comm->forward_comm(fix, STATE_SIZE);
  bodies.update_frames(bodies.ghost_tops);
}

void Ownership::sum(std::vector<Load> &column)
{
  loads = column.data();
  compare_calls(world);
  if (any_ghosts) comm->reverse_comm(fix, LOAD_SIZE);
  if (!bodies.large.empty()) sum_large(column);
}

void Ownership::spread(std::vector<Load> &column)
{
  if (!any_ghosts) return;
  loads = column.data();
  message = Message::LOADS;
  compare_calls(world);
  comm->forward_comm(fix, LOAD_SIZE);
}

/* ----------------------------------------------------------------------
   per-atom arrays
------------------------------------------------------------------------- */

void Ownership::grow_arrays(int n)
{
  body_id.resize(n);
  owner_tag.resize(n);
  owned.resize(n, -1);
  shared.resize(n, -1);
  arm.resize(n);
  records.grow(n);
}

void Ownership::set_arrays(int i)
{
  body_id[i] = owner_tag[i] = 0;
  owned[i] = shared[i] = -1;
  arm[i] = {};
  records.set(i);
}

void Ownership::copy_arrays(int from, int to, int delflag)
{
  if (delflag && owned[to] >= 0) remove_owned(owned[to]);
  body_id[to] = body_id[from];
  owner_tag[to] = owner_tag[from];
  owned[to] = owned[from];
  arm[to] = arm[from];
  records.copy(from, to);
  if (owned[to] >= 0) owner_atom[owned[to]] = to;
}

double Ownership::present_memory() const
{
  const double per_atom = 2 * sizeof(tagint) + 2 * sizeof(int) + 3 * sizeof(double);
  return bodies.memory_usage() + owned.capacity() * per_atom +
      (packed_large.capacity() + parts.capacity() + sums.capacity()) * sizeof(double) +
      large_owners.capacity() * sizeof(tagint) +
      (owner_atom.capacity() + index.capacity()) * sizeof(int) + records.memory_usage();
}

void Ownership::note_scratch(double bytes)
{
  peak = std::max(peak, present_memory() + bytes);
}

double Ownership::memory_usage() const
{
  return std::max(peak, present_memory());
}

/* ----------------------------------------------------------------------
   one atom, with its body if it owns one, as doubles: exchange between ranks and restart files
------------------------------------------------------------------------- */

int Ownership::pack_exchange(int i, double *buf) const
{
  int m = 0;
  buf[m++] = ubuf(body_id[i]).d;
  if (body_id[i] == 0) return m;
  buf[m++] = ubuf(owner_tag[i]).d;
  for (int k = 0; k < 3; ++k) buf[m++] = arm[i][k];
  m += records.pack(i, buf + m);
  const int ibody = owned[i];
  buf[m++] = ubuf(ibody < 0 ? 0 : bodies.history_size()).d;
  if (ibody < 0) return m;
  return m + pack_moved(ibody, buf + m);
}

/// In a restart file a history may have another scheme.
int Ownership::unpack_exchange(int i, const double *buf)
{
  int m = 0;
  set_arrays(i);
  body_id[i] = (tagint) ubuf(buf[m++]).i;
  if (body_id[i] == 0) return m;
  owner_tag[i] = (tagint) ubuf(buf[m++]).i;
  for (int k = 0; k < 3; ++k) arm[i][k] = buf[m++];
  m += records.unpack(i, buf + m);
  const int size = (int) ubuf(buf[m++]).i;
  if (size == 0) return m;
  return m + unpack_moved(add_owned(i), buf + m, size);
}

int Ownership::pack_moved(int ibody, double *buf) const
{
  int m = pack_body(ibody, buf);
  std::memcpy(buf + m, &bodies.last_of(ibody), sizeof(Correction));
  m += LAST_SIZE;
  std::memcpy(buf + m, &bodies.load_of(ibody), sizeof(Load));
  m += LOAD_SIZE;
  std::copy_n(bodies.history(ibody), bodies.history_size(), buf + m);
  return m + bodies.history_size();
}

/// size: of the history, which is skipped if it has another scheme.
int Ownership::unpack_moved(int ibody, const double *buf, int size)
{
  int m = unpack_body(buf, ibody);
  std::memcpy(&bodies.change_last(ibody), buf + m, sizeof(Correction));
  m += LAST_SIZE;
  std::memcpy(&bodies.change_load(ibody), buf + m, sizeof(Load));
  m += LOAD_SIZE;
  if (size == bodies.history_size()) std::copy_n(buf + m, size, bodies.history(ibody));
  return m + size;
}

int Ownership::pack_body(int ibody, double *buf) const
{
  const Body &body = bodies.body_at(ibody);
  int m = 0;
  buf[m++] = ubuf(body.id).d;
  buf[m++] = ubuf(body.natoms).d;
  buf[m++] = ubuf(body.from_file).d;
  buf[m++] = ubuf(body.fresh).d;
  buf[m++] = ubuf(body.large).d;
  buf[m++] = ubuf(body.off).d;
  buf[m++] = body.extent;
  buf[m++] = body.rigid.mass;
  for (double moment : body.rigid.inertia) buf[m++] = moment;
  for (int periods : body.image) buf[m++] = periods;
  std::memcpy(buf + m, &bodies.state_of(ibody), sizeof(BodyState));
  return BODY_SIZE;
}

int Ownership::unpack_body(const double *buf, int ibody)
{
  Body &body = bodies.change_body(ibody);
  int m = 0;
  body.id = (tagint) ubuf(buf[m++]).i;
  body.natoms = (tagint) ubuf(buf[m++]).i;
  body.from_file = (int) ubuf(buf[m++]).i;
  body.fresh = (int) ubuf(buf[m++]).i;
  body.large = (int) ubuf(buf[m++]).i;
  body.off = (Mask) ubuf(buf[m++]).i;
  body.extent = buf[m++];
  body.rigid.mass = buf[m++];
  for (double &moment : body.rigid.inertia) moment = buf[m++];
  for (int &periods : body.image) periods = (int) buf[m++];
  std::memcpy(&bodies.change_state(ibody), buf + m, sizeof(BodyState));
  return BODY_SIZE;
}

int Ownership::packed_size(int i) const
{
  if (body_id[i] == 0) return 1;
  const int site = ATOM_SIZE + records.packed_size(i);
  return owned[i] < 0 ? site : site + moved_size();
}

int Ownership::max_exchange() const
{
  return ATOM_SIZE + Extended::RECORD_SIZE + moved_size() - bodies.history_size() +
      std::max(bodies.history_size(), MAX_SIZE);
}

int Ownership::max_forward() const
{
  return 2 + BODY_SIZE;
}

/* ----------------------------------------------------------------------
   ghost bodies: from owner atoms to their ghosts and back
------------------------------------------------------------------------- */

int Ownership::pack_forward(int n, const int *list, double *buf)
{
  int m = 0;
  if (message == Message::LABELS) {
    for (int i = 0; i < n; ++i) buf[m++] = labels[list[i]];
    return m;
  }
  for (int i = 0; i < n; ++i) {
    const int ibody = shared[list[i]];
    if (message == Message::GHOSTS) {
      buf[m++] = ubuf(body_id[list[i]]).d;
      buf[m++] = ubuf(ibody < 0 ? 0 : 1).d;
      if (ibody >= 0) m += pack_body(ibody, buf + m);
    } else if (ibody < 0) {
      continue;
    } else if (message == Message::STATES) {
      std::memcpy(buf + m, &bodies.state_of(ibody), sizeof(BodyState));
      m += STATE_SIZE;
    } else {
      std::memcpy(buf + m, &loads[ibody], sizeof(Load));
      m += LOAD_SIZE;
    }
  }
  return m;
}

void Ownership::unpack_forward(int n, int first, const double *buf)
{
  int m = 0;
  if (message == Message::LABELS) {
    std::copy_n(buf, n, labels + first);
    return;
  }
  for (int i = first; i < first + n; ++i) {
    if (message == Message::GHOSTS) {
      body_id[i] = (tagint) ubuf(buf[m++]).i;
      if (ubuf(buf[m++]).i == 0) continue;
      owned[i] = shared[i] = bodies.add_ghost();
      m += unpack_body(buf + m, owned[i]);
    } else if (shared[i] >= 0 && message == Message::STATES) {
      std::memcpy(&bodies.change_state(shared[i]), buf + m, sizeof(BodyState));
      m += STATE_SIZE;
    } else if (shared[i] >= 0) {
      std::memcpy(&loads[shared[i]], buf + m, sizeof(Load));
      m += LOAD_SIZE;
    }
  }
}

/// Labels of atoms, if there are any, otherwise loads.
int Ownership::pack_reverse(int n, int first, double *buf)
{
  if (labels) {
    std::copy_n(labels + first, n, buf);
    return n;
  }
  int m = 0;
  for (int i = first; i < first + n; ++i) {
    if (shared[i] < 0) continue;
    std::memcpy(buf + m, &loads[shared[i]], sizeof(Load));
    m += LOAD_SIZE;
  }
  return m;
}

/// Adds labels or loads of ghosts to the values of their owners.
void Ownership::unpack_reverse(int n, const int *list, const double *buf)
{
  if (labels) {
    for (int i = 0; i < n; ++i) labels[list[i]] += buf[i];
    return;
  }
  int m = 0;
  for (int i = 0; i < n; ++i) {
    const int ibody = shared[list[i]];
    if (ibody < 0) continue;
    for (int k = 0; k < 3; ++k) loads[ibody].force[k] += buf[m++];
    for (int k = 0; k < 3; ++k) loads[ibody].torque_space[k] += buf[m++];
  }
}

/* ----------------------------------------------------------------------
   large bodies
------------------------------------------------------------------------- */

/// Maximum distance of a ghost atom; with comm_modify mode multi only some atoms extend that far.
static double ghost_cutoff(const Comm *comm, const Domain *domain)
{
  const double *cut = comm->cutghost;    // in a triclinic box along its reciprocal axes
  return domain->triclinic ? cut[2] / domain->h_inv[2] : cut[2];
}

void Ownership::choose_large()
{
  drop_copies();
  packed_large.clear();
  const double cutoff = ghost_cutoff(comm, domain);
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    Body &one = bodies.change_body(ibody);
    one.large = comm->nprocs > 1 && (one.large || one.extent > cutoff);
  }
  count_large();
}

void Ownership::count_large()
{
  bigint here = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) here += bodies.body_at(ibody).large;
  nlarge = over_ranks(MPI_SUM, here, world);
}

/// A site cannot find its owner atom, although it exists: its body becomes large.
void Ownership::promote()
{
  std::sort(unseen.begin(), unseen.end());
  unseen.erase(std::unique(unseen.begin(), unseen.end()), unseen.end());
  const std::vector<tagint> all = gather_sorted(unseen, world);
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    if (std::binary_search(all.begin(), all.end(), atom->tag[owner_atom[ibody]]))
      bodies.change_body(ibody).large = 1;
  count_large();
}

/// Before atoms are exchanged, since the owner may be on another rank afterwards.
void Ownership::pack_large()
{
  packed_large.resize(bodies.large.size() * large_size());
  double *buf = packed_large.data();
  for (size_t n = 0; n < bodies.large.size(); ++n) {
    buf[0] = ubuf(large_owners[n]).d;
    pack_moved(bodies.large[n], buf + 1);
    buf += large_size();
  }
}

/// Gathers large bodies from their owners on all ranks.  Collective.
void Ownership::gather_large()
{
  std::vector<double> mine;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    if (!bodies.body_at(ibody).large) continue;
    mine.resize(mine.size() + large_size());
    double *buf = &mine[mine.size() - large_size()];
    buf[0] = ubuf(atom->tag[owner_atom[ibody]]).d;
    pack_moved(ibody, buf + 1);
  }
  packed_large = gather(mine, world);
}

/// Adds large bodies of other ranks after the owned bodies.
void Ownership::share_large()
{
  const int size = large_size();
  if ((bigint) packed_large.size() != nlarge * size) gather_large();
  std::map<tagint, int> found;    // by the atom IDs of their owners
  for (size_t m = 0; m < packed_large.size(); m += size) {
    const tagint tag = (tagint) ubuf(packed_large[m]).i;
    const int owner = atom->map(tag);
    int ibody = owner >= 0 && owner < atom->nlocal ? owned[owner] : -1;
    if (ibody < 0) {
      ibody = bodies.add_copy();
      unpack_moved(ibody, &packed_large[m + 1], bodies.history_size());
    }
    found[tag] = ibody;
  }
  for (const auto &one : found) {
    large_owners.push_back(one.first);
    bodies.large.push_back(one.second);
  }
}

/// The body of an owned atom, -1 if this rank cannot find it.
int Ownership::find_body(int i) const
{
  const auto found = std::lower_bound(large_owners.begin(), large_owners.end(), owner_tag[i]);
  if (found != large_owners.end() && *found == owner_tag[i])
    return bodies.large[found - large_owners.begin()];
  const int owner = atom->map(owner_tag[i]);
  return owner < 0 ? -1 : owned[owner];
}

void Ownership::sum_large(std::vector<Load> &column)
{
  parts.resize(bodies.large.size() * LOAD_SIZE);
  sums.resize(parts.size());
  double *part = parts.data();
  for (const int ibody : bodies.large) {
    part = std::copy_n(column[ibody].force, 3, part);
    part = std::copy_n(column[ibody].torque_space, 3, part);
  }
  reduce(MPI_SUM, parts.data(), sums.data(), parts.size(), world);
  const double *sum = sums.data();
  for (const int ibody : bodies.large) {
    std::copy_n(sum, 3, column[ibody].force);
    std::copy_n(sum + 3, 3, column[ibody].torque_space);
    sum += LOAD_SIZE;
  }
}
