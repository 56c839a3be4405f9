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
  if (thermostat) thermostat->measure();
}

Load Party::acting(int ibody) const
{
  if (isokinetic) return isokinetic->acting(ibody);
  return thermostat ? thermostat->acting(ibody) : bodies->acting(ibody);
}

void Party::seed_local(int terms, double h)
{
  measure();
  if (thermostat) thermostat->seed_local(h);
  for (int ibody = 0; ibody < bodies->nmoved(); ++ibody)
    Bootstrap::seed_body(*bodies, ibody, acting(ibody), scheme, h, terms);
  if (isokinetic) {
    const double heat[2] = {0.0, h * isokinetic->power()};
    isokinetic->seed_heat(heat, 2, h, h);
  }
}

/* ---------------------------------------------------------------------- */

static int most_start_values(const std::vector<Party> &parties)
{
  int most = 0;
  for (const auto &party : parties) most = std::max(most, party.scheme.start_values());
  return most;
}

Bootstrap::Bootstrap(LAMMPS *lmp, const std::vector<Party> &parties, double h) :
    Pointers(lmp), parties(parties), h(h), collocation(most_start_values(parties))
{
  for (auto &party : this->parties) party.power.assign(collocation.number_of_nodes(), 0.0);
}

void Bootstrap::measure(int node)
{
  for (auto &party : parties) {
    if (node == 0 || !party.thermostat)
      party.measure();
    else
      party.thermostat->measure_node(collocation, node);
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
  for (const auto &party : parties) owners.push_back(party.fix);
  Forces forces(lmp, owners);
  std::string why = forces.reason();
  if (why.empty()) {
    const StartFound start = search(forces);
    if (start.verdict != StartPlan::Verdict::SHORTER_SPACING) {
      const bool any = std::any_of(parties.begin(), parties.end(), [](const auto &party) {
        return party.bodies->number() > 0;
      });
      if (comm->me == 0 && any)
        utils::logmesg(lmp, "Fix gear/quat {}: start of order {} from {} force evaluations{}\n",
                       names(), orders(start), evaluations, reason);
      return true;
    }
    why = reason;
  }
  for (auto &party : parties) {
    if (!party.needed) continue;
    party.seed_local(3, h);
    const Noise noise = forces.noise([&party](int i) {
      return party.ownership->in_body(i);
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

/// True if forces jump so early that a history begins with a lower order than it can keep.
bool Bootstrap::lowers_order(const StartFound &start) const
{
  return start.verdict == StartPlan::Verdict::JUMPS &&
      std::any_of(parties.begin(), parties.end(), [&start](const auto &party) {
           return start.order() < party.scheme.order();
         });
}

/// Those that the histories begin with.
std::string Bootstrap::orders(const StartFound &start) const
{
  std::string orders;
  for (const auto &party : parties) {
    const int full = party.scheme.order();
    const std::string order =
        std::to_string(lowers_order(start) ? std::min(full, start.order()) : full);
    if (orders.empty() || orders != order) orders += (orders.empty() ? "" : " and ") + order;
  }
  return orders;
}

/* ---------------------------------------------------------------------- */

/// What find_start() asks of LAMMPS.
struct Bootstrap::Search {
  Bootstrap &our;
  Forces &forces;
  const double skin;
  std::vector<Bodies::Snapshot> snapshots = {};
  double spacing = 0.0;

  Search(Bootstrap &our, Forces &forces) : our(our), forces(forces), skin(our.neighbor->skin)
  {
    for (const auto &party : our.parties) snapshots.push_back(party.bodies->snapshot());
  }

  void put_back()
  {
    for (size_t p = 0; p < our.parties.size(); ++p) {
      our.parties[p].bodies->put_back_states(snapshots[p]);
      our.parties[p].bodies->put_back_loads(snapshots[p]);
    }
  }

  /// The length that the motion of a body is compared with.
  double length(const Body &body) const { return body.extent > 0.0 ? body.extent : skin; }

  void begin(double of)
  {
    spacing = of;
    our.reason = "forces vary too much within a few steps";
    put_back();
    our.measure(0);
    for (auto &party : our.parties) {
      const Bodies &bodies = *party.bodies;
      if (party.thermostat) party.thermostat->begin_start(our.collocation, spacing, our.h);
      party.work.resize(bodies.nmoved());
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
        our.collocation.begin(local_series(bodies.rigid_of(ibody), bodies.state_of(ibody),
                                           party.acting(ibody), spacing),
                              party.work[ibody]);
    }
  }

  void foretell()
  {
    for (auto &party : our.parties) {
      for (auto &work : party.work) our.collocation.foretell(work);
      if (party.thermostat) party.thermostat->foretell(our.collocation);
    }
  }

  bool visit(int pair, double &change)
  {
    double here = 0.0;
    for (const int node : {-pair, pair})
      if (!visit_node(node, here)) {
        our.reason = fmt::format("sites would leave the neighbor skin, {}", skin);
        return false;
      }
    for (auto &party : our.parties) {
      for (auto &work : party.work) our.collocation.settle(pair, work);
      if (party.thermostat) party.thermostat->settle(our.collocation, pair);
    }
    change = over_ranks(MPI_MAX, here, our.world);
    return true;
  }

  /// Forces at one node; change: grows to what they change.  False, with nothing evaluated, if a
  /// site would leave the skin.
  bool visit_node(int node, double &change)
  {
    for (auto &party : our.parties) {
      Bodies &bodies = *party.bodies;
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
        bodies.change_state(ibody) = our.collocation.state_at(node, party.work[ibody], spacing);
      party.ownership->spread_states();
      party.sites->place(true);
    }
    if (forces.largest_displacement() > 0.5 * skin) return false;
    forces.evaluate();
    ++our.evaluations;
    for (auto &party : our.parties) party.sites->gather_loads(our.atom->f, our.atom->torque);
    our.measure(node);
    for (auto &party : our.parties)
      for (int ibody = 0; ibody < party.bodies->nmoved(); ++ibody) {
        const Body &body = party.bodies->body_at(ibody);
        const BodyState &state = party.bodies->state_of(ibody);
        change = std::max(change,
                          our.collocation.set_load(node, body.rigid, state, party.acting(ibody),
                                                   spacing, length(body), party.work[ibody]));
      }
    return true;
  }
};

/// After the call atoms, states and loads are as before.
StartFound Bootstrap::search(Forces &forces)
{
  forces.save();
  Search all(*this, forces);
  const StartFound start = find_start(most_start_values(parties), first_spacing(), all);
  const double copies = 3.0 * sizeof(double) * (atom->torque_flag ? 4 : 3) *
      (atom->nlocal + atom->nghost);    // positions, velocities, forces
  for (auto &party : parties)
    party.ownership->note_scratch(party.work.capacity() * sizeof(Collocation::Workspace) + copies);
  if (start.verdict != StartPlan::Verdict::SHORTER_SPACING) {
    reason.clear();
    if (lowers_order(start))
      reason = fmt::format(", because forces vary in jumps, by {:.1g} of the motion in a step",
                           start.change);
    seed_all(start);
  }
  forces.restore();
  all.put_back();
  for (auto &party : parties) {
    party.ownership->spread_states();
    party.sites->place_extended();
  }
  return start;
}

/// Node spacing: the step, or as much of it as keeps every site within half the skin.
double Bootstrap::first_spacing() const
{
  const double span = collocation.pairs() * std::fabs(h);
  double fastest = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (std::none_of(parties.begin(), parties.end(), [i](const Party &party) {
          return party.ownership->in_body(i);
        }))
      continue;
    fastest = std::max(fastest, dot3(atom->v[i], atom->v[i]));
  }
  const double way = span * std::sqrt(over_ranks(MPI_MAX, fastest, world));
  const double reach = 0.25 * neighbor->skin;
  return way > reach ? h * reach / way : h;
}

/// Histories of all bodies from the polynomials that were found.
void Bootstrap::seed_all(const StartFound &start)
{
  for (auto &party : parties) {
    Bodies &bodies = *party.bodies;
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      seed(party.scheme, bodies.rigid_of(ibody), collocation.series(party.work[ibody], start.pairs),
           start.spacing, h, bodies.history(ibody));
    if (party.thermostat) party.thermostat->seed(collocation, start.pairs, party.scheme.values());
    if (!party.isokinetic) continue;
    std::vector<double> heat(party.power.size() + 1);
    const int terms =
        collocation.integrate(party.power.data(), start.pairs, start.spacing, heat.data());
    party.isokinetic->seed_heat(heat.data(), terms, start.spacing, h);
  }
}
