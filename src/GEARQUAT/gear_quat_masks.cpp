/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_masks.h"

#include "gear_quat_bodies.h"
#include "gear_quat_gather.h"

#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cstdlib>

using namespace LAMMPS_NS;
using namespace GearQuat;

namespace {

/// IDs of all bodies, sorted, on all ranks.
std::vector<tagint> all_ids(LAMMPS *lmp, const Bodies &bodies)
{
  std::vector<tagint> mine;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) mine.push_back(bodies.body[ibody].id);
  return gather_sorted(mine, lmp->world);
}

/// n, *, *n, n* or m*n with 1 <= m <= n <= number; false if it is none of these.
bool parse_range(const std::string &text, tagint number, tagint &first, tagint &last)
{
  const size_t star = text.find('*');
  const std::string left = text.substr(0, star);
  const std::string right = star == std::string::npos ? left : text.substr(star + 1);
  for (const auto &part : {left, right})
    if (part.find_first_not_of("0123456789") != std::string::npos || part.size() > 18) return false;
  if (star == std::string::npos && left.empty()) return false;
  const bigint from = left.empty() ? 1 : std::atoll(left.c_str());
  const bigint to = right.empty() ? number : std::atoll(right.c_str());
  if (from < 1 || from > to || to > number) return false;
  first = (tagint) from;
  last = (tagint) to;
  return true;
}

}    // namespace

Masks::Masks(LAMMPS *lmp, const std::vector<MaskWords> &words, const Bodies &bodies) : Pointers(lmp)
{
  if (words.empty()) return;
  const std::vector<tagint> ids = all_ids(lmp, bodies);
  for (const auto &one : words) {
    const char *key = one.torque ? "torque" : "force";
    tagint first, last;
    if (!parse_range(one.range, (tagint) ids.size(), first, last))
      error->all(FLERR,
                 "Fix gear/quat {}: bodies {} are neither a number from 1 to {} nor a range of "
                 "them with an asterisk",
                 key, one.range, ids.size());
    if (domain->dimension == 2 && (one.torque ? one.on[0] || one.on[1] : one.on[2]))
      error->all(FLERR, "Fix gear/quat {}: the {} has to be off in a 2d simulation", key,
                 one.torque ? "torque about x and y" : "force along z");
    Mask bits = 0, wanted = 0;
    for (int k = 0; k < 3; ++k) {
      const Mask bit = one.torque ? torque_off(k) : force_off(k);
      bits |= bit;
      if (!one.on[k]) wanted |= bit;
    }
    for (tagint m = first; m <= last; ++m) {
      Mask &mask = off[ids[m - 1]];
      mask = (mask & ~bits) | wanted;
    }
  }
  for (auto it = off.begin(); it != off.end();) it = it->second ? std::next(it) : off.erase(it);
}

bool Masks::impose(Bodies &bodies) const
{
  int changed = 0, any_changed;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    Body &body = bodies.body[ibody];
    const auto found = off.find(body.id);
    const Mask wanted = found == off.end() ? 0 : found->second;
    if (body.off != wanted) changed = 1;
    body.off = wanted;
  }
  MPI_Allreduce(&changed, &any_changed, 1, MPI_INT, MPI_MAX, world);
  return any_changed != 0;
}
