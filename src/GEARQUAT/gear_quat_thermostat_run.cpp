/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword temp, before a run: degrees of freedom, the target of its steps, a test for too strong
   friction, and the start of the chains.  It also handles steps in which degrees of freedom
   change. */

#include "gear_quat_thermostat.h"

#include "gear_quat_limits.h"
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

// targets that differ by less than this are equal up to rounding

static constexpr double ROUNDING_OF_TARGET = 1.0e-12;

// a common motion of all bodies with less kinetic energy than this, in kT, is not reported

static constexpr double TOLD_MOTION = 0.01;

// a friction that is nearly too strong, relative to the limit

static constexpr double SAFE = 0.8;

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
  refuse_friction(h);
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

/* ----------------------------------------------------------------------
   test for a friction that is too strong for the bodies
------------------------------------------------------------------------- */

/// Ends the run if it is too strong.
void Thermostat::refuse_friction(double h) const
{
  const double limit = most_friction / std::fabs(h);
  for (int c = 0; c < (int) chains.size(); ++c) {
    const ChainTarget target = target_of(c, 0.0, h);
    if (!(twice_of(c) > 0.0) || !(target.freedoms > 0.0)) continue;
    if (friction_bound(chains[c], target, twice_of(c)) < limit) continue;
    const double found = friction_on_trial(chains[c], target, twice_of(c), h);
    if (found < limit) continue;
    const double advised =
        std::max(FEWEST_STEPS * std::fabs(h),
                 target.period * friction_bound(chains[c], target, twice_of(c)) / (SAFE * limit));
    error->all(FLERR,
               "Fix gear/quat temp: the {}temperature is {:.3g}, {:.3g} times its target, and with "
               "a damping time of {:.3g} the thermostat would have a friction of {:.2g}/step, "
               "where a step of {:.3g} permits {:.2g}; use a damping time of {:.2g} or longer",
               !words.separate     ? ""
                   : c == ROTATION ? "rotational "
                                   : "translational ",
               twice_of(c) / target.freedoms * force->mvv2e / force->boltz,
               twice_of(c) / (target.freedoms * target.kt), words.damp, found * std::fabs(h), h,
               limit * std::fabs(h), 1.05 * advised);
  }
}

double Thermostat::friction_ahead(double h) const
{
  constexpr double WEAK = 0.1;    // times the step: weak enough for any method
  const double size = std::fabs(h);
  double strongest = 0.0;
  for (int c = 0; c < (int) chains.size(); ++c) {
    const ChainTarget target = target_of(c, 0.0, h);
    if (!(twice_of(c) > 0.0) || !(target.freedoms > 0.0)) continue;
    double bound = friction_bound(chains[c], target, twice_of(c));
    if (size * bound > WEAK)
      bound = std::min(bound, friction_on_trial(chains[c], target, twice_of(c), h));
    strongest = std::max(strongest, size * bound);
  }
  return strongest;
}

/// The longest step permitted by the friction and the damping time.
double Thermostat::longest_step() const
{
  if (!acts()) return std::numeric_limits<double>::infinity();
  const double longest = words.damp / FEWEST_STEPS, strongest = strongest_friction();
  return strongest > 0.0 ? std::min(longest, SAFE * most_friction / strongest) : longest;
}

double Thermostat::strongest_friction() const
{
  double strongest = 0.0;
  for (const auto &chain : chains) strongest = std::max(strongest, std::fabs(chain.friction()));
  return strongest;
}

double Thermostat::part_of_limit(double h) const
{
  return std::fabs(h) * strongest_friction() / most_friction;
}

Cause Thermostat::instability(double h) const
{
  const double part = part_of_limit(h);
  if (part < 1.0) return {};
  return {fmt::format("The thermostat became unstable first: its friction in a step of {:g} is "
                      "{:.2g} times as strong as the method can follow",
                      h, part),
          "Begin nearer to the target temperature, or use a longer damping time"};
}

/// Warns once of a friction that is nearly too strong.
void Thermostat::watch_friction(double h)
{
  const double part = part_of_limit(h);
  if (warned_friction || part < SAFE) return;
  warned_friction = true;
  const double translation = element(T_TRANSLATION), rotation = element(T_ROTATION);
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat temp: in step {} the thermostat has a friction of {:.2g}/step, "
                   "{:.0f} % of the limit of the method; the temperatures of translation and "
                   "rotation are {:.4g} and {:.4g}, the target is {:.4g}; use a longer damping "
                   "time than {:g}",
                   update->ntimestep, std::fabs(h) * strongest_friction(), 100.0 * part,
                   translation, rotation, element(TARGET), words.damp);
}

/* ----------------------------------------------------------------------
   the start: kinetic energies at the nodes of the bodies' collocation, which drive the chains from
   the start to each node
------------------------------------------------------------------------- */

/// Chains that have never moved start near their stationary state.
void Thermostat::settle_fresh(double h)
{
  for (size_t c = 0; c < chains.size(); ++c)
    chains[c].begin_settled(target_of(c, 0.0, h), twice_of(c), h);
  note_friction();
}

void Thermostat::begin_start(const StartNodes &nodes)
{
  settle_fresh(nodes.h);
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

void Thermostat::seed_local(double h, int /*terms*/)
{
  settle_fresh(h);
  for (size_t c = 0; c < chains.size(); ++c) {
    const double now = twice_of(c);
    chains[c].seed(&now, 0, 0.0, 1);
  }
}
