/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The motion of the bodies of a fix from run to run: which histories go on, and which begin; what
   other fixes have done to velocities; what a restart file keeps.  A step itself is that of
   gear_quat_step.h. */

#ifndef LMP_GEAR_QUAT_MOTION_H
#define LMP_GEAR_QUAT_MOTION_H

#include "gear_quat_start.h"
#include "gear_quat_step.h"

#include <map>
#include <string>

namespace LAMMPS_NS::GearQuat {

class Motion : protected Pointers {
 public:
  /// bodies: empty, with histories of args.scheme.
  Motion(LAMMPS *lmp, Fix *fix, const Arguments &args, const Fleet &fleet, Bodies &bodies,
         Ownership &ownership, Sites &sites, OtherFixes &others, Step &step);

  /// The store has made its bodies, and they receive their masks.  Collective.
  void meet_bodies();
  /// Before a run.  Ends it if the scene does not allow a changing time step.  Collective.
  void init();
  /// Histories have to be made anew.  Rank 0 says why if there are any.
  void forget(const std::string &why);
  /// The masks of the command replace those of a restart file.  Collective.
  void impose_masks();
  /// Before the first step, whose poses, velocities and loads are present.  Collective.
  void begin_run();
  /// True if degrees of freedom depend on forces that LAMMPS' setup may not have shown yet.
  bool awaits_forces() const { return set_up && step.coupling && step.coupling->awaits_forces(); }
  /// The loads are those of all fixes.  Collective.
  void meet_forces() { step.coupling->meet_forces(); }
  void end_run();

  /// Before a step: bodies, and then their histories, take over the velocities that other fixes
  /// have given to atoms, in the end of that step if `end`.  Collective.
  void take_velocities(bigint of_step, bool end);
  /// True before the first step of a run that LAMMPS has set up: begin_steps() has to be called.
  bool begins_steps() const { return set_up; }
  /// For all fixes gear/quat together: histories are made from present loads, by the forces f and
  /// torques of all fixes, unless there are some that agree with them.  Those that need a start make
  /// all others begin anew with them, where a full start is possible.  Collective.
  static void begin_steps(const Fleet &fleet, double **f, double **torque);
  /// Whether contacts may close in the steps that follow, whose friction nobody has been told.
  bool watches_contacts() const { return watches; }
  /// Before a step, now and then: their friction is measured.  f: as begin_steps().  Collective.
  void look_at_contacts(double **f);
  /// The largest error of a body here in the last step, as a length.
  double last_error() const;

  // elements of the fix's vector behind those of Sums

  int elements() const { return of_tolerance() + of_coupling(); }
  double element(int n) const;
  /// 1 if an element grows with the number of bodies.
  int extensive(int n) const;
  /// What a thermostat has taken from the bodies; collective.
  double energy() const { return step.coupling ? step.coupling->energy() : 0.0; }

  /// What is not a history, as sections of a restart file.
  void write(Sections &file) const;
  /// Before the histories of the file arrive: those of its settings that this command does not
  /// state become those of the fix, if histories can go on with them.
  void adopt_scheme(const Sections &file);
  /// The histories of the file have arrived.  If they do not fit this command they start anew, and
  /// rank 0 says so, as it does if they go on with another corrector.  Returns what the file does
  /// not have of the rest, empty if it has all.
  std::string read(const Sections &file);

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
  bool set_up = false;     ///< LAMMPS has evaluated forces for a run, no step of it has begun
  bool resumed = false;    ///< histories are those of a restart file
  std::string movers;      ///< IDs of the other fixes that moved atoms in the last steps

  int of_tolerance() const { return step.tolerance ? (int) Tolerance::ELEMENTS : 0; }
  int of_coupling() const { return step.coupling ? step.coupling->elements() : 0; }
  double longest_step() const;
  ChoiceOfValues scene_of(const MotionSums &here) const;
  ChoiceOfValues scene_of_start(const MotionSums &here) const;
  double edge_rate = 0.0;    ///< fast edge by time, when the number was chosen
  double damping = 0.0;      ///< part of a momentum that forces take in a step
  void measure_friction(double **f);
  bool warned_friction = false, watches = false;
  bigint next_look = 0;    ///< step before which the friction of contacts is measured again
  void tell_friction();
  Scheme foresee_scheme(const MotionSums &here) const;
  Scheme choose_scheme(const MotionSums &here);
  void tell_choice(const ChoiceOfValues &scene, const ChoiceOfValues::Choice &choice) const;
  const char *another_scheme_suits();
  std::string words_of_scheme() const;
  /// True if a start finds all derivatives, as far as it can.
  bool bootstraps() const { return args.start == Arguments::Start::BOOTSTRAP; }
  bool has_to_start(double **f);
  static void start_together(const std::vector<Motion *> &full, const std::vector<bool> &needed);
  Starter starter(bool needed);
  void begin(bool full);
  const char *reason_to_start_anew(double **f);
  bool can_start_anew() const;
  bool forces_can_be_followed() const;
  std::string present_movers() const;
  bool forces_changed(double **f);
  double rounding(int ibody, double force) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
