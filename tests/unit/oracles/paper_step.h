/* One step of the paper, literally: derivatives instead of a Nordsieck history, Taylor series with
   factorials (Eq. 11), corrections as printed (Eqs. 13 to 18 and the lines below them), W and A as
   matrices.  Further passes start from the corrected values, with the force and the body-frame
   torque of the first pass.  Extended precision, no kernel header. */

#pragma once

#include <array>
#include <cmath>
#include <vector>

namespace Oracle {

using Real = long double;
/// derivatives[k][i]: k-th time derivative of the i-th component.
using Derivatives = std::vector<std::vector<Real>>;

struct PaperStep {
  std::vector<Real> coefficients;    ///< Table 1 or 2
  Real dt, mass, inertia[3], force[3], torque_space[3];
  int passes = 1;
  bool predicted_omega = false, predicted_momentum = false, project = false;

  static Real factorial(int n) { return n < 2 ? 1.0L : n * factorial(n - 1); }

  void predict(Derivatives &y) const
  {
    for (std::size_t k = 0; k < y.size(); ++k)
      for (std::size_t i = 0; i < y[k].size(); ++i)
        for (std::size_t l = k + 1; l < y.size(); ++l)
          y[k][i] += y[l][i] * std::pow(dt, Real(l - k)) / factorial(int(l - k));
  }

  void correct(Derivatives &y, int i, Real cor) const
  {
    for (std::size_t k = 0; k < y.size(); ++k)
      y[k][i] += coefficients[k] * cor * factorial(int(k)) / std::pow(dt, Real(k));
  }

  Real norm2(const Real *q) const
  {
    return project ? q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] : 1.0L;
  }

  /// W(q) of Eqs. 5 and 6, its last row corrected.
  template <class T> static std::array<std::array<T, 4>, 4> w(const T *q)
  {
    return {{{q[3], -q[2], q[1], q[0]},
             {q[2], q[3], -q[0], q[1]},
             {-q[1], q[0], q[3], q[2]},
             {-q[0], -q[1], -q[2], q[3]}}};
  }

  static void half_w_times(const Real *q, const Real *v, Real *out)
  {
    const auto rows = w(q);
    for (int i = 0; i < 4; ++i)
      out[i] =
          0.5L * (rows[i][0] * v[0] + rows[i][1] * v[1] + rows[i][2] * v[2] + rows[i][3] * v[3]);
  }

  /// A(q)/2 of Eq. 8 as corrected, n = |q|^2.
  template <class T> static std::array<T, 9> half_a(const T *q, T n)
  {
    const T x = q[0], y = q[1], z = q[2], s = q[3];
    return {x * x + s * s - n / 2, x * y + z * s,         x * z - y * s,
            x * y - z * s,         y * y + s * s - n / 2, y * z + x * s,
            x * z + y * s,         y * z - x * s,         z * z + s * s - n / 2};
  }

  /// Eqs. 8, 10 and 7; q: the pose at which the torque was evaluated.
  void angular_acceleration(const Real *q, const Real *w, Real *wdot) const
  {
    const Real n = norm2(q);
    const auto a = half_a(q, n);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      Real torque = 0.0L;
      for (int c = 0; c < 3; ++c) torque += 2.0L / n * a[3 * i + c] * torque_space[c];
      wdot[i] = torque / inertia[i] + (inertia[j] - inertia[k]) / inertia[i] * w[j] * w[k];
    }
  }

  /// Columns: x y z, px py pz, q1..q4, wx wy wz.
  void first(Derivatives &y) const
  {
    predict(y);
    const Derivatives met = y;
    for (int i = 0; i < 3; ++i) {
      correct(y, 3 + i, (force[i] - met[1][3 + i]) * dt);    // Eq. 14
      const Real momentum = predicted_momentum ? met[0][3 + i] : y[0][3 + i];
      correct(y, i, (momentum / mass - met[1][i]) * dt);    // Eq. 13
    }
    for (int pass = 0; pass < passes; ++pass) {
      const Derivatives p = y;
      Real wdot[3], qdot[4];
      angular_acceleration(&met[0][6], &p[0][10], wdot);
      for (int i = 0; i < 3; ++i) correct(y, 10 + i, (wdot[i] - p[1][10 + i]) * dt);    // Eq. 15
      const Derivatives &source = predicted_omega ? p : y;
      const Real w[4] = {source[0][10], source[0][11], source[0][12], 0.0L};
      half_w_times(&p[0][6], w, qdot);                                                // Eq. 5
      for (int i = 0; i < 4; ++i) correct(y, 6 + i, (qdot[i] - p[1][6 + i]) * dt);    // Eq. 16
    }
    if (project) unit(&y[0][6]);
  }

  /// Columns: x y z, q1..q4.
  void second(Derivatives &y) const
  {
    predict(y);
    const Derivatives met = y;
    for (int i = 0; i < 3; ++i)
      correct(y, i, (force[i] / mass - met[2][i]) * dt * dt / 2);    // Eq. 17
    for (int pass = 0; pass < passes; ++pass) {
      const Derivatives p = y;
      const Real *q = &p[0][3], *qdot = &p[1][3];
      // omega: Eq. 5 solved for it, 2 W^T qdot / |q|^2
      const Real f = 2.0L / norm2(q);
      const Real w[3] = {f * (q[3] * qdot[0] + q[2] * qdot[1] - q[1] * qdot[2] - q[0] * qdot[3]),
                         f * (-q[2] * qdot[0] + q[3] * qdot[1] + q[0] * qdot[2] - q[1] * qdot[3]),
                         f * (q[1] * qdot[0] - q[0] * qdot[1] + q[3] * qdot[2] - q[2] * qdot[3])};
      Real v[4] = {}, qddot[4];
      angular_acceleration(&met[0][3], w, v);
      for (int i = 0; i < 4; ++i) v[3] -= 2.0L * qdot[i] * qdot[i];
      half_w_times(q, v, qddot);    // Eq. 6
      for (int i = 0; i < 4; ++i)
        correct(y, 3 + i, (qddot[i] - p[2][3 + i]) * dt * dt / 2);    // Eq. 18
    }
    if (!project) return;
    unit(&y[0][3]);
    Real radial = 0.0L;    // Eq. 4
    for (int i = 0; i < 4; ++i) radial += y[0][3 + i] * y[1][3 + i];
    for (int i = 0; i < 4; ++i) y[1][3 + i] -= radial * y[0][3 + i];
  }

  static void unit(Real *q)    // Eq. 3
  {
    const Real norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; ++i) q[i] /= norm;
  }
};

}    // namespace Oracle
