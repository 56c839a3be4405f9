/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A Nose-Hoover chain: a thermostat of M variables xi_k (1/time).  The first variable is the
   friction of all momenta that the chain acts on (doc/theory.md, Eqs. T1 to T4):

     p' = F - xi_1 p,   L' = tau - xi_1 L                                                     (T1)
     xi_1' = (2K/(g kT) - 1)/tau^2 - xi_1 xi_2                                                (T2)
     xi_2' = g xi_1^2 - 1/tau^2 - xi_2 xi_3
     xi_k' = xi_(k-1)^2 - 1/tau^2 - xi_k xi_(k+1)          k > 2, without the last term for k = M

   with the kinetic energy K of g degrees of freedom, and the masses Q_1 = g kT tau^2 and Q_k = kT
   tau^2 of the fixes nvt and rigid/nvt.  Potential energy + K + E is constant, where

     E = sum_k Q_k xi_k^2/2 + S                                                               (T3)
     S' = kT (g xi_1 + xi_2 + ... + xi_M) - (sum_k Q_k xi_k^2/2) T'/T                         (T4)

   even while the target T and thus the masses change.
   Sources: G. J. Martyna, M. L. Klein, M. Tuckerman, J. Chem. Phys. 97, 2635 (1992), section II,
   where p_eta_k = Q_k xi_k; the masses: G. J. Martyna, M. E. Tuckerman, D. J. Tobias, M. L. Klein,
   Mol. Phys. 87, 1117 (1996), section 2.5.  A chain with a single variable: W. G. Hoover,
   Phys. Rev. A 31, 1695 (1985), after S. Nose, J. Chem. Phys. 81, 511 (1984).

   Far from the target, or with many degrees of freedom, xi_2 grows as g xi_1^2: the chain is stiff,
   although the bodies move smoothly.  So only K(t) is interpolated over a step of the bodies, by
   the polynomial through 2K at the end of the step and at the ends of earlier steps.  Eqs. T2 and
   T4 have quadratic right-hand sides, so the Taylor series of their solution under this polynomial
   is a recursion.  It is summed in sub-steps as short as its last terms require.

   For the start, the host calls flow() for the friction at another time, and seed() with the 2K
   there.  In a step it calls advance() with each estimate of 2K, and then conclude().
   When degrees of freedom change, it calls join(). */

#ifndef GEAR_QUAT_CHAIN_H
#define GEAR_QUAT_CHAIN_H

#include "gear_quat_history.h"

#include <array>

namespace LAMMPS_NS::GearQuat {

/// Target of a chain.
struct ChainTarget {
  double kt = 0.0;         ///< Boltzmann's constant * temperature
  double kt_rate = 0.0;    ///< its derivative in time
  double freedoms = 0.0;
  double period = 0.0;    ///< tau
};

/// A polynomial in the time since the present time of a chain, in units of a step.
struct ChainDrive {
  static constexpr int MOST = 2 * ((MOST_ROWS + 1) / 2) + 1;    ///< terms in a start
  int terms = 0;
  std::array<double, MOST> c = {};

  /// Through the values y at the times x, by Newton's divided differences.
  static ChainDrive through(int points, const double *x, const double *y);
};

class Chain {
 public:
  static constexpr int LONGEST = 10;    ///< most variables xi
  static constexpr int MOST = LONGEST + 1;
  using Variables = std::array<double, MOST>;    ///< xi_1 ... xi_M, S
  static constexpr int MOST_SUMS = MOST_ROWS;    ///< stored sums 2K, for the polynomial
  /// A chain with STIFF sub-steps per step is stiff; beyond GIVEN_UP the solution is abandoned.
  static constexpr int STIFF = 4, GIVEN_UP = 200000;
  static constexpr double SETTLING = 10.0;    ///< steps until a stiff chain varies slowly

  explicit Chain(int length) : length(length) {}

  /// Number of variables: xi and S.
  int size() const { return length + 1; }
  /// The friction xi_1, and all variables, in the current pass.
  double friction() const { return now[0]; }
  const Variables &values() const { return now; }

  /// E, Eq. T3: the energy that the chain has taken from the bodies.
  double energy(const ChainTarget &target) const { return moving(target, now) + now[length]; }

  /// The solution of Eqs. T2 and T4 with the initial values at the beginning of the step.
  struct Flow {
    Variables y;
    int substeps;    ///< GIVEN_UP: y is not the solution
  };

  /// The variables at the time `until`, in units of the step h, of either sign.  target: at the
  /// beginning of the step.  Without degrees of freedom the variables are constant.
  Flow flow(const ChainTarget &target, const ChainDrive &drive, double h, double until) const;

  /// True if the motion of the chain is unsuitable for the start of histories of bodies: it is
  /// stiff over a step of h, or would be unstable over `steps` steps backwards in time.
  bool is_stiff(const ChainTarget &target, double twice_kinetic, double h, int steps) const;

  /// A stiff chain without a past changes abruptly and then slowly: its motion in the first steps
  /// of h, with a constant 2K, is taken as its past.  E stays zero.
  void begin_settled(const ChainTarget &target, double twice_kinetic, double h);

  /// One pass of a step of h: the variables at its end, where the bodies have 2K = twice_kinetic.
  /// target: at the beginning of the step.  values: of the method.  False if the chain changes too
  /// fast to be followed.
  bool advance(const ChainTarget &target, double twice_kinetic, double h, int values);

  /// Completes the step: the 2K of its last pass becomes the first of the earlier sums.
  void conclude();

  /// For the start.  twice: points to 2K at the present time; the values at `pairs` later and
  /// earlier times of this spacing are after and before it in memory.  `count` earlier sums are
  /// kept; those without a node are extrapolated by the polynomial through all nodes, whose next
  /// difference is zero.
  void seed(const double *twice, int pairs, double spacing, int count);

  /// For a discontinuity of 2K, when bodies were inserted or removed.  E and all xi do not change,
  /// and earlier sums are forgotten.
  void join(const ChainTarget &before, const ChainTarget &target);

  /// Between steps.
  template <class V> void fields(V &v)
  {
    v(now, known, sums, ages);
    if (v.reads()) begun = now;
  }

 private:
  int length;
  Variables begun = {};    ///< at the beginning of the step
  Variables now = {};      ///< in the present pass
  /// The number of sums of times before this step: none but the last after a change of direction.
  int earlier(double h) const { return known > 1 && ages[1] * h < 0.0 ? 1 : known; }
  int known = 0;                                         ///< earlier sums
  std::array<double, MOST_SUMS> sums = {}, ages = {};    ///< 2K, and how long ago
  double latest = 0.0, width = 0.0;                      ///< 2K and length of the present step

  /// sum_k Q_k xi_k^2/2
  double moving(const ChainTarget &target, const Variables &y) const;

  class Series;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
