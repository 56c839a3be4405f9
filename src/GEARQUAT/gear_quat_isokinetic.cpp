/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_isokinetic.h"

#include "gear_quat_ranks.h"

#include "error.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

void IsokineticConstraint::sum()
{
  constexpr size_t N = sizeof(KineticSums) / sizeof(double);
  reduce(MPI_SUM, &here.force_power, &sums.force_power, N, world);
  here = KineticSums();
  alpha = GearQuat::multipliers(mode, sums);
}

void IsokineticConstraint::sum_present()
{
  here = KineticSums();
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    here.add(bodies.rigid_of(ibody), bodies.load_of(ibody), bodies.state_of(ibody));
  sum();
}

void IsokineticConstraint::begin_run(bool anew)
{
  sum_present();
  refuse_rest();
  if (!anew && counted == bodies.number()) return;
  target = sums;
  counted = bodies.number();
}

/// Without kinetic energy the multiplier is undefined: NOTHING is rounding, relative to the whole.
void IsokineticConstraint::refuse_rest() const
{
  constexpr double NOTHING = 1.0e-24;
  int turns = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    if (bodies.rigid_of(ibody).rotational_freedoms() > 0) turns = 1;
  turns = over_ranks(MPI_MAX, turns, world);

  const bool separate = mode == Isokinetic::SEPARATE;
  const double least = NOTHING * (sums.translation + sums.rotation);
  const char *missing = nullptr;
  if (least <= 0.0)
    missing = "";
  else if (separate && sums.translation <= least)
    missing = "translational ";
  else if (separate && turns && sums.rotation <= least)
    missing = "rotational ";
  if (missing)
    error->all(FLERR,
               "Fix gear/quat isokinetic {}: the {}kinetic energy of the bodies is zero and would "
               "stay so; give them velocities first",
               separate ? "separate" : "total", missing);
}

double IsokineticConstraint::end_passes()
{
  sum();
  if (counted != bodies.number()) {    // some were removed, with their energy
    target = sums;
    counted = bodies.number();
  }
  factor = scale_factors(mode, target, sums);
  if (!scales) return 0.0;
  return 0.5 * (sums.translation + sums.rotation - target.translation - target.rotation);
}
