/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_isokinetic.h"

#include "gear_quat_ranks.h"

#include "error.h"
#include "force.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

IsokineticConstraint::IsokineticConstraint(LAMMPS *lmp, Bodies &bodies, const Scheme &scheme,
                                           Isokinetic mode, bool rescale) :
    Coupling(lmp, bodies),
    scheme(scheme), mode(mode), scales(rescale), heat_at_nodes()
{
}

/// Sums the contributions of owned bodies over all ranks, and resets the local sums.
void IsokineticConstraint::sum()
{
  constexpr size_t N = sizeof(KineticSums) / sizeof(double);
  reduce(MPI_SUM, &here.force_power, &sums.force_power, N, world);
  here = KineticSums();
  alpha = multipliers(mode, sums);
  of_all = alpha;
}

void IsokineticConstraint::measure()
{
  here = KineticSums();
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    here.add(bodies.rigid_of(ibody), bodies.load_of(ibody), bodies.state_of(ibody));
  sum();
}

void IsokineticConstraint::begin_run(bool anew, double /*h*/)
{
  measure();
  refuse_rest();
  if (!anew && counted == bodies.number()) return;
  target = sums;
  counted = bodies.number();
}

/// Without kinetic energy the multiplier is undefined.
void IsokineticConstraint::refuse_rest() const
{
  int turn = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    if (bodies.rigid_of(ibody).rotational_freedoms() > 0) turn = 1;
  turn = over_ranks(MPI_MAX, turn, world);

  const bool separate = mode == Isokinetic::SEPARATE;
  const char *missing =
      part_at_rest({sums.translation, sums.rotation}, {true, turn != 0}, separate);
  if (missing)
    error->all(FLERR,
               "Fix gear/quat isokinetic {}: the {}kinetic energy of the bodies is zero and would "
               "stay so; give them velocities first",
               separate ? "separate" : "total", missing);
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

/// In all passes torques are evaluated at the predicted pose.
void IsokineticConstraint::add_prediction(const Integrator &, int ibody,
                                          const Integrator::Pending &pending)
{
  const BodyState &s = bodies.state_of(ibody);
  add(ibody, s.velocity, s.omega_body, pending);
}

void IsokineticConstraint::end_passes(const Integrator &integrator)
{
  sum();
  heat.advance(integrator, sums.power());
  if (counted != bodies.number()) {    // some were removed, with their energy
    target = sums;
    counted = bodies.number();
  }
  factor = scale_factors(mode, target, sums);
  if (scales)
    heat.add(0.5 * (sums.translation + sums.rotation - target.translation - target.rotation));
}

/* ----------------------------------------------------------------------
   the start: the power of all forces at the nodes
------------------------------------------------------------------------- */

void IsokineticConstraint::begin_start(const StartNodes &nodes)
{
  nodes.collocation.begin(0.0, sums.power(), heat_at_nodes);
}

void IsokineticConstraint::visit_node(const StartNodes &nodes, int node)
{
  measure();
  nodes.collocation.set_rate(node, sums.power(), heat_at_nodes);
}

void IsokineticConstraint::seed(const StartNodes &nodes, int pairs, int /*values*/)
{
  double series[Collocation::MAX_NODES + 1];
  const int terms = nodes.collocation.series(heat_at_nodes, pairs, nodes.spacing, series);
  heat.seed(series, terms, nodes.spacing, nodes.h, scheme.values());
}

void IsokineticConstraint::seed_local(double h, int /*terms*/)
{
  const double series[2] = {0.0, h * sums.power()};
  heat.seed(series, 2, h, h, scheme.values());
}

double IsokineticConstraint::element(int n)
{
  if (n == HEAT) return heat.value() * force->mvv2e;
  return n == ALPHA_TRANSLATION ? alpha.translation : alpha.rotation;
}
