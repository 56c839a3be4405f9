/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Declarations in classes of LAMMPS with the patch in doc/upstream.  The members are detected at
   compile time; without a member nothing is declared. */

#ifndef GEAR_QUAT_DECLARED_H
#define GEAR_QUAT_DECLARED_H

namespace LAMMPS_NS::GearQuat {

constexpr int UNDECLARED = -1;    ///< of a flag that is 0 or 1 otherwise

template <typename Style> auto repeatable_of(const Style *style, int) -> decltype(style->repeatable)
{
  return style->repeatable;
}
template <typename Style> int repeatable_of(const Style *, long)
{
  return UNDECLARED;
}
/// 1 if forces of a pair or bond style, or post_force() of a fix, can be evaluated again in a step,
/// 0 if not.
template <typename Style> int declared_repeatable(const Style *style)
{
  return repeatable_of(style, 0);
}

template <typename Style>
auto no_net_force_of(const Style *style, int) -> decltype(style->no_net_force)
{
  return style->no_net_force;
}
template <typename Style> int no_net_force_of(const Style *, long)
{
  return UNDECLARED;
}
/// 1 if forces of a style add up to zero, 0 if they need not.
template <typename Style> int declared_no_net_force(const Style *style)
{
  return no_net_force_of(style, 0);
}

template <typename Run>
auto evaluates_forces(Run *run, int eflag, int vflag, int)
    -> decltype(run->evaluate_forces(eflag, vflag), bool(run->evaluate_forces_flag))
{
  if (!run->evaluate_forces_flag) return false;
  run->evaluate_forces(eflag, vflag);
  return true;
}
template <typename Run> bool evaluates_forces(Run *, int, int, long)
{
  return false;
}
/// True if the run style has evaluated the forces at the present positions, without fixes.
template <typename Run> bool evaluated_by(Run *run, int eflag, int vflag)
{
  return evaluates_forces(run, eflag, vflag, 0);
}

}    // namespace LAMMPS_NS::GearQuat

#endif
