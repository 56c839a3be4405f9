/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Measures the damping of bodies by forces, before a step.

   If forces can be evaluated, velocities are changed by rigid-body velocities u, and the loads
   change by -Gamma u.  The fastest rate of M^-1 Gamma, with the masses and moments M, follows from
   a few such changes, each along the last response.

   Random forces must not be evaluated again; they are determined as the current forces minus all
   other forces.  A friction 1/tau on the velocity of each atom implies random forces of a
   temperature T in steps of h, so that
     sum f^2/m = sum m v^2/tau^2 + n 2 kT/(h tau)    for n components. */

#ifndef LMP_GEAR_QUAT_FRICTION_H
#define LMP_GEAR_QUAT_FRICTION_H

#include "gear_quat_forces.h"
#include "gear_quat_sites.h"

namespace LAMMPS_NS::GearQuat {

class FrictionOfForces : protected Pointers {
 public:
  FrictionOfForces(LAMMPS *lmp, const Fix *fix, Bodies &bodies, Ownership &ownership,
                   Sites &sites) :
      Pointers(lmp),
      owners({fix}), bodies(bodies), ownership(ownership), sites(sites)
  {
  }

  /// The part of a momentum that is damped by forces in a step h, 0 if unknown.  f: the forces of
  /// the last step.  After the call atoms, states and loads are as before.  Collective.
  double part(double **f, double h)
  {
    const double random = of_random(f, h);    // f may be atom->f
    return std::fabs(h) * (random + of_velocities(h));
  }

 private:
  const std::vector<const Fix *> owners;
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;

  /// Velocities of bodies, or accelerations.
  struct Twist {
    double linear[3], angular_body[3];
  };
  double of_velocities(double h);
  std::vector<Twist> begin(double h) const;
  std::vector<Twist> accelerations() const;
  double norm(const std::vector<Twist> &twists) const;
  double of_random(double **f, double h);
  double thermal_energy(const std::vector<const Fix *> &fixes) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
