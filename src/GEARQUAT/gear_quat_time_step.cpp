/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_time_step.h"

#include "fix.h"
#include "force.h"
#include "modify.h"
#include "output.h"
#include "pair.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/// A length that no motion can have is refused before a run, by the look at the scene.
double TimeStep::follow()
{
  const double next = update->dt;
  if (next == 0.0 || !std::isfinite(next) || next == h) return 0.0;
  const double ratio = next / h;
  h = next;
  return ratio;
}

void TimeStep::change(double step)
{
  update->update_time();    // in every step: the sum has the same rounding in two runs as in one
  if (step != update->dt) set(step);
}

void TimeStep::change_begun(double step)
{
  const bigint before = update->ntimestep - 1;
  update->atime += (before - update->atimestep) * update->dt;
  update->atimestep = before;
  --update->ntimestep;    // a dump in intervals of time may not be due any more when this step ends
  set(step);
  ++update->ntimestep;
}

/// As fix dt/reset changes it; this fix learns of it with all others.
void TimeStep::set(double step)
{
  changing = true;
  update->dt = step;
  update->dt_default = 0;
  if (force->pair) force->pair->reset_dt();
  for (auto *fix : modify->get_fix_list()) fix->reset_dt();
  output->reset_dt();
  changing = false;
}

double TimeStep::beginning() const
{
  return update->atime + (update->ntimestep - 1 - update->atimestep) * update->dt;
}

double TimeStep::end() const
{
  return update->atime + (update->ntimestep - update->atimestep) * update->dt;
}
