/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Other styles by their names: a row with all facts of each, their reasons in LAMMPS' sources, and
   what to use instead. */

#ifndef LMP_GEAR_QUAT_STYLES_H
#define LMP_GEAR_QUAT_STYLES_H

#include "gear_quat_sites.h"
#include "gear_quat_stability.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Compute;
class Fix;
class Force;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

namespace Fact {
  enum : unsigned {
    // forces of any style
    UNREPEATABLE = 1 << 0,    ///< they differ, or may differ, when they are evaluated again
    RANDOM = 1 << 1,          ///< they, or the changes of velocities of a fix, are random
    DISSIPATIVE = 1 << 2,     ///< they damp motion, and may set in where atoms touch
    // pair styles
    BACKGROUND = 1 << 3,    ///< acts between atoms and a fluid at rest: momentum changes
    // fixes
    REPEATABLE = 1 << 4,    ///< post_force() is a function of positions, velocities and perhaps the
                            ///< time that changes forces and torques only
    THREADS = 1 << 5,       ///< pre_force() clears the forces of the threads of OPENMP
    NO_FORCE = 1 << 6,      ///< is called around the forces, but changes none
    BESIDE_GROUP = 1 << 7,      ///< its forces act on atoms outside of its group
    TIME_STEP = 1 << 8,         ///< changes the time step
    CARRIES_BODIES = 1 << 9,    ///< calls deform() of rigid fixes where it remaps atoms
    // effects of fixes on velocities, positions, types or number of atoms of their groups
    REFLECTION = 1 << 10,    ///< mirrors single atoms that reach a position
    EXCHANGE = 1 << 11,      ///< inserts and removes whole molecules, which may be bodies
    CHANGE = 1 << 12,        ///< changes atoms, which bodies do not follow
    // atoms of a CHANGE
    ANY = 1 << 13,               ///< any atoms, for any group
    CONSTRAINED = 1 << 14,       ///< those of its group whose degrees of freedom it subtracts
    AT_INTEGRATION = 1 << 15,    ///< its group, if a keyword makes it act in initial_integrate()

    ON_ATOMS = REFLECTION | EXCHANGE | CHANGE
  };
}

/// A row of a table.
struct Style {
  const char *patterns;
  unsigned facts;
  const char *reason;
  const char *instead = "";    ///< an alternative that is suitable for bodies

  bool is(unsigned any_of) const { return facts & any_of; }
};

/// The first row of this style that has one of these facts, null for none; of a hybrid style, for
/// any of its styles.
const Style *known(unsigned any_of, const Fix *fix);
const Style *known_pair(unsigned any_of, const Force *force);
/// True if a compute accumulates the data of every evaluation of forces.
bool adds_up(const Compute *compute);

/// The name of a fix in messages: ID and style.
std::string name_of(const Fix *fix);
/// The other fixes that may exert forces on atoms, in the order in which LAMMPS calls them.
std::vector<const Fix *> fixes_with_forces(LAMMPS *lmp, const Fix *owner);
/// The name of a style that reads velocities between prediction and correction, or empty.  owner:
/// the calling fix.
std::string reader_of_predicted_velocities(LAMMPS *lmp, const Fix *owner);
/// True if an output or another fix may read data at the end of the present step.
bool reads_at_end(LAMMPS *lmp, const Fix *owner);

/* ---------------------------------------------------------------------- */

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

}    // namespace LAMMPS_NS::GearQuat

#endif
