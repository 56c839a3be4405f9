/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* One step of one body.

     predict            evaluate (host)                   correct
     rows -> t + h  ->  sites at body_state(), forces  ->  rows at t + h

   Momentum formulation, 6 components and the quaternion (gear_quat_momentum.h):
     x'' = F/m,  L' = torque along the axes of space

   First-order formulation (Evans), 13 components:
     x' = p/m,  p' = F,  q' = 1/2 W(q) omega,  omega' from Euler's equations
   Second-order formulation (Rapaport), 7 components:
     x'' = F/m,  q'' = 1/2 W(q) (omega', -2 q'.q')

   Equation numbers: Pratt & Bin Mohamad Zaini.  Once per step the host calls predict(),
   find_states(), [forces] and correct(), or for a body without moments of inertia the functions
   whose names end in center. */

#ifndef GEAR_QUAT_INTEGRATOR_H
#define GEAR_QUAT_INTEGRATOR_H

#include "gear_quat_coefficients.h"
#include "gear_quat_gauss.h"
#include "gear_quat_history.h"
#include "gear_quat_momentum.h"
#include "gear_quat_turn.h"

namespace LAMMPS_NS::GearQuat {

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
  /// Other formulations: the velocities after a correction with this friction, and share() is 0.
  void find_velocities(const Block &block, const Friction &friction, Velocities &found) const;
  double share() const { return scheme.momentum() ? momentum_step().share() : 0.0; }
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
    Pending pending = begin(load, axes_of(rows).data(), rows);
    for (int k = 0; k < scheme.passes; ++k) correct_pass(body, load, friction, rows, pending, k);
    return finish(load, rows, pending);
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

  /// Torque and moments of inertia are not used.
  Correction correct_center(const RigidBody &body, const Load &load, double *rows,
                            const Friction &friction = Friction()) const
  {
    double x[3], residual[3] = {0.0, 0.0, 0.0}, dx[3];
    copy(rows + Scheme::POSITION, 3, x);
    with_history([&](auto history) {
      correct_center(history, body, load, friction, rows, residual);
    });
    for (int i = 0; i < 3; ++i) dx[i] = rows[i] - x[i];
    return {dot3(load.force, dx), corrector.weight2 * dot3(residual, residual), 0.0};
  }

 private:
  struct Residual {    ///< summed over the passes
    double all[7] = {};
    double *x() { return all; }
    double *q() { return all + 3; }
    const double *x() const { return all; }
    const double *q() const { return all + 3; }
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

  // formulations first and second; earlier: passes before

  void correct_pass(const RigidBody &body, const Load &load, const Friction &friction, double *rows,
                    Pending &pending, int earlier) const
  {
    with_history([&](auto history) {
      pass(history, body, load, friction, rows, pending, earlier);
    });
  }

  /// Projects |q| = 1 and, in the second-order form, q.qdot = 0.
  Correction finish(const Load &load, double *rows, const Pending &pending) const
  {
    with_history([&](auto history) {
      finish_passes(history, rows, pending);
    });
    return conclude(load, rows, pending);
  }

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
  template <int CARRIES>
  void correct_center(First<CARRIES> history, const RigidBody &body, const Load &load,
                      const Friction &friction, double *rows, double *residual) const
  {
    const double *rates = rows + scheme.width(), *momentum = rows + Scheme::MOMENTUM;
    double before[3], damped[3], target[3];
    copy(momentum, 3, before);
    friction.add_to(load.force, before, body.mass, damped);
    for (int i = 0; i < 3; ++i) target[i] = h * damped[i] - rates[Scheme::MOMENTUM + i];
    if (friction.implicit) friction.solve(h * corrector.c[0], target);
    feed_back<3>(history, rows, Scheme::MOMENTUM, target);
    const double *p = scheme.predicted_momentum ? before : momentum;
    for (int i = 0; i < 3; ++i) target[i] = h * p[i] / body.mass - rates[Scheme::POSITION + i];
    feed_back<3>(history, rows, Scheme::POSITION, target, residual);
  }

  /// Angular velocities (Eqs. 7, 15) and quaternions (Eqs. 5, 16).
  template <int CARRIES>
  void correct_rotation(First<CARRIES> history, const RigidBody &body, const double *torque_body,
                        const Friction &damper, double *rows, double *residual) const
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

  template <int CARRIES>
  void pass(First<CARRIES> history, const RigidBody &body, const Load &load,
            const Friction &friction, double *rows, Pending &pending, int earlier) const
  {
    if (earlier == 0)    // with constant forces once is sufficient
      correct_center(history, body, load, friction, rows, pending.total.x());
    correct_rotation(history, body, pending.torque_body, friction, rows, pending.total.q());
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
            corrector.weight2 * dot3(total.x(), total.x()),
            corrector.weight2 * dot4(total.q(), total.q())};
  }

  // the momentum formulation

  /// One body alone needs fewer operations with numbers of type double.
  bool side_by_side(const Block &block) const { return scheme.momentum() && block.count > 1; }
  MomentumStep momentum_step() const { return {corrector, h}; }

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
  void correct_center(Second<CARRIES> history, const RigidBody &body, const Load &load,
                      const Friction &friction, double *rows, double *residual) const
  {
    if (friction.acts())
      pass_of_center(body, load, friction, rows, residual);
    else
      position_residual(body, load, rows, residual);
    history.template correct<3>(rows, n, corrector.c.data(), Scheme::POSITION, residual);
  }

  /// The residual of the quaternion after another pass (Eqs. 6, 7, 18).  total: earlier.  With c_2
  /// = 1 the residuals of all passes add up to target - prediction, so the history is corrected
  /// once.
  void rotation_residual(const RigidBody &body, const double *torque_body, const Friction &damper,
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
  void pass_of_center(const RigidBody &body, const Load &load, const Friction &friction,
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
    friction.add_to(load.force, momentum, body.mass, damped.force);
    position_residual(body, damped, rows, total);
    if (friction.implicit) friction.solve(0.5 * h * corrector.c[1], total);
  }

  /// Computes only residuals: rows stay predicted until finish_passes().
  template <int CARRIES>
  void pass(Second<CARRIES>, const RigidBody &body, const Load &load, const Friction &friction,
            double *rows, Pending &pending, int) const
  {
    double before[4], *total = pending.total.q();
    pass_of_center(body, load, friction, rows, pending.total.x());
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
    history.template correct<Scheme::SECOND_WIDTH>(rows, n, corrector.c.data(), 0,
                                                   pending.total.all);
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
