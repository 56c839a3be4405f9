/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_friction.h"

#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   friction that can be evaluated
------------------------------------------------------------------------- */

static constexpr int CHANGES = 4;         // of velocities; the friction of contacts has many rates
static constexpr double NONE = 1.0e-9;    // smaller changes of a velocity in a step are rounding

double FrictionOfForces::of_velocities(double h)
{
  Forces forces(lmp, owners, Forces::Which::OF_VELOCITIES);
  if (!forces.reason().empty() || !forces.any()) return 0.0;
  const auto before = bodies.snapshot();
  forces.save();
  const auto loads = [&] {
    ownership.spread_states();
    sites.place(true);
    forces.evaluate();
    sites.gather_loads(atom->f, atom->torque);
  };
  loads();
  const std::vector<Twist> present = accelerations();
  std::vector<Twist> change = begin(h);
  double rate = 0.0;
  for (int n = 0; n < CHANGES; ++n) {
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
      BodyState &state = bodies.change_state(ibody);
      state = before.states[ibody];
      add3(change[ibody].linear, state.velocity);
      add3(change[ibody].angular_body, state.omega_body);
    }
    loads();
    std::vector<Twist> answer = accelerations();
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      for (int k = 0; k < 3; ++k) {
        answer[ibody].linear[k] -= present[ibody].linear[k];
        answer[ibody].angular_body[k] -= present[ibody].angular_body[k];
      }
    const double size = norm(change), found = norm(answer);
    rate = found / size;
    if (!(std::fabs(h) * rate > NONE)) {
      rate = 0.0;
      break;
    }
    for (auto &twist : answer)
      for (int k = 0; k < 3; ++k) {
        twist.linear[k] *= size / found;
        twist.angular_body[k] *= size / found;
      }
    change = answer;
  }
  forces.restore();
  bodies.put_back_states(before);
  bodies.put_back_loads(before);
  ownership.spread_states();
  sites.place_extended();
  return rate;
}

/// Changes that differ for each body and are as large as the velocities, or as the velocity for a
/// displacement by a part of the skin in a step.
std::vector<FrictionOfForces::Twist> FrictionOfForces::begin(double h) const
{
  double here[2] = {0.0, 0.0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const BodyState &state = bodies.state_of(ibody);
    here[0] += 2.0 *
        (translational_energy(rigid, state.velocity) + rotational_energy(rigid, state.omega_body));
    here[1] += rigid.mass;
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  const double slow = 1.0e-3 * neighbor->skin / std::fabs(h);
  const double energy = std::max(all[0], all[1] * slow * slow) / (double) bodies.number();
  std::vector<Twist> twists(bodies.nmoved(), Twist());
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const double id = (double) bodies.body_at(ibody).id;
    for (int k = 0; k < 3; ++k) {
      if (k < domain->dimension)
        twists[ibody].linear[k] = std::sqrt(energy / rigid.mass) * std::sin(1.7 * id + 2.1 * k);
      if (rigid.inertia[k] > 0.0)
        twists[ibody].angular_body[k] =
            std::sqrt(energy / rigid.inertia[k]) * std::sin(2.3 * id + 1.9 * k);
    }
  }
  return twists;
}

/// Accelerations by the present loads, without the gyroscopic part.
std::vector<FrictionOfForces::Twist> FrictionOfForces::accelerations() const
{
  std::vector<Twist> found(bodies.nmoved(), Twist());
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const Load load = bodies.acting(ibody);
    double torque_body[3];
    to_body(bodies.axes(ibody), load.torque_space, torque_body);
    for (int k = 0; k < 3; ++k) {
      found[ibody].linear[k] = load.force[k] / rigid.mass;
      if (rigid.inertia[k] > 0.0) found[ibody].angular_body[k] = torque_body[k] / rigid.inertia[k];
    }
  }
  return found;
}

/// Weighted by mass and moments.  Collective.
double FrictionOfForces::norm(const std::vector<Twist> &twists) const
{
  double here = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const Twist &twist = twists[ibody];
    here += rigid.mass * dot3(twist.linear, twist.linear);
    for (int k = 0; k < 3; ++k)
      here += rigid.inertia[k] * twist.angular_body[k] * twist.angular_body[k];
  }
  return std::sqrt(over_ranks(MPI_SUM, here, world));
}

/* ----------------------------------------------------------------------
   random forces
------------------------------------------------------------------------- */

double FrictionOfForces::of_random(double **f, double h)
{
  std::vector<const Fix *> fixes;
  int group = 0;
  for (auto *other : modify->get_fix_list())
    if (known(FixFact::RANDOM, other) && !other->time_integrate &&
        (modify->get_fix_mask(other) & FixConst::POST_FORCE)) {
      fixes.push_back(other);
      group |= other->groupbit;
    }
  if (fixes.empty()) return 0.0;
  Forces others(lmp, owners, Forces::Which::WITHOUT_RANDOM);
  if (!others.reason().empty()) return 0.0;
  others.save();
  const std::vector<double> all(f[0], f[0] + 3 * (size_t) atom->nlocal);
  others.evaluate();
  double here[3] = {0.0, 0.0, 0.0};    // components, m v^2, f^2/m
  for (const Site &site : sites) {
    const int i = site.atom;
    if (!(atom->mask[i] & group)) continue;
    const double mass = ownership.mass_of(i);
    double alone[3];
    for (int k = 0; k < 3; ++k) alone[k] = force->ftm2v * (all[3 * (size_t) i + k] - atom->f[i][k]);
    here[0] += domain->dimension;
    here[1] += mass * dot3(atom->v[i], atom->v[i]);
    here[2] += dot3(alone, alone) / mass;
  }
  others.restore();
  const auto sums = over_ranks(MPI_SUM, here, world);
  if (!(sums[2] > 0.0)) return 0.0;
  double kt = thermal_energy(fixes);
  if (kt < 0.0) kt = sums[1] / sums[0];
  const double half = sums[0] * kt / std::fabs(h);    // of the term that is linear in 1/tau
  return sums[2] / (half + std::sqrt(half * half + sums[1] * sums[2]));
}

/// kT of the highest target temperature of these fixes, negative if unknown.
double FrictionOfForces::thermal_energy(const std::vector<const Fix *> &fixes) const
{
  double target = -1.0;
  for (const auto *one : fixes) {
    int dim = -1;
    const void *told = const_cast<Fix *>(one)->extract("t_target", dim);
    if (told && dim == 0) target = std::max(target, *static_cast<const double *>(told));
  }
  return target < 0.0 ? -1.0 : force->boltz * target / force->mvv2e;
}
