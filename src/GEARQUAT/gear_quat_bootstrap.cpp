/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_bootstrap.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "fix.h"
#include "neighbor.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

void Party::measure()
{
  if (isokinetic) isokinetic->measure();
}

Load Party::acting(int ibody) const
{
  return isokinetic ? isokinetic->acting(ibody) : bodies->acting(ibody);
}

void Party::seed_local(int terms, double h)
{
  measure();
  for (int ibody = 0; ibody < bodies->nmoved(); ++ibody)
    Bootstrap::seed_body(*bodies, ibody, acting(ibody), scheme, h, terms);
  if (isokinetic) {
    const double heat[2] = {0.0, h * isokinetic->power()};
    isokinetic->seed_heat(heat, 2, h, h);
  }
}

/* ---------------------------------------------------------------------- */

static int most_values(const std::vector<Party> &parties)
{
  int most = 0;
  for (const auto &party : parties) most = std::max(most, party.scheme.values());
  return most;
}

Bootstrap::Bootstrap(LAMMPS *lmp, const std::vector<Party> &parties, double h) :
    Pointers(lmp), parties(parties), h(h), collocation(most_values(parties)), evaluations(0)
{
  for (auto &party : this->parties) party.power.assign(collocation.number_of_nodes(), 0.0);
}

void Bootstrap::measure(int node)
{
  for (auto &party : parties) {
    party.measure();
    if (party.isokinetic) party.power[collocation.pairs() + node] = party.isokinetic->power();
  }
}

void Bootstrap::zero(Party party, double h)
{
  party.seed_local(2, h);
}

void Bootstrap::seed_body(Bodies &bodies, int ibody, const Load &acting, const Scheme &scheme,
                          double h, int terms)
{
  const RigidBody &rigid = bodies.rigid_of(ibody);
  auto series = local_series(rigid, bodies.state_of(ibody), acting, h);
  series.terms = terms;
  seed(scheme, rigid, series, h, h, bodies.history(ibody));
}

/* ---------------------------------------------------------------------- */

bool Bootstrap::run()
{
  std::vector<const Fix *> owners;
  std::string orders;
  for (const auto &party : parties) {
    owners.push_back(party.fix);
    const std::string order = std::to_string(party.scheme.order());
    if (orders.empty() || orders != order) orders += (orders.empty() ? "" : " and ") + order;
  }
  Forces forces(lmp, owners);
  std::string why = forces.reason();
  if (why.empty()) {
    if (search(forces)) {
      const bool any = std::any_of(parties.begin(), parties.end(), [](const auto &party) {
        return party.bodies->number() > 0;
      });
      if (comm->me == 0 && any)
        utils::logmesg(lmp, "Fix gear/quat {}: start of order {} from {} force evaluations{}\n",
                       names(), orders, evaluations, reason);
      return true;
    }
    why = reason;
  }
  for (auto &party : parties) {
    if (!party.needed) continue;
    party.seed_local(3, h);
    const Noise noise = forces.noise([&party](int i) {
      return party.bodies->in_body(i);
    });
    if (comm->me != 0) continue;
    utils::logmesg(lmp, "Fix gear/quat {}: start with known forces only (order 2), because {}\n",
                   party.fix->id, why);
    const std::string remedy = remedy_for_noise(party.scheme, noise);
    if (!remedy.empty())
      utils::logmesg(
          lmp,
          "Fix gear/quat {}: random forces heat bodies with many values; use {} instead of {}\n",
          party.fix->id, remedy, party.scheme.values());
  }
  return false;
}

std::string Bootstrap::names() const
{
  std::vector<std::string> ids;
  for (const auto &party : parties) ids.emplace_back(party.fix->id);
  return utils::join_words(ids, " and ");
}

/// Tries one spacing after the other.  After the call atoms, states and loads are as before.
bool Bootstrap::search(Forces &forces)
{
  std::vector<Bodies::Snapshot> snapshots;
  for (const auto &party : parties) snapshots.push_back(party.bodies->snapshot());
  const auto put_back = [&]() {
    for (size_t p = 0; p < parties.size(); ++p) {
      parties[p].bodies->put_back_states(snapshots[p]);
      parties[p].bodies->put_back_loads(snapshots[p]);
    }
  };
  forces.save();
  bool done = false;
  double spacing = first_spacing();
  for (int n = 0; n < SweepRule::MAX_SPACINGS && !done; ++n, spacing *= 0.5) {
    put_back();
    done = collocate(forces, spacing);
  }
  forces.restore();
  put_back();
  for (auto &party : parties) {
    party.bodies->spread_states();
    party.bodies->place_extended();
  }
  return done;
}

/// Node spacing: the step, or as much of it as keeps every site within half the skin.
double Bootstrap::first_spacing() const
{
  const double span = collocation.pairs() * std::fabs(h);
  double fastest = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (std::none_of(parties.begin(), parties.end(), [i](const Party &party) {
          return party.bodies->in_body(i);
        }))
      continue;
    fastest = std::max(fastest, dot3(atom->v[i], atom->v[i]));
  }
  const double way = span * std::sqrt(over_ranks(MPI_MAX, fastest, world));
  const double reach = 0.25 * neighbor->skin;
  return way > reach ? h * reach / way : h;
}

/// The length that the motion of a body is compared with.
double Bootstrap::length(const Body &body) const
{
  return body.extent > 0.0 ? body.extent : neighbor->skin;
}

/// False, with a reason, if the nodes are too far apart.
bool Bootstrap::collocate(Forces &forces, double spacing)
{
  measure(0);
  for (auto &party : parties) {
    const Bodies &bodies = *party.bodies;
    party.work.resize(bodies.nmoved());
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      collocation.begin(local_series(bodies.rigid_of(ibody), bodies.state_of(ibody),
                                     party.acting(ibody), spacing),
                        party.work[ibody]);
  }

  using Verdict = SweepRule::Verdict;
  Verdict verdict = Verdict::ANOTHER_SWEEP;
  double change = 0.0;
  for (rule.begin_spacing(); verdict == Verdict::ANOTHER_SWEEP;) {
    if (!sweep(forces, spacing, rule.is_first_sweep(), change)) {
      reason = fmt::format("sites would leave the neighbor skin, {}", neighbor->skin);
      return false;
    }
    verdict = rule.judge(change, [this]() {
      return truncation();
    });
  }
  if (verdict == Verdict::SHORTER_SPACING) {
    reason = "forces vary too much within a few steps";
    return false;
  }
  reason.clear();
  if (verdict == Verdict::JUMPS)
    reason = fmt::format(" (forces jump: by {:.1g} of the motion in a step)", change);
  seed_all(spacing);
  return true;
}

void Bootstrap::seed_all(double spacing)
{
  for (auto &party : parties) {
    Bodies &bodies = *party.bodies;
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      seed(party.scheme, bodies.rigid_of(ibody), collocation.series(party.work[ibody]), spacing, h,
           bodies.history(ibody));
    if (!party.isokinetic) continue;
    std::vector<double> heat(party.power.size() + 1);
    collocation.integrate(party.power.data(), spacing, heat.data());
    party.isokinetic->seed_heat(heat.data(), (int) heat.size(), spacing, h);
  }
}

/// The largest truncation error of all bodies.
double Bootstrap::truncation() const
{
  double here = 0.0;
  for (const auto &party : parties)
    for (int ibody = 0; ibody < party.bodies->nmoved(); ++ibody)
      here = std::max(
          here, collocation.truncation(length(party.bodies->body_at(ibody)), party.work[ibody]));
  return over_ranks(MPI_MAX, here, world);
}

/// Forces at all nodes once, outwards.  False, with nothing evaluated there, if a site would leave
/// the skin.
bool Bootstrap::sweep(Forces &forces, double spacing, bool first, double &change)
{
  double here = 0.0;
  for (int pair = 1; pair <= collocation.pairs(); ++pair) {
    for (const int node : {-pair, pair})
      if (!visit(forces, node, spacing, here)) return false;
    if (first && pair < collocation.pairs())
      for (auto &party : parties)
        for (auto &one : party.work) collocation.foretell(pair, one);
  }
  change = over_ranks(MPI_MAX, here, world);
  return true;
}

/// Forces at one node; change: grows to what they change.  False as in sweep().
bool Bootstrap::visit(Forces &forces, int node, double spacing, double &change)
{
  for (auto &party : parties) {
    Bodies &bodies = *party.bodies;
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      bodies.change_state(ibody) = collocation.state_at(node, party.work[ibody], spacing);
    bodies.spread_states();
    bodies.place_sites(true);
  }
  if (forces.largest_displacement() > 0.5 * neighbor->skin) return false;
  forces.evaluate();
  ++evaluations;
  for (auto &party : parties) party.bodies->gather_loads(atom->f, atom->torque);
  measure(node);
  for (auto &party : parties)
    for (int ibody = 0; ibody < party.bodies->nmoved(); ++ibody) {
      const Body &body = party.bodies->body_at(ibody);
      change = std::max(change,
                        collocation.set_load(node, body.rigid, party.bodies->state_of(ibody),
                                             party.acting(ibody), spacing, length(body),
                                             party.work[ibody]));
    }
  return true;
}
