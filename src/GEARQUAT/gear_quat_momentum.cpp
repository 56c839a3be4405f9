/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_momentum.h"

#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

// exact sums represent terms up to 2^20 units, also of a fast common motion

static constexpr double LARGE_MOMENTA = 1024.0;    // 2^10

/* ---------------------------------------------------------------------- */

bool TotalMomentum::belongs(int ibody, int direction) const
{
  return direction < domain->dimension && !(bodies.body_at(ibody).off & force_off(direction));
}

std::string TotalMomentum::find_outside(bool bodies_come) const
{
  bigint here = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) here += bodies.body_at(ibody).natoms;
  const bigint others = atom->natoms - over_ranks(MPI_SUM, here, world);
  if (others > 0) return fmt::format("{} atoms are in no body of this fix", others);
  if (const Fix *other = fix_with_forces(lmp, fix)) return name_of(other) + " may exert forces";
  for (const auto *other : modify->get_fix_list())
    if (!bodies_come && known(Fact::EXCHANGE, other)) return name_of(other) + " may insert atoms";
  if (known_pair(Fact::BACKGROUND, lmp->force))
    return std::string("pair style ") + lmp->force->pair_style + " exerts forces from outside";
  return "";
}

void TotalMomentum::weigh(int stated_freedoms, bool bodies_come)
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

  const int d = domain->dimension;
  stated = stated_freedoms >= 0;
  outside = find_outside(bodies_come);
  subtracted = 0;
  for (int k = 0; k < d; ++k) {
    constant[k] = stated
        ? stated_freedoms >= d
        : domain->periodicity[k] && outside.empty() && count[k] == (double) bodies.number();
    constant[k] = constant[k] && count[k] > 0.0;
    subtracted += constant[k];
  }
  if (stated) subtracted = stated_freedoms;
}

void TotalMomentum::measure(double kt)
{
  const double thermal = std::sqrt(kt * std::max({mass[0], mass[1], mass[2]}));
  const double unit = LARGE_MOMENTA * ExactSum::scale_of(thermal);
  bigint here[3 * ExactSum::LIMBS];
  for (int k = 0; k < 3; ++k) {
    ExactSum sum;
    for (int ibody = 0; constant[k] && ibody < bodies.nowned(); ++ibody)
      if (belongs(ibody, k))
        sum.add(bodies.rigid_of(ibody).mass * bodies.state_of(ibody).velocity[k], unit);
    std::copy_n(sum.limbs, ExactSum::LIMBS, here + ExactSum::LIMBS * k);
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  for (int k = 0; k < 3; ++k) {
    ExactSum sum;
    std::copy_n(all.begin() + ExactSum::LIMBS * k, ExactSum::LIMBS, sum.limbs);
    momentum[k] = sum.value(unit);
    common[k] = constant[k] ? momentum[k] / mass[k] : 0.0;
  }
}

double TotalMomentum::twice_energy() const
{
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += momentum[k] * common[k];
  return sum;
}

std::string TotalMomentum::description() const
{
  if (!any()) return "";
  if (stated) return fmt::format(", without {} by fix_modify extra/dof,", subtracted);
  if (!outside.empty()) return ", with those of the total momentum because " + outside + ",";
  std::vector<std::string> along;
  for (int k = 0; k < 3; ++k)
    if (constant[k]) along.emplace_back(1, "xyz"[k]);
  if (along.empty()) return ", with those of the total momentum,";
  const bool all = (int) along.size() == domain->dimension;
  return ", without those of the total momentum" +
      (all ? std::string() : " along " + utils::join_words(along, " and ")) + ",";
}
