/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_start.h"

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

MotionSums GearQuat::sums_by_loads(const Bodies &bodies)
{
  MotionSums here;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    double torque_body[3];
    to_body(bodies.axes(ibody), bodies.acting(ibody).torque_space, torque_body);
    here.add(bodies.rigid_of(ibody), bodies.state_of(ibody), torque_body);
  }
  return here;
}

void Starter::seed_local(int terms, double h)
{
  scheme = choose(sums_by_loads(*bodies));
  if (coupling) {
    coupling->measure();
    coupling->seed_local(h, terms);
  }
  for (int ibody = 0; ibody < bodies->nmoved(); ++ibody)
    seed_body(*bodies, ibody, scaled(ibody), acting(ibody), scheme, h, terms);
}

void GearQuat::seed_body(Bodies &bodies, int ibody, const BodyState &state, const Load &acting,
                         const Scheme &scheme, double h, int terms)
{
  const RigidBody &rigid = bodies.rigid_of(ibody);
  auto series = local_series(rigid, state, acting, h);
  series.terms = terms;
  seed(scheme, rigid, series, h, h, bodies.history(ibody));
}

/* ---------------------------------------------------------------------- */

static int most_start_values(const std::vector<Starter> &starters)
{
  int most = 0;
  for (const auto &one : starters) most = std::max(most, one.scheme.start_values());
  return most;
}

Start::Start(LAMMPS *lmp, const std::vector<Starter> &starters, double h) :
    Pointers(lmp), starters(starters), h(h), collocation(most_start_values(starters))
{
}

/* ---------------------------------------------------------------------- */

bool Start::run()
{
  std::vector<const Fix *> owners;
  for (const auto &one : starters) owners.push_back(one.fix);
  Forces forces(lmp, owners);
  std::string why = forces.reason();
  if (why.empty()) {
    const StartFound start = search(forces);
    if (start.verdict != StartPlan::Verdict::SHORTER_SPACING) {
      const bool any = std::any_of(starters.begin(), starters.end(), [](const auto &one) {
        return one.bodies->number() > 0;
      });
      if (comm->me == 0 && any)
        utils::logmesg(lmp, "Fix gear/quat {}: start of order {} from {} force evaluations{}\n",
                       names(), orders(start), evaluations, reason);
      return true;
    }
    why = reason;
  }
  for (auto &one : starters) {
    if (!one.needed) continue;
    one.seed_local(3, h);
    if (comm->me != 0) continue;
    utils::logmesg(lmp, "Fix gear/quat {}: start with known forces only (order 2), because {}\n",
                   one.fix->id, why);
  }
  return false;
}

std::string Start::names() const
{
  std::vector<std::string> ids;
  for (const auto &one : starters) ids.emplace_back(one.fix->id);
  return utils::join_words(ids, " and ");
}

/// True if forces become discontinuous so early that a history starts with a reduced order.
bool Start::lowers_order(const StartFound &start) const
{
  return start.verdict == StartPlan::Verdict::JUMPS &&
      std::any_of(starters.begin(), starters.end(), [&start](const auto &one) {
           return start.order() < one.scheme.order();
         });
}

/// The initial orders of the histories.
std::string Start::orders(const StartFound &start) const
{
  std::string orders;
  for (const auto &one : starters) {
    const int full = one.scheme.order();
    const std::string order =
        std::to_string(lowers_order(start) ? std::min(full, start.order()) : full);
    if (orders.empty() || orders != order) orders += (orders.empty() ? "" : " and ") + order;
  }
  return orders;
}

/* ---------------------------------------------------------------------- */

/// The number of pairs of nodes needed for a choice of the number of values.
static constexpr int PAIRS_THAT_TELL = 2;

/// The host of find_start().
struct Start::Search {
  Start &our;
  Forces &forces;
  const double skin;
  std::vector<Bodies::Snapshot> snapshots = {};
  double spacing = 0.0;

  Search(Start &our, Forces &forces) : our(our), forces(forces), skin(our.neighbor->skin)
  {
    for (const auto &one : our.starters) snapshots.push_back(one.bodies->snapshot());
  }

  StartNodes nodes() const { return {our.collocation, spacing, our.h}; }

  void put_back()
  {
    for (size_t p = 0; p < our.starters.size(); ++p) {
      our.starters[p].bodies->put_back_states(snapshots[p]);
      our.starters[p].bodies->put_back_loads(snapshots[p]);
      if (our.starters[p].coupling) our.starters[p].coupling->leave_nodes();
    }
  }

  /// The length scale for the motion of a body.
  double length(const Body &body) const { return body.extent > 0.0 ? body.extent : skin; }

  void begin(double of)
  {
    spacing = of;
    our.reason = "forces vary too much within a few steps";
    put_back();
    for (auto &one : our.starters) {
      const Bodies &bodies = *one.bodies;
      if (one.coupling) {
        one.coupling->measure();
        one.coupling->begin_start(nodes());
      }
      one.work.begin(bodies.nmoved());
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
        our.collocation.begin(
            bodies.rigid_of(ibody),
            local_series(bodies.rigid_of(ibody), one.scaled(ibody), one.acting(ibody), spacing),
            one.work[ibody]);
    }
  }

  void foretell()
  {
    for (auto &one : our.starters) {
      for (auto &work : one.work.all()) our.collocation.foretell(work);
      if (one.coupling) one.coupling->foretell(nodes());
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
    for (auto &one : our.starters) {
      for (auto &work : one.work.all()) our.collocation.settle(pair, work);
      if (one.coupling) one.coupling->settle(nodes(), pair);
    }
    change = over_ranks(MPI_MAX, here, our.world);
    return true;
  }

  /// The result of choose().
  int values_that_do(int values) const
  {
    if (std::any_of(our.starters.begin(), our.starters.end(), [](const Starter &one) {
          return !one.foresee;
        }))
      return values;
    int most = 0;
    for (size_t p = 0; p < our.starters.size(); ++p) {
      const MotionSums here = our.sums_of(our.starters[p], snapshots[p], PAIRS_THAT_TELL, spacing);
      most = std::max(most, our.starters[p].foresee(here).start_values());
    }
    return std::min(values, most);
  }

  /// Evaluates forces in boxes around the box of the start.
  void probe()
  {
    for (const int side : {-1, 1}) {
      put_back();
      int vflag = 0;
      for (auto &one : our.starters) {
        if (one.coupling) one.coupling->enter_probe(side);
        if (one.coupling) vflag |= one.coupling->vflag();
        one.ownership->spread_states();
        one.sites->place(true);
      }
      forces.evaluate(0, vflag);
      ++our.evaluations;
      for (auto &one : our.starters) {
        one.sites->gather_loads(our.atom->f, our.atom->torque);
        if (!one.coupling) continue;
        one.coupling->meet_virial(our.atom->f);
        one.coupling->leave_probe(side);
      }
    }
  }

  /// Evaluates forces at one node; change: increased to the largest change.  False, without an
  /// evaluation, if a site would leave the skin.
  bool visit_node(int node, double &change)
  {
    for (auto &one : our.starters) {
      Bodies &bodies = *one.bodies;
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
        bodies.change_state(ibody) = our.collocation.state_at(node, one.work[ibody], spacing);
      if (one.coupling) one.coupling->enter_node(nodes(), node);
      one.ownership->spread_states();
      one.sites->place(true);
    }
    if (forces.largest_displacement() > 0.5 * skin) return false;
    int vflag = 0;
    for (auto &one : our.starters)
      if (one.coupling) vflag |= one.coupling->vflag();
    forces.evaluate(0, vflag);
    ++our.evaluations;
    for (auto &one : our.starters) one.sites->gather_loads(our.atom->f, our.atom->torque);
    for (auto &one : our.starters) {
      if (!one.coupling) continue;
      one.coupling->meet_virial(our.atom->f);
      one.coupling->visit_node(nodes(), node);
    }
    for (auto &one : our.starters)
      for (int ibody = 0; ibody < one.bodies->nmoved(); ++ibody) {
        const Body &body = one.bodies->body_at(ibody);
        const BodyState &state = one.bodies->state_of(ibody);
        change = std::max(change,
                          our.collocation.set_load(node, body.rigid, state, one.acting(ibody),
                                                   spacing, length(body), one.work[ibody]));
      }
    return true;
  }
};

/// After the call atoms, states and loads are as before.
StartFound Start::search(Forces &forces)
{
  forces.save();
  Search all(*this, forces);
  const bool coupled = std::any_of(starters.begin(), starters.end(), [](const Starter &one) {
    return one.coupling != nullptr;
  });
  const StartFound start = find_start(most_start_values(starters), first_spacing(), all,
                                      coupled ? StartPlan::COUPLED : 0.0);
  if (start.verdict != StartPlan::Verdict::SHORTER_SPACING) {
    reason.clear();
    choose(start, all.snapshots);
    if (lowers_order(start))
      reason = fmt::format(", because forces change suddenly, by {:.1g} of the motion in a step",
                           start.change);
    seed_all(start);
    if (std::any_of(starters.begin(), starters.end(), [](const Starter &one) {
          return one.coupling && one.coupling->probes();
        }))
      all.probe();
  }
  forces.restore();
  all.put_back();
  for (auto &one : starters) {
    one.ownership->spread_states();
    one.sites->place_extended();
  }
  return start;
}

/// Node spacing: the step, shortened if necessary to keep every site within half the skin, and the
/// rotation of every body from its outermost node below 1 radian.
double Start::first_spacing() const
{
  constexpr double LARGEST_TURN = 1.0;
  const double span = collocation.pairs() * std::fabs(h), reach = 0.25 * neighbor->skin;
  double longest = 1.0;    // in units of these limits
  for (int i = 0; i < atom->nlocal; ++i)
    if (std::any_of(starters.begin(), starters.end(), [i](const Starter &one) {
          return one.ownership->in_body(i);
        }))
      longest = std::max(longest, span * length(atom->v[i]) / reach);
  for (const auto &one : starters)
    for (int ibody = 0; ibody < one.bodies->nowned(); ++ibody)
      longest =
          std::max(longest, span * length(one.bodies->state_of(ibody).omega_body) / LARGEST_TURN);
  return h / over_ranks(MPI_MAX, longest, world);
}

/// Sums from the derivatives of this number of pairs, with the states of the start.
MotionSums Start::sums_of(const Starter &one, const Bodies::Snapshot &snapshot, int pairs,
                          double spacing) const
{
  MotionSums here;
  for (int ibody = 0; ibody < one.bodies->nowned(); ++ibody)
    here.add(one.bodies->rigid_of(ibody), snapshot.states[ibody],
             collocation.series(one.work[ibody], pairs), spacing);
  return here;
}

void Start::choose(const StartFound &start, const std::vector<Bodies::Snapshot> &snapshots)
{
  for (size_t p = 0; p < starters.size(); ++p) {
    Starter &one = starters[p];
    const int pairs = std::min(start.pairs, PAIRS_THAT_TELL);
    one.scheme = one.choose(sums_of(one, snapshots[p], pairs, start.spacing));
  }
}

/// Histories of all bodies from the polynomials.
void Start::seed_all(const StartFound &start)
{
  for (auto &one : starters) {
    Bodies &bodies = *one.bodies;
    for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
      seed(one.scheme, bodies.rigid_of(ibody), collocation.series(one.work[ibody], start.pairs),
           start.spacing, h, bodies.history(ibody));
    if (one.coupling)
      one.coupling->seed({collocation, start.spacing, h}, start.pairs, one.scheme.values());
  }
}
