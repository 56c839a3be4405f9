/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Sums over bodies.  The atoms of a body may be on several ranks; those on one rank are a part of
   the body.  Every rank adds up its parts, and merge() brings the parts of the same body together,
   so a message has one item for each part, however many atoms that part has.  Bodies whose atoms
   are all on one rank need no message. */

#ifndef LMP_GEAR_QUAT_PARTS_H
#define LMP_GEAR_QUAT_PARTS_H

#include "gear_quat_ranks.h"

#include "lmptype.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Parts {
 public:
  /// key: of n owned atoms, positive and the same for all atoms of a body, 0 for an atom in none.
  /// Collective.
  Parts(Comm *comm, const tagint *key, int n) : comm(comm)
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
  /// The part with a key that one of the atoms has.
  int find(tagint key) const
  {
    return (int) (std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
  }
  struct Atoms {
    const int *first, *last;
    const int *begin() const { return first; }
    const int *end() const { return last; }
  };
  /// The owned atoms of a part, by their local indices.
  Atoms atoms(int part) const { return {&atom[start[part]], &atom[start[part + 1] - 1] + 1}; }

  /// Sorts the atoms of a part.
  template <class Before> void sort_atoms(int part, Before before)
  {
    std::sort(&atom[start[part]], &atom[start[part + 1] - 1] + 1, before);
  }
  /// Parts of bodies that have atoms on other ranks too.
  const std::vector<int> &on_several_ranks() const { return shared; }
  /// From here on merge() leaves out the parts for which `whole` is true, on all ranks alike.
  template <class Whole> void complete(Whole whole)
  {
    shared.erase(std::remove_if(shared.begin(), shared.end(), whole), shared.end());
  }

  /// One item for each part, with a function merge() that takes in the item of another rank.  After
  /// the call every part has the item of the whole body.  Items are merged in the order of the
  /// ranks and sent as bytes.  Collective.
  template <typename Item> void merge(std::vector<Item> &items) const { merge(items, shared); }

  double memory_usage() const
  {
    return (atom.capacity() + start.capacity() + shared.capacity()) * sizeof(int) +
        keys.capacity() * sizeof(tagint);
  }

 private:
  Comm *comm;
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

  /// Every item goes to the rank that the key names, which returns it merged.
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
    messages = send_to_ranks(comm, std::move(messages), std::move(ranks));
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
    for (const auto &message : send_to_ranks(comm, std::move(messages), std::move(ranks)))
      items[message.part] = message.item;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
