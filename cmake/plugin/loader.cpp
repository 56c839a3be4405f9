// gearquatplugin.so: what LAMMPS opens.
//
//   LAMMPS --dlopen--> gearquatplugin.so --same version, integers and MPI?--> gearquat.so
//                              |
//                              +-- no: say why; `fix gear/quat` is then an error
//
// LAMMPS does not check what a plugin was compiled for: one for another version runs, reads memory
// at wrong places and exits with 0. This file therefore uses nothing of LAMMPS' C++, only C
// functions that are looked up by name, and opens the fix itself after all checks have passed.

#include "built_for.h"
#include "plugin_api.h"

#include <dlfcn.h>
#include <mpi.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using gearquat_plugin::Init;
using gearquat_plugin::RegisterStyle;
using gearquat_plugin::Style;

#if defined(LAMMPS_BIGBIG)
constexpr int TAGINT_BYTES = 8;
#else
constexpr int TAGINT_BYTES = 4;
#endif
constexpr int BIGINT_BYTES = 8;

// MPI libraries of one family can replace each other; libraries of different families cannot.
constexpr const char *FAMILY_OPEN_MPI = "Open MPI";
constexpr const char *FAMILY_MPICH = "MPICH";
constexpr const char *FAMILY_STUBS = "no MPI (LAMMPS' stubs)";

#if defined(OMPI_MAJOR_VERSION)
constexpr const char *MPI_FAMILY = FAMILY_OPEN_MPI;
#elif defined(MPICH_VERSION) || defined(MVAPICH2_VERSION) || defined(I_MPI_VERSION)
constexpr const char *MPI_FAMILY = FAMILY_MPICH;
#elif defined(MPI_STUBS)
constexpr const char *MPI_FAMILY = FAMILY_STUBS;
#else
#error "GEARQUAT knows Open MPI, MPICH and those with MPICH's ABI, and LAMMPS' stubs"
#endif

// the reason for a refusal; lives as long as the library, LAMMPS keeps pointers into us
std::string refusal;

template <typename Function> Function *look_up(const char *name)
{
  return reinterpret_cast<Function *>(dlsym(RTLD_DEFAULT, name));
}

bool contains(const std::string &text, const char *word)
{
  return text.find(word) != std::string::npos;
}

// "4 Feb 2025" from 20250204
std::string date_of(int number)
{
  static const char *const MONTHS[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                       "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const int month = number / 100 % 100;
  if (month < 1 || month > 12) return std::to_string(number);
  return std::to_string(number % 100) + " " + MONTHS[month - 1] + " " +
      std::to_string(number / 10000);
}

// first line of the version string of the running MPI; empty if there is none
std::string running_mpi()
{
  auto get_version = look_up<int(char *, int *)>("MPI_Get_library_version");
  if (!get_version) return "";
  std::vector<char> text(65536, '\0');    // MPICH writes more than its own limit
  int length = 0;
  get_version(text.data(), &length);
  std::string line(text.data());
  line = line.substr(0, line.find('\n'));
  line = line.substr(0, line.find(", package:"));    // Open MPI adds where it was built
  std::string words;
  for (const char c : line)
    if (c != ' ' && c != '\t')
      words += c;
    else if (words.empty() || words.back() != ' ')
      words += ' ';
  return words;
}

std::string family_of(const std::string &mpi)
{
  if (contains(mpi, "Open MPI")) return FAMILY_OPEN_MPI;
  if (mpi.empty() || contains(mpi, "STUBS"))
    return FAMILY_STUBS;    // the stubs are C++, not looked up
  for (const char *name : {"MPICH", "MVAPICH", "Intel(R) MPI"})
    if (contains(mpi, name)) return FAMILY_MPICH;
  return "unknown";
}

std::string integers(int bigint_bytes, int tagint_bytes)
{
  return std::to_string(8 * bigint_bytes) + "-bit bigint and " + std::to_string(8 * tagint_bytes) +
      "-bit tagint";
}

// why this LAMMPS is not the one we were compiled for; empty if it is
std::string mismatch(void *lammps)
{
  auto version = look_up<int(void *)>("lammps_version");
  auto setting = look_up<int(void *, const char *)>("lammps_extract_setting");
  if (!version || !setting)
    return "this program does not offer LAMMPS' C library functions, its version is unknown";

  if (version(lammps) != GEARQUAT_LAMMPS_NUMBER)
    return "the plugin was built for LAMMPS " GEARQUAT_LAMMPS_VERSION ", but this is LAMMPS " +
        date_of(version(lammps));

  const int bigint_bytes = setting(lammps, "bigint");
  const int tagint_bytes = setting(lammps, "tagint");
  if (bigint_bytes != BIGINT_BYTES || tagint_bytes != TAGINT_BYTES)
    return "the plugin was built for LAMMPS with " + integers(BIGINT_BYTES, TAGINT_BYTES) +
        ", but this LAMMPS has " + integers(bigint_bytes, tagint_bytes);

  const std::string mpi = running_mpi();
  if (family_of(mpi) != MPI_FAMILY)
    return std::string("the plugin was built for the MPI library ") + MPI_FAMILY +
        ", but this LAMMPS runs on " + (mpi.empty() ? "none that can be found" : mpi);

  return "";
}

// the library with the fix, which lies beside this one
Init *open_fix(std::string &reason)
{
  Dl_info self;
  if (!dladdr(reinterpret_cast<void *>(&open_fix), &self)) {
    reason = "the plugin cannot find its own folder";
    return nullptr;
  }
  const std::string own = self.dli_fname;
  const auto slash = own.rfind('/');
  const std::string path =
      (slash == std::string::npos ? "./" : own.substr(0, slash + 1)) + "gearquat.so";

  void *library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void *init = library ? dlsym(library, "gearquat_init") : nullptr;
  if (!init) {
    const char *text = dlerror();
    reason = "the plugin cannot open " + path + ": " + (text ? text : "no gearquat_init in it");
  }
  return reinterpret_cast<Init *>(init);
}

// Stands in for the fix: repeats the reason where it is used, on screen and in the log. Returning
// nothing makes LAMMPS stop with "Unrecognized fix style" and a non-zero exit code; a Python
// program gets an exception.
void *refuse_fix(void *lammps, int, char **)
{
  auto error = look_up<void(void *, int, const char *)>("lammps_error");
  auto setting = look_up<int(void *, const char *)>("lammps_extract_setting");
  constexpr int WARNING = 0;
  if (error && setting && setting(lammps, "world_rank") == 0)
    error(lammps, WARNING, refusal.c_str());
  return nullptr;
}

}    // namespace

extern "C" void lammpsplugin_init(void *lammps, void *handle, void *register_style)
{
  std::string reason = mismatch(lammps);
  Init *init = reason.empty() ? open_fix(reason) : nullptr;
  if (init) {
    init(lammps, handle, register_style);
    return;
  }

  refusal = "fix gear/quat is not available: " + reason +
      ". Build GEARQUAT for this LAMMPS and its MPI (cmake -D LAMMPS_SOURCE_DIR=...), or use the "
      "lmp it was installed with.";
  auto setting = look_up<int(void *, const char *)>("lammps_extract_setting");
  if (!setting || setting(lammps, "universe_rank") == 0)
    std::fprintf(stderr, "WARNING: %s\n", refusal.c_str());

  // a LAMMPS with the package compiled in keeps its own fix
  auto has_style = look_up<int(void *, const char *, const char *)>("lammps_has_style");
  if (has_style && has_style(lammps, "fix", "gear/quat")) return;

  Style stand_in{};
  stand_in.lammps_version = GEARQUAT_LAMMPS_VERSION;
  stand_in.category = "fix";
  stand_in.name = "gear/quat";
  stand_in.description = "GEARQUAT, refused";
  stand_in.author = "the GEARQUAT authors";
  stand_in.creator.v2 = &refuse_fix;
  stand_in.handle = handle;
  reinterpret_cast<RegisterStyle *>(register_style)(&stand_in, lammps);
}
