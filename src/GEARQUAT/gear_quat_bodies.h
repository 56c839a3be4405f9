/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Body store: which atoms make a body, who owns it, and what the owner knows.

   A body belongs to the rank that owns its owner atom and migrates with it.  Owned bodies come
   first, then ghost bodies: copies of pose and velocities for atoms whose owner atom is a ghost
   here.  Few bodies lie across the border of two ranks, so only the owner atoms of these are shared
   with their ghosts.  Centers of mass are unwrapped; atoms are placed with their own image flags,
   so that bodies need none.

   A body that reaches further than ghost atoms are seen is large: every rank has it, with its
   history, and moves it as its owner does; its loads are summed over all ranks.  Of all other
   bodies only the owner has the history.

   The fix calls, every step:
     [predict owned states] -> spread_states() -> place_sites() -> [forces] -> gather_loads()
     -> [correct owned states] -> spread_states() -> place_sites()
   where spread_moved() does instead of spread_states() if the frames are written with the states;
   and after every exchange of atoms update_ghosts(). */

#ifndef LMP_GEAR_QUAT_BODIES_H
#define LMP_GEAR_QUAT_BODIES_H

#include "gear_quat_assembly.h"
#include "gear_quat_extended.h"
#include "gear_quat_integrator.h"
#include "gear_quat_sections.h"

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

struct BodyCount;
struct Census;

class Bodies : protected Pointers {
 public:
  Bodies(LAMMPS *lmp, Fix *fix, const Scheme &scheme);

  // Owned bodies come first, then large ones of other ranks, then ghosts, which have no correction.

  int nhere() const { return (int) body.size(); }
  const Body &body_at(int ibody) const { return body[ibody]; }
  const RigidBody &rigid_of(int ibody) const { return body[ibody].rigid; }
  const BodyState &state_of(int ibody) const { return state[ibody]; }
  const Load &load_of(int ibody) const { return load[ibody]; }
  const Correction &last_of(int ibody) const { return last[ibody]; }

  // The rooms that move bodies write states and corrections here, and call spread_states() then, or
  // spread_moved() if they have written the frames of all states, too.

  BodyState &change_state(int ibody) { return state[ibody]; }
  BodyFrame &change_frame(int ibody) { return frame[ibody]; }
  Correction &change_last(int ibody) { return last[ibody]; }
  void forget_work()
  {
    for (auto &correction : last) correction.work = 0.0;
  }

  struct Snapshot {
    std::vector<BodyState> states;
    std::vector<Load> loads;
  };
  Snapshot snapshot() const { return {state, load}; }
  void put_back_states(const Snapshot &saved) { state = saved.states; }
  void put_back_loads(const Snapshot &saved) { load = saved.loads; }

  // bodies that this rank moves by what they need in a step, large ones last and in the same order
  // on all ranks; valid until atoms are exchanged

  std::vector<int> tops;      ///< rotate
  std::vector<int> points;    ///< have no moments of inertia: their orientation stays
  std::vector<int> fresh;     ///< have come in this step and have no history yet

  struct Site {    ///< an owned atom of a body; stays valid until atoms are exchanged
    int atom, body;
    double arm_body[3];
    double wrap[3];    ///< what its image flags take from its unwrapped position
  };
  struct Expected {    ///< position or velocity of a site by the state of its body
    double value[3];
    double size;    ///< what its rounding is relative to
  };
  Expected expected_position(const Site &site) const;
  Expected expected_velocity(const Site &site) const;
  // True if place or velocity of the atom are those of its body, up to rounding.
  bool is_there(const Site &site) const;
  bool is_as_fast(const Site &site) const;
  double atom_mass(int atom) const;
  std::vector<Site> sites;    ///< those at their center of mass, with arms of zero, come first

  int nowned() const { return nown; }
  /// Bodies that this rank moves: owned ones and copies of large ones of other ranks.
  int nmoved() const { return nmove; }
  /// True if every rank has this body.
  bool is_large(int ibody) const { return !large.empty() && body[ibody].large; }
  /// On all ranks.
  bigint number_of_large() const { return nlarge; }
  /// The load without the components that are turned off for this body.
  Load acting(int ibody) const { return acting_load(load[ibody], body[ibody].off); }
  /// The rotation matrix space -> body of a state that spread_states() has seen.
  const double *axes(int ibody) const { return frame[ibody].axes; }
  double *history(int ibody) { return rows.data() + (size_t) ibody * row_size; }
  const double *history(int ibody) const { return rows.data() + (size_t) ibody * row_size; }
  // Of a scheme with a trial row: histories that are kept for a step that may be undone, also if
  // bodies change their ranks in it.
  void keep_histories();
  void put_back_histories();
  bool in_body(int atom) const { return body_id[atom] != 0; }
  /// The user's ID of an atom's body, of ghosts too; 0 for none.
  tagint id_of(int atom) const;
  /// Sites on this rank that are more than points.
  bigint number_of_extended_here() const { return (bigint) extended.sites.size(); }
  /// True if some atoms of bodies, on any rank, are more than points.
  bool has_extended() const { return extended.has_records(); }

  // life cycle, all collective

  /// Build all bodies anew from the atoms; ids: body of every owned atom, 0 for none.
  void create(const std::vector<tagint> &ids, const GivenBodies &given);
  /// Build more bodies, of atoms that are in none.  fresh: in a step, without histories.
  void add(const std::vector<tagint> &ids, const GivenBodies &given, bool fresh);
  /// Build the same bodies anew from the atoms' present masses, positions and velocities.
  void recreate();
  /// Bodies as a restart file has them, in place of those that the command has just made of the
  /// same atoms; the command numbers them and may leave some out.  NONE, and no bodies are left, if
  /// they differ otherwise.  packed: of every owned atom, or null; extended: with such atoms;
  /// group: atoms outside of it are in what bodies the file says, 0 for none.
  enum class Resumed { ALL, FEWER, NONE };
  Resumed resume(const std::vector<const double *> &packed, bool extended, int group);
  /// Ends the run if an atom of a body is of a kind that cannot be followed.
  void refuse_atoms() const;
  /// Before a run, and before atoms are exchanged: where change_box has remapped the atoms of
  /// bodies, these get back their shapes and orientations, and their centers are remapped.  True,
  /// with a warning, if there are any; warns of bodies that another box has deformed otherwise.
  /// Needs no ghosts.  Collective.
  bool follow_box();
  /// The present box is the one that positions of atoms are those of.
  void note_box();
  /// Before a run: bodies that reach further than ghost atoms are seen are large.
  void choose_large();
  /// Find the body of every atom after atoms were exchanged, created or removed; one that not all
  /// of its atoms find becomes large.  Ends the run if a body has lost some of its atoms.
  void update_ghosts();
  /// Ghost atoms learn the IDs of their bodies if all bodies are large.  Collective.
  void tell_ids_to_ghosts()
  {
    if (nlarge == nbodies) tell_ghosts();
  }
  /// True if masses, positions and velocities of all atoms are those of their bodies.  Ends the run
  /// if image flags or another box have torn a body.
  bool atoms_match();
  /// Ends the run if a body has lost some of its atoms, and follows changed atom IDs; needs no
  /// ghosts.
  void check_whole();
  /// The IDs of all bodies, sorted, on all ranks.  Collective.
  std::vector<tagint> all_ids() const;
  /// Gives these masks, by IDs, to all bodies.  True if one had another; collective.
  bool change_masks(const std::map<tagint, Mask> &masks);
  /// Degrees of freedom that rigidity takes from the atoms of a group.
  bigint removed_freedoms(int groupbit);
  /// Bodies on all ranks and atoms in them, as of create() or update_ghosts().
  bigint number() const { return nbodies; }
  bigint number_of_sites() const { return natoms; }
  /// How often bodies have come or gone, the same on all ranks.
  int changes() const { return nchanges; }
  /// An atom of the fix group was created that is in no body yet; it may be added to one.
  void note_stranger(int change) { strangers += change; }
  /// label: of all owned atoms, followed by their ghosts, which receive the same.  Collective.
  void spread_labels(std::vector<double> &label);

  // one step

  /// Fresh bodies have histories now and become like all others.
  void take_in_fresh();
  /// any: something in the scene may make a force; otherwise no loads are gathered.
  void expect_forces(bool any);

  void spread_states();
  /// The same where the frames of all bodies that this rank moves are those of their states.
  void spread_moved();
  /// Positions of all sites, and velocities if anything reads them before the next call.
  void place_sites(bool velocities);
  /// Velocities alone: before a run positions were made by the last step, or by the user.
  void place_velocities();
  /// Orientations and rates of atoms that are more than points, where these were moved alone.
  void place_extended();
  /// torque: of the atoms themselves, used where they are more than points.
  void gather_loads(double **f, double **torque);
  void spread_loads();
  /// Index of the first site that is not at its center of mass.
  size_t first_arm() const { return ncentered; }
  /// Constraint force m a - f of a site under the present loads, its arm from the center of mass,
  /// and its virial: xx yy zz xy xz yz.
  struct ConstraintForce {
    double force[1][3], arm[1][3], virial[6];
  };
  ConstraintForce constraint_force(const Site &site, double **f) const;
  /// Mean of the arms of all sites of each body, owned and ghost, in `force`.  Collective.
  std::vector<Load> centroids();

  // what the fix forwards

  void grow_arrays(int nmax);
  void copy_arrays(int from, int to, int delflag);
  void set_arrays(int atom);
  int packed_size(int atom) const;
  int pack_exchange(int atom, double *buf) const;
  int unpack_exchange(int atom, const double *buf);
  /// Of pack_exchange().
  static AtomParts packed_parts()
  {
    return {SITE_SIZE - 1, Extended::RECORD_SIZE, BODY_SIZE - STATE_SIZE, STATE_SIZE, LAST_SIZE,
            LOAD_SIZE};
  }
  int pack_forward(int n, const int *list, double *buf);
  void unpack_forward(int n, int first, const double *buf);
  int pack_reverse(int n, int first, double *buf);
  void unpack_reverse(int n, const int *list, const double *buf);
  int max_exchange() const;
  int max_forward() const;
  /// The most that was needed at a time, see note_scratch().
  double memory_usage() const;
  /// So many bytes more are allocated now, and will be freed before the next step.
  void note_scratch(double bytes);

 private:
  std::vector<Body> body;
  std::vector<BodyState> state;
  std::vector<Load> load;
  std::vector<Correction> last;    ///< what the last corrector has found

  Fix *fix;
  Scheme scheme;
  int row_size;    ///< doubles of a history, with a trial row also of the one that was kept
  Extended extended;

  int nown = 0, nmove = 0;           ///< owned bodies; with copies of large ones
  bigint nbodies = 0, natoms = 0;    ///< on all ranks: bodies, and atoms in them
  bigint nlarge = 0;                 ///< on all ranks
  int nchanges = 0;                  ///< of nbodies
  std::vector<double> box;    ///< that the bodies were last seen in: shape, corner; may be empty
  int strangers = 0;          ///< atoms created since the fix was defined, in no body
  bool warned_strangers = false;    ///< that there are such atoms
  std::vector<double> rows;         ///< histories of moved bodies
  std::vector<int> owner_atom;      ///< local index of the owner atom of an owned body

  struct Large {
    tagint owner;    ///< atom ID of the owner atom
    int body;
  };
  std::vector<Large> large;    ///< sorted: the same order on all ranks; empty on a single one
  std::vector<double> packed_large;    ///< all of them, packed, while atoms are exchanged
  std::vector<double> parts, sums;     ///< their loads: of the atoms here, and of all

  std::vector<BodyFrame> frame;    ///< of the states of all bodies here

  // These say what a step can leave out, and change only when atoms are exchanged.

  std::vector<int> ghost_tops;    ///< ghost bodies that rotate
  std::vector<tagint> unseen;     ///< owner atoms that sites here do not see
  size_t ncentered = 0;           ///< sites at their center of mass
  bool wrapped = false;    ///< a site is in another periodic image than its unwrapped position
  bool any_ghosts =
      false;    ///< a site, on any rank, has its body on another one, which is not large
  bool any_forces = true;
  double peak = 0.0;    ///< bytes

  // per atom, ghosts too

  std::vector<tagint> body_id;      ///< the user's ID of its body, 0 for none
  std::vector<tagint> owner_tag;    ///< atom ID of the owner of its body
  std::vector<int> owned;           ///< the body it owns, or -1
  std::vector<int> shared;    ///< the same if sites on other ranks are in that body, otherwise -1
  std::vector<std::array<double, 3>> site_body;    ///< from the center of mass, principal frame

  /// packed: IDs of body and owner, arm, size of history; behind the arm what `extended` has
  static constexpr int SITE_SIZE = 6;
  static constexpr int STATE_SIZE = sizeof(BodyState) / sizeof(double);
  static constexpr int LOAD_SIZE = sizeof(Load) / sizeof(double);
  static constexpr int BODY_SIZE = 11 + STATE_SIZE;
  static constexpr int LAST_SIZE = sizeof(Correction) / sizeof(double);

  enum class Forward { GHOSTS, STATES, LOADS, LABELS };
  Forward forward = Forward::STATES;    ///< what forward communication carries
  double *labels = nullptr;             ///< of all atoms, while these are sent

  double present_memory() const;
  void clear(bool extended = false);
  void count();
  void set_number(bigint all);
  void follow_atom_ids();
  void drop_ghosts();
  void tell_ghosts();
  void share_owners();
  int add_owned(int atom);
  void remove_owned(int ibody);
  void update_frame(int ibody);
  void list_bodies();
  void list_sites();
  void list_site(int atom);
  int body_of(int atom) const;
  bool take_stock();
  void pack_large();
  void gather_large();
  void share_large();
  void promote();
  void count_large();
  void sum_loads();
  void sum_large_loads();
  template <bool POSITIONS, bool VELOCITIES> void place();
  template <bool POSITIONS, bool VELOCITIES, bool WRAPPED> void place();

  Census census(int groupbit) const;
  std::vector<BodyCount> count_atoms(const Parts &parts, int groupbit) const;
  Census compare_sites() const;
  void find_place(const Site &site, double *found, double *expected) const;
  void describe(const Site &site, BodyCount &count) const;
  void refuse_tears(const Census &found) const;
  bool tell_of_box(bigint remapped, tagint deformed) const;

  int moved_size() const { return BODY_SIZE + LAST_SIZE + LOAD_SIZE + row_size; }
  /// of a large body: atom ID of its owner atom, and what an owner has
  int large_size() const { return 1 + moved_size(); }
  int pack_moved(int ibody, double *buf) const;
  int unpack_moved(int ibody, const double *buf, int size);
  static int pack_body(const Body &body, const BodyState &state, double *buf);
  static int unpack_body(const double *buf, Body &body, BodyState &state);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
