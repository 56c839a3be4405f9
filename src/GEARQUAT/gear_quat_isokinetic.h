/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword isokinetic: bodies with constant kinetic energy (gear_quat_gauss.h).  The multipliers
   need sums over all bodies on all ranks: a reduction of four numbers in every pass of the
   corrector, and one after it.

   The heat removed by the constraint, W' = sum(F.v + tau.omega), is integrated like the bodies, so
   that the sum of potential energy, kinetic energy and W is constant to the order of the method. */

#ifndef LMP_GEAR_QUAT_ISOKINETIC_H
#define LMP_GEAR_QUAT_ISOKINETIC_H

#include "gear_quat_coupling.h"
#include "gear_quat_scalar.h"

namespace LAMMPS_NS::GearQuat {

class IsokineticConstraint : public Coupling {
 public:
  /// Elements of the fix's vector after the elements of Sums.
  enum { HEAT, ALPHA_TRANSLATION, ALPHA_ROTATION, ELEMENTS };

  /// rescale: after each step momenta are scaled to the kinetic energy at the start.
  IsokineticConstraint(LAMMPS *lmp, Bodies &bodies, const Scheme &scheme, Isokinetic mode,
                       bool rescale);

  /// Without histories, the present kinetic energy becomes the conserved kinetic energy.
  void begin_run(bool anew, double h) override;
  bool may_start_anew() const override { return false; }

  void measure() override;
  Load acting(int ibody) const override
  {
    return damped_load(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.load_of(ibody),
                       of_all);
  }
  void correct(const Integrator &integrator, int passes) override
  {
    correct_by_passes(*this, integrator, passes);
  }
  void set_scheme(const Scheme &other) override { scheme = other; }
  void rescale(double ratio) override { heat.rescale(ratio, scheme.values()); }

  void begin_start(const StartNodes &nodes) override;
  void foretell(const StartNodes &nodes) override { nodes.collocation.foretell(heat_at_nodes); }
  void visit_node(const StartNodes &nodes, int node) override;
  void settle(const StartNodes &nodes, int pair) override
  {
    nodes.collocation.settle(pair, heat_at_nodes);
  }
  void seed(const StartNodes &nodes, int pairs, int values) override;
  void seed_local(double h, int terms) override;

  int elements() const override { return ELEMENTS; }
  double element(int n) override;
  bool extensive(int n) const override { return n == HEAT; }

  void fields(Fields &v) override { v(counted, target, heat); }

 private:
  friend class Coupling;    // calls the functions required by correct_by_passes()

  Scheme scheme;
  Isokinetic mode;
  bool scales;    ///< momenta after a step

  KineticSums here;    ///< of owned bodies, in a pass
  KineticSums sums, target;
  Multipliers alpha;
  Friction of_all;    ///< alpha
  Multipliers factor;
  bigint counted = 0;    ///< number of bodies in the target
  ScalarHistory heat;
  Collocation::Scalar heat_at_nodes;

  void sum();
  void refuse_rest() const;

  static constexpr bool SUMS_OF_LAST_PASS = true;
  void begin_passes(const Integrator &) { here = KineticSums(); }
  void add_prediction(const Integrator &, int ibody, const Integrator::Pending &pending);
  void find_friction(const Integrator &, int /*pass*/) { sum(); }
  Friction friction_of(int /*ibody*/) const { return of_all; }
  void add(int ibody, const double *velocity, const double *omega_body,
           const Integrator::Pending &pending)
  {
    here.add(bodies.rigid_of(ibody), bodies.load_of(ibody).force, pending.torque_body, velocity,
             omega_body);
  }
  void end_passes(const Integrator &integrator);
  void finish(const Integrator &integrator, const RigidBody &rigid, double *rows) const
  {
    if (scales) integrator.scale_momenta(rigid, factor, rows);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
