/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Rigid bodies in LAMMPS' command minimize (doc/theory.md, Energy minimization).

   LAMMPS' minimizers move atoms along straight lines, by linear combinations of the forces on them.
   The forces on the atoms of a body are projected onto its rigid motions, so that these
   combinations are rigid motions, too.  Before each evaluation of the forces the body moves to the
   pose nearest to its atoms, and the atoms move to their positions in the body.  The degrees of
   freedom of a body are thus the degrees of freedom of its atoms, nothing is sent to all ranks, and
   rotations and translations have the same measure, the displacement of the atoms.

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
      Pointers(lmp), bodies(bodies), ownership(ownership), sites(sites), moments(bodies)
  {
  }

  /// Ends the run if the minimizer cannot move bodies.
  void init();
  /// Called when bodies were made or atoms exchanged.  Collective.
  void measure();
  /// Loads are present.  Ends the run on all ranks if one is not finite; warns of rotations that
  /// move no atom.  Collective.
  void check_loads();
  /// Moves bodies to their atoms, and atoms to their positions, except ghosts.  Collective.
  void fit();
  /// Moves bodies, atoms and ghosts before forces are evaluated, unless fit() was called after the
  /// last evaluation.
  void fit_all();
  /// Projects the forces f on atoms of bodies onto rigid motions.  Collective.
  void project(double **f);

  // Starting point of a line search, stored in the memory of histories, which a minimization does
  // not need.

  void store();
  void put_back();

 private:
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;
  bool fitted = false, warned = false;
  Column<ArmSums> moments;    ///< of all bodies here, along their axes

  Arms arms_of(int ibody) const
  {
    const Arms along_axes = {(double) bodies.body_at(ibody).natoms, moments[ibody]};
    return along_axes.in_space(bodies.axes(ibody));
  }
  double *stored(int ibody) { return bodies.history(ibody); }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
