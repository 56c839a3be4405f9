/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Data combined over all ranks.  Every call is collective.

   In test builds, with GEARQUAT_CHECKS, every call counts, and World compares the count and the
   lines of all calls over the ranks.  A run ends if ranks are in different calls. */

#ifndef LMP_GEAR_QUAT_RANKS_H
#define LMP_GEAR_QUAT_RANKS_H

#include "gear_quat_exact_sum.h"

#include "comm.h"
#include "lmptype.h"

#include <algorithm>
#include <array>
#include <functional>
#include <mpi.h>
#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

namespace LAMMPS_NS::GearQuat {

#ifdef GEARQUAT_CHECKS
/// The collective calls of this rank: how many, and the sum of their lines.
struct Calls {
  bigint count = 0, lines = 0;

  void compare(MPI_Comm world, const char *file, int line)
  {
    ++count;
    lines += line;
    bigint here[4] = {count, -count, lines, -lines}, least[4];
    MPI_Allreduce(here, least, 4, MPI_LMP_BIGINT, MPI_MIN, world);
    if (least[0] == -least[1] && least[2] == -least[3]) return;
    fprintf(stderr,
            "ERROR: Fix gear/quat: ranks make different collective calls; one is at %s:%d\n", file,
            line);
    MPI_Abort(world, 1);
  }
};
inline Calls calls;

/// All ranks, at a collective call.
struct World {
  MPI_Comm comm;
  World(MPI_Comm comm, const char *file = __builtin_FILE(), int line = __builtin_LINE()) :
      comm(comm)
  {
    calls.compare(comm, file, line);
  }
};
#else
struct World {
  MPI_Comm comm;
  World(MPI_Comm comm) : comm(comm) {}
};
#endif

/// In test builds, ends the run if ranks have made different calls.
inline void compare_calls(World /*world*/) {}

/// Reduces numbers (int, tagint, bigint or double) over all ranks, element by element.
template <typename T> void reduce(MPI_Op op, T *here, T *all, size_t n, World world)
{
  static_assert(std::is_arithmetic<T>::value);
  const MPI_Datatype type = std::is_same<T, double>::value ? MPI_DOUBLE
      : std::is_same<T, int>::value                        ? MPI_INT
                                                           : MPI_LMP_BIGINT;
  MPI_Allreduce(here, all, (int) n, type, op, world.comm);
}

template <typename T, size_t N> std::array<T, N> over_ranks(MPI_Op op, T (&here)[N], World world)
{
  std::array<T, N> all;
  reduce(op, here, all.data(), N, world);
  return all;
}

/// One number.
template <typename T> T over_ranks(MPI_Op op, T here, World world)
{
  T one[1] = {here};
  return over_ranks(op, one, world)[0];
}

/// Exact sums over all ranks, element by element.
template <size_t N> void sum_over_ranks(ExactSum (&sums)[N], World world)
{
  constexpr int PARTS = ExactSum::PARTS;
  double here[N * PARTS];
  for (size_t k = 0; k < N * PARTS; ++k) here[k] = sums[k / PARTS].parts[k % PARTS];
  const auto all = over_ranks(MPI_SUM, here, world);
  for (size_t k = 0; k < N * PARTS; ++k) sums[k / PARTS].parts[k % PARTS] = all[k];
}

/// Sends each item to its rank, and returns the items received.
template <typename T>
std::vector<T> send_to_ranks(Comm *comm, World /*world*/, std::vector<T> items,
                             std::vector<int> ranks)
{
  constexpr int IRREGULAR = 0, UNSORTED = 0;
  const int n = (int) items.size();
  std::vector<T> received;
  items.emplace_back();    // avoids null pointers on a rank without items
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

/// Sends the text of one rank to all.
inline std::string broadcast(std::string text, World world, int root)
{
  int size = (int) text.size();
  MPI_Bcast(&size, 1, MPI_INT, root, world.comm);
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, root, world.comm);
  return text;
}

/// Gathers the items of all ranks in the order of the ranks.  T: without pointers, since it is sent
/// as bytes.
template <typename T> std::vector<T> gather(std::vector<T> &mine, World all_ranks)
{
  const MPI_Comm world = all_ranks.comm;
  int here = (int) mine.size(), ranks;    // not const: required by LAMMPS' MPI stubs
  MPI_Comm_size(world, &ranks);
  std::vector<int> counts(ranks, 0), starts(ranks, 0);
  MPI_Allgather(&here, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  std::partial_sum(counts.begin(), counts.end() - 1, starts.begin() + 1);
  std::vector<T> all(starts.back() + counts.back());
  MPI_Datatype type;
  MPI_Type_contiguous(sizeof(T), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Allgatherv(mine.data(), here, type, all.data(), counts.data(), starts.data(), type, world);
  MPI_Type_free(&type);
  return all;
}

/// The gathered items, sorted.
template <typename T, class Before = std::less<T>>
std::vector<T> gather_sorted(std::vector<T> &mine, World world, Before before = Before())
{
  std::vector<T> all = gather(mine, world);
  std::sort(all.begin(), all.end(), before);
  return all;
}

/// Sums over bodies.  The atoms of a body may be on several ranks; its atoms on one rank are a part
/// of the body.  Every rank sums over its parts, and merge() combines the parts of the same body,
/// so a message has one item for each part, for any number of atoms.  Bodies whose atoms are all on
/// one rank need no message.
class Parts {
 public:
  /// key: of n owned atoms, positive and the same for all atoms of a body, 0 for an atom in none.
  /// Collective.
  Parts(Comm *comm, MPI_Comm world, const tagint *key, int n) : comm(comm), world(world)
  {
    atom.reserve(n - std::count(key, key + n, 0));
    for (int i = 0; i < n; ++i)
      if (key[i] != 0) atom.push_back(i);
    const auto before = [key](int i, int j) {
      return key[i] < key[j];
    };
    if (!std::is_sorted(atom.begin(), atom.end(), before))
      std::sort(atom.begin(), atom.end(), before);
    for (size_t i = 0; i < atom.size(); ++i)
      if (keys.empty() || key[atom[i]] != keys.back()) {
        keys.push_back(key[atom[i]]);
        start.push_back((int) i);
      }
    start.push_back((int) atom.size());
    find_shared();
  }

  int number() const { return (int) keys.size(); }
  tagint key(int part) const { return keys[part]; }
  struct Atoms {
    const int *first, *last;
    const int *begin() const { return first; }
    const int *end() const { return last; }
  };
  /// The owned atoms of a part, by their local indices.
  Atoms atoms(int part) const { return {&atom[start[part]], &atom[start[part + 1] - 1] + 1}; }

  /// items: one for each part, with a function merge() that adds the item of another rank.  After
  /// the call every part has the item of the whole body.  Items are merged in the order of the
  /// ranks and sent as bytes.  Collective.
  template <typename Item> void merge(std::vector<Item> &items) const { merge(items, shared); }

 private:
  Comm *comm;
  MPI_Comm world;
  std::vector<int> atom, start;    ///< atoms by parts, and where each part starts
  std::vector<tagint> keys;
  std::vector<int> shared;    ///< parts of bodies that are on other ranks too

  struct Ranks {
    int number;
    void merge(const Ranks &other) { number += other.number; }
  };

  void find_shared()
  {
    if (comm->nprocs == 1) return;
    std::vector<int> all(number());
    std::iota(all.begin(), all.end(), 0);
    std::vector<Ranks> ranks(all.size(), {1});
    merge(ranks, all);
    for (const int part : all)
      if (ranks[part].number > 1) shared.push_back(part);
  }

  /// Every item is sent to the rank given by its key, which returns it merged.
  template <typename Item> void merge(std::vector<Item> &items, const std::vector<int> &which) const
  {
    if (comm->nprocs == 1) return;
    struct Message {
      tagint key;
      int rank, part;
      Item item;
    };
    std::vector<Message> messages;
    std::vector<int> ranks;
    messages.reserve(which.size() + 1);
    for (const int part : which) {
      messages.push_back({keys[part], comm->me, part, items[part]});
      ranks.push_back((int) (keys[part] % comm->nprocs));
    }
    messages = send_to_ranks(comm, world, std::move(messages), std::move(ranks));
    std::sort(messages.begin(), messages.end(), [](const Message &a, const Message &b) {
      return a.key != b.key ? a.key < b.key : a.rank < b.rank;
    });
    ranks.clear();
    for (size_t first = 0, last; first < messages.size(); first = last) {
      Item whole = messages[first].item;
      for (last = first + 1; last < messages.size() && messages[last].key == messages[first].key;)
        whole.merge(messages[last++].item);
      for (size_t i = first; i < last; ++i) messages[i].item = whole;
    }
    for (const auto &message : messages) ranks.push_back(message.rank);
    for (const auto &message : send_to_ranks(comm, world, std::move(messages), std::move(ranks)))
      items[message.part] = message.item;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
