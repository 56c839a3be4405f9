/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_tolerance.h"

#include "gear_quat_motion.h"
#include "gear_quat_ranks.h"
#include "gear_quat_scene.h"

#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

// no step moves a site by more than this part of the neighbor skin: a force that begins on the way is
// met before the body is deep in it

static constexpr double PART_OF_SKIN = 0.25;

static Scheme with_trial_row(Scheme scheme)
{
  scheme.trial = true;
  return scheme;
}

Tolerance::Tolerance(LAMMPS *lmp, const Fix *fix, const Scheme &scheme, const StepControl &control,
                     Bodies &bodies) :
    Pointers(lmp),
    fix(fix), bodies(bodies), present(with_trial_row(scheme)), control(control), order(present)
{
  record.values = present.values();
}

void Tolerance::refuse_scene() const
{
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR,
               "Fix gear/quat tolerance cannot be used with run_style respa: its levels have "
               "steps of their own");
  for (auto *other : modify->get_fix_list()) {
    if (other == fix) continue;
    const Motion *same = motion_of(other);
    if (utils::strmatch(other->style, "^dt/reset") || (same && same->changes_step()))
      error->all(
          FLERR,
          "Fix gear/quat tolerance: fix {} ({}) changes the time step too; one fix alone can "
          "do so",
          other->id, other->style);
  }
}

/* ----------------------------------------------------------------------
   start
------------------------------------------------------------------------- */

Scheme Tolerance::scheme_of_start() const
{
  Scheme start = present;
  start.trial = false;
  start.rows = control.most + 1;
  return start;
}

void Tolerance::begin(bool full)
{
  record = Checkpoint();
  set_values(full ? control.most : control.fewest);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    double *rows = bodies.history(ibody);
    double *above = rows + present.values() * present.width();
    if (full && present.carries()) {    // the row above the most is the trial row; carries are zero
      std::copy_n(above, present.width(), rows + present.trial_row());
      std::fill_n(above, present.carries() * present.width(), 0.0);
    }
  }
}

void Tolerance::shorten_first_step()
{
  double here[2] = {0.0, largest_speed()};
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    here[0] = std::max(here[0], order.error(bodies.history(ibody), bodies.body_at(ibody).reach()));
  const auto all = over_ranks(MPI_MAX, here, world);
  const double largest = all[0];
  const double ratio = std::min(1.0, control.allowed(largest, present.values()));
  const double size =
      std::max(control.shortest, std::min(ratio * std::fabs(update->dt), farthest_step(all[1])));
  if (size >= std::fabs(update->dt)) return;
  const Fix *first = fix;    // gear/quat, which starts histories for all before it begins the step
  for (const auto *other : modify->get_fix_list())
    if (utils::strmatch(other->style, "^gear/quat")) {
      first = other;
      break;
    }
  if (const Fix *other = integrated_before(first)) {
    if (comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat tolerance: the error of the first step is estimated as {:.2g}, "
          "more than {:.2g}; define fix {} ({}) after this fix, or use a time step of {:.2g}",
          largest, control.eps, other->id, other->style, size);
    return;
  }
  if (comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat tolerance: first step {:.3g} instead of {:.3g}\n",
                   std::copysign(size, update->dt), update->dt);
  set_begun_step(std::copysign(size, update->dt));
}

/// A fix that has begun this step when `begins` begins it, null for none.
const Fix *Tolerance::integrated_before(const Fix *begins) const
{
  for (const auto *other : modify->get_fix_list()) {    // in the order in which they begin a step
    if (other == begins) break;
    if (other->time_integrate) return other;
  }
  return nullptr;
}

/// Time so far was made of the steps before the one that has begun.
void Tolerance::set_begun_step(double step)
{
  const bigint before = update->ntimestep - 1;
  update->atime += (before - update->atimestep) * update->dt;
  update->atimestep = before;
  set_step(step);
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

Correction Tolerance::correct(const Integrator &integrator, int ibody, const Load &load)
{
  StepErrors one;
  const Body &body = bodies.body_at(ibody);
  const Correction correction = order.correct(integrator, body.rigid, body.reach(), load,
                                              bodies.axes(ibody), bodies.history(ibody), one);
  if (!std::isfinite(one.same)) one.same = std::numeric_limits<double>::infinity();
  errors.include(one);
  return correction;
}

/// No site on this rank is faster.
double Tolerance::largest_speed() const
{
  double largest = 0.0;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const BodyState &s = bodies.state_of(ibody);
    const double speed = length(s.velocity) + bodies.body_at(ibody).reach() * length(s.omega_body);
    largest = std::max(largest, speed);
  }
  return largest;
}

/// Where nothing moves nothing is known of what a longer step would do.
double Tolerance::farthest_step(double speed) const
{
  if (speed == 0.0) return std::fabs(update->dt);
  return neighbor->skin > 0.0 ? PART_OF_SKIN * neighbor->skin / speed
                              : std::numeric_limits<double>::infinity();
}

double Tolerance::choose()
{
  double here[5] = {errors.fewer, errors.same, errors.more, fresh ? 1.0 : 0.0, largest_speed()};
  const auto all = over_ranks(MPI_MAX, here, world);
  errors = StepErrors();
  fresh = false;
  if (std::isinf(all[1]))
    error->all(
        FLERR,
        "Fix gear/quat tolerance: the estimated error of step {} is not a number; the forces "
        "are wrong, or the motion is lost: use a smaller tolerance",
        update->ntimestep);

  const double step = update->dt, size = std::fabs(step);
  const int values = present.values();
  record.smallest = record.steps == 0.0 ? size : std::min(record.smallest, size);
  record.steps += 1.0;
  record.steady += 1.0;
  record.time += size;
  record.values_sum += values;
  record.largest = std::max(record.largest, all[1] / control.eps);

  auto next = control.next({all[0], all[1], all[2]}, step, values, (int) record.steady,
                           farthest_step(all[4]));
  if (all[3] != 0.0) next.values = control.fewest;    // rows above are zero in a fresh history
  if (next.held) {
    record.held += 1.0;
    if (!warned_held && comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat tolerance: step {} makes an error of {:.2g}, more than {:.2g}, but "
          "dtmin keeps the time step at {:.3g}; further such steps are counted",
          update->ntimestep, all[1], control.eps, control.shortest);
    warned_held = true;
  }
  if (next.values != values) change_values(next.values);
  return next.step;
}

/// The step that ends now was made with the present one.
void Tolerance::change_step(double step)
{
  if (step == update->dt) return;
  update->update_time();
  set_step(step);
}

void Tolerance::set_values(int values)
{
  present.rows = values;
  order = VariableOrder(present);
  record.values = values;
  record.steady = 0.0;
}

void Tolerance::change_values(int values)
{
  while (present.values() != values) {
    const bool more = values > present.values();
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      more ? order.add_row(bodies.history(ibody)) : order.drop_row(bodies.history(ibody));
    set_values(present.values() + (more ? 1 : -1));
  }
}

void Tolerance::keep_step(double step)
{
  if (update->dt == step) return;
  tell_of_step(step);
  change_step(step);
}

void Tolerance::put_back_begun_step(double step)
{
  if (const Fix *other = integrated_before(fix))
    error->all(
        FLERR,
        "Fix gear/quat tolerance: the time step was changed before a run with pre no, and fix "
        "{} ({}) has begun the first step with it; leave out pre no",
        other->id, other->style);
  tell_of_step(step);
  set_begun_step(step);
}

void Tolerance::tell_of_step(double step) const
{
  if (comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat tolerance: goes on with a time step of {:.3g}, not {:.3g}\n",
                   step, update->dt);
}

/// As fix dt/reset changes it; this fix learns of it with all others.
void Tolerance::set_step(double step)
{
  changing_step = true;
  update->dt = step;
  update->dt_default = 0;
  if (force->pair) force->pair->reset_dt();
  for (auto *other : modify->get_fix_list()) other->reset_dt();
  output->reset_dt();
  changing_step = false;
}

/* ----------------------------------------------------------------------
   outputs and restart
------------------------------------------------------------------------- */

double Tolerance::element(int n) const
{
  switch (n) {
    case STEP:
      return update->dt;
    case SMALLEST:
      return record.smallest;
    case MEAN:
      return record.steps > 0.0 ? record.time / record.steps : 0.0;
    case VALUES:
      return present.values();
    case MEAN_VALUES:
      return record.steps > 0.0 ? record.values_sum / record.steps : 0.0;
    case LARGEST_ERROR:
      return record.largest;
    default:
      return record.held;
  }
}

void Tolerance::restore(const Checkpoint &saved)
{
  set_values((int) saved.values);
  record = saved;
}
