/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The rotation of a body with a known angular momentum L(t), along the axes of space:

     q' = 1/2 W(q) (omega, 0),   omega = I^-1 A(q) L(t)

   With q(t) = q(0) p(t), where p = (v, c) is the rotation since the beginning, and l = A(q(0)) L,

     v' = (c omega + v x omega)/2,   c' = -v.omega/2
     omega = I^-1 (l - 2 c u + 2 v x u),   u = v x l

   The Taylor coefficients of these functions follow from each other, one order after the other
   (A. Griewank and A. Walther, Evaluating Derivatives, SIAM 2008, Chap. 13).  Time is in units of
   the step.  The cost grows with the square of the order. */

#ifndef GEAR_QUAT_TURN_H
#define GEAR_QUAT_TURN_H

#include "gear_quat_math.h"

namespace LAMMPS_NS::GearQuat {

class Turn {
 public:
  static constexpr int MOST = 24;    ///< order of the series, and terms of L
  static constexpr int LANES = 2;    ///< bodies that turn side by side

  /// The coefficients of h L(t) along the axes of space.
  using Momentum = double[MOST][3];

  /// terms: known coefficients of L, the others are zero.  The order of the series is larger than
  /// this, so that all of them count, and large enough for a relative error below `accuracy` of a
  /// free rotation.
  explicit Turn(int terms, double accuracy = 1.0e-14);

  /// The changes of the quaternions of up to LANES bodies in the step.  A result does not depend on
  /// the others, and has no rounding error of q.  q: unit quaternions at the beginning.
  void changes(int count, const RigidBody *const *bodies, const Momentum *momenta,
               const double *const *q, double (*change)[4]) const;
  /// q: the unit quaternion of one body, at the beginning and then at the end of the step.
  void advance(const RigidBody &body, const Momentum &momentum, double *q) const;

  /// The Taylor coefficients of q(t), MOST + 1.
  static void coefficients(const RigidBody &body, const Momentum &momentum, int terms,
                           const double *q, double (*found)[4]);

 private:
  static constexpr int ORDERS[] = {5, 6, 7, 8, 9, 10, 12, 16, MOST};
  static constexpr int KINDS = sizeof(ORDERS) / sizeof(*ORDERS);

  int terms;
  double fastest[KINDS];    ///< squared angle of a step up to which an order is sufficient

  int order_for(double angle2) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
