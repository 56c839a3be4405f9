/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#ifndef LMP_GEAR_QUAT_GATHER_H
#define LMP_GEAR_QUAT_GATHER_H

#include <algorithm>
#include <functional>
#include <mpi.h>
#include <numeric>
#include <vector>

namespace LAMMPS_NS::GearQuat {

constexpr int EVERY_RANK = -1;

/// What all ranks have, in the order of the ranks: on one of them (empty elsewhere), or on every one.
/// T: without pointers, for it is sent as bytes.  Collective.
template <typename T>
std::vector<T> gather(std::vector<T> &mine, MPI_Comm world, int root = EVERY_RANK)
{
  int here = (int) mine.size(), me, ranks;    // not const: MPI without MPI wants it so
  MPI_Comm_rank(world, &me);
  MPI_Comm_size(world, &ranks);
  MPI_Datatype type;
  MPI_Type_contiguous(sizeof(T), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  std::vector<int> counts(ranks, 0), starts(ranks, 0);
  if (root == EVERY_RANK)
    MPI_Allgather(&here, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  else
    MPI_Gather(&here, 1, MPI_INT, counts.data(), 1, MPI_INT, root, world);
  std::partial_sum(counts.begin(), counts.end() - 1, starts.begin() + 1);
  std::vector<T> all(starts.back() + counts.back());
  if (root == EVERY_RANK)
    MPI_Allgatherv(mine.data(), here, type, all.data(), counts.data(), starts.data(), type, world);
  else
    MPI_Gatherv(mine.data(), here, type, all.data(), counts.data(), starts.data(), type, root,
                world);
  MPI_Type_free(&type);
  return all;
}

/// The same, sorted.
template <typename T, class Before = std::less<T>>
std::vector<T> gather_sorted(std::vector<T> &mine, MPI_Comm world, Before before = Before(),
                             int root = EVERY_RANK)
{
  std::vector<T> all = gather(mine, world, root);
  std::sort(all.begin(), all.end(), before);
  return all;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
