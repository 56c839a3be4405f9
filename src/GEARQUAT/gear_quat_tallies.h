/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What LAMMPS notes of computes: in which step each was evaluated last, for which steps it was asked,
   and in which step energies and virials were tallied.  A fix whose force is a variable of computes
   changes these notes whenever its force is evaluated, between steps too. */

#ifndef LMP_GEAR_QUAT_TALLIES_H
#define LMP_GEAR_QUAT_TALLIES_H

#include "lmptype.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS::GearQuat {

class Tallies : protected Pointers {
 public:
  explicit Tallies(LAMMPS *lmp) : Pointers(lmp) {}

  /// Keep the notes, and forget that computes were evaluated.
  void save();
  /// Energies and virials of the last step pass for those of the present step number.
  void pretend();
  /// True if a compute that needs such a tally was evaluated since save().
  bool used() const;
  /// Put back what save() kept.  Computes that were evaluated since will be evaluated again.
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

}    // namespace LAMMPS_NS::GearQuat

#endif
