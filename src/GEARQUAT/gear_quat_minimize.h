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

#include "gear_quat_shapes.h"
#include "gear_quat_sites.h"

namespace LAMMPS_NS::GearQuat {

class Minimization : protected Pointers {
 public:
  Minimization(LAMMPS *lmp, Bodies &bodies, Ownership &ownership, Sites &sites) :
      Pointers(lmp), bodies(bodies), ownership(ownership), sites(sites)
  {
  }

  /// Ends the run if the minimizer cannot move bodies.
  void init();
  /// Called before a minimization, when poses and loads are present.  Ends the run on all ranks if a
  /// load is not finite.  Collective.
  void begin();
  /// Moves bodies to their atoms, and atoms to their positions, except ghosts.  Collective.
  void fit();
  /// Projects the forces f on atoms of bodies onto rigid motions.  Collective.
  void project(double **f);

  // Starting point of a line search.

  void store();
  void put_back();

 private:
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;
  /// In the memory of the history of a body, which a minimization does not need, and which travels
  /// with the body.
  struct Stored {
    double center[3], q[4];    ///< starting point of a line search
    ArmSums arms;              ///< along the axes of the body
  };
  static_assert(sizeof(Stored) <= VERLET * Scheme::SECOND_WIDTH * sizeof(double));
  Stored &stored(int ibody) { return *reinterpret_cast<Stored *>(bodies.history(ibody)); }
  Arms arms_of(int ibody)
  {
    const Arms along_axes = {(double) bodies.body_at(ibody).natoms, stored(ibody).arms};
    return along_axes.in_space(bodies.axes(ibody));
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
