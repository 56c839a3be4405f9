/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_bootstrap.h"

#include "atom.h"
#include "comm.h"
#include "fix.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr int MAX_SWEEPS = 12;
static constexpr int MAX_HALVINGS = 8;

// sweeps end when the next one would change accelerations by less than this, relative to how the
// bodies move: less than rounding takes from their velocities in a step, or than the polynomial of
// the motion leaves out.  A change that no longer falls is taken for rounding of the forces below
// ROUNDING; above, the nodes are too far apart, or forces jump, as at a cut-off.  Which of the two,
// shorter spacings tell; after the last of JUMPING of them a change below JUMP counts as jumps.

static constexpr double CONVERGED = 1.0e-15;
static constexpr double ROUNDING = 1.0e-9;
static constexpr double JUMP = 0.1;
static constexpr int JUMPING = 3;

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
    Pointers(lmp), parties(parties), h(h), collocation(most_values(parties)), evaluations(0),
    jumps(0)
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
  const RigidBody &rigid = bodies.body[ibody].rigid;
  auto series = local_series(rigid, bodies.state[ibody], acting, h);
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
    const int values = party.scheme.values();
    const int most = forces.most_values_with_noise([&party](int i) {
      return party.bodies->in_body(i);
    });
    if (comm->me != 0) continue;
    utils::logmesg(lmp, "Fix gear/quat {}: start with known forces only (order 2), because {}\n",
                   party.fix->id, why);
    if (most > 0 && values > most)
      utils::logmesg(
          lmp,
          "Fix gear/quat {}: random forces heat bodies with many values; values {} suits "
          "them, not {}\n",
          party.fix->id, most == 4 ? "4" : fmt::format("4 to {}", most), values);
  }
  return false;
}

std::string Bootstrap::names() const
{
  std::vector<std::string> ids;
  for (const auto &party : parties) ids.emplace_back(party.fix->id);
  return utils::join_words(ids, " and ");
}

/// Spacing after spacing; after the call atoms, states and loads are as before.
bool Bootstrap::search(Forces &forces)
{
  std::vector<std::vector<BodyState>> states;
  std::vector<std::vector<Load>> loads;
  for (const auto &party : parties) {
    const int n = party.bodies->nmoved();
    states.emplace_back(party.bodies->state.begin(), party.bodies->state.begin() + n);
    loads.emplace_back(party.bodies->load.begin(), party.bodies->load.begin() + n);
  }
  const auto put_back = [&]() {
    for (size_t p = 0; p < parties.size(); ++p) {
      std::copy(states[p].begin(), states[p].end(), parties[p].bodies->state.begin());
      std::copy(loads[p].begin(), loads[p].end(), parties[p].bodies->load.begin());
    }
  };
  forces.save();
  bool done = false;
  double spacing = first_spacing();
  for (int n = 0; n < MAX_HALVINGS && !done; ++n, spacing *= 0.5) {
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
    double v2 = 0.0;
    for (int k = 0; k < 3; ++k) v2 += atom->v[i][k] * atom->v[i][k];
    fastest = std::max(fastest, v2);
  }
  double all;
  MPI_Allreduce(&fastest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  const double reach = 0.25 * neighbor->skin, way = span * std::sqrt(all);
  return way > reach ? h * reach / way : h;
}

/// Size of a body, in units of which its motion is judged.
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
      collocation.begin(
          local_series(bodies.body[ibody].rigid, bodies.state[ibody], party.acting(ibody), spacing),
          party.work[ibody]);
  }

  double change = 0.0;
  bool found = false, stuck = false;
  for (int n = 0; n < MAX_SWEEPS && !found && !stuck; ++n) {
    const double before = change;
    if (!sweep(forces, spacing, n == 0, change)) {
      reason = fmt::format("sites would leave the neighbor skin, {}", neighbor->skin);
      return false;
    }
    const double next = n > 0 && change < before ? change * (change / before) : change;
    found = next < CONVERGED || (n > 0 && next < truncation());
    stuck = !std::isfinite(change) || (n > 1 && change > 0.5 * before);
  }
  reason.clear();
  if (!found && change < ROUNDING) found = true;
  if (!found && change < JUMP && ++jumps == JUMPING) {
    reason = fmt::format(" (forces jump: by {:.1g} of the motion in a step)", change);
    found = true;
  }
  if (!found) {
    reason = "forces vary too much within a few steps";
    return false;
  }
  seed_all(spacing);
  return true;
}

void Bootstrap::seed_all(double spacing)
{
  for (auto &party : parties) {
    Bodies &bodies = *party.bodies;
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      seed(party.scheme, bodies.body[ibody].rigid, collocation.series(party.work[ibody]), spacing,
           h, bodies.history(ibody));
    if (!party.isokinetic) continue;
    std::vector<double> heat(party.power.size() + 1);
    collocation.integrate(party.power.data(), spacing, heat.data());
    party.isokinetic->seed_heat(heat.data(), (int) heat.size(), spacing, h);
  }
}

/// Largest of all bodies.
double Bootstrap::truncation() const
{
  double here = 0.0, all;
  for (const auto &party : parties)
    for (int ibody = 0; ibody < party.bodies->nmoved(); ++ibody)
      here = std::max(here,
                      collocation.truncation(length(party.bodies->body[ibody]), party.work[ibody]));
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
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
  MPI_Allreduce(&here, &change, 1, MPI_DOUBLE, MPI_MAX, world);
  return true;
}

/// Forces at one node; change: grows to what they change.  False as in sweep().
bool Bootstrap::visit(Forces &forces, int node, double spacing, double &change)
{
  for (auto &party : parties) {
    Bodies &bodies = *party.bodies;
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      bodies.state[ibody] = collocation.state_at(node, party.work[ibody], spacing);
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
      const Body &body = party.bodies->body[ibody];
      change = std::max(change,
                        collocation.set_load(node, body.rigid, party.bodies->state[ibody],
                                             party.acting(ibody), spacing, length(body),
                                             party.work[ibody]));
    }
  return true;
}
