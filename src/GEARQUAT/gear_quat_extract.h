/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What other C++ code may ask the fix by name, see Fix::extract(): names as those of fix rigid where
   it has them.  Bodies are numbered as in the local data of the fix, owned ones first. */

#ifndef LMP_GEAR_QUAT_EXTRACT_H
#define LMP_GEAR_QUAT_EXTRACT_H

#include "gear_quat_bodies.h"

#include <string>

namespace LAMMPS_NS::GearQuat {

class Extract : protected Pointers {
 public:
  /// template_id: that of keyword mol, or empty.
  Extract(LAMMPS *lmp, const Bodies &bodies, const std::string &template_id) :
      Pointers(lmp), bodies(bodies), template_id(template_id)
  {
  }

  /// Null for an unknown name.  The result holds until atoms or bodies are exchanged, created or
  /// removed, or until the same name is asked for again.  dim: 0 scalar, 1 vector, 2 array.
  ///   body         int *      owned atoms: number of the body, -1 for none
  ///   nbody        int *      owned and ghost bodies of this rank
  ///   masstotal    double *   owned and ghost bodies
  ///   inertia      double **  the same: principal moments
  ///   ke           double *   translational kinetic energy of all bodies; collective
  ///   erotational  double *   rotational kinetic energy of all bodies; collective
  ///   onemol       Molecule **  the molecules of the template of keyword mol, null without
  void *extract(const std::string &name, int &dim);

 private:
  const Bodies &bodies;
  std::string template_id;

  std::vector<int> body;
  int nbody = 0;
  std::vector<double> masstotal, inertia;
  std::vector<double *> inertia_rows;
  double ke = 0.0, erotational = 0.0;

  double energy(bool rotational) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
