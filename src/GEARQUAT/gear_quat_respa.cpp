/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_respa.h"

#include "atom.h"
#include "fix.h"
#include "memory.h"
#include "modify.h"
#include "update.h"

#if __has_include("respa.h")
#include "respa.h"
#else    // the LAMMPS of the Python package comes without that header
#include "library.h"
#endif

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

RespaForces::RespaForces(LAMMPS *lmp) : Pointers(lmp), f(nullptr), torque(nullptr), nmax(0) {}

RespaForces::~RespaForces()
{
  memory->destroy(f);
  memory->destroy(torque);
}

bool RespaForces::outermost(int level) const
{
  return level == levels() - 1;
}

int RespaForces::levels() const
{
  return (int) steps(lmp).size();
}

std::vector<double> RespaForces::steps(LAMMPS *lmp)
{
#if __has_include("respa.h")
  const auto *integrate = dynamic_cast<Respa *>(lmp->update->integrate);
  const int levels = integrate ? integrate->nlevels : 0;
  const double *first = integrate ? integrate->step : nullptr;
#else
  const bool respa = utils::strmatch(lmp->update->integrate_style, "^respa");
  const int levels = respa ? *(const int *) lammps_extract_global(lmp, "respa_levels") : 0;
  const auto *first = respa ? (const double *) lammps_extract_global(lmp, "respa_dt") : nullptr;
#endif
  return std::vector<double>(first, first + levels);
}

/// Atoms may have been exchanged since the step began.
void RespaForces::begin()
{
  if (atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(f);
    memory->destroy(torque);
    memory->create(f, nmax, 3, "gear/quat:f_sum");
    if (atom->torque_flag) memory->create(torque, nmax, 3, "gear/quat:torque_sum");
  }
  std::fill_n(f[0], 3 * (size_t) nmax, 0.0);
  if (torque) std::fill_n(torque[0], 3 * (size_t) nmax, 0.0);
}

void RespaForces::add(int level)
{
  if (level == 0) begin();
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = 0; k < 3; ++k) f[i][k] += atom->f[i][k];
  if (!torque) return;
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = 0; k < 3; ++k) torque[i][k] += atom->torque[i][k];
}

/// LAMMPS keeps them in a fix of its own, that packs for each atom 3 numbers a level: forces, then
/// torques.
void RespaForces::sum_present()
{
  begin();
  Fix *store = modify->get_fix_by_id("RESPA");
  const int n = levels();
  std::vector<double> stored((torque ? 6 : 3) * (size_t) n);
  for (int i = 0; i < atom->nlocal; ++i) {
    store->pack_exchange(i, stored.data());
    for (int j = 0; j < 3 * n; ++j) {
      f[i][j % 3] += stored[j];
      if (torque) torque[i][j % 3] += stored[3 * n + j];
    }
  }
}

double RespaForces::memory_usage() const
{
  return (torque ? 6.0 : 3.0) * nmax * sizeof(double);
}
