/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Output of the bodies: the fix's scalar and vector for all bodies together, a row of numbers for
   each body in its global array (all bodies on all ranks, sorted by ID) and local data (owned
   bodies), and data for other C++ code by name. */

#include "fix_gear_quat.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "force.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

/// Elements of the vector, as listed in the manual.
static constexpr int KE_TRANSLATION = 0, KE_ROTATION = 1, NORM = 2, RADIAL = 3, MAX_POSITION = 4,
                     RMS_POSITION = 5, MAX_ANGLE = 6, RMS_ANGLE = 7;
/// Columns, counted from 0; the first fifteen are as in fix rigid.
static constexpr int CENTER = 0, VELOCITY = 3, FORCE = 6, TORQUE = 9, IMAGE = 12, QUATERNION = 15,
                     OMEGA_BODY = 19, ANGULAR_MOMENTUM = 22, POSITION_ERROR = 25, ANGLE_ERROR = 26,
                     ID = 27;

// |q|^2 as a sum of four squares has this rounding error; a smaller deviation is reported as zero
static constexpr double NORM_ROUNDING = 1.0e-15;

/* ----------------------------------------------------------------------
   scalar and vector
------------------------------------------------------------------------- */

/// The change of the potential energy from the predicted to the corrected pose, zero if it is less
/// than the effect of round-off in the centers on the loads; and the energy of a thermostat.
double FixGearQuat::compute_scalar()
{
  double here[2] = {0.0, 0.0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const BodyState &s = bodies.state[ibody];
    const Load &l = bodies.load[ibody];
    here[0] -= bodies.last[ibody].work;
    here[1] +=
        std::sqrt(dot3(l.force, l.force) * dot3(s.center, s.center)) + length(l.torque_space);
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  const double rounding = std::numeric_limits<double>::epsilon() * all[1];
  return (std::fabs(all[0]) < rounding ? 0.0 : all[0] / force->ftm2v) + step.energy();
}

double FixGearQuat::compute_vector(int n)
{
  if (n >= size_vector)
    error->all(FLERR,
               "Fix gear/quat {}: output reads element {} of a vector of {}; the fix has other "
               "keywords than when the output was defined: define it anew",
               id, n + 1, size_vector);
  if (n >= ELEMENTS) return step.element(n - ELEMENTS);
  const Integrator *integrator = step.present_integrator();    // null while there are no histories
  const bool largest = n == NORM || n == RADIAL || n == MAX_POSITION || n == MAX_ANGLE;
  double here = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.body[ibody].rigid;
    const BodyState &s = bodies.state[ibody];
    const Correction &last = bodies.last[ibody];
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

/// A center in the box and its image flags, also if they exceed the range of integers.
static void wrap(Domain *domain, const double *center, double *wrapped, double *image)
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
std::vector<FixGearQuat::Row> FixGearQuat::owned_rows() const
{
  std::vector<Row> made(bodies.nowned());
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    double *row = made[ibody].data();
    const Body &body = bodies.body[ibody];
    const BodyState &s = bodies.state[ibody];
    const Load &l = bodies.load[ibody];

    wrap(domain, s.center, row + CENTER, row + IMAGE);
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
    row[POSITION_ERROR] = bodies.last[ibody].position_error();
    row[ANGLE_ERROR] = bodies.last[ibody].angle_error();
    row[ID] = double(body.id);
  }
  return made;
}

/// Rows stay valid until the next call.  LAMMPS does not call a function to request local data.
void FixGearQuat::show_bodies()
{
  mine = owned_rows();
  rows.clear();
  for (Row &row : mine) rows.push_back(row.data());
  array_local = rows.data();
  size_local_rows = bodies.nowned();
}

/// 0 in rows without a body.  Rows are gathered at the first request after sites were listed or
/// placed: collective.
double FixGearQuat::compute_array(int row, int column)
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

/* ----------------------------------------------------------------------
   data for other C++ code
------------------------------------------------------------------------- */

/// Data that other C++ code may request from the fix by name, see Fix::extract(): names as in fix
/// rigid where they exist.  Bodies are numbered as in the local data, owned bodies first.  Null
/// for an unknown name.  The result is valid until atoms or bodies are exchanged, created or
/// removed, or until the same name is requested again.  dim: 0 scalar, 1 vector.
///   body         int *      owned atoms: number of the body, -1 for none
///   nbody        int *      owned and ghost bodies of this rank
///   masstotal    double *   owned and ghost bodies
///   onemol       Molecule **  the molecules of the template of keyword mol, otherwise null
void *FixGearQuat::extract(const char *word, int &dim)
{
  const std::string name = word;
  dim = 0;
  nbody = bodies.nhere();
  if (name == "nbody") return &nbody;
  if (name == "onemol") return find_template(lmp, args.mol);
  dim = 1;    // one element more avoids a null pointer without atoms
  if (name == "body") {
    body_of_atom.assign(atom->nlocal + 1, -1);
    for (int i = 0; i < atom->nlocal; ++i) body_of_atom[i] = ownership.body_of(i);
    return body_of_atom.data();
  }
  if (name == "masstotal") {
    masstotal.resize(nbody + 1);
    for (int i = 0; i < nbody; ++i) masstotal[i] = bodies.body[i].rigid.mass;
    return masstotal.data();
  }
  return nullptr;
}

double FixGearQuat::memory_usage()
{
  return ownership.memory_usage() + sites.memory_usage() +
      (mine.capacity() + all.capacity()) * sizeof(Row) + rows.capacity() * sizeof(double *);
}
