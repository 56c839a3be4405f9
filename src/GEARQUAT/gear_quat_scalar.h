/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A scalar y with the equation y' = rate that is integrated with the bodies: a Nordsieck history
   with the values and coefficients of their momenta.  A bath uses it for variables common to
   all bodies, such as the heat removed by a thermostat. */

#ifndef GEAR_QUAT_SCALAR_H
#define GEAR_QUAT_SCALAR_H

#include "gear_quat_integrator.h"

#include <array>

namespace LAMMPS_NS::GearQuat {

class ScalarHistory {
 public:
  using Rows = std::array<double, MAX_VALUES>;

  double value() const { return rows[0]; }
  void add(double change) { rows[0] += change; }

  /// Sets the derivatives from `terms` terms of a series in units of series_step; the value stays.
  void seed(const double *series, int terms, double series_step, double h, int values)
  {
    double power = 1.0;
    for (int j = 1; j < values; ++j) {
      power *= h / series_step;
      rows[j] = j < terms ? power * series[j] : 0.0;
    }
  }

  /// Changes the step; ratio = new step / old step.
  void rescale(double ratio, int values) { Nordsieck<1>::rescale(rows.data(), values, ratio); }

  /// One step with the coefficients of a first-order equation, to its end, where y' = rate.
  void advance(const double *coefficients, int values, double h, double rate)
  {
    Nordsieck<1>::predict(rows.data(), values);
    const double residual = h * rate - rows[1];
    Nordsieck<1>::correct<1>(rows.data(), values, coefficients, 0, &residual);
  }

  template <class V> void fields(V &v) { v(rows); }

 private:
  Rows rows = {};
};

}    // namespace LAMMPS_NS::GearQuat

#endif
