/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keywords iso, aniso, tri, x, y, z, xy, xz and yz: the box moves so that components of the
   molecular pressure have their targets, with keyword temp (NPT) or without (NPH); doc/theory.md,
   Eqs. P1 to P9.

     W G_ab' = sum m v_a v_b + delta_ab b_a sum m v^2 + W_ab - P_ab V delta_ab - W xi G_ab        (P2)

   for the free components.  v is relative to a constant common motion, and W_ab is the molecular
   virial (gear_quat_virial.h).  The weights are b = 1/N_f with the translational degrees of freedom
   N_f, or (3, 1, -1)/N_f if the box shears.  The mass is W = (N_f + d) kT Pdamp^2/d.  Coupled
   components have the mean of their right-hand sides.  xi is the friction of a chain of the box.
   The energy

     U + K + sum W G_ab^2/2 + P V + S + energies of the chains,                                 (P7)
     S' = V sum (P_ab - P delta_ab) G_ab - V P' - sum (W'/2) G_ab^2,   P = sum P_aa/d

   is constant.  The box (gear_quat_box.h) moves as the bodies do: a step predicts the box, LAMMPS
   evaluates the forces in the predicted box, and every pass of the corrector corrects the box. */

#ifndef LMP_GEAR_QUAT_BAROSTAT_H
#define LMP_GEAR_QUAT_BAROSTAT_H

#include "gear_quat_box.h"
#include "gear_quat_box_frequency.h"
#include "gear_quat_scalar.h"
#include "gear_quat_thermostat.h"
#include "gear_quat_virial.h"

#include <memory>

namespace LAMMPS_NS::GearQuat {

class Barostat : public Thermostat {
 public:
  /// Elements of the fix's vector after the elements of Thermostat.
  enum {
    PRESSURE = Thermostat::ELEMENTS,
    P_COMPONENT,    ///< xx yy zz xy xz yz
    P_TARGET = P_COMPONENT + 6,
    STRAIN_RATE,    ///< xx yy zz
    E_BOX = STRAIN_RATE + 3,
    XI_BOX,
    ELEMENTS
  };

  Barostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const Sites &sites,
           const ThermostatWords &words, const PressureWords &pressure, const Scheme &scheme);

  void begin_run(bool anew, double h) override;
  void set_scheme(const Scheme &scheme) override;
  const char *reason_to_start_anew() const override;

  void predict(const Integrator &integrator) override;
  void meet_virial(double **f) override { virial.measure(f, scale()); }
  BodyState scaled(const BodyState &s) const override
  {
    BodyState found = s;
    box.to_scaled(found);
    return found;
  }
  bool others_ask_for_virial() const override;
  void measure() override;
  Load acting(int ibody) const override
  {
    return damped_load(bodies.rigid_of(ibody), scaled(bodies.state_of(ibody)), met(ibody), of_all);
  }
  void correct(const Integrator &integrator, int passes) override;
  bool knows_box() const override { return box.is_shown(); }
  bool is_tilted() const override;
  void flip_box() override;
  void note_step(double h) override;
  void keep() override;
  void put_back() override;
  double longest_step() const override;
  void errors(double h, int values, const Include &include) const override;
  std::vector<Rate> rates(double h, bool ahead) const override;
  void follow_changes(double h) override;
  void rescale(double ratio) override;

  void refer_to_box(double h) override;
  void begin_start(const StartNodes &nodes) override;
  void foretell(const StartNodes &nodes) override;
  void enter_node(const StartNodes &nodes, int node) override;
  void visit_node(const StartNodes &nodes, int node) override;
  void settle(const StartNodes &nodes, int pair) override;
  void leave_nodes() override;
  bool probes() const override { return true; }
  void enter_probe(int side) override;
  void leave_probe(int side) override;
  void seed(const StartNodes &nodes, int pairs, int values) override;
  void seed_local(double h, int terms) override;
  int vflag() const override { return virial.flag(); }

  int elements() const override { return ELEMENTS; }
  double element(int n) override;
  bool extensive(int n) const override { return n == E_BOX || Thermostat::extensive(n); }
  double energy() const override;

  void fields(Fields &v) override;

 private:
  friend class Coupling;    // calls the functions required by correct_by_passes()

  PressureWords asked;
  MolecularVirial virial;
  Box box;
  CellHistory cell;
  Chain chain;           ///< of the box
  ScalarHistory heat;    ///< S
  int values_of_heat = 0;
  CorrectorCoefficients::Array heat_coefficients;    ///< of a first-order equation
  RememberedLoads times{false};    ///< with a changing step: of the last drives of the box
  double width = 0.0;              ///< the step of the histories
  Upper target;                    ///< pressures of the present step, or at a node
  Upper target_rate;               ///< change of these targets with time
  double kt = 0.0;                 ///< of the mass of the box in that step
  Upper made_target, made_rate;    ///< of the last step before this run
  std::array<double, Upper::SIZE> periods = {};    ///< damping times in the last step
  std::string told_of_box;                         ///< last message of the degrees of freedom

  Upper matrix, rate;    ///< M and G in the present pass, or at a node
  struct Moving {        ///< variables that a step changes
    CellHistory cell;
    Chain chain;
    ScalarHistory heat;
  };
  std::unique_ptr<Moving> kept;
  bool changing_step;    ///< keyword tolerance
  Upper local_error;     ///< of M M^-1, of the last step
  Upper kinetic;         ///< sum m v_a v_b, as of the last sum
  Upper correction;      ///< of M M^-1 by the corrector, in the last step
  double friction_of_box = 0.0;
  CellFriction of_all;
  Upper inverse;    ///< of M

  using Tensor = ExactSum[Upper::SIZE];
  Tensor tensor;    ///< of owned bodies, in a pass

  BoxFrequency frequency;
  bool warned_mesh = false;
  double longest_body = 0.0;    ///< largest distance of a site from the owner atom of its body
  static constexpr double IN_A_STEP = 0.03;    ///< limit for the change of the box in a step
  Upper strongest;                             ///< drive in this run, as magnitudes
  Upper drive_of_smaller;                      ///< in the start, before the box is enlarged
  Upper begun_box, begun_matrix;               ///< the box of LAMMPS, and M, where the run began

  // the start

  Collocation::Nodes<Upper::SIZE, 2> cell_at_nodes = {};
  Collocation::Scalar twice_box_at_nodes = {}, heat_at_nodes = {};
  bool held_box = false;
  Upper target_at_start;

  double dimensions() const;
  double weight_of(int direction) const;
  double mass_of(int component) const;
  double twice_kinetic_of_box() const;
  ChainTarget target_of_box(double steps_ahead, double h) const;
  int free_components() const;
  double volume() const;
  double mean_target(const Upper &pressures) const;
  void find_target(bigint step, double h);
  void move_target(double time);
  void refuse_scene() const;
  void refuse_others() const;
  void tell_freedoms_of_box();
  void find_temperature();
  Upper masses() const;
  double period() const;
  double probing_strain() const;
  void watch_box(double h);
  void watch_mesh();
  void refuse_box() const;
  void find_longest_body();
  void refuse_narrow_box(int direction, double edge) const;
  void note_drive(const Upper &now);
  double period_for_drive(double omega) const;
  void set_heat(const Scheme &scheme);
  void prepare(double h);
  void advance_box(double h, int values);
  Upper drive() const;
  double rate_of_heat() const;
  /// The components of Upper that may be nonzero in this box: tilts come last.
  int moving_components() const { return asked.shears() ? Upper::SIZE : 3; }
  void add_momenta(int ibody, const double *velocity, Tensor &sums, int count) const;
  void sum_momenta(const Tensor &sums);
  void sum_present_momenta();
  void note_box();
  double friction_now() const { return chain_acts() ? chain.friction() : 0.0; }
  bool chain_acts() const { return asked.length > 0; }

  // the passes of a step

  Load met(int ibody) const
  {
    Load scaled_load = bodies.load_of(ibody);
    inverse.times(bodies.load_of(ibody).force, scaled_load.force);
    return scaled_load;
  }
  CellFriction friction_of(int /*ibody*/) const { return of_all; }
  void begin_passes(const Integrator &integrator);
  void add_prediction(const Integrator &integrator, int ibody, const Integrator::Pending &pending);
  void find_friction(const Integrator &integrator, int pass);
  void add(int ibody, const double *scaled_velocity, const double *omega_body,
           const Integrator::Pending &pending);
  void end_passes(const Integrator &integrator);
  void place(int ibody, const Integrator::Pending &pending, BodyState &state,
             Correction &last) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
