/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The assembly of bodies: principal axes, their directions, and the rotation. */

#include "gear_quat_assembly.h"

#include "domain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double ON_AXIS = 1.0e-6;    // of the body's size: neither side

/// Principal moments and axes, the latter without directions.
void Assembly::find_axes(int part, const Momenta &momenta)
{
  double tensor[9];
  const MomentaUnits unit = units_of_momenta(part);
  for (int m = 0; m < 6; ++m)
    tensor[3 * ROW[m] + COLUMN[m]] = tensor[3 * COLUMN[m] + ROW[m]] =
        momenta.inertia_space[m].value(unit.inertia);
  Made &one = made[part];
  if (one.body.from_file) {
    const double *i = given.at(one.body.id).inertia;
    const double given_tensor[9] = {i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2]};
    std::copy_n(given_tensor, 9, tensor);
  }
  double *moments = one.body.rigid.inertia;
  principal_axes(tensor, moments, one.axes);
  check_moments(one);
  drop_vanishing_moments(moments);
  // in two dimensions the z axis stays where it is, exactly
  if (domain->dimension == 3) sort_axes(moments, one.axes);
}

/// Orientation and angular velocity.
void Assembly::find_rotation(int part, const Momenta &momenta)
{
  Made &one = made[part];
  const double *moments = one.body.rigid.inertia;
  const MomentaUnits unit = units_of_momenta(part);
  double momentum_space[3], momentum_body[3];
  for (int k = 0; k < 3; ++k)
    momentum_space[k] = one.body.from_file ? given.at(one.body.id).angular_momentum_space[k]
                                           : momenta.angular_momentum_space[k].value(unit.momentum);
  quaternion_from_matrix(one.axes, one.state.q);
  to_body(one.axes, momentum_space, momentum_body);
  for (int k = 0; k < 3; ++k)
    one.state.omega_body[k] = moments[k] > 0.0 ? momentum_body[k] / moments[k] : 0.0;
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(one.state.omega_body[k]) || !std::isfinite(one.state.velocity[k]))
      faulty[NOT_FINITE] = one.body.id;
}

/* ----------------------------------------------------------------------
   directions of the axes
------------------------------------------------------------------------- */

/// Directs the axes by the body itself, not by its orientation at the start: the first and the
/// third axis point to the side of the heaviest site that is not in the plane across the axis; of
/// equally heavy sites the first one counts.
void Assembly::orient_axes()
{
  if (domain->dimension != 3) return;
  const auto along = [this](int part, const Site &site, double *components) {
    double arm[3];
    for (int k = 0; k < 3; ++k) arm[k] = site.x[k] - made[part].state.center[k];
    to_body(made[part].axes, arm, components);
  };
  const std::vector<Reach> reach = over_sites(Reach{0.0}, [&](Reach &all, int part) {
    visit(part, [&](const Site &site) {
      double x[3];
      along(part, site, x);
      for (const double one : x) all.largest = std::max(all.largest, std::fabs(one));
    });
  });
  const Sides none = {{-1.0, -1.0, -1.0}, {MAXTAGINT, MAXTAGINT, MAXTAGINT}, {}};
  const std::vector<Sides> sides = over_sites(none, [&](Sides &all, int part) {
    visit(part, [&](const Site &site) {
      Sides one = none;
      along(part, site, one.side);
      for (int k = 0; k < 3; ++k) {
        if (std::fabs(one.side[k]) < ON_AXIS * reach[part].largest) continue;
        one.mass[k] = site.mass;
        one.tag[k] = site.tag;
      }
      all.merge(one);
    });
  });
  for (int part = 0; part < parts.number(); ++part) direct(made[part].axes, sides[part]);
}

/// One axis follows from the two others.
void Assembly::direct(double *axes, const Sides &sides)
{
  // false if all sites are in the plane across the axis

  const auto turn = [&](int k) {
    if (sides.tag[k] == MAXTAGINT) return false;
    if (sides.side[k] < 0.0)
      for (int i = 3 * k; i < 3 * k + 3; ++i) axes[i] = -axes[i];
    return true;
  };
  const bool first = turn(0), third = turn(2);
  const int last = first == third ? 1 : first ? 2 : 0;
  if (last != 1) turn(1);
  cross3(axes + 3 * ((last + 1) % 3), axes + 3 * ((last + 2) % 3), axes + 3 * last);
}
