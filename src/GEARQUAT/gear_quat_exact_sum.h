/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A sum that does not depend on the order of its terms, nor on their distribution over ranks: of
   integers in doubles.  All terms share a scale, a power of two.  A term is divided into multiples
   of 2^-33, 2^-55 and 2^-77 of it, whose sums are exact while they are below 2^53 such units: for up
   to 2^31 terms and sums below 2^20 scales.  What is below 2^-78 is rounded.  Larger sums and terms
   have rounding errors, and what is not finite makes the sum not finite.

   Every rank adds its terms; the host sums `parts` over all ranks element by element, in any order,
   and calls value().  Compilers that treat additions as associative (-ffast-math) undo this. */

#ifndef GEAR_QUAT_EXACT_SUM_H
#define GEAR_QUAT_EXACT_SUM_H

#include "gear_quat_math.h"

#include <cmath>

namespace LAMMPS_NS::GearQuat {

/// T: double, or Lanes for a sum of each lane.
template <class T> struct ExactSumOf {
  static constexpr int PARTS = 3;
  T parts[PARTS] = {};

  /// The power of two above a positive number: a scale that depends on nothing else.
  static double scale_of(double number)
  {
    int exponent;
    std::frexp(number, &exponent);
    return std::ldexp(1.0, exponent);
  }

  GEAR_QUAT_INLINE void add(const T &term, double scale)
  {
    T rest = term;
    double rounds = ROUNDS * scale;    // to multiples of the unit
#pragma GCC unroll 3
    for (int k = 0; k < PARTS; ++k) {
      const T units = (rest + rounds) - rounds;
      parts[k] += units;
      rest -= units;
      rounds *= FINER;
    }
  }

  /// Adds the terms of a sum with the same scale.
  void add(const ExactSumOf &other)
  {
    for (int k = 0; k < PARTS; ++k) parts[k] += other.parts[k];
  }
  /// The same of a lane.
  template <class Other> void add_lane(const Other &other, int lane)
  {
    for (int k = 0; k < PARTS; ++k) parts[k] += get(other.parts[k], lane);
  }

  double value() const
  {
    return parts[0] + (parts[1] + parts[2]);
  }

 private:
  static constexpr double ROUNDS = 1.5 * 524288.0;    ///< 1.5 * 2^(52 - 33)
  static constexpr double FINER = 1.0 / 4194304.0;    ///< 2^-22
};

using ExactSum = ExactSumOf<double>;

}    // namespace LAMMPS_NS::GearQuat

#endif
