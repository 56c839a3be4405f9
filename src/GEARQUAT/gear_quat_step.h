/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The motion of the bodies of a fix.  Histories continue from run to run, or start:

     begin_run()        LAMMPS has evaluated the forces before the first step
     start()            before the first step: histories of all fixes gear/quat, which continue
                        or start

   One step of all bodies:

     begin()            predict, place sites
     LAMMPS             forces at the predicted sites
     end()              gather loads, correct, test the error;
                        if it is too large: undo, shorten, predict, place, evaluate, and repeat
                        place sites
     choose_next()      with a changing step, when all fixes have finished this one

   A Step owns the length of the step, the integrator, the bath of all bodies, the control of the
   error, and the limits beyond which a run ends. */

#ifndef LMP_GEAR_QUAT_STEP_H
#define LMP_GEAR_QUAT_STEP_H

#include "gear_quat_arguments.h"
#include "gear_quat_bath.h"
#include "gear_quat_forces.h"
#include "gear_quat_stability.h"
#include "gear_quat_styles.h"
#include "gear_quat_tolerance.h"

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// The present time of a fix.
enum class Phase {
  DEFINED,      ///< the command has made the bodies, whose atoms the user may still change
  COMPARED,     ///< bodies were compared with their atoms, or are from a restart file; no run yet
  SET_UP,       ///< LAMMPS has set up a run
  READY,        ///< histories are ready for its first step
  BEGUN,        ///< in a step, which LAMMPS evaluates forces for
  CORRECTED,    ///< a step has ended; states and atoms are those of the prediction
  ENDED,        ///< a step has ended, and atoms have its states
  BETWEEN       ///< a run has ended
};

class Step;

/// The form of all sentences about rates, without a full stop.
std::string words_of(const Rate &rate);

/// All fixes gear/quat of a run, in the order in which they begin a step.  Their bodies act on each
/// other, so their histories start together.
struct Fleet {
  std::vector<Step *> members;

  /// The fix as a fix gear/quat, null for a fix of another style.
  const Step *find(const Fix *fix) const;
  /// True if a fix that integrates in time moves this owned atom.
  bool moves(const Fix *fix, const Atom *atom, int i) const;
};

/// Starts the histories of these fixes together, with steps of h.  Atoms are then as before.
/// Collective.
void start_together(LAMMPS *lmp, const std::vector<Step *> &fixes, double h);

class Step : public Scene {
 public:
  /// tally(vflag, f): adds the virial of the constraint forces, computed from the forces f on atoms.
  using Tally = std::function<void(int, double **)>;
  Step(const Scene &scene, const Fleet &fleet, Tally tally);

  Phase phase = Phase::DEFINED;
  bool had_run() const { return phase >= Phase::SET_UP; }
  bool continues() const { return started; }    ///< histories exist, also those of a restart file
  /// True once bodies have histories of the present length.
  bool started = false;

  // before a run; all collective

  /// The store has made its bodies; sets their masks.
  void meet_bodies();
  /// Ends the run on all ranks with a reason: a time step of zero, r-RESPA with different steps, or
  /// atoms that another fix moves too.
  void refuse_scene() const;
  /// Ends the run if other fixes change atoms of bodies, or do not allow a changing time step.
  void init();
  /// Writes the report to screen and log on rank 0, if keyword report requests it: what is on, what is
  /// off and why, and which pairs of atoms cost time and move nothing.  In any case it warns of a pair
  /// style that acts between atoms of a body.  To be called in setup(), when neighbor lists are built
  /// and bodies have their ghosts.
  void report() const;
  /// Discards the histories.  Rank 0 prints the reason if there are any.
  void forget(const std::string &why);
  /// Replaces the masks of a restart file by the masks of the command.
  void impose_masks();
  /// Called when poses, velocities and loads are present.
  void begin_run();
  /// Warns of rates that have become too large for the step.
  void end_run();
  /// Histories and integrator adopt LAMMPS' time step.
  void follow_length();

  // a step; f, torque: of atoms; all collective

  /// f, torque: of the previous step, from all pair styles and fixes.
  void start(double **f, double **torque);
  void begin(int vflag, double **f);
  /// f, torque: of the predicted sites.
  void end(double **f, double **torque);
  /// Chooses the next step; with keyword tolerance only.
  void choose_next();

  // elements of the fix's vector after those of the bodies

  int elements() const { return of_tolerance() + bath.elements(); }
  double element(int n);
  /// 1 if an element is proportional to the number of bodies.
  int extensive(int n) const { return bath.extensive(n - of_tolerance()); }
  /// The energy that a thermostat has removed from the bodies.
  double energy() const { return bath.energy(); }

  // restart files

  /// Writes the state other than histories.
  void write(Fields &file);
  /// Before the histories of the file arrive: settings of the file that this command does not state
  /// are adopted, if histories can continue with them.
  void adopt_scheme(Fields &file);
  /// The histories of the file have arrived.  If they do not fit this command, histories start
  /// again, and rank 0 prints a message.  False if the file is damaged.
  bool read(Fields &file);

  const Scheme &scheme() const { return tolerance ? tolerance->scheme() : present; }
  double length() const { return time_step.length(); }
  /// The current integrator; null while there are no histories.
  const Integrator *present_integrator() const { return started ? integrator.get() : nullptr; }

  TimeStep time_step;
  std::unique_ptr<Tolerance> tolerance;    ///< null: the step is LAMMPS' own
  Bath bath;
  bool velocities_read = true;    ///< by other styles, between begin() and end()

 private:
  friend class Start;
  const Fleet &fleet;
  Scheme present;    ///< without keyword tolerance
  Tally tally;
  std::unique_ptr<Integrator> integrator;
  int vflag_of_step = 0;           ///< LAMMPS' vflag when the step began
  std::map<tagint, Mask> masks;    ///< of the command, by the IDs of bodies

  /// Settings in a restart file: histories continue only if those before STATES_CORRECTOR are the
  /// same; from TCHAIN on, where they are off (0) they may differ.
  static constexpr int FORMULATION = 0, VALUES = 1, TUNED = 2, TOLERANCE = 4, TCHAIN = 8,
                       STATES_CORRECTOR = 11, STARTED = 12, SETTINGS = 13;
  using Settings = std::array<double, SETTINGS>;
  Settings of_file = {};
  Settings settings() const;
  std::vector<std::string> other_settings(const Settings &mine) const;
  void fields(Fields &v);
  int of_tolerance() const { return tolerance ? Tolerance::ELEMENTS : 0; }

  // start

  /// True unless start zero or a tolerance is given: a start determines as many derivatives as it can.
  bool bootstraps() const { return args.start == Arguments::Start::BOOTSTRAP && !tolerance; }
  bool has_to_start(double **f);
  /// History of one body from its state and the load that acts on it.  terms: 2 for the paper's
  /// start, in which all derivatives from the second on are zero, or 3 with the load.
  void seed(int ibody, int terms);
  /// The same for all bodies.
  void seed_local(int terms);
  void note_start();
  const char *reason_to_start_anew(double **f);
  bool can_start_anew() const;
  bool forces_can_be_followed() const;
  bool forces_changed(double **f);
  double rounding(int ibody, double force) const;

  // the number of values

  double edge_of_start = 0.0;    ///< fast edge in the last start
  double edge_rate = 0.0;        ///< the same divided by the step, if the number was chosen
  Choice choose(double edge, int present = 0) const;
  double fast_edge(MotionSums here) const;
  void choose_scheme(double edge);
  const char *another_scheme_suits() const;

  // the table of rates

  std::vector<Rate> rates;    ///< of the motion of bodies, as of the last look
  std::string warned;         ///< of this rate
  void note_rates(double edge);
  std::vector<Rate> all_rates(double h) const;
  void warn_of_rates();

  // limits

  MotionLimits limits;    ///< for the current step and box
  void find_limits(double h);
  /// When forces have been evaluated: ends the run if one of these fixes has moved an atom of a body.
  void watch_places() const;
  std::vector<const Fix *> watched;
  void refuse_fixes();
  void warn_of_noise() const;
  void watch_load(int ibody, double **f) const;
  void watch(int ibody, double **f) const;
  void watch_all(double **f) const;
  [[noreturn]] void stop(int ibody, const BodyState &s, double h, double **f) const;
  std::string what_happened(int ibody, const BodyState &s, double h) const;
  std::string remedy(int ibody, double h) const;

  // a step

  void predict(double **f);
  void place_prediction();
  /// Of a block: the loads that act, with scaled forces, and the scaled centers of a prediction.
  struct Scaled {
    Load loads[LANES];
    double centers[LANES][3];
  };
  Block block_of(const std::vector<int> &list, size_t first, size_t most);
  void scale(Block &block, const int *ids, Scaled &scaled) const;
  void correct(double **f, bool states);
  void sum(const std::vector<int> &list);
  template <bool ARE_POINTS> void correct(const std::vector<int> &list, double **f, bool states);
  bool has_to_place() const;
  /// After a step the fix reads its states itself.
  bool reads_states() const { return tolerance || bath.reads_states() || scheme().is_verlet(); }
  void place_correction();
  void shorten();
  void accept(double **f);

  // the length of the step

  void make_integrator();
  void set_scheme(const Scheme &scheme);
  void adopt_length();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
