/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword temp: Nose-Hoover chains (gear_quat_chain.h) that hold the temperature of all bodies.
   They need the kinetic energies of all bodies on all ranks: a reduction in every pass of the
   corrector, of exact sums, so that a run does not depend on where bodies are.  A component of a
   momentum that keywords force and torque turn off belongs to no chain, nor does a total momentum
   that is constant (gear_quat_momentum.h).

   The target of a step is that of LAMMPS' thermostats: it changes linearly with the number of the
   step from the beginning to the end of the run.  A run without steps changes nothing.

   Bodies that come or go in a step change degrees of freedom and kinetic energy at its end, as do
   forces from outside that set in.  Then the chains receive the derivatives of the new ones.  In a
   step in which bodies come or go they are predicted and not corrected.

   Before the first step of a run begin_run() sees only the forces of fixes that are defined before
   this one, and meet_forces() all of them. */

#ifndef LMP_GEAR_QUAT_THERMOSTAT_H
#define LMP_GEAR_QUAT_THERMOSTAT_H

#include "gear_quat_bodies.h"
#include "gear_quat_chain.h"
#include "gear_quat_exact_sum.h"
#include "gear_quat_momentum.h"
#include "gear_quat_startup.h"
#include "pointers.h"

#include <array>
#include <string>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// What keywords temp, tchain and thermostat say.
struct ThermostatWords {
  double start = 0.0, stop = 0.0, damp = 0.0;    ///< damp 0: none
  int length = 0;
  bool separate = false;
  bool may_wait = false;    ///< bodies may come later, so that there may be none
};

class Thermostat : protected Pointers {
 public:
  /// Elements of the fix's vector behind those of Sums, and of Tolerance.
  static constexpr double FEWEST_STEPS = 10.0;    ///< of a damping time, otherwise a warning
  enum { ENERGY, T_TRANSLATION, T_ROTATION, TARGET, XI_TRANSLATION, XI_ROTATION, ELEMENTS };

  /// scheme: the one with most values.
  Thermostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const ThermostatWords &words,
             const Scheme &scheme);

  // all collective

  /// Before a run of steps of h.  Ends it if there is nothing to be thermostatted, or if the
  /// friction would be too strong.  anew: there are no histories.
  void begin_run(bool anew, double h);
  /// The loads are those of all fixes, before the first step of a run or of its output.
  void meet_forces();
  /// After meet_forces().  begins: histories do, so that the total momentum is judged by the present
  /// forces alone.  Ends the run if nothing that could be thermostatted moves.
  void begin_steps(bool begins);
  /// Friction by the present states and chains, whose rates are known then.
  void measure();
  /// One step of h: correct the predicted histories and states.
  void correct(const Integrator &integrator, const Scheme &scheme);
  /// The most of all chains in this step.
  Chain::LeftOut left_out(double h, int values) const;
  /// The target.
  double kt() const { return line.kt; }
  /// The present friction in a step of h, as a part of the strongest that bodies can follow.
  double part_of_limit(double h) const;
  /// A next step should not be longer.
  double longest_step() const;
  /// A step of h holds: warns once of bodies that a thermostat cannot warm.
  void watch_cold(double h);
  /// And of a friction that is nearly too strong.
  void watch_friction(double h);
  /// Bodies that have come in this step have histories, and none is left of those that have gone;
  /// the step holds, so that its forces tell whether the total momentum is constant.
  void follow_changes(double h);
  /// Bodies have received other velocities.
  void follow_velocities(double h);

  /// True if the target, or a degree of freedom, is not as in the steps before this run; after
  /// meet_forces().
  bool target_jumps() const;
  /// Rank 0 tells the degrees of freedom if they are not those that it has told last.  why: what
  /// comes before.
  void tell_freedoms(const std::string &why = "");

  // after measure()

  /// The load that moves a body: what is not turned off, with the friction.
  Load acting(int ibody) const
  {
    return damped_load(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.acting(ibody),
                       friction_of(ibody));
  }
  double element(int n);
  /// What the chains have taken from the bodies.
  double energy() const;

  // the start, of all bodies at the same nodes (gear_quat_startup.h), in
  // gear_quat_thermostat_start.cpp

  void begin_start(const Collocation &collocation, double spacing, double h);
  void foretell(const Collocation &collocation);
  /// As measure(), at another node.
  void measure_node(const Collocation &collocation, int node);
  void settle(const Collocation &collocation, int pair);
  /// values: of the method.
  void seed(const Collocation &collocation, int pairs, int values);
  /// From the present alone.
  void seed_local(double h);

  // As Bodies::keep_histories(), for a step that may be undone.
  void keep_chains() { kept = chains; }
  void put_back_chains() { chains = kept; }

  /// What a restart file holds, the same on all ranks.
  struct Checkpoint {
    double mode, length, bodies;                ///< mode: number of chains, 0 without a thermostat
    double kt, kt_step, period, freedoms[2];    ///< of the last step
    double constant;                            ///< TotalMomentum::record() then
    Chain::Record chains[2];
  };
  Checkpoint checkpoint() const;
  /// saved: of as many chains of as many variables.
  void restore(const Checkpoint &saved);

 private:
  const Fix *fix;
  Bodies &bodies;
  ThermostatWords words;

  enum Part { TRANSLATION, ROTATION };
  struct Line {    ///< kT of a step, and its change with every step
    double kt = 0.0, kt_step = 0.0;
  };
  struct Setting {    ///< of a step
    Line line;
    double freedoms[2], damp, constant;
  };

  std::vector<Chain> chains, kept;    ///< of both parts, or one for both
  double freedoms[2] = {};            ///< of both parts
  double twice[2] = {};               ///< twice the kinetic energies, as of the last sum
  bigint counted = 0;                 ///< bodies that the freedoms belong to
  int changes = 0;                    ///< Bodies::changes() then
  std::array<double, 3> told = {};    ///< the freedoms that the log has, and their total momentum
  Line line;                          ///< the target of the present step
  double damp_before = 0.0;           ///< of the steps so far
  Setting made = {};                  ///< of the last step before this run
  bool waiting = false;               ///< no step of this run has begun
  bool anew = false;                  ///< where it began there were no histories
  double friction[2] = {};            ///< xi_1 of the chains
  const double most_friction;         ///< times the step, that bodies can follow
  const bool single_pass;             ///< of the corrector
  bool strong = false;                ///< the friction of this step is taken implicitly
  double unit = 1.0;                  ///< of the sums, see scale()
  double cold[2] = {};                ///< for how long the parts have been cold
  bool warned[2] = {};                ///< of that
  bool warned_friction = false;
  TotalMomentum total;
  std::vector<Integrator::Pending> pending;

  double spacing = 0.0, step_of_start = 0.0;
  std::vector<Collocation::Scalar> nodes;    ///< 2K of the chains
  std::vector<bool> held;                    ///< chains that do not move while bodies start

  int mode() const { return words.separate ? 2 : 1; }
  Line line_of_step(bigint step) const;
  ChainTarget target_of(int chain, double steps_ahead, double h) const;
  double twice_of(int chain) const;
  double freedoms_of(int chain) const;
  bool is_thermostatted(int ibody, Part part, int component = 0) const;
  /// Of a body without masks, in the present pass.
  Friction of_all;
  Friction friction_of(int ibody) const;
  Setting setting() const;
  void count_freedoms();
  void judge(double constant);
  void refuse_masks() const;
  void refuse_friction(double h) const;
  double strongest_friction() const;
  void settle_fresh(double h);
  void refuse_nothing(bool meets_all) const;
  using Sums = ExactSum[2];
  void add_kinetic(int ibody, const double *velocity, const double *omega_body, Sums &here) const;
  /// of_states: with the total momentum, and the forces, that states and loads have.
  void sum_kinetic(const Sums &here, bool of_states);
  double scale() const;
  void sum_present();
  void note_friction();
  void share_friction();
  /// act: of the index of every body on this rank that has a history, owned or large.
  template <class Act> void for_moved(Act act) const
  {
    for (const auto *list : {&bodies.points, &bodies.tops})
      for (const int ibody : *list) act(ibody);
  }
  void advance(int chain, double twice_kinetic, double h, int values);
  void finish_body(const Integrator &integrator, int ibody);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
