/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A sum that does not depend on the order of its terms, nor on how they are spread over ranks:
   integers in units of 2^-73 of a scale that all terms share.  A term is rounded to that; the sum
   of up to 2^31 terms is exact otherwise, while it stays below 2^20 scales.

   Every rank adds its terms; the host adds `limbs` of all ranks, number by number, and asks for
   value(). */

#ifndef GEAR_QUAT_EXACT_SUM_H
#define GEAR_QUAT_EXACT_SUM_H

#include <cmath>
#include <cstdint>

namespace LAMMPS_NS::GearQuat {

struct ExactSum {
  std::int64_t limbs[2] = {0, 0};    ///< in units of 2^-42 and 2^-73 of the scale

  /// The power of two above a positive number: a scale that depends on nothing else.
  static double scale_of(double number)
  {
    int exponent;
    std::frexp(number, &exponent);
    return std::ldexp(1.0, exponent);
  }

  /// A term that is too large, or no number, makes the sum that large.
  void add(double term, double scale)
  {
    double units = term * (UPPER / scale);
    if (!(std::fabs(units) < LARGEST)) units = LARGEST;
    const auto whole = (std::int64_t) units;
    const double rest = (units - (double) whole) * LOWER;
    limbs[0] += whole;
    limbs[1] += (std::int64_t)(rest + std::copysign(0.5, rest));
  }

  double value(double scale) const
  {
    return (double(limbs[0]) + double(limbs[1]) / LOWER) / UPPER * scale;
  }

 private:
  static constexpr double LOWER = 2147483648.0;           ///< 2^31
  static constexpr double UPPER = 2048.0 * LOWER;         ///< 2^42
  static constexpr double LARGEST = UPPER * 1048576.0;    ///< 2^62
};

}    // namespace LAMMPS_NS::GearQuat

#endif
