/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_thermostat.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

// a kinetic energy smaller than this part of the subtracted energy is due to rounding

static constexpr double ROUNDING_OF_ENERGY = 1.0e-13;

// a part of the kinetic energy that stays below this fraction of its target for this many damping
// times will not become warm: a separate chain increases it by several powers of ten in that time

static constexpr double COLD = 0.01, COLD_TIMES = 10.0;

// limit for an implicit friction, times the step: a weaker one is equally accurate if explicit

static constexpr double STRONG = 1.0e-3;

/* ---------------------------------------------------------------------- */

Thermostat::Thermostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const ThermostatWords &words,
                       const Scheme &scheme) :
    Coupling(lmp, bodies),
    fix(fix), words(words), chains(words.length == 0    ? 0
                                       : words.separate ? 2
                                                        : 1,
                                   Chain(words.length)),
    total(lmp, fix, bodies)
{
  set_scheme(scheme);
}

void Thermostat::set_scheme(const Scheme &scheme)
{
  single_pass = scheme.coupled_passes() == 1;
}

/* ----------------------------------------------------------------------
   target and degrees of freedom
------------------------------------------------------------------------- */

Thermostat::Line Thermostat::line_of_step(bigint step) const
{
  const double per_degree = force->boltz / force->mvv2e;
  const bigint steps = update->endstep - update->beginstep;
  Line found = {per_degree * words.start, 0.0};
  if (steps <= 0) return found;
  found.kt_step = per_degree * (words.stop - words.start) / steps;
  found.kt += found.kt_step * (step - update->beginstep);
  return found;
}

ChainTarget Thermostat::target_of(int chain, double steps_ahead, double h) const
{
  ChainTarget target;
  target.kt = line.kt + line.kt_step * steps_ahead;
  target.kt_rate = h == 0.0 ? 0.0 : line.kt_step / h;
  target.freedoms = freedoms_of(chain);
  target.period = words.damp;
  return target;
}

double Thermostat::freedoms_of(int chain) const
{
  return words.separate ? freedoms[chain] : freedoms[TRANSLATION] + freedoms[ROTATION];
}

double Thermostat::twice_of(int chain) const
{
  return words.separate ? twice[chain] : twice[TRANSLATION] + twice[ROTATION];
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

Friction Thermostat::friction_of(int ibody) const
{
  Friction found = of_all;
  for (int k = 0; k < 3; ++k)
    if (!is_thermostatted(ibody, TRANSLATION, k)) found.translation[k] = 0.0;
  if (!is_thermostatted(ibody, ROTATION)) found.rotation = 0.0;
  return found;
}

/// Scale of kinetic energies, which is the same in all steps with one target.
double Thermostat::scale() const
{
  return ExactSum::scale_of(std::max(1.0, freedoms[TRANSLATION] + freedoms[ROTATION]) * line.kt);
}

/// Adds the part of the kinetic energy of a body that the chains act on.
void Thermostat::add_kinetic(int ibody, const double *velocity, const double *omega_body,
                             Sums &sums) const
{
  const RigidBody &rigid = bodies.rigid_of(ibody);
  double along[3] = {velocity[0], velocity[1], velocity[2]};
  const bool masked = bodies.body_at(ibody).off != 0;
  for (int k = 0; masked && k < 3; ++k)
    if (!is_thermostatted(ibody, TRANSLATION, k)) along[k] = 0.0;
  sums[TRANSLATION].add(2.0 * translational_energy(rigid, along), unit);
  if (!masked || is_thermostatted(ibody, ROTATION))
    sums[ROTATION].add(2.0 * rotational_energy(rigid, omega_body), unit);
}

void Thermostat::sum_kinetic(const Sums &sums)
{
  bigint limbs[2 * ExactSum::LIMBS];
  for (int part = 0; part < 2; ++part)
    std::copy_n(sums[part].limbs, ExactSum::LIMBS, limbs + ExactSum::LIMBS * part);
  const auto all = over_ranks(MPI_SUM, limbs, world);
  for (int part = 0; part < 2; ++part) {
    ExactSum sum;
    std::copy_n(all.begin() + ExactSum::LIMBS * part, ExactSum::LIMBS, sum.limbs);
    twice[part] = sum.value(unit);
  }
  const double common = total.twice_energy();
  twice[TRANSLATION] -= common;
  if (twice[TRANSLATION] < ROUNDING_OF_ENERGY * common) twice[TRANSLATION] = 0.0;
}

void Thermostat::sum_present()
{
  Sums sums;
  unit = scale();
  total.measure(line.kt);
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const BodyState &s = bodies.state_of(ibody);
    add_kinetic(ibody, s.velocity, s.omega_body, sums);
  }
  sum_kinetic(sums);
}

void Thermostat::note_friction()
{
  for (size_t c = 0; c < chains.size(); ++c) friction[c] = chains[c].friction();
  share_friction();
}

void Thermostat::share_friction()
{
  of_all = Multipliers{friction[TRANSLATION], friction[words.separate ? ROTATION : TRANSLATION]};
  of_all.implicit = strong;
  std::copy_n(total.velocity(), 3, of_all.common);
}

void Thermostat::measure()
{
  sum_present();
  note_friction();
}

void Thermostat::correct(const Integrator &integrator, int passes)
{
  correct_by_passes(*this, integrator, passes);
}

void Thermostat::begin_passes(const Integrator &integrator)
{
  waiting = false;
  same_bodies = changes == bodies.changes();
  line = line_of_step(update->ntimestep);
  unit = scale();
  total.measure(line.kt);
  strong = std::fabs(integrator.step()) * strongest_friction() > STRONG;
  here[TRANSLATION] = here[ROTATION] = ExactSum();
}

void Thermostat::add_prediction(const Integrator &, int ibody, const Integrator::Pending &)
{
  const BodyState &s = bodies.state_of(ibody);
  add_kinetic(ibody, s.velocity, s.omega_body, here);
}

void Thermostat::find_friction(const Integrator &integrator, int /*pass*/)
{
  const int values = integrator.values();
  const double h = integrator.step();
  sum_kinetic(here);
  for (size_t c = 0; c < chains.size(); ++c)
    advance(c, same_bodies ? twice_of(c) : chains[c].foretold(h, values), h, values);
  note_friction();
  here[TRANSLATION] = here[ROTATION] = ExactSum();
}

void Thermostat::end_passes(const Integrator &)
{
  for (auto &chain : chains) chain.conclude();
}

/// A non-finite kinetic energy is due to an unstable body, which ends the run.
void Thermostat::advance(int chain, double twice_kinetic, double h, int values)
{
  if (!std::isfinite(twice_kinetic)) return;
  const ChainTarget target = target_of(chain, -1.0, h);
  if (chains[chain].advance(target, twice_kinetic, h, values)) return;
  const double degree = force->mvv2e / force->boltz;
  error->all(FLERR,
             "Fix gear/quat temp: in step {} the bodies have a temperature of {:.4g}, {:.3g} times "
             "the target, and the thermostat cannot follow it; begin nearer to the target, or use "
             "a longer damping time than {:g}",
             update->ntimestep, degree * twice_kinetic / target.freedoms,
             twice_kinetic / (target.freedoms * target.kt), words.damp);
}

/// The effect of the errors of the chains in this step on bodies in thermal motion: an error d of
/// the friction causes the error h d v of a velocity v.  A cold body is insensitive to the friction,
/// so its errors do not show whether the chains are accurate.
void Thermostat::errors(double h, int values, const Include &include) const
{
  const int terms = std::min(values, SECOND_MOST);
  double most = 0.0;
  for (size_t c = 0; c < chains.size(); ++c)
    most = std::max(most, chains[c].left_out(target_of(c, 0.0, h), h, terms));
  most *= double(adams_moulton(terms));
  StepErrors found;
  found.energy = std::fabs(h) * 3.0 * line.kt * most;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    found.length = h * h * std::sqrt(3.0 * line.kt / bodies.rigid_of(ibody).mass) * most;
    include(found);
  }
}

void Thermostat::note_step(double h)
{
  if (!acts()) return;
  for (const Part part : {TRANSLATION, ROTATION}) {
    const bool is_cold = twice[part] < COLD * freedoms[part] * line.kt;
    cold[part] = is_cold ? cold[part] + std::fabs(h) : 0.0;
    if (warned[part] || cold[part] < COLD_TIMES * words.damp) continue;
    warned[part] = true;
    if (comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat temp: until step {} the {} kinetic energy of the bodies was below {:g} "
          "% of its target for {:g} damping times; a thermostat only scales it, so bodies that "
          "hardly {} stay cold for a long time; velocity create gives them velocities between "
          "runs",
          update->ntimestep, part == ROTATION ? "rotational" : "translational", 100.0 * COLD,
          COLD_TIMES, part == ROTATION ? "rotate" : "move");
  }
}

void Thermostat::follow_velocities(double h)
{
  measure();
  for (size_t c = 0; c < chains.size(); ++c) {
    const ChainTarget target = target_of(c, 0.0, h);
    chains[c].join(target, target, twice_of(c));
  }
}

/* ----------------------------------------------------------------------
   outputs and restart
------------------------------------------------------------------------- */

double Thermostat::energy() const
{
  double sum = 0.0;
  for (size_t c = 0; c < chains.size(); ++c) sum += chains[c].energy(target_of(c, 0.0, 0.0));
  return sum * force->mvv2e;
}

double Thermostat::element(int n)
{
  const double degree = force->mvv2e / force->boltz;
  const auto temperature = [&](Part part) {
    sum_present();
    return freedoms[part] > 0.0 ? degree * twice[part] / freedoms[part] : 0.0;
  };
  switch (n) {
    case ENERGY:
      return energy();
    case T_TRANSLATION:
      return temperature(TRANSLATION);
    case T_ROTATION:
      return temperature(ROTATION);
    case TARGET:
      return degree * line.kt;
    case XI_TRANSLATION:
      return friction[TRANSLATION];
    default:
      return friction[words.separate ? ROTATION : TRANSLATION];
  }
}

void Thermostat::fields(Fields &v)
{
  Setting last = setting();
  v(chains, counted, cold, last);
  if (!v.reads()) return;
  made = last;
  waiting = true;
  line = made.line;
  damp_before = made.damp;
  std::copy_n(made.freedoms, 2, freedoms);
  note_friction();
}

// targets that differ by less than this are equal up to rounding

static constexpr double ROUNDING_OF_TARGET = 1.0e-12;

// a common motion of all bodies with less kinetic energy than this, in kT, is not reported

static constexpr double TOLD_MOTION = 0.01;

// the strongest friction that bodies follow, times the step; and the part of it that a changing step
// permits

static constexpr double STRONGEST = 0.5, SAFE = 0.8;

static constexpr Mask NO_TORQUE = torque_off(0) | torque_off(1) | torque_off(2);

/* ----------------------------------------------------------------------
   degrees of freedom
------------------------------------------------------------------------- */

/// In two dimensions bodies turn only about z, for any keywords.
bool Thermostat::is_thermostatted(int ibody, Part part, int component) const
{
  if (part == TRANSLATION) return total.belongs(ibody, component);
  const Mask off = bodies.body_at(ibody).off;
  return domain->dimension == 2 ? !(off & torque_off(2)) : (off & NO_TORQUE) != NO_TORQUE;
}

void Thermostat::count_freedoms()
{
  double here = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    if (!is_thermostatted(ibody, ROTATION)) continue;
    const RigidBody &rigid = bodies.rigid_of(ibody);
    here += rigid.freedoms(domain->dimension) - domain->dimension;
  }
  total.weigh(words.subtracted, words.may_wait);
  freedoms[TRANSLATION] = total.freedoms();
  freedoms[ROTATION] = over_ranks(MPI_SUM, here, world);
  counted = bodies.number();
  changes = bodies.changes();
  natoms = atom->natoms;
}

void Thermostat::tell_once(std::string &last, const std::string &message) const
{
  if (message != last && comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat {}: {}\n", fix->id, message);
  last = message;
}

void Thermostat::tell_freedoms()
{
  if (!acts()) return;
  std::string now =
      fmt::format("thermostat of {:.0f} degrees of freedom of translation{} and {:.0f} of rotation",
                  freedoms[TRANSLATION], total.description(), freedoms[ROTATION]);
  const double common = 0.5 * total.twice_energy() / line.kt;
  if (common > TOLD_MOTION)
    now += fmt::format("; the bodies move together with a kinetic energy of {:.3g} kT, which is "
                       "not part of their temperature: velocity zero linear removes it",
                       common);
  tell_once(told, now);
}

void Thermostat::follow_changes(double h)
{
  if (changes == bodies.changes() && natoms == atom->natoms) return;
  ChainTarget before[2];
  for (size_t c = 0; c < chains.size(); ++c) before[c] = target_of(c, 0.0, h);
  count_freedoms();
  sum_present();
  for (size_t c = 0; c < chains.size(); ++c)
    chains[c].join(before[c], target_of(c, 0.0, h), twice_of(c));
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

/// The setting of the last completed step.
Thermostat::Setting Thermostat::setting() const
{
  if (waiting) return made;
  return {line, {freedoms[TRANSLATION], freedoms[ROTATION]}, damp_before};
}

void Thermostat::begin_run(bool /*anew*/, double h)
{
  refuse_masks();
  made = setting();
  waiting = true;
  damp_before = words.damp;
  const bool moves = update->nsteps > 0 || made.line.kt == 0.0;
  line = moves ? line_of_step(update->ntimestep) : made.line;
  count_freedoms();
  sum_present();
  note_friction();
  refuse_nothing();
  tell_freedoms();
  // a single pass uses only the predicted friction
  const double fewest = (single_pass ? 2.0 : 1.0) * FEWEST_STEPS;
  constexpr double ROUNDING = 1.0e-12;    // tolerance limits a step to exactly this many
  if (acts() && words.damp < (1.0 - ROUNDING) * fewest * std::fabs(h) && comm->me == 0)
    error->warning(
        FLERR,
        "Fix gear/quat temp: a damping time of {:.3g} is less than {:.0f} time steps, and "
        "the motion may become unstable",
        words.damp, fewest);
}

const char *Thermostat::reason_to_start_anew() const
{
  const auto differs = [this](double a, double b) {
    return std::fabs(a - b) > ROUNDING_OF_TARGET * line.kt;
  };
  const bool jumps = differs(made.line.kt, line.kt) || differs(made.line.kt_step, line.kt_step) ||
      made.freedoms[TRANSLATION] != freedoms[TRANSLATION] ||
      made.freedoms[ROTATION] != freedoms[ROTATION] || made.damp != words.damp;
  return jumps ? "the thermostat has another target, or other degrees of freedom, than in the "
                 "last steps"
               : nullptr;
}

/// Space-frame components of a torque do not correspond to a part of the rotational energy.
void Thermostat::refuse_masks() const
{
  if (domain->dimension == 2) return;
  tagint partly = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body_at(ibody);
    const Mask off = body.off & NO_TORQUE;
    if (off && off != NO_TORQUE && body.rigid.rotational_freedoms() > 0) partly = body.id;
  }
  partly = over_ranks(MPI_MAX, partly, world);
  if (partly)
    error->all(FLERR,
               "Fix gear/quat temp: keyword torque turns off some components for body {} and not "
               "all, so its rotation has no temperature; turn off all three, or define a second "
               "fix without temp for such bodies",
               partly);
}

void Thermostat::refuse_nothing() const
{
  if (!acts() || (words.may_wait && counted == 0)) return;
  if (!total.any() && freedoms[ROTATION] == 0.0)
    error->all(FLERR,
               "Fix gear/quat temp: keywords force and torque turn off all degrees of freedom of "
               "the bodies, so they have no temperature");
  if (freedoms[TRANSLATION] < 0.0)
    error->all(FLERR,
               "Fix gear/quat temp: fix_modify extra/dof subtracts more degrees of freedom of "
               "translation than the bodies have");
}

/// The longest step permitted by the friction and the damping time.
double Thermostat::longest_step() const
{
  if (!acts()) return std::numeric_limits<double>::infinity();
  const double longest = words.damp / FEWEST_STEPS, strongest = strongest_friction();
  return strongest > 0.0 ? std::min(longest, SAFE * STRONGEST / strongest) : longest;
}

double Thermostat::strongest_friction() const
{
  double strongest = 0.0;
  for (const auto &chain : chains) strongest = std::max(strongest, std::fabs(chain.friction()));
  return strongest;
}

std::vector<Rate> Thermostat::rates(double h, bool /*ahead*/) const
{
  if (!acts()) return {};
  const double found = std::fabs(h) * strongest_friction();
  const double period = std::max(FEWEST_STEPS * std::fabs(h), 2.0 * words.damp * found / STRONGEST);
  return {{"the friction of the thermostat is", found, STRONGEST,
           fmt::format("use a damping time of {:g} or longer", rounded_up(period))}};
}

/* ----------------------------------------------------------------------
   the start: kinetic energies at the nodes of the bodies' collocation, which drive the chains from
   the start to each node
------------------------------------------------------------------------- */

void Thermostat::begin_start(const StartNodes &nodes)
{
  note_friction();
  twice_at_nodes.resize(chains.size());
  held.resize(chains.size());
  for (size_t c = 0; c < chains.size(); ++c) {
    held[c] = chains[c].is_stiff(target_of(c, 0.0, nodes.h), twice_of(c), nodes.h,
                                 nodes.collocation.pairs());
    nodes.collocation.begin(0.0, twice_of(c), twice_at_nodes[c]);
  }
}

void Thermostat::foretell(const StartNodes &nodes)
{
  for (auto &twice : twice_at_nodes) nodes.collocation.foretell(twice);
}

ChainDrive Thermostat::drive_of(const Collocation &collocation, const Collocation::Scalar &twice)
{
  double at[ChainDrive::MOST];
  const int points = 2 * twice.pairs + 1;
  for (int i = 0; i < points; ++i) at[i] = i - twice.pairs;
  return ChainDrive::through(points, at, collocation.rate_at_start(twice) - twice.pairs);
}

void Thermostat::visit_node(const StartNodes &nodes, int node)
{
  sum_present();
  for (size_t c = 0; c < chains.size(); ++c) {
    const ChainTarget target = target_of(c, 0.0, nodes.h);
    const ChainDrive drive = drive_of(nodes.collocation, twice_at_nodes[c]);
    if (!held[c]) friction[c] = chains[c].flow(target, drive, nodes.spacing, node).y[0];
    nodes.collocation.set_rate(node, twice_of(c), twice_at_nodes[c]);
  }
  share_friction();
}

void Thermostat::settle(const StartNodes &nodes, int pair)
{
  for (auto &twice : twice_at_nodes) nodes.collocation.settle(pair, twice);
}

void Thermostat::seed(const StartNodes &nodes, int pairs, int values)
{
  for (size_t c = 0; c < chains.size(); ++c)
    chains[c].seed(nodes.collocation.rate_at_start(twice_at_nodes[c]), pairs, nodes.spacing,
                   values + 1);
}

void Thermostat::seed_local(double /*h*/, int /*terms*/)
{
  note_friction();
  for (size_t c = 0; c < chains.size(); ++c) {
    const double now = twice_of(c);
    chains[c].seed(&now, 0, 0.0, 1);
  }
}
