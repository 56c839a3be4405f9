/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keywords that act on all bodies of a fix together.  The last three act by a friction that depends
   on sums over all bodies:

     keyword langevin      a random step of all momenta between steps (gear_quat_friction.h)
     keyword temp          Nose-Hoover chains (gear_quat_chain.h), driven by the temperature
     keyword isokinetic    Gauss's principle (gear_quat_temperature.h)
     keywords of pressure  a box that moves (gear_quat_barostat.h), with chains or without

   Without these three acts() is false, and bodies move by their own loads.

   In every step one sum over all bodies determines friction, chains and box at its end, and then each
   body is corrected once.  The terms are the velocities that the bodies would have without friction:
   an implicit friction divides them by the same factor, so its equation needs no other sum.  Bodies
   may start from rest: the friction of a chain is negative until forces have moved them.  When bodies
   come or go, chains are predicted and not corrected, and receive their new derivatives at the end of
   the step.

   The start finds histories by collocation (gear_quat_startup.h).  It calls either seed_local()
   alone, or begin_start(); for every pair of nodes foretell(), visit_node() at both nodes and
   settle(); and seed() at the end.

   Functions are collective unless they say otherwise. */

#ifndef LMP_GEAR_QUAT_BATH_H
#define LMP_GEAR_QUAT_BATH_H

#include "gear_quat_arguments.h"
#include "gear_quat_barostat.h"
#include "gear_quat_history.h"
#include "gear_quat_stability.h"
#include "gear_quat_temperature.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Bath : protected Pointers {
  Temperature temperature;

 public:
  Barostat box;

  Bath(LAMMPS *lmp, const Fix *fix, const Arguments &args, Bodies &bodies, const Sites &sites);

  bool acts() const { return thermostats > 0 || isokinetic.acts() || box.moves(); }
  /// After a step its states are read.
  bool reads_states() const { return isokinetic.acts() || words.is_random(); }
  /// A temperature is defined for the bodies, by chains, random steps or a box.
  bool has_temperature() const { return words.damp > 0.0 || box.moves(); }
  /// False if its variables would be lost in a start.
  bool may_start_anew() const { return !isokinetic.acts(); }

  // before a run

  /// States and loads belong to the first step, of length h; LAMMPS' setup may not have evaluated
  /// the forces of all fixes yet.  anew: there are no histories.  Ends the run if the keywords
  /// cannot act on these bodies.
  void begin_run(bool anew, double h);
  /// The scheme of the bodies has changed; there are no histories.  Local.
  void set_scheme(const Scheme &scheme);
  /// fix_modify extra/dof: degrees of freedom of translation that do not count.  Local.
  void subtract(int freedoms) { temperature.subtracted = freedoms; }
  /// A reason for a new start of histories, null for none.
  const char *reason_to_start_anew() const;

  // in a step

  /// Random changes of momenta during half a step, before (half 0) and after the step of the
  /// integrator.
  void take_random_half(const Integrator &integrator, int half);
  /// Histories are predicted.
  void predict(const Integrator &integrator);
  /// Computes friction and rates from the present states and loads.
  void measure();
  /// The load on a body, including the friction; to be called after measure().  Local.
  Load acting(int ibody) const;
  /// Before bodies are corrected: sums over all bodies, with predicted histories and scaled loads,
  /// determine friction, chains and box at the end of the step.
  void begin_correction(double h);
  bool needs_sums() const { return acts() && !isokinetic.acts(); }
  void add(const Integrator &integrator, const Block &block, const int *ids);    ///< local
  void find_friction(const Integrator &integrator);
  void conclude(double h);    ///< local
  /// Of a body without masks or a flow, whose center is scaled.  Local.
  const Friction &friction() const { return box.moves() ? box.friction() : of_all; }
  /// Each body has a friction of its own, relative to the flow at its place.
  bool has_flow() const { return temperature.has_flow(); }
  Friction friction_of(int ibody) const;
  Load scaled(const Load &load) const { return box.moves() ? box.scaled(load) : load; }
  /// Corrected states with scaled centers become unscaled.  predicted: their scaled centers.  Local.
  void place(const Block &block, const int *ids, const double (*predicted)[3]);
  void end_correction(const Integrator &integrator);
  /// Called in an accepted step, after insertions have histories and removals are complete.
  void follow_changes(double h);
  /// Saves variables for a step that may be undone; put_back() restores them.  Local.
  void keep();
  void put_back();
  /// The step of the histories changes.  Local.
  void rescale(double ratio);
  /// Longest next step; infinite for no limit.  Local.
  double longest_step() const;
  /// The errors in this step of h of chains and box, as energies or as lengths.  Local.
  std::array<double, 2> errors(bool as_energy, double h, int values) const;
  /// Rows of the table of rates, for steps of h.  Local.
  std::vector<Rate> rates(double h) const;

  // the start

  void begin_start(const StartNodes &nodes);
  void foretell(const StartNodes &nodes);    ///< local
  /// Computes friction and rates from the states and loads of a node, like measure().
  void visit_node(const StartNodes &nodes, int node);
  void settle(const StartNodes &nodes, int pair);    ///< local
  /// Makes histories from the innermost `pairs`.  values: of the method.  Local.
  void seed(const StartNodes &nodes, int pairs, int values);
  /// Makes histories from the present alone, after measure(), with `terms` terms for bodies.
  void seed_local(double h, int terms);

  // elements of the fix's vector

  int elements() const;
  double element(int n);
  /// True if the element is proportional to the number of bodies.
  bool extensive(int n) const;
  /// The energy that random steps, chains and box have taken from the bodies.
  double energy() const;

  void fields(Fields &v);

 private:
  /// Elements of the fix's vector after the elements of Outputs and Tolerance; with isokinetic:
  enum { HEAT, ALPHA_TRANSLATION, ALPHA_ROTATION, ELEMENTS_OF_ISOKINETIC };
  /// Otherwise, before those of a moving box:
  enum { ENERGY, T_TRANSLATION, T_ROTATION, TARGET, XI_TRANSLATION, XI_ROTATION, ELEMENTS };

  Bodies &bodies;
  ThermostatWords words;
  const int thermostats;              ///< number of chains: of both parts, or one for both
  std::vector<Chain> chains, kept;    ///< the last one is that of the box, if it has one
  IsokineticConstraint isokinetic;
  double randomly_taken = 0.0;      ///< energy, from bodies that this rank owns
  ScalarHistory heat, kept_heat;    ///< removed by isokinetic, or S of the box
  int values_of_heat = 0;
  CorrectorCoefficients::Array coefficients_of_heat;    ///< of a first-order equation

  std::vector<double> made;    ///< setting() of the last step
  bool same_bodies = true;     ///< no insertion or removal in this step
  enum { OF_BOX = 2 };
  double xi[3] = {};    ///< xi_1 of the chains
  Friction of_all;      ///< of a body without masks or a flow, in the current pass
  std::string told;     ///< last message of the degrees of freedom

  // the start: 2K, which drives a chain from the start to each node, and the rate of the heat

  std::vector<Collocation::Scalar> at_nodes;
  std::vector<bool> held;    ///< chains that are constant during the start
  std::vector<double> rates_of_unknowns() const;

  double &xi_of(int chain) { return xi[chain < thermostats ? chain : OF_BOX]; }
  double of_both(int chain, const double (&parts)[2]) const;
  double twice_of(int chain) const;
  ChainTarget target_of(int chain, double steps_ahead, double h) const;
  double strongest_friction() const;
  std::vector<double> setting() const;
  void refuse_bodies() const;
  void tell_freedoms();
  template <class Act> void for_moved(Act act);
  void sum_present();
  void note_friction();
  void settle_fresh(double h);
  void share_friction();
  void begin_passes(double h);
  void advance(int chain, double twice_kinetic, double h, int values);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
