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
   (gear_quat_integrator.h), and the forces there replace those of the polynomial (Picard iteration).
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

#include "gear_quat_integrator.h"

#include <vector>

namespace LAMMPS_NS::GearQuat {

class StartPlan {
 public:
  static constexpr int MAX_PAIRS = (MAX_VALUES + 1) / 2;
  static constexpr int MAX_SPACINGS = 8;    ///< tries, each with half the spacing

  enum class Verdict { GOES_ON, CONVERGED, JUMPS, SHORTER_SPACING };

  /// Pairs of nodes required by the order of a history with this number of rows.
  static int pairs_for(int values) { return (values + 1) / 2; }

  /// slowest: a change becomes smaller at most by this factor in another evaluation.  With a bath
  /// the loads change its variables first, and these change the loads one evaluation later.
  explicit StartPlan(int values, double slowest = 0.0) : wanted(values), slowest(slowest) {}
  static constexpr double COUPLED = 0.1;

  /// Reduces the number of values.
  void limit(int values) { wanted = std::min(wanted, values); }

  /// The pair to be evaluated next, 1..pairs_for(values).
  int pair() const { return present; }
  /// It has to be extrapolated first.
  bool is_new() const { return present > known; }
  /// Pairs in the polynomial; fewer than were evaluated if forces are discontinuous.
  int pairs() const { return known; }

  /// After pair() was evaluated.  change: the largest change of an acceleration in any body,
  /// relative to its motion (Collocation::set_load).
  Verdict take(double change);

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
  // limit for the extrapolated errors inside, relative to the error of the last new pair
  static constexpr double CLEAR = 0.5;

  int wanted;    ///< number of values; an odd one has one pair more than the order needs
  double slowest;
  int present = 1;             ///< pair that is evaluated
  int known = 0;               ///< pairs evaluated at least once
  int round = 0;               ///< last pair of a round that evaluates all pairs again
  double contraction = 1.0;    ///< of a change when a pair is evaluated once more
  double first[MAX_PAIRS + 1] = {HUGE_VAL}, last[MAX_PAIRS + 1] = {};    ///< changes

  /// Truncation error of a polynomial of the method's order: the error at the first pair beyond it.
  double left_out() const;

  /// Continues a round, starts another round, adds a pair, or ends.
  Verdict choose();
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
TaylorSeries local_series(const RigidBody &body, const BodyState &state, const Load &load,
                          double h);

/// Fills all rows of a history from a series in units of `series_step`; rows without a known term
/// are zero.  Momenta and angular velocities of the first-order form are derivatives of the series.
void seed(const Scheme &scheme, const RigidBody &body, const TaylorSeries &series,
          double series_step, double h, double *rows);

/// Collocation for a body or a scalar; the tables of the object are common to all.
class Collocation {
 public:
  static constexpr int MAX_HALF = StartPlan::MAX_PAIRS;
  static constexpr int MAX_NODES = 2 * MAX_HALF + 1, WIDTH = 6;

  /// Functions with equations of the first or second order: their exact start, and the derivatives
  /// of that order at the nodes.  Both are in the units of the host; for a body, time is in node
  /// spacings.
  struct Nodes {
    int width = WIDTH;                ///< number of functions
    int pairs;                        ///< of nodes that the polynomial goes through
    double start[2][WIDTH];           ///< the functions; of the second order, the first derivatives
    double rate[WIDTH][MAX_NODES];    ///< node k in column pairs() + k
    double met[2][WIDTH];             ///< at the two nodes that are being evaluated
  };
  /// x of a body in rows 0-2; rows 3-5 have the integral of its angular momentum.
  struct Workspace : Nodes {
    RigidBody body;
    double q[4];    ///< at the start
  };
  /// A function with an equation of the first order.
  using Scalar = Nodes;

  /// Uses the number of nodes required by the order of a history with `values` rows.
  explicit Collocation(int values);

  /// Number of nodes on each side of the start.  The forces at the start itself are already known.
  int pairs() const { return half; }

  /// Begins without pairs: with constant second derivatives, taken from `series` (at least three
  /// terms, in units of the node spacing).
  void begin(const RigidBody &body, const TaylorSeries &series, Workspace &w) const;

  /// Begins for six functions: their values, first and second derivatives.
  void begin(const double *value, const double *first, const double *second, Nodes &w) const;

  /// Starts without pairs: a constant rate.
  void begin(double start, double rate, Scalar &s) const;

  /// Adds a pair, with the rates of the present polynomial.
  void foretell(Nodes &w) const;

  /// Functions of the second order and their first derivatives at a known node by the present
  /// polynomial.
  void values_at(int node, const Nodes &w, double *value, double *rate) const;

  /// State of the body at a known node by the present polynomial; spacing: time between nodes.
  BodyState state_at(int node, const Workspace &w, double spacing) const;

  /// Stores the load at a node, until settle().  length: the size of the body.  Returns the change
  /// of the second derivatives there, relative to the first or second derivatives of that body,
  /// whichever are larger; infinite if the load is not finite.
  double set_load(int node, const RigidBody &body, const BodyState &state, const Load &load,
                  double spacing, double length, Workspace &w) const;

  /// Stores the rates of any functions at a node.
  void set_rates(int node, const double *rates, Nodes &w) const
  {
    std::copy_n(rates, w.width, w.met[node > 0]);
  }
  void set_rate(int node, double rate, Scalar &s) const { set_rates(node, &rate, s); }

  /// The rate at the start; rates at the other nodes are before and after it in memory.
  const double *rate_at_start(const Scalar &s) const { return s.rate[0] + half; }

  /// Updates the polynomial with both nodes of a pair, treated equally, for time reversibility.
  void settle(int pair, Nodes &w) const;

  /// The polynomial through the innermost `pairs` as a series in units of the node spacing.
  TaylorSeries series(const Workspace &w, int pairs) const;
  /// The series of six functions of the second order: c[6 j + i] for term j of function i.
  void expand(const Nodes &w, int pairs, double *c) const;
  /// The number of terms of a function with known second derivatives.
  static int terms_of(int pairs) { return 2 * pairs + 3; }
  TaylorSeries series(const Workspace &w) const { return series(w, w.pairs); }

  /// The series of a scalar whose rates are per unit of time, with `spacing` between nodes.
  /// Returns the number of terms, at most MAX_NODES + 1.
  int series(const Scalar &s, int pairs, double spacing, double *c) const;

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

    void make(int pairs);
  };

  int half;
  std::vector<Polynomial> polynomial;    ///< through 0..half pairs

  /// Coefficient of s^j in the polynomial through the innermost `pairs`, component i.
  long double coefficient(int j, int i, const Nodes &w, int pairs) const;

  /// The series of L times `spacings` of the nodes, in units of this time.  Returns its terms.
  int momentum_of(const Workspace &w, int pairs, double spacings, Turn::Momentum &found) const;

  static double relative(const double *change, const double *second, const BodyState &state,
                         double length, const Workspace &w);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
