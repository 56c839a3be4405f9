/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Start-up: the higher rows of a history.

   A history starts from the Taylor series of the trajectory in x, q and the angular momentum L,
     x(t) = sum_j X_j (t/H)^j,   q(t) = sum_j Q_j (t/H)^j,   H L(t) = sum_j L_j (t/H)^j,
   with a number of known `terms`: 2 (position and velocity: the paper's zero start), 3 (forces
   too), or the number found by collocation.  L has one term less.

   Collocation: forces and torques at the nodes t = k H, k = -m..m, are interpolated by one
   polynomial; integrating it from the exact start gives x, v and L at a node, q turns with L
   (gear_quat_turn.h), and the forces there replace those of the polynomial (Picard iteration).
   Pairs of nodes are added outwards: each is extrapolated by the polynomial through the nodes
   inside it.  Rows 0 and 1 stay exact: no difference of positions enters a velocity.  The start is
   symmetric under time reversal, because the nodes on both sides are treated equally.

   The host of find_start() calls, for every body: begin(); foretell() to add a pair; state_at(),
   [forces], set_load() for both nodes of a pair, then settle(); finally series() and seed().

   find_start() decides which pair of nodes is evaluated next, and when to stop.  After two pairs
   the host may reduce the number of values.  The polynomial through the pairs 1..m-1 predicts the
   accelerations at pair m with an error e_m.  If forces are smooth, e_m decreases by about z^2 from
   pair to pair, with z the angle of the fastest motion in a spacing.  Before a pair is added, the
   pairs inside are evaluated again with the improved polynomial:

     1 | 1 2 | 1 2 3 | 1 2 3 4

   Each further round gains two orders of the spacing.  An evaluation is omitted if the change
   expected from the contraction so far is below the tolerance.

   If e_m does not decrease, a polynomial does not represent the forces at this scale: they are
   discontinuous, as at a cutoff, and only the pairs inside m are useful. */

#ifndef GEAR_QUAT_STARTUP_H
#define GEAR_QUAT_STARTUP_H

#include "gear_quat_coefficients.h"
#include "gear_quat_integrator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class StartPlan {
 public:
  static constexpr int MAX_PAIRS = (MAX_VALUES + 1) / 2;
  static constexpr int MAX_SPACINGS = 8;    ///< tries, each with half the spacing

  enum class Verdict { GOES_ON, CONVERGED, JUMPS, SHORTER_SPACING };

  /// Pairs of nodes required by the order of a history with this number of rows.
  static int pairs_for(int values) { return (values + 1) / 2; }

  /// slowest: a change becomes smaller at most by this factor in another evaluation.  With a coupling
  /// the loads change its variables first, and these change the loads one evaluation later.
  explicit StartPlan(int values, double slowest = 0.0) :
      wanted(values), odd(values % 2), most(pairs_for(values)), slowest(slowest)
  {
  }
  static constexpr double COUPLED = 0.1;

  /// Reduces the number of values.
  void limit(int values)
  {
    if (values >= wanted) return;
    wanted = values;
    odd = values % 2;
    most = pairs_for(values);
  }

  /// The pair to be evaluated next, 1..pairs_for(values).
  int pair() const { return present; }
  /// It has to be extrapolated first.
  bool is_new() const { return present > known; }
  /// Pairs in the polynomial; fewer than were evaluated if forces are discontinuous.
  int pairs() const { return known; }

  /// After pair() was evaluated.  change: the largest change of an acceleration in any body,
  /// relative to its motion (Collocation::set_load).
  Verdict take(double change)
  {
    if (!std::isfinite(change) || (present == 1 && change > TOO_FAR))
      return Verdict::SHORTER_SPACING;
    const double before = is_new() ? first[present - 1]
                                   : std::max(last[present], slowest * first[present]);
    const double falls = is_new() ? FALLS : CONTRACTS;
    if (change > CONVERGED && change > falls * before)
      return change < ROUNDING ? Verdict::CONVERGED : Verdict::JUMPS;
    last[present] = change;
    if (is_new()) {
      known = present;
      first[known] = change;
    } else if (before > 0.0)
      contraction = std::max({contraction == 1.0 ? 0.0 : contraction, change / before, slowest});
    return choose();
  }

 private:
  // the first pair is too far out if its relative error exceeds this
  static constexpr double TOO_FAR = 0.5;
  // for smooth forces errors decrease from pair to pair, and changes decrease in another evaluation
  static constexpr double FALLS = 1.0, CONTRACTS = 0.5;
  // less than the rounding of velocities in a step; and an upper bound for the rounding of forces
  static constexpr double CONVERGED = 1.0e-15, ROUNDING = 1.0e-9;
  // tolerance for the last changes, relative to the truncation error; smaller beyond four pairs,
  // since the highest derivatives multiply errors of the inner pairs, unless there is a spare pair
  static constexpr double ALLOWED = 0.03;
  double allowed_part() const
  {
    return odd || known < 5 ? ALLOWED : std::ldexp(ALLOWED, 3 * (4 - known));
  }
  // limit for the extrapolated errors inside, relative to the error of the last new pair
  static constexpr double CLEAR = 0.5;

  int wanted;    ///< number of values
  bool odd;      ///< odd number of values: one pair more than the order needs
  int most;
  double slowest;
  int present = 1;             ///< pair that is evaluated
  int known = 0;               ///< pairs evaluated at least once
  int round = 0;               ///< last pair of a round that evaluates all pairs again
  double contraction = 1.0;    ///< of a change when a pair is evaluated once more
  double first[MAX_PAIRS + 1] = {HUGE_VAL}, last[MAX_PAIRS + 1] = {};    ///< changes

  /// Truncation error of a polynomial of the method's order: the error at the first pair beyond it.
  double left_out() const
  {
    if (odd || known < 2) return first[known];
    return first[known] * std::min(1.0, first[known] / first[known - 1]);
  }

  /// Continues a round, starts another round, adds a pair, or ends.
  Verdict choose()
  {
    const bool more = known < most && first[known] > CONVERGED;
    const double allowed = more ? 0.0 : std::max(CONVERGED, allowed_part() * left_out());
    while (present < round)
      if (contraction * last[++present] > allowed) return Verdict::GOES_ON;
    const double next = contraction * *std::max_element(last + 1, last + known + 1);
    // extrapolation to the next pair multiplies errors by up to four for each pair inside
    const bool again = more ? round < known && std::ldexp(next, 2 * known) > CLEAR * first[known]
                            : next > allowed;
    if (!again && !more) return Verdict::CONVERGED;
    if (again) {
      round = known;
      present = 0;
      return choose();
    }
    round = 0;
    present = known + 1;
    return Verdict::GOES_ON;
  }
};

/// Result of a start.
struct StartFound {
  StartPlan::Verdict verdict;    ///< CONVERGED or JUMPS; SHORTER_SPACING if there is none
  int pairs = 0;                 ///< of nodes that the polynomial goes through
  double spacing = 0.0;          ///< of the nodes
  double change = 0.0;           ///< the last error seen

  /// The highest known derivative of positions.
  int order() const { return 2 * pairs + 2; }
};

/// The start of all bodies of a host.  The host has
///   void begin(double spacing)             all bodies at the start, no pair known
///   void foretell()                        adds a pair, for all bodies
///   bool visit(int pair, double &change)   forces at both nodes; false if they cannot be evaluated
///   int values_that_do(int values)         sufficient values, at most `values`; after pair 2
template <class Host>
StartFound find_start(int values, double spacing, Host &host, double slowest = 0.0)
{
  using Verdict = StartPlan::Verdict;
  StartFound found = {Verdict::SHORTER_SPACING};
  for (int n = 0; n < StartPlan::MAX_SPACINGS; ++n, spacing *= 0.5) {
    StartPlan plan(values, slowest);
    host.begin(spacing);
    found.spacing = spacing;
    do {
      if (plan.is_new()) host.foretell();
      const bool visited = host.visit(plan.pair(), found.change);
      if (visited && plan.is_new() && plan.pair() == 2) plan.limit(host.values_that_do(values));
      found.verdict = visited ? plan.take(found.change) : Verdict::SHORTER_SPACING;
    } while (found.verdict == Verdict::GOES_ON);
    found.pairs = plan.pairs();
    if (found.verdict != Verdict::SHORTER_SPACING) break;
  }
  return found;
}

/* ---------------------------------------------------------------------- */

/// Taylor series of one body's x (columns 0-2) and q (columns 3-6) in units of a step, and of its
/// angular momentum times the step, along the axes of space.
struct TaylorSeries {
  static constexpr int MAX_TERMS = MAX_VALUES + 3;
  int terms = 0;
  double c[MAX_TERMS][7];
  Turn::Momentum momentum;

  /// After a collocation more than of x, because L determines them.
  int terms_of_q() const { return terms > 3 ? MAX_TERMS : terms; }
};

/// The three terms determined by a state and its load, in units of the step h.
inline TaylorSeries local_series(const RigidBody &body, const BodyState &state, const Load &load,
                                 double h)
{
  TaylorSeries series;
  series.terms = 3;
  double omegadot_body[3], qdot[4], qddot[4];
  angular_acceleration(body, state, dot4(state.q, state.q), load, omegadot_body);
  quaternion_rate(state.q, state.omega_body, qdot);
  quaternion_acceleration(state.q, qdot, omegadot_body, qddot);
  momentum_along_space(body, state, series.momentum[0]);
  for (int i = 0; i < 3; ++i) {
    series.momentum[0][i] *= h;
    series.momentum[1][i] = h * h * load.torque_space[i];
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

/// Fills all rows of a history from a series in units of `series_step`; rows without a known term
/// are zero.  Momenta and angular velocities of the first-order form are derivatives of the series.
inline void seed(const Scheme &scheme, const RigidBody &body, const TaylorSeries &series,
                 double series_step, double h, double *rows)
{
  const int n = scheme.values(), width = scheme.width(), quat = scheme.quaternion();
  const double ratio = h / series_step;
  for (int i = 0; i < scheme.size(); ++i) rows[i] = 0.0;

  double power = 1.0;
  for (int j = 0; j < n && j < series.terms_of_q(); ++j, power *= ratio) {
    double *row = rows + j * width;
    const bool known = j < series.terms;
    for (int i = 0; i < 3 && known; ++i) row[Scheme::POSITION + i] = power * series.c[j][i];
    if (!scheme.momentum() || j == 0)
      for (int i = 0; i < 4; ++i) row[quat + i] = power * series.c[j][3 + i];
    else if (known)
      for (int i = 0; i < 3; ++i)
        row[Scheme::ANGULAR_MOMENTUM + i] = power / j * series.momentum[j - 1][i];
  }
  if (!scheme.first()) return;

  // p = m x' and omega = 2 W(q)^T q', term by term

  power = 1.0 / series_step;
  for (int j = 0; j < n && j + 1 < series.terms_of_q(); ++j, power *= ratio) {
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

/// Collocation for a body or a scalar; the tables of the object are common to all.
class Collocation {
 public:
  static constexpr int MAX_HALF = StartPlan::MAX_PAIRS;
  static constexpr int MAX_NODES = 2 * MAX_HALF + 1;

  /// A function with WIDTH components and an equation of this ORDER: its exact start, and the
  /// derivatives of that order at the nodes.  Both are in the units of the host; for a body, time is
  /// in node spacings.
  template <int WIDTH, int ORDER> struct Nodes {
    int pairs;                        ///< of nodes that the polynomial goes through
    double start[ORDER][WIDTH];       ///< the function, and its first derivative if ORDER is 2
    double rate[MAX_NODES][WIDTH];    ///< node k in row pairs() + k
    double met[2][WIDTH];             ///< at the two nodes that are being evaluated
  };
  /// x of a body in columns 0-2; columns 3-5 have the integral of its angular momentum.
  struct Workspace : Nodes<6, 2> {
    RigidBody body;
    double q[4];    ///< at the start
  };
  using Scalar = Nodes<1, 1>;

  /// Uses the number of nodes required by the order of a history with `values` rows.
  explicit Collocation(int values) : half(StartPlan::pairs_for(values)), polynomial(half + 1)
  {
    for (int pairs = 0; pairs <= half; ++pairs) polynomial[pairs].make(pairs);
  }

  /// Number of nodes on each side of the start.  The forces at the start itself are already known.
  int pairs() const { return half; }

  /// Begins without pairs: with constant second derivatives, taken from `series` (at least three
  /// terms, in units of the node spacing).
  void begin(const RigidBody &body, const TaylorSeries &series, Workspace &w) const
  {
    w.pairs = 0;
    w.body = body;
    std::copy_n(series.c[0] + 3, 4, w.q);
    for (int i = 0; i < 3; ++i) {
      w.start[0][i] = series.c[0][i];
      w.start[1][i] = series.c[1][i];
      w.rate[half][i] = 2.0 * series.c[2][i];
      w.start[0][3 + i] = 0.0;
      w.start[1][3 + i] = series.momentum[0][i];
      w.rate[half][3 + i] = series.momentum[1][i];
    }
  }

  /// Begins for any functions: their values, first and second derivatives.
  template <int WIDTH>
  void begin(const double *value, const double *first, const double *second,
             Nodes<WIDTH, 2> &w) const
  {
    w.pairs = 0;
    std::copy_n(value, WIDTH, w.start[0]);
    std::copy_n(first, WIDTH, w.start[1]);
    std::copy_n(second, WIDTH, w.rate[half]);
  }

  /// Starts without pairs: a constant rate.
  void begin(double start, double rate, Scalar &s) const
  {
    s.pairs = 0;
    s.start[0][0] = start;
    s.rate[half][0] = rate;
  }

  /// Adds a pair, with the rates of the present polynomial.
  template <int WIDTH, int ORDER> void foretell(Nodes<WIDTH, ORDER> &w) const
  {
    const Polynomial &inside = polynomial[w.pairs];
    const int next = w.pairs + 1;
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < WIDTH; ++i) {
        double sum = 0.0;
        for (int l = -w.pairs; l <= w.pairs; ++l)
          sum += inside.beyond[side][column_of(l)] * w.rate[half + l][i];
        w.rate[half + (side ? next : -next)][i] = sum;
      }
    w.pairs = next;
  }

  /// Functions and their first derivatives at a known node by the present polynomial.
  template <int WIDTH>
  void values_at(int node, const Nodes<WIDTH, 2> &w, double *value, double *rate) const
  {
    const Polynomial &present = polynomial[w.pairs];
    for (int i = 0; i < WIDTH; ++i) {
      value[i] = w.start[0][i] + node * w.start[1][i];
      rate[i] = w.start[1][i];
      for (int l = -w.pairs; l <= w.pairs; ++l) {
        value[i] += present.value[column_of(node)][column_of(l)] * w.rate[half + l][i];
        rate[i] += present.rate[column_of(node)][column_of(l)] * w.rate[half + l][i];
      }
    }
  }

  /// State of the body at a known node by the present polynomial; spacing: time between nodes.
  BodyState state_at(int node, const Workspace &w, double spacing) const
  {
    double value[6], rate[6], axes[9];
    values_at(node, w, value, rate);
    BodyState state;
    for (int i = 0; i < 3; ++i) {
      state.center[i] = value[i];
      state.velocity[i] = rate[i] / spacing;
    }
    Turn::Momentum momentum;
    const int terms = momentum_of(w, w.pairs, node, momentum);
    std::copy_n(w.q, 4, state.q);
    Turn(terms).advance(w.body, momentum, state.q);
    rotation_matrix(state.q, 1.0, axes);
    to_body(axes, rate + 3, state.omega_body);
    for (int i = 0; i < 3; ++i)
      state.omega_body[i] *= w.body.inertia[i] > 0.0 ? 1.0 / (spacing * w.body.inertia[i]) : 0.0;
    return state;
  }

  /// Stores the load at a node, until settle().  length: the size of the body.  Returns the change
  /// of the second derivatives there, relative to the first or second derivatives of that body,
  /// whichever are larger; infinite if the load is not finite.
  double set_load(int node, const RigidBody &body, const BodyState &state, const Load &load,
                  double spacing, double length, Workspace &w) const
  {
    double *met = w.met[node > 0], change[6];
    for (int i = 0; i < 3; ++i) {
      met[i] = spacing * spacing * load.force[i] / body.mass;
      met[3 + i] = spacing * spacing * load.torque_space[i];
    }
    for (int i = 0; i < 6; ++i) {
      if (!std::isfinite(met[i])) return std::numeric_limits<double>::infinity();
      change[i] = met[i] - w.rate[half + node][i];
    }
    return relative(change, met, state, length, w);
  }

  /// Stores the rate of a scalar at a node.
  void set_rate(int node, double rate, Scalar &s) const { set_rates(node, &rate, s); }
  /// Stores the rates of any functions at a node.
  template <int WIDTH, int ORDER>
  void set_rates(int node, const double *rates, Nodes<WIDTH, ORDER> &w) const
  {
    std::copy_n(rates, WIDTH, w.met[node > 0]);
  }

  /// The rate at the start; rates at the other nodes are before and after it in memory.
  const double *rate_at_start(const Scalar &s) const { return s.rate[half]; }

  /// Updates the polynomial with both nodes of a pair, treated equally, for time reversibility.
  template <int WIDTH, int ORDER> void settle(int pair, Nodes<WIDTH, ORDER> &w) const
  {
    for (int i = 0; i < WIDTH; ++i) {
      w.rate[half - pair][i] = w.met[0][i];
      w.rate[half + pair][i] = w.met[1][i];
    }
  }

  /// The polynomial through the innermost `pairs` as a series in units of the node spacing.
  TaylorSeries series(const Workspace &w, int pairs) const
  {
    TaylorSeries series;
    double c[TaylorSeries::MAX_TERMS][6], q[Turn::MOST + 1][4];
    series.terms = terms_of(pairs);
    static_assert(MAX_NODES + 2 <= TaylorSeries::MAX_TERMS, "series too short for the nodes");
    expand<6>(w, pairs, c[0]);
    const int terms = momentum_of(w, pairs, 1, series.momentum);
    Turn::coefficients(w.body, series.momentum, terms, w.q, q);
    for (int j = 0; j < TaylorSeries::MAX_TERMS; ++j) {
      for (int i = 0; i < 3; ++i) series.c[j][i] = j < series.terms ? c[j][i] : 0.0;
      std::copy_n(q[j], 4, series.c[j] + 3);
    }
    return series;
  }
  /// The series of any functions: c[WIDTH * j + i] for term j of function i.
  template <int WIDTH> void expand(const Nodes<WIDTH, 2> &w, int pairs, double *c) const
  {
    for (int i = 0; i < WIDTH; ++i) {
      c[i] = w.start[0][i];
      c[WIDTH + i] = w.start[1][i];
      for (int j = 0; j + 2 < terms_of(pairs); ++j)
        c[WIDTH * (j + 2) + i] = double(coefficient(j, i, w, pairs) / ((j + 1) * (j + 2)));
    }
  }
  /// The number of terms of a function with known second derivatives.
  static int terms_of(int pairs) { return 2 * pairs + 3; }
  TaylorSeries series(const Workspace &w) const { return series(w, w.pairs); }

  /// The series of a scalar whose rates are per unit of time, with `spacing` between nodes.
  /// Returns the number of terms, at most MAX_NODES + 1.
  int series(const Scalar &s, int pairs, double spacing, double *c) const
  {
    c[0] = s.start[0][0];
    for (int j = 0; j <= 2 * pairs; ++j)
      c[j + 1] = double(spacing * coefficient(j, 0, s, pairs) / (j + 1));
    return 2 * pairs + 2;
  }

 private:
  /// Motion slower than this part of the body's size (of a radian) in a step is ignored.
  static constexpr double SMALLEST = 1.0e-4;

  /// Column or row of a node in the tables.
  static int column_of(int node) { return MAX_HALF + node; }

  /// The interpolation through the nodes -pairs..pairs.
  struct Polynomial {
    long double monomial[MAX_NODES][MAX_NODES];    ///< coefficient of s^j at node l
    double value[MAX_NODES][MAX_NODES];            ///< twice integrated, at node k
    double rate[MAX_NODES][MAX_NODES];             ///< once integrated, at node k
    double beyond[2][MAX_NODES];                   ///< at the nodes just outside

    void make(int pairs)
    {
      interpolate(pairs);
      for (int l = -pairs; l <= pairs; ++l) {
        const int column = column_of(l);
        for (int k = -pairs; k <= pairs; ++k) {
          long double twice = 0.0, once = 0.0, power = k;
          for (int j = 0; j <= 2 * pairs; ++j) {
            once += monomial[j][column] * power / (j + 1);
            power *= k;
            twice += monomial[j][column] * power / ((j + 1) * (j + 2));
          }
          value[column_of(k)][column] = double(twice);
          rate[column_of(k)][column] = double(once);
        }
        for (int side = 0; side < 2; ++side) {
          long double sum = 0.0, power = 1.0;
          for (int j = 0; j <= 2 * pairs; ++j, power *= side ? pairs + 1 : -pairs - 1)
            sum += monomial[j][column] * power;
          beyond[side][column] = double(sum);
        }
      }
    }

    /// Lagrange's basis polynomials, multiplied out factor by factor.
    void interpolate(int pairs)
    {
      for (int l = -pairs; l <= pairs; ++l) {
        long double basis[MAX_NODES] = {1.0L};
        long double denominator = 1.0L;
        int degree = 0;
        for (int root = -pairs; root <= pairs; ++root) {
          if (root == l) continue;
          ++degree;
          for (int j = degree; j >= 0; --j)
            basis[j] = (j > 0 ? basis[j - 1] : 0.0L) - root * (j < degree ? basis[j] : 0.0L);
          denominator *= l - root;
        }
        for (int j = 0; j <= 2 * pairs; ++j) monomial[j][column_of(l)] = basis[j] / denominator;
      }
    }
  };

  int half;
  std::vector<Polynomial> polynomial;    ///< through 0..half pairs

  /// Coefficient of s^j in the polynomial through the innermost `pairs`, component i.
  template <int WIDTH, int ORDER>
  long double coefficient(int j, int i, const Nodes<WIDTH, ORDER> &w, int pairs) const
  {
    long double sum = 0.0;
    for (int l = -pairs; l <= pairs; ++l)
      sum += polynomial[pairs].monomial[j][column_of(l)] * w.rate[half + l][i];
    return sum;
  }

  /// The series of L times `spacings` of the nodes, in units of this time.  Returns its terms.
  int momentum_of(const Workspace &w, int pairs, double spacings, Turn::Momentum &found) const
  {
    double c[TaylorSeries::MAX_TERMS][6], power = spacings;
    expand<6>(w, pairs, c[0]);
    const int terms = terms_of(pairs) - 1;
    for (int k = 0; k < terms; ++k, power *= spacings)
      for (int i = 0; i < 3; ++i) found[k][i] = power * (k + 1) * c[k + 1][3 + i];
    return terms;
  }

  static double relative(const double *change, const double *second, const BodyState &state,
                         double length, const Workspace &w)
  {
    double part[2] = {0.0, 0.0}, scale[2] = {SMALLEST * length, SMALLEST}, axes[9];
    rotation_matrix(state.q, dot4(state.q, state.q), axes);
    for (int p = 0; p < 2; ++p) {
      double of[3][3];
      const double *from[] = {change + 3 * p, w.start[1] + 3 * p, second + 3 * p};
      for (int k = 0; k < 3; ++k)
        p == 0 ? (void) std::copy_n(from[k], 3, of[k]) : to_body(axes, from[k], of[k]);
      for (int i = 0; i < 3; ++i) {
        const double unit = p == 0 ? 1.0 : w.body.inertia[i] > 0.0 ? 0.5 / w.body.inertia[i] : 0.0;
        part[p] = std::max(part[p], unit * std::fabs(of[0][i]));
        scale[p] = std::max({scale[p], unit * std::fabs(of[1][i]), unit * std::fabs(of[2][i])});
      }
    }
    return std::max(part[0] / scale[0], part[1] / scale[1]);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
