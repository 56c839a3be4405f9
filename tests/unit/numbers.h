/* Random numbers for the tests, also for programs without GoogleTest. */

#pragma once

#include "gear_quat_math.h"

#include <cmath>
#include <vector>

namespace Check {

/// Reproducible numbers in (-1, 1), the same with every standard library.
class Numbers {
 public:
  explicit Numbers(unsigned long long seed) : state(seed) {}
  double next()
  {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return double(state >> 11) / 4503599627370496.0 - 1.0;
  }
  std::vector<double> list(int n)
  {
    std::vector<double> v(n);
    for (double &x : v) x = next();
    return v;
  }
  std::vector<double> unit_quaternion()
  {
    std::vector<double> q = list(4);
    const double norm = std::sqrt(LAMMPS_NS::GearQuat::dot4(q.data(), q.data()));
    for (double &x : q) x /= norm;
    return q;
  }

 private:
  unsigned long long state;
};

}    // namespace Check
