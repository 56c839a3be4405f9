/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What one fix gear/quat may ask another one in the same run.  A dynamic_cast of a Fix to Peer tells
   whether that fix is of this style. */

#ifndef LMP_GEAR_QUAT_PEER_H
#define LMP_GEAR_QUAT_PEER_H

namespace LAMMPS_NS::GearQuat {

class Peer {
 public:
  /// True if the fix moves this atom.
  virtual bool moves(int atom) const = 0;
  /// True if its start finds all derivatives, as far as it can.
  virtual bool bootstraps() const = 0;
  /// The largest error of a body here in the last step, as a length.
  virtual double last_error() const = 0;

 protected:
  ~Peer() = default;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
