/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A sum that does not depend on the order of its terms, nor on their distribution over ranks:
   integers in units of 2^-73 of a scale that all terms share.  Terms are rounded to this unit;
   otherwise the sum of up to 2^31 terms is exact, while it is below 2^20 scales.  Its value is 2^20
   scales if a term is larger or not finite, or if the sum of a rank is larger.

   Every rank adds its terms; the host sums `limbs` over all ranks element by element and calls
   value(). */

#ifndef GEAR_QUAT_EXACT_SUM_H
#define GEAR_QUAT_EXACT_SUM_H

#include <cmath>
#include <cstdint>

namespace LAMMPS_NS::GearQuat {

struct ExactSum {
  static constexpr int LIMBS = 3;
  /// In units of 2^-42 and 2^-73 of the scale; number of overflows.
  std::int64_t limbs[LIMBS] = {};

  /// The power of two above a positive number: a scale that depends on nothing else.
  static double scale_of(double number)
  {
    int exponent;
    std::frexp(number, &exponent);
    return std::ldexp(1.0, exponent);
  }

  void add(double term, double scale)
  {
    const double units = term * (UPPER / scale);
    if (!(std::fabs(units) < LARGEST)) {
      ++limbs[2];
      return;
    }
    const auto whole = (std::int64_t) units;
    const double rest = (units - (double) whole) * LOWER;
    limbs[0] += whole;
    limbs[1] += (std::int64_t)(rest + std::copysign(0.5, rest));
    count_overflow();
  }

  /// Adds the terms of a sum with the same scale.
  void add(const ExactSum &other)
  {
    for (int k = 0; k < LIMBS; ++k) limbs[k] += other.limbs[k];
    count_overflow();
  }

  double value(double scale) const
  {
    if (limbs[2] > 0) return LARGEST / UPPER * scale;
    return (double(limbs[0]) + double(limbs[1]) / LOWER) / UPPER * scale;
  }

 private:
  static constexpr double LOWER = 2147483648.0;           ///< 2^31
  static constexpr double UPPER = 2048.0 * LOWER;         ///< 2^42
  static constexpr double LARGEST = UPPER * 1048576.0;    ///< 2^62

  /// Two numbers below LARGEST can be added without an overflow of the integer.
  void count_overflow()
  {
    if (std::fabs((double) limbs[0]) < LARGEST) return;
    limbs[0] = 0;
    ++limbs[2];
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
