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
