/* The exact free top, compared with a much simpler method: fourth-order Runge-Kutta in extended
   precision with very many steps, for omega and the nine elements of A. */

#include "oracles/free_top.h"

#include <array>
#include <gtest/gtest.h>

using namespace Oracle;

namespace {

struct Top {
  long double w[3];
  Matrix a;
};

/// omega' from Euler's equations; A' = -omega x A, column by column.
Top slope(const long double *I, const Top &s)
{
  Top d;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    d.w[i] = (I[j] - I[k]) / I[i] * s.w[j] * s.w[k];
    for (int c = 0; c < 3; ++c) d.a.m[i][c] = s.w[k] * s.a.m[j][c] - s.w[j] * s.a.m[k][c];
  }
  return d;
}

Top moved(const Top &s, const Top &d, long double h)
{
  Top r = s;
  for (int i = 0; i < 3; ++i) {
    r.w[i] += h * d.w[i];
    for (int c = 0; c < 3; ++c) r.a.m[i][c] += h * d.a.m[i][c];
  }
  return r;
}

Top runge_kutta(const long double *I, Top s, long double t, int steps)
{
  const long double h = t / steps;
  for (int n = 0; n < steps; ++n) {
    const Top k1 = slope(I, s), k2 = slope(I, moved(s, k1, h / 2)),
              k3 = slope(I, moved(s, k2, h / 2)), k4 = slope(I, moved(s, k3, h));
    s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
  }
  return s;
}

long double distance(const FreeTop &top, const Top &s, long double t)
{
  long double w[3], worst = 0.0L;
  top.omega(t, w);
  const Matrix a = top.attitude(t);
  for (int i = 0; i < 3; ++i) {
    worst = std::max(worst, std::fabs(w[i] - s.w[i]));
    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::fabs(a.m[i][c] - s.a.m[i][c]));
  }
  return worst;
}

}    // namespace

TEST(Jacobi, KnownValuesAndInverse)
{
  long double sn, cn, dn;
  jacobi(0.7L, 0.0L, sn, cn, dn);    // k = 0: sine and cosine
  EXPECT_NEAR(double(sn - std::sin(0.7L)), 0.0, 1e-18);
  EXPECT_NEAR(double(dn - 1.0L), 0.0, 1e-18);
  jacobi(0.2L, 0.81L, sn, cn, dn);    // Abramowitz & Stegun, example 16.6
  EXPECT_NEAR(double(sn), 0.19762, 1e-5);
  EXPECT_NEAR(double(cn), 0.98028, 1e-5);
  EXPECT_NEAR(double(dn), 0.98406, 1e-5);
  for (long double k2 : {0.0L, 0.3L, 0.99L})
    for (long double u : {-2.4L, -1.0L, 0.0L, 0.4L, 1.5L, 2.9L}) {
      jacobi(u, k2, sn, cn, dn);
      EXPECT_NEAR(double(inverse_jacobi(sn, cn, k2) - u), 0.0, 1e-16);
      EXPECT_GT(std::fabs(double(inverse_jacobi(sn, cn, k2 + 0.01L) - u)), u == 0 ? -1.0 : 1e-6);
    }
}

TEST(FreeTop, AgreesWithRungeKuttaInBothRegimesAndAnyOrderOfAxes)
{
  const int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const long double moments[3] = {3.0L, 2.0L, 1.2L};
  const Matrix start = euler_matrix(0.7L, 1.9L, 1.1L);
  for (const auto &order : orders)
    for (const auto &w : {std::array<long double, 3>{1.0L, 0.4L, 0.5L},
                          {-0.3L, 0.2L, 1.1L},
                          {-0.9L, -0.5L, 0.2L},
                          {0.2L, -0.4L, -1.0L}}) {
      long double I[3];
      Top s = {};
      for (int i = 0; i < 3; ++i) {
        I[order[i]] = moments[i];
        s.w[order[i]] = w[i];
      }
      s.a = start;
      const FreeTop top(I, s.w, start);
      EXPECT_EQ(top.about_largest(), std::fabs(w[0]) > 0.5L);
      EXPECT_LT(distance(top, s, 0.0L), 1e-17L);
      const Top end = runge_kutta(I, s, 7.3L, 8000);
      EXPECT_LT(distance(top, end, 7.3L), 2e-13L);
      EXPECT_LT(distance(top, runge_kutta(I, s, -7.3L, 8000), -7.3L), 2e-13L);
    }
}

TEST(FreeTop, RungeKuttaApproachesItWithFourthOrder)
{
  const long double I[3] = {3.0L, 2.0L, 1.2L};
  const Top s = {{1.0L, 0.4L, 0.5L}, euler_matrix(0.7L, 1.9L, 1.1L)};
  const FreeTop top(I, s.w, s.a);
  const long double rough = distance(top, runge_kutta(I, s, 5.0L, 2000), 5.0L);
  const long double fine = distance(top, runge_kutta(I, s, 5.0L, 16000), 5.0L);
  EXPECT_NEAR(double(std::log2(rough / fine)) / 3.0, 4.0, 0.02);
  EXPECT_LT(fine, 2e-15L);
}
