/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The virial of the centers of mass of all bodies (doc/theory.md, Eq. P6),

     W_ab = sum over pairs of F_a (R_ij)_b = V_ab - sum_i (f_i)_a (d_i)_b,      a <= b,

   where V is the virial of LAMMPS' styles for atoms, and f_i and d_i are force and arm of site i.
   It needs no constraint forces.  LAMMPS computes V in the requested steps.

   As in LAMMPS, the force of another fix counts if the fix adds it to the virial (fix_modify virial
   yes).  Fixes exert their forces in the order of their definition, so those whose forces count come
   before this one, and all others after it: f_i are the forces of styles and of the fixes before. */

#ifndef LMP_GEAR_QUAT_VIRIAL_H
#define LMP_GEAR_QUAT_VIRIAL_H

#include "gear_quat_cell.h"
#include "gear_quat_sites.h"

#include <string>

namespace LAMMPS_NS {
class Compute;
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class MolecularVirial : protected Pointers {
 public:
  /// Adds compute ID_virial, which requests the virial from LAMMPS.
  MolecularVirial(LAMMPS *lmp, const Fix *fix, const Sites &sites);
  ~MolecularVirial() override;

  /// Ends the run if the compute was deleted or replaced since the last run, or if the force of
  /// another fix counts and acts later, or does not count and acts before.
  void refuse_scene() const;
  /// LAMMPS will compute V in that step.
  void request(bigint step) const;
  /// Computes it from V and the forces f on atoms, in post_force() of this fix.  energy: of all
  /// bodies, approximate.  Collective.
  void measure(double **f, double energy);
  /// The virial in units of mass times velocity squared.
  const Upper &value() const { return virial; }
  template <class V> void fields(V &v) { v(virial); }
  /// True if another compute requests a virial in this step.
  bool others_ask(bigint step) const;
  /// The vflag for the evaluation of forces.
  int flag() const;

 private:
  std::string id;
  const Fix *fix;
  const Sites &sites;
  Upper virial;

  Compute *own() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
