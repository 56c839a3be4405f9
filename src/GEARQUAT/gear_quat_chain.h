/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A Nose-Hoover chain: a thermostat of M variables xi_k (1/time), of which the first is the
   friction of all momenta that it acts on (doc/theory.md, Eqs. T1 to T4):

     p' = F - xi_1 p,   L' = tau - xi_1 L                                                     (T1)
     xi_1' = (2K/(g kT) - 1)/tau^2 - xi_1 xi_2                                                (T2)
     xi_2' = g xi_1^2 - 1/tau^2 - xi_2 xi_3
     xi_k' = xi_(k-1)^2 - 1/tau^2 - xi_k xi_(k+1)          k > 2, without the last term for k = M

   with the kinetic energy K of g degrees of freedom, and the masses Q_1 = g kT tau^2,
   Q_k = kT tau^2 of the fixes nvt and rigid/nvt.  Potential energy + K + E is constant, where

     E = sum_k Q_k xi_k^2/2 + S                                                               (T3)
     S' = kT (g xi_1 + xi_2 + ... + xi_M) - (sum_k Q_k xi_k^2/2) T'/T                         (T4)

   also while the target T and with it the masses change.
   Sources: G. J. Martyna, M. L. Klein, M. Tuckerman, J. Chem. Phys. 97, 2635 (1992), section II,
   where p_eta_k = Q_k xi_k; the masses: G. J. Martyna, M. E. Tuckerman, D. J. Tobias, M. L. Klein,
   Mol. Phys. 87, 1117 (1996), section 2.5.  A chain of a single variable is that of W. G. Hoover,
   Phys. Rev. A 31, 1695 (1985), after S. Nose, J. Chem. Phys. 81, 511 (1984).

   The variables xi_1 ... xi_M and S have histories of n rows, and behind them the trial row of
   gear_quat_step_control.h.  The host calls, for the start: rates(), and seed() for every variable;
   once a step predict(), correct() in every pass, with the kinetic energy that is known then, and
   conclude(); where step or number of values change rescale() and set_values(); and where degrees
   of freedom come or go replace_target(). */

#ifndef GEAR_QUAT_CHAIN_H
#define GEAR_QUAT_CHAIN_H

#include "gear_quat_nordsieck.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace LAMMPS_NS::GearQuat {

/// What a chain aims at.
struct ChainTarget {
  double kt = 0.0;         ///< Boltzmann's constant * temperature
  double kt_rate = 0.0;    ///< its derivative in time
  double freedoms = 0.0;
  double period = 0.0;    ///< tau
};

class Chain {
 public:
  static constexpr int LONGEST = 10;    ///< most variables xi
  static constexpr int MOST = LONGEST + 1;
  using Variables = std::array<double, MOST>;    ///< xi_1 ... xi_M, S

  explicit Chain(int length) : length(length) {}

  /// Of variables: xi and S.
  int size() const { return length + 1; }
  double friction() const { return rows[0][0]; }
  /// The present values.
  Variables values() const
  {
    Variables y = {};
    for (int v = 0; v < size(); ++v) y[v] = rows[v][0];
    return y;
  }

  /// Eqs. T2 and T4 at y; without degrees of freedom nothing moves.
  Variables rates(const ChainTarget &target, double twice_kinetic, const Variables &y) const
  {
    Variables rate = {};
    if (target.freedoms <= 0.0) return rate;
    const double per_period2 = 1.0 / (target.period * target.period);
    double sum = target.freedoms * y[0];
    for (int k = 0; k < length; ++k) {
      const double pushed = k == 0 ? twice_kinetic / (target.freedoms * target.kt) * per_period2
          : k == 1                 ? target.freedoms * y[0] * y[0]
                                   : y[k - 1] * y[k - 1];
      rate[k] = pushed - per_period2 - (k + 1 < length ? y[k] * y[k + 1] : 0.0);
      if (k > 0) sum += y[k];
    }
    rate[length] = target.kt * sum - moving(target, y) * target.kt_rate / target.kt;
    return rate;
  }

  /// E, Eq. T3: what the chain has taken from the bodies.
  double energy(const ChainTarget &target) const
  {
    return moving(target, values()) + rows[length][0];
  }

  /// Row 0 stays, the others become those of a series of `terms` terms in units of series_step.
  void seed(int variable, const double *series, int terms, double series_step, double h)
  {
    double power = 1.0;
    for (int j = 1; j < MAX_VALUES + 1; ++j) {
      power *= h / series_step;
      rows[variable][j] = j < terms ? power * series[j] : 0.0;
    }
  }

  /// To t + h, with n rows.
  void predict(int n)
  {
    for (int v = 0; v < size(); ++v) {
      last[v] = rows[v][n - 1];
      Nordsieck<1>::predict(rows[v], n);
    }
  }

  /// One pass: the residuals of Eqs. T2 and T4 at the present values and this kinetic energy.
  void correct(const ChainTarget &target, double twice_kinetic, double h, int n,
               const double *coefficients)
  {
    const Variables rate = rates(target, twice_kinetic, values());
    for (int v = 0; v < size(); ++v) {
      const double residual = h * rate[v] - rows[v][1];
      Nordsieck<1>::correct<1>(rows[v], n, coefficients, 0, &residual);
    }
  }

  /// The step is complete: the trial row n from the change of the last row.
  void conclude(int n)
  {
    for (int v = 0; v < size(); ++v) {
      const double trial = (rows[v][n - 1] - last[v]) / n;
      change[v] = trial - rows[v][n];
      rows[v][n] = trial;
    }
  }

  /// The largest of the variables xi in rows n - 1 and n (1/time), and how much row n changed in
  /// the step; after conclude().
  struct HighRows {
    double last = 0.0, trial = 0.0, change = 0.0;
  };
  HighRows high_rows(int n) const
  {
    HighRows largest;
    for (int k = 0; k < length; ++k) {
      largest.last = std::max(largest.last, std::fabs(rows[k][n - 1]));
      largest.trial = std::max(largest.trial, std::fabs(rows[k][n]));
      largest.change = std::max(largest.change, std::fabs(change[k]));
    }
    return largest;
  }

  /// Degrees of freedom have changed: E and all xi stay, and the first derivatives become those of
  /// the new target and kinetic energy.
  void replace_target(const ChainTarget &before, const ChainTarget &target, double twice_kinetic,
                      double h)
  {
    const Variables y = values(), rate = rates(target, twice_kinetic, y);
    for (int v = 0; v < size(); ++v) rows[v][1] = h * rate[v];
    rows[length][0] += moving(before, y) - moving(target, y);
  }

  /// Rows and trial row for another step.
  void rescale(double ratio)
  {
    for (int v = 0; v < size(); ++v) Nordsieck<1>::rescale(rows[v], MAX_VALUES + 1, ratio);
  }

  /// Of n rows from now on: the row behind them is the trial row.
  void set_values(int n)
  {
    for (int v = 0; v < size(); ++v) std::fill(rows[v] + n + 1, rows[v] + MAX_VALUES + 1, 0.0);
  }

  /// All rows, for restart files.
  using Record = std::array<double, MOST *(MAX_VALUES + 1)>;
  Record record() const
  {
    Record all;
    std::copy_n(rows[0], all.size(), all.begin());
    return all;
  }
  void restore(const Record &all) { std::copy_n(all.begin(), all.size(), rows[0]); }

 private:
  int length;
  double rows[MOST][MAX_VALUES + 1] = {};
  double last[MOST] = {};      ///< last rows before the step
  double change[MOST] = {};    ///< of trial rows in the step

  /// sum_k Q_k xi_k^2/2
  double moving(const ChainTarget &target, const Variables &y) const
  {
    double sum = target.freedoms * y[0] * y[0];
    for (int k = 1; k < length; ++k) sum += y[k] * y[k];
    return 0.5 * target.kt * target.period * target.period * sum;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
