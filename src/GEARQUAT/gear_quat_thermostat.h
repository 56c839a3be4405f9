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

#include "gear_quat_arguments.h"
#include "gear_quat_chain.h"
#include "gear_quat_coupling.h"
#include "gear_quat_exact_sum.h"
#include "gear_quat_momentum.h"

#include <array>
#include <string>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Thermostat : public Coupling {
 public:
  static constexpr double FEWEST_STEPS = 10.0;    ///< of a damping time, otherwise a warning
  /// Elements of the fix's vector behind those of Sums, and of Tolerance.
  enum { ENERGY, T_TRANSLATION, T_ROTATION, TARGET, XI_TRANSLATION, XI_ROTATION, ELEMENTS };

  /// scheme: the one with most values.
  Thermostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const ThermostatWords &words,
             const Scheme &scheme);

  /// Ends the run if there is nothing to be thermostatted, or if the friction would be too strong.
  void begin_run(bool anew, double h) override;
  void set_scheme(const Scheme &scheme) override;
  double friction_ahead(double h) const override;
  bool awaits_forces() const override { return true; }
  void meet_forces() override;
  /// Where histories begin, the total momentum is judged by the present forces alone.  Ends the run
  /// if nothing that could be thermostatted moves.
  void begin_steps(bool begins) override;
  void end_run() override { tell_freedoms(); }
  /// If the target, or a degree of freedom, is not as in the steps before this run.
  const char *reason_to_start_anew() const override;

  /// The rates of the chains are known then, too.
  void measure() override;
  Load acting(int ibody) const override
  {
    return damped_load(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.acting(ibody),
                       friction_of(ibody));
  }
  void correct(const Integrator &integrator, int passes) override;
  /// Warns once of bodies that a thermostat cannot warm, and of a friction that is nearly too
  /// strong.
  void note_step(double h) override;
  /// The step holds, so that its forces tell whether the total momentum is constant.
  void follow_changes(double h) override;
  void follow_velocities(double h) override;
  void keep() override { kept = chains; }
  void put_back() override { chains = kept; }
  double longest_step() const override;
  void errors(const VariableOrder &order, double h, int values,
              const Include &include) const override;
  Cause instability(double h) const override;

  void begin_start(const StartNodes &nodes) override;
  void foretell(const StartNodes &nodes) override;
  void visit_node(const StartNodes &nodes, int node) override;
  void settle(const StartNodes &nodes, int pair) override;
  void seed(const StartNodes &nodes, int pairs, int values) override;
  void seed_local(double h, int terms) override;

  int elements() const override { return ELEMENTS; }
  double element(int n) override;
  bool extensive(int n) const override { return n == ENERGY; }
  /// What the chains have taken from the bodies.
  double energy() const override;

  void write(Sections &file) const override;
  /// Of as many chains of as many variables.
  std::string read(const Sections &file) override;

 protected:
  friend class Coupling;    // calls what correct_by_passes() asks for

  const Fix *fix;
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
  double most_friction;               ///< times the step, that bodies can follow
  bool single_pass;                   ///< of the corrector
  bool strong = false;                ///< the friction of this step is taken implicitly
  double unit = 1.0;                  ///< of the sums, see scale()
  double cold[2] = {};                ///< for how long the parts have been cold
  bool warned[2] = {};                ///< of that
  bool warned_friction = false;
  TotalMomentum total;

  std::vector<Collocation::Scalar> twice_at_nodes;    ///< 2K of the chains
  std::vector<bool> held;                             ///< chains that do not move in the start

  int mode() const { return words.separate ? 2 : 1; }
  /// False without keyword temp: the object only knows degrees of freedom and kinetic energies.
  bool acts() const { return !chains.empty(); }
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
  void add_kinetic(int ibody, const double *velocity, const double *omega_body, Sums &sums) const;
  /// of_states: with the total momentum, and the forces, that states and loads have.
  void sum_kinetic(const Sums &sums, bool of_states);
  double scale() const;
  void sum_present();
  void note_friction();
  void share_friction();
  /// 2K about the start, in units of the node spacing.
  static ChainDrive drive_of(const Collocation &collocation, const Collocation::Scalar &twice);
  void watch_cold(double h);
  void watch_friction(double h);
  double part_of_limit(double h) const;
  Chain::LeftOut left_out(double h, int values) const;
  /// Rank 0 tells the degrees of freedom if they are not those that it has told last.  why: what
  /// comes before.
  virtual void tell_freedoms(const std::string &why = "");

  // the passes of a step

  Sums here;           ///< twice the kinetic energies of owned bodies, in a pass
  bool same_bodies;    ///< none has come or gone in this step
  static constexpr bool SUMS_OF_LAST_PASS = false;
  void begin_passes(const Integrator &integrator);
  void add_prediction(const Integrator &integrator, int ibody, const Integrator::Pending &);
  void find_friction(const Integrator &integrator, int pass);
  void add(int ibody, const double *velocity, const double *omega_body, const Integrator::Pending &)
  {
    add_kinetic(ibody, velocity, omega_body, here);
  }
  void end_passes(const Integrator &);
  void finish(const Integrator &, const RigidBody &, double *) const {}
  void advance(int chain, double twice_kinetic, double h, int values);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
