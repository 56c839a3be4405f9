/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The motion of the bodies of a fix across runs: histories that continue or start, changes of
   velocities by other fixes, and restart data.  A single step is in gear_quat_step.h. */

#ifndef LMP_GEAR_QUAT_MOTION_H
#define LMP_GEAR_QUAT_MOTION_H

#include "gear_quat_start.h"
#include "gear_quat_step.h"
#include "gear_quat_vibrations.h"

#include <map>
#include <optional>
#include <string>

namespace LAMMPS_NS::GearQuat {

class Motion : protected Pointers {
 public:
  /// bodies: empty, with histories of args.scheme.
  Motion(LAMMPS *lmp, Fix *fix, const Arguments &args, const Fleet &fleet, Bodies &bodies,
         Ownership &ownership, Sites &sites, OtherFixes &others, Step &step);

  /// The store has made its bodies; sets their masks.  Collective.
  void meet_bodies();
  /// Called before a run; ends it if the simulation does not allow a changing time step.
  /// Collective.
  void init();
  /// Discards the histories.  Rank 0 prints the reason if there are any.
  void forget(const std::string &why);
  /// Replaces the masks of a restart file by the masks of the command.  Collective.
  void impose_masks();
  /// Called before the first step, when its poses, velocities and loads are present.  Collective.
  void begin_run();

  /// Before a step: bodies, and then their histories, adopt velocities that other fixes have given
  /// to atoms, at the end of that step if `end`.  Collective.
  void take_velocities(bigint of_step, bool end);
  /// True before the first step of a run that LAMMPS has set up; begin_steps() must then be called.
  bool begins_steps() const { return set_up; }
  /// For all fixes gear/quat together: makes histories from present loads, with the forces f and
  /// torques of all fixes, unless consistent histories exist.  If one fix needs a start, all others
  /// start with it, where a full start is possible.  Collective.
  static void begin_steps(const Fleet &fleet, double **f, double **torque);
  /// After a step: warns if vibrations or rotations have become too fast for the step since
  /// histories began.  Collective in the last step of a run and a few others.
  void look_at_vibrations();
  /// The largest error of a body on this rank in the last step, as a length.
  double last_error() const;

  // elements of the fix's vector after the elements of Sums

  int elements() const { return of_tolerance() + of_coupling(); }
  double element(int n) const;
  /// 1 if an element is proportional to the number of bodies.
  int extensive(int n) const;
  /// The energy that a thermostat has removed from the bodies; collective.
  double energy() const { return step.coupling ? step.coupling->energy() : 0.0; }

  /// Writes the state other than histories.
  void write(Fields &file);
  /// Before the histories of the file arrive: settings of the file that this command does not state
  /// are adopted, if histories can continue with them.
  void adopt_scheme(Fields &file);
  /// The histories of the file have arrived.  If they do not fit this command, histories start
  /// again, and rank 0 prints a message, as it does if they continue with another corrector.
  /// False if the file is damaged.
  bool read(Fields &file);

 private:
  Fix *fix;
  const Arguments &args;
  const Fleet &fleet;
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;
  OtherFixes &others;
  Step &step;
  std::map<tagint, Mask> masks;    ///< of the command, by the IDs of bodies
  bool set_up = false;    ///< LAMMPS has evaluated forces for a run whose first step has not begun
  std::string movers;     ///< IDs of the other fixes that moved atoms in the last steps

  /// Settings in a restart file: histories continue only if most of them are the same.
  struct Settings {
    double formulation, values, compensate, tolerance, tuned;
    double isokinetic, chains, chain_length, box, box_chain;
    bool states_corrector, started;

    template <class V> void fields(V &v)
    {
      v(formulation, values, compensate, tolerance, tuned, isokinetic, chains, chain_length, box,
        box_chain, states_corrector, started);
    }
  };
  Settings of_file = {};
  Settings settings() const;
  std::vector<std::string> other_settings(const Settings &mine) const;
  void fields(Fields &v);

  int of_tolerance() const { return step.tolerance ? (int) Tolerance::ELEMENTS : 0; }
  int of_coupling() const { return step.coupling ? step.coupling->elements() : 0; }
  double longest_step() const;
  ChoiceOfValues scene_of(const MotionSums &here) const;
  ChoiceOfValues scene_of_start(const MotionSums &here) const;
  double edge_rate = 0.0;    ///< fast edge divided by the step, if the number was chosen
  Vibrations vibrations;
  double advised_step = HUGE_VAL;          ///< by the last warning about vibrations
  std::optional<ChoiceOfValues> chosen;    ///< input to the choice of a start that has not ended
  bool warned_values = false;
  Scheme foresee_scheme(const MotionSums &here) const;
  Scheme choose_scheme(const MotionSums &here);
  void tell_choice(const ChoiceOfValues &scene, const ChoiceOfValues::Choice &choice) const;
  void warn_of_vibrations(const ChoiceOfValues &scene, const Scheme &scheme, bool begins);
  void warn_of_values(const ChoiceOfValues &scene);
  const char *another_scheme_suits();
  std::string words_of_scheme() const;
  /// True unless start zero or a tolerance is given: a start determines as many derivatives as it can.
  bool bootstraps() const { return args.start == Arguments::Start::BOOTSTRAP && !step.tolerance; }
  bool has_to_start(double **f);
  static void start_together(const std::vector<Motion *> &full, const std::vector<bool> &needed);
  Starter starter(bool needed);
  void begin();
  const char *reason_to_start_anew(double **f);
  bool can_start_anew() const;
  bool forces_can_be_followed() const;
  std::string present_movers() const;
  bool forces_changed(double **f);
  double rounding(int ibody, double force) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
