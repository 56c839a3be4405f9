/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* How strong a friction can be.  A step of h turns the rows of a free body under the constant
   friction xi into others: predict, then add c_j times the residual that Integrator::correct_pass()
   finds.  This map is linear and depends on h xi alone.  While its spectral radius is 1 or less, the
   method is stable.

   And how strong it becomes: far from its target a chain has a friction of several times 1/tau. */

#ifndef GEAR_QUAT_FRICTION_H
#define GEAR_QUAT_FRICTION_H

#include "gear_quat_chain.h"
#include "gear_quat_tuned.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace LAMMPS_NS::GearQuat {

class FrictionLimit {
 public:
  /// h xi that is followed: stable, and not a large part of a momentum in a step.
  static double of(const Scheme &scheme) { return std::min(stable(scheme), ACCURATE); }

  /// The smallest unstable h xi, positive; MOST if there is none below.
  static double stable(const Scheme &scheme)
  {
    const FrictionLimit map(scheme);
    double stable = LEAST;
    while (stable < MOST && !map.grows(stable * RATIO)) stable *= RATIO;
    if (stable >= MOST) return MOST;
    double unstable = stable * RATIO;
    for (int n = 0; n < HALVINGS; ++n) {
      const double middle = 0.5 * (stable + unstable);
      (map.grows(middle) ? unstable : stable) = middle;
    }
    return stable;
  }

  static constexpr double MOST = 4.0, ACCURATE = 0.5;

 private:
  static constexpr double LEAST = 0.02, RATIO = 1.05;
  static constexpr int HALVINGS = 8;
  // powers of the map up to 2^16, which may grow by this if it is stable
  static constexpr int SQUARINGS = 16;
  static constexpr double TRANSIENT = 1.0e6;

  using Matrix = std::array<std::array<double, MAX_VALUES>, MAX_VALUES>;

  const bool first;
  const int n;    ///< rows of momenta, or of velocities
  CorrectorCoefficients c;

  explicit FrictionLimit(const Scheme &scheme) :
      first(scheme.first()), n(scheme.values() - !first), c(scheme)
  {
  }

  /// The rows of a velocity v of the second formulation are (j + 1) times those of a position behind
  /// the first one, divided by h.
  Matrix map(double friction) const
  {
    Matrix a = {};
    const double share = friction * (first ? c.driven[0] : 0.5 * c.driven[1]);
    for (int column = 0; column < n; ++column) {
      double predicted[MAX_VALUES];
      for (int j = 0; j < n; ++j) predicted[j] = j > column ? 0.0 : binomial(column, j);
      const double residual = (-friction * predicted[0] - predicted[1]) / (1.0 + share);
      for (int j = 0; j < n; ++j) {
        const double feeds = first ? c.driven[j] : 0.5 * (j + 1) * c.driven[j + 1];
        a[j][column] = predicted[j] + feeds * residual;
      }
    }
    return a;
  }

  static double binomial(int n, int k)
  {
    double product = 1.0;
    for (int i = 0; i < k; ++i) product *= double(n - i) / (i + 1);
    return product;
  }

  bool grows(double friction) const
  {
    Matrix a = map(friction);
    for (int k = 0; k < SQUARINGS; ++k) {
      Matrix square = {};
      for (int i = 0; i < n; ++i)
        for (int l = 0; l < n; ++l)
          for (int j = 0; j < n; ++j) square[i][j] += a[i][l] * a[l][j];
      a = square;
      double largest = 0.0;
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) largest = std::max(largest, std::fabs(a[i][j]));
      if (largest > TRANSIENT) return true;
      if (largest < 1.0e-3) return false;
    }
    return false;
  }
};

/// The largest |xi_1| (1/time) that a chain of a single variable reaches with an ideal gas, from its
/// first integral (xi tau)^2 + f - ln f with f = 2K/(g kT); longer chains stay below it.
inline double friction_bound(const Chain &chain, const ChainTarget &target, double twice_kinetic)
{
  const double part = twice_kinetic / (target.freedoms * target.kt);
  const double begun = chain.friction() * target.period;
  return std::sqrt(begun * begun + std::max(0.0, part - 1.0 - std::log(part))) / target.period;
}

/// The same of this chain in steps of h, found by a trial of two damping times; infinite if it
/// cannot be followed.  A gas takes up heat only by its kinetic energy, so bodies with a potential
/// energy need no more.
inline double friction_on_trial(Chain chain, const ChainTarget &target, double twice_kinetic,
                                double h)
{
  constexpr int VALUES = 5, PASSES = 2;
  const double size = std::fabs(h);
  double largest = std::fabs(chain.friction());
  for (double time = 0.0; time < 2.0 * target.period; time += size) {
    const double before = chain.friction();
    double twice = twice_kinetic;
    for (int pass = 0; pass < PASSES; ++pass) {
      if (!chain.advance(target, twice, size, VALUES)) return HUGE_VAL;
      twice = twice_kinetic * std::exp(-size * (before + chain.friction()));
    }
    chain.conclude();
    twice_kinetic = twice;
    largest = std::max(largest, std::fabs(chain.friction()));
  }
  return largest;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
