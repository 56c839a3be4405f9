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
#include "force.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

Bath::Bath(LAMMPS *lmp, const Fix *fix, const Arguments &args, Bodies &bodies, const Sites &sites) :
    Pointers(lmp), temperature(lmp, fix, bodies, args.thermostat, args.pressure),
    box(lmp, fix, bodies, sites, args.pressure, temperature), bodies(bodies),
    words(args.thermostat),
    thermostats(words.damp > 0.0 && !words.is_random() ? 1 + words.separate : 0),
    chains(thermostats, Chain(words.length)), isokinetic(lmp, bodies, args.isokinetic, args.rescale)
{
  if (box.moves() && args.pressure.length > 0) chains.emplace_back(args.pressure.length);
  set_scheme(scheme_of_bath(args.scheme));
  made = setting();
}

void Bath::set_scheme(const Scheme &scheme)
{
  Scheme of_heat;
  of_heat.formulation = Formulation::FIRST;
  of_heat.rows = values_of_heat = isokinetic.acts()
      ? scheme.values()
      : std::min(scheme.values() - scheme.remembers(), FIRST_MOST);
  coefficients_of_heat = CorrectorCoefficients(of_heat).c;
  box.set_scheme(scheme);
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
  return chain < thermostats ? of_both(chain, temperature.twice) : box.twice_kinetic();
}

ChainTarget Bath::target_of(int chain, double steps_ahead, double h) const
{
  const bool of_box = chain >= thermostats;
  return temperature.target(of_box ? box.freedoms() : of_both(chain, temperature.freedoms),
                            of_box ? box.period() : words.damp, steps_ahead, h);
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
  if (chain >= thermostats) box.refuse_speed();
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
  if (isokinetic.acts()) isokinetic.begin_run(anew);
  if (isokinetic.acts() || !has_temperature()) return;
  box.refuse_scene();
  temperature.begin_run(anew);
  note_friction();
  if (words.damp > 0.0) {
    refuse_bodies();
    tell_freedoms();
  }
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
  box.begin_run(anew, h);
}

void Bath::refuse_bodies() const
{
  tagint partly = 0;    // space-frame components of a torque are no part of the rotational energy
  for (int ibody = 0; domain->dimension == 3 && ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body_at(ibody);
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
  if (!temperature.has_translation() && temperature.freedoms[ROTATION] == 0.0)
    error->all(FLERR,
               "Fix gear/quat {}: keywords force and torque turn off all degrees of freedom of "
               "the bodies, so they have no temperature",
               words.keyword());
  if (temperature.freedoms[TRANSLATION] < 0.0)
    error->all(FLERR,
               "Fix gear/quat {}: fix_modify extra/dof subtracts more degrees of freedom of "
               "translation than the bodies have",
               words.keyword());
}

void Bath::tell_freedoms()
{
  temperature.tell_once(
      told,
      fmt::format("thermostat of {:.0f} degrees of freedom of translation{} and {:.0f} of "
                  "rotation",
                  temperature.freedoms[TRANSLATION], temperature.description(),
                  temperature.freedoms[ROTATION]));
}

/// Targets, damping times and degrees of freedom.
std::vector<double> Bath::setting() const
{
  const auto &line = temperature.line;
  std::vector<double> found = {line.kt, line.kt_step, temperature.freedoms[TRANSLATION],
                               temperature.freedoms[ROTATION], words.damp};
  box.add_setting(found);
  return found;
}

const char *Bath::reason_to_start_anew() const
{
  if (isokinetic.acts() || !acts()) return nullptr;
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
  of_all = isokinetic.acts() ? isokinetic.multipliers()
                             : Multipliers{xi[TRANSLATION], xi[words.separate ? ROTATION : 0]};
  of_all.implicit = !isokinetic.acts();
  std::copy_n(temperature.common, 3, of_all.common);
}

Friction Bath::friction_of(int ibody) const
{
  Friction found = friction();
  if (temperature.has_flow()) std::copy_n(temperature.flow_at(ibody).data(), 3, found.common);
  if (bodies.body_at(ibody).off == 0) return found;
  for (int k = 0; k < 3; ++k)
    if (!temperature.has(ibody, TRANSLATION, k)) found.release(k);
  if (!temperature.has(ibody, ROTATION)) found.rotation = 0.0;
  return found;
}

void Bath::sum_present()
{
  if (isokinetic.acts())
    isokinetic.sum_present();
  else if (acts())
    temperature.sum_present();
}

void Bath::measure()
{
  sum_present();
  note_friction();
  box.measure(of_all);
}

Load Bath::acting(int ibody) const
{
  if (!acts()) return bodies.acting(ibody);
  return damped_load(bodies.rigid_of(ibody), box.scaled(bodies.state_of(ibody)),
                     scaled(bodies.acting(ibody)), friction_of(ibody));
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

template <class Act> void Bath::for_moved(Act act)
{
  for (const auto *list : {&bodies.points, &bodies.tops})
    for (const int ibody : *list) act(ibody);
}

void Bath::take_random_half(const Integrator &integrator, int half)
{
  if (!words.is_random()) return;
  temperature.aim(update->ntimestep);
  const RandomStep step(0.5 * integrator.step(), words.damp, temperature.line.kt);
  const auto place = [&](int ibody) {
    integrator.set_velocities(bodies.rigid_of(ibody), box.scaled(bodies.state_of(ibody)),
                              acting(ibody), bodies.history(ibody));
  };
  const bool at_once = !acts();    // otherwise accelerations depend on velocities of all
  for_moved([&](int ibody) {
    const Body &body = bodies.body_at(ibody);
    const bool turns = temperature.has(ibody, ROTATION);
    std::array<bool, 6> changes;
    for (int k = 0; k < 3; ++k) {
      changes[k] = temperature.has(ibody, TRANSLATION, k);
      changes[3 + k] = turns && body.rigid.turns_about(k, domain->dimension);
    }
    BodyState &state = bodies.change_state(ibody);
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
  box.seed_local(integrator.step(), 3, xi[OF_BOX]);
  for_moved(place);
}

void Bath::predict(const Integrator &integrator)
{
  if (!box.moves()) return;
  box.predict(integrator.step());
  box.choose_coefficients(coefficients_of_heat, values_of_heat);
}

void Bath::begin_correction(double h)
{
  begin_passes(h);
  if (!isokinetic.acts()) return;
  isokinetic.sum_present();
  note_friction();
}

void Bath::add(const Integrator &integrator, const Block &block, const int *ids)
{
  Velocities velocities = {};
  integrator.find_velocities(block, velocities);
  if (box.moves()) box.to_space(velocities.linear);
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
  box.measure(of_all);
  for (int round = 0; round < MOST_ROUNDS && change > ROUNDING_OF_FRICTION; ++round) {
    const Friction before = friction();
    const Upper left = (Upper::one() + before.damping.scaled(share)).inverse();
    if (box.moves()) {
      temperature.tensor = (box.matrix() * left * to_scaled).congruent(free_tensor);
      temperature.twice[TRANSLATION] = temperature.tensor.trace();
      const Upper dragged = (Upper::one() + before.drag.scaled(share)).inverse();
      (box.matrix() * dragged * to_scaled).times(free_common, temperature.common);
    } else {
      temperature.twice[TRANSLATION] = left[0] * left[0] * free[TRANSLATION];
    }
    const double turning = before.implicit_torque(share);
    temperature.twice[ROTATION] = turning * turning * free[ROTATION];
    for (int c = 0; c < (int) chains.size(); ++c) {
      const bool is_known = same_bodies || c >= thermostats;
      advance(c, is_known ? twice_of(c) : chains[c].foretold(h, values), h, values);
    }
    note_friction();
    box.pass(of_all, xi[OF_BOX], h);
    change = std::fabs(h * (friction().rotation - before.rotation));
    for (int k = 0; k < Upper::SIZE; ++k)
      change = std::max(change, std::fabs(h * (friction().damping[k] - before.damping[k])));
  }
}

void Bath::place(const Block &block, const int *ids, const double (*predicted)[3])
{
  for (int k = 0; k < block.count && box.moves(); ++k) {
    BodyState &state = *block.states[k];
    double &work = block.last[k]->work;
    for (int i = 0; i < 3; ++i)
      work -= block.loads[k]->force[i] * (state.center[i] - predicted[k][i]);
    work += box.work(bodies.load_of(ids[k]).force, predicted[k], state);
    box.to_space(state);
  }
}

void Bath::end_correction(const Integrator &integrator)
{
  if (isokinetic.acts()) {
    isokinetic.sum_present();
    conclude(integrator.step());
    for_moved([&](int ibody) {
      double *rows = bodies.history(ibody);
      isokinetic.scale(integrator, bodies.rigid_of(ibody), rows);
      integrator.body_state(bodies.rigid_of(ibody), rows, bodies.change_state(ibody),
                            bodies.change_frame(ibody));
    });
  }
  box.end_step();
}

void Bath::begin_passes(double h)
{
  if (isokinetic.acts()) return;
  same_bodies = temperature.is_counted();
  temperature.aim(update->ntimestep);
  temperature.begin();
  box.begin_passes(h);
  made = setting();
}

void Bath::conclude(double h)
{
  const double removed = isokinetic.acts() ? isokinetic.end_passes() : 0.0;
  for (auto &chain : chains) chain.conclude();
  box.end_passes();
  const double rate = isokinetic.acts() ? isokinetic.power() : box.rate_of_heat();
  heat.advance(coefficients_of_heat.data(), values_of_heat, h, rate);
  heat.add(removed);
}

/// The mass of the box changes with the degrees of freedom.
void Bath::follow_changes(double h)
{
  if (isokinetic.acts() || !has_temperature() || temperature.is_counted()) return;
  std::vector<ChainTarget> before;
  for (int c = 0; c < thermostats; ++c) before.push_back(target_of(c, 0.0, h));
  const double of_box = box.twice_kinetic();
  temperature.count();
  temperature.sum_present();
  made = setting();
  for (int c = 0; c < thermostats; ++c)
    chains[c].join(before[c], target_of(c, 0.0, h), twice_of(c));
  heat.add(0.5 * (of_box - box.twice_kinetic()));
}

void Bath::keep()
{
  kept = chains;
  kept_heat = heat;
  box.keep();
}

void Bath::put_back()
{
  chains = kept;
  heat = kept_heat;
  box.put_back();
}

void Bath::rescale(double ratio)
{
  heat.rescale(ratio, values_of_heat);
  box.rescale(ratio);
}

/* ----------------------------------------------------------------------
   limits of the step
------------------------------------------------------------------------- */

double Bath::longest_step() const
{
  const double longest = box.moves() ? box.period() / FEWEST_OF_BOX : HUGE_VAL;
  if (thermostats == 0) return longest;
  return std::min({longest, SAFE * STRONGEST / strongest_friction(), words.damp / FEWEST_STEPS});
}

/// The effect of the errors of the chains in this step on bodies in thermal motion: an error d of
/// the friction causes the error h d v of a velocity v.  A cold body is insensitive to the friction,
/// so its errors do not show whether the chains are accurate.
std::array<double, 2> Bath::errors(bool as_energy, double h, int values) const
{
  const int terms = std::min(values, SECOND_MOST);
  const double kt = temperature.line.kt;
  double most = 0.0;
  for (int c = 0; c < thermostats; ++c)
    most = std::max(most, chains[c].left_out(target_of(c, 0.0, h), h, terms));
  most *= (double) adams_moulton(terms);
  double lightest = HUGE_VAL;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    lightest = std::min(lightest, bodies.rigid_of(ibody).mass);
  return {as_energy ? std::fabs(h) * 3.0 * kt * most
                    : h * h * std::sqrt(3.0 * kt / lightest) * most,
          box.moves() ? box.error_of_step(as_energy, h) : 0.0};
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
  if (isokinetic.acts()) found.push_back(isokinetic.power());
  if (box.moves()) found.push_back(box.rate_of_heat());
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
  box.begin_start(nodes, xi[OF_BOX]);
  at_nodes.clear();
  for (const double rate : rates_of_unknowns())
    nodes.collocation.begin(0.0, rate, at_nodes.emplace_back());
}

void Bath::foretell(const StartNodes &nodes)
{
  for (auto &one : at_nodes) nodes.collocation.foretell(one);
  box.foretell(nodes);
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
  if (box.moves()) box.visit_node(nodes, node, of_all, xi[OF_BOX]);
  const auto now = rates_of_unknowns();
  for (size_t k = 0; k < now.size(); ++k) nodes.collocation.set_rate(node, now[k], at_nodes[k]);
}

void Bath::settle(const StartNodes &nodes, int pair)
{
  for (auto &one : at_nodes) nodes.collocation.settle(pair, one);
  box.settle(nodes, pair);
}

void Bath::seed(const StartNodes &nodes, int pairs, int values)
{
  for (size_t c = 0; c < chains.size(); ++c)
    chains[c].seed(nodes.collocation.rate_at_start(at_nodes[c]), pairs, nodes.spacing, values + 1);
  if (at_nodes.size() > chains.size()) {
    double series[Collocation::MAX_NODES + 1];
    const int terms =
        nodes.collocation.series(at_nodes[chains.size()], pairs, nodes.spacing, series);
    heat.seed(series, terms, nodes.spacing, nodes.h, values_of_heat);
  }
  if (box.moves()) box.seed(nodes, pairs);
}

void Bath::seed_local(double h, int terms)
{
  settle_fresh(h);
  for (size_t c = 0; c < chains.size(); ++c) {
    const double now = twice_of(c);
    chains[c].seed(&now, 0, 0.0, 1);
  }
  box.seed_local(h, terms, xi[OF_BOX]);
  const double series[2] = {0.0, h * (isokinetic.acts() ? isokinetic.power() : box.rate_of_heat())};
  heat.seed(series, 2, h, h, values_of_heat);
}

/* ----------------------------------------------------------------------
   outputs and restart
------------------------------------------------------------------------- */

int Bath::elements() const
{
  if (isokinetic.acts()) return ELEMENTS_OF_ISOKINETIC;
  return !has_temperature() ? 0 : ELEMENTS + (box.moves() ? (int) Barostat::ELEMENTS : 0);
}

bool Bath::extensive(int n) const
{
  return n == 0 || n == ELEMENTS + Barostat::E_BOX;    // HEAT or ENERGY
}

double Bath::energy() const
{
  double sum = 0.0, of_box = box.moves() ? box.energy(heat.value()) : 0.0;
  for (int c = 0; c < (int) chains.size(); ++c)
    (c < thermostats ? sum : of_box) += chains[c].energy(target_of(c, 0.0, 0.0));
  sum += over_ranks(MPI_SUM, randomly_taken, world);
  return sum * force->mvv2e + of_box * force->mvv2e;
}

double Bath::element(int n)
{
  if (isokinetic.acts()) {
    const Multipliers &alpha = isokinetic.multipliers();
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
    case ELEMENTS + Barostat::XI_BOX:
      return xi[OF_BOX];
    default:
      if (n - ELEMENTS < Barostat::P_TARGET) temperature.sum_present();
      return box.element(n - ELEMENTS);
  }
}

void Bath::fields(Fields &v)
{
  if (isokinetic.acts()) v(isokinetic, heat);
  if (words.is_random()) {
    double all = v.reads() ? 0.0 : over_ranks(MPI_SUM, randomly_taken, world);
    v(all);
    if (v.reads()) randomly_taken = comm->me == 0 ? all : 0.0;
  }
  if (isokinetic.acts() || !acts()) return;
  v(chains, made, temperature);
  if (box.moves()) v(box, heat);
  if (v.reads()) note_friction();
}
