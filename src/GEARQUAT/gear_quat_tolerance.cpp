/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_tolerance.h"

#include "gear_quat_known_styles.h"
#include "gear_quat_limits.h"
#include "gear_quat_ranks.h"
#include "gear_quat_scene.h"

#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

Tolerance::Tolerance(LAMMPS *lmp, const Fix *fix, const Scheme &scheme, const StepControl &control,
                     double every_time, const Fleet &fleet, Bodies &bodies, TimeStep &time_step) :
    Pointers(lmp),
    fix(fix), fleet(fleet), bodies(bodies), time_step(time_step),
    present(RememberedLoads::scheme(scheme.compensate)), control(control), every_time(every_time),
    remembered(scheme.compensate), repeat(lmp, fix), predicted(bodies), failed()
{
  if (control.energy) this->control.eps /= force->mvv2e;
}

void Tolerance::refuse_scene() const
{
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR,
               "Fix gear/quat tolerance cannot be used with run_style respa, whose levels "
               "have different steps");
  for (auto *other : modify->get_fix_list()) {
    if (other == fix) continue;
    const Fleet::Member *same = fleet.find(other);
    if (known(FixFact::TIME_STEP, other) || (same && same->changes_step))
      error->all(
          FLERR,
          "Fix gear/quat tolerance: fix {} ({}) changes the time step too; one fix alone can "
          "do so",
          other->id, other->style);
    if (same && same->tuned)
      error->all(FLERR,
                 "Fix gear/quat tolerance: fix {} ({}) follows the changing time step, and with "
                 "tuned coefficients errors from a change decay too slowly; give it corrector "
                 "gear, or let this fix move its bodies",
                 other->id, other->style);
    if (same && comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat tolerance: nothing controls the errors of the bodies of fix {} "
                     "({}), which follows the time step of this fix",
                     other->id, other->style);
  }
}

/* ----------------------------------------------------------------------
   start
------------------------------------------------------------------------- */

void Tolerance::begin()
{
  record = Record();
  growing = Growth();
  remembered.begin();
  present.rows = remembered.values();
}

/// Rank 0 warns if no step is short enough for eps.  Collective.
void Tolerance::warn_of_rounding() const
{
  const Integrator integrator = this->integrator();
  double largest = 0.0;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    largest = std::max(largest, control.error(rounding(integrator, ibody, bodies.load_of(ibody))));
  largest = over_ranks(MPI_MAX, largest, world);
  if (control.eps >= largest || comm->me != 0) return;
  error->warning(
      FLERR,
      "Fix gear/quat tolerance: eps is {:.2g} {} units, and rounding of the motion causes "
      "errors of {:.2g}, which shorter steps do not reduce; use an eps of {:.2g} or more",
      shown(control.eps), control.energy ? "energy" : "distance", shown(largest),
      rounded_up(shown(largest)));
}

/// The first step of histories with the present loads alone.  Forces are assumed to change by their
/// own magnitude while a body moves by its size, at its speed or by its acceleration from rest.
double Tolerance::first_step() const
{
  double least = std::numeric_limits<double>::infinity();
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const Body &body = bodies.body_at(ibody);
    const BodyState &state = bodies.state_of(ibody);
    const double reach = body.reach(), size = reach > 0.0 ? reach : limit_of_motion();
    double turn[3];
    angular_acceleration(body.rigid, state, dot4(state.q, state.q), bodies.load_of(ibody), turn);
    const double speed = length(state.velocity) + reach * length(state.omega_body);
    const double acceleration =
        length(bodies.load_of(ibody).force) / body.rigid.mass + reach * length(turn);
    const double jerk = acceleration * std::max(speed / size, std::sqrt(acceleration / size));
    if (jerk > 0.0) least = std::min(least, control.first_step(jerk, speed, body.rigid.mass));
  }
  return over_ranks(MPI_MIN, least, world);
}

void Tolerance::bound_first_step(double permitted)
{
  const double given = std::fabs(update->dt);
  double size =
      std::min({given, permitted, farthest_step(over_ranks(MPI_MAX, largest_speed(), world))});
  if (control.longest > 0.0) size = std::min(size, control.longest);
  size = std::max(size, control.shortest);
  if (size != given && !integrated_before(first_mover()))
    time_step.change_begun(std::copysign(size, update->dt));
}

void Tolerance::shorten_first_step()
{
  warn_of_rounding();
  const double speed = over_ranks(MPI_MAX, largest_speed(), world);
  double size = std::min({std::fabs(update->dt), first_step(), farthest_step(speed)});
  size = std::max(control.shortest, size);
  size = std::fabs(even(std::copysign(size, update->dt), time_step.beginning()));
  if (size >= std::fabs(update->dt)) return;
  if (const Fix *other = integrated_before(first_mover())) {
    if (comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat tolerance: the first step of {:.3g} should be no longer than "
                     "{:.3g}; define fix {} ({}) after this fix, or use that time step",
                     std::fabs(update->dt), size, other->id, other->style);
    return;
  }
  const double instead = update->dt;
  time_step.change_begun(std::copysign(size, instead));
  tell_of_first_step(instead);
}

/// Reports the first step; instead: the length in LAMMPS.
void Tolerance::tell_of_first_step(double instead) const
{
  if (comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat tolerance: first step {:.3g} instead of {:.3g}\n",
                   update->dt, instead);
}

/// The first fix gear/quat, which starts the histories of all before it begins the step.
const Fix *Tolerance::first_mover() const
{
  return fleet.members.front().fix;
}

/// A fix that has begun this step before `begins` begins it, null for none.
const Fix *Tolerance::integrated_before(const Fix *begins) const
{
  for (const auto *other : modify->get_fix_list()) {    // in the order in which they begin a step
    if (other == begins) break;
    if (other->time_integrate) return other;
  }
  return nullptr;
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
  tell_of_step();
  time_step.change(time_step.length());
}

void Tolerance::put_back_begun_step()
{
  if (const Fix *other = integrated_before(fix))
    error->all(
        FLERR,
        "Fix gear/quat tolerance: the time step was changed before a run with pre no, and fix "
        "{} ({}) has begun the first step with it; leave out pre no",
        other->id, other->style);
  tell_of_step();
  time_step.change_begun(time_step.length());
}

void Tolerance::tell_of_step() const
{
  if (comm->me == 0)
    utils::logmesg(lmp,
                   "Fix gear/quat tolerance: keeping time step {:.3g}; the timestep command "
                   "({:.3g}) is ignored\n",
                   time_step.length(), update->dt);
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
    case LOADS:
      return remembered.loads();
    case MEAN_LOADS:
      return record.steps > 0.0 ? record.loads / record.steps : 0.0;
    case LARGEST_ERROR:
      return record.largest;
    case REPEATED:
      return record.repeated;
    case LENGTH:
      return record.last_length;
    case ENERGY:
      return record.last_energy * force->mvv2e;
    default:
      return record.held;
  }
}

void Tolerance::fields(Fields &v)
{
  v(record, growing, remembered);
  present.rows = remembered.values();
}
