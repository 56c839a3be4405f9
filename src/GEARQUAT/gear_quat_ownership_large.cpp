/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Ownership of large bodies: those whose sites cannot all see their owner atom.

   Before a run, and when they become more or fewer, their owners give them to all ranks, with their
   histories.  From then on every rank predicts and corrects them, from the same loads and so to the
   same bits, and keeps them while atoms are exchanged: the one message of a step is the sum of the
   loads. */

#include "gear_quat_ownership.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

/// How far away a ghost atom may be; with comm_modify mode multi only some atoms are seen so far.
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

/// A site does not see its owner atom, though that is there: from here on its body is large.
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

/// Before atoms are exchanged: the owner may be another rank afterwards.
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

/// The same from their owners.  Collective.
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

/// Large bodies of other ranks, behind the owned ones.
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

/// The body of an owned atom, -1 if that is not to be seen from here.
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
  MPI_Allreduce(parts.data(), sums.data(), (int) parts.size(), MPI_DOUBLE, MPI_SUM, world);
  const double *sum = sums.data();
  for (const int ibody : bodies.large) {
    std::copy_n(sum, 3, column[ibody].force);
    std::copy_n(sum + 3, 3, column[ibody].torque_space);
    sum += LOAD_SIZE;
  }
}
