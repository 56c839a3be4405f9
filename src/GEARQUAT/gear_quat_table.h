/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What users see of every body: a row of numbers, for the fix's global array (all bodies on all
   ranks, sorted by ID) and for its local data (owned bodies). */

#ifndef LMP_GEAR_QUAT_TABLE_H
#define LMP_GEAR_QUAT_TABLE_H

#include "gear_quat_bodies.h"

namespace LAMMPS_NS::GearQuat {

class BodyTable : protected Pointers {
 public:
  /// Columns, counted from 0; the first fifteen are those of fix rigid.
  enum {
    CENTER = 0,
    VELOCITY = 3,
    FORCE = 6,
    TORQUE = 9,
    IMAGE = 12,
    QUATERNION = 15,
    OMEGA_BODY = 19,
    ANGULAR_MOMENTUM = 22,
    POSITION_ERROR = 25,
    ANGLE_ERROR = 26,
    ID = 27,
    COLUMNS = 28
  };

  BodyTable(LAMMPS *lmp, const Bodies &bodies) : Pointers(lmp), bodies(bodies) {}

  /// Rows of owned bodies, anew at every call; the pointers stay valid until the next one.
  double **local();
  /// A number of the global array, 0 in rows without a body.  Rows are gathered when the first is
  /// asked for after forget(): collective.
  double global(int row, int column);
  /// Poses, loads or bodies have changed.
  void forget() { gathered = false; }
  double memory_usage() const
  {
    return (mine.capacity() + all.capacity()) * sizeof(double) + rows.capacity() * sizeof(double *);
  }

 private:
  const Bodies &bodies;
  std::vector<double> mine, all;
  std::vector<double *> rows;
  bool gathered = false;    ///< `all` is of the present poses

  void fill(std::vector<double> &rows_here) const;
  void wrap(const double *center, double *wrapped, double *image) const;
  void fill_row(int ibody, double *row) const;
  void gather();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
