/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword isokinetic: bodies whose kinetic energy stays what it is (gear_quat_gauss.h).  The
   multipliers need sums over all bodies on all ranks: a reduction of four numbers in every pass of
   the corrector, and one after it.

   The heat that the constraint takes, W' = sum(F.v + tau.omega), is integrated as the bodies are,
   so that potential and kinetic energy and W are constant to the order of the method. */

#ifndef LMP_GEAR_QUAT_ISOKINETIC_H
#define LMP_GEAR_QUAT_ISOKINETIC_H

#include "gear_quat_bodies.h"
#include "pointers.h"

namespace LAMMPS_NS::GearQuat {

class IsokineticConstraint : protected Pointers {
 public:
  /// Elements of the fix's vector behind those of Sums.
  enum { HEAT, ALPHA_TRANSLATION, ALPHA_ROTATION, ELEMENTS };

  /// rescale: after each step momenta are scaled to the kinetic energy at the start.
  IsokineticConstraint(LAMMPS *lmp, Bodies &bodies, const Scheme &scheme, Isokinetic mode,
                       bool rescale);

  // all collective

  /// Before a run: states and loads are those of its first step.  afresh: the kinetic energy to be
  /// kept is that of now.  Ends the run if there is none.
  void begin_run(bool afresh);
  /// Multipliers of the present states and loads.
  void measure();
  /// One step: correct the predicted histories and states.
  void correct(const Integrator &integrator);

  // after measure()

  /// The load on an owned body together with the forces of the constraint.
  Load acting(int ibody) const
  {
    return damped_load(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.load_of(ibody),
                       alpha);
  }
  /// The power of all forces and torques.
  double power() const { return sums.power(); }
  double element(int n) const;

  /// Higher derivatives of the heat from `terms` terms of a series in units of series_step.
  void seed_heat(const double *series, int terms, double series_step, double h);
  /// Histories are rescaled to another time step.
  void rescale_step(double ratio);

  /// What a restart file holds, the same on all ranks.
  struct Checkpoint {
    double mode, bodies;
    KineticSums target;
    double heat[MAX_VALUES];
  };
  Checkpoint checkpoint() const;
  /// Of the same kind of constraint.
  void restore(const Checkpoint &saved);

 private:
  Bodies &bodies;
  Scheme scheme;
  Isokinetic mode;
  bool rescale;

  KineticSums sums, target;
  Multipliers alpha;
  bigint counted;             ///< bodies that the target belongs to
  double heat[MAX_VALUES];    ///< Nordsieck history
  std::vector<Integrator::Pending> pending;

  void refuse_rest() const;
  KineticSums over_all(KineticSums here) const;
  KineticSums of_pending() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
