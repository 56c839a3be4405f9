/* The coefficients of formulation momentum, from the kernel of the fix, for stability.py. */

#include "gear_quat_history.h"

#include <algorithm>

using namespace LAMMPS_NS::GearQuat;

extern "C" {

void tuned(int values, double *c)
{
  const auto found = tuned_coefficients(values);
  std::copy(found.begin(), found.end(), c);
}
}
