/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_step.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "universe.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

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

Step::Step(const Scene &scene, const Fleet &fleet, Tally tally) :
    Scene(scene), time_step(lmp), bath(scene), fleet(fleet), present(args.scheme),
    tally(std::move(tally))
{
  if (args.control.eps > 0.0) tolerance = std::make_unique<Tolerance>(scene, time_step);
}

const Step *Fleet::find(const Fix *fix) const
{
  for (const Step *one : members)
    if (one->fix == fix) return one;
  return nullptr;
}

bool Fleet::moves(const Fix *fix, const Atom *atom, int i) const
{
  const Step *one = find(fix);
  return one ? one->ownership.in_body(i) : (atom->mask[i] & fix->groupbit) != 0;
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void Step::meet_bodies()
{
  if (!args.masks.empty()) masks = args.masks_of(ownership.all_ids());
}

void Step::init()
{
  refuse_fixes();
  if (!had_run()) warn_of_noise();
  if (tolerance && utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR,
               "Fix gear/quat tolerance cannot be used with run_style respa, whose levels "
               "have different steps");
  for (const auto *other : modify->get_fix_list())
    if (tolerance && other != fix && (fleet.find(other) || known(Fact::TIME_STEP, other)))
      error->all(FLERR,
                 "Fix gear/quat tolerance cannot be used with fix {} ({}), which changes the time "
                 "step, too, or has histories of constant steps",
                 other->id, other->style);
  if (tolerance && started) tolerance->keep_step();
  follow_length();
}

void Step::forget(const std::string &why)
{
  if (started && comm->me == 0) utils::logmesg(lmp, why + "\n");
  started = false;
}

void Step::impose_masks()
{
  if (!ownership.change_masks(masks) || !started)
    return;    // only the scheme of a restart file may differ
  started = false;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: keywords force and torque turn off other components than in "
                   "the run that wrote the restart file; poses and velocities are kept, the "
                   "higher derivatives start anew");
}

void Step::begin_run()
{
  const double h = length();
  bath.begin_run(!started, tolerance ? std::min(h, bath.longest_step()) : h);
  if (update->nsteps > 0) note_rates(edge_rate * std::fabs(h));
  if (update->nsteps > 0 && !started) {    // before anything has changed
    find_limits(h);
    watch_all(atom->f);
  }
  phase = Phase::SET_UP;
}

/// After a run of no step, the next run may begin without a setup.
void Step::end_run()
{
  constexpr int SHORT = 100;
  if (started && update->nsteps >= SHORT) {
    note_rates(edge_rate * std::fabs(length()));
    warn_of_rates();
  }
  if (phase == Phase::CORRECTED) {    // LAMMPS has ended the run before its last step
    for (int ibody = 0; ibody < bodies.nmoved() && !reads_states(); ++ibody) {
      BodyState &state = bodies.state[ibody];
      integrator->body_state(bodies.body[ibody].rigid, bodies.history(ibody), state,
                             bodies.frame[ibody]);
      if (bath.moves_box()) bath.to_space(state);
    }
    place_correction();
  }
  if (phase == Phase::ENDED) phase = Phase::BETWEEN;
}

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

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Step::begin(int vflag, double **f)
{
  vflag_of_step = vflag;
  if (tolerance) tolerance->begin_step();
  if (tolerance) bath.keep();
  bath.take_random_half(*integrator, 0);
  predict(f);
  place_prediction();
  phase = Phase::BEGUN;
}

void Step::end(double **f, double **torque)
{
  watch_places();
  const bool is_placed = has_to_place();
  for (;;) {
    sites.gather_loads(f, torque);
    // here, since the atoms are at the positions of the forces
    if (bath.others_ask_for_virial()) tally(vflag_of_step, f);
    correct(f, is_placed || reads_states());
    if (!tolerance || tolerance->accepts()) break;
    shorten();
    predict(f);
    place_prediction();
    tolerance->evaluate(vflag_of_step);
  }
  accept(f);
  phase = Phase::CORRECTED;
  if (is_placed) place_correction();
}

void Step::choose_next()
{
  const double next = tolerance->choose(bath.longest_step());
  make_integrator();
  time_step.change(next);
  adopt_length();
}

/* ----------------------------------------------------------------------
   its parts
------------------------------------------------------------------------- */

void Step::predict(double **f)
{
  if (tolerance) {
    tolerance->prepare();
    make_integrator();
  }
  const double h = integrator->step();
  time_step.begin();
  find_limits(h);
  const bool may_repeat = tolerance && std::fabs(h) > args.control.shortest;
  const auto check = [&](int ibody) {
    const BodyState &state = bodies.state[ibody];
    if (!may_repeat && !limits.keep(state)) stop(ibody, state, h, f);
  };
  constexpr int WIDTH = Scheme::SECOND_WIDTH;    // with velocities of half a step before
  std::array<double, 2 * WIDTH> half;
  const bool verlet = scheme().is_verlet();
  const auto seen = [&half, verlet](const double *rows) {
    if (!verlet) return rows;
    std::copy_n(rows, 2 * WIDTH, half.begin());
    for (int i = WIDTH; i < 2 * WIDTH; ++i) half[i] -= rows[i + WIDTH];
    return (const double *) half.data();
  };
  for (const int ibody : bodies.points) {
    double *rows = bodies.history(ibody);
    integrator->predict_center(rows);
    integrator->center_state(bodies.body[ibody].rigid, seen(rows), bodies.state[ibody]);
    check(ibody);
  }
  for (size_t first = 0; first < bodies.tops.size();) {
    const Block block = block_of(bodies.tops, first, LANES);
    integrator->predict(block);
    if (verlet)
      for (int k = 0; k < block.count; ++k)
        integrator->body_state(*block.bodies[k], seen(block.rows[k]), *block.states[k],
                               *block.frames[k]);
    else
      integrator->find_states(block);
    for (int k = 0; k < block.count; ++k) check(bodies.tops[first + k]);
    first += block.count;
  }
  bath.predict(*integrator);
}

/// A shrink-wrapped box sets no limits.
void Step::find_limits(double h)
{
  constexpr int SHRINKS = 2;    // LAMMPS' boundary codes from this code on are shrink-wrapped
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int *faces = domain->boundary[k];
    const bool follows = faces[0] >= SHRINKS || faces[1] >= SHRINKS;
    longest = std::max(longest, follows ? HUGE_VAL : domain->prd[k]);
  }
  limits = MotionLimits(h, longest);
  if (tolerance && args.control.shortest == 0.0)    // turns are exact, and errors small
    limits.rate2 = HUGE_VAL;
}

void Step::place_prediction()
{
  ownership.spread_moved();
  sites.place(velocities_read);
}

/// Up to `most` bodies of a list; one with masks is alone.
Block Step::block_of(const std::vector<int> &list, size_t first, size_t most)
{
  Block block;
  const size_t end = std::min(list.size(), first + most);
  for (size_t n = first; n < end; ++n) {
    const int ibody = list[n], k = block.count;
    const Body &body = bodies.body[ibody];
    if (body.off && k > 0) break;
    block.bodies[k] = &body.rigid;
    block.rows[k] = bodies.history(ibody);
    block.states[k] = &bodies.state[ibody];
    block.frames[k] = &bodies.frame[ibody];
    block.loads[k] = &bodies.load[ibody];
    block.last[k] = &bodies.last[ibody];
    ++block.count;
    if (body.off) break;
  }
  return block;
}

/// Replaces the loads of a block where they are not those of the bodies.
void Step::scale(Block &block, const int *ids, Scaled &scaled) const
{
  const bool in_box = bath.moves_box();
  for (int k = 0; k < block.count && (in_box || bodies.body[*ids].off); ++k) {
    scaled.loads[k] = bath.scaled(bodies.acting(ids[k]));
    block.loads[k] = &scaled.loads[k];
    std::copy_n(block.rows[k], 3, scaled.centers[k]);
  }
}

/// states: they will be read, and are determined.
void Step::correct(double **f, bool states)
{
  if (bath.acts()) {
    bath.begin_correction(integrator->step());
    if (bath.needs_sums()) {
      for (const auto *list : {&bodies.points, &bodies.tops}) sum(*list);
      bath.find_friction(*integrator);
    }
  }
  correct<true>(bodies.points, f, states);
  correct<false>(bodies.tops, f, states);
  if (bath.acts()) bath.end_correction(*integrator);
  if (bath.acts() && states) watch_all(f);    // otherwise their predictions were tested
  if (bath.moves_box() && tolerance)
    tolerance->include({bath.error_of_box(args.control.energy, length())});
}

void Step::sum(const std::vector<int> &list)
{
  for (size_t first = 0; first < list.size();) {
    Block block = block_of(list, first, LANES);
    const int *const ids = &list[first];
    Scaled scaled;
    scale(block, ids, scaled);
    bath.add(*integrator, block, ids);
    first += block.count;
  }
}

template <bool ARE_POINTS> void Step::correct(const std::vector<int> &list, double **f, bool states)
{
  using Last = RememberedLoads::Last;
  const bool coupled = bath.acts(), has_flow = coupled && bath.has_flow();
  const size_t most = has_flow ? 1 : LANES;    // a body in a flow has a friction of its own
  for (size_t first = 0; first < list.size();) {
    Block block = block_of(list, first, most);
    const int *const ids = &list[first];
    const Body &body = bodies.body[*ids];
    const bool is_special = body.off || has_flow, masked = body.off && !bath.moves_box();
    const BodyState before = masked ? *block.states[0] : BodyState();
    Scaled scaled;
    scale(block, ids, scaled);
    Friction own;
    if (is_special && coupled) own = bath.friction_of(*ids);
    const Friction &friction = is_special ? own : bath.friction();
    if (tolerance) tolerance->note_prediction(block);
    if (ARE_POINTS)
      integrator->correct_centers(block, friction);
    else
      integrator->correct(block, friction);
    if (tolerance)
      tolerance->note_correction(*integrator, block, ids,
                                 coupled ? Last::KEPT : Last::INTEGRATED_AGAIN);
    first += block.count;
    if (!states && !masked) continue;
    if (!ARE_POINTS) integrator->find_states(block);
    for (int k = 0; ARE_POINTS && k < block.count; ++k)
      integrator->center_state(*block.bodies[k], block.rows[k], *block.states[k]);
    if (masked) block.last[0]->work = work_between(bodies.load[*ids], before, *block.states[0]);
    bath.place(block, ids, scaled.centers);
    for (int k = 0; k < block.count && !coupled && !tolerance; ++k) watch(ids[k], f);
  }
}

/// False if no output, fix or command reads the atoms before the next prediction replaces their
/// positions.  At forces, fixes read the prediction.
bool Step::has_to_place() const
{
  constexpr int AT_FORCES = FixConst::PRE_FORCE | FixConst::PRE_REVERSE | FixConst::POST_FORCE |
      FixConst::END_OF_STEP | FixConst::MIN_PRE_EXCHANGE | FixConst::MIN_PRE_NEIGHBOR |
      FixConst::MIN_POST_NEIGHBOR | FixConst::MIN_PRE_FORCE | FixConst::MIN_PRE_REVERSE |
      FixConst::MIN_POST_FORCE | FixConst::MIN_ENERGY;
  if (update->ntimestep == update->laststep || reads_at_end(lmp, fix)) return true;
  if (lmp->universe->nworlds > 1 || !utils::strmatch(update->integrate_style, "^verlet"))
    return true;
  for (int i = 0; i < modify->nfix; ++i) {
    const Fix *other = modify->fix[i];
    if (((modify->fmask[i] & ~AT_FORCES) && !fleet.find(other)) ||
        utils::strmatch(other->style, "^event"))
      return true;
  }
  return false;
}

/// Atoms get the corrected states.
void Step::place_correction()
{
  ownership.spread_moved();
  sites.place(true);
  if (reads_at_end(lmp, fix)) comm->forward_comm();    // ghosts are where forces were evaluated
  phase = Phase::ENDED;
}

/// Restores the histories to the beginning of the step, for another try.
void Step::shorten()
{
  bodies.put_back_histories();
  bath.put_back();
  tolerance->shorten();
  make_integrator();
  adopt_length();
  bodies.keep_histories();
  bath.keep();
}

/// Histories of bodies inserted in this step start with the known derivatives.
void Step::accept(double **f)
{
  const double h = integrator->step();
  if (tolerance) watch_all(f);    // otherwise correct() has done this
  bath.note_step(h);
  const int known = args.start == Arguments::Start::ZERO ? 2 : 3;
  for (const int ibody : bodies.fresh) {
    watch_load(ibody, f);
    seed(ibody, known);
  }
  if (!bodies.fresh.empty()) bodies.take_in_fresh();
  bath.follow_changes(h);
  bath.take_random_half(*integrator, 1);
}

/// Tests a corrected state.
inline void Step::watch(int ibody, double **f) const
{
  const BodyState &state = bodies.state[ibody];
  if (!limits.keep(state)) stop(ibody, state, integrator->step(), f);
}

void Step::watch_all(double **f) const
{
  bodies.for_moved([&](int ibody) {
    watch(ibody, f);
  });
}

/* ----------------------------------------------------------------------
   the length of the step
------------------------------------------------------------------------- */

void Step::make_integrator()
{
  integrator = std::make_unique<Integrator>(tolerance ? tolerance->integrator()
                                                      : Integrator(scheme(), length()));
}

void Step::set_scheme(const Scheme &scheme)
{
  present = scheme;
  bodies.set_scheme(scheme);
  bath.set_scheme(scheme);
  if (length() != 0.0) make_integrator();
}

void Step::follow_length()
{
  if (!tolerance || !started) adopt_length();    // otherwise LAMMPS' length will be restored
}

void Step::adopt_length()
{
  const double ratio = time_step.follow();
  if (ratio == 0.0) return;
  if (integrator)
    integrator->set_step(length());
  else
    make_integrator();
  if (!started) return;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    integrator->rescale(bodies.history(ibody), ratio);
  bath.rescale(ratio);
}
