/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Mass properties: principal axes and moments of bodies, and sites of finite size; the rigid motion
   nearest to motions of sites.

   Sites of finite size: moments of inertia about their own center, in their own frame, which is the
   frame of their principal axes, and their orientation in a body.  `own` in a name refers to this
   frame.  Moments in mass * length^2.

   The rigid motion of a body that is nearest to given displacements of its n sites, with equal
   weights (doc/theory.md, Energy minimization), is for small motions a linear problem, for large
   motions the orthogonal Procrustes problem.  Fixed components do not move. */

#ifndef GEAR_QUAT_SHAPES_H
#define GEAR_QUAT_SHAPES_H

#include "gear_quat_math.h"

namespace LAMMPS_NS::GearQuat {

/// The unit quaternion of a rotation matrix A (space -> body, row-major), without small divisors.
void quaternion_from_matrix(const double a[9], double *q);

/// out = A^T t A, a tensor (row-major) in space from its components in the body.
void tensor_to_space(const double a[9], const double *t, double *out);

/// The rotation about the z axis by an angle, and the inverse; the angle is in (-pi, pi].
void quaternion_about_z(double angle, double *q);
double angle_about_z(const double *q);

/// The unit quaternion of a rotation by a vector, in radians.
void quaternion_of_turn(const double *turn, double *q);

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

/* ---------------------------------------------------------------------- */

/// Sums over the arms d of the sites of a body, from its center of mass.
struct ArmSums {
  double arm[3];
  double products[9];    ///< d_a d_b, row-major, lengths squared
};

/// Sums over the displacements u of the sites of a body.
struct Displacements {
  double way[3];
  double products[9];    ///< u_a d_b, row-major
};

/// The arms of n sites, in space.
struct Arms {
  double number;    ///< of sites
  ArmSums sums;

  /// The sums in space for a body with these axes (space -> body), from sums along its axes.
  Arms in_space(const double *axes) const
  {
    Arms out = {number, {}};
    to_space(axes, sums.arm, out.sums.arm);
    tensor_to_space(axes, sums.products, out.sums.products);
    return out;
  }
};

/// A small rigid motion: site i moves by way + turn x arm_i.
struct Twist {
  double way[3];     ///< of the center of mass
  double turn[3];    ///< in radians, in space
};

/// The twist nearest to vectors v_i on the sites.  sums: of v_i and of arm_i x v_i, as force and
/// torque.  Rotations that move no site are zero.
Twist nearest_twist(const Arms &arms, Mask off, const Load &sums);

/// A rigid motion of any size.
struct Move {
  double way[3];         ///< of the center of mass
  double rotation[4];    ///< in space: q becomes rotation * q
};

/// The move nearest to the displacements u_i of the sites, by the Gauss-Newton method from the
/// present pose, which is near the solution.
Move nearest_move(const Arms &arms, Mask off, const Displacements &sums);

}    // namespace LAMMPS_NS::GearQuat

#endif
