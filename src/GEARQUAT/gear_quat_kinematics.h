/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What the rows of a history say of its body: pose and velocities, before or after a correction;
   and velocities into a history.  No evolution in time: that is gear_quat_integrator.h. */

#ifndef GEAR_QUAT_KINEMATICS_H
#define GEAR_QUAT_KINEMATICS_H

#include "gear_quat_nordsieck.h"
#include "gear_quat_rigid_body.h"

#include <algorithm>
#include <array>

namespace LAMMPS_NS::GearQuat {

class Kinematics {
 public:
  /// h: the time step, not zero.
  Kinematics(const Scheme &scheme, double h) : scheme(scheme), h(h), per_h(1.0 / h) {}

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

  /// The same with the frame of this state.
  void body_state(const RigidBody &body, const double *rows, BodyState &state,
                  BodyFrame &frame) const
  {
    if (scheme.first())
      find_state<Formulation::FIRST>(body, rows, state, frame);
    else
      find_state<Formulation::SECOND>(body, rows, state, frame);
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

  /// Velocities of the state into a history of the same pose, and with them the accelerations that
  /// depend on velocities: those of the rotation and, of formulation first, those of the load,
  /// which may be damped.  Other derivatives stay.  load: at this pose.
  ///
  /// The corrector sets these rows too, but for the second derivative of the quaternion in
  /// formulation first.  That changes by what the velocities change of it: to set it in every step
  /// would be another corrector, unstable with 8 values.
  void set_velocities(const RigidBody &body, const BodyState &state, const Load &load,
                      double *rows) const
  {
    const int width = scheme.width(), quat = scheme.quaternion(), row = scheme.first() ? 0 : 1;
    double *rates = rows + width, *qddot = rates + width + quat;
    double omegadot_body[3], qdot[4], now[4], kept[4] = {};
    angular_acceleration(body, state, scheme.norm2(state.q), load, omegadot_body);
    quaternion_rate(rows + quat, state.omega_body, qdot);
    quaternion_acceleration(rows + quat, qdot, omegadot_body, now);
    if (scheme.first()) {
      double scaled[3], before[4];    // times h, h^2
      for (int i = 0; i < 3; ++i) scaled[i] = h * rates[Scheme::OMEGA + i];
      quaternion_acceleration(rows + quat, rates + quat, scaled, before);
      for (int i = 0; i < 4; ++i) kept[i] = qddot[i] - 0.5 * before[i];
    }
    for (int i = 0; i < 3; ++i) rates[Scheme::POSITION + i] = h * state.velocity[i];
    for (int i = 0; i < 4; ++i) {
      rates[quat + i] = h * qdot[i];
      qddot[i] = kept[i] + 0.5 * h * h * now[i];
    }
    if (scheme.first()) {
      for (int i = 0; i < 3; ++i) {
        rows[Scheme::MOMENTUM + i] = body.mass * state.velocity[i];
        rates[Scheme::MOMENTUM + i] = h * load.force[i];
        rates[Scheme::OMEGA + i] = h * omegadot_body[i];
      }
      copy(state.omega_body, 3, rows + Scheme::OMEGA);
    }
    if (!scheme.compensate) return;
    double *carry = rows + (scheme.values() + row) * width;    // of the row that has the velocities
    std::fill(carry + (scheme.first() ? Scheme::MOMENTUM : 0),
              carry + (scheme.first() ? Scheme::MOMENTUM + 3 : width), 0.0);
    if (scheme.first()) std::fill_n(carry + Scheme::OMEGA, 3, 0.0);
  }

  /// d(|q|^2/2)/dt as the history has it; it should vanish.
  double radial_rate(const double *rows) const
  {
    const double *q = rows + scheme.quaternion();
    return dot4(q, q + scheme.width()) / h;
  }

  /// The rotation matrix A of the orientation in a history.
  std::array<double, 9> axes_of(const double *rows) const
  {
    std::array<double, 9> axes;
    const double *q = rows + scheme.quaternion();
    rotation_matrix(q, scheme.norm2(q), axes.data());
    return axes;
  }

 protected:
  Scheme scheme;
  double h, per_h;

  static void copy(const double *from, int n, double *to)
  {
#pragma GCC unroll 4
    for (int i = 0; i < n; ++i) to[i] = from[i];
  }

 private:
  /// All is read before any of it is written: for all the compiler knows, it is written to `rows`.
  template <Formulation FORM>
  void find_state(const RigidBody &body, const double *rows, BodyState &state,
                  BodyFrame &frame) const
  {
    constexpr bool FIRST = FORM == Formulation::FIRST;
    constexpr int QUATERNION = FIRST ? Scheme::FIRST_QUATERNION : Scheme::SECOND_QUATERNION;
    const double *rates = rows + (FIRST ? Scheme::FIRST_WIDTH : Scheme::SECOND_WIDTH);
    double center[3], q[4], velocity[3], omega_body[3];
    copy(rows + Scheme::POSITION, 3, center);
    copy(rows + QUATERNION, 4, q);
    const double norm2 = scheme.norm2(q);
    if (FIRST) {
      for (int i = 0; i < 3; ++i) velocity[i] = rows[Scheme::MOMENTUM + i] / body.mass;
      copy(rows + Scheme::OMEGA, 3, omega_body);
    } else {
      double qdot[4];
      for (int i = 0; i < 3; ++i) velocity[i] = rates[Scheme::POSITION + i] * per_h;
      for (int i = 0; i < 4; ++i) qdot[i] = rates[QUATERNION + i] * per_h;
      angular_velocity(q, norm2, qdot, omega_body);
    }
    copy(center, 3, state.center);
    copy(q, 4, state.q);
    copy(velocity, 3, state.velocity);
    copy(omega_body, 3, state.omega_body);
    rotation_matrix(q, norm2, frame.axes);
    to_space(frame.axes, omega_body, frame.omega_space);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
