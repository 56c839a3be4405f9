// The entry of gearquat.so: tells LAMMPS about `fix gear/quat`.
// It is not called lammpsplugin_init, so that LAMMPS cannot open this library past the loader.

#include "built_for.h"
#include "fix_gear_quat.h"
#include "plugin_api.h"

static void *create_fix(void *lammps, int narg, char **arg)
{
  return new LAMMPS_NS::FixGearQuat(static_cast<LAMMPS_NS::LAMMPS *>(lammps), narg, arg);
}

extern "C" void gearquat_init(void *lammps, void *handle, void *register_style)
{
  gearquat_plugin::Style style{};
  style.lammps_version = GEARQUAT_LAMMPS_VERSION;
  style.category = "fix";
  style.name = "gear/quat";
  style.description = "GEARQUAT: rigid bodies by Gear's method in quaternions";
  style.author = "the GEARQUAT authors";
  style.creator.v2 = &create_fix;
  style.handle = handle;
  reinterpret_cast<gearquat_plugin::RegisterStyle *>(register_style)(&style, lammps);
}
