/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword temp: Nose-Hoover chains (gear_quat_chain.h) that control the temperature of all bodies.
   The chains need the kinetic energies of all bodies on all ranks.  Every pass of the corrector
   therefore reduces exact sums over all ranks, so that a run does not depend on the distribution of
   bodies.  A component of a momentum that is turned off by keywords force and torque is not
   thermostatted, and neither is a constant total momentum (gear_quat_momentum.h).  Bodies may start
   from rest: the friction then becomes negative until forces have moved them.

   As in LAMMPS' thermostats, the target of a step changes linearly with the number of the step from
   the beginning to the end of the run.  A run without steps changes nothing.

   Insertion or removal of bodies changes the degrees of freedom and the kinetic energy at the end
   of a step.  The chains then receive the new derivatives.  In such a step they are predicted and
   not corrected. */

#ifndef LMP_GEAR_QUAT_THERMOSTAT_H
#define LMP_GEAR_QUAT_THERMOSTAT_H

#include "gear_quat_arguments.h"
#include "gear_quat_chain.h"
#include "gear_quat_coupling.h"
#include "gear_quat_exact_sum.h"
#include "gear_quat_momentum.h"

#include <string>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Thermostat : public Coupling {
 public:
  static constexpr double FEWEST_STEPS = 10.0;    ///< in a damping time, otherwise a warning
  /// Elements of the fix's vector after the elements of Sums and Tolerance.
  enum { ENERGY, T_TRANSLATION, T_ROTATION, TARGET, XI_TRANSLATION, XI_ROTATION, ELEMENTS };

  /// scheme: the one with most values.
  Thermostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const ThermostatWords &words,
             const Scheme &scheme);

  /// Ends the run if there is nothing to thermostat.
  void begin_run(bool anew, double h) override;
  void set_scheme(const Scheme &scheme) override;
  void subtract(int freedoms) override { words.subtracted = freedoms; }
  /// A reason if the target or the degrees of freedom have changed since the last run.
  const char *reason_to_start_anew() const override;

  /// Also computes the rates of the chains.
  void measure() override;
  Load acting(int ibody) const override
  {
    return damped_load(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.acting(ibody),
                       friction_of(ibody));
  }
  void correct(const Integrator &integrator, int passes) override;
  /// Warns once of bodies that a thermostat cannot warm.
  void note_step(double h) override;
  void follow_changes(double h) override;
  void follow_velocities(double h) override;
  void keep() override { kept = chains; }
  void put_back() override { chains = kept; }
  double longest_step() const override;
  void errors(double h, int values, const Include &include) const override;
  std::vector<Rate> rates(double h, bool ahead) const override;

  void begin_start(const StartNodes &nodes) override;
  void foretell(const StartNodes &nodes) override;
  void visit_node(const StartNodes &nodes, int node) override;
  void settle(const StartNodes &nodes, int pair) override;
  void seed(const StartNodes &nodes, int pairs, int values) override;
  void seed_local(double h, int terms) override;

  int elements() const override { return ELEMENTS; }
  double element(int n) override;
  bool extensive(int n) const override { return n == ENERGY; }
  /// The energy that the chains have removed from the bodies.
  double energy() const override;

  void fields(Fields &v) override;

 protected:
  friend class Coupling;    // calls the functions required by correct_by_passes()

  const Fix *fix;
  ThermostatWords words;

  enum Part { TRANSLATION, ROTATION };
  struct Line {    ///< kT of a step, and its change with every step
    double kt = 0.0, kt_step = 0.0;
    template <class V> void fields(V &v) { v(kt, kt_step); }
  };
  struct Setting {    ///< of a step
    Line line;
    double freedoms[2], damp;
    template <class V> void fields(V &v) { v(line, freedoms, damp); }
  };

  std::vector<Chain> chains, kept;    ///< of both parts, or one for both
  double freedoms[2] = {};            ///< of both parts
  double twice[2] = {};               ///< twice the kinetic energies, as of the last sum
  bigint counted = 0;                 ///< number of bodies in the freedoms
  int changes = 0;                    ///< Bodies::changes() then
  bigint natoms = 0;                  ///< all atoms then: others decide whether momentum counts
  std::string told;                   ///< last message of the degrees of freedom
  Line line;                          ///< the target of the present step
  double damp_before = 0.0;           ///< of the steps so far
  Setting made = {};                  ///< of the last step before this run
  bool waiting = false;               ///< no step of this run has begun
  double friction[2] = {};            ///< xi_1 of the chains
  bool single_pass;                   ///< of the corrector
  bool strong = false;                ///< the friction of this step is taken implicitly
  double unit = 1.0;                  ///< of the sums, see scale()
  double cold[2] = {};                ///< time that the parts have been cold
  bool warned[2] = {};                ///< of that
  TotalMomentum total;

  std::vector<Collocation::Scalar> twice_at_nodes;    ///< 2K of the chains
  std::vector<bool> held;                             ///< chains that are constant during the start

  /// False without keyword temp: the object only provides degrees of freedom and kinetic energies.
  bool acts() const { return !chains.empty(); }
  Line line_of_step(bigint step) const;
  ChainTarget target_of(int chain, double steps_ahead, double h) const;
  double twice_of(int chain) const;
  double freedoms_of(int chain) const;
  bool is_thermostatted(int ibody, Part part, int component = 0) const;
  /// The friction of a body without masks, in the current pass.
  Friction of_all;
  Friction friction_of(int ibody) const;
  Setting setting() const;
  void count_freedoms();
  void refuse_masks() const;
  double strongest_friction() const;
  void refuse_nothing() const;
  using Sums = ExactSum[2];
  void add_kinetic(int ibody, const double *velocity, const double *omega_body, Sums &sums) const;
  void sum_kinetic(const Sums &sums);
  double scale() const;
  void sum_present();
  void note_friction();
  void share_friction();
  /// 2K around the start, in units of the node spacing.
  static ChainDrive drive_of(const Collocation &collocation, const Collocation::Scalar &twice);
  void tell_freedoms();
  /// Rank 0 prints the message if it differs from the last one.
  void tell_once(std::string &last, const std::string &message) const;

  // the passes of a step

  Sums here;           ///< twice the kinetic energies of owned bodies, in a pass
  bool same_bodies;    ///< no insertion or removal in this step
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
