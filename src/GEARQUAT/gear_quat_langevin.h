/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Langevin dynamics of a body.  Momenta and angular momenta obey

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

#ifndef GEAR_QUAT_LANGEVIN_H
#define GEAR_QUAT_LANGEVIN_H

#include "gear_quat_math.h"

#include <array>
#include <cmath>
#include <cstdint>

namespace LAMMPS_NS::GearQuat {

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
