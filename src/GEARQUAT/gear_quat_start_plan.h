/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Which pair of nodes of the start (gear_quat_startup.h) is evaluated next, and when enough is
   known.

   Pairs are added outwards.  Where the polynomial through 1..m-1 foretells the accelerations at
   pair m, it errs by e_m, which falls by about z^2 from pair to pair if forces are smooth, with z
   the angle that the fastest motion turns in a spacing.  Before a pair is added, those inside are
   evaluated once more with the polynomial that has become better:

     1 | 1 2 | 1 2 3 | 1 2 3 4

   Each further round gains two orders of the spacing.  An evaluation is left out if the change that
   the contraction seen so far lets expect lies below the tolerance.

   Where e_m does not fall, forces are no polynomial at this scale: they jump, as at a cutoff, and
   the pairs inside m hold all that a polynomial can tell. */

#ifndef GEAR_QUAT_START_PLAN_H
#define GEAR_QUAT_START_PLAN_H

#include "gear_quat_coefficients.h"

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS::GearQuat {

class StartPlan {
 public:
  static constexpr int MAX_PAIRS = (MAX_VALUES + 1) / 2;
  static constexpr int MAX_SPACINGS = 8;    ///< that are tried, each half of the one before

  enum class Verdict { GOES_ON, CONVERGED, JUMPS, SHORTER_SPACING };

  /// Pairs of nodes that the order of a history of so many rows needs.
  static int pairs_for(int values) { return (values + 1) / 2; }

  explicit StartPlan(int values) : odd(values % 2), most(pairs_for(values)) {}

  /// The pair to be evaluated next, 1..pairs_for(values).
  int pair() const { return present; }
  /// It has to be foretold first.
  bool is_new() const { return present > known; }
  /// Pairs that the polynomial goes through; fewer than were evaluated where forces jump.
  int pairs() const { return known; }

  /// After pair() was evaluated.  change: the largest change of an acceleration there in any body,
  /// relative to its motion (Collocation::set_load).
  Verdict take(double change)
  {
    if (!std::isfinite(change) || (present == 1 && change > TOO_FAR))
      return Verdict::SHORTER_SPACING;
    const double before = is_new() ? first[present - 1] : last[present];
    const double falls = is_new() ? FALLS : CONTRACTS;
    if (change > CONVERGED && change > falls * before)
      return change < ROUNDING ? Verdict::CONVERGED : Verdict::JUMPS;
    last[present] = change;
    if (is_new()) {
      known = present;
      first[known] = change;
    } else if (before > 0.0)
      contraction = std::max(contraction == 1.0 ? 0.0 : contraction, change / before);
    return choose();
  }

 private:
  // a first pair that is missed by more than this part of the motion is too far out
  static constexpr double TOO_FAR = 0.5;
  // smooth forces are missed by less from pair to pair, and change by less when evaluated once more
  static constexpr double FALLS = 1.0, CONTRACTS = 0.5;
  // less than rounding takes from velocities in a step; and the rounding of forces, at most
  static constexpr double CONVERGED = 1.0e-15, ROUNDING = 1.0e-9;
  // the last changes, as a part of what the polynomial leaves out; beyond four pairs less, for the
  // highest derivatives multiply what the pairs inside are off by, unless there is a pair to spare
  static constexpr double ALLOWED = 0.03;
  double allowed_part() const
  {
    return odd || known < 5 ? ALLOWED : std::ldexp(ALLOWED, 3 * (4 - known));
  }
  // errors inside, as they are extrapolated, as a part of what the last new pair was missed by
  static constexpr double CLEAR = 0.5;

  const bool odd;    ///< number of values: one pair more than the order needs
  const int most;
  int present = 1;             ///< pair that is evaluated
  int known = 0;               ///< pairs evaluated at least once
  int round = 0;               ///< last pair of a round that evaluates all pairs anew
  double contraction = 1.0;    ///< of a change when a pair is evaluated once more
  double first[MAX_PAIRS + 1] = {HUGE_VAL}, last[MAX_PAIRS + 1] = {};    ///< changes

  /// What a polynomial of the method's order leaves out: by that much the first pair beyond it
  /// would be missed.
  double left_out() const
  {
    if (odd || known < 2) return first[known];
    return first[known] * std::min(1.0, first[known] / first[known - 1]);
  }

  /// The rest of a round, another round, one more pair, or the end.
  Verdict choose()
  {
    const bool more = known < most && first[known] > CONVERGED;
    const double allowed = more ? 0.0 : std::max(CONVERGED, allowed_part() * left_out());
    while (present < round)
      if (contraction * last[++present] > allowed) return Verdict::GOES_ON;
    const double next = contraction * *std::max_element(last + 1, last + known + 1);
    // extrapolation to the next pair makes errors up to four times larger for each pair inside
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

/// A start that was found.
struct StartFound {
  StartPlan::Verdict verdict;    ///< CONVERGED or JUMPS; SHORTER_SPACING if there is none
  int pairs = 0;                 ///< of nodes that the polynomial goes through
  double spacing = 0.0;          ///< of the nodes
  double change = 0.0;           ///< the last one seen

  /// The highest derivative of positions that is known.
  int order() const { return 2 * pairs + 2; }
};

/// The start of all bodies of a host.  The host has
///   void begin(double spacing)             all bodies at the start, no pair known
///   void foretell()                        one pair more, for all bodies
///   bool visit(int pair, double &change)   forces at both nodes of the pair; false if they cannot
///                                          be evaluated there
template <class Host> StartFound find_start(int values, double spacing, Host &host)
{
  using Verdict = StartPlan::Verdict;
  StartFound found = {Verdict::SHORTER_SPACING};
  for (int n = 0; n < StartPlan::MAX_SPACINGS; ++n, spacing *= 0.5) {
    StartPlan plan(values);
    host.begin(spacing);
    found.spacing = spacing;
    do {
      if (plan.is_new()) host.foretell();
      found.verdict = host.visit(plan.pair(), found.change) ? plan.take(found.change)
                                                            : Verdict::SHORTER_SPACING;
    } while (found.verdict == Verdict::GOES_ON);
    found.pairs = plan.pairs();
    if (found.verdict != Verdict::SHORTER_SPACING) break;
  }
  return found;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
