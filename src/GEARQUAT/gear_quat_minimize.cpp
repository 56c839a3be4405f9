/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_minimize.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

void Minimization::init()
{
  if (!utils::strmatch(update->minimize_style, "^cg") &&
      !utils::strmatch(update->minimize_style, "^sd"))
    error->all(
        FLERR,
        "Fix gear/quat cannot be used with min_style {}, which does not let fixes take part; "
        "use min_style cg or sd",
        update->minimize_style);
}

void Minimization::begin()
{
  std::vector<ArmSums> sums(bodies.nhere());
  for (const Site &site : sites) {
    const double *d = site.arm_body;
    add3(d, sums[site.body].arm);
    for (int n = 0; n < 9; ++n) sums[site.body].products[n] += d[n / 3] * d[n % 3];
  }
  ownership.sum(sums);
  tagint bad = 0;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    stored(ibody).arms = sums[ibody];
    const Load load = bodies.acting(ibody);
    if (!std::isfinite(length(load.force) + length(load.torque_space)))
      bad = bodies.body_at(ibody).id;
  }
  bad = over_ranks(MPI_MAX, bad, world);
  if (bad)
    error->all(FLERR,
               "Fix gear/quat: the force or torque on body {} is not a number, so it cannot be "
               "minimized; atoms must not be in the same place (see delete_atoms overlap)",
               bad);
}

void Minimization::fit()
{
  std::vector<Displacements> sums(bodies.nhere());
  for (const Site &site : sites) {
    Displacements &sum = sums[site.body];
    double found[3], expected[3], arm[3];
    sites.unwrapped(site, found, expected);
    to_space(bodies.axes(site.body), site.arm_body, arm);
    for (int a = 0; a < 3; ++a) {
      const double way = found[a] - expected[a];
      sum.way[a] += way;
      for (int b = 0; b < 3; ++b) sum.products[3 * a + b] += way * arm[b];
    }
  }
  ownership.sum(sums);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const Move move = nearest_move(arms_of(ibody), bodies.body_at(ibody).off, sums[ibody]);
    BodyState &s = bodies.change_state(ibody);
    double q[4];
    w_times(move.rotation, s.q, q);
    std::copy_n(q, 4, s.q);
    add3(move.way, s.center);
    bodies.update_frame(ibody);
  }
  ownership.spread_moved();
  sites.place(false);
}

void Minimization::project(double **f)
{
  std::vector<Twist> twists(bodies.nhere());
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    Load load = bodies.load_of(ibody);
    for (int k = 0; k < 3; ++k) {
      load.force[k] /= force->ftm2v;
      load.torque_space[k] /= force->ftm2v;
    }
    twists[ibody] = nearest_twist(arms_of(ibody), bodies.body_at(ibody).off, load);
  }
  ownership.spread(twists);
  for (const Site &site : sites) {
    const Twist &of_body = twists[site.body];
    double arm[3];
    to_space(bodies.axes(site.body), site.arm_body, arm);
    cross3(of_body.turn, arm, f[site.atom]);
    add3(of_body.way, f[site.atom]);
  }
}

void Minimization::store()
{
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const BodyState &s = bodies.state_of(ibody);
    std::copy_n(s.center, 3, stored(ibody).center);
    std::copy_n(s.q, 4, stored(ibody).q);
  }
}

void Minimization::put_back()
{
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    BodyState &s = bodies.change_state(ibody);
    std::copy_n(stored(ibody).center, 3, s.center);
    std::copy_n(stored(ibody).q, 4, s.q);
    bodies.update_frame(ibody);
  }
}
