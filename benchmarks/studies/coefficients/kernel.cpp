/* Motions with the kernel itself and any coefficients, for Python (kernel.py).

   Every function takes a Corrector and returns LOST if its motion does not stay finite. */

#include "drive.h"
#include "oracles/cage_scene.h"

#include <random>

using namespace Drive;
using Oracle::CageScene;

namespace {

constexpr double LOST = 1e3;

/// Coefficients c_0 ... c_(values-1) of formulation momentum.
struct Corrector {
  int values, compensate;
  double c[MAX_VALUES];
};

Scheme scheme_for(const Corrector &corrector)
{
  Scheme scheme = scheme_of(MOMENTUM, corrector.values, 1, corrector.compensate);
  scheme.method = Method::GEAR;
  return scheme;
}

CorrectorCoefficients coefficients_of(const Corrector &corrector)
{
  CorrectorCoefficients coefficients(scheme_for(corrector));
  std::copy_n(corrector.c, corrector.values, coefficients.c.begin());
  return coefficients;
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

/// A force in one step only changes the velocity in the following steps by d_1, d_2, ..., whose sum
/// is 1 in units of h F/m.  Returns sum d_k^2 of the center of mass: the mean square change of a
/// velocity in a step, relative to the correct one, under forces that are independent in all steps.
double noise(const Corrector *corrector)
{
  constexpr int STEPS = 1000;    // roots of 0.99 have decayed
  const Scheme scheme = scheme_for(*corrector);
  const CorrectorCoefficients c = coefficients_of(*corrector);
  const int n = scheme.values(), order = scheme.first() ? 1 : 2;
  double rows[MAX_VALUES] = {}, gain = 0.0;
  for (int step = 0; step < STEPS; ++step) {
    const double before = rows[order - 1];
    Nordsieck<1>::predict(rows, n);
    const double residual = (step == 0 ? 1.0 / order : 0.0) - rows[order];
    Nordsieck<1>::correct<1>(rows, n, c.c.data(), 0, &residual);
    const double change = rows[order - 1] - before;
    gain += change * change;
  }
  return gain;
}

/// The tail of the tuned set, and its c_0 (NaN if it is solved for).  Returns the length of the tail, 0
/// if there is no set for this number of values.
int tuned_tail(int values, double *tail, double *c0)
{
  const TunedSet *set = tuned_set(values);
  if (!set) return 0;
  std::copy(set->tail.begin(), set->tail.end(), tail);
  *c0 = double(set->c0);
  return int(set->tail.size());
}
}
