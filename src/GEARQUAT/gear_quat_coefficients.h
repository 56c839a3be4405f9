/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Corrector coefficients in Nordsieck form.

   Row j of a history is y_j = h^j/j! d^j y/dt^j.  After prediction the residual r of the
   differential equation is fed back into every row, y_j += c_j r, with
     first-order equation   r = h y' - y_1           c_1 = 1
     second-order equation  r = h^2/2 y'' - y_2      c_2 = 1 */

#ifndef GEAR_QUAT_COEFFICIENTS_H
#define GEAR_QUAT_COEFFICIENTS_H

#include "gear_quat_history.h"

#include <array>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// gamma_k, the magnitude of the weight of the k-th backward difference in the formulas of Adams
/// and Moulton, k >= 1: sum over i = 0..k of signed weights / (k + 1 - i) vanishes.
long double adams_moulton(int k);

/// Gear's coefficients of a first-order equation, N values; of order N, and of order N + 1 for even
/// N if the motion is slow.
std::vector<long double> first_order_coefficients(int values);

/// Gear's coefficients of a second-order equation, N values. velocity_c0: for right-hand sides that
/// depend on velocities, of order N - 1; otherwise for right-hand sides of positions alone, of order
/// N, and of order N + 1 for even N if the motion is slow.
std::vector<long double> second_order_coefficients(int values, bool velocity_c0);

/// All N tuned coefficients, from SECOND_FEWEST to SECOND_MOST values; empty for other numbers.
std::vector<long double> tuned_coefficients(int values);

/// Coefficients of all columns, and the weight of residuals in the local error.
struct CorrectorCoefficients {
  using Array = std::array<double, MOST_ROWS>;

  Array c = {};            ///< first: of all columns, which have equations of the first order
  double weight2 = 0.0;    ///< of the residuals of positions and quaternions, squared
  double moment = 0.0;    ///< momentum: of the error of the predicted L, see gear_quat_integrator.h

  CorrectorCoefficients() = default;
  /// Throws std::domain_error if the scheme is tuned and has a number of values without a tuned
  /// set.
  explicit CorrectorCoefficients(const Scheme &scheme);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
