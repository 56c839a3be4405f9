/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_integrator.h"

using namespace LAMMPS_NS::GearQuat;

namespace {

constexpr int CENTER = Scheme::POSITION, QUATERNION = Scheme::SECOND_QUATERNION;
constexpr int RATES = Scheme::SECOND_WIDTH;

/// A lane without a body repeats the last one.
GEAR_QUAT_INLINE int body_in(int lane, int count)
{
  return lane < count ? lane : count - 1;
}

/// N numbers of each body, the first at from(body).
template <int N, class From> GEAR_QUAT_INLINE void load(int count, From from, Lanes *to)
{
#pragma GCC unroll 4
  for (int lane = 0; lane < LANES; ++lane) {
    const double *first = from(body_in(lane, count));
#pragma GCC unroll 9
    for (int i = 0; i < N; ++i) set(to[i], lane, first[i]);
  }
}

template <int N, class To> GEAR_QUAT_INLINE void store(int count, const Lanes *from, To to)
{
  for (int body = 0; body < count; ++body) {
    double *first = to(body);
#pragma GCC unroll 9
    for (int i = 0; i < N; ++i) first[i] = get(from[i], body);
  }
}

/// As body_state().
GEAR_QUAT_VARIANTS void states_of(const Block &block, double per_h)
{
  Lanes inertia[3], center[3], q[4], rates[6], velocity[3], omega[3], axes[9], omega_space[3];
  const auto row = [&block](int start) {
    return [&block, start](int body) {
      return block.rows[body] + start;
    };
  };
  load<3>(
      block.count,
      [&](int body) {
        return block.bodies[body]->inertia;
      },
      inertia);
  load<3>(block.count, row(CENTER), center);
  load<4>(block.count, row(QUATERNION), q);
  load<6>(block.count, row(RATES), rates);
  velocities_of_rows(inertia, rates, q, per_h, velocity, omega, axes, omega_space);
  store<3>(block.count, center, [&](int body) {
    return block.states[body]->center;
  });
  store<4>(block.count, q, [&](int body) {
    return block.states[body]->q;
  });
  store<3>(block.count, velocity, [&](int body) {
    return block.states[body]->velocity;
  });
  store<3>(block.count, omega, [&](int body) {
    return block.states[body]->omega_body;
  });
  store<9>(block.count, axes, [&](int body) {
    return block.frames[body]->axes;
  });
  store<3>(block.count, omega_space, [&](int body) {
    return block.frames[body]->omega_space;
  });
}

GEAR_QUAT_INLINE Predicted<Lanes> predicted(const Block &block)
{
  Predicted<Lanes> now;
#pragma GCC unroll 4
  for (int lane = 0; lane < LANES; ++lane) {
    const int body = body_in(lane, block.count);
    now.set_lane(lane, *block.bodies[body], *block.loads[body], block.rows[body]);
  }
  return now;
}

GEAR_QUAT_VARIANTS void free_velocities_of(const MomentumStep &step, const Block &block,
                                           Velocities &found)
{
  step.find_free_velocities(predicted(block), found.linear, found.omega_body);
}

GEAR_QUAT_VARIANTS void corrections_of(const MomentumStep &step, const Block &block,
                                       const Friction &friction, Corrected<double> *found)
{
  const Predicted<Lanes> now = predicted(block);
  Corrected<Lanes> all = {};
  step.find_residual(now, friction, all.residual);
  step.turn(now, all);
  store<6>(block.count, all.residual, [&](int body) {
    return found[body].residual;
  });
  store<4>(block.count, all.q, [&](int body) {
    return found[body].q;
  });
  store<3>(block.count, &all.work, [&](int body) {
    return &found[body].work;
  });
}

}    // namespace

void Integrator::find_states(const Block &block) const
{
  if (!side_by_side(block)) {
    for (int body = 0; body < block.count; ++body)
      body_state(*block.bodies[body], block.rows[body], *block.states[body], *block.frames[body]);
    return;
  }
  states_of(block, per_h);
}

void Integrator::find_velocities(const Block &block, const Friction &friction,
                                 Velocities &found) const
{
  if (scheme.momentum()) {
    free_velocities_of(momentum_step(), block, found);
    return;
  }
  for (int body = 0; body < block.count; ++body) {
    double rows[MAX_SIZE];
    std::copy_n(block.rows[body], scheme.size(), rows);
    correct(*block.bodies[body], *block.loads[body], rows, friction);
    const BodyState state = body_state(*block.bodies[body], rows);
    for (int i = 0; i < 3; ++i) {
      set(found.linear[i], body, state.velocity[i]);
      set(found.omega_body[i], body, state.omega_body[i]);
    }
  }
}

void Integrator::correct(const Block &block, const Friction &friction) const
{
  if (!side_by_side(block)) {
    for (int body = 0; body < block.count; ++body)
      *block.last[body] =
          correct(*block.bodies[body], *block.loads[body], block.rows[body], friction);
    return;
  }
  Corrected<double> found[LANES];
  corrections_of(momentum_step(), block, friction, found);
  for (int body = 0; body < block.count; ++body)
    *block.last[body] = apply(found[body], block.rows[body]);
}
