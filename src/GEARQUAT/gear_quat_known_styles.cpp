/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_known_styles.h"

#include "bond.h"
#include "compute.h"
#include "fix.h"
#include "force.h"
#include "lammps.h"
#include "modify.h"
#include "pair.h"
#include "utils.h"

#include <algorithm>
#include <cstring>
#include <iterator>

using namespace LAMMPS_NS;
using namespace GearQuat;

namespace {

template <typename What> struct StyleFact {
  What what;
  const char *pattern, *reason;
};

struct Word {
  const char *text, *reason;
};

}    // namespace

/* ----------------------------------------------------------------------
   tables
------------------------------------------------------------------------- */

static constexpr StyleFact<PairFact> PAIRS[] = {
    {PairFact::UNREPEATABLE, "^[emst]?dpd", "random forces, but not in mdpd/rhosum"},
    {PairFact::UNREPEATABLE, "^gran", "histories of contacts grow, but not in gran/hooke"},
    {PairFact::UNREPEATABLE, "^brownian", "random forces, scaled by the time step"},
    {PairFact::UNREPEATABLE, "^dsmc", "random collisions change velocities"},
    {PairFact::UNREPEATABLE, "^reax",
     "fix qeq finds its charges, beginning with charges of earlier steps"},
    {PairFact::UNREPEATABLE, "^bpm",
     "no memory of its own, but it is used with bonds bpm, which break"},
    {PairFact::UNREPEATABLE, "^amoeba", "induced dipoles are predicted from earlier evaluations"},
    {PairFact::UNREPEATABLE, "^hippo", "as amoeba"},
    {PairFact::UNREPEATABLE, "^tracker", "keeps and counts contacts"},
    {PairFact::UNREPEATABLE, "^peri", "bonds break, and peri/ves has a viscoelastic history"},
    {PairFact::UNREPEATABLE, "^rheo",
     "reads kernels and interfaces that fix rheo computes once in a step"},
    {PairFact::UNREPEATABLE, "^smd",
     "deformations, stresses and damage are integrated by every evaluation"},
    {PairFact::RANDOM, "^[emst]?dpd", "friction and a random force on every pair"},
    {PairFact::RANDOM, "^brownian", "friction and a random force on every atom"},
    {PairFact::RANDOM, "^dsmc", "random collisions"},
    {PairFact::DISSIPATIVE, "^gran", "forces set in, and are damped, where particles touch"},
    {PairFact::DISSIPATIVE, "^bpm", "as gran"},
    {PairFact::DISSIPATIVE, "^lubricate", "friction of the fluid between particles"},
    {PairFact::DISSIPATIVE, "^sph", "viscosity"},
    {PairFact::DISSIPATIVE, "^rheo", "viscosity"},
    {PairFact::DISSIPATIVE, "^smd", "viscosity"},
    {PairFact::DISSIPATIVE, "^mesocnt/viscous", "friction between tubes"},
    {PairFact::READS_VARIABLES, "^hybrid/scaled", "factors of its styles are numbers or variables"},
    {PairFact::BACKGROUND, "^brownian", "friction and random forces of a fluid at rest"},
    {PairFact::BACKGROUND, "^lubricate", "friction with a fluid, and a flow if there is one"},
};

// whole names, as compared by Force::bond_match()

static constexpr Word UNREPEATABLE_BONDS[] = {
    {"quartic", "sets the type of a broken bond to 0"},
    {"quartic/omp", "as quartic"},
    {"bpm/rotational", "breaks bonds, and keeps their reference state"},
    {"bpm/spring", "breaks bonds, and keeps their reference length"},
    {"bpm/spring/plastic", "as bpm/spring, and reference lengths yield"},
    {"rheo/shell", "makes bonds after a time of contact, and breaks them"},
};

static constexpr Word UNREPEATABLE_VARIABLES[] = {
    {"random(", "draws a number"},
    {"normal(", "draws a number"},
    {"next(", "takes the next value of an atomfile or file variable"},
    {"py_", "a function of Python, which may do anything"},
    {"style = python", "a function of Python, which may do anything"},
};

static constexpr Word RUN_STYLES[] = {
    {"^verlet/split", "evaluates long-range forces on other ranks"},
    {"^verlet/lrt", "evaluates long-range forces in another thread"},
};

static constexpr StyleFact<FixFact> FIXES[] = {
    {FixFact::REPEATABLE, "^addforce", "constants, or variables of positions and the time"},
    {FixFact::REPEATABLE, "^efield",
     "charges and dipoles in a field of constants, variables or positions"},
    {FixFact::REPEATABLE, "^enforce2d", "sets components along z to 0"},
    {FixFact::REPEATABLE, "^freeze$", "sets forces and torques to 0"},
    {FixFact::REPEATABLE, "^gravity", "mass times a constant or variable"},
    {FixFact::REPEATABLE, "^indent$", "a function of positions and variables"},
    {FixFact::REPEATABLE, "^lineforce", "removes components"},
    {FixFact::REPEATABLE, "^planeforce", "removes a component"},
    {FixFact::REPEATABLE, "^setforce", "constants, or variables of positions and the time"},
    {FixFact::REPEATABLE, "^spring$", "a function of centers of mass"},
    {FixFact::REPEATABLE, "^spring/self", "a function of present and initial positions"},
    {FixFact::REPEATABLE, "^viscous$", "a function of velocities"},
    {FixFact::REPEATABLE, "^wall/harmonic", "a function of positions and the place of the wall"},
    {FixFact::REPEATABLE, "^wall/lj", "as wall/harmonic: wall/lj93, wall/lj126 and wall/lj1043"},
    {FixFact::REPEATABLE, "^wall/morse", "as wall/harmonic"},
    {FixFact::REPEATABLE, "^wall/colloid", "as wall/harmonic"},
    {FixFact::REPEATABLE, "^wall/region$",
     "a function of positions and the region, which may follow variables"},
    {FixFact::REPEATABLE, "^wall/table", "as wall/harmonic"},
    {FixFact::WITHOUT_VARIABLES, "^enforce2d", "no arguments"},
    {FixFact::WITHOUT_VARIABLES, "^freeze$", "no arguments"},
    {FixFact::WITHOUT_VARIABLES, "^lineforce", "three numbers"},
    {FixFact::WITHOUT_VARIABLES, "^planeforce", "three numbers"},
    {FixFact::WITHOUT_VARIABLES, "^spring$", "numbers"},
    {FixFact::WITHOUT_VARIABLES, "^viscous$", "numbers"},
    {FixFact::RANDOM, "^langevin", "random forces in every step, with friction"},
    {FixFact::RANDOM, "^brownian", "random displacements, and it integrates itself"},
    {FixFact::RANDOM, "^gle", "random changes of velocities with memory, and it integrates itself"},
    {FixFact::RANDOM, "^gld", "random forces with memory, and it integrates itself"},
    {FixFact::RANDOM, "^ttm", "random forces by the temperature of electrons"},
    {FixFact::RANDOM, "^qtb", "random forces with memory, with friction"},
    {FixFact::RANDOM, "^srd", "collisions with its particles, each a force of one step"},
    {FixFact::DISSIPATIVE, "^wall/gran", "forces set in, and are damped, where particles touch it"},
    {FixFact::DISSIPATIVE, "^damping/cundall", "its forces change sign with velocities"},
    {FixFact::BESIDE_GROUP, "^srd", "its particles collide with atoms of another group"},
    {FixFact::THERMOSTAT, "^temp/", "scales velocities, or mixes them with random ones"},
    {FixFact::THERMOSTAT, "^langevin", "friction and random forces"},
    {FixFact::THERMOSTAT, "^gle$", "friction with memory and random forces"},
    {FixFact::THERMOSTAT, "^gld$", "friction with memory and random forces"},
    {FixFact::THERMOSTAT, "^lambda_thermostat", "scales velocities"},
    {FixFact::TIME_STEP, "^dt/reset", "sets update->dt by velocities and forces"},
    {FixFact::BODY_OF_ATOMS, "^rigid.*/small", nullptr},    // its array is filled after init()
    {FixFact::BODY_OF_ATOMS, "^rigid", "FixRigid::extract() gives its array body"},
    {FixFact::FIRST_RIGID, "^wall/gran",
     "FixWallGran::init() stops its search at the first fix with rigid_flag"},
    {FixFact::CARRIES_BODIES, "^deform", "with remap x; with v and none no atom is moved"},
    {FixFact::CARRIES_BODIES, "^np[th]$", "FixNH::remap()"},
    {FixFact::CARRIES_BODIES, "^np[th]/[abceigos]",
     "variants of npt and nph, but not npt/uef and npt/kk"},
    {FixFact::CARRIES_BODIES, "^press/", "remap() of press/berendsen and press/langevin"},
    {FixFact::CARRIES_BODIES, "^rigid/np[th]", "FixRigidNH::remap()"},
    {FixFact::CARRIES_BODIES, "^bocs", "FixBocs::remap()"},
    {FixFact::CARRIES_BODIES, "^tgnp[th]", "FixTGNHDrude::remap()"},
    {FixFact::CARRIES_BODIES, "^box/relax", "remap() between minimizations"},
    {FixFact::NO_FORCE, "^enforce2d", "sets components along z to 0, where nothing is held"},
    {FixFact::NO_FORCE, "^store/force", "copies forces"},
    {FixFact::NO_FORCE, "^numdiff", "differences of energies, after which forces are put back"},
    {FixFact::NO_FORCE, "^nonaffine/displacement", "reads positions"},
    {FixFact::NO_FORCE, "^INTEL", "adds up what threads have computed"},
    {FixFact::NO_FORCE, "^GPU", "receives what a device has computed"},
    {FixFact::NO_LOCAL_DATA, "^ave/atom", "per-atom data"},
    {FixFact::NO_LOCAL_DATA, "^ave/chunk", "per-atom data"},
    {FixFact::NO_LOCAL_DATA, "^ave/correlate", "global data"},
    {FixFact::NO_LOCAL_DATA, "^ave/grid", "per-atom and per-grid data"},
    {FixFact::NO_LOCAL_DATA, "^ave/time", "global data"},
    {FixFact::NO_LOCAL_DATA, "^balance", "weights of atoms"},
    {FixFact::NO_LOCAL_DATA, "^ehex", "velocities"},
    {FixFact::NO_LOCAL_DATA, "^enforce2d", "velocities"},
    {FixFact::NO_LOCAL_DATA, "^halt", "a variable, which has global data"},
    {FixFact::NO_LOCAL_DATA, "^heat", "velocities"},
    {FixFact::NO_LOCAL_DATA, "^momentum", "velocities"},
    {FixFact::NO_LOCAL_DATA, "^print", "variables, which have global data"},
    {FixFact::NO_LOCAL_DATA, "^temp/", "velocities"},
    {FixFact::NO_LOCAL_DATA, "^vector", "global data"},
    {FixFact::THREADS, "^OMP", "FixOMP::pre_force() calls ThrData::init_force()"},
};

static constexpr StyleFact<ComputeFact> COMPUTES[] = {
    {ComputeFact::READS_LOCAL_DATA, "^reduce", "its inputs may be local data of a fix"},
    {ComputeFact::ADDS_UP, "^.*/tally",
     "Pair::ev_tally() calls it for every pair of every evaluation"},
};

static constexpr char GROUP[] = "give it a group without atoms of bodies";
static constexpr char THERMOSTAT[] =
    "use fix temp/csvr or temp/berendsen, which act on bodies, or fix langevin";
static constexpr char CONSTRAINTS[] =
    "take the bonds and angles of bodies out of it: bodies are rigid already";
static constexpr char WALL[] = "use a wall that exerts a force, such as fix wall/harmonic";
static constexpr char ONE[] = "unfix one of the two";

// doc/src/fix_gear_quat.rst has the same table

static constexpr ActOnAtoms ACTS_ON_ATOMS[] = {
    {"^momentum", ActOnAtoms::MOMENTUM, ActOnAtoms::GROUP,
     "subtracts velocities of a rigid motion, of the group or of chunks", ""},
    {"^temp/rescale$", ActOnAtoms::TEMPERATURE, ActOnAtoms::GROUP, "one factor for all", ""},
    {"^temp/berendsen", ActOnAtoms::TEMPERATURE, ActOnAtoms::GROUP, "one factor for all", ""},
    {"^temp/csvr", ActOnAtoms::TEMPERATURE, ActOnAtoms::GROUP, "one factor for all", ""},
    {"^heat$", ActOnAtoms::TEMPERATURE, ActOnAtoms::GROUP,
     "one factor, and one velocity subtracted", ""},
    {"^wall/reflect", ActOnAtoms::REFLECTION, ActOnAtoms::GROUP,
     "mirrors positions and velocities of atoms beyond the wall", WALL},
    {"^wall/piston$", ActOnAtoms::REFLECTION, ActOnAtoms::GROUP,
     "mirrors positions and velocities of atoms beyond the wall", WALL},
    {"^temp/csld", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "mixes each velocity with a random one",
     THERMOSTAT},
    {"^temp/rescale/eff", ActOnAtoms::SINGLE, ActOnAtoms::GROUP,
     "scales radial velocities of electrons too, by a temperature of both", THERMOSTAT},
    {"^lambda_thermostat", ActOnAtoms::SINGLE, ActOnAtoms::GROUP,
     "changes velocities of some atoms at a time (later than 4 Feb 2025)", THERMOSTAT},
    {"^langevin", ActOnAtoms::SINGLE, ActOnAtoms::AT_INTEGRATION,
     "with gjf it exchanges velocities and scales forces before the step",
     "leave out its keyword gjf"},
    {"^ehex", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "displaces atoms besides scaling velocities",
     "use fix heat without a region, on groups of whole bodies"},
    {"^thermal/conductivity", ActOnAtoms::SINGLE, ActOnAtoms::GROUP,
     "exchanges the energies of two atoms", GROUP},
    {"^viscosity", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "exchanges momenta of two atoms", GROUP},
    {"^oneway", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "reverses velocities of atoms in a region",
     GROUP},
    {"^shardlow", ActOnAtoms::SINGLE, ActOnAtoms::GROUP,
     "random changes of velocities, pair by pair", GROUP},
    {"^lb/momentum", ActOnAtoms::SINGLE, ActOnAtoms::GROUP,
     "subtracts the velocity of atoms and fluid together", "use fix momentum"},
    {"^lb/viscous", ActOnAtoms::IMPULSE, ActOnAtoms::GROUP,
     "fluid and atoms exchange momentum in each step, whatever its length",
     "use fix rigid for them"},
    {"^wall/flow", ActOnAtoms::SINGLE, ActOnAtoms::GROUP,
     "gives a new random velocity to atoms that pass a plane", GROUP},
    {"^smd/setvel", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "sets velocities", GROUP},
    {"^sph/stationary", ActOnAtoms::SINGLE, ActOnAtoms::GROUP,
     "advances densities and energies, as this fix does for bodies", GROUP},
    {"^tmd$", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "moves atoms towards a target",
     "use fix spring or fix spring/self"},
    {"^recenter", ActOnAtoms::SINGLE, ActOnAtoms::ANY,
     "shifts positions of atoms, or of another group with keyword shift",
     "use fix momentum, and subtract the center of mass in the analysis"},
    {"^shake", ActOnAtoms::SINGLE, ActOnAtoms::CONSTRAINED,
     "subtracts the degrees of freedom as well", CONSTRAINTS},
    {"^rattle", ActOnAtoms::SINGLE, ActOnAtoms::CONSTRAINED, "as shake, and corrects velocities",
     CONSTRAINTS},
    {"^ilves", ActOnAtoms::SINGLE, ActOnAtoms::CONSTRAINED, "as shake (later than 4 Feb 2025)",
     CONSTRAINTS},
    {"^atom/swap", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "exchanges types of two atoms", GROUP},
    {"^mol/swap", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "exchanges types of atoms of a molecule",
     GROUP},
    {"^neighbor/swap", ActOnAtoms::SINGLE, ActOnAtoms::GROUP,
     "exchanges types of two atoms (later than 4 Feb 2025)", GROUP},
    {"^sgcmc", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "changes types of atoms", GROUP},
    {"^gcmc", ActOnAtoms::EXCHANGE, ActOnAtoms::GROUP,
     "inserts and removes atoms or, with keywords mol and rigid, whole bodies; without rigid it "
     "may "
     "move them",
     "to exchange whole bodies use its keywords mol and rigid, without MC moves, and keyword mol "
     "of "
     "fix gear/quat"},
    {"^charge/regulation", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "inserts and removes ions",
     GROUP},
    {"^gemc", ActOnAtoms::SINGLE, ActOnAtoms::ANY,
     "exchanges atoms between two boxes and changes these (later than 4 Feb 2025)", ONE},
    {"^hmc", ActOnAtoms::SINGLE, ActOnAtoms::ANY,
     "puts back atoms and knows bodies of rigid/small alone (later than 4 Feb 2025)",
     "use fix rigid/small with fix hmc"},
    {"^pimd", ActOnAtoms::SINGLE, ActOnAtoms::GROUP, "integrates beads of a ring polymer", GROUP},
    {"^ipi", ActOnAtoms::SINGLE, ActOnAtoms::ANY, "takes positions and the box from a server", ONE},
};

/* ----------------------------------------------------------------------
   matching
------------------------------------------------------------------------- */

template <typename What, int N, typename Matches>
static const char *reason_in(const StyleFact<What> (&table)[N], What what, Matches matches)
{
  for (const auto &row : table)
    if (row.what == what && matches(row.pattern)) return row.reason;
  return nullptr;
}

std::string GearQuat::name_of(const Fix *fix)
{
  return fmt::format("fix {} ({})", fix->id, fix->style);
}

const char *GearQuat::known(PairFact what, const Force *force)
{
  return reason_in(PAIRS, what, [force](const char *pattern) {
    return force->pair && const_cast<Force *>(force)->pair_match(pattern, 0, 1);
  });
}

const char *GearQuat::known(FixFact what, const Fix *fix)
{
  return reason_in(FIXES, what, [fix](const char *pattern) {
    return utils::strmatch(fix->style, pattern);
  });
}

const Fix *GearQuat::fix_with_forces(LAMMPS *lmp, const Fix *owner)
{
  constexpr int ON_FORCES = FixConst::POST_FORCE | FixConst::PRE_REVERSE;
  for (auto *other : lmp->modify->get_fix_list())
    if (other != owner && (lmp->modify->get_fix_mask(other) & ON_FORCES) &&
        !known(FixFact::THREADS, other) && !known(FixFact::NO_FORCE, other))
      return other;
  return nullptr;
}

const char *GearQuat::known(ComputeFact what, const Compute *compute)
{
  return reason_in(COMPUTES, what, [compute](const char *pattern) {
    return utils::strmatch(compute->style, pattern);
  });
}

const char *GearQuat::unrepeatable_run_style(const std::string &style)
{
  for (const auto &row : RUN_STYLES)
    if (utils::strmatch(style, row.text)) return row.reason;
  return nullptr;
}

const char *GearQuat::unrepeatable_bond(const Force *force)
{
  for (const auto &bond : UNREPEATABLE_BONDS)
    if (const_cast<Force *>(force)->bond_match(bond.text)) return bond.text;
  return nullptr;
}

bool GearQuat::is_unrepeatable(const std::string &variable)
{
  return std::any_of(std::begin(UNREPEATABLE_VARIABLES), std::end(UNREPEATABLE_VARIABLES),
                     [&variable](const Word &word) {
                       return variable.find(word.text) != std::string::npos;
                     });
}

static std::string repeatable_line(const std::string &name, bool repeatable)
{
  return name + (repeatable ? ": yes" : ": no");
}

std::vector<std::string> GearQuat::repeatable_forces(LAMMPS *lmp)
{
  const Force *force = lmp->force;
  std::vector<std::string> lines;
  if (force->pair)
    lines.push_back(repeatable_line(fmt::format("pair style {}", force->pair_style),
                                    !known(PairFact::UNREPEATABLE, force)));
  if (force->bond)
    lines.push_back(repeatable_line(fmt::format("bond style {}", force->bond_style),
                                    !unrepeatable_bond(force)));
  for (auto *fix : lmp->modify->get_fix_list())
    if (lmp->modify->get_fix_mask(fix) & FixConst::POST_FORCE)
      lines.push_back(repeatable_line(name_of(fix), known(FixFact::REPEATABLE, fix)));
  return lines;
}

bool GearQuat::exerts_forces(const void *style, const char *name)
{
  return style && std::strcmp(name, "zero") != 0;
}

const ActOnAtoms *GearQuat::act_on_atoms(const Fix *fix)
{
  for (const auto &row : ACTS_ON_ATOMS)
    if (utils::strmatch(fix->style, row.pattern)) return &row;
  return nullptr;
}
