/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* r-RESPA with one step for all levels: the forces of a step are the sum over the levels, each of
   which LAMMPS shows in atom->f when that level ends. */

#ifndef LMP_GEAR_QUAT_RESPA_H
#define LMP_GEAR_QUAT_RESPA_H

#include "pointers.h"

#include <vector>

namespace LAMMPS_NS::GearQuat {

class RespaForces : protected Pointers {
 public:
  RespaForces(LAMMPS *lmp);
  ~RespaForces() override;

  /// The time steps of all levels, the innermost first; none without r-RESPA.
  static std::vector<double> steps(LAMMPS *lmp);
  /// True for the level that begins and ends a step.
  bool outermost(int level) const;
  /// Before a step: the sum over the levels of what each has found last, all fixes included.
  void sum_present();
  /// The forces, and torques where atoms have some, of one level; level 0 begins a sum.
  void add(int level);

  double **forces() const { return f; }
  double **torques() const { return torque; }    ///< null where atoms have none
  double memory_usage() const;

 private:
  double **f, **torque;
  int nmax;

  int levels() const;
  void begin();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
