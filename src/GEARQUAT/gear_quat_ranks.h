/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What all ranks have together.  Every call is collective. */

#ifndef LMP_GEAR_QUAT_RANKS_H
#define LMP_GEAR_QUAT_RANKS_H

#include "comm.h"

#include <algorithm>
#include <array>
#include <functional>
#include <mpi.h>
#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// N numbers (int, tagint, bigint or double) of every rank brought together, number by number.
template <typename T, size_t N> std::array<T, N> over_ranks(MPI_Op op, T (&here)[N], MPI_Comm world)
{
  std::array<T, N> all;
  const MPI_Datatype type = std::is_same<T, double>::value ? MPI_DOUBLE
      : std::is_same<T, int>::value                        ? MPI_INT
                                                           : MPI_LMP_BIGINT;
  MPI_Allreduce(here, all.data(), (int) N, type, op, world);
  return all;
}

/// One number.
template <typename T> T over_ranks(MPI_Op op, T here, MPI_Comm world)
{
  T one[1] = {here};
  return over_ranks(op, one, world)[0];
}

/// Sends each item to its rank, and returns those that were sent here.
template <typename T>
std::vector<T> send_to_ranks(Comm *comm, std::vector<T> items, std::vector<int> ranks)
{
  constexpr int IRREGULAR = 0, UNSORTED = 0;
  const int n = (int) items.size();
  std::vector<T> received;
  items.emplace_back();    // no null pointers on a rank without items
  ranks.push_back(0);
  const auto receive = [](int count, char *in, int &flag, int *&, char *&, void *where) {
    const auto *first = reinterpret_cast<const T *>(in);
    static_cast<std::vector<T> *>(where)->assign(first, first + count);
    return flag = 0;    // no reply
  };
  char *no_reply = nullptr;
  comm->rendezvous(IRREGULAR, n, reinterpret_cast<char *>(items.data()), sizeof(T), UNSORTED,
                   ranks.data(), receive, UNSORTED, no_reply, sizeof(T), &received);
  return received;
}

/// The text that one rank has.
inline std::string broadcast(std::string text, MPI_Comm world, int root)
{
  int size = (int) text.size();
  MPI_Bcast(&size, 1, MPI_INT, root, world);
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, root, world);
  return text;
}

constexpr int EVERY_RANK = -1;

/// What all ranks have, in the order of the ranks: on one of them (empty elsewhere), or on every
/// one.  T: without pointers, for it is sent as bytes.
template <typename T>
std::vector<T> gather(std::vector<T> &mine, MPI_Comm world, int root = EVERY_RANK)
{
  int here = (int) mine.size(), me, ranks;    // not const: MPI without MPI wants it so
  MPI_Comm_rank(world, &me);
  MPI_Comm_size(world, &ranks);
  std::vector<int> counts(ranks, 0), starts(ranks, 0);
  MPI_Allgather(&here, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  std::partial_sum(counts.begin(), counts.end() - 1, starts.begin() + 1);
  std::vector<T> all(root == EVERY_RANK || root == me ? starts.back() + counts.back() : 0);
  MPI_Datatype type;
  MPI_Type_contiguous(sizeof(T), MPI_BYTE, &type);
  MPI_Type_commit(&type);
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
