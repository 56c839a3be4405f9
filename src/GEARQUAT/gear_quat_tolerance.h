/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword tolerance inside LAMMPS: the largest errors of all bodies on all ranks, the control
   law of gear_quat_remembered_loads.h, and the outputs that depend on times.

     begin()        histories start
     begin_step(), prepare()
     predict        LAMMPS: neighbors, forces
     correct        with note_prediction() and note_correction() of bodies
     accepts()      error too large: [undo, shorten(), prepare(), predict, evaluate()], correct
                    again, all during final_integrate()
     choose(), TimeStep::change()

   After prepare(), shorten() and choose() a new integrator is needed.

   Nothing else in LAMMPS has used the step at this point: only this fix moves atoms, and the forces
   of other fixes are functions of positions and velocities (Forces).  Neighbor lists of the first
   try are kept, since its atoms have moved less than half the skin.  Energies and virials are
   tallied again as requested for the step. */

#ifndef LMP_GEAR_QUAT_TOLERANCE_H
#define LMP_GEAR_QUAT_TOLERANCE_H

#include "gear_quat_bath.h"
#include "gear_quat_forces.h"
#include "gear_quat_remembered_loads.h"

#include "force.h"
#include "update.h"

#include <memory>

namespace LAMMPS_NS::GearQuat {

/// The length of the step in histories and in LAMMPS.  After the command timestep LAMMPS' length may
/// differ; then the histories follow.  With keyword tolerance this class sets the length of LAMMPS
/// and of all fixes.
class TimeStep : protected Pointers {
 public:
  explicit TimeStep(LAMMPS *lmp) : Pointers(lmp) {}

  /// The length of the step in histories; 0 before the first run.
  double length() const { return h; }
  /// The length of the step that began last; 0 before the first step.
  double begun() const { return last; }
  /// Called when a step of this length begins.
  void begin() { last = h; }
  /// Adopts LAMMPS' step for the histories.  Returns the ratio of new to old length, 0 for no
  /// change; infinite if there was none.
  double follow();

  // LAMMPS' step, and dependent quantities in other fixes and in this fix

  /// Changes the length after the current step.
  void change(double step);
  /// Changes the present step, which has begun with another length: the time so far consists of the
  /// steps before it.
  void change_begun(double step);

  /// The time at a number of the step, near the present one.
  double time_of(bigint step) const;
  /// The time at the beginning of the present step.
  double beginning() const { return time_of(update->ntimestep - 1); }

  template <class V> void fields(V &v) { v(h, last); }

 private:
  double h = 0.0, last = 0.0;

  void set(double step);
};

class Tolerance : protected Scene {
 public:
  /// Elements of the fix's vector, after those of the bodies, as listed in the manual.
  static constexpr int ELEMENTS = 9;

  /// Sums for the outputs.
  struct Record {
    double steps, time, smallest, loads, largest, held, repeated, last;

    template <class V> void fields(V &v)
    {
      v(steps, time, smallest, loads, largest, held, repeated, last);
    }
  };

  Tolerance(const Scene &scene, TimeStep &time_step);

  /// The scheme with the present number of loads.
  const Scheme &scheme() const { return present; }
  /// An integrator with the coefficients of the last prepare().
  Integrator integrator() const { return {present, time_step.length(), remembered.coefficients()}; }
  /// Before histories are made of the present loads: shortens the first step to dtmax, the motion
  /// allowed, `permitted`, and the step whose error would be the tolerance.  Collective.
  void begin(double permitted);

  /// Begins a step, with the histories of the last step.  Collective.
  void begin_step();
  /// Weights for a step of the present length.
  void prepare() { remembered.prepare(time_step.length()); }
  /// Before a block is corrected, and after it.
  void note_prediction(const Block &block);
  void note_correction(const Integrator &integrator, const Block &block, const int *ids,
                       RememberedLoads::Last last);
  /// Includes an error of other variables, in the measure of the tolerance.
  void include(StepErrors one);
  /// After all bodies are corrected: false if the step has failed and must be repeated.
  /// Collective.
  bool accepts();
  /// Histories restored to the beginning of the step get the loads of the next try, LAMMPS its length.
  void shorten();
  /// Forces of the next try at the present positions into atom->f, energies and virials as in the
  /// present step.  vflag: of LAMMPS when the step began.
  void evaluate(int vflag);
  /// Chooses loads and length of the next step, and returns the length.  After the call histories
  /// have the new number of loads.  permitted: upper limit of the length.  Collective.
  double choose(double permitted);
  /// Before a run: the timestep command sets only the first step of histories, which keep their
  /// length.
  void keep_step();

  double element(int n) const;
  void fields(Fields &v);

 private:
  TimeStep &time_step;
  Scheme present;
  StepControl control;
  RememberedLoads remembered;
  Growth growing = Growth::START;
  std::unique_ptr<Forces> forces;           ///< null if no step of the run can be repeated
  RememberedLoads::Row predicted[LANES];    ///< accelerations of a block
  StepErrors errors;                        ///< of the bodies corrected so far; of all, once judged
  double speed = 0.0;                       ///< upper limit of the speeds of all sites
  int tries = 0;                            ///< failed tries of the present step
  StepControl::Next failed;                 ///< the next try
  bool fresh = false;    ///< bodies were inserted in this step, set by the test of the error
  Record record = {};

  void change_loads(int loads);
  double largest_speed() const;
  double limit_of_motion() const;
  double farthest_step(double speed) const;
  double even(double step, double now) const;
  /// In the units of the user.
  double unit_of_error() const { return control.energy ? force->mvv2e : 1.0; }
  double first_step() const;
  void begin_run();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
