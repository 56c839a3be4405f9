/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword tolerance inside LAMMPS: the largest errors of all bodies on all ranks, the law of
   gear_quat_step_control.h, and the outputs that depend on times.

   When histories begin: bound_first_step(), scheme_of_start(), begin() and shorten_first_step().
   In every step: begin_step(); correct() for every body, or note_prediction() and
   note_correction() around the correction by a coupling; and accepts().  If a step is not accepted,
   its maker puts back the histories, calls shorten_values() and shorten_step(), and makes it again.
   At the end of the step: choose(), TimeStep::change(), and order_output().  Where the number of
   values may have changed, after begin(), shorten_values() and choose(), a new integrator is
   needed.  Beside that, announce_output() before the first step of a run, and end_run(). */

#ifndef LMP_GEAR_QUAT_TOLERANCE_H
#define LMP_GEAR_QUAT_TOLERANCE_H

#include "gear_quat_coupling.h"
#include "gear_quat_fleet.h"
#include "gear_quat_forces.h"
#include "gear_quat_time_step.h"

#include <memory>
#include <string>

namespace LAMMPS_NS::GearQuat {

/* A step of LAMMPS that is made again with another length, while final_integrate() lasts.

     predict  LAMMPS: neighbors, forces  correct
     too wrong: [undo, shorten, predict, evaluate()]  correct

   Nothing else in LAMMPS has acted on the step by then: this fix alone moves atoms, and what other
   fixes add to forces is a function of positions and velocities (Forces).  Neighbor lists stay
   those of the first try, whose atoms were less than half the skin away.  Energies and virials are
   tallied again as the step asks for. */

class Repeat : protected Pointers {
 public:
  Repeat(LAMMPS *lmp, const Fix *owner) : Pointers(lmp), owner(owner) {}

  /// To be called when the first step of a run begins.  Rank 0 says if no step of it can be
  /// repeated, once for each reason.  Collective.
  void begin_run();
  bool possible() const { return forces != nullptr; }
  /// Forces at the present positions into atom->f, energies and virials as in the present step.
  /// vflag: what LAMMPS asked of the virial when the step began.
  void evaluate(int vflag);

 private:
  const Fix *owner;
  std::unique_ptr<Forces> forces;    ///< null where no step can be repeated
  std::string told;                  ///< the last reason that was told

  std::string reason() const;
};

class Tolerance : protected Pointers {
 public:
  /// Elements of the fix's vector, behind those of Sums.
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

  /// The next step's values, and the sums behind the outputs.
  struct Record {
    double values, steps, time, smallest, values_sum, largest, held, repeated;
    double last_length, last_energy;
  };

  /// scheme: of the fix; its number of values is the largest.  every_time: steps end at the
  /// multiples of this time, 0: at any.
  Tolerance(LAMMPS *lmp, const Fix *fix, const Scheme &scheme, const StepControl &control,
            double every_time, const Fleet &fleet, Bodies &bodies, TimeStep &time_step);

  /// Ends the run if something else in it changes the time step, or cannot follow it.
  void refuse_scene() const;

  /// The scheme with the present number of values.
  const Scheme &scheme() const { return present; }
  /// What histories have to be seeded with: one row more than the most, without a trial row.
  Scheme scheme_of_start() const;
  /// Histories are seeded.  full: to the last row; otherwise they begin with the fewest values.
  void begin(bool full);
  /// Before histories are made: the first step is within dtmin, dtmax, the motion that is allowed,
  /// and what is permitted beside that.  Collective.
  void bound_first_step(double permitted);
  /// Makes the first step shorter if its error would be too large.  full: of what begin() says.
  /// Collective.
  void shorten_first_step(bool full);

  /// A step begins; the histories are those of the last one.  After a run with `pre no` the length
  /// of the histories is put back; ends the run if other atoms have moved already.  Collective.
  void begin_step();
  /// Correct one body.
  Correction correct(const Integrator &integrator, int ibody, const Load &load);
  // The same around a correction of all bodies together: of the predicted, then of the corrected
  // ones.
  void note_prediction();
  void note_correction(const Integrator &integrator, const Coupling &coupling);
  /// All bodies are corrected: false if the step has failed and is to be made again.  Collective.
  bool accepts();
  /// Histories as they were when the step began get the values, then the length of the next try.
  void shorten_values();
  void shorten_step();
  /// Forces of the next try.  vflag: what LAMMPS asked of the virial when the step began.
  void evaluate(int vflag) { repeat.evaluate(vflag); }
  /// Choose values and length of the next step, and return the length.  After the call histories
  /// have the new number of values.  permitted: it is not longer.  Collective.
  double choose(double permitted);
  /// Energies of the next step may be printed, although LAMMPS does not expect that: its thermo
  /// output knows step numbers only.
  void announce_output();
  /// With thermo 0 there is thermo output at the multiples of every_time: now, if the step that
  /// ends is at one of them.  To be called after TimeStep::change().
  void order_output();
  /// Rank 0 says if a constant step would have done.
  void end_run();
  /// Before a run: the timestep command sets the first step only, so histories keep theirs.
  void keep_step();

  double element(int n) const;
  /// Sections of a restart file.
  void write(Sections &file) const;
  /// Returns what the file does not have, empty if it has all.
  std::string read(const Sections &file);

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
  std::vector<VariableOrder::Row> predicted;    ///< last rows, of bodies corrected together
  StepMeasures errors;         ///< of the bodies corrected so far; of all, once judged
  double speed = 0.0;          ///< no site of a body is faster
  double begun_with = 0.0;     ///< length of the first try of the present step
  int tries = 0;               ///< of the present step that have failed
  StepControl::Next failed;    ///< the next try
  Steady steady;
  bool fresh = false;          ///< bodies have come in this step, once judged
  bool warned_held = false;    ///< of a step held at its lower limit
  bigint announced = -1;       ///< the last step of announce_output()
  Record record = {};
  struct Settled {
    double steps = 0.0, time = 0.0, squares = 0.0;
  } settled;    ///< of this run, without its start: number, sum and sum of squares

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
  double first_step_of_low_order() const;
  void begin_run();
  void tell_of_first_step(double instead) const;
  /// An error as the user counts it.
  double shown(double error) const;
  void refuse_lost() const;
  void refuse_frozen() const;
  void note_step(double size, int values);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
