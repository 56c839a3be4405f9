/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Binary restart files.  The global block says what the histories are, the data of atoms hold them.

   LAMMPS hands both to the fix that has just been made from the atoms: read(), note_place() for
   each atom, and then, when all is there, resume(). */

#ifndef LMP_GEAR_QUAT_RESTART_H
#define LMP_GEAR_QUAT_RESTART_H

#include "gear_quat_motion.h"

#include <cstdio>

namespace LAMMPS_NS::GearQuat {

class Restart : protected Pointers {
 public:
  Restart(LAMMPS *lmp, const Fix *fix, Ownership &ownership, Motion &motion);

  void write(FILE *fp) const;
  /// Ends the run if another release wrote this with other contents.
  void read(const char *buf);
  bool was_read() const { return waiting; }

  int pack(int atom, double *buf) const;
  int size(int atom) const { return HEAD + ownership.packed_size(atom); }
  int max_size() const { return HEAD + ownership.max_exchange(); }
  /// The data of atoms are behind those of so many other fixes.
  void note_place(int n) { place = n; }

  /// The bodies of the file go on; false if the command has other ones: then there are none.
  /// group: atoms outside of it are in what bodies the file says, 0 for none.  Collective.
  bool resume(int group);

 private:
  const Fix *fix;
  Ownership &ownership;
  Motion &motion;

  struct Block {
    double magic, format;
    double extended;    ///< bodies have sites that are more than points
    double natoms;      ///< in the file
    Motion::Checkpoint motion;
  };
  Block block;
  bool waiting;    ///< for resume()
  int place;

  static constexpr int HEAD = 2;    ///< of an atom: how many numbers there are, and its ID

  std::vector<const double *> packed_atoms() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
