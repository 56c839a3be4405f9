/* The free asymmetric top, exactly: angular velocity by Jacobi's elliptic functions, attitude by
   Euler angles about the fixed angular momentum and one quadrature (Landau & Lifshitz, Mechanics,
   section 37; Goldstein, x-convention).  Extended precision; moments all different, separatrix
   (2 E I_middle = L^2) excluded.  Kernel headers are not used.

   Roles: a = the extreme axis that omega stays close to (dn), b = the other extreme (cn), m = the
   middle one (sn).  If 2 E I_m < L^2, a has the largest moment; otherwise the smallest. */

#pragma once

#include "euler_angles.h"

#include <algorithm>

namespace Oracle {

/// sn, cn, dn of u for the parameter k2 = k^2, 0 <= k2 < 1, by the arithmetic-geometric mean.
inline void jacobi(long double u, long double k2, long double &sn, long double &cn, long double &dn)
{
  long double a[32] = {1.0L}, c[32] = {std::sqrt(k2)}, b = std::sqrt(1.0L - k2);
  int n = 0;
  while (n < 30 && std::fabs(c[n]) > 1e-20L) {
    a[n + 1] = 0.5L * (a[n] + b);
    c[n + 1] = 0.5L * (a[n] - b);
    b = std::sqrt(a[n] * b);
    ++n;
  }
  long double phi = std::ldexp(a[n] * u, n);
  for (; n > 0; --n) phi = 0.5L * (phi + std::asin(c[n] / a[n] * std::sin(phi)));
  sn = std::sin(phi);
  cn = std::cos(phi);
  dn = std::sqrt(1.0L - k2 * sn * sn);
}

/// The u with sn u = s, cn u = c.
inline long double inverse_jacobi(long double s, long double c, long double k2)
{
  return std::ellint_1(std::sqrt(k2), std::atan2(s, c));
}

class FreeTop {
 public:
  /// attitude: A at t = 0 (space -> body); omega in the body frame.
  FreeTop(const long double inertia[3], const long double omega0[3], const Matrix &attitude)
  {
    for (int i = 0; i < 3; ++i) I[i] = inertia[i];
    int order[3] = {0, 1, 2};
    std::sort(order, order + 3, [&](int i, int j) {
      return inertia[i] < inertia[j];
    });
    m = order[1];
    auto excess = [&](int axis) {    // L^2 - 2 E I_axis, without cancellation
      long double sum = 0.0L;
      for (int i = 0; i < 3; ++i) sum += I[i] * (I[i] - I[axis]) * omega0[i] * omega0[i];
      return sum;
    };
    a = excess(m) > 0.0L ? order[2] : order[0];
    b = order[0] + order[2] - a;
    const long double from_a = -excess(a), from_b = excess(b);
    k2 = (I[m] - I[b]) * from_a / ((I[a] - I[m]) * from_b);
    rate = std::sqrt((I[a] - I[m]) * from_b / (I[0] * I[1] * I[2]));
    const long double sign_a = omega0[a] < 0.0L ? -1.0L : 1.0L;
    amplitude[a] = sign_a * std::sqrt(from_b / (I[a] * (I[a] - I[b])));
    amplitude[b] = std::sqrt(from_a / (I[b] * (I[a] - I[b])));
    // sign of the middle one from its own Euler equation
    amplitude[m] = sign_a * std::copysign(1.0L, I[(m + 1) % 3] - I[(m + 2) % 3]) *
        std::sqrt(from_a / (I[m] * (I[a] - I[m])));
    u0 = inverse_jacobi(omega0[m] / amplitude[m], omega0[b] / amplitude[b], k2);
    momentum = 0.0L;
    for (int i = 0; i < 3; ++i) momentum += I[i] * I[i] * omega0[i] * omega0[i];
    momentum = std::sqrt(momentum);
    fixed = times(transposed(from_momentum_frame(0.0L, 0.0L)), attitude);
  }

  bool about_largest() const { return I[a] > I[m]; }

  void omega(long double t, long double w[3]) const
  {
    long double sn, cn, dn;
    jacobi(u0 + rate * t, k2, sn, cn, dn);
    w[a] = amplitude[a] * dn;
    w[b] = amplitude[b] * cn;
    w[m] = amplitude[m] * sn;
  }

  /// A(t), space -> body.
  Matrix attitude(long double t) const
  {
    return times(from_momentum_frame(t, precession(t)), fixed);
  }

 private:
  long double I[3], amplitude[3], k2, rate, u0, momentum;
  int a, b, m;
  Matrix fixed;    ///< space -> frame of the angular momentum

  /// Euler angles with z along the angular momentum and the body's third axis = a.
  Matrix from_momentum_frame(long double t, long double phi) const
  {
    long double w[3];
    omega(t, w);
    const int i = (a + 1) % 3, j = (a + 2) % 3;    // right-handed with a
    const long double li = I[i] * w[i], lj = I[j] * w[j], la = I[a] * w[a];
    const Matrix e = euler_matrix(phi, std::atan2(li, lj), std::atan2(std::hypot(li, lj), la));
    Matrix rows = {};    // of e: axes i, j, a
    for (int k = 0; k < 3; ++k) {
      rows.m[i][k] = e.m[0][k];
      rows.m[j][k] = e.m[1][k];
      rows.m[a][k] = e.m[2][k];
    }
    return rows;
  }

  /// phi(t): integral of L (I_i w_i^2 + I_j w_j^2) / (I_i^2 w_i^2 + I_j^2 w_j^2), Gauss, 5 points.
  long double precession(long double t) const
  {
    const long double s = std::sqrt(10.0L / 7.0L), inner = std::sqrt(5.0L - 2.0L * s) / 3.0L,
                      outer = std::sqrt(5.0L + 2.0L * s) / 3.0L, root = std::sqrt(70.0L);
    const long double x[5] = {-outer, -inner, 0.0L, inner, outer},
                      g[5] = {(322 - 13 * root) / 900, (322 + 13 * root) / 900, 128.0L / 225,
                              (322 + 13 * root) / 900, (322 - 13 * root) / 900};
    const int panels = 2 + int(64.0L * std::fabs(rate * t));
    long double sum = 0.0L;
    for (int p = 0; p < panels; ++p)
      for (int l = 0; l < 5; ++l) {
        long double w[3], upper = 0.0L, lower = 0.0L;
        omega(t * (p + 0.5L + 0.5L * x[l]) / panels, w);
        for (int i = 0; i < 3; ++i) {
          if (i == a) continue;
          upper += I[i] * w[i] * w[i];
          lower += I[i] * I[i] * w[i] * w[i];
        }
        sum += g[l] * upper / lower;
      }
    return 0.5L * momentum * sum * t / panels;
  }
};

}    // namespace Oracle
