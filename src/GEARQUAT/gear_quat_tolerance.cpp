/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_tolerance.h"

#include "gear_quat_ranks.h"
#include "gear_quat_styles.h"

#include "comm.h"
#include "compute.h"
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
#include <array>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

/// An invalid length is refused earlier, by the checks before a run.
double TimeStep::follow()
{
  const double next = update->dt;
  if (next == 0.0 || !std::isfinite(next) || next == h) return 0.0;
  const double ratio = next / h;
  h = next;
  return ratio;
}

void TimeStep::change(double step)
{
  update->update_time();    // in every step: rounding then does not depend on the number of runs
  if (step != update->dt) set(step);
}

void TimeStep::change_begun(double step)
{
  const bigint before = update->ntimestep - 1;
  update->atime += (before - update->atimestep) * update->dt;
  update->atimestep = before;
  --update->ntimestep;    // a dump in intervals of time may not be due at the new end of the step
  set(step);
  ++update->ntimestep;
}

/// Changes the step as fix dt/reset does; this fix is notified together with all others.
void TimeStep::set(double step)
{
  update->dt = step;
  update->dt_default = 0;
  if (force->pair) force->pair->reset_dt();
  for (auto *fix : modify->get_fix_list()) fix->reset_dt();
  output->reset_dt();
}

double TimeStep::time_of(bigint step) const
{
  return update->atime + (step - update->atimestep) * update->dt;
}

/* ---------------------------------------------------------------------- */

Tolerance::Tolerance(const Scene &scene, TimeStep &time_step) :
    Scene(scene), time_step(time_step), present(RememberedLoads::scheme(args.scheme.compensate)),
    control(args.control), remembered(args.scheme.compensate), failed()
{
  if (control.energy) control.eps /= force->mvv2e;
}

/* ----------------------------------------------------------------------
   start
------------------------------------------------------------------------- */

void Tolerance::begin(double permitted)
{
  record = Record();
  growing = Growth::START;
  remembered.begin();
  present.rows = remembered.values();
  const double given = update->dt, speed = over_ranks(MPI_MAX, largest_speed(), world);
  double size = std::min({std::fabs(given), permitted, farthest_step(speed), first_step()});
  if (control.longest > 0.0) size = std::min(size, control.longest);
  size = std::max(size, control.shortest);
  size = std::fabs(even(std::copysign(size, given), time_step.beginning()));
  if (size == std::fabs(given)) return;
  for (const auto *other : modify->get_fix_list()) {    // in the order in which they begin a step
    if (other == fix) break;
    if (!other->time_integrate) continue;
    if (size < std::fabs(given) && comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat tolerance: the first step of {:.3g} should be no longer than "
                     "{:.3g}; define fix {} ({}) after this fix, or use that time step",
                     std::fabs(given), size, other->id, other->style);
    return;
  }
  time_step.change_begun(std::copysign(size, given));
  if (comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat tolerance: first step {:.3g} instead of {:.3g}\n",
                   update->dt, given);
}

/// The first step of histories with the present loads alone.  Forces are assumed to change by their
/// own magnitude while a body moves by its size, at its speed or by its acceleration from rest.
double Tolerance::first_step() const
{
  double least = std::numeric_limits<double>::infinity();
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const Body &body = bodies.body[ibody];
    const BodyState &state = bodies.state[ibody];
    const double reach = body.reach(), size = reach > 0.0 ? reach : limit_of_motion();
    double turn[3];
    angular_acceleration(body.rigid, state, dot4(state.q, state.q), bodies.load[ibody], turn);
    const double speed = length(state.velocity) + reach * length(state.omega_body);
    const double acceleration =
        length(bodies.load[ibody].force) / body.rigid.mass + reach * length(turn);
    const double jerk = acceleration * std::max(speed / size, std::sqrt(acceleration / size));
    if (jerk > 0.0) least = std::min(least, control.first_step(jerk, speed, body.rigid.mass));
  }
  return over_ranks(MPI_MIN, least, world);
}

/* ----------------------------------------------------------------------
   length and loads
------------------------------------------------------------------------- */

void Tolerance::change_loads(int loads)
{
  while (remembered.loads() != loads)
    remembered.change(loads > remembered.loads(), update->dt, [this](const auto &act) {
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) act(bodies.history(ibody));
    });
  present.rows = remembered.values();
}

void Tolerance::keep_step()
{
  if (update->dt == time_step.length()) return;
  if (comm->me == 0)
    utils::logmesg(lmp,
                   "Fix gear/quat tolerance: keeping time step {:.3g}; the timestep command "
                   "({:.3g}) is ignored\n",
                   time_step.length(), update->dt);
  time_step.change(time_step.length());
}

/* ----------------------------------------------------------------------
   outputs and restart
------------------------------------------------------------------------- */

double Tolerance::element(int n) const
{
  const Record &all = record;
  const double steps = std::max(all.steps, 1.0);
  return std::array<double, ELEMENTS>{
      update->dt,  all.smallest, all.time / steps, (double) remembered.loads(), all.loads / steps,
      all.largest, all.held,     all.repeated,     all.last * unit_of_error()}[n];
}

void Tolerance::fields(Fields &v)
{
  v(record, growing, remembered);
  present.rows = remembered.values();
}

// no step moves a site by more than this part of the neighbor skin, so that the onset of a force is
// detected before the body has moved far into its range

static constexpr double PART_OF_SKIN = 0.25;

// limit for the motion between two steps at which lists may be rebuilt

static constexpr double PART_UNSEEN = 0.5;

// a step that has failed this many times is no longer repeated

static constexpr int MOST_TRIES = 40;

// a smaller part of a step counts as no time

static constexpr double ROUNDING_OF_TIME = 1.0e-6;

/* ---------------------------------------------------------------------- */

void Tolerance::begin_step()
{
  if (update->dt != time_step.length())
    error->all(FLERR,
               "Fix gear/quat tolerance: the time step was changed before a run with pre no; leave "
               "out pre no");
  if (update->ntimestep == update->firststep + 1) begin_run();
  tries = 0;
  if (forces) bodies.keep_histories();
}

/// The first step of a run.  Rank 0 reports if no step can be repeated.
void Tolerance::begin_run()
{
  forces = std::make_unique<Forces>(lmp, std::vector<const Fix *>{fix});
  std::string why = forces->reason();
  for (const auto *one : modify->get_compute_list())
    if (why.empty() && adds_up(one))
      why = fmt::format("compute {} ({}) adds up every evaluation of forces", one->id, one->style);
  if (why.empty()) return;
  forces.reset();
  if (comm->me == 0)
    utils::logmesg(lmp,
                   "Fix gear/quat tolerance: no step is repeated, because {}; errors exceed the "
                   "tolerance where forces change suddenly\n",
                   why);
}

void Tolerance::include(StepErrors one)
{
  if (!std::isfinite(one.error)) one.error = std::numeric_limits<double>::infinity();
  errors.include(one);
}

void Tolerance::note_prediction(const Block &block)
{
  for (int k = 0; k < block.count; ++k)
    predicted[k] = RememberedLoads::accelerations(block.rows[k]);
}

void Tolerance::note_correction(const Integrator &integrator, const Block &block, const int *ids,
                                RememberedLoads::Last last)
{
  for (int k = 0; k < block.count; ++k) {
    const RigidBody &rigid = *block.bodies[k];
    const double reach = bodies.body[ids[k]].reach();
    const Load load = bodies.acting(ids[k]);
    StepErrors one =
        remembered.finish(control, integrator, rigid, reach, load, bodies.frame[ids[k]].axes,
                          predicted[k], block.rows[k], last);
    one.error *= control.counted(integrator, rigid, reach, load, block.rows[k]);
    include(one);
  }
}

/// An upper limit for the speeds of sites on this rank.
double Tolerance::largest_speed() const
{
  double largest = 0.0;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const BodyState &s = bodies.state[ibody];
    const double speed = length(s.velocity) + bodies.body[ibody].reach() * length(s.omega_body);
    largest = std::max(largest, speed);
  }
  return largest;
}

/// Maximum displacement of a site in a step, infinite if the range of the forces is unknown.
double Tolerance::limit_of_motion() const
{
  double range = neighbor->skin > 0.0 ? neighbor->skin : std::numeric_limits<double>::infinity();
  if (force->pair && force->pair->cutforce > 0.0) range = std::min(range, force->pair->cutforce);
  const double every = neighbor->every;    // steps in which LAMMPS does not test neighbor lists:
  const double unseen =
      neighbor->build_once ? 1.0 : every * std::max(1.0, std::ceil(neighbor->delay / every));
  return range * std::min(PART_OF_SKIN, PART_UNSEEN / unseen);
}

/// Without motion the effect of a longer step is unknown.
double Tolerance::farthest_step(double speed) const
{
  return speed == 0.0 ? std::fabs(update->dt) : limit_of_motion() / speed;
}

bool Tolerance::accepts()
{
  double here[] = {
      errors.error,   errors.fewer, errors.same, errors.more, bodies.fresh.empty() ? 0.0 : 1.0,
      largest_speed()};
  const auto all = over_ranks(MPI_MAX, here, world);
  errors = {all[0], all[1], all[2], all[3]};
  fresh = all[4] != 0.0;
  speed = all[5];
  if (forces && control.fails(errors.error, update->dt) && tries < MOST_TRIES) {
    ++tries;
    record.repeated += 1.0;
    failed = control.repeat(errors.error, update->dt, remembered.loads(), growing);
    errors = StepErrors();
    return false;
  }
  if (!std::isfinite(errors.error) || tries == MOST_TRIES)
    error->all(
        FLERR,
        "Fix gear/quat tolerance: step {} was tried {} times, and its error is {:.2g} still at a "
        "time step of {:.3g}; the forces are not continuous or no numbers, or the tolerance is "
        "smaller than their rounding",
        update->ntimestep, tries + 1, errors.error * unit_of_error(), update->dt);
  remembered.conclude(update->dt);
  return true;
}

void Tolerance::shorten()
{
  change_loads(failed.loads);
  time_step.change_begun(failed.step);
}

double Tolerance::choose(double permitted)
{
  const double step = update->dt;
  const double size = std::fabs(step);
  record.smallest = record.steps == 0.0 ? size : std::min(record.smallest, size);
  record.steps += 1.0;
  record.time += size;
  record.loads += remembered.loads();
  record.largest = std::max(record.largest, errors.error / control.eps);
  record.last = errors.error;
  auto next =
      control.next(errors, step, remembered, growing, std::min(permitted, farthest_step(speed)));
  if (fresh) {    // fresh histories have the present load only
    next.loads = 1;
    growing = Growth::START;
    next.step = std::copysign(std::min(std::fabs(next.step), first_step()), step);
  }
  if (std::fabs(next.step) == control.shortest) {
    record.held += 1.0;
    if (record.held == 1.0 && comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat tolerance: after step {} dtmin keeps the time step at {:.3g}, longer than "
          "the tolerance or the motion permits; further such steps are counted",
          update->ntimestep, control.shortest);
  }
  errors = StepErrors();
  change_loads(next.loads);
  if (fresh) remembered.begin();
  fresh = false;
  return even(next.step, time_step.time_of(update->ntimestep));
}

/// Equal steps that end at the next output if it is due within a few steps: at a multiple of
/// every_time, or a dump in intervals of time.  The last step ends there to the last bit.  now: the
/// beginning of the step.
double Tolerance::even(double step, double now) const
{
  if (step <= 0.0) return step;
  const double nearest = now + ROUNDING_OF_TIME * step;    // earlier times belong to the last step
  double next = std::numeric_limits<double>::infinity();
  if (args.every_time > 0.0) next = (std::floor(now / args.every_time) + 1.0) * args.every_time;
  if (next <= nearest) next += args.every_time;
  for (int n = 0; n < output->ndump; ++n) {
    if (output->mode_dump[n] == 0) continue;
    double at = output->next_time_dump[n];
    if (at <= nearest) at += output->every_time_dump[n];    // it is written now
    if (at > nearest) next = std::min(next, at);
  }
  const double way = next - now;
  if (!std::isfinite(next) || !(way > 0.0)) return step;
  const double size = even_step(step, way);
  if (way > 1.5 * size)    // rounding of the time is no reason to change the step
    return std::fabs(size - step) < ROUNDING_OF_TIME * step ? step : size;
  double last = way;
  for (int n = 0; n < 4 && now + last != next; ++n)
    last = std::nextafter(last, now + last < next ? HUGE_VAL : 0.0);
  return last;
}

void Tolerance::evaluate(int vflag)
{
  modify->clearstep_compute();             // computes have evaluated other positions
  const bigint now = update->ntimestep;    // as set by Integrate::ev_set()
  const int eflag = (update->eflag_global == now ? ENERGY_GLOBAL : 0) |
      (update->eflag_atom == now ? ENERGY_ATOM : 0);
  forces->evaluate(eflag, vflag);
}
