/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The total momentum P of the bodies that a thermostat acts on, for each direction of space.

   By a rule P is constant in a direction, and is not heat, if the box is periodic along it, all
   atoms are in bodies of this fix, keyword force holds none of them, and no other fix or pair style
   exerts forces from outside.  The thermostat then acts on momenta relative to the common motion
   V = P/M, and n bodies have n - 1 degrees of freedom of translation in this direction:

     p' = F - xi (p - m V),   2 K = sum p^2/m - P^2/M                                       (T5)

   so that a common motion is conserved and affects nothing else.  In all other directions the
   thermostat acts on whole momenta, including P.  fix_modify extra/dof replaces the rule.

   V is measured in every step, because a deviation from it would grow, by an exact sum
   (gear_quat_exact_sum.h), which does not depend on the distribution of bodies over ranks. */

#ifndef LMP_GEAR_QUAT_MOMENTUM_H
#define LMP_GEAR_QUAT_MOMENTUM_H

#include "gear_quat_bodies.h"
#include "gear_quat_exact_sum.h"
#include "pointers.h"

#include <string>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class TotalMomentum : protected Pointers {
 public:
  TotalMomentum(LAMMPS *lmp, const Fix *fix, const Bodies &bodies) :
      Pointers(lmp), fix(fix), bodies(bodies)
  {
  }

  /// True if the thermostat acts on this momentum: keyword force has not turned it off, and it is
  /// not along z in two dimensions.
  bool belongs(int ibody, int direction) const;
  /// Counts and masses of the bodies, and the rule.  subtracted: degrees of freedom of translation
  /// that do not count, negative for the rule; if they are all of P, P is constant.  bodies_come:
  /// what other fixes insert are bodies.  Collective.
  void weigh(int subtracted, bool bodies_come);

  /// After weigh(), from the present states.  kt: of the thermostat.  Collective.
  void measure(double kt);

  // after measure(), of the directions in which P is constant

  /// P^2/M
  double twice_energy() const;
  /// M V_a V_b of the common motion.
  double twice_energy(int a, int b) const { return mass[a] * common[a] * common[b]; }
  /// Velocity of the common motion.
  const double *velocity() const { return common; }

  /// True if the thermostat acts on the momentum of any body, after weigh().
  bool any() const { return count[0] + count[1] + count[2] > 0.0; }
  /// Degrees of freedom of translation, after weigh().
  double freedoms() const { return count[0] + count[1] + count[2] - subtracted; }
  /// For messages: whether the total momentum counts, and why; empty if it has no directions.
  std::string description() const;

 private:
  const Fix *fix;
  const Bodies &bodies;

  bool constant[3] = {}, stated = false;
  std::string outside;    ///< what exerts forces from outside, empty for nothing
  int subtracted = 0;
  double count[3] = {}, mass[3] = {};
  double momentum[3] = {}, common[3] = {};

  std::string find_outside(bool bodies_come) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
