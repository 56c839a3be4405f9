/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The end of a run in which a body has become unstable. */

#ifndef LMP_GEAR_QUAT_BLOWUP_H
#define LMP_GEAR_QUAT_BLOWUP_H

#include "gear_quat_arguments.h"
#include "gear_quat_bath.h"
#include "gear_quat_limits.h"
#include "gear_quat_sites.h"

#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// The form of all sentences about rates, without a full stop.
std::string words_of(const Rate &rate);

class Blowup : protected Pointers {
 public:
  Blowup(LAMMPS *lmp, const Arguments &args, const Bodies &bodies, const Sites &sites,
         const Bath &bath) :
      Pointers(lmp),
      args(args), bodies(bodies), sites(sites), bath(bath)
  {
  }

  std::vector<Rate> rates;    ///< the table of rates, as of its last look
  MotionLimits limits;        ///< for the current step and box

  /// Ends the run if the present loads would make an owned body unstable within a step h.  Atoms
  /// are at the positions of the loads; f: forces on them.
  void watch_loads(double h, double **f) const;
  /// Ends the run if the present load would make this body unstable within a step h.
  void watch_load(int ibody, double h, double **f) const;
  /// Ends the run on all ranks, called by the rank that owns the body (for a large one, by all of
  /// them together).  The message gives step, time, body, its motion and load, its atom with the
  /// largest force, and one remedy.  s: the resulting state, beyond the limits.
  [[noreturn]] void stop(int ibody, const BodyState &s, double h, double **f) const;

 private:
  const Arguments &args;
  const Bodies &bodies;
  const Sites &sites;
  const Bath &bath;

  std::string what_happened(int ibody, const BodyState &s, double h) const;
  std::string remedy(int ibody, const BodyState &s, double h) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
