/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Masks: components of the total force and torque that do not act on a body.

   Masked components are those of the space frame.  What does not act is taken by something outside of
   the body, which does no work on it where it stands still: the load that was met stays what it is
   for energy and virial, the load that acts is what moves the body. */

#ifndef GEAR_QUAT_MASK_H
#define GEAR_QUAT_MASK_H

#include "gear_quat_rigid_body.h"

namespace LAMMPS_NS::GearQuat {

/// A bit for each component that is off; 0: everything acts.
using Mask = int;

constexpr Mask force_off(int component)
{
  return 1 << component;
}

constexpr Mask torque_off(int component)
{
  return 1 << (3 + component);
}

/// What is left of a load.
inline Load acting_load(const Load &met, Mask off)
{
  Load acting = met;
  for (int k = 0; k < 3; ++k) {
    if (off & force_off(k)) acting.force[k] = 0.0;
    if (off & torque_off(k)) acting.torque_space[k] = 0.0;
  }
  return acting;
}

/// Work of a load met at the pose `before` along the small way to the pose `after`.
inline double work_between(const Load &met, const BodyState &before, const BodyState &after)
{
  double torque_body[3], dx[3], dq[4], angle_body[3];
  const double norm2 = dot4(before.q, before.q);
  for (int i = 0; i < 3; ++i) dx[i] = after.center[i] - before.center[i];
  for (int i = 0; i < 4; ++i) dq[i] = after.q[i] - before.q[i];
  angular_velocity(before.q, norm2, dq, angle_body);
  torque_along_axes(before.q, norm2, met, torque_body);
  return dot3(met.force, dx) + dot3(torque_body, angle_body);
}

}    // namespace LAMMPS_NS::GearQuat

#endif
