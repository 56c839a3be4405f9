/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_bootstrap.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr int MAX_SWEEPS = 12;
static constexpr int MAX_HALVINGS = 8;

// sweeps end when no node would move by more than this, in units of the body's size and in radians

static constexpr double CONVERGED = 1.0e-14;

/* ---------------------------------------------------------------------- */

GearQuatBootstrap::GearQuatBootstrap(LAMMPS *lmp, const Fix *fix, GearQuatBodies &bodies,
                                     const Scheme &scheme, double h) :
    Pointers(lmp),
    fix(fix), bodies(bodies), scheme(scheme), h(h)
{
}

void GearQuatBootstrap::zero()
{
  seed_local(2);
}

void GearQuatBootstrap::seed_local(int terms)
{
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.body[ibody].rigid;
    auto series = local_series(rigid, bodies.state[ibody], bodies.load[ibody], h);
    series.terms = terms;
    seed(scheme, rigid, series, h, h, bodies.history(ibody));
  }
}

void GearQuatBootstrap::gather_present_loads(LAMMPS *lmp, const Fix *fix, GearQuatBodies &bodies)
{
  GearQuatForces forces(lmp, fix);
  bodies.spread_states();
  forces.save();
  forces.evaluate();
  bodies.gather_loads(lmp->atom->f);
  forces.restore();
}

/* ---------------------------------------------------------------------- */

void GearQuatBootstrap::run()
{
  GearQuatForces forces(lmp, fix);
  std::string why = forces.reason();
  bool done = false;
  if (why.empty()) {
    const std::vector<BodyState> states(bodies.state.begin(),
                                        bodies.state.begin() + bodies.nowned());
    const std::vector<Load> loads(bodies.load.begin(), bodies.load.begin() + bodies.nowned());
    forces.save();
    double spacing = first_spacing();
    for (int n = 0; n < MAX_HALVINGS && !done; ++n, spacing *= 0.5) {
      std::copy(states.begin(), states.end(), bodies.state.begin());
      std::copy(loads.begin(), loads.end(), bodies.load.begin());
      done = collocate(forces, spacing, why);
    }
    forces.restore();
    std::copy(states.begin(), states.end(), bodies.state.begin());
    std::copy(loads.begin(), loads.end(), bodies.load.begin());
    bodies.spread_states();
  }
  if (done) return;
  seed_local(3);
  if (comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat: start with known forces only (order 2), because {}\n", why);
}

/// Node spacing: the step, or as much of it as keeps every site within half the skin.
double GearQuatBootstrap::first_spacing() const
{
  const double span = Collocation::HALF * std::fabs(h);
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

/// False if the nodes are too far apart, by displacement or by convergence.
bool GearQuatBootstrap::collocate(GearQuatForces &forces, double spacing, std::string &why)
{
  work.resize(bodies.nowned());
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    collocation.begin(
        local_series(bodies.body[ibody].rigid, bodies.state[ibody], bodies.load[ibody], spacing),
        work[ibody]);

  double change = 0.0;
  for (int n = 0; n < MAX_SWEEPS; ++n) {
    const double before = change;
    if (!sweep(forces, spacing, change)) {
      why = "sites would leave the neighbor skin, " + std::to_string(neighbor->skin);
      return false;
    }
    if (!std::isfinite(change)) break;
    // rounding of the forces may keep a small change alive
    const bool settled = n > 1 && change < 1.0e-11 && change > 0.5 * before;
    if (change < CONVERGED || settled) {
      for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
        seed(scheme, bodies.body[ibody].rigid, collocation.series(work[ibody]), spacing, h,
             bodies.history(ibody));
      return true;
    }
  }
  why = "forces vary too much within a few steps";
  return false;
}

/// Forces at all nodes once.  False, with nothing evaluated there, if a site would leave the skin.
bool GearQuatBootstrap::sweep(GearQuatForces &forces, double spacing, double &change)
{
  double here = 0.0;
  for (int node = 0; node < Collocation::NODES; ++node) {
    if (node == Collocation::HALF) continue;
    for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
      bodies.state[ibody] = collocation.state_at(node, work[ibody], spacing);
    bodies.spread_states();
    bodies.place_sites();
    if (forces.largest_displacement() > 0.5 * neighbor->skin) return false;
    forces.evaluate();
    bodies.gather_loads(atom->f);
    for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
      const GearQuatBody &body = bodies.body[ibody];
      const double length = body.extent > 0.0 ? body.extent : neighbor->skin;
      here = std::max(here,
                      collocation.set_load(node, body.rigid, bodies.state[ibody],
                                           bodies.load[ibody], spacing, length, work[ibody]));
    }
  }
  MPI_Allreduce(&here, &change, 1, MPI_DOUBLE, MPI_MAX, world);
  return true;
}
