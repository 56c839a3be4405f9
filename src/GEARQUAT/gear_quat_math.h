/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Several bodies side by side, in the vector registers of the processor: a number of type Lanes has
   an element for each of them.  The operations of a body are the same as with numbers of type
   double, and so are the results, in registers of any length.

   A function that is marked GEAR_QUAT_VARIANTS is compiled twice, also for processors with AVX2;
   the variant is chosen when the program is loaded.  What it calls is marked GEAR_QUAT_INLINE.

   Quaternion kinematics in the paper's convention.

   q = (q1, q2, q3, q4) with the scalar part LAST; LAMMPS' own order is scalar first.
   `space` and `body` in a name say in which frame components are given; the body frame is the frame
   of the principal axes.  q turns body components into space components: e_space = A^T(q) e_body.
   Equation numbers: Pratt & Bin Mohamad Zaini, with the misprints of Eqs. 5, 6 and 8 corrected
   (last row of W is (-q1, -q2, -q3, q4); A is the rotation matrix space -> body).

   Mass properties and Euler's equations of one rigid body.

   Components of the total force and torque, along the axes of space, may be masked: an external
   constraint, which does no work on a body at rest, balances the masked components.  Energy and
   virial use the full load, the motion uses the masked load. */

#ifndef GEAR_QUAT_MATH_H
#define GEAR_QUAT_MATH_H

#include <array>
#include <cmath>
#include <cstddef>    // defines __GLIBC__

namespace LAMMPS_NS::GearQuat {

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpsabi"    // no function with such arguments is ever called
constexpr int LANES = 4;                    ///< bodies side by side
using Lanes = double __attribute__((vector_size(LANES * sizeof(double))));
#define GEAR_QUAT_INLINE inline __attribute__((always_inline))
GEAR_QUAT_INLINE void set(Lanes &a, int lane, double value)
{
  a[lane] = value;
}
GEAR_QUAT_INLINE double get(const Lanes &a, int lane)
{
  return a[lane];
}
#else
constexpr int LANES = 1;
using Lanes = double;
#define GEAR_QUAT_INLINE inline
#endif

inline void set(double &a, int /*lane*/, double value)
{
  a = value;
}
inline double get(const double &a, int /*lane*/)
{
  return a;
}

#if defined(__GNUC__) && defined(__x86_64__) && defined(__GLIBC__) && !defined(__SANITIZE_THREAD__)
#define GEAR_QUAT_VARIANTS __attribute__((target_clones("avx2", "default"), flatten))
#else
#define GEAR_QUAT_VARIANTS
#endif

/* ---------------------------------------------------------------------- */

// T: double, or Lanes for several bodies side by side

template <class T> GEAR_QUAT_INLINE T dot3(const T *a, const T *b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T> GEAR_QUAT_INLINE T dot4(const T *a, const T *b)
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

template <class T> GEAR_QUAT_INLINE void cross3(const T *a, const T *b, T *out)
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/// sum += a, without a loop: most LAMMPS builds use -O2, which does not unroll loops.
inline void add3(const double *a, double *sum)
{
  sum[0] += a[0];
  sum[1] += a[1];
  sum[2] += a[2];
}

/// out = W(q) a, the matrix of Eqs. 5 and 6; it is the quaternion product q a.
template <class T> GEAR_QUAT_INLINE void w_times(const T *q, const T *a, T *out)
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
template <class T> GEAR_QUAT_INLINE void quaternion_rate(const T *q, const T *omega_body, T *qdot)
{
  const T half[4] = {0.5 * omega_body[0], 0.5 * omega_body[1], 0.5 * omega_body[2], T()};
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
/// norm2: |q|^2, or 1 for the paper's formulas as they are.
inline void angular_velocity(const double *q, double norm2, const double *qdot, double *omega_body)
{
  w_transposed_times(q, qdot, omega_body);
  const double factor = 2.0 / norm2;
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) omega_body[i] *= factor;
}

/// A(q), Eq. 8, row-major: e_body = A e_space.
/// norm2 = |q|^2 gives a rotation for every q: sites stay rigid between prediction and projection.
/// norm2 = 1 is Eq. 8 as it is, a rotation only to the accuracy of |q| = 1.
template <class T> GEAR_QUAT_INLINE void rotation_matrix(const T *q, const T &norm2, T *a)
{
  const T s = 2.0 / norm2;
  const T xx = s * q[0] * q[0], yy = s * q[1] * q[1], zz = s * q[2] * q[2];
  const T ww = s * q[3] * q[3];
  const T xy = s * q[0] * q[1], xz = s * q[0] * q[2], yz = s * q[1] * q[2];
  const T xw = s * q[0] * q[3], yw = s * q[1] * q[3], zw = s * q[2] * q[3];
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
template <class T> GEAR_QUAT_INLINE void to_body(const T *a, const T *space, T *body)
{
  body[0] = a[0] * space[0] + a[1] * space[1] + a[2] * space[2];
  body[1] = a[3] * space[0] + a[4] * space[1] + a[5] * space[2];
  body[2] = a[6] * space[0] + a[7] * space[1] + a[8] * space[2];
}

/// e_space = A^T e_body, Eq. 9.
template <class T> GEAR_QUAT_INLINE void to_space(const T *a, const T *body, T *space)
{
  space[0] = a[0] * body[0] + a[3] * body[1] + a[6] * body[2];
  space[1] = a[1] * body[0] + a[4] * body[1] + a[7] * body[2];
  space[2] = a[2] * body[0] + a[5] * body[1] + a[8] * body[2];
}

/// Project q onto |q| = 1, Eq. 3.
inline void project_norm(double *q)
{
  const double factor = 1.0 / std::sqrt(dot4(q, q));
  for (int i = 0; i < 4; ++i) q[i] *= factor;
}

/* ---------------------------------------------------------------------- */

/// An upper triangular matrix, in the order of LAMMPS' Domain::h.
struct Upper {
  enum { XX, YY, ZZ, YZ, XZ, XY, SIZE };
  static constexpr int ROW[] = {0, 1, 2, 1, 0, 0}, COLUMN[] = {0, 1, 2, 2, 2, 1};
  std::array<double, SIZE> m = {};

  template <class V> void fields(V &v) { v(m); }

  static Upper one() { return {{1.0, 1.0, 1.0, 0.0, 0.0, 0.0}}; }

  double &operator[](int k) { return m[k]; }
  double operator[](int k) const { return m[k]; }

  double determinant() const { return m[XX] * m[YY] * m[ZZ]; }
  double trace() const { return m[XX] + m[YY] + m[ZZ]; }

  /// this * v
  template <class T> GEAR_QUAT_INLINE void times(const T *v, T *product) const
  {
    for (int i = 0; i < 3; ++i) product[i] = row_times(i, v);
  }
  /// Row i of this * v
  template <class T> GEAR_QUAT_INLINE T row_times(int i, const T *v) const
  {
    if (i == 2) return m[ZZ] * v[2];
    return i == 1 ? m[YY] * v[1] + m[YZ] * v[2] : m[XX] * v[0] + m[XY] * v[1] + m[XZ] * v[2];
  }

  Upper operator*(const Upper &o) const
  {
    return {{m[XX] * o[XX], m[YY] * o[YY], m[ZZ] * o[ZZ], m[YY] * o[YZ] + m[YZ] * o[ZZ],
             m[XX] * o[XZ] + m[XY] * o[YZ] + m[XZ] * o[ZZ], m[XX] * o[XY] + m[XY] * o[YY]}};
  }
  Upper operator+(const Upper &o) const
  {
    Upper sum;
    for (int k = 0; k < SIZE; ++k) sum[k] = m[k] + o[k];
    return sum;
  }
  Upper operator-(const Upper &o) const { return *this + o.scaled(-1.0); }
  Upper scaled(double factor) const
  {
    Upper product;
    for (int k = 0; k < SIZE; ++k) product[k] = factor * m[k];
    return product;
  }
  Upper inverse() const
  {
    const double x = 1.0 / m[XX], y = 1.0 / m[YY], z = 1.0 / m[ZZ];
    return {{x, y, z, -m[YZ] * y * z, (m[XY] * m[YZ] * y - m[XZ]) * x * z, -m[XY] * x * y}};
  }
  /// this * s * transposed, for a symmetric matrix s, of which s has the upper half.
  Upper congruent(const Upper &s) const
  {
    const auto place = [](int i, int j) {
      return i == j ? i : 6 - i - j;
    };
    Upper found;
    for (int k = 0; k < SIZE; ++k)
      for (int i = ROW[k]; i < 3; ++i)
        for (int j = COLUMN[k]; j < 3; ++j)
          found[k] += m[place(ROW[k], i)] * s[place(i, j)] * m[place(COLUMN[k], j)];
    return found;
  }
  /// sum_ab this_ab o_ab
  double contracted(const Upper &o) const
  {
    double sum = 0.0;
    for (int k = 0; k < SIZE; ++k) sum += m[k] * o[k];
    return sum;
  }
};

/* ---------------------------------------------------------------------- */

/// A moment of inertia below this fraction of the largest counts as zero: that of CO2 from coordinates
/// with three decimals in Angstrom is up to 4e-7.
constexpr double LINEAR_FRACTION = 5.0e-7;

/// Mass and principal moments.  A zero moment has no rotational degree of freedom.
struct RigidBody {
  double mass;
  double inertia[3];

  int rotational_freedoms() const
  {
    return (inertia[0] > 0.0) + (inertia[1] > 0.0) + (inertia[2] > 0.0);
  }
  /// True if the body turns about this axis; in two dimensions bodies turn only about z.
  bool turns_about(int axis, int dimension) const
  {
    return inertia[axis] > 0.0 && (dimension == 3 || axis == 2);
  }
  /// Includes translation.
  int freedoms(int dimension) const
  {
    return dimension == 2 ? 2 + turns_about(2, 2) : 3 + rotational_freedoms();
  }
};

/// Position and motion of a body: the 13 numbers that determine its sites.
struct BodyState {
  double center[3];        ///< center of mass, unwrapped
  double q[4];             ///< orientation, scalar part last
  double velocity[3];      ///< of the center of mass
  double omega_body[3];    ///< angular velocity along the principal axes
};

/// Data for placing a site, derived from a state.
struct BodyFrame {
  double axes[9];    ///< rotation matrix space -> body
  double omega_space[3];
};

/// Total force and torque about the center of mass, in mass * length / time^2 (* length).
struct Load {
  double force[3];
  double torque_space[3];
};

/// Results of the corrector in a step.
struct Correction {
  double work;    ///< of the load, from the predicted to the corrected pose
  double position_error2, quaternion_error2;    ///< squared estimates of the local errors

  /// Estimated local error of the center of mass, length.
  double position_error() const { return std::sqrt(position_error2); }
  /// Estimated local error of the orientation, radians.
  double angle_error() const { return 2.0 * std::sqrt(quaternion_error2); }
};

/// omegadot_body, Eq. 7.  An axis without inertia has no angular acceleration.
inline void angular_acceleration(const RigidBody &body, const double *torque_body,
                                 const double *omega_body, double *omegadot_body)
{
  const double *inertia = body.inertia;
  const auto about = [&](int i, int j, int k) {    // indices known at compile time
    const double gyroscopic = (inertia[j] - inertia[k]) * omega_body[j] * omega_body[k];
    return inertia[i] > 0.0 ? (torque_body[i] + gyroscopic) / inertia[i] : 0.0;
  };
  omegadot_body[0] = about(0, 1, 2);
  omegadot_body[1] = about(1, 2, 0);
  omegadot_body[2] = about(2, 0, 1);
}

/// 1/I, 0 for an axis without inertia.
template <class T> GEAR_QUAT_INLINE void inverse_moments(const T *inertia, T *per_inertia)
{
  const T zero = T(), one = zero + 1.0;
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const T moment = inertia[i] > zero ? inertia[i] : one;
    per_inertia[i] = inertia[i] > zero ? one / moment : zero;
  }
}

/// The torque along the principal axes, Eq. 10.  norm2: see rotation_matrix().
inline void torque_along_axes(const double *q, double norm2, const Load &load, double *torque_body)
{
  double a[9];
  rotation_matrix(q, norm2, a);
  to_body(a, load.torque_space, torque_body);
}

/// The angular acceleration of a body in a state under a load.
inline void angular_acceleration(const RigidBody &body, const BodyState &state, double norm2,
                                 const Load &load, double *omegadot_body)
{
  double torque_body[3];
  torque_along_axes(state.q, norm2, load, torque_body);
  angular_acceleration(body, torque_body, state.omega_body, omegadot_body);
}

/// The angular momentum along the axes of space, A^T I omega.
inline void momentum_along_space(const RigidBody &body, const BodyState &state, double *momentum)
{
  double a[9], along[3];
  rotation_matrix(state.q, dot4(state.q, state.q), a);
  for (int i = 0; i < 3; ++i) along[i] = body.inertia[i] * state.omega_body[i];
  to_space(a, along, momentum);
}

/// A bit for each component that is off; 0: all components act.
using Mask = int;

constexpr Mask force_off(int component)
{
  return 1 << component;
}

constexpr Mask torque_off(int component)
{
  return 1 << (3 + component);
}

/// The load without the masked components.
inline Load acting_load(const Load &met, Mask off)
{
  Load acting = met;
  for (int k = 0; k < 3; ++k) {
    if (off & force_off(k)) acting.force[k] = 0.0;
    if (off & torque_off(k)) acting.torque_space[k] = 0.0;
  }
  return acting;
}

/// Work of a load at the pose `before` over the small displacement to the pose `after`.
inline double work_between(const Load &met, const BodyState &before, const BodyState &after)
{
  double torque_body[3], dx[3], dq[4], angle_body[3];
  const double norm2 = dot4(before.q, before.q);
  for (int i = 0; i < 3; ++i) dx[i] = after.center[i] - before.center[i];
  for (int i = 0; i < 4; ++i) dq[i] = after.q[i] - before.q[i];
  angular_velocity(before.q, norm2, dq, angle_body);
  torque_along_axes(before.q, norm2, met, torque_body);
  return dot3(met.force, dx) + dot3(torque_body, angle_body);
}

inline double translational_energy(const RigidBody &body, const double *velocity)
{
  return 0.5 * body.mass * dot3(velocity, velocity);
}

inline double rotational_energy(const RigidBody &body, const double *omega_body)
{
  double twice = 0.0;
  for (int i = 0; i < 3; ++i) twice += body.inertia[i] * omega_body[i] * omega_body[i];
  return 0.5 * twice;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
