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
   the step.  The cost grows with the square of the order.

   Several bodies turn side by side, in the vector registers of the processor.  The operations of a
   body are the same in registers of any length, and so is its result. */

#ifndef GEAR_QUAT_TURN_H
#define GEAR_QUAT_TURN_H

#include "gear_quat_lanes.h"
#include "gear_quat_math.h"

namespace LAMMPS_NS::GearQuat {

class Turn {
 public:
  static constexpr int MOST = 24;    ///< order of the series, and terms of L
  /// The orders of bodies.
  struct Orders {
    int terms, least;
    double fastest[MOST + 1];    ///< squared angle of a step up to which an order is sufficient

    int of(double angle2) const
    {
      int order = least;
      while (order < MOST && angle2 > fastest[order]) ++order;
      return order;
    }
  };
  /// The coefficients of h L(t) along the axes of space.
  using Momentum = double[MOST][3];

  /// terms: known coefficients of L, the others are zero.  The order of the series is at least
  /// `least`, and large enough for a relative error below `accuracy` of a free rotation.
  Turn(int terms, int least, double accuracy);
  /// As accurate as a series can be.
  explicit Turn(int terms) : orders{terms, MOST, {}} {}

  /// The changes of the quaternions of 1 to LANES bodies in the step.  A result does not depend on
  /// the others, and has no rounding error of q.  rows: of each body, `stride` numbers apart; first
  /// the unit quaternion at the beginning, then the coefficients of the integral of h L(t).
  void changes(int count, const RigidBody *const *bodies, const double *const *rows, int stride,
               double (*change)[4]) const;
  /// The series converge up to an angle: a longer step of one body is divided, and its change replaced.
  void change_in_parts(const RigidBody &body, const double *rows, int stride, double *change) const;
  /// q: the unit quaternion of one body, at the beginning and then at the end of the step.
  void advance(const RigidBody &body, const Momentum &momentum, double *q) const;

  /// The Taylor coefficients of q(t), MOST + 1.
  static void coefficients(const RigidBody &body, const Momentum &momentum, int terms,
                           const double *q, double (*found)[4]);

 private:
  Orders orders;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
