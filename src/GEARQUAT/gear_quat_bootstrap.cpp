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

GearQuatBootstrap::GearQuatBootstrap(LAMMPS *lmp, const Fix *fix, GearQuatBodies &bodies,
                                     GearQuatIsokinetic *isokinetic, const Scheme &scheme,
                                     double h) :
    Pointers(lmp),
    fix(fix), bodies(bodies), isokinetic(isokinetic), scheme(scheme), h(h),
    collocation(scheme.values()), evaluations(0), jumps(0),
    power(collocation.number_of_nodes(), 0.0)
{
}

/// States and loads are those of a node: what the constraint makes of them.
void GearQuatBootstrap::measure(int node)
{
  if (!isokinetic) return;
  isokinetic->measure();
  power[collocation.pairs() + node] = isokinetic->power();
}

/// What moves a body, after measure().
Load GearQuatBootstrap::acting(int ibody) const
{
  return isokinetic ? isokinetic->acting(ibody) : bodies.acting(ibody);
}

void GearQuatBootstrap::zero()
{
  seed_local(2);
}

void GearQuatBootstrap::seed_local(int terms)
{
  measure(0);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    seed_body(bodies, ibody, acting(ibody), scheme, h, terms);
  if (isokinetic) {
    const double heat[2] = {0.0, h * isokinetic->power()};
    isokinetic->seed_heat(heat, 2, h, h);
  }
}

void GearQuatBootstrap::seed_body(GearQuatBodies &bodies, int ibody, const Load &acting,
                                  const Scheme &scheme, double h, int terms)
{
  const RigidBody &rigid = bodies.body[ibody].rigid;
  auto series = local_series(rigid, bodies.state[ibody], acting, h);
  series.terms = terms;
  seed(scheme, rigid, series, h, h, bodies.history(ibody));
}

/* ---------------------------------------------------------------------- */

bool GearQuatBootstrap::run()
{
  GearQuatForces forces(lmp, fix);
  std::string why = forces.reason();
  bool done = false;
  if (why.empty()) {
    const std::vector<BodyState> states(bodies.state.begin(),
                                        bodies.state.begin() + bodies.nmoved());
    const std::vector<Load> loads(bodies.load.begin(), bodies.load.begin() + bodies.nmoved());
    forces.save();
    double spacing = first_spacing();
    for (int n = 0; n < MAX_HALVINGS && !done; ++n, spacing *= 0.5) {
      std::copy(states.begin(), states.end(), bodies.state.begin());
      std::copy(loads.begin(), loads.end(), bodies.load.begin());
      done = collocate(forces, spacing);
    }
    why = reason;
    forces.restore();
    std::copy(states.begin(), states.end(), bodies.state.begin());
    std::copy(loads.begin(), loads.end(), bodies.load.begin());
    bodies.spread_states();
    bodies.place_extended();
  }
  if (done) {
    if (comm->me == 0)
      utils::logmesg(lmp, "Fix gear/quat {}: start of order {} from {} force evaluations{}\n",
                     fix->id, scheme.order(), evaluations, reason);
    return true;
  }
  seed_local(3);
  if (comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat {}: start with known forces only (order 2), because {}\n",
                   fix->id, why);
  return false;
}

/// Node spacing: the step, or as much of it as keeps every site within half the skin.
double GearQuatBootstrap::first_spacing() const
{
  const double span = collocation.pairs() * std::fabs(h);
  double fastest = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!bodies.in_body(i)) continue;
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
double GearQuatBootstrap::length(const GearQuatBody &body) const
{
  return body.extent > 0.0 ? body.extent : neighbor->skin;
}

/// False, with a reason, if the nodes are too far apart.
bool GearQuatBootstrap::collocate(GearQuatForces &forces, double spacing)
{
  measure(0);
  work.resize(bodies.nmoved());
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    collocation.begin(
        local_series(bodies.body[ibody].rigid, bodies.state[ibody], acting(ibody), spacing),
        work[ibody]);

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
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    seed(scheme, bodies.body[ibody].rigid, collocation.series(work[ibody]), spacing, h,
         bodies.history(ibody));
  if (isokinetic) {
    std::vector<double> heat(power.size() + 1);
    collocation.integrate(power.data(), spacing, heat.data());
    isokinetic->seed_heat(heat.data(), (int) heat.size(), spacing, h);
  }
  return true;
}

/// Largest of all bodies.
double GearQuatBootstrap::truncation() const
{
  double here = 0.0, all;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    here = std::max(here, collocation.truncation(length(bodies.body[ibody]), work[ibody]));
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}

/// Forces at all nodes once, outwards.  False, with nothing evaluated there, if a site would leave
/// the skin.
bool GearQuatBootstrap::sweep(GearQuatForces &forces, double spacing, bool first, double &change)
{
  double here = 0.0;
  for (int pair = 1; pair <= collocation.pairs(); ++pair) {
    for (const int node : {-pair, pair})
      if (!visit(forces, node, spacing, here)) return false;
    if (first && pair < collocation.pairs())
      for (auto &one : work) collocation.foretell(pair, one);
  }
  MPI_Allreduce(&here, &change, 1, MPI_DOUBLE, MPI_MAX, world);
  return true;
}

/// Forces at one node; change: grows to what they change.  False as in sweep().
bool GearQuatBootstrap::visit(GearQuatForces &forces, int node, double spacing, double &change)
{
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    bodies.state[ibody] = collocation.state_at(node, work[ibody], spacing);
  bodies.spread_states();
  bodies.place_sites(true);
  if (forces.largest_displacement() > 0.5 * neighbor->skin) return false;
  forces.evaluate();
  ++evaluations;
  bodies.gather_loads(atom->f, atom->torque);
  measure(node);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const GearQuatBody &body = bodies.body[ibody];
    change = std::max(change,
                      collocation.set_load(node, body.rigid, bodies.state[ibody], acting(ibody),
                                           spacing, length(body), work[ibody]));
  }
  return true;
}
