/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The virial of the centers of mass of all bodies (doc/theory.md, Eq. P6),

     W_ab = sum over pairs of F_a (R_ij)_b = V_ab - sum_i (f_i)_a (d_i)_b,      a <= b,

   where V is the virial of LAMMPS' styles for atoms, and f_i and d_i are force and arm of site i.  It
   needs no forces of constraint.  LAMMPS computes V in the steps that are asked for. */

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
  /// Adds compute ID_virial, by which LAMMPS knows the steps that need a virial.
  MolecularVirial(LAMMPS *lmp, const Fix *fix, const Sites &sites);
  ~MolecularVirial() override;

  /// LAMMPS computes V in that step.
  void request(bigint step) const;
  /// Of the forces f on atoms that were evaluated last, with V.  energy: of all bodies, roughly.
  /// Collective.
  void measure(double **f, double energy);
  /// In units of mass times velocity squared.
  const Upper &value() const { return virial; }
  void restore(const Upper &saved) { virial = saved; }
  /// True if some atoms have torques of their own, which V does not know.  Collective.
  bool has_torques() const;
  /// True if a compute other than that of this class asks for a virial in this step.
  bool others_ask(bigint step) const;
  /// What vflag has to be when forces are evaluated.
  int flag() const;

 private:
  std::string id;
  const Sites &sites;
  Upper virial;

  Compute *own() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
