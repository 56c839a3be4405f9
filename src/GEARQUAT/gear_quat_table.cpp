/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_table.h"

#include "gear_quat_gather.h"

#include "domain.h"
#include "force.h"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace LAMMPS_NS;
using namespace GearQuat;

double **BodyTable::local()
{
  fill(mine);
  rows.resize(bodies.nowned());
  for (size_t i = 0; i < rows.size(); ++i) rows[i] = mine.data() + i * COLUMNS;
  return rows.data();
}

double BodyTable::global(int row, int column)
{
  if (!gathered) gather();
  const size_t at = (size_t) row * COLUMNS + column;
  return at < all.size() ? all[at] : 0.0;
}

void BodyTable::fill(std::vector<double> &rows_here) const
{
  rows_here.resize((size_t) bodies.nowned() * COLUMNS);
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    fill_row(ibody, rows_here.data() + (size_t) ibody * COLUMNS);
}

/// A center in the box and its image flags; also where it has flown so far that flags are no integers.
void BodyTable::wrap(const double *center, double *wrapped, double *image) const
{
  const int periodic[3] = {domain->xperiodic, domain->yperiodic, domain->zperiodic};
  const bool tilted = domain->triclinic;
  std::copy_n(center, 3, wrapped);
  if (tilted) domain->x2lamda(wrapped, wrapped);
  for (int k = 0; k < 3; ++k) {
    const double low = tilted ? 0.0 : domain->boxlo[k], period = tilted ? 1.0 : domain->prd[k];
    image[k] = periodic[k] ? std::floor((wrapped[k] - low) / period) : 0.0;
    wrapped[k] -= image[k] * period;
  }
  if (tilted) domain->lamda2x(wrapped, wrapped);
}

/// Quaternions have the scalar first, as everywhere in LAMMPS.
void BodyTable::fill_row(int ibody, double *row) const
{
  const Body &body = bodies.body[ibody];
  const BodyState &s = bodies.state[ibody];
  const Load &l = bodies.load[ibody];

  double a[9], momentum_body[3];
  wrap(s.center, row + CENTER, row + IMAGE);
  rotation_matrix(s.q, dot4(s.q, s.q), a);
  for (int i = 0; i < 3; ++i) momentum_body[i] = body.rigid.inertia[i] * s.omega_body[i];

  std::copy_n(s.velocity, 3, row + VELOCITY);
  for (int i = 0; i < 3; ++i) {
    row[FORCE + i] = l.force[i] / force->ftm2v;
    row[TORQUE + i] = l.torque_space[i] / force->ftm2v;
  }
  row[QUATERNION] = s.q[3];
  std::copy_n(s.q, 3, row + QUATERNION + 1);
  std::copy_n(s.omega_body, 3, row + OMEGA_BODY);
  to_space(a, momentum_body, row + ANGULAR_MOMENTUM);
  row[POSITION_ERROR] = bodies.last[ibody].position_error;
  row[ANGLE_ERROR] = bodies.last[ibody].angle_error;
  row[ID] = double(body.id);
}

void BodyTable::gather()
{
  std::vector<double> rows_here;    // local() has shown `mine`
  fill(rows_here);
  const std::vector<double> met = gather_all(rows_here, MPI_DOUBLE, world);

  std::vector<size_t> order(met.size() / COLUMNS);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](size_t i, size_t j) {
    return met[i * COLUMNS + ID] < met[j * COLUMNS + ID];
  });
  all.resize(met.size());
  for (size_t i = 0; i < order.size(); ++i)
    std::copy_n(met.data() + order[i] * COLUMNS, (int) COLUMNS, all.data() + i * COLUMNS);
  gathered = true;
}
