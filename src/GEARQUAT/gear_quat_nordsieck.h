/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Nordsieck history of one body: n rows of `width` components, row after row,
   row j = h^j/j! d^j y/dt^j.  Every routine works on one body; loops over bodies live in the caller. */

#ifndef GEAR_QUAT_NORDSIECK_H
#define GEAR_QUAT_NORDSIECK_H

namespace GearQuat {

/// Advance the history by one step: the Taylor series (Eq. 11) as additions of Pascal's triangle.
/// After the call row j holds h^j/j! times the j-th derivative of the same polynomial at t + h.
inline void nordsieck_predict(double *rows, int n, int width)
{
  for (int pass = 0; pass < n - 1; ++pass)
    for (int j = n - 2; j >= pass; --j) {
      double *lower = rows + j * width;
      const double *upper = lower + width;
      for (int c = 0; c < width; ++c) lower[c] += upper[c];
    }
}

/// Feed the residual r of `count` components, the first at `component`, back into every row.
inline void nordsieck_correct(double *rows, int n, int width, const double *coefficients,
                              int component, int count, const double *residual)
{
  for (int j = 0; j < n; ++j) {
    double *row = rows + j * width + component;
    for (int c = 0; c < count; ++c) row[c] += coefficients[j] * residual[c];
  }
}

/// The same polynomial for another step: ratio = new step / old step.
inline void nordsieck_rescale(double *rows, int n, int width, double ratio)
{
  double factor = 1.0;
  for (int j = 1; j < n; ++j) {
    factor *= ratio;
    for (int c = 0; c < width; ++c) rows[j * width + c] *= factor;
  }
}

}    // namespace GearQuat

#endif
