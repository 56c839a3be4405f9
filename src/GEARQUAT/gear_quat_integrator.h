/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* One step of one body.

     predict            evaluate (host)                   correct
     rows -> t + h  ->  sites at body_state(), forces  ->  rows at t + h

   First-order formulation (Evans), 13 components, FIRST_VALUES rows:
     x' = p/m,  p' = F,  q' = 1/2 W(q) omega,  omega' from Euler's equations
   Second-order formulation (Rapaport), 7 components, SECOND_VALUES rows:
     x'' = F/m,  q'' = 1/2 W(q) (omega', -2 q'.q')
   Equation numbers: Pratt & Bin Mohamad Zaini.  The host calls, in this order and once a step:
   predict(), body_state(), [forces at that state], correct(). */

#ifndef GEAR_QUAT_INTEGRATOR_H
#define GEAR_QUAT_INTEGRATOR_H

#include "gear_quat_coefficients.h"
#include "gear_quat_nordsieck.h"
#include "gear_quat_rigid_body.h"

namespace GearQuat {

enum class Formulation { FIRST, SECOND };

constexpr int MAX_VALUES = SECOND_VALUES;    ///< rows of the longest history

/// What is the same for all bodies of a run.
struct Scheme {
  Formulation formulation = Formulation::SECOND;
  bool velocity_c0 = false;           ///< second: 3/16 (the paper's) instead of 3/20
  bool predicted_omega = false;       ///< first: omega that feeds Eq. 5
  bool predicted_momentum = false;    ///< first: momentum that feeds Eq. 13 (the paper's)
  bool project = true;                ///< keep |q| = 1 and q.qdot = 0

  bool first() const { return formulation == Formulation::FIRST; }
  int values() const { return first() ? FIRST_VALUES : SECOND_VALUES; }
  int width() const { return first() ? 13 : 7; }
  int size() const { return values() * width(); }

  // columns of a row

  static constexpr int POSITION = 0;
  static constexpr int MOMENTUM = 3;    ///< first only
  int quaternion() const { return first() ? 6 : 3; }
  static constexpr int OMEGA = 10;    ///< first only

  /// What q is divided by where a unit quaternion is meant: unprojected, the paper's formulas are
  /// taken as they stand, and a body is only as rigid as |q| = 1 holds.
  double norm2(const double *q) const { return project ? dot4(q, q) : 1.0; }
};

/// c_j of the scheme as doubles.
inline void corrector_coefficients(const Scheme &scheme, double c[MAX_VALUES])
{
  const Fraction *exact = scheme.first() ? FIRST_ORDER.data()
      : scheme.velocity_c0               ? SECOND_ORDER_VELOCITY.data()
                                         : SECOND_ORDER_POSITION.data();
  for (int j = 0; j < scheme.values(); ++j) c[j] = exact[j].value();
}

/// How far the corrector moved a body: what turns forces at the predicted pose into the energy of
/// the corrected one, -(F.dx + tau.dtheta).
struct Shift {
  double center[3];
  double angle_space[3];
};

class Integrator {
 public:
  /// h: the time step, not zero; negative runs backwards.
  Integrator(const Scheme &scheme, double h) : scheme(scheme), h(h)
  {
    corrector_coefficients(scheme, c);
  }

  void predict(double *rows) const { nordsieck_predict(rows, scheme.values(), scheme.width()); }

  /// Pose and velocities a history stands for, before or after the correction.
  BodyState body_state(const RigidBody &body, const double *rows) const
  {
    BodyState state;
    const double *rates = rows + scheme.width();
    const int quat = scheme.quaternion();
    copy(rows + Scheme::POSITION, 3, state.center);
    copy(rows + quat, 4, state.q);
    if (scheme.first()) {
      for (int i = 0; i < 3; ++i) state.velocity[i] = rows[Scheme::MOMENTUM + i] / body.mass;
      copy(rows + Scheme::OMEGA, 3, state.omega_body);
    } else {
      double qdot[4];
      for (int i = 0; i < 3; ++i) state.velocity[i] = rates[Scheme::POSITION + i] / h;
      for (int i = 0; i < 4; ++i) qdot[i] = rates[quat + i] / h;
      angular_velocity(state.q, scheme.norm2(state.q), qdot, state.omega_body);
    }
    return state;
  }

  /// Correct a predicted history with the load met at the predicted pose, then project.
  Shift correct(const RigidBody &body, const Load &load, double *rows) const
  {
    const int quat = scheme.quaternion();
    double x[3], q[4], a[9], torque_body[3];
    copy(rows + Scheme::POSITION, 3, x);
    copy(rows + quat, 4, q);
    rotation_matrix(q, scheme.norm2(q), a);
    to_body(a, load.torque_space, torque_body);

    if (scheme.first())
      correct_first(body, load, torque_body, rows);
    else
      correct_second(body, load, torque_body, rows);
    if (scheme.project) project(rows);
    return shift_from(x, q, rows);
  }

 private:
  Scheme scheme;
  double h;
  double c[MAX_VALUES];

  static void copy(const double *from, int n, double *to)
  {
    for (int i = 0; i < n; ++i) to[i] = from[i];
  }

  void feed_back(double *rows, int component, int count, const double *residual) const
  {
    nordsieck_correct(rows, scheme.values(), scheme.width(), c, component, count, residual);
  }

  void correct_first(const RigidBody &body, const Load &load, const double *torque_body,
                     double *rows) const
  {
    const int quat = scheme.quaternion();
    const double *rates = rows + scheme.width();
    double *momentum = rows + Scheme::MOMENTUM, *omega_body = rows + Scheme::OMEGA;
    double omegadot_body[3], predicted_p[3], predicted_omega[3], qdot[4], r[4];
    copy(momentum, 3, predicted_p);
    copy(omega_body, 3, predicted_omega);

    // momenta (Eq. 14) and angular velocities (Eqs. 7, 15)

    for (int i = 0; i < 3; ++i) r[i] = h * load.force[i] - rates[Scheme::MOMENTUM + i];
    feed_back(rows, Scheme::MOMENTUM, 3, r);

    angular_acceleration(body, torque_body, predicted_omega, omegadot_body);
    for (int i = 0; i < 3; ++i) r[i] = h * omegadot_body[i] - rates[Scheme::OMEGA + i];
    feed_back(rows, Scheme::OMEGA, 3, r);

    // positions (Eq. 13) and quaternions (Eqs. 5, 16)

    const double *p = scheme.predicted_momentum ? predicted_p : momentum;
    for (int i = 0; i < 3; ++i) r[i] = h * p[i] / body.mass - rates[Scheme::POSITION + i];
    feed_back(rows, Scheme::POSITION, 3, r);

    quaternion_rate(rows + quat, scheme.predicted_omega ? predicted_omega : omega_body, qdot);
    for (int i = 0; i < 4; ++i) r[i] = h * qdot[i] - rates[quat + i];
    feed_back(rows, quat, 4, r);
  }

  void correct_second(const RigidBody &body, const Load &load, const double *torque_body,
                      double *rows) const
  {
    const int quat = scheme.quaternion(), width = scheme.width();
    const double *rates = rows + width, *seconds = rows + 2 * width;
    double *q = rows + quat;
    double omega_body[3], omegadot_body[3], qdot[4], qddot[4], r[4];
    const double half_h2 = 0.5 * h * h;

    // positions (Eq. 17)

    for (int i = 0; i < 3; ++i) r[i] = half_h2 * load.force[i] / body.mass - seconds[i];
    feed_back(rows, Scheme::POSITION, 3, r);

    // quaternions (Eqs. 6, 7, 18)

    for (int i = 0; i < 4; ++i) qdot[i] = rates[quat + i] / h;
    angular_velocity(q, scheme.norm2(q), qdot, omega_body);
    angular_acceleration(body, torque_body, omega_body, omegadot_body);
    quaternion_acceleration(q, qdot, omegadot_body, qddot);
    for (int i = 0; i < 4; ++i) r[i] = half_h2 * qddot[i] - seconds[quat + i];
    feed_back(rows, quat, 4, r);
  }

  /// Eqs. 3 and 4.  A rescaled q with a radial rate left in would damp the spin, so the
  /// second-order form needs both; the first-order form has no independent rate of q.
  void project(double *rows) const
  {
    double *q = rows + scheme.quaternion();
    project_norm(q);
    if (!scheme.first()) project_rate(q, q + scheme.width());
  }

  Shift shift_from(const double *x, const double *q, const double *rows) const
  {
    const double *new_q = rows + scheme.quaternion();
    Shift shift;
    for (int i = 0; i < 3; ++i) shift.center[i] = rows[i] - x[i];

    // small rotation: 2 (dq conj(q)) in the body frame, turned into space

    double dq[4], angle_body[3], a[9];
    const double norm2 = dot4(q, q);
    for (int i = 0; i < 4; ++i) dq[i] = new_q[i] - q[i];
    angular_velocity(q, norm2, dq, angle_body);
    rotation_matrix(q, norm2, a);
    to_space(a, angle_body, shift.angle_space);
    return shift;
  }
};

}    // namespace GearQuat

#endif
