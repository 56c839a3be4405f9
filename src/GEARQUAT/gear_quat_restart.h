/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Binary restart files.  The global block describes the histories in sections, and the data of
   atoms contain them.  Files of 0.3.0 and of all later releases can be read.

   LAMMPS passes the block and the data to the fix that has just been created from the atoms:
   read(), note_place() for each atom, and finally resume(). */

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
  /// Ends the run if the file is from 0.2.0 or earlier, or from a release that does not write
  /// sections.
  void read(const char *buf);
  bool was_read() const { return waiting; }

  int pack(int atom, double *buf) const;
  int size(int atom) const { return HEAD + ownership.packed_size(atom); }
  int max_size() const { return HEAD + ownership.max_exchange(); }
  /// n: the number of other fixes whose data of atoms precede.
  void note_place(int n) { place = n; }

  /// Continues with the bodies of the file; false, without bodies, if the command defines other
  /// bodies.  group: the file gives the bodies of atoms outside of the group, 0 for none.
  /// Collective.
  bool resume(int group);

  /// The text file beside a restart file: all bodies in the format of infile, sorted by ID, with
  /// all digits.  A write error ends the run.  The file is complete at any time: it is written
  /// under another name and then renamed.  rows: of BodyTable, for this rank's owned bodies.
  /// Collective.
  void write_bodies(const std::string &filename, double **rows) const;

 private:
  const Fix *fix;
  const Bodies &bodies;
  Ownership &ownership;
  Motion &motion;

  Sections sections;      ///< of the file
  std::string release;    ///< that wrote it, if known
  bool waiting;           ///< for resume()
  int place;

  static constexpr int HEAD = 2;    ///< of an atom: the count of numbers, and its ID

  std::vector<const double *> packed_atoms() const;
  Ownership::Resumed resume_bodies(int group) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
