/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A box that another fix changes during a run (doc/theory.md, Boxes that other commands change).

   A fix that remaps atoms with the box notifies the rigid fixes before and after (Fix::deform()).
   Then the centers of mass are remapped, and bodies keep their shapes, orientations and velocities:
   an error of first order, as with fix rigid.

   If the box changes without a remap, atoms do not move.  The center of mass of a body, which is
   unwrapped, stays with its owner atom, and the other images of the body move with the box.  With
   fix deform remap v a body gets the velocity of the image beyond a face when its owner atom
   crosses it, and each atom has the velocity of its own image, like LAMMPS' atoms. */

#ifndef LMP_GEAR_QUAT_DRIVEN_H
#define LMP_GEAR_QUAT_DRIVEN_H

#include "gear_quat_sites.h"

namespace LAMMPS_NS::GearQuat {

class Step;

class DrivenBox : protected Scene {
 public:
  DrivenBox(const Scene &scene, Step &step) : Scene(scene), step(step) {}

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
  Step &step;
  const Fix *driver = nullptr;    ///< a fix that changes the box in this run

  void pass_faces(int ibody, const double *images);
  void move_center(int ibody, const double *way);
  void place_sites();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
