/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_checks.h"

#include "gear_quat_bodies.h"
#include "gear_quat_peer.h"
#include "gear_quat_respa.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/// Forces are evaluated once per step, so all levels of r-RESPA need the same time step.
static void refuse_respa_with_steps(LAMMPS *lmp)
{
  const std::vector<double> steps = RespaForces::steps(lmp);
  for (size_t level = 1; level < steps.size(); ++level)
    if (steps[level] != steps[0])
      lmp->error->all(FLERR,
                      "Fix gear/quat requires run_style respa to have the same step at all levels "
                      "(loop factors of 1); levels 1 and {} have {} and {}",
                      level + 1, steps[0], steps[level]);
}

/// A box that follows its atoms moves none of them, but a fix that changes the box does.
static void refuse_box_changes(LAMMPS *lmp)
{
  for (const auto *other : lmp->modify->get_fix_list())
    if (other->box_change & (Fix::BOX_CHANGE_SIZE | Fix::BOX_CHANGE_SHAPE))
      lmp->error->all(FLERR,
                      "Fix gear/quat requires a box that does not change size or shape, and fix {} "
                      "({}) changes it",
                      other->id, other->style);
}

static void refuse_other_integrators(LAMMPS *lmp, const Fix *fix, const Bodies &bodies)
{
  for (auto *other : lmp->modify->get_fix_list()) {
    if (other == fix || !other->time_integrate) continue;
    const auto *same = dynamic_cast<const Peer *>(other);
    int dim;
    const int *its_body =
        utils::strmatch(other->style, "^rigid") && !utils::strmatch(other->style, "/small")
        ? (int *) other->extract("body", dim)
        : nullptr;
    const Atom *atom = lmp->atom;
    tagint shared = 0, any;
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!bodies.in_body(i) || !(atom->mask[i] & other->groupbit)) continue;
      if (same && !same->moves(i)) continue;
      if (its_body && its_body[i] < 0) continue;
      shared = atom->tag[i];
    }
    MPI_Allreduce(&shared, &any, 1, MPI_LMP_TAGINT, MPI_MAX, lmp->world);
    if (any)
      lmp->error->all(FLERR,
                      "Fix gear/quat: atom {} is also moved by fix {} ({}); take it out of the "
                      "group of one of the two",
                      any, other->id, other->style);
  }
}

/// Granular walls ask only the first rigid fix for the masses of its bodies; pair styles refuse a
/// second one.
static void warn_of_walls(LAMMPS *lmp, const Fix *fix)
{
  const Fix *first = nullptr;
  for (const auto *other : lmp->modify->get_fix_list())
    if (!first && other->rigid_flag) first = other;
  if (first == fix || lmp->comm->me != 0) return;
  for (const auto *other : lmp->modify->get_fix_list())
    if (utils::strmatch(other->style, "^wall/gran"))
      lmp->error->warning(FLERR,
                          "Fix gear/quat: fix {} ({}) knows the bodies of fix {} only and damps "
                          "contacts of those of fix {} with the masses of atoms; use one fix for "
                          "all bodies",
                          other->id, other->style, first->id, fix->id);
}

void GearQuat::refuse_scene(LAMMPS *lmp, const Fix *fix, const Bodies &bodies)
{
  if (lmp->update->whichflag == 2)
    lmp->error->all(FLERR, "Fix gear/quat cannot be used with minimize: unfix it first");
  if (lmp->update->dt == 0.0 || !std::isfinite(lmp->update->dt))
    lmp->error->all(FLERR, "Fix gear/quat requires a time step that is not zero, it is {}",
                    lmp->update->dt);
  refuse_box_changes(lmp);
  bodies.refuse_atoms();
  refuse_respa_with_steps(lmp);
  refuse_other_integrators(lmp, fix, bodies);
  warn_of_walls(lmp, fix);
}
