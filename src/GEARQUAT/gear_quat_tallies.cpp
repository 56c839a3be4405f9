/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_tallies.h"

#include "compute.h"
#include "modify.h"
#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr bigint NEVER = -1;

/// The notes of a compute that name the step of its last evaluation.
static std::vector<bigint *> steps_of_evaluation(Compute *one)
{
  return {&one->invoked_scalar, &one->invoked_vector, &one->invoked_array, &one->invoked_peratom,
          &one->invoked_local};
}

static std::vector<bigint *> steps_of_tally(Update *update)
{
  return {&update->eflag_global, &update->vflag_global, &update->eflag_atom, &update->vflag_atom};
}

/* ---------------------------------------------------------------------- */

void Tallies::save()
{
  notes.clear();
  for (auto *one : modify->get_compute_list()) {
    Note note = {one->invoked_flag, {}, {}};
    int n = 0;
    for (const auto *step : steps_of_evaluation(one)) note.invoked[n++] = *step;
    if (one->timeflag) note.steps.assign(one->tlist, one->tlist + one->ntime);
    notes.push_back(note);
  }
  int n = 0;
  for (const auto *step : steps_of_tally(update)) tallied[n++] = *step;
  modify->clearstep_compute();
}

void Tallies::pretend()
{
  for (auto *step : steps_of_tally(update)) *step = update->ntimestep;
}

bool Tallies::used() const
{
  const auto &computes = modify->get_compute_list();
  return std::any_of(computes.begin(), computes.end(), [](const Compute *one) {
    return one->timeflag && one->invoked_flag;
  });
}

void Tallies::restore()
{
  size_t which = 0;
  for (auto *one : modify->get_compute_list()) {
    const Note &note = notes[which++];
    int n = 0;
    one->invoked_flag = note.flag;
    for (auto *step : steps_of_evaluation(one)) {
      if (*step != note.invoked[n]) {
        *step = NEVER;
        one->invoked_flag = Compute::INVOKED_NONE;
      }
      ++n;
    }
    if (!one->timeflag) continue;
    one->clearstep();
    for (const bigint step : note.steps) one->addstep(step);
  }
  int n = 0;
  for (auto *step : steps_of_tally(update)) *step = tallied[n++];
}
