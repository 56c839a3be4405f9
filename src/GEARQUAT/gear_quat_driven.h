/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies that LAMMPS moves, in minimizations and with the box.

   Rigid bodies in LAMMPS' command minimize (doc/theory.md, Energy minimization).

   LAMMPS' minimizers move atoms along straight lines, by linear combinations of the forces on them.
   The forces on the atoms of a body are projected onto its rigid motions, so that these
   combinations are rigid motions, too.  Before each evaluation of the forces the body moves to the
   pose nearest to its atoms, and the atoms move to their positions in the body.  The degrees of
   freedom of a body are thus the degrees of freedom of its atoms, nothing is sent to all ranks, and
   rotations and translations have the same measure, the displacement of the atoms.

   Bodies keep their velocities, and their angular velocities along their principal axes.

   A box that another fix changes during a run (doc/theory.md, Boxes that other commands change).

   A fix that remaps atoms with the box notifies the rigid fixes before and after (Fix::deform()).
   Then the centers of mass are remapped, and bodies keep their shapes, orientations and velocities:
   an error of first order, as with fix rigid.

   If the box changes without a remap, atoms do not move.  The center of mass of a body, which is
   unwrapped, stays with its owner atom, and the other images of the body move with the box.  With
   fix deform remap v a body gets the velocity of the image beyond a face when its owner atom
   crosses it, and each atom has the velocity of its own image, like LAMMPS' atoms. */

#ifndef LMP_GEAR_QUAT_DRIVEN_H
#define LMP_GEAR_QUAT_DRIVEN_H

#include "gear_quat_shapes.h"
#include "gear_quat_sites.h"

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Step;
struct Arguments;

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

/* ---------------------------------------------------------------------- */

class DrivenBox : protected Pointers {
 public:
  DrivenBox(LAMMPS *lmp, const Fix *fix, const Arguments &args, Bodies &bodies,
            Ownership &ownership, Sites &sites, Step &step) :
      Pointers(lmp),
      fix(fix), args(args), bodies(bodies), ownership(ownership), sites(sites), step(step)
  {
  }

  /// Ends the run if another fix changes the box in a way that bodies cannot follow.  Before a run.
  void init();
  /// Called before a minimization, in which no other fix changes the box.
  void rest() { driver = nullptr; }
  /// True if another fix changes the box in this run.
  bool any() const { return driver; }

  /// Another fix has remapped atoms with the box, from Ownership::box().  Collective.
  void end_remap();
  /// Called before a step, and when the box may have changed without a remap.
  void follow();
  /// Called in LAMMPS' setup, before atoms are wrapped.
  void begin_setup();
  /// Called when bodies were made again.  Local.
  void note_images();
  /// Called when atoms were wrapped and exchanged, and bodies found again.  Collective.
  void follow_images();
  /// Called at the end of a run, when sites are placed in the last box.  Collective.
  void end_run();

 private:
  const Fix *fix;
  const Arguments &args;
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;
  Step &step;
  const Fix *driver = nullptr;    ///< a fix that changes the box in this run

  void pass_faces(int ibody, const double *images);
  void move_center(int ibody, const double *way);
  void place_sites();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
