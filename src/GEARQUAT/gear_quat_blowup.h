/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Ends a run before its first step if a body turns faster than the method can follow.  Most such
   bodies are nearly linear; their smallest moment of inertia makes them spin fast about their axis.
   Also ends a run at the step in which a body becomes unstable, before its atoms are placed, so
   before a dump or another fix sees them.  The fix makes the comparison for every body and step
   (gear_quat_limits.h); this file makes the error message.  The message states what became unstable
   first: the coupling of all bodies, otherwise the forces, otherwise the motion of the bodies. */

#ifndef LMP_GEAR_QUAT_BLOWUP_H
#define LMP_GEAR_QUAT_BLOWUP_H

#include "gear_quat_coupling.h"
#include "gear_quat_limits.h"
#include "gear_quat_sites.h"

#include <string>

namespace LAMMPS_NS::GearQuat {

/// Speed of the motion at the beginning of a run.
struct Pace {
  double kt = 0.0;    ///< twice the mean kinetic energy of a degree of freedom; 0 if bodies are few
  double vibration = 0.0;    ///< an angular frequency, see pace_of(); 0 if unknown

  /// The longest step with which a scheme follows the vibrations, infinite if they are not known.
  double longest_step(const Scheme &scheme) const;
};

/// The largest F^2/(m kT) of a body, and T^2/(I kT) about its axes.  In equilibrium its mean is the
/// mean curvature of the potential energy by mass; in a collision it is about the curvature there.
/// Forces that accelerate all bodies alike cause no vibration.  Collective; loads: present.
Pace pace_of(LAMMPS *lmp, const Bodies &bodies);

/// Ends the run on all ranks if a body turns faster than can be followed at a step h.  Rank 0 warns
/// of a nearly linear body that will turn that fast once it has its share of the kinetic energy.
/// Collective.
void check_spins(LAMMPS *lmp, const Bodies &bodies, const Scheme &scheme, const Pace &pace,
                 double h);

class Blowup : protected Pointers {
 public:
  /// shortest: value of keyword dtmin, or 0.
  Blowup(LAMMPS *lmp, const Bodies &bodies, Ownership &ownership, const Sites &sites,
         const Scheme &scheme, double shortest) :
      Pointers(lmp),
      bodies(bodies), ownership(ownership), sites(sites), scheme(scheme), shortest(shortest)
  {
  }

  /// Speed of the motion at the beginning of a run, from pace_of().
  Pace pace;
  /// If the coupling is unstable, it became unstable before the bodies; may be null.
  const Coupling *coupling = nullptr;

  /// The limits for the current step and box.
  MotionLimits limits;

  /// Ends the run if the present loads would make an owned body unstable within a step h.  Atoms
  /// are at the positions of the loads; f: forces on them.
  void check_loads(double h, double **f) const;
  /// Ends the run if the present load would make this body unstable within a step h.
  void check_load(int ibody, double h, double **f) const;
  /// Ends the run on all ranks, called by the rank that owns the body (for a large one, by all of
  /// them together).  The message gives step, time, body, its site nearest to another atom (or one
  /// with a non-finite force), what became unstable first, and a remedy.  Atoms are at the
  /// positions of the load; s: the resulting state, beyond the limits.
  [[noreturn]] void stop(int ibody, const BodyState &s, double h, double **f) const;

 private:
  const Bodies &bodies;
  Ownership &ownership;
  const Sites &sites;
  const Scheme &scheme;
  double shortest;

  struct Meeting {
    int site, other;    ///< atoms; -1 for none
    double distance2;
  };
  Meeting nearest(int ibody, int site) const;
  std::string what_happened(int ibody, const BodyState &s, double h) const;
  Cause first_cause(int ibody, const BodyState &s, double h) const;
  int inaccurate_bodies(int ibody, double h) const;
  bool is_pushed(int ibody, double h) const;
  std::string shorter_step(double h) const;
  std::string where(int ibody, int bad, const Meeting &met) const;
  std::string agree(const std::string &text, int ibody, int bad, const Meeting &met) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
