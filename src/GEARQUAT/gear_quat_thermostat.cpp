/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_thermostat.h"

#include "gear_quat_friction.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

// a kinetic energy less than this part of the other one is rounding of velocities

static constexpr double NOTHING = 1.0e-24;

// targets that differ by less are the same but for rounding

static constexpr double ROUNDING_OF_TARGET = 1.0e-12;

// a part of a kinetic energy that is below this fraction of its target for as many damping times is
// not about to become warm: chains of its own make it grow by several powers of ten in that time

static constexpr double COLD = 0.01, COLD_TIMES = 10.0;

static constexpr Mask NO_TORQUE = torque_off(0) | torque_off(1) | torque_off(2);

/* ---------------------------------------------------------------------- */

Thermostat::Thermostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const ThermostatWords &words,
                       const Scheme &scheme) :
    Pointers(lmp),
    fix(fix), bodies(bodies), words(words), chains(words.separate ? 2 : 1, Chain(words.length)),
    most_friction(FrictionLimit::of(scheme))
{
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

/// In two dimensions bodies have no momentum along z and turn about z alone, whatever keywords say.
bool Thermostat::is_thermostatted(int ibody, Part part, int component) const
{
  const Mask off = bodies.body_at(ibody).off;
  const bool flat = domain->dimension == 2;
  if (part == TRANSLATION) return !(off & force_off(component)) && !(flat && component == 2);
  return flat ? !(off & torque_off(2)) : (off & NO_TORQUE) != NO_TORQUE;
}

void Thermostat::count_freedoms()
{
  double here[2] = {0.0, 0.0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    for (int k = 0; k < 3; ++k) here[TRANSLATION] += is_thermostatted(ibody, TRANSLATION, k);
    if (!is_thermostatted(ibody, ROTATION)) continue;
    const RigidBody &rigid = bodies.rigid_of(ibody);
    here[ROTATION] += domain->dimension == 2 ? rigid.inertia[2] > 0.0 : rigid.rotational_freedoms();
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  conserved = conserves_momentum();
  const int of_total = conserved ? domain->dimension : 0;
  freedoms[TRANSLATION] = std::max(0.0, all[TRANSLATION] - of_total);
  freedoms[ROTATION] = all[ROTATION];
  counted = bodies.number();
  changes = bodies.changes();
}

/// True if nothing outside of the bodies has a force on them.
bool Thermostat::conserves_momentum() const
{
  if (bodies.number_of_sites() != atom->natoms) return false;
  int held = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    for (int k = 0; k < domain->dimension; ++k) held |= !is_thermostatted(ibody, TRANSLATION, k);
  if (over_ranks(MPI_MAX, held, world)) return false;
  constexpr int EXERTS = FixConst::POST_FORCE | FixConst::POST_FORCE_RESPA;
  for (auto *other : modify->get_fix_list()) {
    // what it sets to zero along z belongs to no degree of freedom
    if (other == fix || utils::strmatch(other->style, "^enforce2d")) continue;
    if ((modify->get_fix_mask(other) & EXERTS) && group->count(other->igroup) > 0) return false;
  }
  return true;
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void Thermostat::begin_run(double h)
{
  refuse_masks();
  const Line before = line;
  const double had[2] = {freedoms[TRANSLATION], freedoms[ROTATION]};
  const bool first = counted == 0;
  count_freedoms();
  line = line_of_step(update->ntimestep);
  const auto differs = [&](double a, double b) {
    return std::fabs(a - b) > ROUNDING_OF_TARGET * line.kt;
  };
  const bool changed = had[TRANSLATION] != freedoms[TRANSLATION] ||
      had[ROTATION] != freedoms[ROTATION];
  jumps = differs(before.kt, line.kt) || differs(before.kt_step, line.kt_step) || changed ||
      damp_before != words.damp;
  damp_before = words.damp;
  measure();
  refuse_nothing();
  refuse_friction(h);
  if (words.damp < FEWEST_STEPS * std::fabs(update->dt) && comm->me == 0)
    error->warning(
        FLERR,
        "Fix gear/quat temp: a damping time of {:.3g} is less than {:.0f} time steps, and "
        "the motion may become unstable",
        words.damp, FEWEST_STEPS);
  if ((first || changed) && comm->me == 0)
    utils::logmesg(lmp,
                   "Fix gear/quat {}: thermostat of {:.0f} degrees of freedom of translation{} and "
                   "{:.0f} of rotation\n",
                   fix->id, freedoms[TRANSLATION],
                   conserved ? ", without those of the total momentum," : "", freedoms[ROTATION]);
}

/// Space-frame components of a torque belong to no part of the rotational energy.
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

/// Friction warms nothing that stands still.
void Thermostat::refuse_nothing() const
{
  if (words.may_wait && counted == 0) return;
  if (freedoms[TRANSLATION] + freedoms[ROTATION] == 0.0)
    error->all(FLERR,
               "Fix gear/quat temp: the bodies have no degrees of freedom that keywords force and "
               "torque leave on, so they have no temperature");
  const char *missing = nullptr;
  const auto rests = [this](Part part) {
    return freedoms[part] > 0.0 && twice[part] <= NOTHING * (twice[TRANSLATION] + twice[ROTATION]);
  };
  if (twice[TRANSLATION] + twice[ROTATION] <= 0.0)
    missing = "";
  else if (words.separate && rests(TRANSLATION))
    missing = "translational ";
  else if (words.separate && rests(ROTATION))
    missing = "rotational ";
  if (missing)
    error->all(FLERR,
               "Fix gear/quat temp: the {}kinetic energy of the bodies is zero, and a thermostat "
               "only scales it; give them velocities first",
               missing);
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

Friction Thermostat::friction_of(int ibody) const
{
  const double of_rotation = friction[words.separate ? ROTATION : TRANSLATION];
  Friction found = Multipliers{friction[TRANSLATION], of_rotation};
  if (bodies.body_at(ibody).off == 0) return found;
  for (int k = 0; k < 3; ++k)
    if (!is_thermostatted(ibody, TRANSLATION, k)) found.translation[k] = 0.0;
  if (!is_thermostatted(ibody, ROTATION)) found.rotation = 0.0;
  return found;
}

/// Of kinetic energies: the same in all steps with one target.
double Thermostat::scale() const
{
  return ExactSum::scale_of(std::max(1.0, freedoms[TRANSLATION] + freedoms[ROTATION]) * line.kt);
}

/// Adds what the chains have of the kinetic energy of a body.
void Thermostat::add_kinetic(int ibody, const double *velocity, const double *omega_body,
                             Sums &here) const
{
  const RigidBody &rigid = bodies.rigid_of(ibody);
  double along[3] = {velocity[0], velocity[1], velocity[2]};
  const bool masked = bodies.body_at(ibody).off != 0;
  for (int k = 0; masked && k < 3; ++k)
    if (!is_thermostatted(ibody, TRANSLATION, k)) along[k] = 0.0;
  here[TRANSLATION].add(2.0 * translational_energy(rigid, along), unit);
  if (!masked || is_thermostatted(ibody, ROTATION))
    here[ROTATION].add(2.0 * rotational_energy(rigid, omega_body), unit);
}

void Thermostat::sum_kinetic(const Sums &here)
{
  bigint limbs[4];
  for (int part = 0; part < 2; ++part) std::copy_n(here[part].limbs, 2, limbs + 2 * part);
  const auto all = over_ranks(MPI_SUM, limbs, world);
  for (int part = 0; part < 2; ++part) {
    ExactSum sum;
    std::copy_n(all.begin() + 2 * part, 2, sum.limbs);
    twice[part] = sum.value(unit);
  }
}

void Thermostat::sum_present()
{
  Sums here;
  unit = scale();
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const BodyState &s = bodies.state_of(ibody);
    add_kinetic(ibody, s.velocity, s.omega_body, here);
  }
  sum_kinetic(here);
}

void Thermostat::note_friction()
{
  for (size_t c = 0; c < chains.size(); ++c) friction[c] = chains[c].friction();
}

void Thermostat::measure()
{
  sum_present();
  note_friction();
}

void Thermostat::correct(const Integrator &integrator, const Scheme &scheme)
{
  const int values = integrator.values();
  const double h = integrator.step();
  const bool same_bodies = changes == bodies.changes();
  line = line_of_step(update->ntimestep);

  Sums here;
  double velocity[3], omega_body[3];
  unit = scale();
  pending.resize(bodies.nmoved());
  for_moved([&](int ibody) {
    const BodyState &s = bodies.state_of(ibody);
    pending[ibody] =
        integrator.begin(bodies.acting(ibody), bodies.axes(ibody), bodies.history(ibody));
    if (ibody < bodies.nowned()) add_kinetic(ibody, s.velocity, s.omega_body, here);
  });

  for (int pass = 0; pass < scheme.passes; ++pass) {
    sum_kinetic(here);
    for (size_t c = 0; c < chains.size(); ++c)
      advance(c, same_bodies ? twice_of(c) : chains[c].foretold(h, values), h, values);
    note_friction();
    here[TRANSLATION] = here[ROTATION] = ExactSum();
    for_moved([&](int ibody) {
      const RigidBody &rigid = bodies.rigid_of(ibody);
      double *rows = bodies.history(ibody);
      integrator.correct_pass(rigid, bodies.acting(ibody), friction_of(ibody), rows,
                              pending[ibody]);
      if (ibody >= bodies.nowned() || pass + 1 == scheme.passes) return;
      integrator.velocities_of_pass(rigid, rows, pending[ibody], velocity, omega_body);
      add_kinetic(ibody, velocity, omega_body, here);
    });
  }
  for (auto &chain : chains) chain.conclude();
  for_moved([&](int ibody) {
    finish_body(integrator, ibody);
  });
}

/// A kinetic energy that is no number belongs to a body that is lost, which ends the run.
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

void Thermostat::finish_body(const Integrator &integrator, int ibody)
{
  double *rows = bodies.history(ibody);
  BodyState &state = bodies.change_state(ibody);
  Correction &last = bodies.change_last(ibody);
  const bool masked = bodies.body_at(ibody).off != 0;
  const BodyState before = masked ? state : BodyState();
  last = integrator.finish(bodies.acting(ibody), rows, pending[ibody]);
  integrator.body_state(bodies.rigid_of(ibody), rows, state, bodies.change_frame(ibody));
  if (masked) last.work = work_between(bodies.load_of(ibody), before, state);
}

Chain::LeftOut Thermostat::left_out(double h, int values) const
{
  Chain::LeftOut all;
  for (size_t c = 0; c < chains.size(); ++c) {
    const Chain::LeftOut one = chains[c].left_out(target_of(c, 0.0, h), h, values);
    all = {std::max(all.fewer, one.fewer), std::max(all.same, one.same),
           std::max(all.more, one.more)};
  }
  return all;
}

void Thermostat::watch_cold(double h)
{
  for (const Part part : {TRANSLATION, ROTATION}) {
    const bool is_cold = twice[part] < COLD * freedoms[part] * line.kt;
    cold[part] = is_cold ? cold[part] + std::fabs(h) : 0.0;
    if (warned[part] || cold[part] < COLD_TIMES * words.damp) continue;
    warned[part] = true;
    if (comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat temp: until step {} the {} kinetic energy of the bodies was below {:g} % "
          "of its target for {:g} damping times; a thermostat only scales it, so bodies that "
          "hardly "
          "{} stay cold for long; velocity create gives them velocities between runs",
          update->ntimestep, part == ROTATION ? "rotational" : "translational", 100.0 * COLD,
          COLD_TIMES, part == ROTATION ? "rotate" : "move");
  }
}

void Thermostat::follow_bodies(double h)
{
  if (changes == bodies.changes()) return;
  ChainTarget before[2];
  for (size_t c = 0; c < chains.size(); ++c) before[c] = target_of(c, 0.0, h);
  count_freedoms();
  sum_present();
  for (size_t c = 0; c < chains.size(); ++c)
    chains[c].join(before[c], target_of(c, 0.0, h), twice_of(c));
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
      return chains.front().friction();
    default:
      return chains.back().friction();
  }
}

Thermostat::Checkpoint Thermostat::checkpoint() const
{
  Checkpoint saved = {(double) mode(),
                      (double) words.length,
                      (double) counted,
                      line.kt,
                      line.kt_step,
                      words.damp,
                      {freedoms[TRANSLATION], freedoms[ROTATION]},
                      {}};
  for (size_t c = 0; c < chains.size(); ++c) saved.chains[c] = chains[c].record();
  return saved;
}

void Thermostat::restore(const Checkpoint &saved)
{
  counted = (bigint) saved.bodies;
  line = {saved.kt, saved.kt_step};
  damp_before = saved.period;
  std::copy_n(saved.freedoms, 2, freedoms);
  for (size_t c = 0; c < chains.size(); ++c) chains[c].restore(saved.chains[c]);
  note_friction();
}
