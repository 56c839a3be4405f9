/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Output of the bodies: the fix's scalar and vector for all bodies together, a row of numbers for
   each body in its global array and local data, and data for other C++ code by name. */

#ifndef LMP_GEAR_QUAT_OUTPUTS_H
#define LMP_GEAR_QUAT_OUTPUTS_H

#include "gear_quat_given_bodies.h"
#include "gear_quat_sites.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Outputs : protected Pointers {
 public:
  /// template_id: template of keyword mol, or empty.
  Outputs(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership, const Sites &sites,
          const std::string &template_id);

  // the fix's scalar and vector; collective

  /// Elements of the vector, as listed in the manual.
  static constexpr int KE_TRANSLATION = 0, KE_ROTATION = 1, NORM = 2, RADIAL = 3, MAX_POSITION = 4,
                       RMS_POSITION = 5, MAX_ANGLE = 6, RMS_ANGLE = 7, ELEMENTS = 8;
  /// Change of the potential energy from the predicted to the corrected pose; zero if it is less
  /// than the effect of round-off in the centers on the loads.
  double energy_correction() const;
  /// An element; integrator: null while there are no histories.
  double element(int n, const Integrator *integrator) const;

  // a row of numbers of every body, for the fix's global array (all bodies on all ranks, sorted by
  // ID) and for its local data (owned bodies)

  /// Columns, counted from 0; the first fifteen are as in fix rigid.
  static constexpr int CENTER = 0, VELOCITY = 3, FORCE = 6, TORQUE = 9, IMAGE = 12, QUATERNION = 15,
                       OMEGA_BODY = 19, ANGULAR_MOMENTUM = 22, POSITION_ERROR = 25,
                       ANGLE_ERROR = 26, ID = 27, COLUMNS = 28;
  /// Rows of owned bodies, computed at every call; the pointers stay valid until the next call.
  double **local();
  /// A number of the global array, 0 in rows without a body.  Rows are gathered at the first
  /// request after sites were listed or placed: collective.
  double global(int row, int column);

  /// Data that other C++ code may request from the fix by name, see Fix::extract(): names as in fix
  /// rigid where they exist.  Bodies are numbered as in the local data, owned bodies first.  Null
  /// for an unknown name.  The result is valid until atoms or bodies are exchanged, created or
  /// removed, or until the same name is requested again.  dim: 0 scalar, 1 vector.
  ///   body         int *      owned atoms: number of the body, -1 for none
  ///   nbody        int *      owned and ghost bodies of this rank
  ///   masstotal    double *   owned and ghost bodies
  ///   onemol       Molecule **  the molecules of the template of keyword mol, otherwise null
  void *extract(const std::string &name, int &dim);

  double memory_usage() const
  {
    return (mine.capacity() + all.capacity()) * sizeof(Row) + rows.capacity() * sizeof(double *);
  }

 private:
  const Bodies &bodies;
  const Ownership &ownership;
  const Sites &sites;
  std::string template_id;

  using Row = std::array<double, COLUMNS>;
  std::vector<Row> mine, all;
  std::vector<double *> rows;    ///< of `mine`
  int gathered = -1;             ///< number of placements when `all` was gathered

  std::vector<int> body;    ///< the last results of extract()
  int nbody = 0;
  std::vector<double> masstotal;

  void wrap(const double *center, double *wrapped, double *image) const;
  void fill_row(int ibody, double *row) const;
  std::vector<Row> owned_rows() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
