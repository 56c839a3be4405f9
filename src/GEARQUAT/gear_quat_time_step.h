/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The length of the step, of histories and of LAMMPS.  This class alone changes either.

   Histories have the length of the last step, or of the one that has begun.  LAMMPS' own may differ
   from it after the command timestep, and then histories follow: whoever holds them rescales them
   by follow().  With keyword tolerance it is the other way round: change() and change_begun() tell
   LAMMPS and all fixes. */

#ifndef LMP_GEAR_QUAT_TIME_STEP_H
#define LMP_GEAR_QUAT_TIME_STEP_H

#include "pointers.h"

namespace LAMMPS_NS::GearQuat {

class TimeStep : protected Pointers {
 public:
  explicit TimeStep(LAMMPS *lmp) : Pointers(lmp) {}

  /// Of the histories; 0 before the first run.
  double length() const { return h; }
  /// Of the last step that was made; 0 before the first one.
  double made() const { return last; }
  /// A step of this length begins.
  void begin() { last = h; }
  /// LAMMPS' step becomes that of the histories.  Returns the new length by the old one, 0 if
  /// nothing changes; infinite if there was none.
  double follow();
  /// True while fixes are told of a length that change() has set.
  bool is_changing() const { return changing; }

  // LAMMPS' step, and all that depends on it in other fixes and in this one

  /// After the present step.
  void change(double step);
  /// Of the present step, which has begun with another length: the time so far was made of the
  /// steps before it.
  void change_begun(double step);

  // times

  /// When the present step began, and when it ends.
  double beginning() const;
  double end() const;

  /// Of a restart file.
  void restore(double saved) { h = last = saved; }

 private:
  double h = 0.0, last = 0.0;
  bool changing = false;

  void set(double step);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
