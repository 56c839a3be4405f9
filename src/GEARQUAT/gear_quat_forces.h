/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Evaluation of LAMMPS' forces for the start-up.

   The start-up evaluates forces at positions between steps.  It follows pair, bonded and kspace
   forces of styles that depend on positions and velocities only, and the post_force() of the fixes
   in a list (external fields, walls, springs).  It does not follow, and reason() explains why, any
   style that moves atoms, changes their data or draws random numbers, or that depends on the time
   or on energies and pressures, which are available at steps only.  A dependence on the time is
   measured: forces are evaluated at other steps.

   The class RespaForces sums the forces of a step of r-RESPA. */

#ifndef LMP_GEAR_QUAT_FORCES_H
#define LMP_GEAR_QUAT_FORCES_H

#include "lmptype.h"
#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// LAMMPS' records of computes: the last step at which each was evaluated, the steps for which it
/// was requested, and the step in which energies and virials were tallied.  A fix whose force is a
/// variable of computes changes these records whenever its force is evaluated, also between steps.
class Tallies : protected Pointers {
 public:
  explicit Tallies(LAMMPS *lmp) : Pointers(lmp) {}

  /// Saves the records and marks computes as not evaluated.
  void save();
  /// Marks energies and virials of the last step as current.
  void pretend();
  /// True if a compute that needs such a tally was evaluated since save().
  bool used() const;
  /// Restores the records of save().  Computes evaluated since then will be evaluated again.
  void restore();

 private:
  struct Note {
    int flag;
    bigint invoked[5];
    std::vector<bigint> steps;
  };
  std::vector<Note> notes;
  bigint tallied[4];
};

class Forces : protected Pointers {
 public:
  /// Examines the simulation.  owners: the calling fixes.  Collective.
  Forces(LAMMPS *lmp, const std::vector<const Fix *> &owners);

  /// Empty if forces can be followed, otherwise the reason.
  const std::string &reason() const { return why; }

  /// Saves all data of all atoms, including ghosts, for any atom style: positions, velocities,
  /// forces, and other quantities that pair styles sum up or overwrite, such as rates of energies.
  void save();
  /// Restores the data of save().
  void restore();
  /// Largest displacement of an owned atom since save(), on all ranks.
  double largest_displacement() const;
  /// Forces of owned atoms at their present positions into atom->f.  Without flags energies and
  /// virials do not change; with the flags of LAMMPS' present step they are evaluated at these
  /// positions.
  void evaluate(int eflag = 0, int vflag = 0);

 private:
  std::string why;
  std::vector<Fix *> pre_force, post_force;
  struct Copy {
    double *data;
    std::vector<double> values;
  };
  std::vector<Copy> copies;    ///< of the per-atom arrays of the atom style, positions first
  Tallies tallies;

  void look_at_styles();
  void look_at_fixes(const std::vector<const Fix *> &owners);
  void look_at_time();
  void evaluate_at(bigint step, bool of_fixes);
  void clear();
  void clear_owned();
  void evaluate_styles(int eflag, int vflag);
  void compute_forces(int eflag, int vflag);
};

/// r-RESPA with one step for all levels: the forces of a step are the sum over the levels.  LAMMPS
/// has the forces of each level in atom->f when that level ends.
class RespaForces : protected Pointers {
 public:
  RespaForces(LAMMPS *lmp);
  ~RespaForces() override;

  /// The time steps of all levels, the innermost first; none without r-RESPA.
  static std::vector<double> steps(LAMMPS *lmp);
  /// True for the level that begins and ends a step.
  bool outermost(int level) const;
  /// Called before a step: sums the latest forces of all levels, including all fixes.
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
