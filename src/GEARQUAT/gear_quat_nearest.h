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

#include <algorithm>
#include <cmath>

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

/// A rotation about an axis moves no site if the sum of squared distances from the axis is less
/// than this part of the sum of squared distances from the center of mass: the axis of a linear
/// body.
constexpr double NO_ARM = 1.0e-12;

/// Solves m x = b for positive semidefinite m by Cholesky's method with pivots.  Components that
/// are held, and components that the others determine up to NO_ARM of their scale, are 0.
inline void solve_free(const double m[6][6], const double b[6], const double scale[6],
                       const bool held[6], double x[6])
{
  int order[6], rank = 0;
  bool free[6] = {};
  double l[6][6] = {}, rest[6], y[6];
  for (int n = 0; n < 6; ++n) x[n] = 0.0, rest[n] = m[n][n];
  for (; rank < 6; ++rank) {
    int best = -1;
    double largest = NO_ARM;
    for (int n = 0; n < 6; ++n)
      if (!free[n] && !held[n] && rest[n] > largest * scale[n]) {
        largest = rest[n] / scale[n];
        best = n;
      }
    if (best < 0) break;
    free[best] = true;
    order[rank] = best;
    l[best][rank] = std::sqrt(rest[best]);
    for (int n = 0; n < 6; ++n) {
      if (free[n]) continue;
      double sum = m[n][best];
      for (int k = 0; k < rank; ++k) sum -= l[n][k] * l[best][k];
      l[n][rank] = sum / l[best][rank];
      rest[n] -= l[n][rank] * l[n][rank];
    }
  }
  for (int k = 0; k < rank; ++k) {
    y[k] = b[order[k]];
    for (int j = 0; j < k; ++j) y[k] -= l[order[k]][j] * y[j];
    y[k] /= l[order[k]][k];
  }
  for (int k = rank - 1; k >= 0; --k) {
    for (int j = k + 1; j < rank; ++j) y[k] -= l[order[j]][k] * x[order[j]];
    x[order[k]] = y[k] / l[order[k]][k];
  }
}

/// The twist nearest to vectors v_i on the sites.  sums: of v_i and of arm_i x v_i, as force and
/// torque.  Rotations that move no site are zero.
inline Twist nearest_twist(const Arms &arms, Mask off, const Load &sums)
{
  const double *p = arms.sums.products, *s = arms.sums.arm, trace = p[0] + p[4] + p[8];
  const double cross[3][3] = {{0.0, -s[2], s[1]}, {s[2], 0.0, -s[0]}, {-s[1], s[0], 0.0}};
  double m[6][6] = {}, b[6], scale[6], x[6];
  bool held[6];
  for (int a = 0; a < 3; ++a) {
    m[a][a] = scale[a] = arms.number;
    scale[3 + a] = trace;
    for (int c = 0; c < 3; ++c) {
      m[3 + a][3 + c] = (a == c ? trace : 0.0) - p[3 * a + c];
      m[3 + a][c] = m[c][3 + a] = cross[a][c];
    }
    b[a] = sums.force[a];
    b[3 + a] = sums.torque_space[a];
    held[a] = off & force_off(a);
    held[3 + a] = off & torque_off(a);
  }
  solve_free(m, b, scale, held, x);
  return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
}

/// A rigid motion of any size.
struct Move {
  double way[3];         ///< of the center of mass
  double rotation[4];    ///< in space: q becomes rotation * q
};

/// The unit quaternion of a rotation by a vector, in radians.
inline void quaternion_of_turn(const double *turn, double *q)
{
  const double angle = length(turn);
  const double part = angle > 0.0 ? std::sin(0.5 * angle) / angle : 0.5;
  for (int k = 0; k < 3; ++k) q[k] = part * turn[k];
  q[3] = std::cos(0.5 * angle);
}

/// The move nearest to the displacements u_i of the sites, by the Gauss-Newton method from the
/// present pose, which is near the solution.
inline Move nearest_move(const Arms &arms, Mask off, const Displacements &sums)
{
  constexpr int ROUNDS = 50;
  Move move = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 1.0}};
  const double *p = arms.sums.products, reach2 = (p[0] + p[4] + p[8]) / arms.number;
  double last = HUGE_VAL;
  double there[9];    // sum of (d_i + u_i)_a (d_i)_b
  for (int n = 0; n < 9; ++n) there[n] = p[n] + sums.products[n];
  for (int round = 0; round < ROUNDS; ++round) {
    double a[9];
    rotation_matrix(move.rotation, dot4(move.rotation, move.rotation), a);    // its transpose turns
    const Arms turned = arms.in_space(a);
    double k[9] = {};    // sum of (turned d_i)_a (d_i + u_i)_b
    for (int n = 0; n < 9; ++n)
      for (int i = 0; i < 3; ++i) k[n] += a[3 * i + n / 3] * there[3 * (n % 3) + i];
    Load rest = {{}, {k[5] - k[7], k[6] - k[2], k[1] - k[3]}};
    double shift[3];
    cross3(turned.sums.arm, move.way, shift);
    for (int n = 0; n < 3; ++n) {
      rest.force[n] =
          sums.way[n] + arms.sums.arm[n] - turned.sums.arm[n] - arms.number * move.way[n];
      rest.torque_space[n] -= shift[n];
    }
    const Twist twist = nearest_twist(turned, off, rest);
    double turn[4], q[4];
    quaternion_of_turn(twist.turn, turn);
    w_times(turn, move.rotation, q);
    std::copy_n(q, 4, move.rotation);
    project_norm(move.rotation);
    add3(twist.way, move.way);
    const double size = dot3(twist.way, twist.way) + reach2 * dot3(twist.turn, twist.turn);
    if (!(size < 0.25 * last)) break;    // only rounding is left
    last = size;
  }
  return move;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
