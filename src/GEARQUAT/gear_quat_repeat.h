/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A step of LAMMPS that is made again with another length, while final_integrate() lasts.

     predict  LAMMPS: neighbors, forces  correct
     too wrong: [undo, shorten, predict, evaluate()]  correct

   Nothing else in LAMMPS has acted on the step by then: this fix alone moves atoms, and what other
   fixes add to forces is a function of positions and velocities (Forces).  Neighbor lists stay
   those of the first try, whose atoms were less than half the skin away.  Energies and virials are
   tallied again as the step asks for. */

#ifndef LMP_GEAR_QUAT_REPEAT_H
#define LMP_GEAR_QUAT_REPEAT_H

#include "gear_quat_forces.h"

#include "pointers.h"

#include <memory>
#include <string>

namespace LAMMPS_NS::GearQuat {

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

}    // namespace LAMMPS_NS::GearQuat

#endif
