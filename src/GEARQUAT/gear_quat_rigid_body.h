/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Mass properties and Euler's equations of one rigid body.  Frames: see gear_quat_quaternion.h.

   Components of the total force and torque, along the axes of space, may be masked: what does not
   act is taken by something outside of the body, which does no work on it where it stands still.
   The load that was met stays what it is for energy and virial, the load that acts moves the body.

   Sites of finite size have moments of inertia about their own center, in their own frame: `own` in
   a name stands for the frame of the site. */

#ifndef GEAR_QUAT_RIGID_BODY_H
#define GEAR_QUAT_RIGID_BODY_H

#include "gear_quat_quaternion.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace LAMMPS_NS::GearQuat {

/// A moment of inertia below this fraction of the largest counts as zero, as fix rigid counts it.
constexpr double LINEAR_FRACTION = 1.0e-7;

/// Mass and principal moments.  A zero moment has no rotational degree of freedom.
struct RigidBody {
  double mass;
  double inertia[3];

  int rotational_freedoms() const
  {
    return (inertia[0] > 0.0) + (inertia[1] > 0.0) + (inertia[2] > 0.0);
  }
  /// With those of translation; in two dimensions the body turns about z alone.
  int freedoms(int dimension) const
  {
    return dimension == 2 ? 2 + (inertia[2] > 0.0) : 3 + rotational_freedoms();
  }
};

/// Where a body is and how it moves: the 13 numbers that place and move its sites.
struct BodyState {
  double center[3];        ///< center of mass, unwrapped
  double q[4];             ///< orientation, scalar part last
  double velocity[3];      ///< of the center of mass
  double omega_body[3];    ///< angular velocity along the principal axes
};

/// What placing a site needs, derived from a state.
struct BodyFrame {
  double axes[9];    ///< rotation matrix space -> body
  double omega_space[3];
};

/// Total force and torque about the center of mass, in mass * length / time^2 (* length).
struct Load {
  double force[3];
  double torque_space[3];
};

/// What the corrector tells of a step.
struct Correction {
  double work;    ///< of the load along the way from the predicted to the corrected pose
  double position_error2, quaternion_error2;    ///< squared estimates of the local errors

  /// Estimated local error of the center of mass, length.
  double position_error() const { return std::sqrt(position_error2); }
  /// Estimated local error of the orientation, radians.
  double angle_error() const { return 2.0 * std::sqrt(quaternion_error2); }
};

/// omegadot_body, Eq. 7.  An axis without inertia has no angular acceleration.
inline void angular_acceleration(const RigidBody &body, const double *torque_body,
                                 const double *omega_body, double *omegadot_body)
{
  const double *inertia = body.inertia;
  const auto about = [&](int i, int j, int k) {    // indices the compiler knows
    const double gyroscopic = (inertia[j] - inertia[k]) * omega_body[j] * omega_body[k];
    return inertia[i] > 0.0 ? (torque_body[i] + gyroscopic) / inertia[i] : 0.0;
  };
  omegadot_body[0] = about(0, 1, 2);
  omegadot_body[1] = about(1, 2, 0);
  omegadot_body[2] = about(2, 0, 1);
}

/// 1/I, 0 for an axis without inertia.
inline void inverse_moments(const RigidBody &body, double *per_inertia)
{
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) per_inertia[i] = body.inertia[i] > 0.0 ? 1.0 / body.inertia[i] : 0.0;
}

/// Eq. 7 for many torques and angular velocities: no division that waits for them.
inline void angular_acceleration(const RigidBody &body, const double *per_inertia,
                                 const double *torque_body, const double *omega_body,
                                 double *omegadot_body)
{
  const double *inertia = body.inertia;
  const auto about = [&](int i, int j, int k) {
    const double gyroscopic = (inertia[j] - inertia[k]) * omega_body[j] * omega_body[k];
    return (torque_body[i] + gyroscopic) * per_inertia[i];
  };
  omegadot_body[0] = about(0, 1, 2);
  omegadot_body[1] = about(1, 2, 0);
  omegadot_body[2] = about(2, 0, 1);
}

/// The torque along the principal axes, Eq. 10.  norm2: see rotation_matrix().
inline void torque_along_axes(const double *q, double norm2, const Load &load, double *torque_body)
{
  double a[9];
  rotation_matrix(q, norm2, a);
  to_body(a, load.torque_space, torque_body);
}

/// The same acceleration of a body in a state under a load.
inline void angular_acceleration(const RigidBody &body, const BodyState &state, double norm2,
                                 const Load &load, double *omegadot_body)
{
  double torque_body[3];
  torque_along_axes(state.q, norm2, load, torque_body);
  angular_acceleration(body, torque_body, state.omega_body, omegadot_body);
}

/// A bit for each component that is off; 0: everything acts.
using Mask = int;

constexpr Mask force_off(int component)
{
  return 1 << component;
}

constexpr Mask torque_off(int component)
{
  return 1 << (3 + component);
}

/// What is left of a load.
inline Load acting_load(const Load &met, Mask off)
{
  Load acting = met;
  for (int k = 0; k < 3; ++k) {
    if (off & force_off(k)) acting.force[k] = 0.0;
    if (off & torque_off(k)) acting.torque_space[k] = 0.0;
  }
  return acting;
}

/// Work of a load met at the pose `before` along the small way to the pose `after`.
inline double work_between(const Load &met, const BodyState &before, const BodyState &after)
{
  double torque_body[3], dx[3], dq[4], angle_body[3];
  const double norm2 = dot4(before.q, before.q);
  for (int i = 0; i < 3; ++i) dx[i] = after.center[i] - before.center[i];
  for (int i = 0; i < 4; ++i) dq[i] = after.q[i] - before.q[i];
  angular_velocity(before.q, norm2, dq, angle_body);
  torque_along_axes(before.q, norm2, met, torque_body);
  return dot3(met.force, dx) + dot3(torque_body, angle_body);
}

inline double translational_energy(const RigidBody &body, const double *velocity)
{
  return 0.5 * body.mass * dot3(velocity, velocity);
}

inline double rotational_energy(const RigidBody &body, const double *omega_body)
{
  double twice = 0.0;
  for (int i = 0; i < 3; ++i) twice += body.inertia[i] * omega_body[i] * omega_body[i];
  return 0.5 * twice;
}

/// Principal moments and axes of a symmetric tensor (row-major) by cyclic Jacobi rotations.
/// After the call the rows of `a` are the axes, a rotation matrix space -> body: every Jacobi
/// rotation is proper, so the axes are right-handed.
/// Axes are not sorted: an axis that is principal already stays exactly as it is.
inline void principal_axes(const double tensor[9], double moments[3], double a[9])
{
  double m[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 9; ++i) m[i / 3][i % 3] = tensor[i];

  for (int sweep = 0; sweep < 50; ++sweep) {
    const double off = std::fabs(m[0][1]) + std::fabs(m[0][2]) + std::fabs(m[1][2]);
    if (off == 0.0) break;
    for (int p = 0; p < 2; ++p)
      for (int r = p + 1; r < 3; ++r) {
        if (m[p][r] == 0.0) continue;
        const double ratio = (m[r][r] - m[p][p]) / (2.0 * m[p][r]);
        const double t = std::copysign(1.0, ratio) / (std::fabs(ratio) + std::hypot(ratio, 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
        const double shift = t * m[p][r];
        const int o = 3 - p - r;
        m[p][p] -= shift;
        m[r][r] += shift;
        m[p][r] = m[r][p] = 0.0;
        const double mop = m[o][p], mor = m[o][r];
        m[o][p] = m[p][o] = c * mop - s * mor;
        m[o][r] = m[r][o] = s * mop + c * mor;
        for (int i = 0; i < 3; ++i) {
          const double vp = v[i][p], vr = v[i][r];
          v[i][p] = c * vp - s * vr;
          v[i][r] = s * vp + c * vr;
        }
      }
  }

  for (int k = 0; k < 3; ++k) {
    moments[k] = m[k][k];
    for (int i = 0; i < 3; ++i) a[3 * k + i] = v[i][k];
  }
}

/// Largest moment first; the rows of `a` go with their moments and stay right-handed.
inline void sort_axes(double moments[3], double a[9])
{
  auto swap = [&](int k, int l) {
    std::swap(moments[k], moments[l]);
    for (int i = 0; i < 3; ++i) {
      const double row = a[3 * k + i];
      a[3 * k + i] = a[3 * l + i];
      a[3 * l + i] = -row;
    }
  };
  for (int k = 0; k < 2; ++k)
    for (int l = 0; l < 2 - k; ++l)
      if (moments[l] < moments[l + 1]) swap(l, l + 1);
}

/// Moments that are zero but for rounding become exactly zero: a linear body has two rotational
/// degrees of freedom, a point none.
inline void drop_vanishing_moments(double moments[3])
{
  const double largest = std::max({moments[0], moments[1], moments[2]});
  for (int i = 0; i < 3; ++i)
    if (moments[i] < LINEAR_FRACTION * largest || moments[i] <= 0.0) moments[i] = 0.0;
}

// sites of finite size

/// A solid sphere.
inline void sphere_moments(double mass, double radius, double moments[3])
{
  for (int i = 0; i < 3; ++i) moments[i] = 0.4 * mass * radius * radius;
}

/// A solid ellipsoid with these semi-axes.
inline void ellipsoid_moments(double mass, const double semi_axes[3], double moments[3])
{
  for (int i = 0; i < 3; ++i) {
    const double b = semi_axes[(i + 1) % 3], c = semi_axes[(i + 2) % 3];
    moments[i] = 0.2 * mass * (b * b + c * c);
  }
}

/// A thin rod along its own x axis.
inline void line_moments(double mass, double length, double moments[3])
{
  moments[0] = 0.0;
  moments[1] = moments[2] = mass * length * length / 12.0;
}

/// A thin triangle with these corners about its center, along axes that are principal.
inline void triangle_moments(double mass, const double *c1, const double *c2, const double *c3,
                             double moments[3])
{
  double second[3];
  for (int k = 0; k < 3; ++k)
    second[k] = mass / 12.0 * (c1[k] * c1[k] + c2[k] * c2[k] + c3[k] * c3[k]);
  for (int k = 0; k < 3; ++k) moments[k] = second[(k + 1) % 3] + second[(k + 2) % 3];
}

/// Adds the tensor with these moments along the rows of `a`, a rotation matrix space -> own.
inline void add_tensor(const double moments[3], const double a[9], double tensor[9])
{
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 9; ++i) tensor[i] += moments[k] * a[3 * k + i / 3] * a[3 * k + i % 3];
}

/// momentum_space = A^T I A omega_space of a site whose own frame is `a`.
inline void own_angular_momentum(const double moments[3], const double a[9],
                                 const double *omega_space, double *momentum_space)
{
  double own[3];
  to_body(a, omega_space, own);
  for (int k = 0; k < 3; ++k) own[k] *= moments[k];
  to_space(a, own, momentum_space);
}

/// Orientation of a site in its body: q_own = q_body * relative.  Both are unit quaternions.
inline void relative_orientation(const double *q_body, const double *q_own, double *relative)
{
  const double inverse[4] = {-q_body[0], -q_body[1], -q_body[2], q_body[3]};
  w_times(inverse, q_own, relative);
  project_norm(relative);
}

/// q_own = q_body * relative, of unit length whatever that of q_body.
inline void site_orientation(const double *q_body, const double *relative, double *q_own)
{
  w_times(q_body, relative, q_own);
  project_norm(q_own);
}

/// A turn about the z axis, and back; the angle is in (-pi, pi].
inline void quaternion_about_z(double angle, double *q)
{
  q[0] = q[1] = 0.0;
  q[2] = std::sin(0.5 * angle);
  q[3] = std::cos(0.5 * angle);
}

inline double angle_about_z(const double *q)
{
  return q[3] < 0.0 ? 2.0 * std::atan2(-q[2], -q[3]) : 2.0 * std::atan2(q[2], q[3]);
}

}    // namespace LAMMPS_NS::GearQuat

#endif
