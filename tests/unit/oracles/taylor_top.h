/* Taylor coefficients of a free body's attitude and angular velocity, from the recurrences of
   Euler's equations and qdot = 1/2 q omega; extended precision, no kernel header. */

#pragma once

namespace Oracle {

struct TaylorTop {
  static constexpr int TERMS = 14;
  long double w[TERMS][3], q[TERMS][4];    ///< coefficient of t^n; q scalar part last

  TaylorTop(const long double *I, const double *q0, const double *w0)
  {
    for (int i = 0; i < 3; ++i) w[0][i] = w0[i];
    for (int i = 0; i < 4; ++i) q[0][i] = q0[i];
    for (int n = 0; n + 1 < TERMS; ++n) {
      long double dw[3] = {}, dq[4] = {};
      for (int k = 0; k <= n; ++k) {
        const long double *a = w[k], *b = w[n - k], *p = q[n - k];
        for (int i = 0; i < 3; ++i) {
          const int j = (i + 1) % 3, l = (i + 2) % 3;
          dw[i] += (I[j] - I[l]) / I[i] * a[j] * b[l];
          dq[i] += 0.5L * (p[3] * a[i] + p[j] * a[l] - p[l] * a[j]);    // s omega + v x omega
        }
        dq[3] -= 0.5L * (p[0] * a[0] + p[1] * a[1] + p[2] * a[2]);
      }
      for (int i = 0; i < 3; ++i) w[n + 1][i] = dw[i] / (n + 1);
      for (int i = 0; i < 4; ++i) q[n + 1][i] = dq[i] / (n + 1);
    }
  }
};

}    // namespace Oracle
