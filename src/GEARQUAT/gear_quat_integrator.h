/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* One step of one body.

     predict            evaluate (host)                   correct
     rows -> t + h  ->  sites at body_state(), forces  ->  rows at t + h

   Momentum formulation, 6 components and the quaternion:
     x'' = F/m,  L' = torque along the axes of space
   The quaternion turns exactly with the predicted L(t) (gear_quat_turn.h), then by a small rotation
   from the residual r of the rows of L.  These have the coefficients of the rows of x, of which L'
   is the second derivative: the angles follow L as x follows x'.
   With a = I^-1 A r, m = h A L and w = I^-1 m, all along the principal axes, the small rotation is
     c_0 a + kappa (w x a - I^-1 (w x A r + m x a))
   The error of the predicted L(t) changes the rotation also by its first moment about the middle of
   the step, in proportion to L.  This would not be symmetric in time and damp librations; the term
   with kappa, the `moment` of gear_quat_coefficients.h, cancels it.

   First-order formulation (Evans), 13 components:
     x' = p/m,  p' = F,  q' = 1/2 W(q) omega,  omega' from Euler's equations
   Second-order formulation (Rapaport), 7 components:
     x'' = F/m,  q'' = 1/2 W(q) (omega', -2 q'.q')

   Equation numbers: Pratt & Bin Mohamad Zaini.  Once per step the host calls predict(),
   body_state(), [forces] and correct(), or for a body without moments of inertia the functions
   whose names end in center. */

#ifndef GEAR_QUAT_INTEGRATOR_H
#define GEAR_QUAT_INTEGRATOR_H

#include "gear_quat_coefficients.h"
#include "gear_quat_gauss.h"
#include "gear_quat_history.h"
#include "gear_quat_turn.h"

namespace LAMMPS_NS::GearQuat {

/// Replaces Friction where there is none.
struct Undamped {
  static constexpr bool implicit = false;

  double force(int, double met, const double *, double) const { return met; }
  double torque(double met, double) const { return met; }
  void solve(double, double *) const {}
  double implicit_torque(double) const { return 1.0; }
};

class Integrator : public Kinematics {
 public:
  /// h: not zero; negative runs backwards.  Throws std::domain_error for a missing tuned set.
  Integrator(const Scheme &scheme, double h) : Integrator(scheme, h, CorrectorCoefficients(scheme))
  {
  }
  /// Uses the given coefficients, as many as in the scheme.
  Integrator(const Scheme &scheme, double h, const CorrectorCoefficients &coefficients) :
      Kinematics(scheme, h), n(scheme.values()),
      turning(scheme.is_verlet() ? 1 : n - 1, std::max(scheme.order(), LEAST_ORDER),
              std::pow(10.0, scheme.remembers() ? -15 : -std::min(15, n + 8))),
      corrector(coefficients)
  {
  }

  int values() const { return n; }

  /// Up to Turn::LANES bodies; each result is independent of the others.
  void predict(int count, const RigidBody *const *bodies, double *const *rows) const
  {
    double turned[Turn::LANES][4];
    if (scheme.momentum()) turn(count, bodies, rows, turned);
    with_history([&](auto history) {
      for (int body = 0; body < count; ++body) predict(history, turned[body], rows[body]);
    });
  }
  void predict(const RigidBody &body, double *rows) const
  {
    const RigidBody *one = &body;
    predict(1, &one, &rows);
  }

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

  /// Corrects a predicted history with the load at the predicted pose, then projects.  axes: of
  /// this pose, from axes_of().
  Correction correct(const RigidBody &body, const Load &load, const double *axes,
                     double *rows) const
  {
    if (scheme.momentum()) {
      Residual total;
      position_residual(body, load, rows, total.x);
      momentum_residual(load.torque_space, rows, total.q);
      return correct_momenta(body, load, axes, total, rows);
    }
    Pending pending = begin(load, axes, rows);
    for (int k = 0; k < scheme.passes; ++k) correct_pass(body, load, Undamped(), rows, pending, k);
    return finish(body, load, rows, pending);
  }
  Correction correct(const RigidBody &body, const Load &load, double *rows) const
  {
    return correct(body, load, axes_of(rows).data(), rows);
  }

  // With a friction that depends on all bodies: begin(), [friction] and correct_pass() for each
  // pass, finish(), and in the first-order form also scale_momenta().

  struct Residual {    ///< summed over the passes
    double x[3];
    double q[4];    ///< formulation momentum: of L, three components
  };
  /// The part of the prediction that a correction needs.
  struct Pending {
    double x[3], q[4], torque_body[3];
    Residual total;
  };

  Pending begin(const Load &load, const double *axes, const double *rows) const
  {
    Pending pending;
    copy(rows + Scheme::POSITION, 3, pending.x);
    copy(rows + scheme.quaternion(), 4, pending.q);
    to_body(axes, load.torque_space, pending.torque_body);
    pending.total = Residual();
    return pending;
  }

  /// Damper: Friction, or a class with the same functions.  earlier: passes without friction.
  template <class Damper>
  void correct_pass(const RigidBody &body, const Load &load, const Damper &friction, double *rows,
                    Pending &pending, int earlier = 0) const
  {
    with_history([&](auto history) {
      pass(history, body, load, friction, rows, pending, earlier);
    });
  }

  /// The velocities after the passes so far.
  void velocities_of_pass(const RigidBody &body, const double *rows, const Pending &pending,
                          double *velocity, double *omega_body) const
  {
    if (scheme.first()) {
      for (int i = 0; i < 3; ++i) velocity[i] = rows[Scheme::MOMENTUM + i] / body.mass;
      copy(rows + Scheme::OMEGA, 3, omega_body);
    } else if (scheme.momentum()) {
      double momentum[3];
      momentum_of_pass(rows, pending.total.q, momentum);
      velocity_of_pass(rows, pending.total.x, velocity);
      omega_of(body, axes_of(rows).data(), momentum, omega_body);
    } else {
      double q[4], qdot[4];
      velocity_of_pass(rows, pending.total.x, velocity);
      rotation_of_pass(rows, pending.total.q, q, qdot);
      angular_velocity(q, scheme.norm2(q), qdot, omega_body);
    }
  }

  /// Projects |q| = 1 and, in the second-order form, q.qdot = 0.
  Correction finish(const RigidBody &body, const Load &load, double *rows,
                    const Pending &pending) const
  {
    if (scheme.momentum())    // axes: predicted
      return correct_momenta(body, load, axes_of(rows).data(), pending.total, rows);
    with_history([&](auto history) {
      finish_passes(history, rows, pending);
    });
    return conclude(load, rows, pending);
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
    inverse_moments(body, per_inertia);
    for (int i = 0; i < 3; ++i) turn[i] *= per_inertia[i];
  }

  /// Torque and moments of inertia are not used.
  Correction correct_center(const RigidBody &body, const Load &load, double *rows) const
  {
    double x[3], residual[3] = {0.0, 0.0, 0.0}, dx[3];
    copy(rows + Scheme::POSITION, 3, x);
    with_history([&](auto history) {
      correct_center(history, body, load, Undamped(), rows, residual);
    });
    for (int i = 0; i < 3; ++i) dx[i] = rows[i] - x[i];
    return {dot3(load.force, dx), corrector.weight2 * dot3(residual, residual), 0.0};
  }

 private:
  template <int CARRIES> using First = Nordsieck<Scheme::FIRST_WIDTH, CARRIES>;
  template <int CARRIES> using Second = Nordsieck<Scheme::SECOND_WIDTH, CARRIES>;
  template <int CARRIES> struct Momenta : Second<CARRIES> {
  };

  /// Columns of the center, which come first.
  template <int CARRIES> static constexpr int center_columns(First<CARRIES>) { return 6; }
  template <int CARRIES> static constexpr int center_columns(Second<CARRIES>) { return 3; }

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
  void turn(int count, const RigidBody *const *bodies, double *const *rows,
            double (*turned)[4]) const
  {
    const double *first[Turn::LANES];
    for (int body = 0; body < count; ++body) first[body] = rows[body] + Scheme::SECOND_QUATERNION;
    // velocity Verlet turns bodies with the angular momentum of half a step, so it is symmetric in time
    double half[Turn::LANES][2 * Scheme::SECOND_WIDTH];
    for (int body = 0; body < count && scheme.is_verlet(); ++body) {
      std::copy_n(first[body], 2 * Scheme::SECOND_WIDTH, half[body]);
      for (int i = 0; i < 3; ++i)
        half[body][Scheme::SECOND_WIDTH + i] += first[body][2 * Scheme::SECOND_WIDTH + i];
      first[body] = half[body];
    }
    turning.changes(count, bodies, first, Scheme::SECOND_WIDTH, turned);
    for (int body = 0; body < count && scheme.remembers(); ++body)
      turning.change_in_parts(*bodies[body], first[body], Scheme::SECOND_WIDTH, turned[body]);
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

  /// Of the series of a turn.  Librations have products of low order, even if they turn slowly.
  static constexpr int LEAST_ORDER = 6;

  int n;
  Turn turning;
  CorrectorCoefficients corrector;

  /// The residual: of the first derivative.
  template <int COUNT, class History>
  void feed_back(History history, double *rows, int component, const double *residual,
                 double *total = nullptr) const
  {
    history.template correct<COUNT>(rows, n, corrector.c.data(), component, residual);
    if (total)
      for (int i = 0; i < COUNT; ++i) total[i] += residual[i];
  }

  /// Momenta (Eq. 14) and positions (Eq. 13).
  template <int CARRIES, class Damper>
  void correct_center(First<CARRIES> history, const RigidBody &body, const Load &load,
                      const Damper &damper, double *rows, double *residual) const
  {
    const double *rates = rows + scheme.width(), *momentum = rows + Scheme::MOMENTUM;
    double before[3], target[3];
    copy(momentum, 3, before);
    for (int i = 0; i < 3; ++i)
      target[i] =
          h * damper.force(i, load.force[i], before, body.mass) - rates[Scheme::MOMENTUM + i];
    if (damper.implicit) damper.solve(h * corrector.c[0], target);
    feed_back<3>(history, rows, Scheme::MOMENTUM, target);
    const double *p = scheme.predicted_momentum ? before : momentum;
    for (int i = 0; i < 3; ++i) target[i] = h * p[i] / body.mass - rates[Scheme::POSITION + i];
    feed_back<3>(history, rows, Scheme::POSITION, target, residual);
  }

  /// Angular velocities (Eqs. 7, 15) and quaternions (Eqs. 5, 16).
  template <int CARRIES, class Damper>
  void correct_rotation(First<CARRIES> history, const RigidBody &body, const double *torque_body,
                        const Damper &damper, double *rows, double *residual) const
  {
    const int quat = scheme.quaternion();
    const double *rates = rows + scheme.width(), *omega_body = rows + Scheme::OMEGA;
    double before[3], torque[3], target[4];
    copy(omega_body, 3, before);
    for (int i = 0; i < 3; ++i)
      torque[i] = damper.torque(torque_body[i], body.inertia[i] * before[i]);
    angular_acceleration(body, torque, before, target);
    for (int i = 0; i < 3; ++i) target[i] = h * target[i] - rates[Scheme::OMEGA + i];
    if (damper.implicit)
      for (int i = 0; i < 3; ++i)
        if (body.inertia[i] > 0.0) target[i] *= damper.implicit_torque(h * corrector.c[0]);
    feed_back<3>(history, rows, Scheme::OMEGA, target);
    quaternion_rate(rows + quat, scheme.predicted_omega ? before : omega_body, target);
    for (int i = 0; i < 4; ++i) target[i] = h * target[i] - rates[quat + i];
    feed_back<4>(history, rows, quat, target, residual);
  }

  template <int CARRIES, class Damper>
  void pass(First<CARRIES> history, const RigidBody &body, const Load &load, const Damper &friction,
            double *rows, Pending &pending, int earlier) const
  {
    if (earlier == 0)    // with constant forces once is sufficient
      correct_center(history, body, load, friction, rows, pending.total.x);
    correct_rotation(history, body, pending.torque_body, friction, rows, pending.total.q);
  }

  template <int CARRIES>
  void finish_passes(First<CARRIES> history, double *rows, const Pending &) const
  {
    if (scheme.project) project_row(history, rows);
  }

  Correction conclude(const Load &load, const double *rows, const Pending &pending) const
  {
    const double *q = rows + scheme.quaternion();
    double dx[3], dq[4], angle_body[3];
    for (int i = 0; i < 3; ++i) dx[i] = rows[i] - pending.x[i];
    for (int i = 0; i < 4; ++i) dq[i] = q[i] - pending.q[i];
    angular_velocity(pending.q, dot4(pending.q, pending.q), dq, angle_body);
    const Residual &total = pending.total;
    return {dot3(load.force, dx) + dot3(pending.torque_body, angle_body),
            corrector.weight2 * dot3(total.x, total.x), corrector.weight2 * dot4(total.q, total.q)};
  }

  // the momentum formulation

  /// The small rotation of the correction, along the principal axes.  Returns |a|^2.
  double small_rotation(const RigidBody &body, const double *axes, const double *rows,
                        const double *residual, double *angle_body) const
  {
    double per_inertia[3], along[3], a[3], m[3], w[3], bent[3], lever[3], turned[3];
    inverse_moments(body, per_inertia);
    to_body(axes, residual, along);
    to_body(axes, rows + Scheme::SECOND_WIDTH + Scheme::ANGULAR_MOMENTUM, m);
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
      angle_body[i] = corrector.c[0] * a[i] +
          corrector.moment * (turned[i] - per_inertia[i] * (bent[i] + lever[i]));
    return dot3(a, a);
  }

  /// The change of q by a small turn, of which the result has |q| = 1.
  static void small_turn(const double *q, const double *angle_body, double *change)
  {
    double after[4];
    quaternion_rate(q, angle_body, change);
    for (int i = 0; i < 4; ++i) after[i] = q[i] + change[i];
    const double missing = missing_length(after);
    for (int i = 0; i < 4; ++i) change[i] += missing * after[i];
  }

  void momentum_residual(const double *torque_space, const double *rows, double *residual) const
  {
    const double *seconds = rows + 2 * Scheme::SECOND_WIDTH + Scheme::ANGULAR_MOMENTUM;
    const double half_h2 = 0.5 * h * h;
    for (int i = 0; i < 3; ++i) residual[i] = half_h2 * torque_space[i] - seconds[i];
  }

  /// h L after the passes so far.
  void momentum_of_pass(const double *rows, const double *total, double *momentum) const
  {
    const double *rates = rows + Scheme::SECOND_WIDTH + Scheme::ANGULAR_MOMENTUM;
    for (int i = 0; i < 3; ++i) momentum[i] = rates[i] + corrector.c[1] * total[i];
  }

  /// Corrects the rows with these residuals.  axes: predicted.
  Correction correct_momenta(const RigidBody &body, const Load &load, const double *axes,
                             const Residual &total, double *rows) const
  {
    return scheme.compensate ? correct_momenta(Momenta<2>(), body, load, axes, total, rows)
                             : correct_momenta(Momenta<0>(), body, load, axes, total, rows);
  }
  template <int CARRIES>
  Correction correct_momenta(Momenta<CARRIES> history, const RigidBody &body, const Load &load,
                             const double *axes, const Residual &total, double *rows) const
  {
    double angle[3], change[4], torque_body[3];
    const double error2 = small_rotation(body, axes, rows, total.q, angle);
    history.template correct<3>(rows, n, corrector.c.data(), Scheme::POSITION, total.x);
    history.template correct<3, 1>(rows, n, corrector.c.data(), Scheme::ANGULAR_MOMENTUM, total.q);
    small_turn(rows + Scheme::SECOND_QUATERNION, angle, change);
    history.template add<4>(rows, n, 0, Scheme::SECOND_QUATERNION, change);
    to_body(axes, load.torque_space, torque_body);
    return {corrector.c[0] * dot3(load.force, total.x) + dot3(torque_body, angle),
            corrector.weight2 * dot3(total.x, total.x), 0.25 * corrector.weight2 * error2};
  }

  template <int CARRIES, class Damper>
  void pass(Momenta<CARRIES>, const RigidBody &body, const Load &load, const Damper &friction,
            double *rows, Pending &pending, int) const
  {
    const double *rates = rows + Scheme::SECOND_WIDTH;
    double damped[3], momentum[3];
    pass_of_center(body, load, friction, rows, pending.total.x);
    if (friction.implicit)
      copy(rates + Scheme::ANGULAR_MOMENTUM, 3, momentum);
    else
      momentum_of_pass(rows, pending.total.q, momentum);
    for (int i = 0; i < 3; ++i)
      damped[i] = friction.torque(load.torque_space[i], per_h * momentum[i]);
    momentum_residual(damped, rows, pending.total.q);
    if (!friction.implicit) return;
    const double part = friction.implicit_torque(0.5 * h * corrector.c[1]);
    for (int i = 0; i < 3; ++i) pending.total.q[i] *= part;
  }

  /// Positions (Eq. 17): forces are constant, so one pass is sufficient.
  void position_residual(const RigidBody &body, const Load &load, const double *rows,
                         double *residual) const
  {
    const double *seconds = rows + 2 * Scheme::SECOND_WIDTH + Scheme::POSITION;
    const double half_h2_per_mass = 0.5 * h * h / body.mass;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) residual[i] = half_h2_per_mass * load.force[i] - seconds[i];
  }

  template <int CARRIES>
  void correct_center(Second<CARRIES> history, const RigidBody &body, const Load &load, Undamped,
                      double *rows, double *residual) const
  {
    position_residual(body, load, rows, residual);
    history.template correct<3>(rows, n, corrector.c.data(), Scheme::POSITION, residual);
  }

  /// The residual of the quaternion after another pass (Eqs. 6, 7, 18).  total: earlier.  With c_2
  /// = 1 the residuals of all passes add up to target - prediction, so the history is corrected
  /// once.
  template <class Damper>
  void rotation_residual(const RigidBody &body, const double *torque_body, const Damper &damper,
                         const double *rows, double *total) const
  {
    const double *seconds = rows + 2 * Scheme::SECOND_WIDTH + Scheme::SECOND_QUATERNION;
    const double half_h2 = 0.5 * h * h;
    double omega_body[3], torque[3], omegadot_body[3], q[4], qdot[4], target[4];
    rotation_of_pass(rows, total, q, qdot);
    angular_velocity(q, scheme.norm2(q), qdot, omega_body);
    for (int i = 0; i < 3; ++i)
      torque[i] = damper.torque(torque_body[i], body.inertia[i] * omega_body[i]);
    angular_acceleration(body, torque, omega_body, omegadot_body);
    quaternion_acceleration(q, qdot, omegadot_body, target);
    for (int i = 0; i < 4; ++i) total[i] = half_h2 * target[i] - seconds[i];
  }

  void rotation_of_pass(const double *rows, const double *total, double *q, double *qdot) const
  {
    const double *place = rows + Scheme::SECOND_QUATERNION, *rates = place + Scheme::SECOND_WIDTH;
    for (int i = 0; i < 4; ++i) {
      q[i] = place[i] + corrector.c[0] * total[i];
      qdot[i] = (rates[i] + corrector.c[1] * total[i]) * per_h;
    }
  }
  void velocity_of_pass(const double *rows, const double *total, double *velocity) const
  {
    const double *rates = rows + Scheme::SECOND_WIDTH + Scheme::POSITION;
    for (int i = 0; i < 3; ++i) velocity[i] = (rates[i] + corrector.c[1] * total[i]) * per_h;
  }

  /// The residual of positions with a friction.
  template <class Damper>
  void pass_of_center(const RigidBody &body, const Load &load, const Damper &friction,
                      const double *rows, double *total) const
  {
    const double *rates = rows + Scheme::SECOND_WIDTH + Scheme::POSITION;
    double velocity[3], momentum[3];
    Load damped;
    if (friction.implicit)
      for (int i = 0; i < 3; ++i) velocity[i] = per_h * rates[i];
    else
      velocity_of_pass(rows, total, velocity);
    for (int i = 0; i < 3; ++i) momentum[i] = body.mass * velocity[i];
    for (int i = 0; i < 3; ++i)
      damped.force[i] = friction.force(i, load.force[i], momentum, body.mass);
    position_residual(body, damped, rows, total);
    if (friction.implicit) friction.solve(0.5 * h * corrector.c[1], total);
  }

  /// Computes only residuals: rows stay predicted until finish_passes().
  template <int CARRIES, class Damper>
  void pass(Second<CARRIES>, const RigidBody &body, const Load &load, const Damper &friction,
            double *rows, Pending &pending, int) const
  {
    double before[4], *total = pending.total.q;
    pass_of_center(body, load, friction, rows, pending.total.x);
    copy(total, 4, before);
    rotation_residual(body, pending.torque_body, friction, rows, total);
    if (friction.implicit)
      withhold(body, rows, before, 1.0 - friction.implicit_torque(0.5 * h * corrector.c[1]), total);
  }

  /// Reduces the change of a residual to account for friction.  The radial part, which conserves
  /// |q|, and a rotation about an axis without inertia have no friction.
  void withhold(const RigidBody &body, const double *rows, const double *before, double part,
                double *total) const
  {
    const double *q = rows + Scheme::SECOND_QUATERNION;
    double change[4], turn[3], back[4];
    for (int i = 0; i < 4; ++i) change[i] = total[i] - before[i];
    angular_velocity(q, dot4(q, q), change, turn);
    for (int i = 0; i < 3; ++i) turn[i] *= body.inertia[i] > 0.0 ? part : 0.0;
    quaternion_rate(q, turn, back);
    for (int i = 0; i < 4; ++i) total[i] -= back[i];
  }

  template <int CARRIES>
  void finish_passes(Second<CARRIES> history, double *rows, const Pending &pending) const
  {
    double residual[Scheme::SECOND_WIDTH];
    copy(pending.total.x, 3, residual + Scheme::POSITION);
    copy(pending.total.q, 4, residual + Scheme::SECOND_QUATERNION);
    history.template correct<Scheme::SECOND_WIDTH>(rows, n, corrector.c.data(), 0, residual);
    if (scheme.project) project(history, rows);
  }

  /// A rescaled q with a nonzero radial rate would damp the rotation, so the rate is projected too
  /// (Eq. 4).
  template <int CARRIES> void project(Second<CARRIES> history, double *rows) const
  {
    const double *q = rows + Scheme::SECOND_QUATERNION, *rates = q + Scheme::SECOND_WIDTH;
    double change[4];
    project_row(history, rows);
    const double radial = -dot4(q, rates);
    for (int i = 0; i < 4; ++i) change[i] = radial * q[i];
    history.template add<4>(rows, n, 1, Scheme::SECOND_QUATERNION, change);
  }

  /// 1/|q| - 1.
  static double missing_length(const double *q)
  {
    const double norm2 = dot4(q, q), part = 1.0 - norm2;
    if (std::fabs(part) < 1.0e-4) return part * (0.5 + part * (0.375 + part * 0.3125));
    const double norm = std::sqrt(norm2);
    return part / (norm * (1.0 + norm));
  }

  /// |q| = 1 (Eq. 3), as an increment, so that a compensated row keeps its digits.
  template <class History> void project_row(History history, double *rows) const
  {
    const double *q = rows + scheme.quaternion(), missing = missing_length(q);
    double change[4];
    for (int i = 0; i < 4; ++i) change[i] = missing * q[i];
    history.template add<4>(rows, n, 0, scheme.quaternion(), change);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
