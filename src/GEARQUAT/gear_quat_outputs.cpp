/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_outputs.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "domain.h"
#include "force.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

// |q|^2 as a sum of four squares has this rounding error; a smaller deviation is reported as zero

static constexpr double NORM_ROUNDING = 1.0e-15;

Outputs::Outputs(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership, const Sites &sites,
                 const std::string &template_id) :
    Pointers(lmp),
    bodies(bodies), ownership(ownership), sites(sites), template_id(template_id)
{
  find_template(lmp, template_id);    // it must exist
}

/* ----------------------------------------------------------------------
   scalar and vector
------------------------------------------------------------------------- */

double Outputs::energy_correction() const
{
  double here[2] = {0.0, 0.0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const BodyState &s = bodies.state_of(ibody);
    const Load &l = bodies.load_of(ibody);
    here[0] -= bodies.last_of(ibody).work;
    here[1] +=
        std::sqrt(dot3(l.force, l.force) * dot3(s.center, s.center)) + length(l.torque_space);
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  const double rounding = std::numeric_limits<double>::epsilon() * all[1];
  return std::fabs(all[0]) < rounding ? 0.0 : all[0] / force->ftm2v;
}

double Outputs::element(int n, const Integrator *integrator) const
{
  const bool largest = n == NORM || n == RADIAL || n == MAX_POSITION || n == MAX_ANGLE;
  double here = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const BodyState &s = bodies.state_of(ibody);
    const Correction &last = bodies.last_of(ibody);
    const double off = last.position_error(), turn = last.angle_error();
    const double rate = integrator ? integrator->radial_rate(bodies.history(ibody)) : 0.0;
    const double of_body[ELEMENTS] = {translational_energy(rigid, s.velocity),
                                      rotational_energy(rigid, s.omega_body),
                                      std::fabs(dot4(s.q, s.q) - 1.0),
                                      std::fabs(rate),
                                      off,
                                      off * off,
                                      turn,
                                      turn * turn};
    here = largest ? std::max(here, of_body[n]) : here + of_body[n];
  }
  const double all = over_ranks(largest ? MPI_MAX : MPI_SUM, here, world);
  if (n == KE_TRANSLATION || n == KE_ROTATION) return all * force->mvv2e;
  if (n == NORM || n == RADIAL) return all < NORM_ROUNDING ? 0.0 : all;
  if (largest) return all;
  return bodies.number() ? std::sqrt(all / bodies.number()) : 0.0;
}

/* ----------------------------------------------------------------------
   array and local data
------------------------------------------------------------------------- */

std::vector<Outputs::Row> Outputs::owned_rows() const
{
  std::vector<Row> made(bodies.nowned());
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) fill_row(ibody, made[ibody].data());
  return made;
}

double **Outputs::local()
{
  mine = owned_rows();
  rows.clear();
  for (Row &row : mine) rows.push_back(row.data());
  return rows.data();
}

double Outputs::global(int row, int column)
{
  if (gathered != sites.placements()) {
    std::vector<Row> here = owned_rows();
    all = gather_sorted(here, world, [](const Row &a, const Row &b) {
      return a[ID] < b[ID];
    });
    gathered = sites.placements();
  }
  return row < (int) all.size() ? all[row][column] : 0.0;
}

/// A center in the box and its image flags, also if they exceed the range of integers.
void Outputs::wrap(const double *center, double *wrapped, double *image) const
{
  const bool tilted = domain->triclinic;
  std::copy_n(center, 3, wrapped);
  if (tilted) domain->x2lamda(wrapped, wrapped);
  for (int k = 0; k < 3; ++k) {
    const double low = tilted ? 0.0 : domain->boxlo[k], period = tilted ? 1.0 : domain->prd[k];
    image[k] = domain->periodicity[k] ? std::floor((wrapped[k] - low) / period) : 0.0;
    wrapped[k] -= image[k] * period;
  }
  if (tilted) domain->lamda2x(wrapped, wrapped);
}

/// Quaternions have unit length, and the scalar first, as in LAMMPS.
void Outputs::fill_row(int ibody, double *row) const
{
  const Body &body = bodies.body_at(ibody);
  const BodyState &s = bodies.state_of(ibody);
  const Load &l = bodies.load_of(ibody);

  wrap(s.center, row + CENTER, row + IMAGE);
  std::copy_n(s.velocity, 3, row + VELOCITY);
  for (int i = 0; i < 3; ++i) {
    row[FORCE + i] = l.force[i] / force->ftm2v;
    row[TORQUE + i] = l.torque_space[i] / force->ftm2v;
  }
  double unit[4];
  std::copy_n(s.q, 4, unit);
  project_norm(unit);
  row[QUATERNION] = unit[3];
  std::copy_n(unit, 3, row + QUATERNION + 1);
  std::copy_n(s.omega_body, 3, row + OMEGA_BODY);
  momentum_along_space(body.rigid, s, row + ANGULAR_MOMENTUM);
  row[POSITION_ERROR] = bodies.last_of(ibody).position_error();
  row[ANGLE_ERROR] = bodies.last_of(ibody).angle_error();
  row[ID] = double(body.id);
}

/* ----------------------------------------------------------------------
   data for other C++ code
------------------------------------------------------------------------- */

void *Outputs::extract(const std::string &name, int &dim)
{
  dim = 0;
  nbody = bodies.nhere();
  if (name == "nbody") return &nbody;
  if (name == "onemol") return find_template(lmp, template_id);
  dim = 1;    // one element more avoids a null pointer without atoms
  if (name == "body") {
    body.assign(atom->nlocal + 1, -1);
    for (int i = 0; i < atom->nlocal; ++i) body[i] = ownership.body_of(i);
    return body.data();
  }
  if (name == "masstotal") {
    masstotal.resize(nbody + 1);
    for (int i = 0; i < nbody; ++i) masstotal[i] = bodies.rigid_of(i).mass;
    return masstotal.data();
  }
  return nullptr;
}
