/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_momentum.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "domain.h"
#include "force.h"
#include "kspace.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

// a sum of forces counts as zero if in a damping time it changes the total momentum by less than
// this part of its thermal value, or if it is less than this part of all forces: the individual
// pair forces may be larger, and of single precision

static constexpr double PART_OF_THERMAL = 1.0e-10, PART_OF_FORCES = 1.0e-8;

// or if it is less than this multiple of the sum of independent errors of all atoms: a mesh whose
// forces are derivatives of interpolated energies leaves a third of it

static constexpr double ERRORS_OF_MESH = 3.0;

// exact sums represent terms up to 2^20 units: forces of overlaps, and fast common motion

static constexpr double LARGE_FORCES = 1073741824.0, LARGE_MOMENTA = 1024.0;    // 2^30, 2^10

/* ---------------------------------------------------------------------- */

TotalMomentum::TotalMomentum(LAMMPS *lmp, const Bodies &bodies, double period) :
    Pointers(lmp), bodies(bodies), period(period)
{
}

bool TotalMomentum::belongs(int ibody, int direction) const
{
  return direction < domain->dimension && !(bodies.body_at(ibody).off & force_off(direction));
}

void TotalMomentum::weigh()
{
  double heaviest = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    heaviest = std::max(heaviest, bodies.rigid_of(ibody).mass);
  heaviest = over_ranks(MPI_MAX, heaviest, world);
  const double unit = ExactSum::scale_of(heaviest * std::max((bigint) 1, bodies.number()));

  ExactSum masses[3];
  constexpr int COUNTS = 3 * ExactSum::LIMBS;
  bigint here[COUNTS + 3] = {};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    for (int k = 0; k < 3; ++k) {
      if (!belongs(ibody, k)) continue;
      masses[k].add(bodies.rigid_of(ibody).mass, unit);
      ++here[COUNTS + k];
    }
  for (int k = 0; k < 3; ++k)
    std::copy_n(masses[k].limbs, ExactSum::LIMBS, here + ExactSum::LIMBS * k);
  const auto all = over_ranks(MPI_SUM, here, world);
  for (int k = 0; k < 3; ++k) {
    std::copy_n(all.begin() + ExactSum::LIMBS * k, ExactSum::LIMBS, masses[k].limbs);
    mass[k] = masses[k].value(unit);
    count[k] = (double) all[COUNTS + k];
  }
}

/* ----------------------------------------------------------------------
   sums
------------------------------------------------------------------------- */

void TotalMomentum::begin_sums(double kt)
{
  for (auto &sum : differences) sum = ExactSum();
  thermal = std::sqrt(kt * std::max({mass[0], mass[1], mass[2]}));
  unit_momentum = LARGE_MOMENTA * ExactSum::scale_of(thermal);
  unit_force = LARGE_FORCES * ExactSum::scale_of(thermal / period);
}

void TotalMomentum::add_predicted(int ibody, const double *of_rows)
{
  for (int k = 0; k < 3; ++k)
    if (counts(k) && belongs(ibody, k))
      differences[k].add(bodies.load_of(ibody).force[k] - of_rows[k], unit_force);
}

void TotalMomentum::add_up(bigint *limbs)
{
  for (int k = 0; k < 3; ++k) {
    ExactSum sums[2];
    double here = 0.0;    // only for a test: its rounding may depend on the distribution of bodies
    for (int ibody = 0; counts(k) && ibody < bodies.nowned(); ++ibody) {
      const Body &body = bodies.body_at(ibody);
      if (body.off & force_off(k)) continue;
      sums[0].add(body.rigid.mass * bodies.state_of(ibody).velocity[k], unit_momentum);
      here += bodies.load_of(ibody).force[k];
    }
    sums[1].add(here, unit_force);
    for (const ExactSum &sum : {sums[0], sums[1], differences[k]})
      limbs = std::copy_n(sum.limbs, ExactSum::LIMBS, limbs);
  }
}

void TotalMomentum::take(const bigint *limbs)
{
  for (int k = 0; k < 3; ++k) {
    ExactSum sums[3];
    for (ExactSum &sum : sums) {
      std::copy_n(limbs, ExactSum::LIMBS, sum.limbs);
      limbs += ExactSum::LIMBS;
    }
    momentum[k] = sums[0].value(unit_momentum);
    force[k] = sums[1].value(unit_force);
    common[k] = counts(k) ? momentum[k] / mass[k] : 0.0;
    unforeseen[k] = counts(k) ? sums[2].value(unit_force) / mass[k] : 0.0;
  }
}

double TotalMomentum::twice_energy() const
{
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += momentum[k] * common[k];
  return sum;
}

/* ----------------------------------------------------------------------
   test whether it is constant
------------------------------------------------------------------------- */

/// The largest sum of forces that counts as zero.
double TotalMomentum::explained() const
{
  double most = PART_OF_THERMAL * thermal / period;
  const KSpace *mesh = lmp->force->kspace;
  if (mesh)
    most += ERRORS_OF_MESH * mesh->accuracy * std::sqrt((double) atom->natoms) * lmp->force->ftm2v;
  return most;
}

bool TotalMomentum::judge()
{
  const double most = explained();
  const auto exceeds = [&](double part_of_forces) {
    bool any = false;
    for (int k = 0; k < 3; ++k)
      any = any || (counts(k) && std::fabs(force[k]) > most + part_of_forces);
    return any;
  };
  if (!exceeds(0.0)) return false;

  double here = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    for (const double one : bodies.load_of(ibody).force) here += std::fabs(one);
  const double part = PART_OF_FORCES * over_ranks(MPI_SUM, here, world);
  if (!exceeds(part)) return false;
  for (int k = 0; k < 3; ++k)
    if (counts(k) && std::fabs(force[k]) > most + part) constant[k] = false;
  return true;
}

/* ----------------------------------------------------------------------
   consequences
------------------------------------------------------------------------- */

double TotalMomentum::freedoms() const
{
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += count[k] - counts(k);
  return sum;
}

std::string TotalMomentum::description() const
{
  std::vector<std::string> along;
  for (int k = 0; k < 3; ++k)
    if (counts(k)) along.emplace_back(1, "xyz"[k]);
  if (along.empty()) return "";
  const bool all = (int) along.size() == domain->dimension;
  return ", without those of the total momentum" +
      (all ? std::string() : " along " + utils::join_words(along, " and ")) + ",";
}

double TotalMomentum::record() const
{
  return constant[0] + 2.0 * constant[1] + 4.0 * constant[2];
}

void TotalMomentum::restore(double record)
{
  for (int k = 0; k < 3; ++k) constant[k] = ((int) record >> k) & 1;
}
