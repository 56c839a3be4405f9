/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies as streams of doubles: between ranks, to ghosts and back, and in restart files.  This file
   also handles large bodies, some of whose sites cannot find their owner atom.

   Before a run, and when the number of large bodies changes, their owners send them to all ranks,
   with their histories.  From then on every rank predicts and corrects large bodies, from the same
   loads and thus to the same bits, and keeps them while atoms are exchanged.  The only message in a
   step is the sum of the loads. */

#include "gear_quat_ownership.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace GearQuat;

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
