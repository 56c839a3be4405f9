/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_integrator.h"

using namespace LAMMPS_NS::GearQuat;

/* ----------------------------------------------------------------------
   states
------------------------------------------------------------------------- */

void Integrator::set_velocities(const RigidBody &body, const BodyState &state, const Load &load,
                                double *rows) const
{
  double momentum[3], *rates = rows + scheme.width(), *seconds = rates + scheme.width();
  momentum_along_space(body, state, momentum);
  for (int i = 0; i < 3; ++i) {
    rates[Scheme::POSITION + i] = h * state.velocity[i];
    rates[Scheme::ANGULAR_MOMENTUM + i] = h * momentum[i];
  }
  for (int i = 0; i < 3 && scheme.is_verlet(); ++i) {
    seconds[Scheme::POSITION + i] = 0.5 * h * h * load.force[i] / body.mass;
    seconds[Scheme::ANGULAR_MOMENTUM + i] = 0.5 * h * h * load.torque_space[i];
  }
  if (scheme.compensate)
    std::fill_n(rows + (scheme.values() + 1) * scheme.width(), scheme.width(), 0.0);
}

void Integrator::find_state(const RigidBody &body, const double *rows, BodyState &state,
                            BodyFrame &frame) const
{
  const int quat = scheme.quaternion();
  const double *rates = rows + scheme.width(), norm2 = scheme.norm2(rows + quat);
  center_state(body, rows, state);
  copy(rows + quat, 4, state.q);
  if (scheme.first()) {
    copy(rows + Scheme::OMEGA, 3, state.omega_body);
  } else {
    double qdot[4];
    for (int i = 0; i < 4; ++i) qdot[i] = rates[quat + i] * per_h;
    angular_velocity(state.q, norm2, qdot, state.omega_body);
  }
  rotation_matrix(state.q, norm2, frame.axes);
  to_space(frame.axes, state.omega_body, frame.omega_space);
}

/* ----------------------------------------------------------------------
   the correction of a center, and of a body in formulations first and second
------------------------------------------------------------------------- */

namespace LAMMPS_NS::GearQuat {

class Passes {
 public:
  Passes(const Integrator &of, const RigidBody &body, const Load &load, const Friction &friction,
         double *rows) :
      of(of),
      scheme(of.scheme), body(body), load(load), friction(friction), rows(rows), n(of.n),
      c(of.corrector.c.data()), h(of.h), per_h(of.per_h)
  {
    std::copy_n(rows + Scheme::POSITION, 3, x);
  }

  template <class History> Correction center(History history)
  {
    correct_center(history);
    return center_found();
  }

  Correction all()
  {
    const int quat = scheme.quaternion();
    double q[4], dq[4], angle_body[3];
    std::copy_n(rows + quat, 4, q);
    to_body(of.axes_of(rows).data(), load.torque_space, torque_body);
    of.with_history([&](auto history) {
      correct(history);
    });
    Correction found = center_found();
    for (int i = 0; i < 4; ++i) dq[i] = rows[quat + i] - q[i];
    angular_velocity(q, dot4(q, q), dq, angle_body);
    found.work += dot3(torque_body, angle_body);
    found.quaternion_error2 = of.corrector.weight2 * dot4(residual + 3, residual + 3);
    return found;
  }

 private:
  const Integrator &of;
  const Scheme &scheme;
  const RigidBody &body;
  const Load &load;
  const Friction &friction;
  double *rows;
  const int n;
  const double *c, h, per_h;
  double x[3], torque_body[3];    ///< predicted
  double residual[7] = {};        ///< of x and q, summed over the passes

  template <int CARRIES> using First = Integrator::First<CARRIES>;
  template <int CARRIES> using Second = Integrator::Second<CARRIES>;

  Correction center_found() const
  {
    double dx[3];
    for (int i = 0; i < 3; ++i) dx[i] = rows[i] - x[i];
    return {dot3(load.force, dx), of.corrector.weight2 * dot3(residual, residual), 0.0};
  }

  /// target: of the first derivative.
  template <int COUNT, class History>
  void feed_back(History history, int component, double *target, double *total = nullptr)
  {
    for (int i = 0; i < COUNT; ++i)
      target[i] = h * target[i] - rows[scheme.width() + component + i];
    history.template correct<COUNT>(rows, n, c, component, target);
    for (int i = 0; i < COUNT && total; ++i) total[i] += target[i];
  }

  /// Momenta (Eq. 14) and positions (Eq. 13).
  template <int CARRIES> void correct_center(First<CARRIES> history)
  {
    const double *momentum = rows + Scheme::MOMENTUM;
    double before[3], target[3];
    std::copy_n(momentum, 3, before);
    friction.add_to(load.force, before, body.mass, target);
    feed_back<3>(history, Scheme::MOMENTUM, target);
    const double *p = scheme.predicted_momentum ? before : momentum;
    for (int i = 0; i < 3; ++i) target[i] = p[i] / body.mass;
    feed_back<3>(history, Scheme::POSITION, target, residual);
  }

  /// Angular velocities (Eqs. 7, 15) and quaternions (Eqs. 5, 16).
  template <int CARRIES> void correct_rotation(First<CARRIES> history)
  {
    const int quat = scheme.quaternion();
    const double *omega_body = rows + Scheme::OMEGA;
    double before[3], torque[3], target[4];
    std::copy_n(omega_body, 3, before);
    for (int i = 0; i < 3; ++i)
      torque[i] = friction.torque(torque_body[i], body.inertia[i] * before[i]);
    angular_acceleration(body, torque, before, target);
    feed_back<3>(history, Scheme::OMEGA, target);
    quaternion_rate(rows + quat, scheme.predicted_omega ? before : omega_body, target);
    feed_back<4>(history, quat, target, residual + 3);
  }

  /// With constant forces one correction of the center is sufficient.
  template <int CARRIES> void correct(First<CARRIES> history)
  {
    correct_center(history);
    for (int k = 0; k < scheme.passes; ++k) correct_rotation(history);
    if (scheme.project) project(history);
  }

  /// The residual of positions (Eq. 17), with an implicit friction in formulation momentum.
  void find_center()
  {
    const double *rates = rows + Scheme::SECOND_WIDTH, *seconds = rates + Scheme::SECOND_WIDTH;
    const double half_h2_per_mass = 0.5 * h * h / body.mass;
    double momentum[3], force[3];
    std::copy_n(load.force, 3, force);
    if (friction.implicit) {
      for (int i = 0; i < 3; ++i) momentum[i] = body.mass * (per_h * rates[i]);
      friction.add_to(load.force, momentum, body.mass, force);
    }
    for (int i = 0; i < 3; ++i) residual[i] = half_h2_per_mass * force[i] - seconds[i];
    if (friction.implicit) friction.solve(0.5 * h * c[1], residual);
  }

  template <int CARRIES> void correct_center(Second<CARRIES> history)
  {
    find_center();
    history.template correct<3>(rows, n, c, Scheme::POSITION, residual);
  }

  /// The residual of the quaternion after another pass (Eqs. 6, 7, 18).  With c_2 = 1 the residuals
  /// of all passes add up to target - prediction, so the history is corrected once.
  void find_rotation()
  {
    const double *place = rows + Scheme::SECOND_QUATERNION, *rates = place + Scheme::SECOND_WIDTH;
    const double *seconds = rates + Scheme::SECOND_WIDTH, half_h2 = 0.5 * h * h;
    double omega_body[3], omegadot_body[3], q[4], qdot[4], target[4], *total = residual + 3;
    for (int i = 0; i < 4; ++i) {
      q[i] = place[i] + c[0] * total[i];
      qdot[i] = (rates[i] + c[1] * total[i]) * per_h;
    }
    angular_velocity(q, scheme.norm2(q), qdot, omega_body);
    angular_acceleration(body, torque_body, omega_body, omegadot_body);
    quaternion_acceleration(q, qdot, omegadot_body, target);
    for (int i = 0; i < 4; ++i) total[i] = half_h2 * target[i] - seconds[i];
  }

  /// A rescaled q with a nonzero radial rate would damp the rotation, so the rate is projected, too
  /// (Eq. 4).
  template <int CARRIES> void correct(Second<CARRIES> history)
  {
    find_center();
    for (int k = 0; k < scheme.passes; ++k) find_rotation();
    history.template correct<Scheme::SECOND_WIDTH>(rows, n, c, 0, residual);
    if (!scheme.project) return;
    project(history);
    const double *q = rows + Scheme::SECOND_QUATERNION;
    const double radial = -dot4(q, q + Scheme::SECOND_WIDTH);
    double change[4];
    for (int i = 0; i < 4; ++i) change[i] = radial * q[i];
    history.template add<4>(rows, n, 1, Scheme::SECOND_QUATERNION, change);
  }

  /// |q| = 1 (Eq. 3), as an increment, so that a compensated row keeps its digits.
  template <class History> void project(History history)
  {
    const double *q = rows + scheme.quaternion(), missing = missing_length(q);
    double change[4];
    for (int i = 0; i < 4; ++i) change[i] = missing * q[i];
    history.template add<4>(rows, n, 0, scheme.quaternion(), change);
  }
};

}    // namespace LAMMPS_NS::GearQuat

Correction Integrator::correct_by_passes(const RigidBody &body, const Load &load,
                                         const Friction &friction, double *rows) const
{
  return Passes(*this, body, load, friction, rows).all();
}

void Integrator::correct_centers(const Block &block, const Friction &friction) const
{
  with_history([&](auto history) {
    for (int k = 0; k < block.count; ++k)
      *block.last[k] =
          Passes(*this, *block.bodies[k], *block.loads[k], friction, block.rows[k]).center(history);
  });
}

/* ----------------------------------------------------------------------
   several bodies side by side
------------------------------------------------------------------------- */

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

void Integrator::find_velocities(const Block &block, Velocities &found) const
{
  free_velocities_of(momentum_step(), block, found);
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
