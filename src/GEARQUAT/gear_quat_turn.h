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

  /// The coefficients of h L(t) along the axes of space.
  using Momentum = double[MOST][3];

  /// Orientation after the step.  terms: known coefficients of L; the others are zero.  q: unit
  /// quaternion at its beginning, and the result.  least: order of the series at least; a fast
  /// rotation has a higher order.
  static void advance(const RigidBody &body, const Momentum &momentum, int terms, int least,
                      double *q);

  /// The Taylor coefficients of q(t), MOST + 1.
  static void coefficients(const RigidBody &body, const Momentum &momentum, int terms,
                           const double *q, double (*found)[4]);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
