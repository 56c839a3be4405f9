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

/// An invalid length is refused earlier, by the checks before a run.
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
  update->update_time();    // in every step: rounding then does not depend on the number of runs
  if (step != update->dt) set(step);
}

void TimeStep::change_begun(double step)
{
  const bigint before = update->ntimestep - 1;
  update->atime += (before - update->atimestep) * update->dt;
  update->atimestep = before;
  --update->ntimestep;    // a dump in intervals of time may not be due at the new end of the step
  set(step);
  ++update->ntimestep;
}

/// Changes the step as fix dt/reset does; this fix is notified together with all others.
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
