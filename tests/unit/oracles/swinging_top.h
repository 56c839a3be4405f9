/* A free asymmetric top whose center of mass oscillates, x'' = -x.  The exact motion is known, and
   so are the exact rows of a history. */

#pragma once

#include "exact_flow.h"
#include "gear_quat_integrator.h"
#include "taylor_top.h"

#include <vector>

namespace Oracle {

using namespace LAMMPS_NS::GearQuat;

constexpr long double MOMENTS[3] = {3.0L, 2.0L, 1.2L};
inline const RigidBody TOP = {2.0, {3.0, 2.0, 1.2}};

/// An oscillating free top: x'' = -x, free rotation.
inline BodyState top_state(double t)
{
  const ExactFlow flow(TOP, [](const BodyState &, double) {
    return Load{};
  });
  BodyState s = {{}, {0.1, -0.3, 0.5, 0.8}, {}, {1.0, 0.4, 0.5}};
  project_norm(s.q);
  const int parts = 1 + int(2.0 * std::fabs(t));
  for (int n = 0; n < parts; ++n) s = flow(s, t / parts);
  for (int i = 0; i < 3; ++i) {
    s.center[i] = std::cos(t + i + 0.3);
    s.velocity[i] = -std::sin(t + i + 0.3);
  }
  return s;
}

inline Load swing(const BodyState &s, double)
{
  Load l = {};
  for (int i = 0; i < 3; ++i) l.force[i] = -TOP.mass * s.center[i];
  return l;
}

/// Exact rows of that motion at t = 0 for a step h: x q (and p, omega) in the columns of the scheme.
inline std::vector<double> exact_rows(const Scheme &scheme, double h)
{
  const BodyState s = top_state(0.0);
  const TaylorTop top(MOMENTS, s.q, s.omega_body);
  std::vector<double> rows(scheme.size());
  double factor = 1.0, quarter = std::acos(0.0);
  for (int j = 0; j < scheme.values(); ++j) {
    double *row = rows.data() + j * scheme.width();
    for (int i = 0; i < 3; ++i) {
      row[i] = factor * std::cos(i + 0.3 + j * quarter);
      if (scheme.first()) {
        row[3 + i] = factor * TOP.mass * std::cos(i + 0.3 + (j + 1) * quarter);
        row[10 + i] = std::pow(h, j) * double(top.w[j][i]);
      }
    }
    double *q = row + scheme.quaternion();
    for (int i = 0; i < 4; ++i) q[i] = std::pow(h, j) * double(top.q[j][i]);
    factor *= h / (j + 1);
  }
  return rows;
}

}    // namespace Oracle
