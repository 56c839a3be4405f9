/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword tolerance inside LAMMPS: the largest errors of all bodies on all ranks, the law of
   gear_quat_step_control.h, and LAMMPS' time step.

   The fix calls when histories begin scheme_of_start(), begin() and shorten_first_step(); in every
   step correct() for every body; and at the end of the step, when all fixes have finished it,
   choose() and change_step().  Where the number of values may have changed, after begin() and
   choose(), the fix makes its integrator anew. */

#ifndef LMP_GEAR_QUAT_TOLERANCE_H
#define LMP_GEAR_QUAT_TOLERANCE_H

#include "gear_quat_bodies.h"
#include "gear_quat_step_control.h"

namespace LAMMPS_NS::GearQuat {

class Tolerance : protected Pointers {
 public:
  /// Elements of the fix's vector, behind those of Sums.
  enum { STEP, SMALLEST, MEAN, VALUES, MEAN_VALUES, LARGEST_ERROR, HELD, ELEMENTS };

  /// What a restart file keeps: the next step's values, steps made with them, and the sums behind the
  /// outputs.
  struct Checkpoint {
    double values, steady;
    double steps, time, smallest, values_sum, largest, held;
  };

  /// scheme: of the fix; its number of values is the largest.
  Tolerance(LAMMPS *lmp, const Fix *fix, const Scheme &scheme, const StepControl &control,
            Bodies &bodies);

  /// Ends the run if something else in it changes the time step, or cannot follow it.
  void refuse_scene() const;

  /// The scheme with the present number of values.
  const Scheme &scheme() const { return present; }
  /// What histories have to be seeded with: one row more than the most, without a trial row.
  Scheme scheme_of_start() const;
  /// Histories are seeded.  full: to the last row; otherwise they begin with the fewest values.
  void begin(bool full);
  /// Makes the first step shorter if its error would be too large.  Collective.
  void shorten_first_step();

  /// Correct one body.
  Correction correct(const Integrator &integrator, int ibody, const Load &load);
  /// The history of a body has just begun with fewer terms than the others have.
  void note_fresh() { fresh = true; }
  /// Choose values and length of the next step, and return the length.  After the call histories
  /// have the new number of values.  Collective.
  double choose();
  /// update->dt and all that depends on it, this fix too, become those of the next step.
  void change_step(double step);
  /// Restores `step`, that of the histories: the timestep command sets the first step only.
  void keep_step(double step);
  /// The same in a run with pre no, whose first step has begun with another length already.  Ends the
  /// run if other atoms have moved.
  void put_back_begun_step(double step);
  /// True while fixes are told of a step that this control has chosen.
  bool is_changing_step() const { return changing_step; }

  double element(int n) const;
  Checkpoint checkpoint() const { return record; }
  void restore(const Checkpoint &saved);

 private:
  const Fix *fix;
  Bodies &bodies;
  Scheme present;
  StepControl control;
  VariableOrder order;
  StepErrors errors;    ///< of the bodies corrected so far
  bool changing_step = false;
  bool fresh = false;
  bool warned_held = false;    ///< of a step held at its lower limit
  Checkpoint record = {};

  void set_values(int values);
  void change_values(int values);
  void set_step(double step);
  void set_begun_step(double step);
  void tell_of_step(double step) const;
  const Fix *integrated_before(const Fix *begins) const;
  double largest_speed() const;
  double farthest_step(double speed) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
