/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_bath.h"

#include "gear_quat_friction.h"
#include "gear_quat_ranks.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

// damping times of fewer steps are warned of

static constexpr double FEWEST_STEPS = 10.0;

// steps in a damping time of the box, which may oscillate many times in it; with a changing step

static constexpr double FEWEST_OF_BOX = 100.0;

// the strongest friction that bodies follow, times the step, and the part of it that a changing step
// permits

static constexpr double STRONGEST = 0.5, SAFE = 0.8;

// targets that differ by less than this are equal up to rounding

static constexpr double ROUNDING = 1.0e-12;

// a change of the friction in a step that is rounding

static constexpr double ROUNDING_OF_FRICTION = 1.0e-15;

static constexpr auto TRANSLATION = Temperature::TRANSLATION, ROTATION = Temperature::ROTATION;

/* ---------------------------------------------------------------------- */

/// With remembered loads the box is that of a constant order.
static Scheme scheme_of_bath(Scheme scheme)
{
  if (!scheme.remembers()) return scheme;
  scheme.formulation = Formulation::SECOND;
  scheme.rows = SECOND_PAPER;
  scheme.passes = 2;
  return scheme;
}

Bath::Bath(const Scene &scene) :
    Scene(scene), temperature(scene), words(args.thermostat), asked(args.pressure),
    id(asked.any() ? std::string(fix->id) + "_virial" : ""),
    thermostats(words.damp > 0.0 && !words.is_random() ? 1 + words.separate : 0),
    chains(thermostats, Chain(words.length)), box(lmp, asked.fixed)
{
  if (moves_box())
    modify->add_compute(id + " all pressure NULL pair bond angle dihedral improper kspace");
  if (moves_box() && asked.length > 0) chains.emplace_back(asked.length);
  set_scheme(scheme_of_bath(args.scheme));
  made = setting();
}

Bath::~Bath()
{
  if (moves_box() && own()) modify->delete_compute(id);
}

void Bath::set_scheme(const Scheme &scheme)
{
  Scheme of_heat;
  of_heat.formulation = Formulation::FIRST;
  of_heat.rows = values_of_heat = is_isokinetic()
      ? scheme.values()
      : std::min(scheme.values() - scheme.remembers(), FIRST_MOST);
  coefficients_of_heat = CorrectorCoefficients(of_heat).c;
  if (!moves_box()) return;
  if (scheme.remembers() && !times) times.emplace(false);
  cell.set_scheme(scheme);
}

/* ----------------------------------------------------------------------
   chains: the last one is that of the box, if it has one
------------------------------------------------------------------------- */

double Bath::of_both(int chain, const double (&parts)[2]) const
{
  return words.separate ? parts[chain] : parts[TRANSLATION] + parts[ROTATION];
}

double Bath::twice_of(int chain) const
{
  return chain < thermostats ? of_both(chain, temperature.twice) : twice_of_box();
}

ChainTarget Bath::target_of(int chain, double steps_ahead, double h) const
{
  const bool of_box = chain >= thermostats;
  return temperature.target(of_box ? freedoms_of_box() : of_both(chain, temperature.freedoms),
                            of_box ? period_of_box() : words.damp, steps_ahead, h);
}

double Bath::strongest_friction() const
{
  double strongest = 0.0;
  for (int c = 0; c < thermostats; ++c)
    strongest = std::max(strongest, std::fabs(chains[c].friction()));
  return strongest;
}

/// A non-finite kinetic energy is due to an unstable body, which ends the run.
void Bath::advance(int chain, double twice_kinetic, double h, int values)
{
  if (!std::isfinite(twice_kinetic)) return;
  const ChainTarget target = target_of(chain, -1.0, h);
  if (chains[chain].advance(target, twice_kinetic, h, values)) return;
  if (chain >= thermostats)
    error->all(FLERR,
               "Fix gear/quat: in step {} the box moves so fast that its thermostat cannot follow; "
               "begin nearer to the target pressure, or use a longer Pdamp",
               update->ntimestep);
  const double degree = force->mvv2e / force->boltz;
  error->all(FLERR,
             "Fix gear/quat temp: in step {} the bodies have a temperature of {:.4g}, {:.3g} times "
             "the target, and the thermostat cannot follow it; begin nearer to the target, or use "
             "a longer damping time than {:g}",
             update->ntimestep, degree * twice_kinetic / target.freedoms,
             twice_kinetic / (target.freedoms * target.kt), words.damp);
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void Bath::begin_run(bool anew, double h)
{
  if (is_isokinetic()) conserve_energy(anew);
  if (is_isokinetic() || !has_temperature()) return;
  refuse_scene();
  temperature.begin_run(anew);
  note_friction();
  if (words.damp > 0.0) refuse_bodies();
  temperature.tell_freedoms(words.damp > 0.0 ? "thermostat" : "barostat");
  if (words.is_random()) {
    const double ratio = 0.5 * std::fabs(h) / words.damp, faster = ratio / std::tanh(ratio);
    if (words.damp < 2.0 * std::fabs(h) && comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat langevin: with a damping time of {:.3g} time steps averages "
                     "are right, but free bodies diffuse and drift {:.3g} times too fast; for "
                     "motion in time use a damping time of at least two time steps",
                     words.damp / std::fabs(h), faster);
  }
  if (thermostats > 0) {
    if (temperature.has_flow() && words.length > 1)
      error->all(FLERR,
                 "Fix gear/quat temp: in the flow of fix deform remap v a chain of {} variables "
                 "does not hold the temperature, because friction does work all the time; add "
                 "keyword tchain 1",
                 words.length);
    // tolerance limits a step to exactly this many
    if (words.damp < (1.0 - ROUNDING) * FEWEST_STEPS * std::fabs(h) && comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat temp: a damping time of {:.3g} is less than {:.0f} time steps, and "
          "the motion may become unstable",
          words.damp, FEWEST_STEPS);
  }
  if (!moves_box()) return;
  if (temperature.freedoms[TRANSLATION] < 1.0)
    error->all(FLERR,
               "Fix gear/quat: constant pressure requires more than one body that is free to move");
  if (update->nsteps > 0 || anew) find_target(update->ntimestep, h);
  if (anew) refer_to_box(h);
  correction = Upper();    // forces are evaluated in the corrected box
  request_virial();
}

void Bath::refuse_bodies() const
{
  tagint partly = 0;    // space-frame components of a torque are no part of the rotational energy
  for (int ibody = 0; domain->dimension == 3 && ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body[ibody];
    const Mask off = body.off & Temperature::NO_TORQUE;
    if (off && off != Temperature::NO_TORQUE && body.rigid.rotational_freedoms() > 0)
      partly = body.id;
  }
  partly = over_ranks(MPI_MAX, partly, world);
  if (partly)
    error->all(FLERR,
               "Fix gear/quat {}: keyword torque turns off some components for body {} and not "
               "all, so its rotation has no temperature; turn off all three, or define a second "
               "fix without this keyword for such bodies",
               words.keyword(), partly);
  if (bodies.number() == 0) return;
  if (temperature.freedoms[TRANSLATION] < 0.0 ||
      (!temperature.has_translation() && temperature.freedoms[ROTATION] == 0.0))
    error->all(
        FLERR,
        "Fix gear/quat {}: keywords force and torque or fix_modify extra/dof leave the bodies "
        "no degrees of freedom, so they have no temperature",
        words.keyword());
}

/// Targets, damping times and degrees of freedom.
std::vector<double> Bath::setting() const
{
  const auto &line = temperature.line;
  std::vector<double> found = {line.kt, line.kt_step, temperature.freedoms[TRANSLATION],
                               temperature.freedoms[ROTATION], words.damp};
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k])
      found.insert(found.end(), {present_target[k], target_rate[k], asked.period[k]});
  return found;
}

const char *Bath::reason_to_start_anew() const
{
  if (is_isokinetic() || !acts()) return nullptr;
  const auto now = setting();
  const auto same = [](double a, double b) {
    return std::fabs(a - b) <= ROUNDING * (std::fabs(a) + std::fabs(b));
  };
  return std::equal(now.begin(), now.end(), made.begin(), same)
      ? nullptr
      : "a target, a damping time or the degrees of freedom differ from those of the last steps";
}

/* ----------------------------------------------------------------------
   the friction
------------------------------------------------------------------------- */

void Bath::note_friction()
{
  for (int c = 0; c < (int) chains.size(); ++c) xi_of(c) = chains[c].friction();
  share_friction();
}

void Bath::share_friction()
{
  of_all = is_isokinetic() ? alpha
                           : Multipliers{xi[TRANSLATION], xi[words.separate ? ROTATION : 0]};
  of_all.implicit = !is_isokinetic();
  std::copy_n(temperature.common, 3, of_all.common);
}

Friction Bath::friction_of(int ibody) const
{
  Friction found = friction();
  if (temperature.has_flow()) std::copy_n(temperature.flow_at(ibody).data(), 3, found.common);
  if (bodies.body[ibody].off == 0) return found;
  for (int k = 0; k < 3; ++k)
    if (!temperature.has(ibody, TRANSLATION, k)) found.release(k);
  if (!temperature.has(ibody, ROTATION)) found.rotation = 0.0;
  return found;
}

void Bath::sum_present()
{
  if (is_isokinetic())
    find_multipliers();
  else if (acts())
    temperature.sum_present();
}

void Bath::measure()
{
  sum_present();
  note_friction();
  measure_box();
}

Load Bath::acting(int ibody) const
{
  if (!acts()) return bodies.acting(ibody);
  return damped_load(bodies.body[ibody].rigid, scaled(bodies.state[ibody]),
                     scaled(bodies.acting(ibody)), friction_of(ibody));
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Bath::take_random_half(const Integrator &integrator, int half)
{
  if (!words.is_random()) return;
  temperature.aim(update->ntimestep);
  const RandomStep step(0.5 * integrator.step(), words.damp, temperature.line.kt);
  const auto place = [&](int ibody) {
    integrator.set_velocities(bodies.body[ibody].rigid, scaled(bodies.state[ibody]), acting(ibody),
                              bodies.history(ibody));
  };
  const bool at_once = !acts();    // otherwise accelerations depend on velocities of all
  bodies.for_moved([&](int ibody) {
    const Body &body = bodies.body[ibody];
    const bool turns = temperature.has(ibody, ROTATION);
    std::array<bool, 6> changes;
    for (int k = 0; k < 3; ++k) {
      changes[k] = temperature.has(ibody, TRANSLATION, k);
      changes[3 + k] = turns && body.rigid.turns_about(k, domain->dimension);
    }
    BodyState &state = bodies.state[ibody];
    const auto normal = normal_numbers(words.seed, 2 * update->ntimestep + half, body.id);
    const auto flow = temperature.has_flow() ? temperature.flow_at(ibody) : std::array<double, 3>();
    for (int k = 0; k < 3; ++k) state.velocity[k] -= flow[k];
    const double gained = step.take(body.rigid, changes, normal, state);
    for (int k = 0; k < 3; ++k) state.velocity[k] += flow[k];
    if (ibody < bodies.nowned()) randomly_taken -= gained;
    bodies.update_frame(ibody);
    if (at_once) place(ibody);
  });
  if (at_once) return;
  measure();
  seed_box(integrator.step(), 3);
  bodies.for_moved(place);
}

/// With a changing step, scalars have the coefficients of velocities.
void Bath::predict(const Integrator &integrator)
{
  if (!moves_box()) return;
  if (times) {
    times->prepare(integrator.step());
    const CorrectorCoefficients &of_times = times->coefficients();
    cell.set_coefficients(of_times);
    for (int j = 0; j < values_of_heat; ++j)
      coefficients_of_heat[j] = 0.5 * (j + 1) * of_times.c[j + 1];
  }
  cell.predict();
  refuse_box(cell.matrix());
  show(cell.matrix(), cell.rate(integrator.step()));
}

void Bath::begin_correction(double h)
{
  if (is_isokinetic()) {
    find_multipliers();
    note_friction();
    return;
  }
  temperature.aim(update->ntimestep);
  temperature.begin();
  width = h;
  find_target(update->ntimestep, width);
  made = setting();
}

void Bath::add(const Integrator &integrator, const Block &block, const int *ids)
{
  Velocities velocities = {};
  integrator.find_velocities(block, velocities);
  const Lanes free[3] = {velocities.linear[0], velocities.linear[1], velocities.linear[2]};
  if (moves_box()) box.matrix().times(free, velocities.linear);
  temperature.add(block.count, ids, velocities);
}

/// The velocities that remain depend on the friction and the motion of the box, and these depend on
/// the velocities.
void Bath::find_friction(const Integrator &integrator)
{
  constexpr int MOST_ROUNDS = 8;
  temperature.sum();
  const int values = integrator.values();
  const double h = integrator.step(), share = integrator.share();
  const double free[2] = {temperature.twice[TRANSLATION], temperature.twice[ROTATION]};
  const Upper free_tensor = temperature.tensor, to_scaled = box.inverse_matrix();
  const double free_common[3] = {temperature.common[0], temperature.common[1],
                                 temperature.common[2]};
  double change = HUGE_VAL;
  measure_box();
  for (int round = 0; round < MOST_ROUNDS && change > ROUNDING_OF_FRICTION; ++round) {
    const Friction before = friction();
    const Upper left = (Upper::one() + before.damping.scaled(share)).inverse();
    if (moves_box()) {
      temperature.tensor = (box.matrix() * left * to_scaled).congruent(free_tensor);
      temperature.twice[TRANSLATION] = temperature.tensor.trace();
      const Upper dragged = (Upper::one() + before.drag.scaled(share)).inverse();
      (box.matrix() * dragged * to_scaled).times(free_common, temperature.common);
    } else {
      temperature.twice[TRANSLATION] = left[0] * left[0] * free[TRANSLATION];
    }
    const double turning = before.implicit_torque(share);
    temperature.twice[ROTATION] = turning * turning * free[ROTATION];
    for (int c = 0; c < (int) chains.size(); ++c) advance(c, twice_of(c), h, values);
    note_friction();
    if (moves_box()) cell.pass(drive(), xi[OF_BOX], h);
    measure_box();
    change = std::fabs(h * (friction().rotation - before.rotation));
    for (int k = 0; k < Upper::SIZE; ++k)
      change = std::max(change, std::fabs(h * (friction().damping[k] - before.damping[k])));
  }
  conclude(h);
}

void Bath::place(const Block &block, const int *ids, const double (*predicted)[3])
{
  for (int k = 0; k < block.count && moves_box(); ++k) {
    BodyState &state = *block.states[k];
    double scaled_way[3], way[3];
    for (int i = 0; i < 3; ++i) scaled_way[i] = state.center[i] - predicted[k][i];
    box.matrix().times(scaled_way, way);
    double &work = block.last[k]->work;
    for (int i = 0; i < 3; ++i) work -= block.loads[k]->force[i] * scaled_way[i];
    work += dot3(bodies.load[ids[k]].force, way);
    box.to_space(state);
  }
}

void Bath::end_correction(const Integrator &integrator)
{
  if (is_isokinetic()) scale(integrator);
  if (!moves_box()) return;
  show_box(false);
  request_virial();
}

void Bath::conclude(double h)
{
  for (auto &chain : chains) chain.conclude();
  if (moves_box()) {
    correction = cell.correction() * box.inverse_matrix();
    local_error = cell.local_error() * box.inverse_matrix();
    cell.finish();
    note_rates(width);
  }
  const double rate = is_isokinetic() ? sums.power() : rate_of_heat();
  heat.advance(coefficients_of_heat.data(), values_of_heat, h, rate);
}

/// The mass of the box changes with the degrees of freedom.
void Bath::follow_changes(double h)
{
  if (is_isokinetic() || !has_temperature() || temperature.is_counted()) return;
  std::vector<ChainTarget> before;
  for (int c = 0; c < thermostats; ++c) before.push_back(target_of(c, 0.0, h));
  const double of_box = twice_of_box();
  temperature.count();
  temperature.sum_present();
  made = setting();
  for (int c = 0; c < thermostats; ++c) chains[c].join(before[c], target_of(c, 0.0, h));
  heat.add(0.5 * (of_box - twice_of_box()));
}

void Bath::keep()
{
  kept = chains;
  kept_heat = heat;
  kept_cell = cell;
}

void Bath::put_back()
{
  chains = kept;
  heat = kept_heat;
  cell = kept_cell;
  if (moves_box()) box.set(cell.matrix());
}

void Bath::rescale(double ratio)
{
  heat.rescale(ratio, values_of_heat);
  cell.rescale(ratio);
  width *= ratio;
}

/* ----------------------------------------------------------------------
   keyword isokinetic
------------------------------------------------------------------------- */

/// From the present states and loads.
void Bath::find_multipliers()
{
  constexpr size_t N = sizeof(KineticSums) / sizeof(double);
  KineticSums here;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    here.add(bodies.body[ibody].rigid, bodies.load[ibody], bodies.state[ibody]);
  reduce(MPI_SUM, &here.force_power, &sums.force_power, N, world);
  alpha = multipliers(args.isokinetic, sums);
}

/// Without histories, the present kinetic energy becomes the conserved one.  Without kinetic energy
/// the multiplier is undefined: NOTHING is rounding, relative to the whole.
void Bath::conserve_energy(bool anew)
{
  constexpr double NOTHING = 1.0e-24;
  find_multipliers();
  int turns = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    if (bodies.body[ibody].rigid.rotational_freedoms() > 0) turns = 1;
  turns = over_ranks(MPI_MAX, turns, world);
  const double least = NOTHING * (sums.translation + sums.rotation);
  if (least <= 0.0 ||
      (args.isokinetic == Isokinetic::SEPARATE &&
       (sums.translation <= least || (turns && sums.rotation <= least))))
    error->all(FLERR,
               "Fix gear/quat isokinetic: a kinetic energy of the bodies is zero and would stay so "
               "(translation {:g}, rotation {:g}); give them velocities first",
               0.5 * sums.translation * force->mvv2e, 0.5 * sums.rotation * force->mvv2e);
  if (!anew && counted == bodies.number()) return;
  conserved = sums;
  counted = bodies.number();
}

/// With keyword rescale momenta are scaled to the conserved energy.
void Bath::scale(const Integrator &integrator)
{
  find_multipliers();
  if (counted != bodies.number()) {    // some were removed, with their energy
    conserved = sums;
    counted = bodies.number();
  }
  const Multipliers factor = scale_factors(args.isokinetic, conserved, sums);
  conclude(integrator.step());
  if (!args.rescale) return;
  heat.add(0.5 * (sums.translation + sums.rotation - conserved.translation - conserved.rotation));
  bodies.for_moved([&](int ibody) {
    double *rows = bodies.history(ibody);
    integrator.scale_momenta(bodies.body[ibody].rigid, factor, rows);
    integrator.body_state(bodies.body[ibody].rigid, rows, bodies.state[ibody], bodies.frame[ibody]);
  });
}

/* ----------------------------------------------------------------------
   limits of the step
------------------------------------------------------------------------- */

double Bath::longest_step() const
{
  const double longest = moves_box() ? period_of_box() / FEWEST_OF_BOX : HUGE_VAL;
  if (thermostats == 0) return longest;
  return std::min({longest, SAFE * STRONGEST / strongest_friction(), words.damp / FEWEST_STEPS});
}

std::vector<Rate> Bath::rates(double h) const
{
  std::vector<Rate> table;
  const double found = std::fabs(h) * strongest_friction();
  const double period = std::max(FEWEST_STEPS * std::fabs(h), 2.0 * words.damp * found / STRONGEST);
  if (thermostats > 0)
    table.push_back({"the friction of the thermostat is", found, STRONGEST,
                     fmt::format("use a damping time of {:.4g} or longer", period)});
  return table;
}

/* ----------------------------------------------------------------------
   the start
------------------------------------------------------------------------- */

/// 2K around the start, in units of the node spacing.
static ChainDrive drive_of(const StartNodes &nodes, const Collocation::Scalar &twice)
{
  double at[ChainDrive::MOST];
  const int points = 2 * twice.pairs + 1;
  for (int i = 0; i < points; ++i) at[i] = i - twice.pairs;
  return ChainDrive::through(points, at, nodes.collocation.rate_at_start(twice) - twice.pairs);
}

std::vector<double> Bath::rates_of_unknowns() const
{
  std::vector<double> found;
  for (size_t c = 0; c < chains.size(); ++c) found.push_back(twice_of(c));
  if (is_isokinetic()) found.push_back(sums.power());
  if (moves_box()) found.push_back(rate_of_heat());
  return found;
}

void Bath::settle_fresh(double h)
{
  for (size_t c = 0; c < chains.size(); ++c)
    chains[c].begin_settled(target_of(c, 0.0, h), twice_of(c), h);
  note_friction();
}

void Bath::begin_start(const StartNodes &nodes)
{
  settle_fresh(nodes.h);
  held.clear();
  for (size_t c = 0; c < chains.size(); ++c)
    held.push_back(chains[c].is_stiff(target_of(c, 0.0, nodes.h), twice_of(c), nodes.h,
                                      nodes.collocation.pairs()));
  if (moves_box()) {
    const double s = nodes.spacing;
    nodes.collocation.begin(box.matrix().m.data(), (box_rate * box.matrix()).scaled(s).m.data(),
                            acceleration_of_box().scaled(s * s).m.data(), cell_at_nodes);
  }
  at_nodes.clear();
  for (const double rate : rates_of_unknowns())
    nodes.collocation.begin(0.0, rate, at_nodes.emplace_back());
}

void Bath::foretell(const StartNodes &nodes)
{
  for (auto &one : at_nodes) nodes.collocation.foretell(one);
  if (moves_box()) nodes.collocation.foretell(cell_at_nodes);
}

void Bath::visit_node(const StartNodes &nodes, int node)
{
  sum_present();
  for (int c = 0; c < (int) chains.size(); ++c)
    if (!held[c])
      xi_of(c) =
          chains[c]
              .flow(target_of(c, 0.0, nodes.h), drive_of(nodes, at_nodes[c]), nodes.spacing, node)
              .y[0];
  share_friction();
  if (moves_box()) {
    const double s2 = nodes.spacing * nodes.spacing;
    nodes.collocation.set_rates(node, acceleration_of_box().scaled(s2).m.data(), cell_at_nodes);
    combine();
  }
  const auto now = rates_of_unknowns();
  for (size_t k = 0; k < now.size(); ++k) nodes.collocation.set_rate(node, now[k], at_nodes[k]);
}

void Bath::settle(const StartNodes &nodes, int pair)
{
  for (auto &one : at_nodes) nodes.collocation.settle(pair, one);
  if (moves_box()) nodes.collocation.settle(pair, cell_at_nodes);
}

void Bath::seed(const StartNodes &nodes, int pairs, int values)
{
  for (size_t c = 0; c < chains.size(); ++c)
    chains[c].seed(nodes.collocation.rate_at_start(at_nodes[c]), pairs, nodes.spacing, values);
  if (at_nodes.size() > chains.size()) {
    double series[Collocation::MAX_NODES + 1];
    const int terms =
        nodes.collocation.series(at_nodes[chains.size()], pairs, nodes.spacing, series);
    heat.seed(series, terms, nodes.spacing, nodes.h, values_of_heat);
  }
  if (!moves_box()) return;
  double series[Upper::SIZE * TaylorSeries::MAX_TERMS];
  nodes.collocation.expand(cell_at_nodes, pairs, series);
  cell.seed(series, Collocation::terms_of(pairs), nodes.spacing, nodes.h);
}

void Bath::seed_local(double h, int terms)
{
  settle_fresh(h);
  for (size_t c = 0; c < chains.size(); ++c) {
    const double now = twice_of(c);
    chains[c].seed(&now, 0, 0.0, 1);
  }
  seed_box(h, terms);
  const double series[2] = {0.0, h * (is_isokinetic() ? sums.power() : rate_of_heat())};
  heat.seed(series, 2, h, h, values_of_heat);
}

/* ----------------------------------------------------------------------
   outputs and restart
------------------------------------------------------------------------- */

int Bath::elements() const
{
  if (is_isokinetic()) return ELEMENTS_OF_ISOKINETIC;
  return !has_temperature() ? 0 : moves_box() ? ELEMENTS : PRESSURE;
}

bool Bath::extensive(int n) const
{
  return n == 0 || n == E_BOX;    // HEAT or ENERGY
}

double Bath::energy() const
{
  double sum = 0.0, of_box = 0.0;
  if (moves_box())
    of_box = mean_of(target()) * box.volume() + heat.value() + 0.5 * twice_of_box() -
        virial.contracted(correction);
  for (int c = 0; c < (int) chains.size(); ++c)
    (c < thermostats ? sum : of_box) += chains[c].energy(target_of(c, 0.0, 0.0));
  sum += over_ranks(MPI_SUM, randomly_taken, world);
  return sum * force->mvv2e + of_box * force->mvv2e;
}

double Bath::element(int n)
{
  if (is_isokinetic()) {
    return n == HEAT             ? heat.value() * force->mvv2e
        : n == ALPHA_TRANSLATION ? alpha.translation
                                 : alpha.rotation;
  }
  const double degree = force->mvv2e / force->boltz;
  const auto degrees = [&](int part) {
    temperature.sum_present();
    const double freedoms = temperature.freedoms[part];
    return freedoms > 0.0 ? degree * temperature.twice[part] / freedoms : 0.0;
  };
  switch (n) {
    case ENERGY:
      return energy();
    case T_TRANSLATION:
      return degrees(TRANSLATION);
    case T_ROTATION:
      return degrees(ROTATION);
    case TARGET:
      return degree * temperature.line.kt;
    case XI_TRANSLATION:
      return xi[TRANSLATION];
    case XI_ROTATION:
      return xi[words.separate ? ROTATION : TRANSLATION];
    default:
      return element_of_box(n);
  }
}

void Bath::fields(Fields &v)
{
  if (is_isokinetic()) v(counted, conserved, heat);
  if (words.is_random()) {
    double all = v.reads() ? 0.0 : over_ranks(MPI_SUM, randomly_taken, world);
    v(all);
    if (v.reads()) randomly_taken = comm->me == 0 ? all : 0.0;
  }
  if (is_isokinetic() || !acts()) return;
  v(chains, made, temperature);
  if (moves_box()) v(width, present_target, target_rate, correction, virial, box, cell, heat);
  if (times) v(*times);
  if (moves_box() && v.reads()) note_rates(width);
  if (v.reads()) note_friction();
}
