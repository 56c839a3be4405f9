/* Motions with the kernel itself and any coefficients, for Python (kernel.py).

   Every function takes a Corrector and returns LOST if its motion does not stay finite. */

#include "drive.h"
#include "gear_quat_limits.h"
#include "oracles/cage_scene.h"
#include "oracles/swinging_top.h"

#include <random>

using namespace Drive;
using Oracle::CageScene;
using Oracle::TOP;

namespace {

constexpr double LOST = 1e3;

/// Coefficients c_0 ... c_(values-1) of rows that forces drive, and of those that integrate these, which
/// only the first formulation has.  any_norm: without a projection.
struct Corrector {
  int second, values, passes, compensate, any_norm;
  double sets[2][MAX_VALUES];
};

Scheme scheme_for(const Corrector &corrector)
{
  Scheme scheme = scheme_of(corrector.second ? SECOND : FIRST, corrector.values, corrector.passes,
                            corrector.compensate);
  scheme.tuned = corrector.any_norm;
  scheme.projection = corrector.any_norm ? Projection::AUTO : Projection::YES;
  return scheme;
}

CorrectorCoefficients coefficients_of(const Corrector &corrector)
{
  CorrectorCoefficients c(scheme_for(corrector));
  std::copy_n(corrector.sets[0], corrector.values, c.driven.begin());
  std::copy_n(corrector.sets[1], corrector.values, c.integrated.begin());
  return c;
}

/// spacing: the longest of the nodes of the start.
Motion motion_of(const Corrector &corrector, const RigidBody &body, const BodyState &state,
                 const LoadOf &load, double h, double spacing)
{
  const Scheme scheme = scheme_for(corrector);
  return Motion(body, load, scheme, coefficients_of(corrector), h,
                started(scheme, body, state, load, h, Start::BOOTSTRAP, std::min(h, spacing)));
}

/// Wells that hold the axes of the body at those of space; a body with small amplitude swings about
/// its axis i with frequency[i].  The potential is - sum_i depth_i (axis i of body . axis i of space).
struct Wells {
  RigidBody body = {1.0, {0.6, 1.15, 1.75}};
  double depth[3];

  explicit Wells(const double *frequency)
  {
    double stiffness[3], total = 0.0;
    for (int i = 0; i < 3; ++i) {
      stiffness[i] = body.inertia[i] * frequency[i] * frequency[i];
      total += stiffness[i];
    }
    for (int i = 0; i < 3; ++i) depth[i] = 0.5 * total - stiffness[i];
  }

  double potential(const BodyState &state) const
  {
    double a[9];
    rotation_matrix(state.q, dot4(state.q, state.q), a);
    return -(depth[0] * a[0] + depth[1] * a[4] + depth[2] * a[8]);
  }

  Load operator()(const BodyState &state, double norm2) const
  {
    Load load = {};
    double a[9];    // its rows are the axes of the body
    rotation_matrix(state.q, norm2, a);
    for (int i = 0; i < 3; ++i) {
      double pull[3] = {0.0, 0.0, 0.0}, torque[3];
      pull[i] = depth[i];
      cross3(a + 3 * i, pull, torque);
      for (int k = 0; k < 3; ++k) load.torque_space[k] += torque[k];
    }
    return load;
  }

  double energy(const BodyState &state) const
  {
    return potential(state) + rotational_energy(body, state.omega_body);
  }
};

double bounded(double x)
{
  return std::fabs(x) < LOST ? x : LOST;
}

}    // namespace

extern "C" {

/// Change of the energy of a libration, averaged over 200 steps after `steps`, by the kinetic energy
/// at its start.  frequency[3]: of small amplitudes; amplitude: of the start, in radians.
double libration(const Corrector *corrector, double h, int steps, const double *frequency,
                 double amplitude)
{
  constexpr double WAY[3] = {0.9, -1.1, 1.0};
  constexpr int AVERAGED = 200;
  const Wells wells(frequency);
  BodyState start = {};
  start.q[3] = 1.0;
  for (int i = 0; i < 3; ++i) start.omega_body[i] = amplitude * WAY[i] * frequency[i];
  try {
    Motion motion = motion_of(*corrector, wells.body, start, wells, h, 0.3);
    motion.steps(steps);
    double change = 0.0;
    for (int i = 0; i < AVERAGED; ++i) {
      motion.step();
      change += (wells.energy(motion.state()) - wells.energy(start)) / AVERAGED;
    }
    return bounded(change / rotational_energy(wells.body, start.omega_body));
  } catch (const std::runtime_error &) {
    return LOST;
  }
}

/// Relative change of the energy of the free top.
double free_top(const Corrector *corrector, double h, double time)
{
  static const BodyState start = Oracle::top_state(0.0);
  try {
    Motion motion = motion_of(*corrector, TOP, start, free_of_load, h, 0.1);
    const double energy = rotational_energy(TOP, start.omega_body);
    motion.run(time);
    return bounded(rotational_energy(TOP, motion.state().omega_body) / energy - 1.0);
  } catch (const std::runtime_error &) {
    return LOST;
  }
}

/// The center of mass (center[3]) of the body of test case 1 in its cage.  seed: of another start, 0
/// for the paper's own.
void cage(const Corrector *corrector, double h, int seed, double time, double *center)
{
  static const CageScene scene(1, true);
  BodyState start = scene.start;
  if (seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (double &x : start.q) x = normal(random);
    project_norm(start.q);
    start.center[0] -= 14.0;
    for (int i = 0; i < 3; ++i) {
      start.velocity[i] = 0.12 * normal(random);
      start.omega_body[i] = 0.3 * normal(random);
      start.center[i] += (i == 0 ? 3.0 : 2.0) * normal(random);
    }
  }
  std::fill_n(center, 3, LOST);
  try {
    Motion motion = motion_of(*corrector, scene.body, start, scene, h, 0.05);
    motion.run(time);
    const BodyState end = motion.state();
    for (int i = 0; i < 3; ++i) center[i] = bounded(end.center[i]);
  } catch (const std::runtime_error &) {
  }
}

double noise(const Corrector *corrector)
{
  return noise_gain(scheme_for(*corrector), coefficients_of(*corrector));
}

/// The tail of a tuned set, and its c_0 (NaN if it is solved for).  which: 0 or 1, as in Corrector.
/// Returns the length of the tail, 0 if there is no such set.
int tuned_tail(int second, int values, int which, int any_norm, double *tail, double *c0)
{
  const Columns kind = which && !second ? Columns::INTEGRATED : Columns::DRIVEN;
  const TunedSet *set = tuned_set(second ? SECOND : FIRST, values, kind, any_norm);
  if (!set) return 0;
  std::copy(set->tail.begin(), set->tail.end(), tail);
  *c0 = double(set->c0);
  return int(set->tail.size());
}
}
