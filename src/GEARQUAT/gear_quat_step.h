/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* One step of all bodies of a fix:

     begin()            predict, place sites
     LAMMPS             forces at the predicted sites
     end()              gather loads, correct, test the error;
                        if it is too large: undo, shorten, predict, place, evaluate, and repeat
                        place sites
     choose_next()      with a changing step, when all fixes have finished this one

   A Step owns the objects of a step: the length, the integrator, the coupling of all bodies, the
   control of the error, and the limits beyond which a run ends. */

#ifndef LMP_GEAR_QUAT_STEP_H
#define LMP_GEAR_QUAT_STEP_H

#include "gear_quat_arguments.h"
#include "gear_quat_blowup.h"
#include "gear_quat_coupling.h"
#include "gear_quat_fixes.h"
#include "gear_quat_scene.h"
#include "gear_quat_sites.h"
#include "gear_quat_time_step.h"
#include "gear_quat_tolerance.h"

#include <functional>
#include <memory>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// The coupling of all bodies selected by the keywords, null for none.
std::unique_ptr<Coupling> make_coupling(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                                        Bodies &bodies, const Sites &sites);

class Step : protected Pointers {
 public:
  /// tally(vflag, f): adds the virial of the constraint forces, computed from the forces f on
  /// atoms.
  using Tally = std::function<void(int, double **)>;
  Step(LAMMPS *lmp, const Fix *fix, const Arguments &args, const Fleet &fleet, Bodies &bodies,
       Ownership &ownership, Sites &sites, OtherFixes &others, Tally tally);

  /// f: forces on atoms.
  void begin(int vflag, double **f);
  /// f, torque: of the predicted sites.  Collective.
  void end(double **f, double **torque);
  /// Chooses the next step; with keyword tolerance only.  Collective.
  void choose_next();

  /// Loads of bodies from the forces on atoms that LAMMPS has just evaluated.  Collective.
  void gather(double **f, double **torque);

  // before a run

  /// of_predicted_velocities: true if velocities are read between begin() and end().
  void expect_readers(bool of_predicted_velocities) { velocities_read = of_predicted_velocities; }
  /// Bodies have been compared with their atoms, so the next step omits it.
  void note_comparison() { compared = true; }
  /// Histories and integrator adopt LAMMPS' time step.
  void follow_length();
  /// Makes the integrator; histories have the number of values of scheme().
  void make_integrator();
  /// Replaces the coupling between runs; null for none.
  void set_coupling(std::unique_ptr<Coupling> other);
  /// Replaces the scheme, without keyword tolerance; there are no histories.
  void set_scheme(const Scheme &scheme);

  /// Ends the run if the present loads would make a body unstable in the next step.
  void check_loads(double **f);
  /// Other fixes that read atoms, or local data of this fix, at the end of a step.
  void expect_readers_at_end(const Readers &others) { readers = others; }
  /// True if something may read local data at the end of this step.
  bool shows_local_data() const;

  /// True between begin() and end().
  bool is_within() const { return within; }

  /// True once bodies have histories of the present length.
  bool started = false;

  const Scheme &scheme() const { return tolerance ? tolerance->scheme() : present; }
  double length() const { return time_step.length(); }
  /// The current integrator, null before the first run.
  const Integrator *present_integrator() const { return integrator.get(); }
  /// The load on a body; with a coupling after its measure().
  Load acting(int ibody) const { return acting_on(bodies, coupling.get(), ibody); }

  TimeStep time_step;
  Blowup blowup;
  std::unique_ptr<Tolerance> tolerance;    ///< null: the step is LAMMPS' own
  std::unique_ptr<Coupling> coupling;      ///< null: bodies move by their own loads

 private:
  const Arguments &args;
  Scheme present;    ///< without keyword tolerance
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;
  OtherFixes &others;
  Tally tally;
  std::unique_ptr<Integrator> integrator;
  int vflag_of_step = 0;          ///< LAMMPS' vflag when the step began
  bool velocities_read = true;    ///< by other styles, between prediction and correction
  bool compared = false;
  bool within = false;
  Readers readers;

  void check_other_fixes();
  void predict(double **f);
  void place_prediction();
  void correct(double **f);
  template <bool MASKED> void correct_bodies(double **f);
  template <bool MASKED, bool POINT, bool CHANGING> void correct_body(int ibody, double **f);
  void correct_together();
  bool is_accepted();
  void shorten();
  void hold(double **f);
  void begin_fresh(double **f);
  void examine(int ibody, double **f);
  void find_limits(double h);
  bool is_due(const std::vector<int> &periods) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
