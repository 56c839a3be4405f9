/* Random collisions (tests/unit/collisions.h) for Python: rates of change and energies for other solvers,
   and whole runs under a tolerance.  States are those of both bodies. */

#include "collisions.h"

using namespace Drive;

extern "C" {

/// Number `which`.  discard() ends it.
Collision *collision(int which, BodyState *start, double *time)
{
  auto *made = new Collision(which);
  std::copy_n(made->start, 2, start);
  *time = made->time;
  return made;
}

void discard(Collision *collision)
{
  delete collision;
}

/// How often forces or energies have been asked for.
long calls(const Collision *collision)
{
  return collision->calls;
}

/// Rates of change of states, whose quaternions need not be of unit length.
void rates(const Collision *collision, const BodyState *now, BodyState *found)
{
  Load loads[2];
  collision->potential(now, loads);
  for (int k = 0; k < 2; ++k) {
    const RigidBody &body = collision->molecules[k].body;
    std::copy_n(now[k].velocity, 3, found[k].center);
    for (int i = 0; i < 3; ++i) found[k].velocity[i] = loads[k].force[i] / body.mass;
    quaternion_rate(now[k].q, now[k].omega_body, found[k].q);
    angular_acceleration(body, now[k], dot4(now[k].q, now[k].q), loads[k], found[k].omega_body);
  }
}

/// found: potential and kinetic energy.
void energies(const Collision *collision, const BodyState *now, double *found)
{
  Load unused[2];
  found[0] = collision->potential(now, unused);
  found[1] = collision->kinetic(now);
}

/// found: evaluations, largest error of the energy on the way (NaN if it is lost), depth, steps, repeated.
void follow(const Collision *collision, double eps, int energy, int most_steps, double *found)
{
  const Outcome met = collide(*collision, eps, energy, most_steps);
  const bool lost = !met.arrived || met.steps >= most_steps;
  const double error = lost ? std::numeric_limits<double>::quiet_NaN() : met.error;
  const double numbers[] = {double(met.evaluations), error, met.depth, double(met.steps),
                            double(met.repeated)};
  std::copy_n(numbers, 5, found);
}
}
