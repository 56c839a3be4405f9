/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Motion before the first step of a run: which histories go on, and which begin. */

#include "gear_quat_motion.h"

#include "gear_quat_ranks.h"
#include "gear_quat_scene.h"

#include "comm.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

// If the step becomes shorter than this part of the last one, histories start anew: the errors in
// their higher rows are those of the long step.  If it becomes longer than so many of the last one,
// too: these errors grow with powers of the ratio, and may be as large as the motion.

static constexpr double SHORTER = 0.49, LONGER = 2.05;

// Forces at a corrected pose differ from those at the predicted one by what the step has corrected,
// so at a stable step they leave a smaller residual than the last one.  If a residual exceeds the
// last one OTHER_FORCES times, or OTHER_NOISE times where forces are random, the forces are not
// those of the last step any more.  Residuals that rounding explains are excepted: rounding of
// forces, relative to the largest force on an atom, and rounding of the way that a body moves in a
// step.

static constexpr double OTHER_FORCES = 1.0, OTHER_NOISE = 10.0;
static constexpr double ROUNDING_OF_FORCES = 1.0e-11, ROUNDING_OF_MOTION = 1.0e-13;

/* ---------------------------------------------------------------------- */

void Motion::begin_steps(const std::vector<Motion *> &all, double **f)
{
  std::vector<Motion *> full;
  std::vector<bool> needed;
  for (auto *one : all)
    if (one->tolerance && !one->started) one->tolerance->bound_first_step(one->longest_step());
  for (auto *one : all) {
    one->set_up = false;
    const bool needs = one->has_to_start(f);
    if (one->bootstraps()) {
      full.push_back(one);
      needed.push_back(needs);
    } else if (needs) {
      Bootstrap::zero(one->party(true), one->step());
      one->begin(false);
      if (one->tolerance) one->tolerance->shorten_first_step(false);
    }
  }
  if (!std::count(needed.begin(), needed.end(), true)) return;

  // Histories that could continue start anew too if this gives the others a start of full order.

  const bool some_go_on = std::count(needed.begin(), needed.end(), false) > 0;
  const bool together = !some_go_on || full[0]->forces_can_be_followed();
  std::vector<Party> parties;
  for (size_t n = 0; n < full.size(); ++n)
    if (needed[n] || together) parties.push_back(full[n]->party(needed[n]));
  const bool found = Bootstrap(full[0]->lmp, parties, full[0]->step()).run();
  for (size_t n = 0; n < full.size(); ++n)
    if (needed[n] || (together && found)) full[n]->begin(found);
  for (size_t n = 0; n < full.size(); ++n)
    if ((found || needed[n]) && full[n]->tolerance) full[n]->tolerance->shorten_first_step(found);
}

/// Returns null if the histories can continue.  Collective.
const char *Motion::reason_to_start_anew(double **f)
{
  if (std::fabs(step()) < SHORTER * std::fabs(last_step) && can_start_anew())
    return "the time step is less than half of that of the last steps";
  if (std::fabs(step()) > LONGER * std::fabs(last_step) && last_step != 0.0 && can_start_anew())
    return "the time step is more than twice that of the last steps";
  if (!movers.empty() && movers != present_movers() && can_start_anew())
    return "other fixes move atoms than in the last steps";
  if (thermostat && thermostat->target_jumps() && bootstraps() && forces_can_be_followed())
    return "the thermostat has another target, or other degrees of freedom, than in the last steps";
  return forces_changed(f) ? "forces are not those of the last step" : nullptr;
}

/// The other fixes that move atoms: the derivatives of forces depend on that motion.
std::string Motion::present_movers() const
{
  std::string ids = "of this run:";
  for (const auto *other : modify->get_fix_list())
    if (other != fix && other->time_integrate) ids += std::string(" ") + other->id;
  return ids;
}

/// True if a new start would be of full order, and nothing but the histories would be new.
bool Motion::can_start_anew() const
{
  return !tolerance && !isokinetic && bootstraps() && forces_can_be_followed();
}

/// By a start of full order, of all fixes together.
bool Motion::forces_can_be_followed() const
{
  std::vector<const Fix *> owners;
  for (auto *other : modify->get_fix_list()) {
    const Motion *same = motion_of(other);
    if (same && (same->bootstraps() || same == this)) owners.push_back(other);
  }
  return Forces(lmp, owners).reason().empty();
}

/// True if the present loads leave a residual that the histories cannot have left.
bool Motion::forces_changed(double **f)
{
  measure();
  double here[2] = {0.0, 0.0};    // error of the last step, force on an atom
  for (auto *other : modify->get_fix_list())
    if (const Motion *same = motion_of(other)) here[0] = std::max(here[0], same->last_error());
  for (const Site &site : sites) here[1] = std::max(here[1], force->ftm2v * length(f[site.atom]));
  const auto largest = over_ranks(MPI_MAX, here, world);

  double ratio = 0.0;
  for (const auto *list : {&bodies.points, &bodies.tops})
    for (const int ibody : *list) {
      double rows[MAX_SIZE];
      std::copy_n(bodies.history(ibody), args.scheme.size(), rows);
      const Body &body = bodies.body_at(ibody);
      const Correction found = list == &bodies.points
          ? integrator->correct_center(body.rigid, acting(ibody), rows)
          : integrator->correct(body.rigid, acting(ibody), rows);
      const double one = body.length(found) / (largest[0] + rounding(ibody, largest[1]));
      ratio = std::isfinite(one) ? std::max(ratio, one) : 2.0 * OTHER_NOISE;
    }
  ratio = over_ranks(MPI_MAX, ratio, world);
  return ratio > OTHER_NOISE || (ratio > OTHER_FORCES && forces_can_be_followed());
}

/// The part of a residual that rounding explains, as a length.  force: the largest one on an atom.
double Motion::rounding(int ibody, double force) const
{
  const Body &body = bodies.body_at(ibody);
  const BodyState &s = bodies.state_of(ibody);
  const double size = std::fabs(step());
  double response = 1.0 / body.rigid.mass;
  for (const double moment : body.rigid.inertia)
    if (moment > 0.0) response = std::max(response, body.reach() * body.reach() / moment);
  const double noise = ROUNDING_OF_FORCES * std::sqrt((double) body.natoms) * force;
  const double way = size * length(s.velocity) + body.reach() * (1.0 + size * length(s.omega_body));
  return size * size * response * noise + ROUNDING_OF_MOTION * way;
}

double Motion::last_error() const
{
  double largest = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    largest = std::max(largest, bodies.body_at(ibody).length(bodies.last_of(ibody)));
  return largest;
}

/// True if histories have to start; rank 0 says why they start anew.
bool Motion::has_to_start(double **f)
{
  if (thermostat) thermostat->meet_forces();
  const char *reason = started ? reason_to_start_anew(f) : nullptr;
  if (reason && comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat {}: {}, histories start anew\n", fix->id, reason);
  const bool needs = !started || reason;
  movers = present_movers();
  if (thermostat) thermostat->begin_steps(needs);
  if (needs) blowup.check_loads(step(), f);
  return needs;
}

Party Motion::party(bool needed)
{
  return {fix,
          &bodies,
          &ownership,
          &sites,
          isokinetic.get(),
          thermostat.get(),
          tolerance ? tolerance->scheme_of_start() : args.scheme,
          needed};
}

/// Histories have started.  full: all their rows are known.
void Motion::begin(bool full)
{
  started = true;
  if (!tolerance) return;
  tolerance->begin(full);
  take_over_values();
}
