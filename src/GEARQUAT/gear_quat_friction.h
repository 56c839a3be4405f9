/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Friction of momenta, and random changes of them.

   Constant kinetic energy by Gauss's principle of least constraint, for first-order equations:

     p' = F - alpha p,   L' = tau - alpha L    (space frame; body frame: omega' gains -alpha omega)
     alpha = sum(F.v + tau.omega) / sum(m v.v + omega.I.omega)

   with sums over all bodies, so that the time derivative of the denominator vanishes; the
   gyroscopic term does no work.  `total` has one alpha, `separate` one for translation and one for
   rotation, each from its own terms.  For points: D. J. Evans, W. G. Hoover, B. H. Failor, B. Moran, A. J. C. Ladd,
   Phys. Rev. A 28, 1016 (1983).

   Langevin dynamics of a body.  Momenta and angular momenta obey

     p' = F - p/tau + sqrt(2 m kT/tau) dW/dt,   L_i' = N_i - L_i/tau + sqrt(2 I_i kT/tau) dW_i/dt

   along the principal axes i.  Before and after a step of h without friction, every momentum takes
   the exact step of h/2 of its Ornstein-Uhlenbeck process, with independent normal numbers g:

     p <- c p + sqrt((1 - c^2) m kT) g,   c = exp(-h/(2 tau))

   With velocity Verlet this is the splitting OVRVO, whose averages have errors of order h^2 at any
   damping (B. Leimkuhler and C. Matthews, J. Chem. Phys. 138, 174102 (2013); for rigid bodies
   R. L. Davidchack, T. E. Ouldridge and M. V. Tretyakov, J. Chem. Phys. 142, 144114 (2015)).

   The numbers g are a function of seed, half of a step and body, so they depend neither on the ranks
   nor on the order of bodies: Philox4x32-10 (J. K. Salmon et al., Parallel random numbers: as easy
   as 1, 2, 3, Proc. SC11 (2011)) and the transform of Box and Muller. */

#ifndef GEAR_QUAT_FRICTION_H
#define GEAR_QUAT_FRICTION_H

#include "gear_quat_math.h"

#include <array>
#include <cmath>
#include <cstdint>

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

  void add(const RigidBody &body, const Load &load, const BodyState &state)
  {
    double torque_body[3];
    torque_along_axes(state.q, dot4(state.q, state.q), load, torque_body);
    force_power += dot3(load.force, state.velocity);
    torque_power += dot3(torque_body, state.omega_body);
    translation += 2.0 * translational_energy(body, state.velocity);
    rotation += 2.0 * rotational_energy(body, state.omega_body);
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

/// The rates at which the momenta p of a body, along the axes of space, and its angular momentum L
/// decay:
///   p' = F - damping (p - m common) - drag m common,   L' = torque - rotation L
struct Friction {
  Upper damping;
  Upper drag;                            ///< of a moving cell (gear_quat_box.h)
  double common[3] = {0.0, 0.0, 0.0};    ///< velocity of a motion of all bodies that does not decay
  double rotation = 0.0;
  bool implicit = false;    ///< residuals are solved for the friction that they change

  Friction() = default;
  Friction(const Multipliers &alpha) :
      damping(Upper::one().scaled(alpha.translation)), rotation(alpha.rotation)
  {
  }
  /// Component i of a momentum in space does not change; the cell does not shear.
  void release(int i) { damping[i] = drag[i]; }

  /// The force with friction on a momentum p.
  template <class T>
  GEAR_QUAT_INLINE void add_to(const T *force, const T *p, const T &mass, T *damped) const
  {
    T own[3], shared[3];
    for (int i = 0; i < 3; ++i) {
      shared[i] = mass * common[i];
      own[i] = p[i] - shared[i];
    }
    for (int i = 0; i < 3; ++i)
      damped[i] = force[i] - damping.row_times(i, own) - drag.row_times(i, shared);
  }
  template <class T> GEAR_QUAT_INLINE T torque(const T &met, const T &l) const
  {
    return met - rotation * l;
  }

  // A residual r changes a velocity by `share` * r, and thus the friction.  The functions turn
  // explicit residuals into implicit residuals, for a rotation component by component.  share: with
  // the units of a time.

  /// The equations of x, y and z are solved backwards.
  template <class T> GEAR_QUAT_INLINE void solve(double share, T *residual) const
  {
    T own[3] = {T(), T(), T()};
    for (int i = 2; i >= 0; --i) {
      const T of_others = share * damping.row_times(i, own);
      residual[i] = own[i] = (residual[i] - of_others) / (1.0 + share * damping[i]);
    }
  }
  double implicit_torque(double share) const { return 1.0 / (1.0 + share * rotation); }
};

/// The load with the forces of friction.
inline Load damped_load(const RigidBody &body, const BodyState &state, const Load &load,
                        const Friction &alpha)
{
  double momentum_space[3], momentum[3];
  momentum_along_space(body, state, momentum_space);
  Load damped = load;
  for (int i = 0; i < 3; ++i) momentum[i] = body.mass * state.velocity[i];
  alpha.add_to(load.force, momentum, body.mass, damped.force);
  for (int i = 0; i < 3; ++i) damped.torque_space[i] -= alpha.rotation * momentum_space[i];
  return damped;
}

/* ---------------------------------------------------------------------- */

using RandomWords = std::array<std::uint32_t, 4>;

inline RandomWords philox(RandomWords counter, std::uint32_t key0, std::uint32_t key1)
{
  for (int round = 0; round < 10; ++round, key0 += 0x9E3779B9U, key1 += 0xBB67AE85U) {
    const std::uint64_t a = 0xD2511F53ULL * counter[0], b = 0xCD9E8D57ULL * counter[2];
    counter = {(std::uint32_t)(b >> 32) ^ counter[1] ^ key0, (std::uint32_t) b,
               (std::uint32_t)(a >> 32) ^ counter[3] ^ key1, (std::uint32_t) a};
  }
  return counter;
}

/// Independent numbers of the standard normal distribution: one for each momentum of a body.
inline std::array<double, 6> normal_numbers(int seed, std::int64_t step, std::int64_t body)
{
  constexpr double TWO_PI = 6.283185307179586, UNIT = 1.0 / 4294967296.0;    // 2^-32
  const auto low = [](std::int64_t number) {
    return (std::uint32_t) number;
  };
  std::array<double, 6> normal;
  RandomWords words;
  for (int k = 0; k < 6; k += 2) {
    if (k % 4 == 0)
      words =
          philox({low(step), low(step >> 32), low(body), low(body >> 32)}, low(seed), low(k / 4));
    const double radius = std::sqrt(-2.0 * std::log((words[k % 4] + 0.5) * UNIT));
    const double angle = TWO_PI * UNIT * words[k % 4 + 1];
    normal[k] = radius * std::cos(angle);
    normal[k + 1] = radius * std::sin(angle);
  }
  return normal;
}

/// The exact step of h of all processes.
struct RandomStep {
  double decay, variance;    ///< c, and (1 - c^2) kT

  RandomStep(double h, double tau, double kt) :
      decay(std::exp(-std::fabs(h) / tau)), variance(-kt * std::expm1(-2.0 * std::fabs(h) / tau))
  {
  }

  /// Changes the velocity and omega_body where `acts`.  Returns the change of the kinetic energy.
  double take(const RigidBody &body, const std::array<bool, 6> &acts,
              const std::array<double, 6> &normal, BodyState &state) const
  {
    double twice = 0.0;
    for (int i = 0; i < 6; ++i) {
      const double mass = i < 3 ? body.mass : body.inertia[i - 3];
      double &v = i < 3 ? state.velocity[i] : state.omega_body[i - 3];
      if (!acts[i] || !(mass > 0.0)) continue;
      const double before = v;
      v = decay * v + std::sqrt(variance / mass) * normal[i];
      twice += mass * (v * v - before * before);
    }
    return 0.5 * twice;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
