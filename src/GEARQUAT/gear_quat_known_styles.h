/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Properties of other LAMMPS styles, looked up by name.  LAMMPS does not declare these properties,
   so they were taken from its source code; every row of a table states its reason.  The callers
   decide on the consequences.  In each table the first matching row counts.  Patterns have the syntax of
   utils::strmatch() and begin with ^, so that they are not found within other names. */

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

/// The name of a fix in messages: ID and style.
std::string name_of(const Fix *fix);

/// Properties of a pair style, also as a part of a hybrid style.
enum class PairFact {
  UNREPEATABLE,       ///< its forces differ, or may differ, when they are evaluated again
  RANDOM,             ///< its forces are random
  DISSIPATIVE,        ///< its forces damp motion, and may set in where atoms touch
  READS_VARIABLES,    ///< it may evaluate variables of the script
  BACKGROUND,         ///< forces between atoms and a fluid at rest: they change the total momentum
};

/// Properties of a fix.
enum class FixFact {
  REPEATABLE,    ///< post_force() is a function of positions, velocities and perhaps the time
                 ///< that changes forces and torques only
  THREADS,       ///< pre_force() clears the forces of the threads of the OPENMP package
  WITHOUT_VARIABLES,    ///< of REPEATABLE: evaluates no variables of the script
  RANDOM,               ///< its forces or changes of velocities are random
  DISSIPATIVE,          ///< its forces damp motion, and set in where atoms touch
  BESIDE_GROUP,         ///< its forces act on atoms outside of its group
  THERMOSTAT,           ///< it controls a temperature, by forces or by velocities
  TIME_STEP,            ///< it changes the time step
  BODY_OF_ATOMS,        ///< after init() extract("body") gives the body of each atom, or -1
  FIRST_RIGID,          ///< it takes the masses of bodies from the first rigid fix alone
  CARRIES_BODIES,       ///< it calls deform() of rigid fixes where it remaps atoms with the box
  NO_FORCE,             ///< it is called around the forces, but changes none
  NO_LOCAL_DATA,        ///< it is called at the end of a step, but reads no local data of a fix
};

/// Properties of a compute.
enum class ComputeFact {
  READS_LOCAL_DATA,    ///< it may read local data of a fix
  ADDS_UP,             ///< it accumulates the data of every evaluation of forces
};

/// The reason for this property of a style, null if the style does not have it.
const char *known(PairFact what, const Force *force);
const char *known(FixFact what, const Fix *fix);
const char *known(ComputeFact what, const Compute *compute);
/// The first other fix that may exert forces on atoms, null for none.
const Fix *fix_with_forces(LAMMPS *lmp, const Fix *owner);
/// One line for each style: whether its forces can be evaluated again, and the source of this
/// information.
std::vector<std::string> repeatable_forces(LAMMPS *lmp);
/// The bond style whose bonds may break or change for good when they are evaluated, null for none.
const char *unrepeatable_bond(const Force *force);
/// True if that variable, as shown by `info variables`, changes whenever it is evaluated.
bool is_unrepeatable(const std::string &variable);

/// The reason if a run style evaluates forces differently from LAMMPS' run styles verlet and respa,
/// otherwise null.
const char *unrepeatable_run_style(const std::string &style);

/// False for no style and for style zero, of pairs, bonds, angles, dihedrals or impropers.
bool exerts_forces(const void *style, const char *name);

/// The effect of a fix on velocities, positions, types or number of atoms.
struct ActOnAtoms {
  const char *pattern;
  enum {
    MOMENTUM,       ///< subtracts a rigid motion from velocities
    TEMPERATURE,    ///< scales velocities, uniformly unless a bias or a region divides them
                    ///< them
    REFLECTION,     ///< mirrors single atoms that reach a position
    IMPULSE,        ///< a force that is inversely proportional to the time step
    EXCHANGE,       ///< inserts and removes whole molecules, which may be bodies
    SINGLE          ///< changes atoms one by one
  } act;
  enum {
    GROUP,            ///< its group
    ANY,              ///< any atoms, for any group
    CONSTRAINED,      ///< atoms of its group whose degrees of freedom it subtracts
    AT_INTEGRATION    ///< its group, if a keyword makes it act in initial_integrate()
  } on;
  const char *reason;
  const char *instead;    ///< an alternative that is suitable for bodies
};
/// The effect of a fix on atoms, null if the fix is not known to have such an effect.
const ActOnAtoms *act_on_atoms(const Fix *fix);

}    // namespace LAMMPS_NS::GearQuat

#endif
