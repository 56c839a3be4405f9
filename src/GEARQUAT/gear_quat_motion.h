/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Motion of all owned bodies: predicted, then corrected with the loads that the store has gathered.
   Knows which laws hold in this run (masks, isokinetic, thermostat, tolerance) and decides once a
   step, not once a body, which of them the loop over bodies has to heed.

   The fix calls, before the first step of a run: [gathers present loads] begin_steps(); every step:
   predict(); [places sites, forces, gathers loads]; correct(); and with a changing step
   repeats_step(), after which it places sites, calls evaluate(), gathers loads and corrects once
   more if so; and when all fixes have finished the step choose_step(). */

#ifndef LMP_GEAR_QUAT_MOTION_H
#define LMP_GEAR_QUAT_MOTION_H

#include "gear_quat_arguments.h"
#include "gear_quat_blowup.h"
#include "gear_quat_bootstrap.h"
#include "gear_quat_isokinetic.h"
#include "gear_quat_thermostat.h"
#include "gear_quat_tolerance.h"

#include <memory>
#include <string>

namespace LAMMPS_NS::GearQuat {

class Motion : protected Pointers {
 public:
  /// bodies: empty, with histories of args.scheme.
  Motion(LAMMPS *lmp, Fix *fix, const Arguments &args, Bodies &bodies, Ownership &ownership,
         Sites &sites);

  /// The store has made its bodies, and they receive their masks.  Collective.
  void meet_bodies();
  /// Before a run.  Ends it if the scene does not allow a changing time step.  Collective.
  void init();
  /// LAMMPS' time step may have changed; histories keep their polynomials.
  void follow_time_step();
  /// Histories have to be made anew.  Rank 0 says why if there are any.
  void forget(const std::string &why);
  /// The masks of the command replace those of a restart file.  Collective.
  void impose_masks();
  /// Poses, velocities and loads are those of the first step.  Collective.
  void begin_run();

  /// True once bodies have histories.
  bool has_started() const { return started; }
  /// Histories take over the velocities that other fixes have given to these bodies.
  void take_velocities(const std::vector<int> &changed);
  /// True before the first step of a run that LAMMPS has set up: begin_steps() has to be called.
  bool begins_steps() const { return set_up; }
  /// Loads are the present ones of all fixes, f what they were gathered from.  Histories are made
  /// from them, unless there are some that agree with them.  all: of all fixes gear/quat; those
  /// that need a start make all others begin anew with them, where a full start is possible.
  /// Collective.
  static void begin_steps(const std::vector<Motion *> &all, double **f);
  /// True if a start finds all derivatives, as far as it can.
  bool bootstraps() const { return args.start == Arguments::Start::BOOTSTRAP; }
  /// The largest error of a body here in the last step, as a length.
  double last_error() const;
  /// True if this motion is that of the atom.
  bool moves(int atom) const { return ownership.in_body(atom); }
  /// Both leave states with their frames.
  void predict(double **f);
  /// f: forces that the loads were gathered from.
  void correct(double **f);

  /// True if degrees of freedom depend on forces that LAMMPS' setup may not have shown yet.
  bool awaits_forces() const { return set_up && thermostat; }
  /// The loads are those of all fixes.  Collective.
  void meet_forces() { thermostat->meet_forces(); }

  bool changes_step() const { return tolerance != nullptr; }
  bool is_tuned() const { return args.scheme.tuned; }
  /// After correct(): true if the step has failed.  After the call histories and states are those
  /// of the prediction of a shorter one.  f: as in correct().  Collective.
  bool repeats_step(double **f);
  void evaluate(int vflag) { tolerance->evaluate(vflag); }
  /// To be called with tolerance only, when all fixes have finished the step.  Collective.
  void choose_step();
  void end_run()
  {
    if (awaits_forces()) thermostat->tell_freedoms();
    if (tolerance) tolerance->end_run();
  }

  // elements of the fix's vector behind those of Sums

  int elements() const;
  double element(int n) const;
  /// What a thermostat has taken from the bodies; collective.
  double energy_of_thermostat() const { return thermostat ? thermostat->energy() : 0.0; }
  /// 1 if an element grows with the number of bodies.
  int extensive(int n) const;
  /// Null before the start.
  const Integrator *present_integrator() const;

  /// The part of a restart file that is not a history.
  struct Checkpoint {
    double formulation, values, compensate, started, h, variable, tuned;
    Tolerance::Checkpoint tolerance;
    IsokineticConstraint::Checkpoint isokinetic;
    Thermostat::Checkpoint thermostat;
  };
  Checkpoint checkpoint() const;
  /// The histories of the file are about to arrive.  If they do not fit this command they start
  /// anew, and rank 0 says so, as it does if they go on with another corrector.
  void restore(const Checkpoint &saved);

 private:
  Fix *fix;
  const Arguments &args;
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;
  Blowup blowup;
  std::map<tagint, Mask> masks;                        ///< of the command, by the IDs of bodies
  std::unique_ptr<IsokineticConstraint> isokinetic;    ///< null without
  std::unique_ptr<Thermostat> thermostat;              ///< null without
  bool coupled;    ///< all bodies are corrected together, by one of these two
  std::unique_ptr<Tolerance> tolerance;    ///< null: the step is LAMMPS' own
  std::unique_ptr<Integrator> integrator;

  bool started = false;      ///< histories are those of the step of the integrator
  bool set_up = false;       ///< LAMMPS has evaluated forces for a run, no step of it has begun
  double last_step = 0.0;    ///< the time step of the last step that was made
  MotionLimits limits;       ///< of the present step
  std::string movers;        ///< IDs of the other fixes that moved atoms in the last steps

  /// The time step of the histories; 0 before the first run.
  double step() const { return integrator ? integrator->step() : 0.0; }
  const Scheme &present_scheme() const;
  int elements_of_tolerance() const { return tolerance ? (int) Tolerance::ELEMENTS : 0; }
  double longest_step() const;
  void make_integrator(double step);
  bool has_to_start(double **f);
  Party party(bool needed);
  void begin(bool full);
  const char *reason_to_start_anew(double **f);
  bool can_start_anew() const;
  bool forces_can_be_followed() const;
  std::string present_movers() const;
  bool forces_changed(double **f);
  double rounding(int ibody, double force) const;
  /// Of a corrected state.
  void check_limits(int ibody, double **f) const
  {
    const BodyState &state = bodies.state_of(ibody);
    if (!limits.keep(state)) blowup.stop(ibody, state, last_step, f);
  }
  /// The load that moves a body.
  Load acting(int ibody) const
  {
    if (isokinetic) return isokinetic->acting(ibody);
    return thermostat ? thermostat->acting(ibody) : bodies.acting(ibody);
  }
  template <bool MASKED> void correct_bodies(double **f);
  template <bool MASKED, bool POINT, bool CHANGING> void correct_body(int ibody, double **f);
  void correct_together(double **f);
  void hold_step(double **f);
  void take_over_values();
  Blowup::Cause unstable_thermostat(double h) const;
  void measure();
  void begin_fresh(double **f);
  void predict_bodies(double **f);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
