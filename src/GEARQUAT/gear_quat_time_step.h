/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The length of the step in histories and in LAMMPS. Only this class changes these lengths.

   Histories have the length of the last or of the current step.  After the command timestep
   LAMMPS' length may differ; then the histories follow: their owner rescales them by follow().
   With keyword tolerance, change() and change_begun() set the length of LAMMPS and of all fixes. */

#ifndef LMP_GEAR_QUAT_TIME_STEP_H
#define LMP_GEAR_QUAT_TIME_STEP_H

#include "pointers.h"

namespace LAMMPS_NS::GearQuat {

class TimeStep : protected Pointers {
 public:
  explicit TimeStep(LAMMPS *lmp) : Pointers(lmp) {}

  /// The length of the step in histories; 0 before the first run.
  double length() const { return h; }
  /// The length of the last completed step; 0 before the first step.
  double made() const { return last; }
  /// Called when a step of this length begins.
  void begin() { last = h; }
  /// Adopts LAMMPS' step for the histories.  Returns the ratio of new to old length, 0 for no
  /// change; infinite if there was none.
  double follow();
  /// True while fixes are notified of a length set by change().
  bool is_changing() const { return changing; }

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
  bool changing = false;

  void set(double step);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
