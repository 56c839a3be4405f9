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
   measured: forces are evaluated at other steps. */

#ifndef LMP_GEAR_QUAT_FORCES_H
#define LMP_GEAR_QUAT_FORCES_H

#include "lmptype.h"
#include "pointers.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Forces : protected Pointers {
 public:
  /// Examines the simulation.  owners: the calling fixes.  Collective.
  Forces(LAMMPS *lmp, const std::vector<const Fix *> &owners);

  /// Empty if forces can be followed, otherwise the reason.
  const std::string &reason() const { return why; }

  /// Saves all data of all atoms, including ghosts, for any atom style: positions, velocities,
  /// forces, and other quantities that pair styles sum up or overwrite, such as rates of energies.
  void save();
  /// Restores the data of save().  Computes count as not evaluated: a fix whose force is a variable
  /// of computes has evaluated them.
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
  std::array<bigint, 4> tallied;

  void look_at_styles();
  void look_at_fixes(const std::vector<const Fix *> &owners);
  void look_at_time();
  std::vector<double> forces_at(bigint step);
  void clear();
  void evaluate_styles(int eflag, int vflag);
  std::array<bigint *, 4> steps_of_tallies();
};

/// The time steps of all levels of r-RESPA, the innermost first; none without r-RESPA.
std::vector<double> respa_steps(LAMMPS *lmp);

}    // namespace LAMMPS_NS::GearQuat

#endif
