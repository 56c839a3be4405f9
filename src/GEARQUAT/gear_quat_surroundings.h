/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What a scene computes around its bodies that moves none of them: pairs of atoms that nothing
   moves, pairs within a body, atoms of the fix group that no body uses.  Found before a run in the
   neighbor lists of the pair styles; nothing is changed. */

#ifndef LMP_GEAR_QUAT_SURROUNDINGS_H
#define LMP_GEAR_QUAT_SURROUNDINGS_H

#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Bodies;
struct Arguments;

class Surroundings : protected Pointers {
 public:
  /// Collective; to be made after neighbor lists were built.
  Surroundings(LAMMPS *lmp, const Fix *fix, const Arguments &args, Bodies &bodies);

  /// What was found, a sentence each, below it the line of the input script that mends it; nothing
  /// where there is nothing to mend.  The same on all ranks.
  const std::vector<std::string> &lines() const { return text; }

 private:
  const Fix *fix;
  const Arguments &args;
  Bodies &bodies;
  std::vector<std::string> text;

  bigint pairs = 0, still_pairs = 0, own_pairs = 0;    ///< entries of neighbor lists
  bigint still = 0;                                    ///< atoms that nothing moves
  bigint unused = 0, unused_still = 0;                 ///< atoms of the fix group in no body

  std::vector<double> labels();
  void count_pairs(const std::vector<double> &label);
  void count_atoms(const std::vector<double> &label);
  void propose(const std::vector<double> &label);
  std::string exclude_still(const std::vector<double> &label) const;
  std::string exclude_own() const;
  bool meets_itself() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
