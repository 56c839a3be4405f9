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

#include "gear_quat_friction.h"
#include "gear_quat_history.h"
#include "gear_quat_momentum.h"

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

  Correction correct_by_passes(const RigidBody &body, const Load &load, const Friction &friction,
                               double *rows) const;

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
};

}    // namespace LAMMPS_NS::GearQuat

#endif
