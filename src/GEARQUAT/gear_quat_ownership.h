/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The assignment of atoms to bodies and of bodies to ranks: fills the store of bodies, and carries
   messages about bodies between ranks.

   A body belongs to the rank that owns its owner atom and migrates with it.  Ranks whose atoms
   belong to it have a ghost body: a copy of pose and velocities, found through the ghost of the
   owner atom.  Few bodies extend across the border of two ranks, so only the owner atoms of these
   bodies are shared with their ghosts.

   A body becomes large when one of its atoms finds no ghost of the owner atom: every rank has this
   body, with its history, and moves it like its owner; its loads are summed over all ranks.  All
   other bodies have a history only on the rank of the owner.

   The fix calls update() after every exchange of atoms, and spread_states() whenever states have
   changed, or spread_moved() if their frames were written with them. */

#ifndef LMP_GEAR_QUAT_OWNERSHIP_H
#define LMP_GEAR_QUAT_OWNERSHIP_H

#include "gear_quat_assembly.h"
#include "gear_quat_bodies.h"
#include "gear_quat_extended.h"
#include "pointers.h"

#include <cstddef>
#include <map>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// Counts, the same on all ranks; bodies are given by their IDs, 0 for none.
struct Comparison {
  bigint removed_freedoms;    ///< removed by rigidity from bodies wholly in the group
  tagint divided;             ///< a body with some of its atoms in the group
  tagint broken;              ///< a body that has lost atoms, or that is given by several IDs
};

class Ownership : protected Pointers {
 public:
  Ownership(LAMMPS *lmp, Fix *fix, Bodies &bodies);

  // atoms

  bool in_body(int atom) const { return assigned[atom].id != 0; }
  /// The user's ID of an atom's body, also for ghosts; 0 for none.
  tagint id_of(int atom) const;
  /// The index of an owned atom's body, as of update(); -1 for none.
  int body_of(int atom) const { return atom < (int) index.size() ? index[atom] : -1; }
  /// The index of the body whose owner is this atom, -1 for none.
  int owned_by(int atom) const { return assigned[atom].owned; }
  /// The local index of the owner atom of an owned body.
  int owner_of(int ibody) const { return owner_atom[ibody]; }
  /// The vector from the center of mass of the body to an atom, along the principal axes.
  const double *arm_of(int atom) const { return assigned[atom].arm; }
  double mass_of(int atom) const;
  /// True if the mass of an atom has changed since its body was made from masses.
  bool has_other_mass(int atom) const
  {
    return mass_of(atom) != assigned[atom].mass && !bodies.body[index[atom]].from_file;
  }
  /// label: of all owned atoms, followed by their ghosts, which receive the same.  Collective.
  void spread_labels(std::vector<double> &label) { send(Content::OF_ATOMS, label.data(), 1); }

  /// Positions and orientations of extended atoms in their bodies.
  Extended &extended() { return records; }
  const Extended &extended() const { return records; }

  // life cycle, all collective

  /// Builds all bodies from the atoms; ids: body of every owned atom, 0 for none.
  void create(const std::vector<tagint> &ids, const GivenBodies &given);
  /// Builds more bodies, from atoms that are in none.  fresh: in a step, without histories.
  void add(const std::vector<tagint> &ids, const GivenBodies &given, bool fresh);
  /// Rebuilds the same bodies from the atoms' present masses, positions and velocities.  Ends the run
  /// if image flags or another box than the last one have torn or changed a body.
  void recreate();
  /// Replaces the bodies that the command has just made by the bodies of a restart file, made of
  /// the same atoms; the command numbers them.  Returns false, and removes all bodies, if they
  /// differ.  packed: of every owned atom, or null; with_extended: there are records of extended
  /// atoms; group: the file gives the bodies of atoms outside of the group, 0 for none.
  bool resume(const std::vector<const double *> &packed, bool with_extended, int group);
  /// Finds the body of every atom after atoms were exchanged, created or removed; a body that some
  /// of its atoms cannot find becomes large.  Ends the run if a body has lost some of its atoms.
  void update();
  /// Ends the run if a body has lost some of its atoms, and updates changed atom IDs; needs no
  /// ghosts.
  void check_whole();
  /// Compares numbers of atoms with their bodies.  Needs no ghost atoms, so it can be called at any
  /// time.  groupbit: the group whose degrees of freedom are requested, 0 for none.
  /// Collective.
  Comparison count_atoms(int groupbit = 0) const;
  /// The IDs of all bodies, sorted, on all ranks.  Collective.
  std::vector<tagint> all_ids() const;
  /// Sets these masks, by IDs, for all bodies.  True if one has changed; collective.
  bool change_masks(const std::map<tagint, Mask> &masks);
  /// Atoms in bodies, on all ranks.
  bigint number_of_atoms() const { return natoms; }
  /// The box of the positions of bodies, as Domain::h and boxlo.
  const std::vector<double> &box() const { return last_box; }
  /// Sets this box to the current box of LAMMPS.
  void note_box();

  // a step

  void spread_states();
  /// Like spread_states(), if the frames of all bodies that this rank moves match their states.
  void spread_moved();
  /// Sums over the atoms on this rank, for each body here, become sums over the atoms on all ranks
  /// for bodies that this rank moves.  Sums: of at most MOST_NUMBERS doubles.
  static constexpr int MOST_NUMBERS = 12;
  template <class Sums> void sum(std::vector<Sums> &column)
  {
    static_assert(sizeof(Sums) <= MOST_NUMBERS * sizeof(double));
    sum(reinterpret_cast<double *>(column.data()), sizeof(Sums) / sizeof(double));
  }
  /// Sends the values of their owners to ghost bodies.
  template <class Values> void spread(std::vector<Values> &column)
  {
    if (any_ghosts)
      send(Content::OF_BODIES, reinterpret_cast<double *>(column.data()),
           sizeof(Values) / sizeof(double));
  }

  // functions called by the fix

  void grow_arrays(int nmax);
  void copy_arrays(int from, int to, int delflag);
  void set_arrays(int atom);
  int packed_size(int atom) const;
  int pack_exchange(int atom, double *buf) const;
  int unpack_exchange(int atom, const double *buf);
  int pack_forward(int n, const int *list, double *buf);
  void unpack_forward(int n, int first, const double *buf);
  int pack_reverse(int n, int first, double *buf);
  void unpack_reverse(int n, const int *list, const double *buf);
  int max_exchange() const { return ATOM_SIZE + Extended::RECORD_SIZE + 1 + bodies.most_packed(); }
  int max_forward() const { return 2 + bodies.packed_size(Bodies::OF_GHOST); }
  /// Including the store.
  double memory_usage() const;

 private:
  Fix *fix;
  Bodies &bodies;
  Extended records;

  bigint natoms = 0;          ///< on all ranks
  bool any_ghosts = false;    ///< on some rank an atom belongs to a body of another rank that is
                              ///< not large; changes only when atoms are exchanged
  std::vector<double> last_box;
  std::vector<int> owner_atom;    ///< local index of the owner atom of an owned body
  std::vector<int> index;         ///< see body_of()
  std::vector<tagint> unseen;     ///< owner atoms of which this rank has not even a ghost
  std::map<tagint, int> large;    ///< indices of large bodies, by the atom IDs of their owners

  /// An atom, also a ghost.
  struct Assigned {
    tagint id = 0;       ///< the user's ID of its body, 0 for none
    tagint owner = 0;    ///< atom ID of the owner of its body
    double arm[3] = {};
    double mass = 0.0;    ///< when the body was made

    // does not travel with the atom

    int owned = -1;     ///< the body it owns, or -1
    int shared = -1;    ///< the same if atoms on other ranks are in that body, otherwise -1
  };
  std::vector<Assigned> assigned;
  /// Doubles of an atom before its record as an extended atom, the size of its body, and that body.
  static constexpr int ATOM_SIZE = offsetof(Assigned, owned) / sizeof(double);

  // the data in a message: the IDs of bodies and ghost bodies, or numbers of all atoms or all bodies

  enum class Content { GHOSTS, OF_ATOMS, OF_BODIES };
  Content content = Content::GHOSTS;
  double *numbers = nullptr;
  int width = 0;    ///< of an atom or a body

  void clear(bool with_extended = false);
  void count();
  void follow_atom_ids();
  void drop_copies();
  void share_owners();
  int add_owned(int atom);
  void remove_owned(int ibody);
  int find_body(int atom) const;
  void find_bodies();
  void order_bodies();
  bool all_found();
  void share_large();
  void promote();

  void send(Content what, double *values = nullptr, int size = 0);
  void add_from_ghosts(Content what, double *values, int size);
  void sum(double *values, int size);
  double *numbers_of(int atom) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
