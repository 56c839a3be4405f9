/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Sites of finite size: own moments of inertia about their center, in their own frame, and the
   orientation of that frame.  Quaternions and frames: see gear_quat_quaternion.h, with `own` for the
   frame of the site. */

#ifndef GEAR_QUAT_SHAPES_H
#define GEAR_QUAT_SHAPES_H

#include "gear_quat_quaternion.h"

namespace LAMMPS_NS::GearQuat {

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
