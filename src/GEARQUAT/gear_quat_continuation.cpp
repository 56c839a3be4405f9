/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_step.h"

#include "gear_quat_ranks.h"

#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
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

/* ----------------------------------------------------------------------
   which histories continue
------------------------------------------------------------------------- */

void Step::start(double **f, double **torque)
{
  if (phase != Phase::SET_UP) return;
  for (Step *one : fleet.members) one->sites.gather_loads(f, torque);
  // histories that could continue start with the others: one polynomial has the forces of all
  std::vector<Step *> together;
  int starts = 0;
  for (Step *one : fleet.members) {
    one->phase = Phase::READY;
    const bool needs = one->has_to_start(f);
    if (needs && one->tolerance) {
      one->started = false;
      one->tolerance->begin(one->bath.longest_step());
    }
    for (int ibody = 0; ibody < one->bodies.nmoved() && needs; ++ibody) one->watch_load(ibody, f);
    if (one->bootstraps()) {
      together.push_back(one);
      starts += needs;
    } else if (needs) {
      one->bath.refer_to_box(one->length());
      one->seed_local(one->tolerance ? 3 : 2);
      one->note_start();
    }
  }
  if (starts > 0) start_together(lmp, together, length());
}

/// Returns null if the histories can continue.  Collective.
const char *Step::reason_to_start_anew(double **f)
{
  const double now = std::fabs(length()), last = std::fabs(time_step.begun());
  const bool other_length = now < SHORTER * last || (now > LONGER * last && last != 0.0);
  if (other_length && can_start_anew())
    return "the time step has changed by more than a factor of two";
  if (bath.acts() && length() * time_step.begun() < 0.0 && can_start_anew())
    return "the time step has changed its sign";
  if (const char *other = another_scheme_suits()) return other;
  const char *changed = bath.reason_to_start_anew();
  if (changed && (tolerance || (bootstraps() && forces_can_be_followed()))) return changed;
  return forces_changed(f) ? "forces have changed since the last step" : nullptr;
}

/// True if a new start would be of full order, and would change only the histories.
bool Step::can_start_anew() const
{
  return !tolerance && bath.may_start_anew() && bootstraps() && forces_can_be_followed();
}

/// True if a start of full order can follow the forces, for all fixes together.
bool Step::forces_can_be_followed() const
{
  std::vector<const Fix *> owners;
  for (const Step *one : fleet.members)
    if (one->bootstraps() || one == this) owners.push_back(one->fix);
  return Forces(lmp, owners).reason().empty();
}

/// True if the residual of the present loads is too large for the histories.  The few values for
/// forces that jump, as of contacts, follow any change soon.
bool Step::forces_changed(double **f)
{
  if (noise_of_forces(lmp, ownership).noise != Noise::NONE) return false;
  bath.measure();
  double here[2] = {0.0, 0.0};    // error of the last step, force on an atom
  for (const Step *one : fleet.members)
    for (int ibody = 0; ibody < one->bodies.nowned(); ++ibody)
      here[0] = std::max(here[0], one->bodies.body[ibody].length(one->bodies.last[ibody]));
  for (const Site &site : sites)
    here[1] = std::max(here[1], force->ftm2v * GearQuat::length(f[site.atom]));
  const auto largest = over_ranks(MPI_MAX, here, world);

  double ratio = 0.0;
  bodies.for_moved([&](int ibody) {
    double rows[MAX_SIZE];
    std::copy_n(bodies.history(ibody), scheme().size(), rows);
    const Body &body = bodies.body[ibody];
    const Correction found = body.rigid.rotational_freedoms() == 0
        ? integrator->correct_center(body.rigid, bath.acting(ibody), rows)
        : integrator->correct(body.rigid, bath.acting(ibody), rows);
    const double one = body.length(found) / (largest[0] + rounding(ibody, largest[1]));
    ratio = std::isfinite(one) ? std::max(ratio, one) : 2.0 * OTHER_NOISE;
  });
  ratio = over_ranks(MPI_MAX, ratio, world);
  return ratio > OTHER_NOISE || (ratio > OTHER_FORCES && forces_can_be_followed());
}

/// The part of a residual due to rounding, as a length.  force: the largest one on an atom.
double Step::rounding(int ibody, double force) const
{
  const Body &body = bodies.body[ibody];
  const BodyState &s = bodies.state[ibody];
  const double size = std::fabs(length());
  double response = 1.0 / body.rigid.mass;
  for (const double moment : body.rigid.inertia)
    if (moment > 0.0) response = std::max(response, body.reach() * body.reach() / moment);
  const double noise = ROUNDING_OF_FORCES * std::sqrt((double) body.natoms) * force;
  const double way = size * GearQuat::length(s.velocity) +
      body.reach() * (1.0 + size * GearQuat::length(s.omega_body));
  return size * size * response * noise + ROUNDING_OF_MOTION * way;
}

/// True if histories have to start; rank 0 prints the reason if they start again.  Velocity Verlet
/// continues with the present forces, as fixes of LAMMPS do, so that the total momentum is kept.
bool Step::has_to_start(double **f)
{
  const char *reason = started ? reason_to_start_anew(f) : nullptr;
  if (reason && comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat {}: {}; histories are rebuilt\n", fix->id, reason);
  const bool needs = !started || reason;
  for (int ibody = 0; ibody < bodies.nmoved() && !needs && scheme().is_verlet(); ++ibody) {
    project_norm(bodies.state[ibody].q);
    seed(ibody, 3);
  }
  return needs;
}

void Step::seed(int ibody, int terms)
{
  const RigidBody &rigid = bodies.body[ibody].rigid;
  auto series = local_series(rigid, bath.scaled(bodies.state[ibody]), bath.acting(ibody), length());
  series.terms = terms;
  GearQuat::seed(scheme(), rigid, series, length(), length(), bodies.history(ibody));
}

void Step::seed_local(int terms)
{
  choose_scheme(HUGE_VAL);
  bath.measure();
  bath.seed_local(length(), terms);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) seed(ibody, terms);
}

/// Histories have started.
void Step::note_start()
{
  started = true;
  note_rates(edge_of_start);
  warn_of_rates();
  if (tolerance) make_integrator();
}

double Step::element(int n)
{
  return n < of_tolerance() ? tolerance->element(n) : bath.element(n - of_tolerance());
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

Step::Settings Step::settings() const
{
  const Scheme &scheme = tolerance ? args.scheme : this->scheme();
  const ThermostatWords &temp = args.thermostat;
  const PressureWords &box = args.pressure;
  int components = 0;    // and which are coupled
  for (int k = 0; k < PressureWords::COMPONENTS; ++k) components |= (int) box.on[k] << k;
  for (int k = 0; k < 3 && box.any(); ++k)
    components |= box.tied[k] << (PressureWords::COMPONENTS + 2 * k);
  const bool any_temp = temp.damp > 0.0;
  return {(double) scheme.formulation,
          (double) scheme.values(),
          (double) scheme.tuned(),
          (double) scheme.compensate,
          (double) scheme.remembers(),
          (double) args.isokinetic,
          (double) any_temp,
          (double) components,
          any_temp ? (double) temp.length : 0.0,
          !any_temp              ? 0.0
              : temp.is_random() ? 3.0
                                 : 1.0 + temp.separate,
          box.any() ? 1.0 + box.length : 0.0,
          (double) args.states("corrector"),
          (double) started};
}

/// The keywords with another value in the file, without which histories cannot continue.
std::vector<std::string> Step::other_settings(const Settings &mine) const
{
  static constexpr char BOX[] = "iso, aniso, tri, x, y, z, xy, xz, yz or couple";
  constexpr const char *KEYWORDS[STATES_CORRECTOR] = {
      "formulation", "values", "corrector", "compensate", "tolerance", "isokinetic",
      "temp",        BOX,      "tchain",    "thermostat", "pchain"};
  if (of_file[FORMULATION] != mine[FORMULATION]) return {KEYWORDS[FORMULATION]};
  std::vector<std::string> others;
  for (int n = VALUES; n < STATES_CORRECTOR; ++n)
    if (of_file[n] != mine[n] && (n < TCHAIN || (of_file[n] != 0.0 && mine[n] != 0.0)))
      others.emplace_back(KEYWORDS[n]);
  return others;
}

void Step::fields(Fields &v)
{
  v(time_step, edge_rate, sites);
  if (tolerance) tolerance->fields(v);
  bath.fields(v);
}

void Step::write(Fields &file)
{
  Settings mine = settings();
  file(mine);
  fields(file);
}

void Step::adopt_scheme(Fields &file)
{
  file(of_file);
  Scheme scheme = args.scheme;
  if (tolerance || of_file[TOLERANCE] != 0.0 || of_file[STARTED] == 0.0 ||
      of_file[FORMULATION] != (double) scheme.formulation)
    return;
  if (args.automatic_values) scheme.rows = (int) of_file[VALUES];
  if (scheme.values() != of_file[VALUES]) return;
  if (!args.states("corrector"))
    scheme.method = of_file[TUNED] != 0.0 ? Method::TUNED : Method::GEAR;
  set_scheme(scheme);
}

bool Step::read(Fields &file)
{
  const auto others = other_settings(settings());
  if (others.empty()) {
    started = of_file[STARTED] != 0.0;
    fields(file);
    if (!file.is_complete()) return false;
    // the number of values belongs to a corrector that this command does not state
    if (of_file[STATES_CORRECTOR] != 0.0 && !args.states("corrector")) edge_rate = 0.0;
    if (length() != 0.0) make_integrator();
  }
  if (started && comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat {}: histories of the restart file go on{}\n", fix->id,
                   tolerance ? ""
                             : fmt::format(" with values {}, corrector {}", scheme().values(),
                                           scheme().tuned() ? "tuned" : "gear"));
  if (of_file[STARTED] != 0.0 && !others.empty() && comm->me == 0)
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

/// Radians of vibrations in a step, of the bodies on all ranks; infinite if unknown.  here: of the
/// bodies that this rank owns.  Collective.
double Step::fast_edge(MotionSums here) const
{
  const auto sums = over_ranks(MPI_SUM, here.sums, world);
  std::copy(sums.begin(), sums.end(), here.sums);
  return bodies.number() > 0 ? here.fast_edge(length()) : HUGE_VAL;
}

/// For vibrations of these radians in a step.  Collective.
Choice Step::choose(double edge, int present) const
{
  const Noise noise = noise_of_forces(lmp, ownership).noise;
  return Choice(args.scheme, edge, noise, args.states("corrector"), present);
}

/// Histories have the chosen scheme after the call.  Collective.
void Step::choose_scheme(double edge)
{
  edge_of_start = edge;
  if (!args.automatic_values) return;
  edge_rate = edge / std::fabs(length());
  const Choice choice = choose(edge);
  std::string why = "because the motion is not known before it begins";
  if (choice.reason == Choice::NOISE)
    why = "because " + noise_of_forces(lmp, ownership).words();    // collective
  else if (choice.reason == Choice::FORMULATION)
    why = "as always with corrector gear";
  else if (std::isfinite(edge))
    why = fmt::format("for vibrations of {:.2g} radians in a step", edge);
  const char *how = choice.scheme.is_verlet()        ? " (velocity Verlet)"
      : choice.scheme.tuned() != args.scheme.tuned() ? " and corrector gear"
                                                     : "";
  if (comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat {}: {} values{}, {}\n", fix->id, choice.scheme.values(), how,
                   why);
  set_scheme(choice.scheme);
}

/// Returns the reason to start histories again with another number of values, null for none.
/// Reasons are a change of the step or of forces.  Vibrations are from the last start.  Collective.
const char *Step::another_scheme_suits() const
{
  if (!args.automatic_values || edge_rate == 0.0) return nullptr;
  const Scheme &present = scheme();
  const Choice choice = choose(edge_rate * std::fabs(length()), present.values());
  if (choice.scheme.values() == present.values() && choice.scheme.tuned() == present.tuned())
    return nullptr;
  if (choice.reason == Choice::NOISE) return "forces suit another number of values";
  return can_start_anew() ? "the motion suits another number of values" : nullptr;
}
