/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A cell with a motion prescribed by fix deform, if all atoms belong to bodies of one fix
   (doc/theory.md, Eq. P10).  With remap x scaled centers obey

     X'' = M^-1 [F/m - (G + xi) v],   v = M X',   G = M' M^-1

   where the reference of M is the box at the beginning of each step.  Between steps, M is therefore
   1 and histories contain positions.

   Without a remap M is 1 at all times, and G is 0.

   LAMMPS changes the box at the end of a step.  The forces of a step need the box at its end, which
   is extrapolated by a polynomial through the last boxes.  Before a run fix deform itself provides
   its boxes at the steps around the current step. */

#ifndef LMP_GEAR_QUAT_DRIVEN_CELL_H
#define LMP_GEAR_QUAT_DRIVEN_CELL_H

#include "gear_quat_cell.h"
#include "gear_quat_thermostat.h"

#include <array>

namespace LAMMPS_NS::GearQuat {

class DrivenCell : public Thermostat {
 public:
  /// A box: h as in Domain::h, and boxlo.
  struct Cell {
    std::array<double, 9> h = {};

    Upper edges() const
    {
      Upper found;
      std::copy_n(h.begin(), Upper::SIZE, found.m.begin());
      return found;
    }
  };

  DrivenCell(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const ThermostatWords &words,
             const Scheme &scheme);

  /// deform: the fix that moves the box in this run.
  void obey(Fix *deform) { driver = deform; }
  /// True while fix deform computes a box for this class: no atom is remapped.
  bool is_asking() const { return asking; }
  void note_remap() { remaps = true; }
  /// Called when fix deform has changed the box from the current box of the bodies to the next box.
  void remap(const std::vector<double> &before, bool histories);
  bool remaps_atoms() const { return remaps; }
  /// Begins a step; returns the box in which its forces will be evaluated.
  const Cell &foretell();
  /// h' of that box.
  const Upper &rate_of_faces() const { return face_rate; }
  /// Resets LAMMPS' box to the beginning of the step, if predict() has changed it.
  void put_back_box();

  void begin_run(bool anew, double h) override;
  void set_scheme(const Scheme &present) override
  {
    Thermostat::set_scheme(present);
    scheme = present;
  }
  const char *reason_to_start_anew() const override
  {
    return acts() ? Thermostat::reason_to_start_anew() : nullptr;
  }

  void predict(const Integrator &integrator) override;
  BodyState scaled(const BodyState &s) const override;
  void measure() override;
  Load acting(int ibody) const override
  {
    return damped_load(bodies.rigid_of(ibody), scaled(bodies.state_of(ibody)), met(ibody), of_all);
  }
  void correct(const Integrator &integrator, int passes) override;

  void enter_node(const StartNodes &nodes, int node) override;
  void visit_node(const StartNodes &nodes, int node) override;
  void leave_nodes() override;

  int elements() const override { return acts() ? (int) Thermostat::ELEMENTS : 0; }

  void fields(Fields &v) override
  {
    if (acts()) Thermostat::fields(v);
  }

 private:
  friend class Coupling;    // calls the functions required by correct_by_passes()

  static constexpr int KNOWN = 9;    ///< boxes that a polynomial goes through
  static constexpr int PAST = KNOWN - 1, AHEAD = PAST / 2;

  Scheme scheme;
  Fix *driver = nullptr;
  bool asking = false;
  bool remaps = false;                         ///< atoms are remapped with the box
  bool no_step = true;                         ///< since the run began
  double width = 0.0;                          ///< the step
  std::array<Cell, PAST + 1 + AHEAD> cells;    ///< from step -PAST on; the current step is 0
  Cell begun;                                  ///< LAMMPS' box when the step began
  Cell then;                                   ///< at the end of the step
  Upper face_rate;
  Cell reference, shown;          ///< of M = 1, and of the present M
  bool ahead = false;             ///< LAMMPS' box is the one at the end of the step
  Upper matrix, inverse, rate;    ///< M, M^-1 and G
  CellFriction of_all;

  Cell present() const;
  void show(const Cell &cell);
  Cell ask(bigint step);
  void note_box();
  Upper interpolate(int first, double time, double h, Cell &cell) const;
  void move_to(const Cell &cell);
  void refer_to_shown();
  void rows_to_space(double *rows) const;
  void to_space(const double *scaled, double *space) const;
  void to_space(BodyState &s) const;
  bool is_flip_due() const;
  void note_friction_of_cell();

  // the passes of a step

  Load met(int ibody) const
  {
    Load scaled_load = bodies.load_of(ibody);
    inverse.times(bodies.load_of(ibody).force, scaled_load.force);
    return scaled_load;
  }
  CellFriction friction_of(int /*ibody*/) const { return of_all; }
  void find_friction(const Integrator &integrator, int pass);
  void add(int ibody, const double *scaled_velocity, const double *omega_body,
           const Integrator::Pending &pending);
  void finish(const Integrator &integrator, const RigidBody &body, double *rows) const;
  void place(int ibody, const Integrator::Pending &pending, BodyState &state,
             Correction &last) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
