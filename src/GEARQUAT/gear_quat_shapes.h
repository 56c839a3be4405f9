/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Sites of finite size: moments of inertia about their own center, in their own frame, which is the
   frame of their principal axes, and their orientation in a body.  `own` in a name refers to this
   frame.  Moments in mass * length^2. */

#ifndef GEAR_QUAT_SHAPES_H
#define GEAR_QUAT_SHAPES_H

#include "gear_quat_math.h"

namespace LAMMPS_NS::GearQuat {

// LAMMPS' quaternions have the scalar first

inline void from_lammps(const double *wxyz, double *q)
{
  for (int k = 0; k < 4; ++k) q[k] = wxyz[(k + 1) % 4];
  project_norm(q);
}

inline void to_lammps(const double *q, double *wxyz)
{
  for (int k = 0; k < 4; ++k) wxyz[(k + 1) % 4] = q[k];
}

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

/// A thin triangle with these corners relative to its center, in any frame.
/// principal: unit quaternion of its own frame in the frame of the corners; the two are exactly the
/// same if the products of inertia are zero except for rounding.
inline void triangle_moments(double mass, const double *c1, const double *c2, const double *c3,
                             double moments[3], double principal[4])
{
  constexpr double ROUNDING = 1.0e-14;
  double second[9], tensor[9], a[9];    // without the mass: the own frame depends on corners only
  for (int i = 0; i < 9; ++i) {
    const int k = i / 3, l = i % 3;
    second[i] = (c1[k] * c1[l] + c2[k] * c2[l] + c3[k] * c3[l]) / 12.0;
  }
  const double trace = second[0] + second[4] + second[8];
  for (int i = 0; i < 9; ++i)
    tensor[i] = std::fabs(second[i]) <= ROUNDING * trace ? 0.0 : -second[i];
  for (int k = 0; k < 3; ++k) tensor[4 * k] = second[4 * ((k + 1) % 3)] + second[4 * ((k + 2) % 3)];
  principal_axes(tensor, moments, a);
  for (int k = 0; k < 3; ++k) moments[k] *= mass;
  quaternion_from_matrix(a, principal);
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

/// q_own = q_body * relative, of unit length for any length of q_body.
inline void site_orientation(const double *q_body, const double *relative, double *q_own)
{
  w_times(q_body, relative, q_own);
  project_norm(q_own);
}

}    // namespace LAMMPS_NS::GearQuat

#endif
