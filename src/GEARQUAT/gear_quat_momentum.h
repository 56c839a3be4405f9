/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The momentum formulation, x'' = F/m and L' = torque along the axes of space, for one body or for
   several side by side.

   The quaternion is turned exactly with the predicted L(t), then by a small
   rotation from the residual r of the rows of L.  These have the coefficients of the rows of x, of
   which L' is the second derivative: the angles follow L as x follows x'.
   With a = I^-1 A r, m = h A L and w = I^-1 m, all along the principal axes, the small rotation is
     c_0 a + kappa (w x a - I^-1 (w x A r + m x a))
   The error of the predicted L(t) changes the rotation also by its first moment about the middle of
   the step, in proportion to L.  This would not be symmetric in time and damp librations; the term
   with kappa, the `moment` of gear_quat_history.h, cancels it.

   The rotation of a body with a known angular momentum L(t), along the axes of space:

     q' = 1/2 W(q) (omega, 0),   omega = I^-1 A(q) L(t)

   With q(t) = q(0) p(t), where p = (v, c) is the rotation since the beginning, and l = A(q(0)) L,

     v' = (c omega + v x omega)/2,   c' = -v.omega/2
     omega = I^-1 (l - 2 c u + 2 v x u),   u = v x l

   The Taylor coefficients of these functions follow from each other, one order after the other
   (A. Griewank and A. Walther, Evaluating Derivatives, SIAM 2008, Chap. 13).  Time is in units of
   the step.  The cost grows with the square of the order.

   Several bodies turn side by side, in the vector registers of the processor.  The operations of a
   body are the same in registers of any length, and so is its result. */

#ifndef GEAR_QUAT_MOMENTUM_H
#define GEAR_QUAT_MOMENTUM_H

#include "gear_quat_friction.h"
#include "gear_quat_history.h"

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

/* ---------------------------------------------------------------------- */

/// 1/|q| - 1.
inline double missing_length(const double *q)
{
  const double norm2 = dot4(q, q), part = 1.0 - norm2;
  if (std::fabs(part) < 1.0e-4) return part * (0.5 + part * (0.375 + part * 0.3125));
  const double norm = std::sqrt(norm2);
  return part / (norm * (1.0 + norm));
}
template <class T> GEAR_QUAT_INLINE T missing_lengths(const T *q)
{
  T missing = T();
  constexpr int COUNT = sizeof(T) / sizeof(double);
  for (int lane = 0; lane < COUNT; ++lane) {
    const double one[4] = {get(q[0], lane), get(q[1], lane), get(q[2], lane), get(q[3], lane)};
    set(missing, lane, missing_length(one));
  }
  return missing;
}

/// The change of q by a small turn, of which the result has |q| = 1.
template <class T> GEAR_QUAT_INLINE void small_turn(const T *q, const T *angle_body, T *change)
{
  T after[4];
  quaternion_rate(q, angle_body, change);
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) after[i] = q[i] + change[i];
  const T missing = missing_lengths(after);
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) change[i] += missing * after[i];
}

/// Numbers of a predicted history, and properties of its body.
template <class T> struct Predicted {
  T mass, inertia[3];
  T q[4], rates[6], seconds[6];    ///< of x and L, as in rows 1 and 2
  T force[3], torque_space[3];

  GEAR_QUAT_INLINE void set_lane(int lane, const RigidBody &body, const Load &load,
                                 const double *rows)
  {
    constexpr int WIDTH = Scheme::SECOND_WIDTH;
    set(mass, lane, body.mass);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      set(inertia[i], lane, body.inertia[i]);
      set(force[i], lane, load.force[i]);
      set(torque_space[i], lane, load.torque_space[i]);
    }
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) set(q[i], lane, rows[Scheme::SECOND_QUATERNION + i]);
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      set(rates[i], lane, rows[WIDTH + i]);
      set(seconds[i], lane, rows[2 * WIDTH + i]);
    }
  }
};

/// What a correction changes.
template <class T> struct Corrected {
  T residual[6];                                 ///< of x and L
  T q[4];                                        ///< change of q
  T work, position_error2, quaternion_error2;    // in this order, as in Correction
};

class MomentumStep {
 public:
  MomentumStep(const CorrectorCoefficients &corrector, double h) : corrector(corrector), h(h) {}

  /// A residual r changes a velocity by share() r.
  double share() const { return 0.5 * h * corrector.c[1]; }

  /// The residual with a friction.
  template <class T>
  GEAR_QUAT_INLINE void find_residual(const Predicted<T> &now, const Friction &friction,
                                      T *residual) const
  {
    const double half_h2 = 0.5 * h * h, per_h = 1.0 / h;
    T p[3], damped[3];
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) p[i] = now.mass * (now.rates[i] * per_h);
    friction.add_to(now.force, p, now.mass, damped);
    const T half_h2_per_mass = half_h2 / now.mass;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      residual[i] = half_h2_per_mass * damped[i] - now.seconds[i];
      residual[3 + i] = half_h2 * friction.torque(now.torque_space[i], per_h * now.rates[3 + i]) -
          now.seconds[3 + i];
    }
    if (!friction.implicit) return;
    friction.solve(share(), residual);
    const double part = friction.implicit_torque(share());
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) residual[3 + i] *= part;
  }

  /// The velocities after a correction without friction; of the rotation along the predicted axes.
  template <class T>
  GEAR_QUAT_INLINE void find_free_velocities(const Predicted<T> &now, T *velocity,
                                             T *omega_body) const
  {
    const double half_h2 = 0.5 * h * h, per_h = 1.0 / h;
    T axes[9], per_inertia[3], momentum[3];
    const T half_h2_per_mass = half_h2 / now.mass;
    rotation_matrix(now.q, dot4(now.q, now.q), axes);
    inverse_moments(now.inertia, per_inertia);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const T residual = half_h2_per_mass * now.force[i] - now.seconds[i];
      const T turning = half_h2 * now.torque_space[i] - now.seconds[3 + i];
      velocity[i] = per_h * (now.rates[i] + corrector.c[1] * residual);
      momentum[i] = per_h * (now.rates[3 + i] + corrector.c[1] * turning);
    }
    to_body(axes, momentum, omega_body);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) omega_body[i] *= per_inertia[i];
  }

  /// The changes by a residual.
  template <class T> GEAR_QUAT_INLINE void turn(const Predicted<T> &now, Corrected<T> &found) const
  {
    const T *r = found.residual;
    T axes[9], per_inertia[3], along[3], a[3], m[3], w[3], bent[3], lever[3], turned[3], angle[3];
    T torque_body[3];
    rotation_matrix(now.q, dot4(now.q, now.q), axes);
    inverse_moments(now.inertia, per_inertia);
    to_body(axes, r + 3, along);
    to_body(axes, now.rates + 3, m);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      a[i] = per_inertia[i] * along[i];
      w[i] = per_inertia[i] * m[i];
    }
    cross3(w, along, bent);
    cross3(m, a, lever);
    cross3(w, a, turned);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i)
      angle[i] = corrector.c[0] * a[i] +
          corrector.moment * (turned[i] - per_inertia[i] * (bent[i] + lever[i]));
    small_turn(now.q, angle, found.q);
    to_body(axes, now.torque_space, torque_body);
    found.work = corrector.c[0] * dot3(now.force, r) + dot3(torque_body, angle);
    found.position_error2 = corrector.weight2 * dot3(r, r);
    found.quaternion_error2 = 0.25 * corrector.weight2 * dot3(a, a);
  }

 private:
  const CorrectorCoefficients &corrector;
  double h;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
