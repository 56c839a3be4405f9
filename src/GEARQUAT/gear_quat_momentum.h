/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The total momentum P of the bodies that a thermostat acts on, for each direction of space.

   If the forces on all bodies add up to zero, P is constant and is not heat.  The thermostat then
   acts on momenta relative to the common motion V = P/M, and n bodies have n - 1 degrees of freedom
   of translation in this direction:

     p' = F - xi (p - m V),   2 K = sum p^2/m - P^2/M                                       (T5)

   so that a common motion is conserved and affects nothing else.  If the forces do not add up to
   zero, the thermostat acts on whole momenta, including P.

   A sum of forces counts as zero if it is explained by rounding or by the mesh of long-range
   forces.  Every step measures the sum in each direction in which P was constant so far.  A
   direction in which P has changed is measured again only when histories are reset: between two
   contacts with a wall P is constant, but still part of the heat.

   The host sums the `LIMBS` integers of add_up() over all ranks and passes the sums to take().  The
   sum of momenta is exact (gear_quat_exact_sum.h), so it does not depend on the distribution of
   bodies over ranks. */

#ifndef LMP_GEAR_QUAT_MOMENTUM_H
#define LMP_GEAR_QUAT_MOMENTUM_H

#include "gear_quat_bodies.h"
#include "gear_quat_exact_sum.h"
#include "pointers.h"

#include <algorithm>
#include <string>

namespace LAMMPS_NS::GearQuat {

class TotalMomentum : protected Pointers {
 public:
  static constexpr int LIMBS = 9 * ExactSum::LIMBS;
  static constexpr double IN_ALL = 7.0;    ///< record() if P is constant in all directions

  /// period: the damping time of the thermostat.
  TotalMomentum(LAMMPS *lmp, const Bodies &bodies, double period);

  /// True if the thermostat acts on this momentum: keyword force has not turned it off, and it is
  /// not along z in two dimensions.
  bool belongs(int ibody, int direction) const;
  /// Counts and masses of the bodies by direction.  Collective.
  void weigh();

  /// Called before the sums of a step. kt: of the thermostat.
  void begin_sums(double kt);
  /// The force in the predicted rows of an owned body, in a step.
  void add_predicted(int ibody, const double *force);
  /// Momenta and forces of owned bodies from their present states and loads.
  void add_up(bigint *limbs);
  void take(const bigint *limbs);

  // after take()

  /// True if forces do not add up to zero in a direction in which P was constant: P is no longer
  /// constant there.  Collective.
  bool judge();
  /// P^2/M in the directions in which P is constant.
  double twice_energy() const;
  /// M V_a V_b of the common motion in these directions.
  double twice_energy(int a, int b) const { return mass[a] * common[a] * common[b]; }
  /// Velocity of the common motion in these directions, and the difference of its acceleration from
  /// the acceleration in the predicted rows, if these were added.
  void move_along(Friction &friction) const
  {
    std::copy_n(common, 3, friction.common);
    std::copy_n(unforeseen, 3, friction.unforeseen);
  }

  /// True if the thermostat acts on the momentum of any body, after weigh().
  bool any() const { return count[0] + count[1] + count[2] > 0.0; }
  /// Degrees of freedom of translation, after weigh().
  double freedoms() const;
  /// The excluded total momentum for messages, or empty.
  std::string description() const;

  /// For restart files: bit k is set if P is constant in direction k.
  double record() const;
  void restore(double record);

 private:
  const Bodies &bodies;
  double period;

  bool constant[3] = {true, true, true};
  double count[3] = {}, mass[3] = {};
  double momentum[3] = {}, force[3] = {};
  double common[3] = {};        ///< velocity of the common motion, where it is constant
  double unforeseen[3] = {};    ///< the difference of its acceleration from the predicted rows
  ExactSum differences[3];      ///< of forces on this rank, for unforeseen
  double thermal = 0.0;         ///< momentum of all bodies together at the target
  double unit_momentum = 1.0, unit_force = 1.0;

  bool counts(int direction) const { return constant[direction] && count[direction] > 0.0; }
  double explained() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
