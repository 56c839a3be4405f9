/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Constant kinetic energy by Gauss's principle of least constraint, for first-order equations:

     p' = F - alpha p,   L' = tau - alpha L    (space frame; body frame: omega' gains -alpha omega)
     alpha = sum(F.v + tau.omega) / sum(m v.v + omega.I.omega)

   with sums over all bodies, so that the time derivative of the denominator vanishes; the
   gyroscopic term does no work.  `total` has one alpha, `separate` one for translation and one for
   rotation, each from
   its own terms.  For points: D. J. Evans, W. G. Hoover, B. H. Failor, B. Moran, A. J. C. Ladd,
   Phys. Rev. A 28, 1016 (1983). */

#ifndef GEAR_QUAT_GAUSS_H
#define GEAR_QUAT_GAUSS_H

#include "gear_quat_math.h"

namespace LAMMPS_NS::GearQuat {

enum class Isokinetic { NONE, TOTAL, SEPARATE };

/// Sums over bodies: powers of forces and torques, and twice the kinetic energies.
struct KineticSums {
  double force_power = 0.0;
  double torque_power = 0.0;
  double translation = 0.0;
  double rotation = 0.0;

  double power() const { return force_power + torque_power; }
  template <class V> void fields(V &v) { v(force_power, torque_power, translation, rotation); }

  /// torque_body: about the center of mass.
  void add(const RigidBody &body, const double *force, const double *torque_body,
           const double *velocity, const double *omega_body)
  {
    force_power += dot3(force, velocity);
    torque_power += dot3(torque_body, omega_body);
    translation += 2.0 * translational_energy(body, velocity);
    rotation += 2.0 * rotational_energy(body, omega_body);
  }

  void add(const RigidBody &body, const Load &load, const BodyState &state)
  {
    double torque_body[3];
    torque_along_axes(state.q, dot4(state.q, state.q), load, torque_body);
    add(body, load.force, torque_body, state.velocity, state.omega_body);
  }
};

/// Multipliers of momenta and of angular momenta, in 1/time or without unit.
struct Multipliers {
  double translation = 0.0;
  double rotation = 0.0;
};

/// The alpha of each; zero where there is no kinetic energy to be kept.
inline Multipliers multipliers(Isokinetic mode, const KineticSums &sums)
{
  auto ratio = [](double power, double twice) {
    return twice > 0.0 ? power / twice : 0.0;
  };
  if (mode == Isokinetic::SEPARATE)
    return {ratio(sums.force_power, sums.translation), ratio(sums.torque_power, sums.rotation)};
  const double both = ratio(sums.power(), sums.translation + sums.rotation);
  return {both, both};
}

/// Factors of the momenta that restore the kinetic energies of `wanted`.
inline Multipliers scale_factors(Isokinetic mode, const KineticSums &wanted,
                                 const KineticSums &found)
{
  auto factor = [](double is_wanted, double is_found) {
    return is_found > 0.0 ? std::sqrt(is_wanted / is_found) : 1.0;
  };
  if (mode == Isokinetic::SEPARATE)
    return {factor(wanted.translation, found.translation), factor(wanted.rotation, found.rotation)};
  const double both =
      factor(wanted.translation + wanted.rotation, found.translation + found.rotation);
  return {both, both};
}

/// The rates at which the momenta of a body decay, 1/time: of its momentum along the axes of space,
/// and of its angular momentum.
struct Friction {
  double translation[3] = {0.0, 0.0, 0.0};
  double rotation = 0.0;
  /// Velocity of a motion of all bodies that does not decay.
  double common[3] = {0.0, 0.0, 0.0};
  bool implicit = false;    ///< residuals are solved for the friction that they change

  Friction() = default;
  Friction(const Multipliers &alpha) : rotation(alpha.rotation)
  {
    for (double &one : translation) one = alpha.translation;
  }

  /// Component i of a momentum does not change.
  void release(int i) { translation[i] = 0.0; }

  // what acts on component i of a momentum p, or of an angular momentum l along the principal axes

  double force(int i, double met, const double *p, double mass) const
  {
    return met - translation[i] * (p[i] - mass * common[i]);
  }
  double torque(double met, double l) const { return met - rotation * l; }

  // A residual r changes a velocity by `share` * r, and thus the friction.  The functions turn
  // explicit residuals into implicit residuals, for a rotation component by component.  share: with
  // the units of a time.

  void solve(double share, double *residual) const
  {
    for (int i = 0; i < 3; ++i) residual[i] /= 1.0 + share * translation[i];
  }
  double implicit_torque(double share) const { return 1.0 / (1.0 + share * rotation); }
};

/// The load with the forces of friction, -alpha (p - m common) and -alpha L.
template <class Damper>
Load damped_load(const RigidBody &body, const BodyState &state, const Load &load,
                 const Damper &alpha)
{
  double momentum_space[3], momentum[3];
  momentum_along_space(body, state, momentum_space);
  Load damped = load;
  for (int i = 0; i < 3; ++i) momentum[i] = body.mass * state.velocity[i];
  for (int i = 0; i < 3; ++i) {
    damped.force[i] = alpha.force(i, load.force[i], momentum, body.mass);
    damped.torque_space[i] -= alpha.rotation * momentum_space[i];
  }
  return damped;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
