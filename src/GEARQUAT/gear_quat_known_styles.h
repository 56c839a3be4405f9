/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What this package knows about other styles of LAMMPS by their names.  LAMMPS does not tell these
   facts, so they were read in its source; every row of a table has its reason.  Where LAMMPS does
   tell them (gear_quat_declared.h), its word counts.  The callers decide what follows from a fact.
   In each table the first row that matches counts.  Patterns have the syntax of utils::strmatch(). */

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

/// As messages name a fix: with ID and style.
std::string name_of(const Fix *fix);

/// What is known of a pair style, also where it is a part of a hybrid one.
enum class PairFact {
  UNREPEATABLE,       ///< its forces are others when they are evaluated again, or so they may be
  RANDOM,             ///< its forces are random
  CONTACTS,           ///< its forces are those of contacts, with friction
  READS_VARIABLES,    ///< it may evaluate variables of the script
};

/// What is known of a fix, by one word each.
enum class FixFact {
  REPEATABLE,    ///< post_force() is a function of positions, velocities and perhaps the time
                 ///< that changes forces and torques only
  THREADS,       ///< pre_force() clears the forces of the threads of the OPENMP package
  WITHOUT_VARIABLES,    ///< of REPEATABLE: evaluates no variables of the script
  RANDOM,               ///< its forces or changes of velocities are random
  COLLISIONS,           ///< its forces are collisions, each of which lasts one step
  CONTACTS,             ///< its forces are those of contacts, with friction
  THERMOSTAT,           ///< it holds a temperature, by forces or by velocities
  TIME_STEP,            ///< it changes the time step
  BODY_OF_ATOMS,        ///< after init() extract("body") gives the body of each atom, or -1
  FIRST_RIGID,          ///< it takes the masses of bodies from the first rigid fix alone
  CARRIES_BODIES,       ///< it calls deform() of rigid fixes where it remaps atoms with the box
  NO_FORCE,             ///< it acts around the forces, but changes none
  NO_LOCAL_DATA,        ///< it acts at the end of a step, but reads no local data of a fix itself
};

/// What is known of a compute.
enum class ComputeFact {
  READS_LOCAL_DATA,    ///< it may read local data of a fix
  ADDS_UP,             ///< it adds up what every evaluation of forces tells it
};

/// The reason for what is known of a style, null if it is not known of it.
const char *known(PairFact what, const Force *force);
const char *known(FixFact what, const Fix *fix);
const char *known(ComputeFact what, const Compute *compute);
/// Whether, and by whom, forces of all styles can be evaluated again: a line each.
std::vector<std::string> sources_of_repeatability(LAMMPS *lmp);
/// The bond style whose bonds may break or change for good when they are evaluated, null for none.
const char *unrepeatable_bond(const Force *force);
/// True if that variable, as `info variables` shows it, is another one whenever it is evaluated.
bool is_unrepeatable(const std::string &variable);

/// Why a run style evaluates forces otherwise than LAMMPS' run styles verlet and respa, null if not.
const char *unrepeatable_run_style(const std::string &style);

/// False for no style and for style zero, of pairs, bonds, angles, dihedrals or impropers.
bool exerts_forces(const void *style, const char *name);

/// What a fix does to velocities, places, types or number of atoms.
struct ActOnAtoms {
  const char *pattern;
  enum {
    MOMENTUM,       ///< subtracts a rigid motion from velocities
    TEMPERATURE,    ///< scales velocities, all of them alike unless a bias or a region divides them
    REFLECTION,     ///< mirrors single atoms that reach a place
    IMPULSE,        ///< a force that is inversely proportional to the time step
    SINGLE          ///< changes atoms one by one
  } act;
  enum {
    GROUP,            ///< its group
    ANY,              ///< any atoms, whatever its group
    CONSTRAINED,      ///< atoms of its group whose degrees of freedom it subtracts
    AT_INTEGRATION    ///< its group, if a keyword makes it act in initial_integrate()
  } on;
  const char *reason;
  const char *instead;    ///< what suits bodies
};
/// Null for a fix that does nothing of that, as far as is known.
const ActOnAtoms *act_on_atoms(const Fix *fix);

}    // namespace LAMMPS_NS::GearQuat

#endif
