/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* One step of one body.

     predict            evaluate (host)                   correct
     rows -> t + h  ->  sites at body_state(), forces  ->  rows at t + h

   Momentum formulation, 6 components and the quaternion:
     x'' = F/m,  L' = torque along the axes of space

   First-order formulation (Evans), 13 components:
     x' = p/m,  p' = F,  q' = 1/2 W(q) omega,  omega' from Euler's equations
   Second-order formulation (Rapaport), 7 components:
     x'' = F/m,  q'' = 1/2 W(q) (omega', -2 q'.q')

   Equation numbers: Pratt & Bin Mohamad Zaini.  Once per step the host calls predict(),
   find_states(), [forces] and correct(), or for a body without moments of inertia the functions
   whose names end in center.

   In the momentum formulation the quaternion is turned exactly with the predicted L(t), then by a
   small rotation from the residual r of the rows of L.  These have the coefficients of the rows of x, of
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
   the step.  The cost grows with the square of the order. */

#ifndef GEAR_QUAT_INTEGRATOR_H
#define GEAR_QUAT_INTEGRATOR_H

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

/// Formulation momentum: the velocities and the frame of a body, or of several side by side.  rates:
/// h x' and h L, along the axes of space.
template <class T>
GEAR_QUAT_INLINE void velocities_of_rows(const T *inertia, const T *rates, const T *q, double per_h,
                                         T *velocity, T *omega_body, T *axes, T *omega_space)
{
  T per_inertia[3], along[3];
  rotation_matrix(q, dot4(q, q), axes);
  inverse_moments(inertia, per_inertia);
  to_body(axes, rates + 3, along);
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    velocity[i] = rates[i] * per_h;
    omega_body[i] = per_h * per_inertia[i] * along[i];
  }
  to_space(axes, omega_body, omega_space);
}

/// Up to LANES bodies side by side; the results of each are independent of the others.
struct Block {
  int count = 0;
  const RigidBody *bodies[LANES];
  double *rows[LANES];
  BodyState *states[LANES];
  BodyFrame *frames[LANES];
  const Load *loads[LANES];
  Correction *last[LANES];
};

/// Of bodies side by side.
struct Velocities {
  Lanes linear[3], omega_body[3];
};

class Integrator {
 public:
  /// h: not zero; negative runs backwards.  Throws std::domain_error for a missing tuned set.
  Integrator(const Scheme &scheme, double h) : Integrator(scheme, h, CorrectorCoefficients(scheme))
  {
  }
  /// Uses the given coefficients, as many as in the scheme.
  Integrator(const Scheme &scheme, double h, const CorrectorCoefficients &coefficients) :
      scheme(scheme), h(h), per_h(1.0 / h), n(scheme.values()),
      turning(scheme.is_verlet() ? 1 : n - 1, std::max(scheme.order(), LEAST_ORDER),
              std::pow(10.0, scheme.remembers() ? -15 : -std::min(15, n + 8))),
      corrector(coefficients)
  {
  }

  int values() const { return n; }
  double step() const { return h; }
  /// Another step; histories have to be rescaled with it.
  void set_step(double step)
  {
    h = step;
    per_h = 1.0 / step;
  }

  /// Pose and velocities.
  BodyState body_state(const RigidBody &body, const double *rows) const
  {
    BodyState state;
    BodyFrame frame;
    body_state(body, rows, state, frame);
    return state;
  }

  /// Pose and velocities, and the frame of this state.
  void body_state(const RigidBody &body, const double *rows, BodyState &state,
                  BodyFrame &frame) const
  {
    if (!scheme.momentum()) return find_state(body, rows, state, frame);
    copy(rows + Scheme::POSITION, 3, state.center);
    copy(rows + Scheme::SECOND_QUATERNION, 4, state.q);
    velocities_of_rows(body.inertia, rows + Scheme::SECOND_WIDTH, state.q, per_h, state.velocity,
                       state.omega_body, frame.axes, frame.omega_space);
  }

  /// Position and velocity alone.
  void center_state(const RigidBody &body, const double *rows, BodyState &state) const
  {
    const double *rates = rows + scheme.width();
    copy(rows + Scheme::POSITION, 3, state.center);
    for (int i = 0; i < 3; ++i)
      state.velocity[i] = scheme.first() ? rows[Scheme::MOMENTUM + i] / body.mass
                                         : rates[Scheme::POSITION + i] * per_h;
  }

  /// Formulation momentum: velocities of the state into a history of the same pose.  With velocity
  /// Verlet also the accelerations, which may depend on velocities by a friction.  load: at this pose.
  void set_velocities(const RigidBody &body, const BodyState &state, const Load &load,
                      double *rows) const;

  /// d(|q|^2/2)/dt from the history; it should vanish.
  double radial_rate(const double *rows) const
  {
    const double *q = rows + scheme.quaternion();
    return scheme.momentum() ? 0.0 : dot4(q, q + scheme.width()) / h;
  }

  /// The rotation matrix A of the orientation in a history.
  std::array<double, 9> axes_of(const double *rows) const
  {
    std::array<double, 9> axes;
    const double *q = rows + scheme.quaternion();
    rotation_matrix(q, scheme.norm2(q), axes.data());
    return axes;
  }

  void predict(const Block &block) const
  {
    double turned[LANES][4];
    if (scheme.momentum()) turn(block, turned);
    with_history([&](auto history) {
      for (int body = 0; body < block.count; ++body)
        predict(history, turned[body], block.rows[body]);
    });
  }
  void predict(const RigidBody &body, double *rows) const
  {
    Block one;
    one.count = 1;
    one.bodies[0] = &body;
    one.rows[0] = rows;
    predict(one);
  }

  /// Poses, velocities and frames of the bodies.
  void find_states(const Block &block) const;
  /// Formulation momentum: the velocities after a correction without friction.  An implicit friction
  /// xi divides them by 1 + share() * xi, up to the change of the orientation by the correction.
  void find_velocities(const Block &block, Velocities &found) const;
  double share() const { return momentum_step().share(); }
  /// Corrects predicted histories with the loads at the predicted poses, all with this friction.
  void correct(const Block &block, const Friction &friction) const;

  void predict_center(double *rows) const
  {
    with_history([&](auto history) {
      history.template predict<center_columns(history)>(rows, n);
    });
  }

  void rescale(double *rows, double ratio) const
  {
    with_history([&](auto history) {
      history.rescale(rows, n, ratio);
    });
    if (!scheme.remembers()) return;
    double factor = std::pow(ratio, n), *above = rows + scheme.trial_row();
    for (int i = 0; i < 2 * scheme.width(); ++i) {
      if (i == scheme.width()) factor *= ratio;
      above[i] *= factor;
    }
  }

  /// Corrects a predicted history with the load at the predicted pose, then projects.
  Correction correct(const RigidBody &body, const Load &load, double *rows,
                     const Friction &friction = Friction()) const
  {
    if (scheme.momentum()) {
      const auto now = predicted(body, load, rows);
      Corrected<double> found = {};
      momentum_step().find_residual(now, friction, found.residual);
      momentum_step().turn(now, found);
      return apply(found, rows);
    }
    return correct_by_passes(body, load, friction, rows);
  }

  /// A rotation about an axis without inertia does not change: it has no momentum.
  void scale_momenta(const RigidBody &body, const Multipliers &factor, double *rows) const
  {
    double p[3], omega[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = (factor.translation - 1.0) * rows[Scheme::MOMENTUM + i];
      omega[i] = body.inertia[i] > 0.0 ? (factor.rotation - 1.0) * rows[Scheme::OMEGA + i] : 0.0;
    }
    with_history([&](auto history) {
      history.template add<3>(rows, n, 0, Scheme::MOMENTUM, p);
      history.template add<3>(rows, n, 0, Scheme::OMEGA, omega);
    });
  }

  /// Formulation momentum: moves and turns a body, and changes its momenta.  place: as in row 0, with
  /// the integral of h L in the columns of L; rate: as in row 1.
  void displace(const RigidBody &body, const double *place, const double *rate, double *rows) const
  {
    double turn[3], change[4];
    turn_of(body, axes_of(rows).data(), place + Scheme::ANGULAR_MOMENTUM, turn);
    small_turn(rows + Scheme::SECOND_QUATERNION, turn, change);
    with_history([&](auto history) {
      history.template add<3>(rows, n, 0, Scheme::POSITION, place);
      history.template add<4>(rows, n, 0, Scheme::SECOND_QUATERNION, change);
      history.template add<6>(rows, n, 1, Scheme::POSITION, rate);
    });
  }

  /// I^-1 A L, along the principal axes.
  static void turn_of(const RigidBody &body, const double *axes, const double *momentum,
                      double *turn)
  {
    double per_inertia[3];
    to_body(axes, momentum, turn);
    inverse_moments(body.inertia, per_inertia);
    for (int i = 0; i < 3; ++i) turn[i] *= per_inertia[i];
  }

  /// Torques and moments of inertia are not used.
  void correct_centers(const Block &block, const Friction &friction) const;
  Correction correct_center(const RigidBody &body, const Load &load, double *rows) const
  {
    Correction found;
    Block one;
    one.count = 1;
    one.bodies[0] = &body;
    one.loads[0] = &load;
    one.rows[0] = rows;
    one.last[0] = &found;
    correct_centers(one, Friction());
    return found;
  }

 private:
  friend class Passes;
  template <int CARRIES> using First = Nordsieck<Scheme::FIRST_WIDTH, CARRIES>;
  template <int CARRIES> using Second = Nordsieck<Scheme::SECOND_WIDTH, CARRIES>;
  template <int CARRIES> struct Momenta : Second<CARRIES> {
  };

  static void copy(const double *from, int n, double *to)
  {
#pragma GCC unroll 4
    for (int i = 0; i < n; ++i) to[i] = from[i];
  }

  /// Columns of the center, which come first.
  template <int CARRIES> static constexpr int center_columns(First<CARRIES>)
  {
    return 6;
  }
  template <int CARRIES> static constexpr int center_columns(Second<CARRIES>)
  {
    return 3;
  }

  template <class History> void predict(History history, const double *, double *rows) const
  {
    history.predict(rows, n);
  }

  template <int CARRIES>
  void predict(Momenta<CARRIES> history, const double *turned, double *rows) const
  {
    double *q = rows + Scheme::SECOND_QUATERNION, *carry = CARRIES ? history.carry_of(q, n, 0) : q;
    double kept[4], kept_carry[4];    // q has no part in the sums of the columns of x and L
    history.template add<4>(rows, n, 0, Scheme::SECOND_QUATERNION, turned);
    copy(q, 4, kept);
    if (CARRIES) copy(carry, 4, kept_carry);
    history.template predict<6>(rows, n);
    copy(kept, 4, q);
    if (CARRIES) copy(kept_carry, 4, carry);
  }

  /// The changes of quaternions with the momenta of histories that are not predicted yet.
  void turn(const Block &block, double (*turned)[4]) const
  {
    const double *first[LANES];
    for (int body = 0; body < block.count; ++body)
      first[body] = block.rows[body] + Scheme::SECOND_QUATERNION;
    // velocity Verlet turns bodies with the angular momentum of half a step, so it is symmetric in time
    double half[LANES][2 * Scheme::SECOND_WIDTH];
    for (int body = 0; body < block.count && scheme.is_verlet(); ++body) {
      std::copy_n(first[body], 2 * Scheme::SECOND_WIDTH, half[body]);
      for (int i = 0; i < 3; ++i)
        half[body][Scheme::SECOND_WIDTH + i] += first[body][2 * Scheme::SECOND_WIDTH + i];
      first[body] = half[body];
    }
    turning.changes(block.count, block.bodies, first, Scheme::SECOND_WIDTH, turned);
    for (int body = 0; body < block.count && scheme.remembers(); ++body)
      turning.change_in_parts(*block.bodies[body], first[body], Scheme::SECOND_WIDTH, turned[body]);
  }

  /// Calls act with the kind of history that this scheme has.
  template <class Act> void with_history(Act act) const
  {
    if (scheme.first())
      scheme.compensate ? act(First<1>()) : act(First<0>());
    else if (scheme.momentum())
      scheme.compensate ? act(Momenta<2>()) : act(Momenta<0>());
    else
      scheme.compensate ? act(Second<2>()) : act(Second<0>());
  }

  /// Formulations first and second.
  void find_state(const RigidBody &body, const double *rows, BodyState &state,
                  BodyFrame &frame) const;

  /// Of the series of a turn.  Librations have products of low order, even if they turn slowly.
  static constexpr int LEAST_ORDER = 6;

  Scheme scheme;
  double h, per_h;
  int n;
  Turn turning;
  CorrectorCoefficients corrector;

  Correction correct_by_passes(const RigidBody &body, const Load &load, const Friction &friction,
                               double *rows) const;

  // the momentum formulation

  /// One body alone needs fewer operations with numbers of type double.
  bool side_by_side(const Block &block) const
  {
    return scheme.momentum() && block.count > 1;
  }
  MomentumStep momentum_step() const
  {
    return {corrector, h};
  }

  static Predicted<double> predicted(const RigidBody &body, const Load &load, const double *rows)
  {
    Predicted<double> now;
    now.set_lane(0, body, load, rows);
    return now;
  }

  Correction apply(const Corrected<double> &found, double *rows) const
  {
    scheme.compensate ? apply(Momenta<2>(), found, rows) : apply(Momenta<0>(), found, rows);
    return {found.work, found.position_error2, found.quaternion_error2};
  }
  template <int CARRIES>
  void apply(Momenta<CARRIES> history, const Corrected<double> &found, double *rows) const
  {
    double place[3];
    for (int i = 0; i < 3; ++i) place[i] = corrector.c[0] * found.residual[i];
    history.template add<3>(rows, n, 0, Scheme::POSITION, place);
    history.template add<4>(rows, n, 0, Scheme::SECOND_QUATERNION, found.q);
    history.template correct<6, 1>(rows, n, corrector.c.data(), 0, found.residual);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
