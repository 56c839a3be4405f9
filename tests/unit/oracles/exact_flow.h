/* The state of a body after a time h, from any state and under any load, to the accuracy of the
   load: modified midpoint steps extrapolated to zero (Gragg, Bulirsch & Stoer), in extended
   precision.  The equations of motion are implemented independently; no integrator of the kernel is
   used. */

#pragma once

#include "gear_quat_math.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <vector>

namespace Oracle {

using namespace LAMMPS_NS::GearQuat;

class ExactFlow {
 public:
  using LoadOf = std::function<Load(const BodyState &state, double norm2)>;

  ExactFlow(const RigidBody &body, const LoadOf &load) : body(body), load(load) {}

  /// Accurate while h is a fraction of a radian of the fastest motion.
  BodyState operator()(const BodyState &start, double h) const
  {
    const Vector y0 = packed(start);
    std::vector<Vector> row;    // of Neville's table in (h/n)^2
    for (int k = 0; k < COLUMNS; ++k) {
      Vector next = midpoint(y0, h, 2 * (k + 1));
      for (int m = 1; m <= k; ++m) {
        const long double ratio = (long double) (k + 1) / (k + 1 - m), f = 1 / (ratio * ratio - 1);
        Vector better;
        for (int i = 0; i < SIZE; ++i) better[i] = next[i] + (next[i] - row[m - 1][i]) * f;
        row[m - 1] = next;
        next = better;
      }
      row.push_back(next);
    }
    return unpacked(row.back());
  }

 private:
  static constexpr int SIZE = 13, COLUMNS = 9;
  using Vector = std::array<long double, SIZE>;    // x, q, v, omega_body: the order of BodyState
  static_assert(sizeof(BodyState) == SIZE * sizeof(double), "a state is 13 numbers");

  RigidBody body;
  LoadOf load;

  static Vector packed(const BodyState &s)
  {
    std::array<double, SIZE> numbers;
    std::memcpy(numbers.data(), &s, sizeof s);
    Vector y;
    std::copy(numbers.begin(), numbers.end(), y.begin());
    return y;
  }

  static BodyState unpacked(const Vector &y)
  {
    std::array<double, SIZE> numbers;
    std::copy(y.begin(), y.end(), numbers.begin());
    BodyState s;
    std::memcpy(&s, numbers.data(), sizeof s);
    return s;
  }

  Vector rates(const Vector &y) const
  {
    const BodyState s = unpacked(y);
    const double norm2 = dot4(s.q, s.q);
    const Load l = load(s, norm2);
    double a[9], torque[3];
    rotation_matrix(s.q, norm2, a);
    to_body(a, l.torque_space, torque);
    const long double *q = &y[3], *v = &y[7], *w = &y[10];
    Vector d;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      d[i] = v[i];
      d[7 + i] = l.force[i] / (long double) body.mass;
      d[3 + i] = 0.5L * (q[3] * w[i] + q[j] * w[k] - q[k] * w[j]);
      const long double gyroscopic =
          ((long double) body.inertia[j] - body.inertia[k]) * w[j] * w[k];
      d[10 + i] = (torque[i] + gyroscopic) / body.inertia[i];
    }
    d[6] = -0.5L * (q[0] * w[0] + q[1] * w[1] + q[2] * w[2]);
    return d;
  }

  /// n steps of h/n, without the final smoothing: errors are even powers of h/n.
  Vector midpoint(const Vector &y0, long double h, int n) const
  {
    const long double step = h / n;
    Vector before = y0, now, d = rates(y0);
    for (int i = 0; i < SIZE; ++i) now[i] = y0[i] + step * d[i];
    for (int k = 1; k < n; ++k) {
      d = rates(now);
      for (int i = 0; i < SIZE; ++i) {
        const long double next = before[i] + 2 * step * d[i];
        before[i] = now[i];
        now[i] = next;
      }
    }
    return now;
  }
};

}    // namespace Oracle
