/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_turn.h"

#include <algorithm>

using namespace LAMMPS_NS::GearQuat;

/// The coefficients of p = (v, c), from the first on.  Components are written out: compilers do not
/// keep hundreds of small functions inline.
template <int ORDER> struct Rotation {
  struct Vector {
    double x, y, z;
  };
  Vector v[ORDER + 1];
  double c[ORDER + 1];

  void find(const double *per_inertia, const double (*of_l)[3])
  {
    Vector l[ORDER], w[ORDER], u[ORDER];
    for (int k = 0; k < ORDER; ++k) l[k] = {of_l[k][0], of_l[k][1], of_l[k][2]};
    w[0] = {per_inertia[0] * l[0].x, per_inertia[1] * l[0].y, per_inertia[2] * l[0].z};
    v[1] = {0.5 * w[0].x, 0.5 * w[0].y, 0.5 * w[0].z};
    c[1] = 0.0;
#pragma GCC unroll 10
    for (int k = 1; k < ORDER; ++k) {
      double x = 0.0, y = 0.0, z = 0.0, down = 0.0;
#pragma GCC unroll 10
      for (int j = 1; j <= k; ++j) {
        x += v[j].y * l[k - j].z - v[j].z * l[k - j].y;
        y += v[j].z * l[k - j].x - v[j].x * l[k - j].z;
        z += v[j].x * l[k - j].y - v[j].y * l[k - j].x;
      }
      u[k] = {x, y, z};
      x = -x, y = -y, z = -z;
#pragma GCC unroll 10
      for (int j = 1; j < k; ++j) {
        x += v[j].y * u[k - j].z - v[j].z * u[k - j].y - c[j] * u[k - j].x;
        y += v[j].z * u[k - j].x - v[j].x * u[k - j].z - c[j] * u[k - j].y;
        z += v[j].x * u[k - j].y - v[j].y * u[k - j].x - c[j] * u[k - j].z;
      }
      w[k] = {per_inertia[0] * (l[k].x + 2.0 * x), per_inertia[1] * (l[k].y + 2.0 * y),
              per_inertia[2] * (l[k].z + 2.0 * z)};
      x = w[k].x, y = w[k].y, z = w[k].z;
#pragma GCC unroll 10
      for (int j = 1; j <= k; ++j) {
        x += v[j].y * w[k - j].z - v[j].z * w[k - j].y + c[j] * w[k - j].x;
        y += v[j].z * w[k - j].x - v[j].x * w[k - j].z + c[j] * w[k - j].y;
        z += v[j].x * w[k - j].y - v[j].y * w[k - j].x + c[j] * w[k - j].z;
        down += v[j].x * w[k - j].x + v[j].y * w[k - j].y + v[j].z * w[k - j].z;
      }
      const double part = 0.5 / (k + 1);
      v[k + 1] = {part * x, part * y, part * z};
      c[k + 1] = -part * down;
    }
  }
};

/// p at the end, of unit length but for the truncation.
template <int ORDER> static void sum(const double *per_inertia, const double (*l)[3], double *p)
{
  Rotation<ORDER> rotation;
  rotation.find(per_inertia, l);
  p[0] = p[1] = p[2] = p[3] = 0.0;
#pragma GCC unroll 10
  for (int k = ORDER; k > 0; --k) {
    p[0] += rotation.v[k].x;
    p[1] += rotation.v[k].y;
    p[2] += rotation.v[k].z;
    p[3] += rotation.c[k];
  }
  p[3] += 1.0;
}

static void sum(int order, const double *per_inertia, const double (*l)[3], double *p)
{
  switch (order) {    // loops of a known length are unrolled
    case 5:
      return sum<5>(per_inertia, l, p);
    case 6:
      return sum<6>(per_inertia, l, p);
    case 7:
      return sum<7>(per_inertia, l, p);
    case 8:
      return sum<8>(per_inertia, l, p);
    case 9:
      return sum<9>(per_inertia, l, p);
    case 10:
      return sum<10>(per_inertia, l, p);
    case 12:
      return sum<12>(per_inertia, l, p);
    case 16:
      return sum<16>(per_inertia, l, p);
    default:
      return sum<Turn::MOST>(per_inertia, l, p);
  }
}

/// l = A(q) L, and 1/I.  Returns the square of half the angle of the step.
static double along_axes(const RigidBody &body, const Turn::Momentum &momentum, int terms,
                         const double *q, double (*l)[3], double *per_inertia)
{
  double a[9], half2 = 0.0;
  inverse_moments(body, per_inertia);
  rotation_matrix(q, 1.0, a);
  for (int k = 0; k < terms; ++k) to_body(a, momentum[k], l[k]);
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) half2 += 0.25 * per_inertia[i] * l[0][i] * per_inertia[i] * l[0][i];
  return half2;
}

/// One of the orders that sum() knows.  half2: the square of half the angle of the step.
static int order_for(double half2, int least)
{
  // (angle/4)^(order + 1) is 1e-14 here: the series of a free asymmetric top has a finite radius
  // of convergence
  struct Limit {
    int order;
    double half2;
  };
  constexpr Limit LIMITS[] = {{5, 8.62e-05}, {6, 0.0004},  {7, 0.00126}, {8, 0.0031},
                              {9, 0.00634},  {10, 0.0114}, {12, 0.0281}, {16, 0.0902}};
  for (const Limit &one : LIMITS)
    if (least <= one.order && half2 <= one.half2) return one.order;
  return Turn::MOST;
}

void Turn::advance(const RigidBody &body, const Momentum &momentum, int terms, int least, double *q)
{
  double l[MOST][3], per_inertia[3], p[4], before[4];
  const double half2 = along_axes(body, momentum, terms, q, l, per_inertia);
  const int order = order_for(half2, least);
  for (int k = terms; k < order; ++k) l[k][0] = l[k][1] = l[k][2] = 0.0;
  sum(order, per_inertia, l, p);
  for (int i = 0; i < 4; ++i) before[i] = q[i];
  w_times(before, p, q);
  project_norm(q);
}

void Turn::coefficients(const RigidBody &body, const Momentum &momentum, int terms, const double *q,
                        double (*found)[4])
{
  double l[MOST][3] = {}, per_inertia[3];
  Rotation<MOST> rotation;
  along_axes(body, momentum, terms, q, l, per_inertia);
  rotation.find(per_inertia, l);
  for (int i = 0; i < 4; ++i) found[0][i] = q[i];
  for (int k = 1; k <= MOST; ++k) {
    const double p[4] = {rotation.v[k].x, rotation.v[k].y, rotation.v[k].z, rotation.c[k]};
    w_times(q, p, found[k]);
  }
}
