/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Vibrations that become faster during a run, as in a gas that condenses.

   The start measures the fast edge (gear_quat_choice.h) from derivatives.  During a run it follows
   from the accelerations in a window of four steps, without evaluations of the forces.  Windows end
   with the steps 100, 200, 400 and so on of a run, and with its last step.  All other steps cost
   one comparison.

   Motion calls note_step() after every step, and sums() if that returns true. */

#ifndef LMP_GEAR_QUAT_VIBRATIONS_H
#define LMP_GEAR_QUAT_VIBRATIONS_H

#include "gear_quat_bodies.h"
#include "gear_quat_choice.h"

#include "pointers.h"

#include <array>
#include <unordered_map>

namespace LAMMPS_NS::GearQuat {

class Vibrations : protected Pointers {
 public:
  Vibrations(LAMMPS *lmp, const Bodies &bodies) : Pointers(lmp), bodies(bodies) {}

  static constexpr int FIRST_WINDOW = 100;    ///< steps

  /// LAMMPS sets up a run.  Runs without a setup are noticed by their first step.
  void begin_run();
  /// After a step of length h, with its states and loads.  True if a window ends.
  bool note_step(double h);
  /// Of the bodies that this rank has owned during the window.  Empties the window.
  MotionSums sums();

 private:
  struct Record {
    int steps = 0;
    MotionSums::Derivative seconds[MotionSums::LEVELS] = {};
  };
  const Bodies &bodies;
  bigint first = -1;                             ///< first step of the present run
  bigint end = 0;                                ///< last step of the next window
  double width = 0.0;                            ///< step in the window
  int changes = 0;                               ///< of the bodies, at the last record
  std::unordered_map<tagint, Record> records;    ///< by the IDs of bodies, which stay

  void choose_end();
  void record(double h);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
