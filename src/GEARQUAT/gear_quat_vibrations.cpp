/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_vibrations.h"

#include "gear_quat_startup.h"

#include "update.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

void Vibrations::begin_run()
{
  first = update->firststep;
  choose_end();
}

/// The end of the first window after the present step.  A window near the end of the run is left
/// out, because the last window would overlap with it.
void Vibrations::choose_end()
{
  bigint length = FIRST_WINDOW;
  while (update->firststep + length <= update->ntimestep) length *= 2;
  end = update->firststep + length;
  if (end > update->laststep - MotionSums::LEVELS) end = update->laststep;
  records.clear();
}

bool Vibrations::note_step(double h)
{
  if (update->firststep != first) begin_run();
  if (update->ntimestep <= end - MotionSums::LEVELS || update->ntimestep > end) return false;
  record(h);
  return update->ntimestep == end;
}

void Vibrations::record(double h)
{
  // forces of bodies that come or go are no vibrations
  if (h != width || bodies.changes() != changes) records.clear();
  width = h;
  changes = bodies.changes();
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    Record &one = records[bodies.body_at(ibody).id];
    if (one.steps == MotionSums::LEVELS) continue;
    const TaylorSeries series =
        local_series(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.acting(ibody), h);
    one.seconds[one.steps++] = MotionSums::derivative(series, 2);
  }
}

MotionSums Vibrations::sums()
{
  MotionSums here;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const auto one = records.find(bodies.body_at(ibody).id);
    if (one != records.end() && one->second.steps == MotionSums::LEVELS)
      here.add(bodies.rigid_of(ibody), bodies.state_of(ibody), one->second.seconds, width);
  }
  choose_end();
  return here;
}
