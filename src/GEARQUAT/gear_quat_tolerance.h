/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword tolerance inside LAMMPS: the largest errors of all bodies on all ranks, the control
   law of gear_quat_step_control.h, and the outputs that depend on times.

   When histories start: bound_first_step(), scheme_of_start(), begin() and shorten_first_step().
   In every step: begin_step(); correct() for every body, or note_prediction() and
   note_correction() around the correction by a coupling; and accepts().  If a step is rejected, the
   caller restores the histories, calls shorten_values() and shorten_step(), and repeats it.
   At the end of the step: choose(), TimeStep::change(), and order_output().  After begin(),
   shorten_values() and choose(), which may change the number of values, a new integrator is
   needed.  In addition, announce_output() before the first step of a run, and end_run(). */

#ifndef LMP_GEAR_QUAT_TOLERANCE_H
#define LMP_GEAR_QUAT_TOLERANCE_H

#include "gear_quat_coupling.h"
#include "gear_quat_fleet.h"
#include "gear_quat_forces.h"
#include "gear_quat_time_step.h"

#include <memory>
#include <string>

namespace LAMMPS_NS::GearQuat {

/* Repetition of a step of LAMMPS with another length, during final_integrate().

     predict  LAMMPS: neighbors, forces  correct
     error too large: [undo, shorten, predict, evaluate()]  correct

   Nothing else in LAMMPS has used the step at this point: only this fix moves atoms, and the forces
   of other fixes are functions of positions and velocities (Forces).  Neighbor lists of the first
   try are kept, since its atoms have moved less than half the skin.  Energies and virials are
   tallied again as requested for the step. */

class Repeat : protected Pointers {
 public:
  Repeat(LAMMPS *lmp, const Fix *owner) : Pointers(lmp), owner(owner) {}

  /// To be called when the first step of a run begins.  Rank 0 reports if no step of it can be
  /// repeated, once for each reason.  Collective.
  void begin_run();
  bool possible() const { return forces != nullptr; }
  /// Forces at the present positions into atom->f, energies and virials as in the present step.
  /// vflag: of LAMMPS when the step began.
  void evaluate(int vflag);

 private:
  const Fix *owner;
  std::unique_ptr<Forces> forces;    ///< null if no step can be repeated
  std::string told;                  ///< the last reported reason

  std::string reason() const;
};

class Tolerance : protected Pointers {
 public:
  /// Elements of the fix's vector, after the elements of Sums.
  enum {
    STEP,
    SMALLEST,
    MEAN,
    VALUES,
    MEAN_VALUES,
    LARGEST_ERROR,
    HELD,
    REPEATED,
    LENGTH,
    ENERGY,
    ELEMENTS
  };

  /// Values of the next step, and the sums for the outputs.
  struct Record {
    double values, steps, time, smallest, values_sum, largest, held, repeated;
    double last_length, last_energy;

    template <class V> void fields(V &v)
    {
      v(values, steps, time, smallest, values_sum, largest, held, repeated, last_length,
        last_energy);
    }
  };

  /// scheme: of the fix, with the largest number of values.  every_time: steps end at multiples of
  /// this time, 0: at any time.
  Tolerance(LAMMPS *lmp, const Fix *fix, const Scheme &scheme, const StepControl &control,
            double every_time, const Fleet &fleet, Bodies &bodies, TimeStep &time_step);

  /// Ends the run if another style changes the time step, or does not support its changes.
  void refuse_scene() const;

  /// The scheme with the present number of values.
  const Scheme &scheme() const { return present; }
  /// The scheme for seeding histories: one row more than the most, without a trial row.
  Scheme scheme_of_start() const;
  /// Histories are seeded.  full: to the last row; otherwise they start with the fewest values.
  void begin(bool full);
  /// Before histories are made: limits the first step to dtmin, dtmax, the motion allowed, and
  /// `permitted`.  Collective.
  void bound_first_step(double permitted);
  /// Shortens the first step if its error would be too large.  full: as in begin().  Collective.
  void shorten_first_step(bool full);

  /// Begins a step, with the histories of the last step.  After a run with `pre no` the length of
  /// the histories is restored; ends the run if other atoms have moved already.  Collective.
  void begin_step();
  /// Corrects one body.
  Correction correct(const Integrator &integrator, int ibody, const Load &load);
  // The same around a correction of all bodies together: of the predicted, then of the corrected
  // histories.
  void note_prediction();
  void note_correction(const Integrator &integrator, const Coupling &coupling);
  /// After all bodies are corrected: false if the step has failed and must be repeated.
  /// Collective.
  bool accepts();
  /// Histories restored to the beginning of the step get the values, then the length of the next
  /// try.
  void shorten_values();
  void shorten_step();
  /// Forces of the next try.  vflag: of LAMMPS when the step began.
  void evaluate(int vflag) { repeat.evaluate(vflag); }
  /// Chooses values and length of the next step, and returns the length.  After the call histories
  /// have the new number of values.  permitted: upper limit of the length.  Collective.
  double choose(double permitted);
  /// Requests energies for a possible output in the next step, which LAMMPS does not expect: its
  /// thermo output is scheduled by step numbers only.
  void announce_output();
  /// With thermo 0, prints thermo output at the multiples of every_time, if the present step ends
  /// at one of them.  To be called after TimeStep::change().
  void order_output();
  /// Rank 0 prints a message if a constant step would have been sufficient.
  void end_run();
  /// Before a run: the timestep command sets only the first step, so histories keep their length.
  void keep_step();

  double element(int n) const;
  void fields(Fields &v);

 private:
  const Fix *fix;
  const Fleet &fleet;
  Bodies &bodies;
  TimeStep &time_step;
  Scheme present;
  StepControl control;
  double every_time;
  VariableOrder order;
  Repeat repeat;
  Column<VariableOrder::Row> predicted;    ///< last rows, of bodies corrected together
  StepMeasures errors;                     ///< of the bodies corrected so far; of all, once judged
  double speed = 0.0;                      ///< upper limit of the speeds of all sites
  double begun_with = 0.0;                 ///< length of the first try of the present step
  int tries = 0;                           ///< failed tries of the present step
  StepControl::Next failed;                ///< the next try
  Steady steady;
  bool fresh = false;          ///< bodies were inserted in this step, set by the test of the error
  bool warned_held = false;    ///< warned of a step limited from below
  bigint announced = -1;       ///< the last step of announce_output()
  Record record = {};
  struct Settled {
    double steps = 0.0, time = 0.0, squares = 0.0, largest = 0.0;
  } settled;    ///< of this run, without its start: number, sum, sum of squares; largest error / eps

  void set_values(int values);
  void change_values(int values);
  void put_back_begun_step();
  void tell_of_step() const;
  const Fix *first_mover() const;
  const Fix *integrated_before(const Fix *begins) const;
  double largest_speed() const;
  double farthest_step(double speed) const;
  double steps_unseen() const;
  double limit_of_motion() const;
  double next_output(double step, double now) const;
  double even(double step, double now) const;
  double step_error() const { return control.measured(errors).same; }
  void include(StepMeasures of_body);
  double first_error() const;
  void warn_of_rounding() const;
  double first_step_of_low_order() const;
  void begin_run();
  void tell_of_first_step(double instead) const;
  /// An error in the units of the user.
  double shown(double error) const;
  void refuse_lost() const;
  void refuse_frozen() const;
  void note_step(double size, int values);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
