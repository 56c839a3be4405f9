/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_repeat.h"

#include "gear_quat_known_styles.h"

#include "comm.h"
#include "compute.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

void Repeat::begin_run()
{
  forces.reset(new Forces(lmp, {owner}));
  const std::string why = reason();
  if (why.empty()) return;
  forces.reset();
  if (comm->me == 0 && why != told)
    utils::logmesg(lmp,
                   "Fix gear/quat tolerance: no step is repeated, because {}; errors exceed the "
                   "tolerance where forces change suddenly\n",
                   why);
  told = why;
}

/// Why steps cannot be repeated, empty if they can.
std::string Repeat::reason() const
{
  if (!forces->reason().empty()) return forces->reason();
  for (const auto *one : modify->get_compute_list())
    if (known(ComputeFact::ADDS_UP, one))
      return fmt::format("compute {} ({}) adds up every evaluation of forces", one->id, one->style);
  return "";
}

void Repeat::evaluate(int vflag)
{
  modify->clearstep_compute();             // what computes found belongs to other positions
  const bigint now = update->ntimestep;    // as Integrate::ev_set() has set them
  const int eflag = (update->eflag_global == now ? ENERGY_GLOBAL : 0) |
      (update->eflag_atom == now ? ENERGY_ATOM : 0);
  forces->evaluate(eflag, vflag);
}
