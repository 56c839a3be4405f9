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
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

// Histories start again if the step becomes shorter than this part of the last step: the errors in
// their higher rows are due to the long step.  They also start again if the step becomes longer by
// more than this factor: the errors grow with powers of the ratio, and may be as large as the
// motion.

static constexpr double SHORTER = 0.49, LONGER = 2.05;

// Forces at a corrected pose differ from forces at the predicted pose by the effect of the
// correction, so at a stable step their residual is smaller than the last residual.  If a residual
// exceeds the last residual by OTHER_FORCES, or by OTHER_NOISE where forces cannot be evaluated
// again, the forces have changed since the last step.  Residuals explained by rounding are excepted:
// rounding of forces, relative to the largest force on an atom, and rounding of the displacement of
// a body in a step.

static constexpr double OTHER_FORCES = 1.0, OTHER_NOISE = 10.0;
static constexpr double ROUNDING_OF_FORCES = 1.0e-11, ROUNDING_OF_MOTION = 1.0e-13;

/* ---------------------------------------------------------------------- */

Motion::Motion(LAMMPS *lmp, Fix *fix, const Arguments &args, const Fleet &fleet, Bodies &bodies,
               Ownership &ownership, Sites &sites, OtherFixes &others, Step &step) :
    Pointers(lmp),
    fix(fix), args(args), fleet(fleet), bodies(bodies), ownership(ownership), sites(sites),
    others(others), step(step), vibrations(lmp, bodies)
{
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
  if (step.tolerance) step.tolerance->refuse_scene();
  if (step.tolerance && step.started) step.tolerance->keep_step();
  step.follow_length();
}

void Motion::forget(const std::string &why)
{
  if (step.started && comm->me == 0) utils::logmesg(lmp, why + "\n");
  step.started = false;
}

void Motion::impose_masks()
{
  if (!ownership.change_masks(masks) || !step.started)
    return;    // only the scheme of a restart file may differ
  step.started = false;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: keywords force and torque turn off other components than in "
                   "the run that wrote the restart file; poses and velocities are kept, the "
                   "higher derivatives start anew");
}

void Motion::begin_run()
{
  const double h = step.length();
  if (update->nsteps > 0) step.blowup.pace = pace_of(lmp, bodies);
  if (!step.started && !step.tolerance && update->nsteps > 0)
    check_spins(lmp, bodies,
                args.automatic_values ? scene_of(sums_by_loads(bodies)).choose(args.scheme).scheme
                                      : step.scheme(),
                step.blowup.pace, h);
  if (step.coupling && args.automatic_values && !step.started && !args.scheme.first()) {
    Scheme damped = args.scheme;    // the strongest friction that any number of values permits
    damped.rows = SECOND_FEWEST;
    step.coupling->set_scheme(damped);
  }
  if (step.coupling)
    step.coupling->begin_run(!step.started, step.tolerance ? std::min(h, longest_step()) : h);
  if (step.tolerance) step.tolerance->announce_output();
  vibrations.begin_run();
  set_up = true;
}

/// Positive; infinite if it is limited only by errors and dtmax.
double Motion::longest_step() const
{
  return step.coupling ? step.coupling->longest_step() : HUGE_VAL;
}

void Motion::take_velocities(bigint of_step, bool end)
{
  if (!others.any_taken()) return;
  const std::vector<int> changed = others.take_velocities(of_step, end);
  if (!step.started) return;
  if (step.coupling) {
    step.coupling->measure();
    if (over_ranks(MPI_MAX, (int) !changed.empty(), world))
      step.coupling->follow_velocities(step.length());
  }
  for (const int ibody : changed)
    step.present_integrator()->set_velocities(bodies.rigid_of(ibody),
                                              scaled_of(bodies, step.coupling.get(), ibody),
                                              step.acting(ibody), bodies.history(ibody));
}

/* ----------------------------------------------------------------------
   which histories continue
------------------------------------------------------------------------- */

void Motion::begin_steps(const Fleet &fleet, double **f, double **torque)
{
  std::vector<Motion *> full;
  std::vector<bool> needed;
  for (const auto &one : fleet.members) {
    Motion &motion = *one.motion;
    motion.take_velocities(motion.update->ntimestep - 1, true);
    motion.ownership.spread_states();
    motion.step.gather(f, torque);
  }
  for (const auto &one : fleet.members) {
    Step &step = one.motion->step;
    if (step.tolerance && !step.started)
      step.tolerance->bound_first_step(one.motion->longest_step());
  }
  for (const auto &one : fleet.members) {
    Motion *motion = one.motion;
    motion->set_up = false;
    const bool needs = motion->has_to_start(f);
    if (motion->bootstraps()) {
      full.push_back(motion);
      needed.push_back(needs);
    } else if (needs) {
      if (motion->step.tolerance) motion->step.tolerance->begin();
      motion->starter(true).seed_local(motion->step.tolerance ? 3 : 2, motion->step.length());
      motion->begin();
      if (motion->step.tolerance) motion->step.tolerance->shorten_first_step();
    }
  }
  start_together(full, needed);
}

void Motion::start_together(const std::vector<Motion *> &full, const std::vector<bool> &needed)
{
  if (!std::count(needed.begin(), needed.end(), true)) return;

  // Histories that could continue also start again if this gives the other fixes a start of full
  // order.

  const bool some_go_on = std::count(needed.begin(), needed.end(), false) > 0;
  const bool together = !some_go_on || full[0]->forces_can_be_followed();
  std::vector<Starter> starters;
  for (size_t n = 0; n < full.size(); ++n)
    if (needed[n] || together) starters.push_back(full[n]->starter(needed[n]));
  const bool found = Start(full[0]->lmp, starters, full[0]->step.length()).run();
  for (size_t n = 0; n < full.size(); ++n)
    if (needed[n] || (together && found)) full[n]->begin();
}

/// Returns null if the histories can continue.  Collective.
const char *Motion::reason_to_start_anew(double **f)
{
  const double now = std::fabs(step.length()), last = std::fabs(step.time_step.made());
  if (now < SHORTER * last && can_start_anew())
    return "the time step is less than half of the previous one";
  if (now > LONGER * last && last != 0.0 && can_start_anew())
    return "the time step is more than twice the previous one";
  if (!movers.empty() && movers != present_movers() && can_start_anew())
    return "other fixes move atoms than in the last steps";
  if (const char *other = another_scheme_suits()) return other;
  const char *changed = step.coupling ? step.coupling->reason_to_start_anew() : nullptr;
  if (changed && (step.tolerance || (bootstraps() && forces_can_be_followed()))) return changed;
  return forces_changed(f) ? "forces have changed since the last step" : nullptr;
}

/// The other fixes that move atoms: the derivatives of forces depend on that motion.
std::string Motion::present_movers() const
{
  std::string ids = "of this run:";
  for (const auto *other : modify->get_fix_list())
    if (other != fix && other->time_integrate) ids += std::string(" ") + other->id;
  return ids;
}

/// True if a new start would be of full order, and would change only the histories.
bool Motion::can_start_anew() const
{
  return !step.tolerance && !(step.coupling && !step.coupling->may_start_anew()) && bootstraps() &&
      forces_can_be_followed();
}

/// True if a start of full order can follow the forces, for all fixes together.
bool Motion::forces_can_be_followed() const
{
  std::vector<const Fix *> owners;
  for (const auto &one : fleet.members)
    if (one.motion->bootstraps() || one.motion == this) owners.push_back(one.fix);
  return Forces(lmp, owners).reason().empty();
}

/// True if the residual of the present loads is too large for the histories.  The few values for
/// forces that jump, as of contacts, follow any change soon.
bool Motion::forces_changed(double **f)
{
  if (noise_of_forces(lmp, ownership).noise != Noise::NONE) return false;
  if (step.coupling) step.coupling->measure();
  const Integrator &integrator = *step.present_integrator();
  double here[2] = {0.0, 0.0};    // error of the last step, force on an atom
  for (const auto &one : fleet.members) here[0] = std::max(here[0], one.motion->last_error());
  for (const Site &site : sites) here[1] = std::max(here[1], force->ftm2v * length(f[site.atom]));
  const auto largest = over_ranks(MPI_MAX, here, world);

  double ratio = 0.0;
  for (const auto *list : {&bodies.points, &bodies.tops})
    for (const int ibody : *list) {
      double rows[MAX_SIZE];
      std::copy_n(bodies.history(ibody), step.scheme().size(), rows);
      const Body &body = bodies.body_at(ibody);
      const Correction found = list == &bodies.points
          ? integrator.correct_center(body.rigid, step.acting(ibody), rows)
          : integrator.correct(body.rigid, step.acting(ibody), rows);
      const double one = body.length(found) / (largest[0] + rounding(ibody, largest[1]));
      ratio = std::isfinite(one) ? std::max(ratio, one) : 2.0 * OTHER_NOISE;
    }
  ratio = over_ranks(MPI_MAX, ratio, world);
  return ratio > OTHER_NOISE || (ratio > OTHER_FORCES && forces_can_be_followed());
}

/// The part of a residual due to rounding, as a length.  force: the largest one on an atom.
double Motion::rounding(int ibody, double force) const
{
  const Body &body = bodies.body_at(ibody);
  const BodyState &s = bodies.state_of(ibody);
  const double size = std::fabs(step.length());
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

/// True if histories have to start; rank 0 prints the reason if they start again.  Velocity Verlet
/// continues with the present forces, as fixes of LAMMPS do, so that the total momentum is kept.
bool Motion::has_to_start(double **f)
{
  const char *reason = step.started ? reason_to_start_anew(f) : nullptr;
  if (reason && comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat {}: {}; histories are rebuilt\n", fix->id, reason);
  const bool needs = !step.started || reason;
  movers = present_movers();
  if (needs) step.check_loads(f);
  for (int ibody = 0; ibody < bodies.nmoved() && !needs && step.scheme().is_verlet(); ++ibody) {
    project_norm(bodies.change_state(ibody).q);
    seed_body(bodies, ibody, scaled_of(bodies, step.coupling.get(), ibody), step.acting(ibody),
              step.scheme(), step.length(), 3);
  }
  return needs;
}

Starter Motion::starter(bool needed)
{
  if (needed && step.coupling) step.coupling->refer_to_box(step.length());
  std::function<Scheme(const MotionSums &)> choose, foresee;
  if (args.automatic_values) {
    choose = [this](const MotionSums &here) {
      return choose_scheme(here);
    };
    foresee = [this](const MotionSums &here) {
      return foresee_scheme(here);
    };
  }
  return {fix,           &bodies, &ownership, &sites, step.coupling.get(),
          step.scheme(), needed,  choose,     foresee};
}

/// Histories have started.
void Motion::begin()
{
  step.started = true;
  // after the checks of the start, since an error of a coupling may have the same cause
  if (chosen) warn_of_vibrations(*chosen, step.scheme(), true);
  chosen.reset();
  if (step.tolerance) step.make_integrator();
}

/* ----------------------------------------------------------------------
   outputs
------------------------------------------------------------------------- */

double Motion::element(int n) const
{
  const int behind = n - of_tolerance();
  return behind < 0 ? step.tolerance->element(n) : step.coupling->element(behind);
}

int Motion::extensive(int n) const
{
  const int behind = n - of_tolerance();
  return step.coupling && step.coupling->extensive(behind);
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

Motion::Settings Motion::settings() const
{
  const Scheme &scheme = step.tolerance ? args.scheme : step.scheme();
  const ThermostatWords &temp = args.thermostat;
  const PressureWords &box = args.pressure;
  int components = 0;    // and which are coupled
  for (int k = 0; k < PressureWords::COMPONENTS; ++k) components |= (int) box.on[k] << k;
  for (int k = 0; k < 3 && box.any(); ++k)
    components |= box.tied[k] << (PressureWords::COMPONENTS + 2 * k);
  Settings found = {};
  found.formulation = (double) scheme.formulation;
  found.values = scheme.values();
  found.compensate = scheme.compensate;
  found.tolerance = scheme.remembers;
  found.tuned = scheme.tuned;
  found.isokinetic = (int) args.isokinetic;
  found.chains = temp.damp > 0.0 ? 1 + temp.separate : 0;
  found.chain_length = temp.length;
  found.box = components;
  found.box_chain = box.length;
  found.states_corrector = args.states("corrector");
  found.started = step.started;
  return found;
}

/// The keywords with another value in the file, without which histories cannot continue.
std::vector<std::string> Motion::other_settings(const Settings &mine) const
{
  std::vector<std::string> others;
  const auto compare = [&](const char *keyword, double Settings::*member) {
    if (of_file.*member != mine.*member) others.emplace_back(keyword);
  };
  compare("formulation", &Settings::formulation);
  // a default depends on the formulation
  if (args.states("values") || others.empty()) compare("values", &Settings::values);
  compare("compensate", &Settings::compensate);
  compare("tolerance", &Settings::tolerance);
  compare("isokinetic", &Settings::isokinetic);
  const bool both = of_file.chains != 0.0 && mine.chains != 0.0;
  compare(both ? "thermostat" : "temp", &Settings::chains);
  if (both) compare("tchain", &Settings::chain_length);
  compare("iso, aniso, tri, x, y, z, xy, xz, yz or couple", &Settings::box);
  if (of_file.box != 0.0 && mine.box != 0.0) compare("pchain", &Settings::box_chain);
  return others;
}

void Motion::fields(Fields &v)
{
  v(step.time_step, edge_rate, movers, sites);
  if (step.tolerance) step.tolerance->fields(v);
  if (step.coupling) step.coupling->fields(v);
}

void Motion::write(Fields &file)
{
  Settings mine = settings();
  file(mine);
  fields(file);
}

bool Motion::read(Fields &file)
{
  const Settings mine = settings();
  const auto others = other_settings(mine);
  if (others.empty()) {
    step.started = of_file.started;
    fields(file);
    if (!file.is_complete()) return false;
    // the number of values belongs to a corrector that this command does not state
    if (of_file.states_corrector && !mine.states_corrector) edge_rate = 0.0;
    if (step.length() != 0.0) step.make_integrator();
  }
  if (comm->me != 0) return true;
  if (step.started)
    utils::logmesg(lmp, "Fix gear/quat {}: histories of the restart file go on with {}\n", fix->id,
                   words_of_scheme());
  if (step.started && of_file.tuned != mine.tuned)
    error->warning(
        FLERR,
        "Fix gear/quat: the restart file was written with corrector {}; its histories go "
        "on with corrector {}",
        of_file.tuned != 0.0 ? "tuned" : "gear", step.scheme().tuned ? "tuned" : "gear");
  if (of_file.started && !others.empty())
    error->warning(
        FLERR,
        "Fix gear/quat: the restart file was written with other settings of {}; poses and "
        "velocities are kept, the higher derivatives are rebuilt",
        utils::join_words(others, ", "));
  return true;
}

/* ----------------------------------------------------------------------
   the number of values, where the command does not state it
------------------------------------------------------------------------- */

/// Input to the choice.  here: of the bodies that this rank owns.  Collective.
ChoiceOfValues Motion::scene_of(const MotionSums &here) const
{
  MotionSums all = here;
  const auto sums = over_ranks(MPI_SUM, all.sums, world);
  std::copy(sums.begin(), sums.end(), all.sums);
  ChoiceOfValues scene;
  scene.edge = bodies.number() > 0 ? all.fast_edge(step.length()) : HUGE_VAL;
  scene.exact = all.knows_derivatives(step.length());
  scene.noise = noise_of_forces(lmp, ownership).noise;
  scene.may_be_gear = !args.states("corrector");
  scene.automatic = args.automatic_values;
  return scene;
}

/// Includes the friction of a coupling whose run has begun.
ChoiceOfValues Motion::scene_of_start(const MotionSums &here) const
{
  ChoiceOfValues scene = scene_of(here);
  if (step.coupling) scene.friction = step.coupling->friction_ahead(step.length());
  return scene;
}

Scheme Motion::foresee_scheme(const MotionSums &here) const
{
  return scene_of_start(here).choose(args.scheme).scheme;
}

/// Histories have this scheme after the call.
Scheme Motion::choose_scheme(const MotionSums &here)
{
  const ChoiceOfValues scene = scene_of_start(here);
  const ChoiceOfValues::Choice choice = scene.choose(args.scheme);
  edge_rate = scene.edge / std::fabs(step.length());
  tell_choice(scene, choice);
  chosen = scene;
  warned_values = false;
  step.set_scheme(choice.scheme);
  return choice.scheme;
}

/// Collective.
void Motion::tell_choice(const ChoiceOfValues &scene, const ChoiceOfValues::Choice &choice) const
{
  using Reason = ChoiceOfValues::Reason;
  const NoisyForces forces = noise_of_forces(lmp, ownership);    // on all ranks
  if (comm->me != 0) return;
  std::string why;
  if (choice.reason == Reason::NOISE)
    why = "because " + forces.words();
  else if (choice.reason == Reason::FRICTION)
    why = "because the thermostat has a strong friction";
  else if (choice.reason == Reason::FORMULATION)
    why = "as always with corrector gear";
  else if (std::isfinite(scene.edge))
    why = fmt::format("for vibrations of {:.2g} radians in a step", scene.edge);
  else
    why = bodies.number() > 0 ? "because the motion is not known before it begins"
                              : "because there are no bodies yet";
  const bool other_corrector = choice.scheme.tuned != args.scheme.tuned;
  utils::logmesg(lmp, "Fix gear/quat {}: {} values{}, {}\n", fix->id, choice.scheme.values(),
                 choice.scheme.is_verlet() ? " (velocity Verlet)"
                     : other_corrector     ? " and corrector gear"
                                           : "",
                 why);
}

/// Warns once, and again if only a much shorter step is short enough.
void Motion::warn_of_vibrations(const ChoiceOfValues &scene, const Scheme &scheme, bool begins)
{
  const double advised = std::fabs(step.length()) * scene.advised_part(scheme);
  if (!scene.too_long(scheme) || advised * ChoiceOfValues::BAND > advised_step) return;
  advised_step = advised;
  if (comm->me != 0) return;
  const std::string who = scene.chooses_longest(scheme)
      ? "any number of values"
      : fmt::format("{} values of formulation {} and corrector {}", scheme.values(),
                    word_of(scheme.formulation), scheme.tuned ? "tuned" : "gear");
  const char *otherwise = "";
  if (begins)
    otherwise = ", or, if atoms overlap, begin with a run with keywords tolerance and temp";
  else if (!scene.chooses_longest(scheme) && !scheme.first())
    otherwise = ", or leave out keywords values and corrector";
  error->warning(FLERR,
                 "Fix gear/quat {}: {}vibrations of {:.2g} radians in a step are "
                 "more than {} can follow for long; use a time step of {:g} or shorter{}",
                 fix->id, begins ? "" : fmt::format("at step {} ", update->ntimestep), scene.edge,
                 who, rounded_down(advised), otherwise);
}

void Motion::look_at_vibrations()
{
  if (step.tolerance) return;
  // short runs with a stated number are not examined, so that effects that are off are free
  if (!args.automatic_values && update->laststep - update->firststep < Vibrations::FIRST_WINDOW)
    return;
  if (!vibrations.note_step(step.length())) return;
  ChoiceOfValues scene = scene_of(vibrations.sums());
  scene.edge = MotionSums::true_edge(scene.edge);
  if (scene.exact && scene.too_long(step.scheme())) {
    warn_of_vibrations(scene, step.scheme(), false);
    return;
  }
  if (scene.exact && args.automatic_values) warn_of_values(scene);
}

/// Warns once for these histories, which keep their number of values.
void Motion::warn_of_values(const ChoiceOfValues &scene)
{
  const int present = step.scheme().values();
  const ChoiceOfValues::Choice suits = scene.choose(args.scheme, present);
  if (warned_values || suits.reason != ChoiceOfValues::Reason::MOTION ||
      suits.scheme.values() >= present)
    return;
  warned_values = true;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat {}: at step {} vibrations of {:.2g} "
                   "radians in a step require {} values, but histories began with {} for a slower "
                   "motion; use keyword values {}, or define the fix again before the next run",
                   fix->id, update->ntimestep, scene.edge, suits.scheme.values(), present,
                   suits.scheme.values());
}

/// Returns the reason to start histories again with another number of values, null for none.
/// Reasons are a change of the step or of forces.  Vibrations are from the last
/// start.  Collective.
const char *Motion::another_scheme_suits()
{
  if (!args.automatic_values || edge_rate == 0.0) return nullptr;
  ChoiceOfValues scene = scene_of(MotionSums());
  scene.edge = edge_rate * std::fabs(step.length());
  using Reason = ChoiceOfValues::Reason;
  const Scheme &present = step.scheme();
  const ChoiceOfValues::Choice choice = scene.choose(args.scheme, present.values());
  if (choice.scheme.values() == present.values() && choice.scheme.tuned == present.tuned)
    return nullptr;
  if (choice.reason != Reason::MOTION && choice.reason != Reason::FORMULATION)
    return "forces suit another number of values";
  return can_start_anew() ? "the motion suits another number of values" : nullptr;
}

/* ----------------------------------------------------------------------
   the method of a restart file
------------------------------------------------------------------------- */

void Motion::adopt_scheme(Fields &file)
{
  file(of_file);
  Scheme scheme = args.scheme;
  if (step.tolerance || of_file.tolerance != 0.0 || !of_file.started ||
      of_file.formulation != (double) scheme.formulation)
    return;
  if (args.automatic_values) scheme.rows = (int) of_file.values;
  if (scheme.values() != of_file.values) return;
  if (!args.states("corrector")) scheme.tuned = of_file.tuned != 0.0;
  step.set_scheme(scheme);
}

std::string Motion::words_of_scheme() const
{
  const Scheme &s = step.scheme();
  return fmt::format("values {}, corrector {}", s.values(), s.tuned ? "tuned" : "gear");
}
