/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Rigid bodies in LAMMPS' command minimize (doc/theory.md, Energy minimization).

   LAMMPS' minimizers move atoms along straight lines, by combinations of the forces on them.  The
   forces on the atoms of a body are projected on its rigid motions, so that these combinations are
   rigid motions, too, and before each evaluation of the forces the body goes to the pose that is
   nearest to its atoms, and they to their places in it.  So the degrees of freedom of a body are
   those of its atoms, nothing is sent to all ranks, and rotations and translations have the same
   measure, the way of the atoms.

   Bodies keep their velocities, and their angular velocities along their principal axes. */

#ifndef LMP_GEAR_QUAT_MINIMIZE_H
#define LMP_GEAR_QUAT_MINIMIZE_H

#include "gear_quat_nearest.h"
#include "gear_quat_sites.h"

#include <vector>

namespace LAMMPS_NS::GearQuat {

class Minimization : protected Pointers {
 public:
  Minimization(LAMMPS *lmp, Bodies &bodies, Ownership &ownership, Sites &sites) :
      Pointers(lmp), bodies(bodies), ownership(ownership), sites(sites)
  {
  }

  /// Ends the run if the minimizer cannot move bodies.
  void init();
  /// Between init() and end().
  bool is_on() const { return on; }
  /// Bodies were made, or atoms exchanged.  Collective.
  void measure();
  /// Loads are present.  Ends the run on all ranks if one is not a number; warns of rotations that
  /// move no atom.  Collective.
  void check_loads();
  /// Bodies go to their atoms, and atoms to their places, ghosts not.  Collective.
  void fit();
  /// The same before forces are evaluated, with ghosts, unless fit() was called since then.
  void fit_all();
  /// The forces f on atoms of bodies become those that move them as rigid bodies.  Collective.
  void project(double **f);

  // Where the minimizer returns to, in the memory of histories, which a minimization does not need.

  void store();
  void put_back();

  void end() { on = false; }

 private:
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;
  bool on = false, fitted = false, warned = false;
  std::vector<Load> moments[2];    ///< sums over the sites of all bodies here, along their axes

  Arms arms_of(int ibody) const;
  double *stored(int ibody) { return bodies.history(ibody); }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
