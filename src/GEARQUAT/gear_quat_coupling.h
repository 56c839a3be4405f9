/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A coupling acts on all bodies together: a friction that depends on sums over all of them.  A fix
   has one coupling or none.

   Every step correct() corrects the predicted histories and states of all bodies.  All couplings
   use the same loop, correct_by_passes(): in every pass of the corrector the sums determine the
   friction, and the friction determines the next velocities and sums.

   The start finds histories by collocation (gear_quat_startup.h).  It calls either seed_local()
   alone, or the following: begin_start(); for every pair of nodes foretell(), visit_node() at both
   nodes and settle(); and seed() at the end.

   Functions are collective unless they say otherwise. */

#ifndef LMP_GEAR_QUAT_COUPLING_H
#define LMP_GEAR_QUAT_COUPLING_H

#include "gear_quat_bodies.h"
#include "gear_quat_fields.h"
#include "gear_quat_limits.h"
#include "gear_quat_remembered_loads.h"
#include "pointers.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// The nodes of a start, centered at the present time.
struct StartNodes {
  const Collocation &collocation;
  double spacing;    ///< time between nodes
  double h;          ///< the step of the histories
};

class Coupling : protected Pointers {
 public:
  Coupling(LAMMPS *lmp, Bodies &bodies) : Pointers(lmp), bodies(bodies), pending(bodies) {}

  // before a run

  /// States and loads belong to the first step, of length h; LAMMPS' setup may not have evaluated
  /// the forces of all fixes yet.  anew: there are no histories.  Ends the run if the coupling
  /// cannot act.
  virtual void begin_run(bool anew, double h) = 0;
  /// The scheme of the bodies has changed; there are no histories.  Local.
  virtual void set_scheme(const Scheme & /*scheme*/) {}
  /// fix_modify extra/dof: degrees of freedom of translation that do not count.  Local.
  virtual void subtract(int /*freedoms*/) {}
  /// A reason for a new start of histories, null for none.
  virtual const char *reason_to_start_anew() const { return nullptr; }
  /// False if the variables of the coupling would be lost in a start.  Local.
  virtual bool may_start_anew() const { return true; }

  // in a step; the following functions are for a moving box, that is, for a barostat

  /// Histories are predicted, and states contain their scaled rows: the box becomes the predicted
  /// one, and centers and velocities of states become unscaled.
  virtual void predict(const Integrator & /*integrator*/) {}
  /// The loads are from the forces f on atoms, which LAMMPS has just evaluated.
  virtual void meet_virial(double ** /*f*/) {}
  /// A state with the scaled center and velocity of a history.  Local.
  virtual BodyState scaled(const BodyState &s) const { return s; }
  /// False if another command has changed the box since the last run.  Local.
  virtual bool knows_box() const { return true; }
  /// True if the box is tilted so much that another cell of the same lattice should replace it.
  virtual bool is_tilted() const { return false; }
  /// Replaces a tilted box, before atoms are exchanged.
  virtual void flip_box() {}
  /// False if in the present step LAMMPS needs the virial of the constraint forces only for this
  /// coupling.  Local.
  virtual bool others_ask_for_virial() const { return true; }

  /// Computes friction and rates from the present states and loads.
  virtual void measure() = 0;
  /// The load on a body, including the friction; to be called after measure().  Local.
  virtual Load acting(int ibody) const = 0;
  /// Corrects the predicted histories and states.
  virtual void correct(const Integrator &integrator, int passes) = 0;
  /// The step of length h is accepted.
  virtual void note_step(double /*h*/) {}
  /// Called in an accepted step, after insertions have histories and removals are complete.
  virtual void follow_changes(double /*h*/) {}
  /// Other fixes have changed velocities of bodies, after measure().
  virtual void follow_velocities(double /*h*/) {}
  /// Saves variables for a step that may be undone; put_back() restores them.  Local.
  virtual void keep() {}
  virtual void put_back() {}
  /// The step of the histories changes.  Local.
  virtual void rescale(double /*ratio*/) {}
  /// Longest next step; infinite for no limit.  Local.
  virtual double longest_step() const { return std::numeric_limits<double>::infinity(); }
  /// Calls `include` with the errors of the coupling in this step of h.  Local.
  using Include = std::function<void(const StepErrors &)>;
  virtual void errors(double /*h*/, int /*values*/, const Include & /*include*/) const {}
  /// Its rows of the table of rates, for steps of h: those expected in the run after begin_run() if
  /// `ahead`, otherwise the present ones.  Local.
  virtual std::vector<Rate> rates(double /*h*/, bool /*ahead*/) const { return {}; }

  // the start

  virtual void begin_start(const StartNodes &nodes) = 0;
  virtual void foretell(const StartNodes &nodes) = 0;    ///< local
  /// Computes friction and rates from the states and loads of a node, like measure().
  virtual void visit_node(const StartNodes &nodes, int node) = 0;
  virtual void settle(const StartNodes &nodes, int pair) = 0;    ///< local
  /// Makes histories from the innermost `pairs`.  values: of the method.  Local.
  virtual void seed(const StartNodes &nodes, int pairs, int values) = 0;
  /// Makes histories from the present alone, after measure(), with `terms` terms for bodies.
  virtual void seed_local(double h, int terms) = 0;
  // With a moving box: refer_to_box() resets its histories; enter_node() sets the box of a node and
  // unscales the states, whose centers are scaled; leave_nodes() restores the box of the start.
  virtual void refer_to_box(double /*h*/) {}
  virtual void enter_node(const StartNodes & /*nodes*/, int /*node*/) {}
  virtual void leave_nodes() {}
  // After the start, with a moving box: forces are evaluated in a box that is a little smaller
  // (side -1), and a little larger (1), with the scaled centers of the start; states are restored.
  virtual bool probes() const { return false; }
  virtual void enter_probe(int /*side*/) {}
  virtual void leave_probe(int /*side*/) {}
  /// LAMMPS' vflag for the evaluation of forces at nodes.  Local.
  virtual int vflag() const { return 0; }

  // elements of the fix's vector

  virtual int elements() const = 0;
  virtual double element(int n) = 0;
  /// True if the element is proportional to the number of bodies.
  virtual bool extensive(int n) const = 0;
  /// The energy that thermo keyword econserve adds.  Local.
  virtual double energy() const { return 0.0; }

  // restart files

  virtual void fields(Fields &v) = 0;

 protected:
  Bodies &bodies;

  /// Calls `act(ibody)` for each body with a history on this rank: owned bodies and copies of large
  /// bodies.
  template <class Act> void for_moved(Act act) const
  {
    for (const auto *list : {&bodies.points, &bodies.tops})
      for (const int ibody : *list) act(ibody);
  }

  // functions that a law may override: the force on a scaled center, and the conversion of a
  // corrected state with a scaled center

  const Load &met(int ibody) const { return bodies.load_of(ibody); }
  void place(int /*ibody*/, const Integrator::Pending &, BodyState &, Correction &) const {}

  /// The load of a body without the components that are turned off; `masked` is storage for it.
  const Load &load_of(int ibody, Load &masked) const
  {
    if (bodies.body_at(ibody).off == 0) return bodies.load_of(ibody);
    masked = bodies.acting(ibody);
    return masked;
  }

  /// The loop of all couplings.  Law has
  ///   void begin_passes(const Integrator &)
  ///   void add_prediction(const Integrator &, int ibody, const Pending &)    of an owned body
  ///   void find_friction(const Integrator &, int pass)    from the sums, which it resets
  ///   Friction friction_of(int ibody) const, and Friction of_all, for a body without masks
  ///   void add(int ibody, const double *velocity, const double *omega_body, const Pending &)
  ///   static constexpr bool SUMS_OF_LAST_PASS             true if add() is called after it
  ///   void end_passes(const Integrator &)
  ///   void finish(const Integrator &, const RigidBody &, double *rows)    of a corrected history
  template <class Law> void correct_by_passes(Law &law, const Integrator &integrator, int passes);

  /// The part of the kinetic energy that is zero, as an adjective followed by a blank; empty if
  /// both parts are zero, null if none is zero.  separate: each part has its own friction, which
  /// scales it; moves: the parts that have degrees of freedom.
  static const char *part_at_rest(const double (&energies)[2], const bool (&moves)[2],
                                  bool separate)
  {
    constexpr double NOTHING = 1.0e-24;    // of the whole: rounding of velocities
    const double all = energies[0] + energies[1];
    if (all <= 0.0) return "";
    for (int part = 0; separate && part < 2; ++part)
      if (moves[part] && energies[part] <= NOTHING * all)
        return part == 0 ? "translational " : "rotational ";
    return nullptr;
  }

 private:
  Column<Integrator::Pending> pending;    ///< in correct_by_passes()
};

/// The load on a body: after measure(), if there is a coupling.
inline Load acting_on(const Bodies &bodies, const Coupling *coupling, int ibody)
{
  return coupling ? coupling->acting(ibody) : bodies.acting(ibody);
}

template <class Law>
void Coupling::correct_by_passes(Law &law, const Integrator &integrator, int passes)
{
  pending.begin(bodies.nmoved());
  law.begin_passes(integrator);
  for_moved([&](int ibody) {
    Load masked;
    pending[ibody] =
        integrator.begin(load_of(ibody, masked), bodies.axes(ibody), bodies.history(ibody));
    if (ibody < bodies.nowned()) law.add_prediction(integrator, ibody, pending[ibody]);
  });

  for (int pass = 0; pass < passes; ++pass) {
    const bool sums = Law::SUMS_OF_LAST_PASS || pass + 1 < passes;
    law.find_friction(integrator, pass);
    for_moved([&](int ibody) {
      const RigidBody &rigid = bodies.rigid_of(ibody);
      double *rows = bodies.history(ibody);
      if (bodies.body_at(ibody).off == 0)
        integrator.correct_pass(rigid, law.met(ibody), law.of_all, rows, pending[ibody]);
      else
        integrator.correct_pass(rigid, bodies.acting(ibody), law.friction_of(ibody), rows,
                                pending[ibody]);
      if (ibody >= bodies.nowned() || !sums) return;
      double velocity[3], omega_body[3];
      integrator.velocities_of_pass(rigid, rows, pending[ibody], velocity, omega_body);
      law.add(ibody, velocity, omega_body, pending[ibody]);
    });
  }
  law.end_passes(integrator);

  for_moved([&](int ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    double *rows = bodies.history(ibody);
    BodyState &state = bodies.change_state(ibody);
    Correction &last = bodies.change_last(ibody);
    const bool masked = bodies.body_at(ibody).off != 0;
    Load load;
    BodyState before;
    if (masked) before = state;
    last = integrator.finish(rigid, load_of(ibody, load), rows, pending[ibody]);
    law.finish(integrator, rigid, rows);
    integrator.body_state(rigid, rows, state, bodies.change_frame(ibody));
    law.place(ibody, pending[ibody], state, last);
    if (masked) last.work = work_between(bodies.load_of(ibody), before, state);
  });
}

}    // namespace LAMMPS_NS::GearQuat

#endif
