/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Start-up: the higher rows of a history.

   A history starts from the Taylor series of the trajectory in x and q,
     x(t) = sum_j X_j (t/H)^j,   q(t) = sum_j Q_j (t/H)^j,
   of which `terms` are known: 2 (position and velocity: the paper's zero start), 3 (forces too), or
   as many as collocation finds.

   Collocation: the second derivatives at the nodes t = k H, k = -half..half, are interpolated by one
   polynomial; integrating it twice from the exact start gives the state at every node, the forces
   there give new second derivatives, and so on until nothing changes (Picard iteration).  Rows 0 and
   1 stay exact: no difference of positions enters a velocity.  Nodes on both sides of the start make
   it symmetric under time reversal.  The first sweep marches outwards: each pair of nodes is foretold
   by the polynomial through the nodes inside it.

   The host calls, for every body: begin(); then, until converged, sweep after sweep, for every pair
   -k and k, k = 1..half: state_at(), [forces at that state], set_load(), and in the first sweep
   foretell(k) after the pair; at the end seed(). */

#ifndef GEAR_QUAT_STARTUP_H
#define GEAR_QUAT_STARTUP_H

#include "gear_quat_integrator.h"

#include <cstdlib>
#include <limits>

namespace LAMMPS_NS::GearQuat {

/// Taylor series of one body's x (columns 0-2) and q (columns 3-6) in units of a step.
struct TaylorSeries {
  static constexpr int MAX_TERMS = MAX_VALUES + 3;
  int terms = 0;
  double c[MAX_TERMS][7];
};

/// The three terms that a state and the load on it determine, in units of the step h.
inline TaylorSeries local_series(const RigidBody &body, const BodyState &state, const Load &load,
                                 double h)
{
  TaylorSeries series;
  series.terms = 3;
  double omegadot_body[3], qdot[4], qddot[4];
  angular_acceleration(body, state, dot4(state.q, state.q), load, omegadot_body);
  quaternion_rate(state.q, state.omega_body, qdot);
  quaternion_acceleration(state.q, qdot, omegadot_body, qddot);
  for (int i = 0; i < 3; ++i) {
    series.c[0][i] = state.center[i];
    series.c[1][i] = h * state.velocity[i];
    series.c[2][i] = 0.5 * h * h * load.force[i] / body.mass;
  }
  for (int i = 0; i < 4; ++i) {
    series.c[0][3 + i] = state.q[i];
    series.c[1][3 + i] = h * qdot[i];
    series.c[2][3 + i] = 0.5 * h * h * qddot[i];
  }
  return series;
}

/// Fill all rows of a history from a series in units of the step `series_step`.
/// After the call rows with no known term are zero; momenta and angular velocities of the
/// first-order form are derivatives of the same series.
inline void seed(const Scheme &scheme, const RigidBody &body, const TaylorSeries &series,
                 double series_step, double h, double *rows)
{
  const int n = scheme.values(), width = scheme.width(), quat = scheme.quaternion();
  const double ratio = h / series_step;
  for (int i = 0; i < scheme.size(); ++i) rows[i] = 0.0;

  double power = 1.0;
  for (int j = 0; j < n && j < series.terms; ++j, power *= ratio) {
    double *row = rows + j * width;
    for (int i = 0; i < 3; ++i) row[Scheme::POSITION + i] = power * series.c[j][i];
    for (int i = 0; i < 4; ++i) row[quat + i] = power * series.c[j][3 + i];
  }
  if (!scheme.first()) return;

  // p = m x' and omega = 2 W(q)^T q', term by term

  power = 1.0 / series_step;
  for (int j = 0; j < n && j + 1 < series.terms; ++j, power *= ratio) {
    double *row = rows + j * width;
    for (int i = 0; i < 3; ++i)
      row[Scheme::MOMENTUM + i] = power * body.mass * (j + 1) * series.c[j + 1][i];
    for (int k = 0; k <= j; ++k) {
      double product[3];
      w_transposed_times(series.c[k] + 3, series.c[j + 1 - k] + 3, product);
      for (int i = 0; i < 3; ++i) row[Scheme::OMEGA + i] += power * 2.0 * (j + 1 - k) * product[i];
    }
  }
}

/// Decides when the sweeps end, from the largest change that each of them makes in any body.
class SweepRule {
 public:
  static constexpr int MAX_SPACINGS = 8;    ///< that are tried, each half of the one before

  enum class Verdict { ANOTHER_SWEEP, CONVERGED, JUMPS, SHORTER_SPACING };

  /// The next sweep is the first one with this node spacing.
  void begin_spacing() { sweeps = 0; }
  bool is_first_sweep() const { return sweeps == 0; }

  /// After a sweep.  truncation: a function that finds what the polynomial leaves out; it is called
  /// only if the answer depends on it.
  ///
  /// Sweeps end when the next one would change accelerations by less than CONVERGED, relative to how
  /// the bodies move: less than rounding takes from their velocities in a step, or than the
  /// polynomial leaves out.  A change that no longer falls is taken for rounding of the forces below
  /// ROUNDING; above, the nodes are too far apart, or forces jump, as at a cutoff.  Which of the two
  /// it is shorter spacings tell: after the last of JUMPING of them a change below JUMP counts as
  /// jumps.
  template <class Truncation> Verdict judge(double change, Truncation truncation)
  {
    const bool first = sweeps++ == 0, second = sweeps == 2;
    const double before = first ? 0.0 : last;
    last = change;
    const double next = !first && change < before ? change * (change / before) : change;
    if (next < CONVERGED || (!first && next < truncation())) return Verdict::CONVERGED;
    const bool falls = first || second || change <= 0.5 * before;
    if (std::isfinite(change) && falls && sweeps < MAX_SWEEPS) return Verdict::ANOTHER_SWEEP;
    if (change < ROUNDING) return Verdict::CONVERGED;
    return change < JUMP && ++jumps == JUMPING ? Verdict::JUMPS : Verdict::SHORTER_SPACING;
  }

 private:
  static constexpr int MAX_SWEEPS = 12, JUMPING = 3;
  static constexpr double CONVERGED = 1.0e-15, ROUNDING = 1.0e-9, JUMP = 0.1;

  int sweeps = 0;    ///< with the present spacing
  int jumps = 0;     ///< spacings at which forces seemed to jump
  double last = 0.0;
};

/// Collocation of one body; the object's tables are the same for all bodies.
class Collocation {
 public:
  static constexpr int MAX_HALF = (MAX_VALUES + 1) / 2;
  static constexpr int MAX_NODES = 2 * MAX_HALF + 1;

  /// Second derivatives at the nodes, in units of the node spacing, and the exact start.
  struct Workspace {
    double start[2][7];
    double second[MAX_NODES][7];
  };

  /// As many nodes as the order of a history of `values` rows needs.
  explicit Collocation(int values) : half((values + 1) / 2), nodes(2 * half + 1)
  {
    interpolate(half, monomial);
    for (int k = 0; k < nodes; ++k) {
      const double s = k - half;
      for (int l = 0; l < nodes; ++l) {
        long double value = 0.0, rate = 0.0, power = s;
        for (int j = 0; j < nodes; ++j) {
          rate += monomial[j][l] * power / (j + 1);
          power *= s;
          value += monomial[j][l] * power / ((j + 1) * (j + 2));
        }
        value_weight[k][l] = double(value);
        rate_weight[k][l] = double(rate);
      }
    }
    for (int inner = 1; inner < half; ++inner) extrapolate(inner);
  }

  /// Nodes on each side of the start, which needs no forces: its own are known.
  int pairs() const { return half; }

  /// First guess: constant second derivatives, those of `series` (at least three terms, in units of
  /// the node spacing).
  void begin(const TaylorSeries &series, Workspace &w) const
  {
    for (int i = 0; i < 7; ++i) {
      w.start[0][i] = series.c[0][i];
      w.start[1][i] = series.c[1][i];
      for (int k = 0; k < nodes; ++k) w.second[k][i] = 2.0 * series.c[2][i];
    }
  }

  /// Second derivatives beyond the nodes -inner..inner from those inside.
  void foretell(int inner, Workspace &w) const
  {
    for (int k = 0; k < nodes; ++k) {
      if (std::abs(k - half) <= inner) continue;
      for (int i = 0; i < 7; ++i) {
        double sum = 0.0;
        for (int l = -inner; l <= inner; ++l)
          sum += outer_weight[inner][k][half + l] * w.second[half + l][i];
        w.second[k][i] = sum;
      }
    }
  }

  /// State of the body at node -half..half by the present polynomial; spacing: time between nodes.
  BodyState state_at(int node, const Workspace &w, double spacing) const
  {
    double value[7], rate[7];
    for (int i = 0; i < 7; ++i) {
      value[i] = w.start[0][i] + node * w.start[1][i];
      rate[i] = w.start[1][i];
      for (int l = 0; l < nodes; ++l) {
        value[i] += value_weight[half + node][l] * w.second[l][i];
        rate[i] += rate_weight[half + node][l] * w.second[l][i];
      }
    }
    BodyState state;
    for (int i = 0; i < 3; ++i) {
      state.center[i] = value[i];
      state.velocity[i] = rate[i] / spacing;
    }
    for (int i = 0; i < 4; ++i) state.q[i] = value[3 + i];
    angular_velocity(state.q, dot4(state.q, state.q), rate + 3, state.omega_body);
    for (int i = 0; i < 3; ++i) state.omega_body[i] /= spacing;
    return state;
  }

  /// Take the load met at a node.  length: the size of the body.  Returns by how much the second
  /// derivatives there change, relative to the first or second derivatives of that body, whichever
  /// are larger; infinite if the load is no number.
  double set_load(int node, const RigidBody &body, const BodyState &state, const Load &load,
                  double spacing, double length, Workspace &w) const
  {
    BodyState unit = state;
    project_norm(unit.q);
    const TaylorSeries series = local_series(body, unit, load, spacing);
    double *second = w.second[half + node], change[7];
    for (int i = 0; i < 7; ++i) {
      const double found = 2.0 * series.c[2][i];
      if (!std::isfinite(found)) return std::numeric_limits<double>::infinity();
      change[i] = found - second[i];
      second[i] = found;
    }
    return relative(change, second, length, w);
  }

  /// What the polynomial leaves out, relative as in set_load: the size of its last term.
  double truncation(double length, const Workspace &w) const
  {
    double term[7];
    for (int i = 0; i < 7; ++i) {
      term[i] = 0.0;
      for (int l = 0; l < nodes; ++l) term[i] += double(monomial[nodes - 1][l]) * w.second[l][i];
    }
    return relative(term, w.second[half], length, w);
  }

  /// The converged polynomial as a series in units of the node spacing.
  TaylorSeries series(const Workspace &w) const
  {
    TaylorSeries series;
    series.terms = nodes + 2;
    static_assert(MAX_NODES + 2 <= TaylorSeries::MAX_TERMS, "series too short for the nodes");
    for (int i = 0; i < 7; ++i) {
      series.c[0][i] = w.start[0][i];
      series.c[1][i] = w.start[1][i];
      for (int j = 0; j < nodes; ++j) {
        long double sum = 0.0;
        for (int l = 0; l < nodes; ++l) sum += monomial[j][l] * w.second[l][i];
        series.c[j + 2][i] = double(sum / ((j + 1) * (j + 2)));
      }
    }
    return series;
  }

  int number_of_nodes() const { return nodes; }

  /// The rate of a scalar at all nodes, from -half on, as series of the scalar that is zero at the
  /// start: `nodes + 1` terms in units of the node spacing.
  void integrate(const double *rate, double spacing, double *c) const
  {
    c[0] = 0.0;
    for (int j = 0; j < nodes; ++j) {
      long double sum = 0.0;
      for (int l = 0; l < nodes; ++l) sum += monomial[j][l] * rate[l];
      c[j + 1] = double(spacing * sum / (j + 1));
    }
  }

 private:
  /// Motion slower than this part of the body's size (of a radian) in a step is none.
  static constexpr double SMALLEST = 1.0e-4;

  using Table = long double[MAX_NODES][MAX_NODES];

  int half, nodes;
  Table monomial;    ///< coefficient of s^j of the interpolation at node l
  double value_weight[MAX_NODES][MAX_NODES];              ///< twice integrated, at node k
  double rate_weight[MAX_NODES][MAX_NODES];               ///< once integrated, at node k
  double outer_weight[MAX_HALF][MAX_NODES][MAX_NODES];    ///< from the inner nodes to node k

  void extrapolate(int inner)
  {
    Table inside;
    interpolate(inner, inside);
    for (int k = 0; k < nodes; ++k)
      for (int l = 0; l <= 2 * inner; ++l) {
        long double sum = 0.0, power = 1.0;
        for (int j = 0; j <= 2 * inner; ++j, power *= k - half) sum += inside[j][l] * power;
        outer_weight[inner][k][half + l - inner] = double(sum);
      }
  }

  static double relative(const double *change, const double *second, double length,
                         const Workspace &w)
  {
    double part[2] = {0.0, 0.0}, scale[2] = {SMALLEST * length, SMALLEST};
    for (int i = 0; i < 7; ++i) {
      const int p = i < 3 ? 0 : 1;
      part[p] = std::max(part[p], std::fabs(change[i]));
      scale[p] = std::max({scale[p], std::fabs(w.start[1][i]), std::fabs(second[i])});
    }
    return std::max(part[0] / scale[0], part[1] / scale[1]);
  }

  /// Lagrange's basis polynomials on the nodes -half..half, multiplied out factor by factor.
  static void interpolate(int half, Table &monomial)
  {
    const int nodes = 2 * half + 1;
    for (int l = 0; l < nodes; ++l) {
      long double basis[MAX_NODES] = {1.0L};
      long double denominator = 1.0L;
      int degree = 0;
      for (int m = 0; m < nodes; ++m) {
        if (m == l) continue;
        const long double root = m - half;
        ++degree;
        for (int j = degree; j >= 0; --j)
          basis[j] = (j > 0 ? basis[j - 1] : 0.0L) - root * (j < degree ? basis[j] : 0.0L);
        denominator *= l - m;
      }
      for (int j = 0; j < nodes; ++j) monomial[j][l] = basis[j] / denominator;
    }
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
