/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Quaternions of any length, in the second-order formulation.

   A projection onto |q| = 1 after each step changes only rows 0 and 1 of a history.  This
   projection makes the method irreversible, and causes half of the energy drift at long steps.
   With Scheme::any_norm() there is no projection: the equation of q is valid for any length
   (gear_quat_math.h), a weak spring keeps the length close to 1, and sites use q/|q|.  Three
   measures are required:

     - residuals use the predicted pose, at which the torque was evaluated;
     - passes are repeated until the residual converges, unless their number is given;
     - a body that turns fast is unstable in this equation.  Between two speeds of rotation, in
       radians per step, Eq. 6 with its projection gradually replaces it; for faster rotation Eq. 6
       is used alone, with its two passes.  Five values need no replacement. */

#ifndef GEAR_QUAT_ANY_NORM_H
#define GEAR_QUAT_ANY_NORM_H

#include "gear_quat_history.h"

#include <algorithm>
#include <cmath>

namespace LAMMPS_NS::GearQuat {

class AnyNorm {
 public:
  explicit AnyNorm(const Scheme &scheme) : on(scheme.any_norm()), repeats(scheme.passes == 0)
  {
    if (scheme.values() == 3) {
      slow = 0.4;
      fast = 0.6;
    } else if (scheme.values() == 7) {
      slow = 0.2;
      fast = 0.3;
    } else if (scheme.values() == 9) {
      slow = 0.16;
      fast = 0.22;
    }
  }

  static constexpr double STIFFNESS = 0.2 * 0.2;    ///< of the spring for |q|, times h^2

  /// The part of the right-hand side that is Eq. 6; 1: all of it.  rows: predicted.
  double projected_part(const double *rows) const
  {
    if (!on) return 1.0;
    const double *rates = rows + Scheme::SECOND_WIDTH + Scheme::SECOND_QUATERNION;
    const double turn2 = 4.0 * dot4(rates, rates);
    if (turn2 <= slow * slow) return 0.0;
    return std::min(1.0, (std::sqrt(turn2) - slow) / (fast - slow));
  }

  /// True if passes are repeated.
  bool converges(double part) const { return repeats && part < 1.0; }

  /// Calls pass(), which computes the residual `total`, until it converges or changes by more than
  /// before.
  template <class Pass> static void repeat(double part, const double *total, Pass pass)
  {
    const int fewest = part > 0.0 ? FEWEST_OF_FAST : FEWEST;
    double before[4], change[4], last = HUGE_VAL;
    for (int k = 1; k < fewest; ++k) pass();
    for (int k = fewest; k <= MOST; ++k) {
#pragma GCC unroll 4
      for (int i = 0; i < 4; ++i) before[i] = total[i];
      pass();
#pragma GCC unroll 4
      for (int i = 0; i < 4; ++i) change[i] = total[i] - before[i];
      const double now = dot4(change, change);
      if (now <= CHANGE * CHANGE * dot4(total, total) || !(now < last)) return;
      last = now;
    }
  }

  /// The square of a residual without its radial part, which is no rotation; q: predicted.
  double turning2(const double *total, const double *q) const
  {
    const double radial = on ? dot4(q, total) : 0.0;
    return dot4(total, total) - radial * radial / dot4(q, q);
  }

  /// Changes of rows 0 and 1 by the projection where both equations contribute.  While the
  /// projection of Eq. 6 is small, rates are scaled like q, which preserves the angular velocity.
  static void projection(double part, const double *q, const double *rates, double *of_q,
                         double *of_rates)
  {
    const double norm2 = dot4(q, q), norm = std::sqrt(norm2);
    const double missing = part * (1.0 - norm2) / (norm * (1.0 + norm));
    const double radial = part * dot4(q, rates) / norm2;
    for (int i = 0; i < 4; ++i) {
      of_q[i] = missing * q[i];
      of_rates[i] = (1.0 - part) * missing * rates[i] - radial * q[i];
    }
  }

 private:
  static constexpr int FEWEST = 2, FEWEST_OF_FAST = 3, MOST = 8;    ///< passes
  static constexpr double CHANGE = 1.0e-3;    ///< of a converged residual, as a part of it

  bool on, repeats;
  double slow = HUGE_VAL, fast = HUGE_VAL;    ///< radians per step
};

}    // namespace LAMMPS_NS::GearQuat

#endif
