/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What is known of LAMMPS' styles by their names: one table for each kind of style, with one row for
   each beginning of a name, its facts, their reasons in LAMMPS' sources, and what to use instead. */

#ifndef LMP_GEAR_QUAT_KNOWN_STYLES_H
#define LMP_GEAR_QUAT_KNOWN_STYLES_H

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Compute;
class Fix;
class Force;
class LAMMPS;
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
    BESIDE_GROUP = 1 << 7,       ///< its forces act on atoms outside of its group
    TIME_STEP = 1 << 8,          ///< changes the time step
    BODY_OF_ATOMS = 1 << 9,      ///< extract("body") gives the body of each atom, or -1
    CARRIES_BODIES = 1 << 10,    ///< calls deform() of rigid fixes where it remaps atoms
    // effects of fixes on velocities, positions, types or number of atoms of their groups
    MOMENTUM = 1 << 11,    ///< subtracts a rigid motion from velocities
    TEMPERATURE =
        1 << 12,    ///< scales velocities, uniformly unless a bias or a region divides them
    REFLECTION = 1 << 13,    ///< mirrors single atoms that reach a position
    EXCHANGE = 1 << 14,      ///< inserts and removes whole molecules, which may be bodies
    SINGLE = 1 << 15,        ///< changes atoms one by one
    // atoms of a SINGLE change
    ANY = 1 << 16,               ///< any atoms, for any group
    CONSTRAINED = 1 << 17,       ///< those of its group whose degrees of freedom it subtracts
    AT_INTEGRATION = 1 << 18,    ///< its group, if a keyword makes it act in initial_integrate()

    ON_ATOMS = MOMENTUM | TEMPERATURE | REFLECTION | EXCHANGE | SINGLE
  };
}

/// A row of a table.
struct Style {
  const char *pattern;
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
/// True if there may be forces: styles other than "zero", or fixes called around the forces.
bool makes_forces(LAMMPS *lmp, const Fix *owner);
/// The name of a style that reads velocities between prediction and correction, or empty.  owner:
/// the calling fix.
std::string reader_of_predicted_velocities(LAMMPS *lmp, const Fix *owner);
/// True if an output or another fix may read data at the end of the present step.
bool reads_at_end(LAMMPS *lmp, const Fix *owner);
/// False for no style and for style zero, of pairs, bonds, angles, dihedrals or impropers.
bool exerts_forces(const void *style, const char *name);

}    // namespace LAMMPS_NS::GearQuat

#endif
