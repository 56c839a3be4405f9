/* Collisions of two random rigid bodies of Lennard-Jones sites: 3 to 12 sites of unit mass, sigma
   and epsilon, half of the bodies charged; energies over four decades, 5 to 100 sigma apart. */

#pragma once

#include "follow.h"
#include "gear_quat_shapes.h"
#include "numbers.h"

namespace Drive {

struct Molecule {
  RigidBody body;
  double reach;
  vector<std::array<double, 3>> arms;    ///< along the principal axes
  vector<double> charges;                ///< their sum is zero
};

inline Molecule random_molecule(Check::Numbers &numbers, double largest_charge)
{
  Molecule molecule;
  const int n = 3 + int(5.0 * (numbers.next() + 1.0));
  double center[3] = {}, tensor[9] = {}, axes[9], charge = 0.0;
  for (int k = 0; k < n; ++k) {
    double d[3];
    do
      for (double &x : d) x = numbers.next();
    while (dot3(d, d) > 1.0);
    for (int i = 0; i < 3; ++i) center[i] += (d[i] *= 0.35 * std::cbrt(n)) / n;
    molecule.arms.push_back({d[0], d[1], d[2]});
    molecule.charges.push_back(largest_charge * numbers.next());
    charge += molecule.charges.back() / n;
  }
  for (auto &d : molecule.arms) {
    for (int i = 0; i < 3; ++i) d[i] -= center[i];
    for (int i = 0; i < 9; ++i)
      tensor[i] += (i % 4 == 0) * dot3(d.data(), d.data()) - d[i / 3] * d[i % 3];
  }
  for (double &q : molecule.charges) q -= charge;
  molecule.body.mass = n;
  principal_axes(tensor, molecule.body.inertia, axes);
  molecule.reach = 0.0;
  for (auto &d : molecule.arms) {
    const auto listed = d;
    to_body(axes, listed.data(), d.data());
    molecule.reach = std::max(molecule.reach, length(d.data()));
  }
  return molecule;
}

/// Collision number `which` of a sequence.
struct Collision {
  Molecule molecules[2];
  BodyState start[2] = {};
  double time;    ///< when the bodies have met and separated, or orbited each other for a while
  mutable long calls = 0;    ///< of the potential, for benchmarks/studies/collisions

  explicit Collision(int which)
  {
    Check::Numbers numbers(7919ULL * which + 13);
    for (int k = 0; k < 10; ++k) numbers.next();
    for (Molecule &one : molecules) one = random_molecule(numbers, which % 2 ? 0.5 : 0.0);
    const double energy = std::pow(10.0, 2.0 * numbers.next());
    const double distance = 5.0 * std::pow(20.0, 0.5 * (numbers.next() + 1.0));
    const double impact = 2.0 * (numbers.next() + 1.0);
    const double both = molecules[0].body.mass + molecules[1].body.mass;
    const double reduced = molecules[0].body.mass * molecules[1].body.mass / both;
    const double speed = std::sqrt(2.0 * energy / reduced);
    for (int k = 0; k < 2; ++k) {
      const double part = (k ? 1.0 : -1.0) * molecules[1 - k].body.mass / both;
      const auto q = numbers.unit_quaternion();
      std::copy(q.begin(), q.end(), start[k].q);
      for (double &w : start[k].omega_body)
        w = std::sqrt(energy / molecules[k].body.inertia[1]) * numbers.next();
      start[k].center[0] = part * distance;
      start[k].center[1] = part * impact;
      start[k].velocity[0] = -part * speed;
    }
    time = distance / speed + std::min(distance / speed, 5.0);
  }

  /// For sites at rotation matrices of quaternions of any length; loads: of both, or null.
  double potential(const BodyState *states, Load *loads) const
  {
    ++calls;
    vector<std::array<double, 3>> arms[2];
    for (int k = 0; k < 2; ++k) {
      double axes[9];
      rotation_matrix(states[k].q, dot4(states[k].q, states[k].q), axes);
      for (const auto &arm : molecules[k].arms) {
        arms[k].emplace_back();
        to_space(axes, arm.data(), arms[k].back().data());
      }
      loads[k] = Load();
    }
    double energy = 0.0;
    for (size_t a = 0; a < arms[0].size(); ++a)
      for (size_t b = 0; b < arms[1].size(); ++b) {
        double d[3], force[3], back[3];
        for (int i = 0; i < 3; ++i)
          d[i] = states[0].center[i] + arms[0][a][i] - states[1].center[i] - arms[1][b][i];
        const double r2 = dot3(d, d), s6 = 1.0 / (r2 * r2 * r2);
        const double coulomb = molecules[0].charges[a] * molecules[1].charges[b] / std::sqrt(r2);
        energy += 4.0 * (s6 * s6 - s6) + coulomb;
        for (int i = 0; i < 3; ++i)
          back[i] = -(force[i] = (24.0 * (2.0 * s6 * s6 - s6) + coulomb) / r2 * d[i]);
        push(arms[0][a].data(), force, loads[0]);
        push(arms[1][b].data(), back, loads[1]);
      }
    return energy;
  }

  double kinetic(const BodyState *states) const
  {
    double energy = 0.0;
    for (int k = 0; k < 2; ++k)
      energy += translational_energy(molecules[k].body, states[k].velocity) +
          rotational_energy(molecules[k].body, states[k].omega_body);
    return energy;
  }

 private:
  static void push(const double *arm, const double *force, Load &load)
  {
    double torque[3];
    cross3(arm, force, torque);
    for (int i = 0; i < 3; ++i) {
      load.force[i] += force[i];
      load.torque_space[i] += torque[i];
    }
  }
};

/// Result of a collision under a tolerance.
struct Outcome {
  double error;    ///< of the energy, maximum over the trajectory
  double depth;    ///< largest potential, or kinetic energy at the start, whichever is larger
  double worst;    ///< error of a step, in units of eps
  long steps, evaluations, repeated;
  bool arrived;
};

/// most_steps: for a pair that keeps orbiting.
inline Outcome collide(const Collision &collision, double eps, bool energy, long most_steps)
{
  using One = Follower::One;
  double potential = 0.0;
  const auto loads = [&](const vector<One> &ones) {
    const BodyState states[2] = {ones[0].state, ones[1].state};
    vector<Load> found(2);
    potential = collision.potential(states, found.data());
    return found;
  };
  vector<One> bodies;
  for (int k = 0; k < 2; ++k)
    bodies.push_back(
        {collision.molecules[k].body, collision.molecules[k].reach, collision.start[k]});

  // in free flight no site approaches the other body by more than a part of the distance

  const auto farthest = [&](const vector<One> &ones) {
    double d[3], speed = 0.0;
    for (int i = 0; i < 3; ++i) d[i] = ones[0].state.center[i] - ones[1].state.center[i];
    for (const One &one : ones)
      speed =
          std::max(speed, length(one.state.velocity) + one.reach * length(one.state.omega_body));
    return 0.25 * std::max(0.3, length(d) - ones[0].reach - ones[1].reach) / speed;
  };
  const double first = std::min(farthest(bodies), 1e-2 * std::cbrt(eps));
  Follower follower(eps, energy, first, bodies, loads);
  follower.farthest = farthest;
  follower.begin();

  const double e0 = potential + collision.kinetic(collision.start);
  Outcome outcome = {0.0, collision.kinetic(collision.start), 0.0, 0, 0, 0, true};
  while (follower.t < collision.time && follower.steps < most_steps) {
    const StepErrors errors = follower.step();
    if (follower.h < 1e-13) outcome.arrived = false;
    if (!outcome.arrived) break;
    const BodyState states[2] = {follower.bodies[0].state, follower.bodies[1].state};
    Load unused[2];
    const double u = collision.potential(states, unused);
    outcome.error = std::max(outcome.error, std::fabs(u + collision.kinetic(states) - e0));
    outcome.depth = std::max(outcome.depth, std::fabs(u));
    follower.follow(errors);
  }
  outcome.worst = follower.largest;
  outcome.steps = follower.steps;
  outcome.evaluations = follower.evaluations;
  outcome.repeated = follower.repeated;
  return outcome;
}

}    // namespace Drive
