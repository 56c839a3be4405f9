/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keywords force and torque: which components act on which bodies (gear_quat_mask.h).  The masks of
   bodies travel with them; here are those of the command, by body ID, the same on all ranks. */

#ifndef LMP_GEAR_QUAT_MASKS_H
#define LMP_GEAR_QUAT_MASKS_H

#include "gear_quat_mask.h"
#include "pointers.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Bodies;

/// One keyword with its words.
struct MaskWords {
  bool torque;          ///< or force
  std::string range;    ///< of bodies, counted from 1 in the order of their IDs
  bool on[3];
};

class Masks : protected Pointers {
 public:
  /// Which bodies the words mean; later words replace earlier ones.  A range that is none, or has
  /// bodies that do not exist, ends the run, and so does motion out of the plane in two dimensions.
  /// Collective.
  Masks(LAMMPS *lmp, const std::vector<MaskWords> &words, const Bodies &bodies);

  /// True if some body, on any rank, has something that does not act.
  bool any() const { return !off.empty(); }
  /// Give all bodies their masks.  True if one had another; collective.
  bool impose(Bodies &bodies) const;

 private:
  std::map<tagint, Mask> off;    ///< bodies with masks only
};

}    // namespace LAMMPS_NS::GearQuat

#endif
