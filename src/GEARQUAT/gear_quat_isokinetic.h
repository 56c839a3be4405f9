/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword isokinetic: the sums over all bodies, of owned bodies on this rank and then of all ranks,
   that give the multipliers of Gauss's principle (gear_quat_gauss.h), and the kinetic energy that
   stays constant. */

#ifndef LMP_GEAR_QUAT_ISOKINETIC_H
#define LMP_GEAR_QUAT_ISOKINETIC_H

#include "gear_quat_bodies.h"
#include "gear_quat_integrator.h"
#include "pointers.h"

namespace LAMMPS_NS::GearQuat {

class IsokineticConstraint : protected Pointers {
 public:
  /// rescale: after each step momenta are scaled to the kinetic energy at the start.
  IsokineticConstraint(LAMMPS *lmp, const Bodies &bodies, Isokinetic mode, bool rescale) :
      Pointers(lmp), bodies(bodies), mode(mode), scales(acts() && rescale)
  {
  }

  bool acts() const { return mode != Isokinetic::NONE; }
  const Multipliers &multipliers() const { return alpha; }
  /// Of all forces: the rate of the heat that the constraint removes.
  double power() const { return sums.power(); }

  /// Without histories, the present kinetic energy becomes the conserved one.  Ends the run if it
  /// is zero.  Collective.
  void begin_run(bool anew);
  /// The contribution of an owned body.  torque_body: at the predicted pose, in all passes.
  void add(int ibody, const double *velocity, const double *omega_body, const double *torque_body)
  {
    here.add(bodies.rigid_of(ibody), bodies.load_of(ibody).force, torque_body, velocity,
             omega_body);
  }
  /// Sums the contributions over all ranks, and begins again.  Collective.
  void sum();
  /// From the present states and loads.  Collective.
  void sum_present();
  /// After the last pass; returns the kinetic energy that scale() removes.  Collective.
  double end_passes();
  void scale(const Integrator &integrator, const RigidBody &rigid, double *rows) const
  {
    if (scales) integrator.scale_momenta(rigid, factor, rows);
  }

  template <class V> void fields(V &v) { v(counted, target); }

 private:
  const Bodies &bodies;
  Isokinetic mode;
  bool scales;    ///< momenta after a step

  KineticSums here;    ///< of owned bodies, in a pass
  KineticSums sums, target;
  Multipliers alpha, factor;
  bigint counted = 0;    ///< number of bodies in the target

  void refuse_rest() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
