/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_motion.h"

#include "gear_quat_ranks.h"
#include "gear_quat_scene.h"

#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

Motion::Motion(LAMMPS *lmp, Fix *fix, const Arguments &args, Bodies &bodies, Ownership &ownership,
               Sites &sites) :
    Pointers(lmp),
    fix(fix), args(args), bodies(bodies), ownership(ownership), sites(sites),
    blowup(lmp, bodies, ownership, sites, args.scheme, args.control.shortest)
{
  if (args.control.eps > 0.0)
    tolerance.reset(new Tolerance(lmp, fix, args.scheme, args.control, args.every_time, bodies));
  if (args.isokinetic != Isokinetic::NONE)    // not with tolerance
    isokinetic.reset(
        new IsokineticConstraint(lmp, bodies, args.scheme, args.isokinetic, args.rescale));
  if (args.thermostat.damp > 0.0)    // not with isokinetic
    thermostat.reset(new Thermostat(lmp, fix, bodies, args.thermostat, args.scheme));
  coupled = isokinetic || thermostat;
  blowup.other_cause = [this](double h) {
    return unstable_thermostat(h);
  };
}

Blowup::Cause Motion::unstable_thermostat(double h) const
{
  if (!thermostat || thermostat->part_of_limit(h) < 1.0) return {};
  return {fmt::format("The thermostat became unstable first: its friction in a step of {:g} is "
                      "{:.2g} times as strong as the method can follow",
                      h, thermostat->part_of_limit(h)),
          "Begin nearer to the target temperature, or use a longer damping time"};
}

void Motion::meet_bodies()
{
  if (!args.masks.empty()) masks = args.masks_of(ownership.all_ids());
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void Motion::init()
{
  if (tolerance) tolerance->refuse_scene();
  if (tolerance && started) tolerance->keep_step(step());
  follow_time_step();
}

const Scheme &Motion::present_scheme() const
{
  return tolerance ? tolerance->scheme() : args.scheme;
}

void Motion::make_integrator(double step)
{
  integrator.reset(new Integrator(present_scheme(), step));
}

void Motion::follow_time_step()
{
  const double next = update->dt;
  if (next == 0.0 || !std::isfinite(next) || next == step()) return;
  if (tolerance && started && !tolerance->is_changing_step()) return;    // it will be put back
  const double ratio = next / step();
  if (integrator)
    integrator->set_step(next);
  else
    make_integrator(next);
  if (!started) return;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    integrator->rescale(bodies.history(ibody), ratio);
  if (isokinetic) isokinetic->rescale_step(ratio);
}

void Motion::forget(const std::string &why)
{
  if (started && comm->me == 0) utils::logmesg(lmp, why + "\n");
  started = false;
}

void Motion::impose_masks()
{
  if (!ownership.change_masks(masks) || !started)
    return;    // only those of a restart file can be others
  started = false;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: keywords force and torque turn off other components than in "
                   "the run that wrote the restart file; poses and velocities are kept, the "
                   "higher derivatives start anew");
}

void Motion::begin_run()
{
  if (update->nsteps > 0) blowup.pace = pace_of(lmp, bodies);
  if (!started && !tolerance && update->nsteps > 0)
    check_spins(lmp, bodies, args.scheme, blowup.pace, step());
  if (isokinetic) isokinetic->begin_run(!started);
  if (thermostat)
    thermostat->begin_run(!started,
                          tolerance ? std::min(step(), thermostat->longest_step()) : step());
  if (tolerance) tolerance->announce_output();
  set_up = true;
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Motion::take_velocities(const std::vector<int> &changed)
{
  if (!started) return;
  measure();
  if (thermostat && over_ranks(MPI_MAX, (int) !changed.empty(), world))
    thermostat->follow_velocities(step());
  for (const int ibody : changed)
    integrator->set_velocities(bodies.rigid_of(ibody), bodies.state_of(ibody), acting(ibody),
                               bodies.history(ibody));
}

/// Forces of constraint and thermostat are those of the present states and loads.
void Motion::measure()
{
  if (isokinetic) isokinetic->measure();
  if (thermostat) thermostat->measure();
}

void Motion::predict(double **f)
{
  const double h = step();
  if (tolerance && update->dt != h) tolerance->put_back_begun_step(h);
  if (tolerance) tolerance->begin_step();
  if (thermostat && tolerance) thermostat->keep_chains();
  predict_bodies(f);
}

void Motion::predict_bodies(double **f)
{
  const double h = step();
  last_step = h;
  limits = blowup.limits(h);
  const auto check = [&](int ibody) {
    const BodyState &state = bodies.state_of(ibody);
    if (!tolerance && !limits.keep_velocities(state)) blowup.stop(ibody, state, h, f);
  };
  for (const int ibody : bodies.points) {
    double *rows = bodies.history(ibody);
    integrator->predict_center(rows);
    integrator->center_state(bodies.rigid_of(ibody), rows, bodies.change_state(ibody));
    check(ibody);
  }
  for (const int ibody : bodies.tops) {
    double *rows = bodies.history(ibody);
    integrator->predict(rows);
    integrator->body_state(bodies.rigid_of(ibody), rows, bodies.change_state(ibody),
                           bodies.change_frame(ibody));
    check(ibody);
  }
}

void Motion::correct(double **f)
{
  if (coupled)
    correct_together(f);
  else
    masks.empty() ? correct_bodies<false>(f) : correct_bodies<true>(f);
}

/// MASKED: some components of the loads do not act.
template <bool MASKED> void Motion::correct_bodies(double **f)
{
  const auto correct_all = [&](auto changing) {
    for (const int ibody : bodies.points) correct_body<MASKED, true, changing>(ibody, f);
    for (const int ibody : bodies.tops) correct_body<MASKED, false, changing>(ibody, f);
  };
  tolerance ? correct_all(std::true_type()) : correct_all(std::false_type());
  if (!tolerance) begin_fresh(f);    // otherwise when the step holds
}

/// POINT: without moments of inertia.  CHANGING: the time step follows the error.
template <bool MASKED, bool POINT, bool CHANGING> void Motion::correct_body(int ibody, double **f)
{
  double *rows = bodies.history(ibody);
  const RigidBody &rigid = bodies.rigid_of(ibody);
  const Load masked = MASKED ? bodies.acting(ibody) : Load();
  const Load &load = MASKED ? masked : bodies.load_of(ibody);
  BodyState &state = bodies.change_state(ibody);
  const BodyState before = MASKED ? state : BodyState();
  Correction &last = bodies.change_last(ibody);
  if (CHANGING)
    last = tolerance->correct(*integrator, ibody, load);
  else
    last = POINT ? integrator->correct_center(rigid, load, rows)
                 : integrator->correct(rigid, load, bodies.axes(ibody), rows);
  if (POINT)
    integrator->center_state(rigid, rows, state);
  else
    integrator->body_state(rigid, rows, state, bodies.change_frame(ibody));
  if (MASKED) last.work = work_between(bodies.load_of(ibody), before, state);
  if (!CHANGING) check_limits(ibody, f);
}

/// Constraint and thermostat couple all bodies, so they are corrected pass by pass.
void Motion::correct_together(double **f)
{
  if (tolerance) tolerance->note_prediction();
  if (isokinetic)
    isokinetic->correct(*integrator);
  else
    thermostat->correct(*integrator, present_scheme());
  if (tolerance) tolerance->note_correction(*integrator);
  if (tolerance && thermostat)
    tolerance->note_chains(thermostat->left_out(step(), integrator->values()), thermostat->kt());
  if (!tolerance) hold_step(f);
}

/// The step is not made again.
void Motion::hold_step(double **f)
{
  for (const auto *list : {&bodies.points, &bodies.tops})
    for (const int ibody : *list) check_limits(ibody, f);
  if (thermostat) {
    thermostat->watch_cold(step());
    thermostat->watch_friction(step());
  }
  begin_fresh(f);
}

/// The histories of bodies that came in this step begin with the derivatives that are known.
void Motion::begin_fresh(double **f)
{
  const int known = args.start == Arguments::Start::ZERO ? 2 : 3;
  for (const int ibody : bodies.fresh) {
    blowup.check_load(ibody, step(), f);
    Bootstrap::seed_body(bodies, ibody, acting(ibody), present_scheme(), step(), known);
  }
  bodies.take_in_fresh();
  if (thermostat) thermostat->follow_changes(step());
}

bool Motion::repeats_step(double **f)
{
  if (!tolerance) return false;
  if (!tolerance->judge()) {
    hold_step(f);
    return false;
  }
  bodies.put_back_histories();
  if (thermostat) thermostat->put_back_chains();
  const int values = present_scheme().values();
  tolerance->shorten_values();
  if (present_scheme().values() != values) take_over_values();
  tolerance->shorten_step();
  bodies.keep_histories();
  if (thermostat) thermostat->keep_chains();
  predict_bodies(f);
  return true;
}

/// Positive; infinite where nothing but errors and dtmax limits it.
double Motion::longest_step() const
{
  return thermostat ? thermostat->longest_step() : std::numeric_limits<double>::infinity();
}

void Motion::choose_step()
{
  const int values = tolerance->scheme().values();
  const double next = tolerance->choose(longest_step());
  if (tolerance->scheme().values() != values) take_over_values();
  tolerance->change_step(next);
  tolerance->order_output();
}

/// The histories of bodies have the number of values that the tolerance has chosen.
void Motion::take_over_values()
{
  make_integrator(step());
}

/* ----------------------------------------------------------------------
   outputs
------------------------------------------------------------------------- */

int Motion::elements() const
{
  return elements_of_tolerance() +
      (isokinetic       ? IsokineticConstraint::ELEMENTS
           : thermostat ? Thermostat::ELEMENTS
                        : 0);
}

double Motion::element(int n) const
{
  const int behind = n - elements_of_tolerance();
  if (behind < 0) return tolerance->element(n);
  return isokinetic ? isokinetic->element(behind) : thermostat->element(behind);
}

int Motion::extensive(int n) const
{
  const int behind = n - elements_of_tolerance();
  return (isokinetic && behind == IsokineticConstraint::HEAT) ||
      (thermostat && behind == Thermostat::ENERGY);
}

const Integrator *Motion::present_integrator() const
{
  return started ? integrator.get() : nullptr;
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

Motion::Checkpoint Motion::checkpoint() const
{
  const Scheme &scheme = args.scheme;
  return {(double) scheme.first(),
          (double) scheme.values(),
          (double) scheme.compensate,
          (double) started,
          step(),
          (double) scheme.trial,
          (double) scheme.tuned,
          tolerance ? tolerance->checkpoint() : Tolerance::Checkpoint(),
          isokinetic ? isokinetic->checkpoint() : IsokineticConstraint::Checkpoint(),
          thermostat ? thermostat->checkpoint() : Thermostat::Checkpoint()};
}

void Motion::restore(const Checkpoint &saved)
{
  const Checkpoint mine = checkpoint();
  std::vector<std::string> others;    // keywords that had another value
  const auto compare = [&others](const char *keyword, double before, double now) {
    if (before != now) others.emplace_back(keyword);
  };
  compare("formulation", saved.formulation, mine.formulation);
  compare("values", saved.values, mine.values);
  compare("compensate", saved.compensate, mine.compensate);
  compare("tolerance", saved.variable, mine.variable);
  compare("isokinetic", saved.isokinetic.mode, mine.isokinetic.mode);
  const bool one_without = saved.thermostat.mode == 0.0 || mine.thermostat.mode == 0.0;
  compare(one_without ? "temp" : "thermostat", saved.thermostat.mode, mine.thermostat.mode);
  if (!one_without) compare("tchain", saved.thermostat.length, mine.thermostat.length);
  const bool same = others.empty();
  if (isokinetic && same) isokinetic->restore(saved.isokinetic);
  if (thermostat && same) thermostat->restore(saved.thermostat);
  started = saved.started != 0.0 && same;
  if (tolerance && started) tolerance->restore(saved.tolerance);
  last_step = saved.h;
  if (saved.h != 0.0) make_integrator(saved.h);
  if (started && saved.tuned != mine.tuned && comm->me == 0)
    error->warning(
        FLERR,
        "Fix gear/quat: the restart file was written with corrector {}; its histories go "
        "on with corrector {}",
        saved.tuned != 0.0 ? "tuned" : "gear", args.scheme.tuned ? "tuned" : "gear");
  if (saved.started != 0.0 && !same && comm->me == 0)
    error->warning(
        FLERR,
        "Fix gear/quat: the restart file was written with other settings of {}; poses and "
        "velocities are kept, the higher derivatives start anew",
        utils::join_words(others, ", "));
}
