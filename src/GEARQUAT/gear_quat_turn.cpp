/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_turn.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS::GearQuat;

/// A number for each of the bodies.
#if defined(__GNUC__)
using Lanes = double __attribute__((vector_size(Turn::LANES * sizeof(double))));
#else
struct Lanes {
  double of[Turn::LANES];
  double &operator[](int lane) { return of[lane]; }
  double operator[](int lane) const { return of[lane]; }
};
template <class Act> static Lanes each(Act act)
{
  Lanes found;
  for (int lane = 0; lane < Turn::LANES; ++lane) found[lane] = act(lane);
  return found;
}
static Lanes operator+(Lanes a, Lanes b)
{
  return each([&](int k) {
    return a[k] + b[k];
  });
}
static Lanes operator-(Lanes a, Lanes b)
{
  return each([&](int k) {
    return a[k] - b[k];
  });
}
static Lanes operator*(Lanes a, Lanes b)
{
  return each([&](int k) {
    return a[k] * b[k];
  });
}
static Lanes operator*(double a, Lanes b)
{
  return each([&](int k) {
    return a * b[k];
  });
}
static Lanes operator-(Lanes a)
{
  return each([&](int k) {
    return -a[k];
  });
}
static Lanes &operator+=(Lanes &a, Lanes b)
{
  return a = a + b;
}
#endif

struct Vector {
  Lanes x, y, z;
};

/// The coefficients of p = (v, c) for all lanes, from the first on.  Components are written out:
/// compilers do not keep hundreds of small functions inline.
template <int ORDER> struct Rotation {
  Vector v[ORDER + 1];
  Lanes c[ORDER + 1];

  void find(const Lanes *per_inertia, const Vector *l)
  {
    Vector w[ORDER], u[ORDER];
    const Lanes zero = {};
    w[0] = {per_inertia[0] * l[0].x, per_inertia[1] * l[0].y, per_inertia[2] * l[0].z};
    v[1] = {0.5 * w[0].x, 0.5 * w[0].y, 0.5 * w[0].z};
    c[1] = zero;
#pragma GCC unroll 10
    for (int k = 1; k < ORDER; ++k) {
      Lanes x = zero, y = zero, z = zero, down = zero;
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

/// p - (0, 0, 0, 1) at the end, with the terms of each lane.
template <int ORDER>
static void sum(const int *orders, const Lanes *per_inertia, const Vector *l, Lanes *p)
{
  Rotation<ORDER> rotation;
  rotation.find(per_inertia, l);
  Lanes zero = {}, counts = zero;
  p[0] = p[1] = p[2] = p[3] = zero;
#pragma GCC unroll 10
  for (int k = ORDER; k > 0; --k) {
    for (int lane = 0; lane < Turn::LANES; ++lane) counts[lane] = k <= orders[lane];
    p[0] += counts * rotation.v[k].x;
    p[1] += counts * rotation.v[k].y;
    p[2] += counts * rotation.v[k].z;
    p[3] += counts * rotation.c[k];
  }
}

static void sum(int order, const int *orders, const Lanes *per_inertia, const Vector *l, Lanes *p)
{
  switch (order) {    // loops of a known length are unrolled
    case 5:
      return sum<5>(orders, per_inertia, l, p);
    case 6:
      return sum<6>(orders, per_inertia, l, p);
    case 7:
      return sum<7>(orders, per_inertia, l, p);
    case 8:
      return sum<8>(orders, per_inertia, l, p);
    case 9:
      return sum<9>(orders, per_inertia, l, p);
    case 10:
      return sum<10>(orders, per_inertia, l, p);
    case 12:
      return sum<12>(orders, per_inertia, l, p);
    case 16:
      return sum<16>(orders, per_inertia, l, p);
    default:
      return sum<Turn::MOST>(orders, per_inertia, l, p);
  }
}

/// The series of a free asymmetric top has a finite radius of convergence: its error is about
/// (angle/4)^(order + 1).
Turn::Turn(int terms, double accuracy) : terms(terms)
{
  for (int k = 0; k < KINDS; ++k) {
    const double angle = 4.0 * std::pow(accuracy, 1.0 / (ORDERS[k] + 1));
    fastest[k] = ORDERS[k] > terms ? angle * angle : -1.0;    // not even at rest
  }
}

int Turn::order_for(double angle2) const
{
  for (int k = 0; k < KINDS; ++k)
    if (angle2 <= fastest[k]) return ORDERS[k];
  return MOST;
}

/// l = A(q) L of one body in its lane, and 1/I.  Returns the square of the angle of the step.
static double along_axes(const RigidBody &body, const Turn::Momentum &momentum, int terms,
                         const double *q, int lane, Vector *l, Lanes *per_inertia)
{
  double a[9], inverse[3], along[3], angle2 = 0.0;
  inverse_moments(body, inverse);
  rotation_matrix(q, dot4(q, q), a);
  for (int k = 0; k < terms; ++k) {
    to_body(a, momentum[k], along);
    l[k].x[lane] = along[0];
    l[k].y[lane] = along[1];
    l[k].z[lane] = along[2];
    if (k > 0) continue;
    for (int i = 0; i < 3; ++i) angle2 += inverse[i] * along[i] * inverse[i] * along[i];
  }
  for (int i = 0; i < 3; ++i) per_inertia[i][lane] = inverse[i];
  return angle2;
}

void Turn::changes(int count, const RigidBody *const *bodies, const Momentum *momenta,
                   const double *const *q, double (*change)[4]) const
{
  Vector l[MOST];
  Lanes per_inertia[3], p[4];
  int orders[LANES], order = 0;
  for (int lane = 0; lane < LANES; ++lane) {
    const int body = std::min(lane, count - 1);    // a lane without a body repeats the last one
    orders[lane] =
        order_for(along_axes(*bodies[body], momenta[body], terms, q[body], lane, l, per_inertia));
    order = std::max(order, orders[lane]);
  }
  const Lanes zero = {};
  for (int k = terms; k < order; ++k) l[k] = {zero, zero, zero};
  sum(order, orders, per_inertia, l, p);
  for (int body = 0; body < count; ++body) {
    const double turned[4] = {p[0][body], p[1][body], p[2][body], p[3][body]};
    w_times(q[body], turned, change[body]);
  }
}

void Turn::advance(const RigidBody &body, const Momentum &momentum, double *q) const
{
  const RigidBody *one = &body;
  const double *before = q;
  double change[1][4];
  changes(1, &one, &momentum, &before, change);
  for (int i = 0; i < 4; ++i) q[i] += change[0][i];
  project_norm(q);
}

void Turn::coefficients(const RigidBody &body, const Momentum &momentum, int terms, const double *q,
                        double (*found)[4])
{
  Vector l[MOST] = {};
  Lanes per_inertia[3];
  Rotation<MOST> rotation;
  for (int lane = 0; lane < LANES; ++lane)
    along_axes(body, momentum, terms, q, lane, l, per_inertia);
  rotation.find(per_inertia, l);
  for (int i = 0; i < 4; ++i) found[0][i] = q[i];
  for (int k = 1; k <= MOST; ++k) {
    const double p[4] = {rotation.v[k].x[0], rotation.v[k].y[0], rotation.v[k].z[0],
                         rotation.c[k][0]};
    w_times(q, p, found[k]);
  }
}
