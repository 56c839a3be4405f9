/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keywords that act on all bodies of a fix together.  The last three act by a friction that depends
   on sums over all bodies:

     keyword langevin      a random step of all momenta between steps (gear_quat_friction.h)
     keyword temp          Nose-Hoover chains (gear_quat_chain.h), driven by the temperature
     keyword isokinetic    Gauss's principle (gear_quat_friction.h)
     keywords of pressure  a box that moves (gear_quat_barostat.cpp), with chains or without

   Without these three acts() is false, and bodies move by their own loads.

   In every step one sum over all bodies determines friction, chains and box at its end, and then each
   body is corrected once.  The terms are the velocities that the bodies would have without friction:
   an implicit friction divides them by the same factor, so its equation needs no other sum.  Bodies
   may start from rest: the friction of a chain is negative until forces have moved them.

   The start finds histories by collocation (gear_quat_startup.h).  It calls either seed_local()
   alone, or begin_start(); for every pair of nodes foretell(), visit_node() at both nodes and
   settle(); and seed() at the end.

   Functions are collective unless they say otherwise.

   With keywords iso, aniso, tri, x, y, z, xy, xz and yz the box moves so that components of the
   molecular pressure have their targets, with keyword temp (NPT) or without (NPH); doc/theory.md,
   Eqs. P1 to P9.

     W G_ab' = sum m v_a v_b + delta_ab b_a sum m v^2 + W_ab - P_ab V delta_ab - W xi G_ab        (P2)

   for the free components.  v is relative to a constant common motion, and W_ab is the molecular
   virial (Eq. P6 below).  The weights are b = 1/N_f with the translational degrees of freedom
   N_f, or (3, 1, -1)/N_f if the box shears.  The mass is W = (N_f + d) kT Pdamp^2/d.  Coupled
   components have the mean of their right-hand sides.  xi is the friction of a chain of the box.
   The energy

     U + K + sum W G_ab^2/2 + P V + S + energies of the chains,                                 (P7)
     S' = V sum (P_ab - P delta_ab) G_ab - V P' - sum (W'/2) G_ab^2,   P = sum P_aa/d

   is constant.  The box (gear_quat_box.h) moves as the bodies do: a step predicts the box, LAMMPS
   evaluates the forces in the predicted box, and the sums over the bodies correct the box.  Atoms
   in no body, which do not move by themselves, keep their places relative to the box.

   The virial of the centers of mass of all bodies is (Eq. P6)

     W_ab = sum over pairs of F_a (R_ij)_b = V_ab - sum_i (f_i)_a (d_i)_b,      a <= b,

   where V is the virial of LAMMPS' styles for atoms, and f_i and d_i are force and arm of site i.
   It needs no constraint forces.  LAMMPS computes V in the requested steps.

   As in LAMMPS, the force of another fix counts if the fix adds it to the virial (fix_modify virial
   yes).  Fixes exert their forces in the order of their definition, so those whose forces count come
   before this one, and all others after it: f_i are the forces of styles and of the fixes before. */

#ifndef LMP_GEAR_QUAT_BATH_H
#define LMP_GEAR_QUAT_BATH_H

#include "gear_quat_arguments.h"
#include "gear_quat_box.h"
#include "gear_quat_remembered_loads.h"
#include "gear_quat_stability.h"
#include "gear_quat_temperature.h"

#include <optional>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class Compute;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

/// The nodes of a start, centered at the present time.
struct StartNodes {
  const Collocation &collocation;
  double spacing;    ///< time between nodes
  double h;          ///< the step of the histories
};

class Bath : protected Scene {
 public:
  /// With a pressure it adds compute ID_virial, which requests the virial from LAMMPS.
  explicit Bath(const Scene &scene);
  ~Bath() override;

  bool is_isokinetic() const { return args.isokinetic != Isokinetic::NONE; }
  bool acts() const { return thermostats > 0 || is_isokinetic() || moves_box(); }
  /// A box moves with the bodies.
  bool moves_box() const { return !id.empty(); }
  /// After a step its states are read.
  bool reads_states() const { return is_isokinetic() || words.is_random(); }
  /// A temperature is defined for the bodies, by chains, random steps or a box.
  bool has_temperature() const { return words.damp > 0.0 || moves_box(); }
  /// False if its variables would be lost in a start.
  bool may_start_anew() const { return !is_isokinetic(); }

  // before a run

  /// States and loads belong to the first step, of length h; LAMMPS' setup may not have evaluated
  /// the forces of all fixes yet.  anew: there are no histories.  Ends the run if the keywords
  /// cannot act on these bodies.
  void begin_run(bool anew, double h);
  /// The scheme of the bodies has changed; there are no histories.  Local.
  void set_scheme(const Scheme &scheme);
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
  bool needs_sums() const { return acts() && !is_isokinetic(); }
  void add(const Integrator &integrator, const Block &block, const int *ids);    ///< local
  void find_friction(const Integrator &integrator);
  /// Of a body without masks or a flow, whose center is scaled.  Local.
  const Friction &friction() const { return moves_box() ? of_bodies : of_all; }
  /// Each body has a friction of its own, relative to the flow at its place.
  bool has_flow() const { return temperature.has_flow(); }
  Friction friction_of(int ibody) const;
  Load scaled(const Load &load) const
  {
    Load found = load;
    if (moves_box()) box.inverse_matrix().times(load.force, found.force);
    return found;
  }
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
  /// Rows of the table of rates, for steps of h.  Local.
  std::vector<Rate> rates(double h) const;

  // a box that moves; without it these functions do nothing

  /// From the forces f on atoms, in post_force() of the fix.
  void measure_virial(double **f);
  /// False if in the present step LAMMPS needs the virial of the constraint forces only for this.
  /// Local.
  bool others_ask_for_virial() const;
  BodyState scaled(const BodyState &s) const
  {
    BodyState found = s;
    if (moves_box()) box.to_scaled(found);
    return found;
  }
  /// A state becomes unscaled.
  void to_space(BodyState &state) const { box.to_space(state); }
  /// The step of length h is accepted.
  void note_step(double h)
  {
    if (times) times->conclude(h);
  }
  /// The work of the displacement at the faces by the local error, or the displacement.  Local.
  double error_of_box(bool as_energy, double h) const;
  /// True if the box is tilted so much that another cell of the same lattice should replace it.
  bool is_tilted() const { return asked.shears() && asked.flip && box.is_tilted(); }
  /// Replaces a tilted box, before atoms are exchanged.
  void flip();

  // the start

  /// The present box becomes the reference, and keeps its rate.  Local.
  void refer_to_box(double h);
  /// Sets the box of a node, and unscales the states, whose centers are scaled.  Local.
  void enter_node(const StartNodes &nodes, int node);
  /// Restores the box of the start.  Local.
  void leave_nodes();
  /// LAMMPS' vflag for the evaluation of forces at nodes.
  int vflag() const;
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
  /// Elements of the fix's vector after those of the bodies and of Tolerance; with isokinetic:
  enum { HEAT, ALPHA_TRANSLATION, ALPHA_ROTATION, ELEMENTS_OF_ISOKINETIC };
  /// Otherwise, those from PRESSURE on with a moving box:
  enum {
    ENERGY,
    T_TRANSLATION,
    T_ROTATION,
    TARGET,
    XI_TRANSLATION,
    XI_ROTATION,
    PRESSURE,
    P_COMPONENT,    ///< xx yy zz xy xz yz
    P_TARGET = P_COMPONENT + 6,
    STRAIN_RATE,    ///< xx yy zz
    E_BOX = STRAIN_RATE + 3,
    XI_BOX,
    ELEMENTS
  };

  Temperature temperature;
  const ThermostatWords &words;
  const PressureWords &asked;
  const std::string id;               ///< of the compute; empty: the box does not move
  const int thermostats;              ///< number of chains: of both parts, or one for both
  std::vector<Chain> chains, kept;    ///< the last one is that of the box, if it has one
  double randomly_taken = 0.0;        ///< energy, from bodies that this rank owns
  ScalarHistory heat, kept_heat;      ///< removed by isokinetic, or S of the box
  int values_of_heat = 0;
  CorrectorCoefficients::Array coefficients_of_heat;    ///< of a first-order equation

  std::vector<double> made;    ///< setting() of the last step
  enum { OF_BOX = 2 };
  double xi[3] = {};    ///< xi_1 of the chains
  Friction of_all;      ///< of a body without masks or a flow, in the current pass

  // keyword isokinetic: sums over all bodies, which give the multipliers of Gauss's principle
  // (gear_quat_friction.h), and the kinetic energy that stays constant

  KineticSums sums, conserved;
  Multipliers alpha;
  bigint counted = 0;    ///< number of bodies in the conserved energy

  // the box

  Upper virial;    ///< of centers of mass, in units of mass times velocity squared
  Box box;
  CellHistory cell, kept_cell;
  std::optional<RememberedLoads> times;    ///< with a changing step: of the last drives of the box
  double width = 0.0;                      ///< the step of the histories
  Upper present_target;                    ///< pressures, of this step
  Upper target_rate;                       ///< change of these targets with time
  double time_of_node = 0.0;               ///< since the present step

  Upper box_rate;       ///< G in the present pass, or at a node
  Upper correction;     ///< of M M^-1 by the corrector, in the last step
  Upper local_error;    ///< of M M^-1, of the last step
  Friction of_bodies;

  // the start: 2K, which drives a chain from the start to each node, and the rate of the heat

  std::vector<Collocation::Scalar> at_nodes;
  std::vector<bool> held;    ///< chains that are constant during the start
  Collocation::Nodes cell_at_nodes = {};
  std::vector<double> rates_of_unknowns() const;

  double &xi_of(int chain) { return xi[chain < thermostats ? chain : OF_BOX]; }
  double of_both(int chain, const double (&parts)[2]) const;
  double twice_of(int chain) const;
  ChainTarget target_of(int chain, double steps_ahead, double h) const;
  double strongest_friction() const;
  std::vector<double> setting() const;
  void refuse_bodies() const;
  void sum_present();
  void note_friction();
  void settle_fresh(double h);
  void share_friction();
  void find_multipliers();
  void conserve_energy(bool anew);
  void scale(const Integrator &integrator);
  void conclude(double h);
  void advance(int chain, double twice_kinetic, double h, int values);

  double weight_of(int direction) const;
  double kt_of_box() const;
  Upper masses() const;
  double mean_of(const Upper &pressures) const;
  double twice_of_box() const;
  /// Coupled directions have one degree of freedom.
  int freedoms_of_box() const;
  /// The shortest damping time.
  double period_of_box() const;
  /// S' of Eq. P7.
  double rate_of_heat() const;
  double element_of_box(int n);
  void find_target(bigint step, double h);
  Upper target() const { return present_target + target_rate.scaled(time_of_node); }
  Upper drive() const;
  Upper acceleration_of_box() const;
  void note_rates(double h);
  void combine();
  void measure_box();
  void show(const Upper &deformation, const Upper &its_rate);
  void seed_box(double h, int terms);
  void refuse_scene() const;
  void show_box(bool forces);
  Compute *own() const;
  void request_virial() const;
  void refuse_box(const Upper &matrix) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
