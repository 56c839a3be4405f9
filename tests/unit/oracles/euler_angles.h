/* Rotation matrices from Euler angles, Goldstein's x-convention (phi about z, theta about the new
   x, psi about the new z), as a product of three plane rotations: no quaternion is used. */

#pragma once

#include <cmath>

namespace Oracle {

struct Matrix {
  long double m[3][3];
};

inline Matrix times(const Matrix &a, const Matrix &b)
{
  Matrix c = {};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) c.m[i][j] += a.m[i][k] * b.m[k][j];
  return c;
}

/// Components of a fixed vector in axes rotated by `angle` about axis 0, 1 or 2.
inline Matrix turned_axes(int axis, long double angle)
{
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  Matrix r = {};
  r.m[axis][axis] = 1.0L;
  r.m[j][j] = r.m[k][k] = std::cos(angle);
  r.m[j][k] = std::sin(angle);
  r.m[k][j] = -std::sin(angle);
  return r;
}

/// A, space -> body (Goldstein's B C D).
inline Matrix euler_matrix(long double phi, long double psi, long double theta)
{
  return times(turned_axes(2, psi), times(turned_axes(0, theta), turned_axes(2, phi)));
}

/// Eq. 2, scalar part last.
inline void euler_quaternion(double phi, double psi, double theta, double *q)
{
  q[0] = std::sin(theta / 2) * std::cos((phi - psi) / 2);
  q[1] = std::sin(theta / 2) * std::sin((phi - psi) / 2);
  q[2] = std::cos(theta / 2) * std::sin((phi + psi) / 2);
  q[3] = std::cos(theta / 2) * std::cos((phi + psi) / 2);
}

}    // namespace Oracle
