/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword tolerance inside LAMMPS: the largest errors of all bodies on all ranks, the law of
   gear_quat_step_control.h, and LAMMPS' time step.

   The fix calls when histories begin scheme_of_start(), begin() and shorten_first_step(); in every
   step begin_step(); correct() for every body, or note_prediction() and note_correction() around
   another correction, and judge(); if that says so, it puts back the
   histories, calls shorten_values() and shorten_step(), and makes the step again; and at the end of
   the step, when all fixes have finished it, choose(), change_step() and order_output().  Where the
   number of values may have changed, after begin(), shorten_values() and choose(), the fix makes
   its integrator anew.  Beside that, announce_output() before the first step of a run, and
   end_run(). */

#ifndef LMP_GEAR_QUAT_TOLERANCE_H
#define LMP_GEAR_QUAT_TOLERANCE_H

#include "gear_quat_bodies.h"
#include "gear_quat_repeat.h"
#include "gear_quat_step_control.h"
#include "pointers.h"

namespace LAMMPS_NS::GearQuat {

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

  /// What a restart file keeps: the next step's values, steps made with them, and the sums behind
  /// the outputs.
  struct Checkpoint {
    double values, steady[3];
    double steps, time, smallest, values_sum, largest, held, repeated, last_length, last_energy;
  };

  /// scheme: of the fix; its number of values is the largest.  every_time: steps end at the
  /// multiples of this time, 0: at any.
  Tolerance(LAMMPS *lmp, const Fix *fix, const Scheme &scheme, const StepControl &control,
            double every_time, Bodies &bodies);

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

  /// A step begins; the histories are those of the last one.  Collective.
  void begin_step();
  /// Correct one body.
  Correction correct(const Integrator &integrator, int ibody, const Load &load);
  // The same around a correction of all bodies together: of the predicted, then of the corrected
  // ones.
  void note_prediction();
  void note_correction(const Integrator &integrator);
  /// The chains of a thermostat are corrected, too; kt: of its target.
  void note_chains(const Chain::LeftOut &left_out, double kt);
  /// All bodies are corrected: true if the step has failed and is to be made again.  Collective.
  bool judge();
  /// Histories as they were when the step began get the values, then the length of the next try.
  void shorten_values();
  void shorten_step();
  /// Forces of the next try.  vflag: what LAMMPS asked of the virial when the step began.
  void evaluate(int vflag) { repeat.evaluate(vflag); }
  /// Choose values and length of the next step, and return the length.  After the call histories
  /// have the new number of values.  permitted: it is not longer.  Collective.
  double choose(double permitted);
  /// update->dt and all that depends on it, this fix too, become those of the next step.
  void change_step(double step);
  /// Energies of the next step may be printed, although LAMMPS does not expect that: its thermo
  /// output knows step numbers only.
  void announce_output();
  /// With thermo 0 there is thermo output at the multiples of every_time: now, if the step that
  /// ends is at one of them.  To be called after change_step().
  void order_output();
  /// Rank 0 says if a constant step would have done.
  void end_run();
  /// Restores `step`, that of the histories: the timestep command sets the first step only.
  void keep_step(double step);
  /// The same in a run with pre no, whose first step has begun with another length already.  Ends
  /// the run if other atoms have moved.
  void put_back_begun_step(double step);
  /// True while fixes are told of a step that this control has chosen.
  bool is_changing_step() const { return changing_step; }

  double element(int n) const;
  Checkpoint checkpoint() const;
  void restore(const Checkpoint &saved);

 private:
  const Fix *fix;
  Bodies &bodies;
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
  bool changing_step = false;
  bool fresh = false;          ///< bodies have come in this step, once judged
  bool warned_held = false;    ///< of a step held at its lower limit
  bigint announced = -1;       ///< the last step of announce_output()
  Checkpoint record = {};
  struct Settled {
    double steps = 0.0, time = 0.0, squares = 0.0;
  } settled;    ///< of this run, without its start: number, sum and sum of squares

  void set_values(int values);
  void change_values(int values);
  void set_step(double step);
  void set_begun_step(double step);
  void tell_of_step(double step) const;
  const Fix *first_mover() const;
  const Fix *integrated_before(const Fix *begins) const;
  double largest_speed() const;
  double farthest_step(double speed) const;
  double steps_unseen() const;
  double limit_of_motion() const;
  double time() const;
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
  double begun_at() const;
  void refuse_frozen() const;
  void note_step(double size, int values);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
