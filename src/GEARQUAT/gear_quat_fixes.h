/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Other fixes that change velocities, positions or masses of the atoms of bodies.  Depending on the
   effect (gear_quat_known_styles.h), bodies adopt the change, the run ends when the change occurs,
   or the run does not begin.  Effects of styles that no table lists are detected by samples.

   The fix calls init() before every run; take_velocities() before a step, with the velocities left
   by the previous step; watch_places() after the forces, with the predicted positions. */

#ifndef LMP_GEAR_QUAT_FIXES_H
#define LMP_GEAR_QUAT_FIXES_H

#include "gear_quat_sites.h"
#include "gear_quat_stability.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Fix;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

struct Arguments;
struct Style;

/// The largest ID of an atom of a body in the group of that fix, 0 for none.  Collective.
tagint shared_atom(LAMMPS *lmp, const Ownership &ownership, const Fix *other);

/// Forces without derivatives on bodies, random ones first, and their style.
struct NoisyForces {
  Noise noise = Noise::NONE;
  std::string style;

  std::string words() const
  {
    return "forces of " + style + (noise == Noise::RANDOM ? " are random" : " are dissipative");
  }
};
/// Collective.
NoisyForces noise_of_forces(LAMMPS *lmp, const Ownership &ownership);

class OtherFixes : protected Pointers {
 public:
  OtherFixes(LAMMPS *lmp, const Fix *fix, Bodies &bodies, Ownership &ownership, Sites &sites,
             const Arguments &args);

  /// Ends the run if a fix of a style that bodies cannot follow acts on their atoms.  Collective.
  void init();
  /// True if some fix may change velocities and bodies adopt the change.
  bool any_taken() const { return !taken.empty(); }

  /// Rank 0 warns of fix gravity if it does not act on bodies, or acts with masses that differ from
  /// the masses of the bodies.  In setup(), before loads are gathered.  Collective.
  void warn_of_gravity();

  /// Returns bodies on this rank whose velocities other fixes have changed at the end of that step;
  /// their states have the new velocities, on all ranks.  A change that is not a rigid motion ends
  /// the run if `end`, and is otherwise ignored.  Collective.
  std::vector<int> take_velocities(bigint step, bool end);

  // These functions are local and test a single site, another one in each step, unless a fix is
  // known to move atoms.

  /// Before a step.  all: tests the positions and velocities of all sites.
  void watch_velocities(bool all);
  /// The forces have been evaluated.
  void watch_places();

 private:
  const Fix *fix;
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;
  const Arguments &args;
  std::vector<const Fix *> taken;      ///< bodies adopt velocities from these
  std::vector<const Fix *> watched;    ///< these may move single atoms
  int sample = 0;                      ///< the site that is tested next
  bool warned_noise = false;           ///< warned of random forces and the like
  bool warned_change = false;          ///< warned of an unknown change in this run

  void warn_of_noise();
  void refuse(Fix *other, const Style &row, tagint atom) const;
  void warn(const Site &site, const char *what);
  std::string names(const std::vector<const Fix *> &fixes) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
