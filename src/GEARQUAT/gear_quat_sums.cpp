/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_sums.h"

#include "force.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

// |q|^2 of four squares carries this rounding itself; less is reported as zero

static constexpr double NORM_ROUNDING = 1.0e-15;

/* ---------------------------------------------------------------------- */

double Sums::energy_correction() const
{
  double here[2] = {0.0, 0.0}, all[2];
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const BodyState &s = bodies.state[ibody];
    const Load &l = bodies.load[ibody];
    here[0] -= bodies.last[ibody].work;
    here[1] += std::sqrt(dot3(l.force, l.force) * dot3(s.center, s.center)) +
        std::sqrt(dot3(l.torque_space, l.torque_space));
  }
  MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_SUM, world);
  const double rounding = std::numeric_limits<double>::epsilon() * all[1];
  return std::fabs(all[0]) < rounding ? 0.0 : all[0] / force->ftm2v;
}

/// What a body adds to an element of the global vector, or offers for the largest.
double Sums::of_body(int n, int ibody, const Integrator *integrator) const
{
  const RigidBody &rigid = bodies.body[ibody].rigid;
  const BodyState &s = bodies.state[ibody];
  const Correction &last = bodies.last[ibody];
  switch (n) {
    case KE_TRANSLATION:
      return translational_energy(rigid, s.velocity);
    case KE_ROTATION:
      return rotational_energy(rigid, s.omega_body);
    case NORM:
      return std::fabs(dot4(s.q, s.q) - 1.0);
    case RADIAL:
      return integrator ? std::fabs(integrator->radial_rate(bodies.history(ibody))) : 0.0;
    case MAX_POSITION:
      return last.position_error;
    case RMS_POSITION:
      return last.position_error * last.position_error;
    case MAX_ANGLE:
      return last.angle_error;
    default:
      return last.angle_error * last.angle_error;
  }
}

double Sums::element(int n, const Integrator *integrator) const
{
  const bool largest = n == NORM || n == RADIAL || n == MAX_POSITION || n == MAX_ANGLE;
  double here = 0.0, all;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const double one = of_body(n, ibody, integrator);
    here = largest ? std::max(here, one) : here + one;
  }
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, largest ? MPI_MAX : MPI_SUM, world);
  if (n == KE_TRANSLATION || n == KE_ROTATION) return all * force->mvv2e;
  if (n == NORM || n == RADIAL) return all < NORM_ROUNDING ? 0.0 : all;
  if (largest) return all;
  return bodies.number() ? std::sqrt(all / bodies.number()) : 0.0;
}
