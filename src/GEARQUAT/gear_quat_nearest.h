/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The rigid motion of a body that is nearest to given displacements of its n sites, with equal
   weights (doc/theory.md, Energy minimization): for small motions a linear problem, for large
   motions the orthogonal Procrustes problem.  Fixed components do not move. */

#ifndef LMP_GEAR_QUAT_NEAREST_H
#define LMP_GEAR_QUAT_NEAREST_H

#include "gear_quat_math.h"

namespace LAMMPS_NS::GearQuat {

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
  Arms in_space(const double *axes) const;
};

/// A small rigid motion: site i moves by way + turn x arm_i.
struct Twist {
  double way[3];     ///< of the center of mass
  double turn[3];    ///< in radians, in space
};

/// A rotation about an axis moves no site if the sum of squared distances from the axis is less
/// than this part of the sum of squared distances from the center of mass: the axis of a linear
/// body.
constexpr double NO_ARM = 1.0e-12;

/// The twist nearest to vectors v_i on the sites.  sums: of v_i and of arm_i x v_i, as force and
/// torque.  idle: if not null, receives the rotations that move no site; they are zero.
Twist nearest_twist(const Arms &arms, Mask off, const Load &sums, Mask *idle = nullptr);

/// A rigid motion of any size.
struct Move {
  double way[3];         ///< of the center of mass
  double rotation[4];    ///< in space: q becomes rotation * q
};

/// The unit quaternion of a rotation by a vector, in radians.
void quaternion_of_turn(const double *turn, double *q);

/// The move nearest to the displacements u_i of the sites.  Uses the Gauss-Newton method from the present pose, which is near the
/// solution.
Move nearest_move(const Arms &arms, Mask off, const Displacements &sums);

}    // namespace LAMMPS_NS::GearQuat

#endif
