/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_integrator.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS::GearQuat;

struct Vector {
  Lanes x, y, z;
};

/// The coefficients of p = (v, c) and l for all lanes, up to an order.
struct Series {
  Lanes q[4];
  Vector per_inertia, l[Turn::MOST], v[Turn::MOST + 1];
  Lanes c[Turn::MOST + 1];

  GEAR_QUAT_INLINE void begin(int count, const RigidBody *const *bodies, const double *const *rows,
                              int stride, int terms);
  GEAR_QUAT_INLINE void find(int terms, int order);
};

/// Reads q and L.  A lane without a body repeats the last one.
void Series::begin(int count, const RigidBody *const *bodies, const double *const *rows, int stride,
                   int terms)
{
  const Lanes zero = {}, one = zero + 1.0;
  const auto body_in = [count](int lane) {
    return std::min(lane, count - 1);
  };
  Lanes inertia[3];
#pragma GCC unroll 4
  for (int lane = 0; lane < LANES; ++lane) {
    const int body = body_in(lane);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) set(inertia[i], lane, bodies[body]->inertia[i]);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) set(q[i], lane, rows[body][i]);
  }
#pragma GCC unroll 3
  for (Lanes &moment : inertia)
    moment = moment > zero ? one / (moment > zero ? moment : one) : zero;
  per_inertia = {inertia[0], inertia[1], inertia[2]};

  // A(q), see rotation_matrix()

  const Lanes s = 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const Lanes xx = s * q[0] * q[0], yy = s * q[1] * q[1], zz = s * q[2] * q[2];
  const Lanes xy = s * q[0] * q[1], xz = s * q[0] * q[2], yz = s * q[1] * q[2];
  const Lanes xw = s * q[0] * q[3], yw = s * q[1] * q[3], zw = s * q[2] * q[3];
  const Lanes rest = s * q[3] * q[3] - 1.0;
  for (int k = 0; k < terms; ++k) {
    Lanes x, y, z;
#pragma GCC unroll 4
    for (int lane = 0; lane < LANES; ++lane) {
      const double *row = rows[body_in(lane)] + (k + 1) * stride;
      set(x, lane, row[0]), set(y, lane, row[1]), set(z, lane, row[2]);
    }
    x *= k + 1.0, y *= k + 1.0, z *= k + 1.0;
    l[k] = {(xx + rest) * x + (xy + zw) * y + (xz - yw) * z,
            (xy - zw) * x + (yy + rest) * y + (yz + xw) * z,
            (xz + yw) * x + (yz - xw) * y + (zz + rest) * z};
  }
}

/// The sums over j up to k - 1 do not depend on the last terms, which follow in a chain.
void Series::find(int terms, int order)
{
  const Lanes zero = {};
  Vector w[Turn::MOST], u[Turn::MOST];
  for (int k = terms; k < order; ++k) l[k] = {zero, zero, zero};
  w[0] = {per_inertia.x * l[0].x, per_inertia.y * l[0].y, per_inertia.z * l[0].z};
  v[1] = {0.5 * w[0].x, 0.5 * w[0].y, 0.5 * w[0].z};
  c[1] = zero;
  for (int k = 1; k < order; ++k) {
    Lanes ux = zero, uy = zero, uz = zero, x = zero, y = zero, z = zero;
    Lanes rx = zero, ry = zero, rz = zero, down = zero;
    for (int j = 1; j < k; ++j) {
      const Vector &a = v[j], &b = l[k - j], &d = u[k - j], &e = w[k - j];
      ux += a.y * b.z - a.z * b.y;
      uy += a.z * b.x - a.x * b.z;
      uz += a.x * b.y - a.y * b.x;
      x += a.y * d.z - a.z * d.y - c[j] * d.x;
      y += a.z * d.x - a.x * d.z - c[j] * d.y;
      z += a.x * d.y - a.y * d.x - c[j] * d.z;
      rx += a.y * e.z - a.z * e.y + c[j] * e.x;
      ry += a.z * e.x - a.x * e.z + c[j] * e.y;
      rz += a.x * e.y - a.y * e.x + c[j] * e.z;
      down += a.x * e.x + a.y * e.y + a.z * e.z;
    }
    const Vector &a = v[k], &b = l[0], &e = w[0];
    u[k] = {ux + (a.y * b.z - a.z * b.y), uy + (a.z * b.x - a.x * b.z),
            uz + (a.x * b.y - a.y * b.x)};
    w[k] = {per_inertia.x * (l[k].x + 2.0 * (x - u[k].x)),
            per_inertia.y * (l[k].y + 2.0 * (y - u[k].y)),
            per_inertia.z * (l[k].z + 2.0 * (z - u[k].z))};
    rx += a.y * e.z - a.z * e.y + c[k] * e.x;
    ry += a.z * e.x - a.x * e.z + c[k] * e.y;
    rz += a.x * e.y - a.y * e.x + c[k] * e.z;
    down += a.x * e.x + a.y * e.y + a.z * e.z;
    const double part = 0.5 / (k + 1);
    v[k + 1] = {part * (w[k].x + rx), part * (w[k].y + ry), part * (w[k].z + rz)};
    c[k + 1] = -part * down;
  }
}

/// W(q) (p - (0, 0, 0, 1)) at the end, with the terms of each lane.
GEAR_QUAT_VARIANTS static void find_changes(const Turn::Orders &orders, int count,
                                            const RigidBody *const *bodies,
                                            const double *const *rows, int stride,
                                            double (*change)[4])
{
  Series series;
  series.begin(count, bodies, rows, stride, orders.terms);
  const Vector &per_inertia = series.per_inertia, &l = series.l[0];
  const Lanes wx = per_inertia.x * l.x, wy = per_inertia.y * l.y, wz = per_inertia.z * l.z;
  const Lanes angle2 = wx * wx + wy * wy + wz * wz, zero = {}, one = zero + 1.0;
  Lanes order_of = zero, p[4] = {zero, zero, zero, zero};
  int most = 0;
#pragma GCC unroll 4
  for (int lane = 0; lane < LANES; ++lane) {
    const int order = orders.of(get(angle2, lane));
    set(order_of, lane, order);
    most = std::max(most, order);
  }
  series.find(orders.terms, most);
  for (int k = most; k > 0; --k) {
    const Lanes counts = order_of >= zero + k ? one : zero;
    p[0] += counts * series.v[k].x;
    p[1] += counts * series.v[k].y;
    p[2] += counts * series.v[k].z;
    p[3] += counts * series.c[k];
  }
  const Lanes *q = series.q;
  const Lanes turned[4] = {q[3] * p[0] - q[2] * p[1] + q[1] * p[2] + q[0] * p[3],
                           q[2] * p[0] + q[3] * p[1] - q[0] * p[2] + q[1] * p[3],
                           q[0] * p[1] - q[1] * p[0] + q[3] * p[2] + q[2] * p[3],
                           q[3] * p[3] - q[0] * p[0] - q[1] * p[1] - q[2] * p[2]};
  for (int body = 0; body < count; ++body)
    for (int i = 0; i < 4; ++i) change[body][i] = get(turned[i], body);
}

/// The series of a free asymmetric top has a finite radius of convergence: its error is about
/// (angle/4)^(order + 1).
Turn::Turn(int terms, int least, double accuracy)
{
  orders.terms = terms;
  orders.least = least;
  for (int order = 0; order <= MOST; ++order) {
    const double angle = 4.0 * std::pow(accuracy, 1.0 / (order + 1));
    orders.fastest[order] = angle * angle;
  }
}

void Turn::changes(int count, const RigidBody *const *bodies, const double *const *rows, int stride,
                   double (*change)[4]) const
{
  find_changes(orders, count, bodies, rows, stride, change);
}

/// Rows for changes(), with a stride of 4.
struct RowsOf {
  double row[Turn::MOST + 1][4];
  const double *first = row[0];

  RowsOf(const double *q, const Turn::Momentum &momentum, int terms)
  {
    std::copy_n(q, 4, row[0]);
    for (int k = 0; k < terms; ++k)
      for (int i = 0; i < 3; ++i) row[k + 1][i] = momentum[k][i] / (k + 1);
  }
};

void Turn::advance(const RigidBody &body, const Momentum &momentum, double *q) const
{
  const RigidBody *one = &body;
  const RowsOf rows(q, momentum, orders.terms);
  double change[1][4];
  changes(1, &one, &rows.first, 4, change);
  for (int i = 0; i < 4; ++i) q[i] += change[0][i];
  project_norm(q);
}

void Turn::change_in_parts(const RigidBody &body, const double *rows, int stride,
                           double *change) const
{
  constexpr double FARTHEST = 0.7, MOST_PARTS = 1.0e4;
  const double *momenta = rows + stride;    // row k: (k + 1)^-1 times a coefficient of L
  double axes[9], along[3], angle2 = 0.0, now[4];
  rotation_matrix(rows, 1.0, axes);
  to_body(axes, momenta, along);
  for (int i = 0; i < 3; ++i)
    if (body.inertia[i] > 0.0) angle2 += along[i] * along[i] / (body.inertia[i] * body.inertia[i]);
  const double parts = std::ceil(std::sqrt(angle2) / FARTHEST);
  if (!(parts > 1.0) || !(parts < MOST_PARTS)) return;
  std::copy_n(rows, 4, now);
  for (double part = 0.0; part < parts; ++part) {
    Momentum rest;    // about the beginning of the part
    for (int i = 0; i < 3; ++i) {
      double unit = 1.0 / parts;
      for (int k = 0; k < orders.terms; ++k) rest[k][i] = (k + 1) * momenta[k * stride + i];
      for (int j = 0; j + 1 < orders.terms; ++j)
        for (int k = orders.terms - 2; k >= j; --k) rest[k][i] += part / parts * rest[k + 1][i];
      for (int k = 0; k < orders.terms; ++k, unit /= parts) rest[k][i] *= unit;
    }
    advance(body, rest, now);
  }
  for (int i = 0; i < 4; ++i) change[i] = now[i] - rows[i];
}

void Turn::coefficients(const RigidBody &body, const Momentum &momentum, int terms, const double *q,
                        double (*found)[4])
{
  const RigidBody *one = &body;
  const RowsOf rows(q, momentum, terms);
  Series series;
  series.begin(1, &one, &rows.first, 4, terms);
  series.find(terms, MOST);
  std::copy_n(q, 4, found[0]);
  for (int k = 1; k <= MOST; ++k) {
    const Vector &v = series.v[k];
    const double p[4] = {get(v.x, 0), get(v.y, 0), get(v.z, 0), get(series.c[k], 0)};
    w_times(q, p, found[k]);
  }
}
