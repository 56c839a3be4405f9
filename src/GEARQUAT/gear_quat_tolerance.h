/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword tolerance inside LAMMPS: the largest errors of all bodies on all ranks, the control
   law of gear_quat_remembered_loads.h, and the outputs that depend on times.

   When histories start: begin().
   In every step: begin_step(); prepare() before the prediction; correct() for every body, or
   note_prediction() and note_correction() around the correction by a bath; and accepts().  If a
   step is rejected, the caller restores the histories, calls shorten_loads() and shorten_step(), and
   repeats it.  At the end of the step: choose(), TimeStep::change(), and order_output().  After
   prepare(), shorten_loads() and choose() a new integrator is needed.  In addition,
   announce_output() before the first step of a run.

   A step is repeated with another length during final_integrate():

     predict  LAMMPS: neighbors, forces  correct
     error too large: [undo, shorten, predict, evaluate()]  correct

   Nothing else in LAMMPS has used the step at this point: only this fix moves atoms, and the forces
   of other fixes are functions of positions and velocities (Forces).  Neighbor lists of the first
   try are kept, since its atoms have moved less than half the skin.  Energies and virials are
   tallied again as requested for the step. */

#ifndef LMP_GEAR_QUAT_TOLERANCE_H
#define LMP_GEAR_QUAT_TOLERANCE_H

#include "gear_quat_bath.h"
#include "gear_quat_forces.h"

#include <memory>
#include <string>

namespace LAMMPS_NS::GearQuat {

/// The length of the step in histories and in LAMMPS. Only this class changes these lengths.
///
/// Histories have the length of the last or of the current step.  After the command timestep LAMMPS'
/// length may differ; then the histories follow: their owner rescales them by follow().  With keyword
/// tolerance, change() and change_begun() set the length of LAMMPS and of all fixes.
class TimeStep : protected Pointers {
 public:
  explicit TimeStep(LAMMPS *lmp) : Pointers(lmp) {}

  /// The length of the step in histories; 0 before the first run.
  double length() const { return h; }
  /// The length of the step that began last; 0 before the first step.
  double begun() const { return last; }
  /// Called when a step of this length begins.
  void begin() { last = h; }
  /// Adopts LAMMPS' step for the histories.  Returns the ratio of new to old length, 0 for no
  /// change; infinite if there was none.
  double follow();

  // LAMMPS' step, and dependent quantities in other fixes and in this fix

  /// Changes the length after the current step.
  void change(double step);
  /// Changes the present step, which has begun with another length: the time so far consists of the
  /// steps before it.
  void change_begun(double step);

  // times

  /// The times at the beginning and at the end of the present step.
  double beginning() const;
  double end() const;

  template <class V> void fields(V &v) { v(h, last); }

 private:
  double h = 0.0, last = 0.0;

  void set(double step);
};

class Tolerance : protected Pointers {
 public:
  /// Elements of the fix's vector, after the elements of Outputs, as listed in the manual.
  static constexpr int ELEMENTS = 10;

  /// Sums for the outputs.
  struct Record {
    double steps, time, smallest, loads, largest, held, repeated, last_length, last_energy;

    template <class V> void fields(V &v)
    {
      v(steps, time, smallest, loads, largest, held, repeated, last_length, last_energy);
    }
  };

  /// scheme: of the fix, with the largest number of loads.  every_time: steps end at multiples of
  /// this time, 0: at any time.
  Tolerance(LAMMPS *lmp, const Fix *fix, const Scheme &scheme, const StepControl &control,
            double every_time, Bodies &bodies, TimeStep &time_step);

  /// The scheme with the present number of loads.
  const Scheme &scheme() const { return present; }
  /// An integrator with the coefficients of the last prepare().
  Integrator integrator() const { return {present, time_step.length(), remembered.coefficients()}; }
  /// Before histories are made of the present loads: shortens the first step to dtmax, the motion
  /// allowed, `permitted`, and the step whose error would be the tolerance.  first: the first fix
  /// gear/quat, which starts the histories of all before it begins the step.  Collective.
  void begin(double permitted, const Fix *first);

  /// Begins a step, with the histories of the last step.  After a run with `pre no` the length of
  /// the histories is restored; ends the run if other atoms have moved already.  Collective.
  void begin_step();
  /// Weights for a step of the present length.
  void prepare() { remembered.prepare(time_step.length()); }
  /// Corrects one body.
  Correction correct(const Integrator &integrator, int ibody, const Load &load);
  // The same around a correction of all bodies together: of the predicted, then of the corrected
  // histories.
  void note_prediction();
  void note_correction(const Integrator &integrator, const Bath &bath);
  /// After all bodies are corrected: false if the step has failed and must be repeated.
  /// Collective.
  bool accepts();
  /// Histories restored to the beginning of the step get the loads, then the length of the next
  /// try.
  void shorten_loads();
  void shorten_step();
  /// Forces of the next try at the present positions into atom->f, energies and virials as in the
  /// present step.  vflag: of LAMMPS when the step began.
  void evaluate(int vflag);
  /// Chooses loads and length of the next step, and returns the length.  After the call histories
  /// have the new number of loads.  permitted: upper limit of the length.  Collective.
  double choose(double permitted);
  /// Requests energies for a possible output in the next step, which LAMMPS does not expect: its
  /// thermo output is scheduled by step numbers only.
  void announce_output();
  /// With thermo 0, prints thermo output at the multiples of every_time, if the present step ends
  /// at one of them.  To be called after TimeStep::change().
  void order_output();
  /// Before a run, or when its first step has begun: the timestep command sets only the first step of
  /// histories, which keep their length.
  void keep_step(bool begun);

  double element(int n) const;
  void fields(Fields &v);

 private:
  const Fix *fix;
  Bodies &bodies;
  TimeStep &time_step;
  Scheme present;
  StepControl control;
  double every_time;
  RememberedLoads remembered;
  Growth growing;
  std::unique_ptr<Forces> forces;            ///< null if no step of the run can be repeated
  std::string told;                          ///< the last reported reason for that
  std::vector<RememberedLoads::Row> predicted;    ///< accelerations of bodies corrected together
  StepErrors errors;           ///< of the bodies corrected so far; of all, once judged
  double speed = 0.0;          ///< upper limit of the speeds of all sites
  double begun_with = 0.0;     ///< length of the first try of the present step
  int tries = 0;               ///< failed tries of the present step
  StepControl::Next failed;    ///< the next try
  bool fresh = false;          ///< bodies were inserted in this step, set by the test of the error
  bool warned_held = false;    ///< warned of a step limited from below
  bigint announced = -1;       ///< the last step of announce_output()
  Record record = {};

  void change_loads(int loads);
  const Fix *integrated_before(const Fix *begins) const;
  double largest_speed() const;
  double farthest_step(double speed) const;
  double steps_unseen() const;
  double limit_of_motion() const;
  double next_output(double step, double now) const;
  double even(double step, double now) const;
  double step_error() const { return control.error(errors); }
  void include(StepErrors one);
  StepErrors rounding(const Integrator &integrator, int ibody, const Load &load) const;
  double first_step() const;
  void begin_run();
  std::string reason_not_to_repeat() const;
  void tell_of_first_step(double instead) const;
  /// An error in the units of the user.
  double shown(double error) const;
  void refuse_lost() const;
  void refuse_frozen() const;
  void note_step(double size);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
