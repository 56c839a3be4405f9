/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Binary restart files.  The global block says in sections what the histories are, and the data of
   atoms hold them.  Files of 0.3.0 and of all later releases are read.

   LAMMPS hands both to the fix that has just been made from the atoms: read(), note_place() for
   each atom, and then, when all is there, resume(). */

#ifndef LMP_GEAR_QUAT_RESTART_H
#define LMP_GEAR_QUAT_RESTART_H

#include "gear_quat_motion.h"
#include "gear_quat_sections.h"

#include <cstdio>

namespace LAMMPS_NS::GearQuat {

class Restart : protected Pointers {
 public:
  Restart(LAMMPS *lmp, const Fix *fix, const Bodies &bodies, Ownership &ownership, Motion &motion);

  void write(FILE *fp) const;
  /// Ends the run if this is of 0.2.0 or before, or of a release that does not write sections.
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

  /// The text beside a restart file: all bodies in the format of infile, sorted by ID, with all
  /// digits.  A file that cannot be written ends the run.  A file of this name is whole at any
  /// time: it is written under another name and then renamed.  rows: those of BodyTable for this
  /// rank's owned bodies.  Collective.
  void write_bodies(const std::string &filename, double **rows) const;

 private:
  const Fix *fix;
  const Bodies &bodies;
  Ownership &ownership;
  Motion &motion;

  Sections sections;      ///< of the file
  std::string release;    ///< that wrote it, if it is known
  bool waiting;           ///< for resume()
  int place;

  static constexpr int HEAD = 2;    ///< of an atom: how many numbers there are, and its ID

  std::vector<const double *> packed_atoms() const;
  Ownership::Resumed resume_bodies(int group) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
