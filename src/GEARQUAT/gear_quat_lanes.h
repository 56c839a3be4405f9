/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Several bodies side by side, in the vector registers of the processor: a number of type Lanes has
   an element for each of them.  The operations of a body are the same as with numbers of type
   double, and so are the results, in registers of any length.

   A function that is marked GEAR_QUAT_VARIANTS is compiled twice, also for processors with AVX2;
   the variant is chosen when the program is loaded.  What it calls is marked GEAR_QUAT_INLINE. */

#ifndef GEAR_QUAT_LANES_H
#define GEAR_QUAT_LANES_H

#include <cstddef>    // defines __GLIBC__

namespace LAMMPS_NS::GearQuat {

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpsabi"    // no function with such arguments is ever called
constexpr int LANES = 4;                    ///< bodies side by side
using Lanes = double __attribute__((vector_size(LANES * sizeof(double))));
#define GEAR_QUAT_INLINE inline __attribute__((always_inline))
GEAR_QUAT_INLINE void set(Lanes &a, int lane, double value)
{
  a[lane] = value;
}
GEAR_QUAT_INLINE double get(const Lanes &a, int lane)
{
  return a[lane];
}
#else
constexpr int LANES = 1;
using Lanes = double;
#define GEAR_QUAT_INLINE inline
#endif

inline void set(double &a, int /*lane*/, double value)
{
  a = value;
}
inline double get(const double &a, int /*lane*/)
{
  return a;
}

#if defined(__GNUC__) && defined(__x86_64__) && defined(__GLIBC__) && !defined(__SANITIZE_THREAD__)
#define GEAR_QUAT_VARIANTS __attribute__((target_clones("avx2", "default"), flatten))
#else
#define GEAR_QUAT_VARIANTS
#endif

}    // namespace LAMMPS_NS::GearQuat

#endif
