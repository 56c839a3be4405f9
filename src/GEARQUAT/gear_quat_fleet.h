/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* All fixes gear/quat of a run.  Their bodies act on each other, so their histories start together,
   and a fix can look up in this list which atoms another fix moves.  Every fix makes such a list in
   init(). */

#ifndef LMP_GEAR_QUAT_FLEET_H
#define LMP_GEAR_QUAT_FLEET_H

#include "gear_quat_ownership.h"

#include "atom.h"
#include "fix.h"

#include <vector>

namespace LAMMPS_NS::GearQuat {

class Motion;

struct Fleet {
  struct Member {
    Fix *fix;
    Motion *motion;
    const Ownership *ownership;
    bool changes_step;    ///< keyword tolerance
    bool tuned;           ///< its coefficients
  };
  std::vector<Member> members;    ///< in the order in which they begin a step

  /// The fix as a fix gear/quat, null for a fix of another style.
  const Member *find(const Fix *fix) const
  {
    for (const auto &one : members)
      if (one.fix == fix) return &one;
    return nullptr;
  }

  /// True if a fix that integrates in time moves this owned atom.
  bool moves(const Fix *fix, const Atom *atom, int i) const
  {
    const Member *member = find(fix);
    return member ? member->ownership->in_body(i) : (atom->mask[i] & fix->groupbit) != 0;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
