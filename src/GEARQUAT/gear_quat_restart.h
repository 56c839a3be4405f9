/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Binary restart files.  The global block consists of MAGIC, FORMAT, the count of the numbers that
   follow, and the numbers of the objects (gear_quat_fields.h).  The data of atoms contain the
   histories.  A file is read by releases with the same format.

   LAMMPS passes the block and the data to the fix that has just been created from the atoms:
   read(), note_place() for each atom, and finally resume(). */

#ifndef LMP_GEAR_QUAT_RESTART_H
#define LMP_GEAR_QUAT_RESTART_H

#include "gear_quat_step.h"

#include <cstdio>

namespace LAMMPS_NS::GearQuat {

class Restart : protected Pointers {
 public:
  Restart(LAMMPS *lmp, const Fix *fix, const Bodies &bodies, Ownership &ownership, Step &step);

  void write(FILE *fp) const;
  /// Ends the run if a release with another format has written the file.
  void read(const char *buf);
  bool was_read() const { return file.reads(); }

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
  /// under another name and then renamed.  rows: of Outputs, for this rank's owned bodies.
  /// Collective.
  void write_bodies(const std::string &filename, double **rows) const;

 private:
  const Fix *fix;
  const Bodies &bodies;
  Ownership &ownership;
  Step &step;

  Fields file;                            ///< the numbers that have not been read yet
  double extended = 0.0, natoms = 0.0;    ///< of the file: are there extended sites; all atoms
  int place = 0;

  static constexpr double MAGIC = 0x6765617271756174;    ///< "gearquat"
  static constexpr double FORMAT = 10;
  static constexpr int HEAD = 2;    ///< of an atom: the count of numbers, and its ID

  std::vector<const double *> packed_atoms() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
