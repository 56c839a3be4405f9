/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;
using namespace GearQuat;

void GearQuat::quaternion_from_matrix(const double a[9], double *q)
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

void GearQuat::tensor_to_space(const double a[9], const double *t, double *out)
{
  for (int n = 0; n < 9; ++n) {
    out[n] = 0.0;
    for (int i = 0; i < 9; ++i) out[n] += a[i / 3 * 3 + n / 3] * t[i] * a[i % 3 * 3 + n % 3];
  }
}

void GearQuat::quaternion_about_z(double angle, double *q)
{
  q[0] = q[1] = 0.0;
  q[2] = std::sin(0.5 * angle);
  q[3] = std::cos(0.5 * angle);
}

double GearQuat::angle_about_z(const double *q)
{
  return q[3] < 0.0 ? 2.0 * std::atan2(-q[2], -q[3]) : 2.0 * std::atan2(q[2], q[3]);
}

void GearQuat::principal_axes(const double tensor[9], double moments[3], double a[9])
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

void GearQuat::sort_axes(double moments[3], double a[9])
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

void GearQuat::drop_vanishing_moments(double moments[3])
{
  const double largest = std::max({moments[0], moments[1], moments[2]});
  for (int i = 0; i < 3; ++i)
    if (moments[i] < LINEAR_FRACTION * largest || moments[i] <= 0.0) moments[i] = 0.0;
}

void GearQuat::sphere_moments(double mass, double radius, double moments[3])
{
  for (int i = 0; i < 3; ++i) moments[i] = 0.4 * mass * radius * radius;
}

void GearQuat::ellipsoid_moments(double mass, const double semi_axes[3], double moments[3])
{
  for (int i = 0; i < 3; ++i) {
    const double b = semi_axes[(i + 1) % 3], c = semi_axes[(i + 2) % 3];
    moments[i] = 0.2 * mass * (b * b + c * c);
  }
}

void GearQuat::line_moments(double mass, double length, double moments[3])
{
  moments[0] = 0.0;
  moments[1] = moments[2] = mass * length * length / 12.0;
}

void GearQuat::triangle_moments(double mass, const double *c1, const double *c2, const double *c3,
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

void GearQuat::add_tensor(const double moments[3], const double a[9], double tensor[9])
{
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 9; ++i) tensor[i] += moments[k] * a[3 * k + i / 3] * a[3 * k + i % 3];
}

void GearQuat::own_angular_momentum(const double moments[3], const double a[9],
                                    const double *omega_space, double *momentum_space)
{
  double own[3];
  to_body(a, omega_space, own);
  for (int k = 0; k < 3; ++k) own[k] *= moments[k];
  to_space(a, own, momentum_space);
}

/* ----------------------------------------------------------------------
   the nearest rigid motion
------------------------------------------------------------------------- */

/// A rotation about an axis moves no site if the sum of squared distances from the axis is less
/// than this part of the sum of squared distances from the center of mass: the axis of a linear
/// body.
static constexpr double NO_ARM = 1.0e-12;

/// Solves m x = b for positive semidefinite m by Cholesky's method with pivots.  Components that
/// are held, and components that the others determine up to NO_ARM of their scale, are 0.
static void solve_free(const double m[6][6], const double b[6], const double scale[6],
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

Twist GearQuat::nearest_twist(const Arms &arms, Mask off, const Load &sums)
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

void GearQuat::quaternion_of_turn(const double *turn, double *q)
{
  const double angle = length(turn);
  const double part = angle > 0.0 ? std::sin(0.5 * angle) / angle : 0.5;
  for (int k = 0; k < 3; ++k) q[k] = part * turn[k];
  q[3] = std::cos(0.5 * angle);
}

Move GearQuat::nearest_move(const Arms &arms, Mask off, const Displacements &sums)
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
