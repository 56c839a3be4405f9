/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Mass properties: principal axes and moments of bodies, and sites of finite size.

   Sites of finite size: moments of inertia about their own center, in their own frame, which is the
   frame of their principal axes, and their orientation in a body.  `own` in a name refers to this
   frame.  Moments in mass * length^2. */

#ifndef GEAR_QUAT_SHAPES_H
#define GEAR_QUAT_SHAPES_H

#include "gear_quat_math.h"

namespace LAMMPS_NS::GearQuat {

/// The unit quaternion of a rotation matrix A (space -> body, row-major), without small divisors.
void quaternion_from_matrix(const double a[9], double *q);

/// Principal moments and axes of a symmetric tensor (row-major) by cyclic Jacobi rotations.
/// After the call the rows of `a` are the axes, a right-handed rotation matrix space -> body.  Axes
/// are not sorted: an axis that is already principal does not change at all.
void principal_axes(const double tensor[9], double moments[3], double a[9]);

/// Largest moment first; the rows of `a` are sorted with their moments and stay right-handed.
void sort_axes(double moments[3], double a[9]);

/// Sets moments that are zero except for rounding to exactly zero: a linear body has two rotational
/// degrees of freedom, a point none.
void drop_vanishing_moments(double moments[3]);

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
void sphere_moments(double mass, double radius, double moments[3]);

/// A solid ellipsoid with these semi-axes.
void ellipsoid_moments(double mass, const double semi_axes[3], double moments[3]);

/// A thin rod along its own x axis.
void line_moments(double mass, double length, double moments[3]);

/// A thin triangle with these corners relative to its center, in any frame.
/// principal: unit quaternion of its own frame in the frame of the corners; the two are exactly the
/// same if the products of inertia are zero except for rounding.
void triangle_moments(double mass, const double *c1, const double *c2, const double *c3,
                      double moments[3], double principal[4]);

/// Adds the tensor with these moments along the rows of `a`, a rotation matrix space -> own.
void add_tensor(const double moments[3], const double a[9], double tensor[9]);

/// momentum_space = A^T I A omega_space of a site whose own frame is `a`.
void own_angular_momentum(const double moments[3], const double a[9], const double *omega_space,
                          double *momentum_space);

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
