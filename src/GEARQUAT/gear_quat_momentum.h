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

   The host sums the `LIMBS` integers of add_up() over all ranks and passes the sums to take().  The
   sum of momenta is exact (gear_quat_exact_sum.h), so it does not depend on the distribution of
   bodies over ranks.  V is summed anew in every step, because a deviation from it would grow. */

#ifndef LMP_GEAR_QUAT_MOMENTUM_H
#define LMP_GEAR_QUAT_MOMENTUM_H

#include "gear_quat_bodies.h"
#include "gear_quat_exact_sum.h"
#include "pointers.h"

#include <algorithm>
#include <string>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class TotalMomentum : protected Pointers {
 public:
  static constexpr int LIMBS = 6 * ExactSum::LIMBS;

  /// period: the damping time of the thermostat.
  TotalMomentum(LAMMPS *lmp, const Fix *fix, const Bodies &bodies, double period) :
      Pointers(lmp), fix(fix), bodies(bodies), period(period)
  {
  }

  /// True if the thermostat acts on this momentum: keyword force has not turned it off, and it is
  /// not along z in two dimensions.
  bool belongs(int ibody, int direction) const;
  /// Counts and masses of the bodies, and the rule.  subtracted: degrees of freedom of translation
  /// that do not count, negative for the rule; if they are all of P, P is constant.  bodies_come:
  /// what other fixes insert are bodies.  Collective.
  void weigh(int subtracted, bool bodies_come);

  /// Called before the sums of a step. kt: of the thermostat.
  void begin_sums(double kt);
  /// The force in the predicted rows of an owned body, in a step.
  void add_predicted(int ibody, const double *force);
  /// Momenta of owned bodies from their present states.
  void add_up(bigint *limbs) const;
  void take(const bigint *limbs);

  // after take(), of the directions in which P is constant

  /// P^2/M
  double twice_energy() const;
  /// M V_a V_b of the common motion.
  double twice_energy(int a, int b) const { return mass[a] * common[a] * common[b]; }
  /// Velocity of the common motion, and the difference of its acceleration from the acceleration in
  /// the predicted rows, if these were added.
  void move_along(Friction &friction) const
  {
    std::copy_n(common, 3, friction.common);
    std::copy_n(unforeseen, 3, friction.unforeseen);
  }

  /// True if the thermostat acts on the momentum of any body, after weigh().
  bool any() const { return count[0] + count[1] + count[2] > 0.0; }
  /// Degrees of freedom of translation, after weigh().
  double freedoms() const { return count[0] + count[1] + count[2] - subtracted; }
  /// For messages: whether the total momentum counts, and why; empty if it has no directions.
  std::string description() const;

 private:
  const Fix *fix;
  const Bodies &bodies;
  double period;

  bool constant[3] = {}, stated = false;
  std::string outside;    ///< what exerts forces from outside, empty for nothing
  int subtracted = 0;
  double count[3] = {}, mass[3] = {};
  double momentum[3] = {}, common[3] = {}, unforeseen[3] = {};
  ExactSum differences[3];    ///< of forces on this rank, for unforeseen
  double unit_momentum = 1.0, unit_force = 1.0;

  std::string find_outside(bool bodies_come) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
