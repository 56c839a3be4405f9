/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The temperature of all bodies: its target, their degrees of freedom, and their kinetic energies as
   exact sums over all ranks, so that a run does not depend on the distribution of bodies.

   As in LAMMPS' thermostats, the target of a step changes linearly with the number of the step from
   the beginning to the end of the run.

   A component of a momentum that is turned off by keywords force and torque has no temperature.
   Neither has the total momentum P in a direction in which it is constant.  By a rule, this is so if
   the box is periodic along it, all atoms are in bodies of this fix, keyword force holds none of
   them, and no other fix or pair style exerts forces from outside.  Friction then acts on momenta
   relative to the common motion V = P/M, and n bodies have n - 1 degrees of freedom of translation in
   this direction:

     p' = F - xi (p - m V),   2 K = sum p^2/m - P^2/M                                       (T5)

   so that a common motion is conserved and affects nothing else.  In all other directions friction
   acts on whole momenta, including P.  fix_modify extra/dof replaces the rule.  V belongs to every
   sum, because a deviation from it would grow.

   With fix deform remap v, the velocity of each center is relative to the flow at its place, which is
   linear between the faces; rotations are not. */

#ifndef LMP_GEAR_QUAT_TEMPERATURE_H
#define LMP_GEAR_QUAT_TEMPERATURE_H

#include "domain.h"
#include "gear_quat_arguments.h"
#include "gear_quat_chain.h"
#include "gear_quat_sites.h"

#include <array>
#include <string>

namespace LAMMPS_NS::GearQuat {

class Temperature : protected Scene {
 public:
  enum Part { TRANSLATION, ROTATION };
  static constexpr Mask NO_TORQUE = torque_off(0) | torque_off(1) | torque_off(2);
  struct Line {    ///< kT of a step, and its change with every step
    double kt = 0.0, kt_step = 0.0;
    template <class V> void fields(V &v) { v(kt, kt_step); }
  };

  Line line;                  ///< the target of the present step
  double freedoms[2] = {};    ///< of both parts
  double twice[2] = {};       ///< twice the kinetic energies, without P^2/M
  Upper tensor;               ///< sum m v_a v_b, without M V_a V_b; with a pressure only
  double common[3] = {};      ///< V of the last sum, 0 where P is not constant

  /// Without keyword temp, it is the temperature for the mass of a box.
  explicit Temperature(const Scene &scene);

  /// Counts and sums.  A run without steps keeps the last target.  anew: there are no histories.
  /// Collective.
  void begin_run(bool anew);
  /// The target of that step becomes the present one.
  void aim(bigint step);
  /// For a chain, a number of steps of h ahead.
  ChainTarget target(double of_freedoms, double period, double steps_ahead, double h) const;

  /// Counts the degrees of freedom.  Collective.
  void count();
  /// False if atoms or bodies have come or gone since count().
  bool is_counted() const;
  /// True if that momentum has a temperature, apart from the total momentum.  In two dimensions
  /// bodies turn only about z.
  bool has(int ibody, Part part, int component = 0) const
  {
    const Mask off = bodies.body[ibody].off;
    if (part == TRANSLATION) return component < domain->dimension && !(off & force_off(component));
    return domain->dimension == 2 ? !(off & torque_off(2)) : (off & NO_TORQUE) != NO_TORQUE;
  }

  // sums over bodies: begin(), add() for owned bodies, and the collective sum()

  void begin();
  double unit_of_energies() const;
  /// Up to LANES bodies, of which owned ones count.
  void add(int count, const int *ids, const Velocities &velocities);
  void sum();
  /// Of the present states.  Collective.
  void sum_present();

  /// True with fix deform remap v.
  bool has_flow() const;
  /// The velocity of the flow at the center of a body.
  std::array<double, 3> flow_at(int ibody) const;

  // after count()

  bool has_translation() const { return count_of[0] + count_of[1] + count_of[2] > 0.0; }
  /// Rank 0 prints them, unless they are as before, and whether the total momentum counts, and why.
  void tell_freedoms(const char *of);

  void fields(Fields &v);

 private:
  const ThermostatWords &words;
  double start, stop;    ///< the target of a run

  bool constant[3] = {}, stated = false;
  std::string outside;    ///< what exerts forces from outside, empty for nothing
  int of_total = 0;       ///< degrees of freedom of P that do not count
  double count_of[3] = {}, mass[3] = {};
  int changes = 0;      ///< Bodies::changes() in count()
  bigint natoms = 0;    ///< all atoms then: others decide whether momentum counts
  enum { TENSOR = 2, MOMENTUM = TENSOR + Upper::SIZE, SUMS = MOMENTUM + 3 };
  ExactSumOf<Lanes> sums[SUMS];    ///< twice the kinetic energies, the tensor, and P
  struct Wanted {
    double energies, momenta;    ///< units of the sums
    bool tensor;                 ///< instead of the energy of translation
    bool constant[3];            ///< components of P
  } wanted;
  struct Moving {    ///< bodies side by side
    Lanes mass, inertia[3];
    Velocities velocities;
  };

  static void add_to(ExactSumOf<Lanes> *sums, const Moving &moving, const Wanted &wanted);

  std::string told;    ///< last message
  std::string find_outside() const;
  void find_start();
  std::string description() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
