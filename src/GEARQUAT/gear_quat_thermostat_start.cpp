/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword temp, the start: kinetic energies at the nodes of the bodies' collocation, and the chains
   that they drive from the start to each node. */

#include "gear_quat_thermostat.h"

#include "gear_quat_friction.h"

#include "comm.h"
#include "error.h"
#include "force.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

// a friction that is nearly too strong, as a part of the limit

static constexpr double SAFE = 0.8;

/* ----------------------------------------------------------------------
   before a run: is the friction going to be stronger than the bodies can follow?
------------------------------------------------------------------------- */

/// Ends the run if so.
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

/// The longest step that the friction, and the damping time, permit.
double Thermostat::longest_step() const
{
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
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat temp: in step {} the thermostat has a friction of {:.2g}/step, "
                   "{:.0f} % of the limit of the method; the temperatures of translation and "
                   "rotation are {:.4g} and {:.4g}, the target is {:.4g}; use a longer damping "
                   "time than {:g}",
                   update->ntimestep, std::fabs(h) * strongest_friction(), 100.0 * part,
                   element(T_TRANSLATION), element(T_ROTATION), element(TARGET), words.damp);
}

/* ---------------------------------------------------------------------- */

/// Chains that have never moved begin near to where they go.
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

/// 2K at a node; behind and before it in memory are those at the other nodes.
static const double *at_start(const Collocation &collocation, const Collocation::Scalar &twice)
{
  return twice.rate[collocation.pairs()];
}

/// 2K about the start, in units of the node spacing.
static ChainDrive drive_of(const Collocation &collocation, const Collocation::Scalar &twice)
{
  double at[ChainDrive::MOST];
  const int points = 2 * twice.pairs + 1;
  for (int i = 0; i < points; ++i) at[i] = i - twice.pairs;
  return ChainDrive::through(points, at, at_start(collocation, twice) - twice.pairs);
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
    chains[c].seed(at_start(nodes.collocation, twice_at_nodes[c]), pairs, nodes.spacing,
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
