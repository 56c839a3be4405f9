/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The store of bodies: columns with an element for each body present on this rank, and lists of
   indices into them.

   Owned bodies come first, then copies of large bodies that other ranks own, then ghost bodies.
   This rank moves owned bodies and copies, and has their histories; of a ghost body it has only the
   data that the atoms of this rank need.  gear_quat_ownership.h determines the bodies,
   gear_quat_sites.h their atoms.  The store itself contains neither atoms nor messages between
   ranks.

   Centers of mass are unwrapped: atoms are placed with their own image flags, so bodies need no
   image flags. */

#ifndef LMP_GEAR_QUAT_BODIES_H
#define LMP_GEAR_QUAT_BODIES_H

#include "gear_quat_integrator.h"

#include "lmptype.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// The properties of a body, which travel with its owner atom.  Its bytes have no gaps.
struct Body {
  RigidBody rigid;
  tagint id;        ///< the user's: molecule ID, group number or custom value
  tagint natoms;    ///< sites
  double extent;    ///< largest distance of a site from the owner atom
  int from_file;    ///< mass and inertia were given, not summed
  int fresh;        ///< inserted in this step: no history yet
  int large;        ///< on several ranks: some sites have no ghost of the owner atom
  Mask off;         ///< components of the load that are turned off
  /// With a box that another fix changes: the periodic image of the owner atom, from which the
  /// center is unwrapped, and with fix deform remap v the image that has the velocity.
  std::array<int, 3> image;
  int unused = 0;

  /// Displacement per radian of the outermost part of the body, a site or a part of a solid.
  double reach() const
  {
    const double *i = rigid.inertia;
    return std::max(extent, std::sqrt(std::max({i[0], i[1], i[2]}) / rigid.mass));
  }
  /// The error of a step as a length.
  double length(const Correction &error) const
  {
    return std::max(error.position_error(), reach() * error.angle_error());
  }
};

class Bodies {
 public:
  /// No bodies; histories will have the format of the scheme.
  explicit Bodies(const Scheme &scheme);
  /// Changes the scheme of histories; existing histories lose their rows.
  void set_scheme(const Scheme &other);

  int nhere() const { return (int) body.size(); }
  int nowned() const { return nown; }
  /// Bodies that this rank moves: owned bodies, and copies of large bodies of other ranks.
  int nmoved() const { return nmove; }
  /// Bodies on all ranks.
  bigint number() const { return nbodies; }
  /// The number of insertions and removals, the same on all ranks.
  int changes() const { return nchanges; }

  // bodies that this rank moves, by the work in a step; large bodies last and in the same order on
  // all ranks; valid until atoms are exchanged

  std::vector<int> tops;      ///< rotate
  std::vector<int> points;    ///< have no moments of inertia: their orientation is constant
  std::vector<int> fresh;     ///< were inserted in this step and have no history yet

  /// Calls act(ibody) for points and then for tops.
  template <class Act> void for_moved(Act act) const
  {
    for (const auto *list : {&points, &tops})
      for (const int ibody : *list) act(ibody);
  }

  // columns; code that moves bodies writes states and corrections, and frames or update_frames()

  std::vector<Body> body;
  std::vector<BodyState> state;
  std::vector<Load> load;
  std::vector<Correction> last;    ///< results of the last corrector
  std::vector<BodyFrame> frame;    ///< of the states

  /// True if every rank has this body.
  bool is_large(int ibody) const { return !large.empty() && body[ibody].large; }
  /// The load without the components that are turned off for this body.
  Load acting(int ibody) const { return acting_load(load[ibody], body[ibody].off); }
  /// The history of a body; only for bodies that this rank moves.
  double *history(int ibody) { return rows.data() + (size_t) ibody * row_size; }

  void update_frame(int ibody);
  void update_frames(const std::vector<int> &list)
  {
    for (const int ibody : list) update_frame(ibody);
  }
  void forget_work()
  {
    for (auto &correction : last) correction.work = 0.0;
  }
  /// Fresh bodies have received histories; from now on they are treated like all others.
  void take_in_fresh();
  // With trial rows: saves histories for a step that may be undone, even if bodies move to other
  // ranks in it.
  void keep_histories();
  void put_back_histories();

  struct Snapshot {
    std::vector<BodyState> states;
    std::vector<Load> loads;
  };
  Snapshot snapshot() const { return {state, load}; }
  void put_back(const Snapshot &saved) { state = saved.states, load = saved.loads; }

  // for ownership

  std::vector<int> large;         ///< copies and owned large bodies, in the same order on all ranks
  std::vector<int> ghost_tops;    ///< ghost bodies that rotate

  /// Removes all bodies except owned bodies.
  void drop_copies() { resize(nmove = nown), large.clear(); }
  /// The index of another body, the last one: first owned bodies, then copies of large ones, then
  /// ghost bodies.
  int add_owned() { return ++nown, add_copy(); }
  int add_copy() { return ++nmove, add_ghost(); }
  int add_ghost() { return resize(nhere() + 1), nhere() - 1; }
  /// Replaces this body by the last owned body.  There must be no copies.
  void remove_owned(int ibody);
  /// Body n becomes body from[n]; a permutation of owned bodies.  There must be no copies.
  void permute(const std::vector<int> &from);
  void clear() { nown = 0, drop_copies(); }
  /// Makes the lists and the frames of all bodies.
  void list();
  /// all: bodies on all ranks.
  void set_number(bigint all);

  /// The data of a body: those that a ghost needs; those that move with it to another rank, into a
  /// restart file, or to the copies of a large body; and all.
  enum Part { OF_GHOST, MOVING, ALL };
  /// As doubles.
  int packed_size(Part part) const;
  /// Doubles of a moving body with any scheme.
  int most_packed() const { return packed_size(MOVING) + std::max(0, MAX_SIZE - row_size); }
  int pack(int ibody, Part part, double *buf) const;
  /// size: of the data, less if the history, at their end, has another scheme.
  void unpack(int ibody, Part part, const double *buf, int size);

  double memory_usage() const;

 private:
  Scheme scheme;
  int row_size;
  int nown = 0, nmove = 0;
  bigint nbodies = 0;
  int nchanges = 0;    ///< of nbodies, insertions and removals

  std::vector<double> rows;    ///< histories

  /// Calls act(column, its elements of a body).
  template <class Self, class Act> static void for_columns(Self &self, Part part, Act act)
  {
    act(self.body, 1);
    act(self.state, 1);
    if (part == OF_GHOST) return;
    act(self.last, 1);
    act(self.load, 1);
    act(self.rows, self.row_size);
    if (part == ALL) act(self.frame, 1);
  }
  void resize(int nhere);
  void list_bodies();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
