/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keywords iso, aniso, tri, x, y, z, xy, xz and yz: the box moves so that components of the
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
   before this one, and all others after it: f_i are the forces of styles and of the fixes before.

   Without these keywords moves() is false: functions do nothing, and centers are not scaled. */

#ifndef LMP_GEAR_QUAT_BAROSTAT_H
#define LMP_GEAR_QUAT_BAROSTAT_H

#include "gear_quat_arguments.h"
#include "gear_quat_box.h"
#include "gear_quat_fields.h"
#include "gear_quat_remembered_loads.h"
#include "gear_quat_sites.h"
#include "gear_quat_startup.h"
#include "gear_quat_temperature.h"

#include <optional>

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

class Barostat : protected Pointers {
 public:
  /// Elements of the fix's vector after those of chains.
  enum {
    PRESSURE,
    P_COMPONENT,    ///< xx yy zz xy xz yz
    P_TARGET = P_COMPONENT + 6,
    STRAIN_RATE,    ///< xx yy zz
    E_BOX = STRAIN_RATE + 3,
    XI_BOX,
    ELEMENTS
  };

  /// With a pressure it adds compute ID_virial, which requests the virial from LAMMPS.
  Barostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const Sites &sites,
           const PressureWords &pressure, Temperature &temperature);
  ~Barostat() override;

  bool moves() const { return !id.empty(); }
  void set_scheme(const Scheme &scheme);

  // before a run

  /// Ends the run if forces have no virial, or positions do not follow the box.  Collective.
  void refuse_scene() const;
  /// After Temperature::begin_run().  Collective.
  void begin_run(bool anew, double h);
  /// Adds targets and damping times.
  void add_setting(std::vector<double> &all) const;

  // a step

  /// Histories are predicted, and states contain their scaled rows: the box becomes the predicted
  /// one, and centers and velocities of states become unscaled.
  void predict(double h);
  /// With a changing step, scalars have the coefficients of velocities.
  void choose_coefficients(CorrectorCoefficients::Array &c, int values) const;
  /// From the forces f on atoms, in post_force() of the fix.  Collective.
  void measure_virial(double **f);
  /// False if in the present step LAMMPS needs the virial of the constraint forces only for this.
  bool others_ask_for_virial() const;
  /// From the present sums; alpha: of the bodies.
  void measure(const Friction &alpha);
  void begin_passes(double h);
  /// xi: the friction of the box.
  void pass(const Friction &alpha, double xi, double h);
  void end_passes();
  /// The work of a force on a body that moves from the scaled center `predicted` to the scaled center
  /// of a state.
  double work(const double *force, const double *predicted, const BodyState &state) const;
  /// A state becomes unscaled.
  void to_space(BodyState &state) const { box.to_space(state); }
  /// Corrected states are placed; LAMMPS gets the corrected box.
  void end_step();
  /// The step of length h is accepted.
  void note_step(double h)
  {
    if (times) times->conclude(h);
  }
  void keep() { kept = cell; }
  void put_back();
  void rescale(double ratio);
  /// True if the box is tilted so much that another cell of the same lattice should replace it.
  bool is_tilted() const { return asked.shears() && asked.flip && box.is_tilted(); }
  /// Replaces a tilted box, before atoms are exchanged.  Collective.
  void flip();

  // scaled and unscaled

  BodyState scaled(const BodyState &s) const
  {
    BodyState found = s;
    if (moves()) box.to_scaled(found);
    return found;
  }
  Load scaled(const Load &load) const
  {
    Load found = load;
    box.inverse_matrix().times(load.force, found.force);
    return found;
  }
  void to_space(Lanes (&velocities)[3]) const
  {
    const Lanes scaled[3] = {velocities[0], velocities[1], velocities[2]};
    box.matrix().times(scaled, velocities);
  }
  const Upper &matrix() const { return box.matrix(); }
  const Upper &inverse_matrix() const { return box.inverse_matrix(); }
  /// Of all bodies, in the present pass.
  const Friction &friction() const { return of_bodies; }

  // limits

  /// The work of the displacement at the faces, or the displacement.
  double error_of_step(bool as_energy, double h) const;

  // the start

  /// The present box becomes the reference, and keeps its rate.
  void refer_to_box(double h);
  void begin_start(const StartNodes &nodes, double xi);
  void foretell(const StartNodes &nodes);
  /// Sets the box of a node, and unscales the states, whose centers are scaled.
  void enter_node(const StartNodes &nodes, int node);
  void visit_node(const StartNodes &nodes, int node, const Friction &alpha, double xi);
  void settle(const StartNodes &nodes, int pair);
  /// Restores the box of the start.
  void leave_nodes();
  void seed(const StartNodes &nodes, int pairs);
  void seed_local(double h, int terms, double xi);
  /// LAMMPS' vflag for the evaluation of forces at nodes.
  int vflag() const;

  /// Ends the run: the chain of the box cannot follow it.
  [[noreturn]] void refuse_speed() const;
  double twice_kinetic() const;
  /// Coupled directions have one degree of freedom.
  int freedoms() const;
  /// The shortest damping time.
  double period() const;
  /// S' of Eq. P7.
  double rate_of_heat() const;
  /// The terms of Eq. P7 with the box, without its chain.  heat: S.
  double energy(double heat) const;
  /// After Temperature::sum_present(); without XI_BOX.
  double element(int n) const;

  void fields(Fields &v);

 private:
  const Fix *fix;
  Bodies &bodies;
  const Sites &sites;
  PressureWords asked;
  Temperature &temperature;
  std::string id;    ///< of the compute; empty: the box does not move
  Upper virial;      ///< of centers of mass, in units of mass times velocity squared
  Box box;
  CellHistory cell, kept;
  std::optional<RememberedLoads> times;    ///< with a changing step: of the last drives of the box
  double width = 0.0;                      ///< the step of the histories
  Upper present_target;                    ///< pressures, of this step
  Upper target_rate;                       ///< change of these targets with time
  double time_of_node = 0.0;               ///< since the present step

  Upper rate;           ///< G in the present pass, or at a node
  Upper correction;     ///< of M M^-1 by the corrector, in the last step
  Upper local_error;    ///< of M M^-1, of the last step
  Friction of_bodies;

  std::string told;    ///< last message of the degrees of freedom

  // the start

  Collocation::Nodes cell_at_nodes = {};

  double weight_of(int direction) const;
  double kt() const;
  Upper masses() const;
  double mean_of(const Upper &pressures) const;
  void find_target(bigint step, double h);
  Upper target() const { return present_target + target_rate.scaled(time_of_node); }
  Upper drive() const;
  Upper begin_acceleration(double xi);
  void note_rates(double h);
  void combine(const Friction &alpha);
  void show(const Upper &deformation, const Upper &its_rate);

  void show_box(bool forces);
  Compute *own() const;
  void request_virial() const;
  void refuse_forces() const;
  void refuse_others() const;
  void refuse_box(const Upper &matrix) const;
  void tell_freedoms();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
