/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Quaternion kinematics in the paper's convention.

   q = (q1, q2, q3, q4) with the scalar part LAST; LAMMPS' own order is scalar first.
   `space` and `body` in a name say in which frame components are given; the body frame is the frame
   of the principal axes.  q turns body components into space components: e_space = A^T(q) e_body.
   Equation numbers: Pratt & Bin Mohamad Zaini, with the misprints of Eqs. 5, 6 and 8 corrected
   (last row of W is (-q1, -q2, -q3, q4); A is the rotation matrix space -> body). */

#ifndef GEAR_QUAT_QUATERNION_H
#define GEAR_QUAT_QUATERNION_H

#include <cmath>

namespace LAMMPS_NS::GearQuat {

inline double dot3(const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline double dot4(const double *a, const double *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

inline double length(const double *a)
{
  return std::sqrt(dot3(a, a));
}

inline double distance2(const double *a, const double *b)
{
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return dot3(d, d);
}

inline void cross3(const double *a, const double *b, double *out)
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/// sum += a, with no loop: most LAMMPS are built with -O2, which leaves loops alone.
inline void add3(const double *a, double *sum)
{
  sum[0] += a[0];
  sum[1] += a[1];
  sum[2] += a[2];
}

/// out = W(q) a, the matrix of Eqs. 5 and 6; it is the quaternion product q a.
inline void w_times(const double *q, const double *a, double *out)
{
  out[0] = q[3] * a[0] - q[2] * a[1] + q[1] * a[2] + q[0] * a[3];
  out[1] = q[2] * a[0] + q[3] * a[1] - q[0] * a[2] + q[1] * a[3];
  out[2] = -q[1] * a[0] + q[0] * a[1] + q[3] * a[2] + q[2] * a[3];
  out[3] = -q[0] * a[0] - q[1] * a[1] - q[2] * a[2] + q[3] * a[3];
}

/// out = W(q)^T a, three components (the fourth is q.a): the vector part of conj(q) a.
inline void w_transposed_times(const double *q, const double *a, double *out)
{
  out[0] = q[3] * a[0] + q[2] * a[1] - q[1] * a[2] - q[0] * a[3];
  out[1] = -q[2] * a[0] + q[3] * a[1] + q[0] * a[2] - q[1] * a[3];
  out[2] = q[1] * a[0] - q[0] * a[1] + q[3] * a[2] - q[2] * a[3];
}

/// qdot = 1/2 W(q) (omega_body, 0), Eq. 5.
inline void quaternion_rate(const double *q, const double *omega_body, double *qdot)
{
  const double half[4] = {0.5 * omega_body[0], 0.5 * omega_body[1], 0.5 * omega_body[2], 0.0};
  w_times(q, half, qdot);
}

/// qddot = 1/2 W(q) (omegadot_body, -2 qdot.qdot), Eq. 6.
inline void quaternion_acceleration(const double *q, const double *qdot,
                                    const double *omegadot_body, double *qddot)
{
  const double half[4] = {0.5 * omegadot_body[0], 0.5 * omegadot_body[1], 0.5 * omegadot_body[2],
                          -dot4(qdot, qdot)};
  w_times(q, half, qddot);
}

/// omega_body = 2 W(q)^T qdot / norm2, the inverse of Eq. 5.
/// norm2: |q|^2, or 1 where the paper's formulas are wanted as they stand.
inline void angular_velocity(const double *q, double norm2, const double *qdot, double *omega_body)
{
  w_transposed_times(q, qdot, omega_body);
  const double factor = 2.0 / norm2;
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) omega_body[i] *= factor;
}

/// A(q), Eq. 8, row-major: e_body = A e_space.
/// norm2 = |q|^2 gives a rotation for every q: sites stay rigid between prediction and projection.
/// norm2 = 1 is Eq. 8 as it stands, a rotation only as far as |q| = 1 holds.
inline void rotation_matrix(const double *q, double norm2, double a[9])
{
  const double s = 2.0 / norm2;
  const double xx = s * q[0] * q[0], yy = s * q[1] * q[1], zz = s * q[2] * q[2];
  const double ww = s * q[3] * q[3];
  const double xy = s * q[0] * q[1], xz = s * q[0] * q[2], yz = s * q[1] * q[2];
  const double xw = s * q[0] * q[3], yw = s * q[1] * q[3], zw = s * q[2] * q[3];
  a[0] = xx + ww - 1.0;
  a[1] = xy + zw;
  a[2] = xz - yw;
  a[3] = xy - zw;
  a[4] = yy + ww - 1.0;
  a[5] = yz + xw;
  a[6] = xz + yw;
  a[7] = yz - xw;
  a[8] = zz + ww - 1.0;
}

/// e_body = A e_space, Eq. 10.
inline void to_body(const double a[9], const double *space, double *body)
{
  body[0] = a[0] * space[0] + a[1] * space[1] + a[2] * space[2];
  body[1] = a[3] * space[0] + a[4] * space[1] + a[5] * space[2];
  body[2] = a[6] * space[0] + a[7] * space[1] + a[8] * space[2];
}

/// e_space = A^T e_body, Eq. 9.
inline void to_space(const double a[9], const double *body, double *space)
{
  space[0] = a[0] * body[0] + a[3] * body[1] + a[6] * body[2];
  space[1] = a[1] * body[0] + a[4] * body[1] + a[7] * body[2];
  space[2] = a[2] * body[0] + a[5] * body[1] + a[8] * body[2];
}

/// The unit quaternion of a proper rotation matrix A (space -> body, row-major).
/// The largest component is found first, so that no small one is divided by.
inline void quaternion_from_matrix(const double a[9], double *q)
{
  const double four[4] = {1.0 + a[0] - a[4] - a[8], 1.0 - a[0] + a[4] - a[8],
                          1.0 - a[0] - a[4] + a[8], 1.0 + a[0] + a[4] + a[8]};
  int largest = 3;
  for (int i = 0; i < 3; ++i)
    if (four[i] > four[largest]) largest = i;
  const double f = 0.5 * std::sqrt(four[largest]);
  const double s = 0.25 / f;
  const double sum01 = a[1] + a[3], sum02 = a[2] + a[6], sum12 = a[5] + a[7];
  const double dif12 = a[5] - a[7], dif20 = a[6] - a[2], dif01 = a[1] - a[3];
  const double candidates[4][4] = {{f, s * sum01, s * sum02, s * dif12},
                                   {s * sum01, f, s * sum12, s * dif20},
                                   {s * sum02, s * sum12, f, s * dif01},
                                   {s * dif12, s * dif20, s * dif01, f}};
  double norm = 0.0;
  for (int i = 0; i < 4; ++i) norm += candidates[largest][i] * candidates[largest][i];
  norm = 1.0 / std::sqrt(norm);
  for (int i = 0; i < 4; ++i) q[i] = norm * candidates[largest][i];
}

/// Project q onto |q| = 1, Eq. 3.
inline void project_norm(double *q)
{
  const double factor = 1.0 / std::sqrt(dot4(q, q));
  for (int i = 0; i < 4; ++i) q[i] *= factor;
}

/// Project a rate of the unit quaternion q onto q.rate = 0, Eq. 4.
inline void project_rate(const double *q, double *rate)
{
  const double radial = dot4(q, rate);
  for (int i = 0; i < 4; ++i) rate[i] -= radial * q[i];
}

}    // namespace LAMMPS_NS::GearQuat

#endif
