/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_styles.h"

#include "gear_quat_arguments.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "compute.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "output.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace GearQuat;
using namespace Fact;

/* ----------------------------------------------------------------------
   tables
------------------------------------------------------------------------- */

static constexpr Style PAIRS[] = {
    {"^[emst]?dpd", UNREPEATABLE | RANDOM, "friction and random forces, but not mdpd/rhosum"},
    {"^gran", UNREPEATABLE | DISSIPATIVE, "histories of contacts, but not in gran/hooke; friction"},
    {"^brownian", UNREPEATABLE | RANDOM | BACKGROUND, "forces of a fluid, by the time step"},
    {"^dsmc", UNREPEATABLE | RANDOM, "random collisions change velocities"},
    {"^reax", UNREPEATABLE, "charges of fix qeq depend on earlier steps"},
    {"^bpm", UNREPEATABLE | DISSIPATIVE, "used with bonds bpm, which break; friction"},
    {"^amoeba", UNREPEATABLE, "induced dipoles are predicted from earlier evaluations"},
    {"^hippo", UNREPEATABLE, "as amoeba"},
    {"^tracker", UNREPEATABLE, "keeps and counts contacts"},
    {"^peri", UNREPEATABLE, "bonds break, and peri/ves has a viscoelastic history"},
    {"^rheo", UNREPEATABLE | DISSIPATIVE, "reads what fix rheo computes once in a step; viscosity"},
    {"^smd", UNREPEATABLE | DISSIPATIVE, "every evaluation integrates damage; viscosity"},
    {"^lubricate", DISSIPATIVE | BACKGROUND, "friction of the fluid between particles"},
    {"^sph", DISSIPATIVE, "viscosity"},
    {"^mesocnt/viscous", DISSIPATIVE, "friction between tubes"},
};

static constexpr char GROUP[] = "give it a group without atoms of bodies";
static constexpr char TEMP[] = "use keyword temp or langevin, which act on bodies";
static constexpr char MOMENTUM[] =
    "use velocity zero linear and velocity zero angular between runs";
static constexpr char BONDS[] =
    "take the bonds and angles of bodies out of it: bodies are rigid already";
static constexpr char WALL[] = "use a wall that exerts a force, such as fix wall/harmonic";
static constexpr char ONE[] = "unfix one of the two";

static constexpr Style FIXES[] = {
    {"^addforce", REPEATABLE, "constants, or variables of positions and the time"},
    {"^efield", REPEATABLE, "charges and dipoles in a field of constants, variables or positions"},
    {"^enforce2d", REPEATABLE | NO_FORCE, "sets components along z to 0"},
    {"^freeze$", REPEATABLE, "sets forces and torques to 0"},
    {"^gravity", REPEATABLE, "mass times a constant or variable"},
    {"^indent$", REPEATABLE, "a function of positions and variables"},
    {"^lineforce", REPEATABLE, "removes components"},
    {"^planeforce", REPEATABLE, "removes a component"},
    {"^setforce", REPEATABLE, "constants, or variables of positions and the time"},
    {"^spring$", REPEATABLE, "a function of centers of mass"},
    {"^spring/self", REPEATABLE, "a function of present and initial positions"},
    {"^viscous$", REPEATABLE, "a function of velocities"},
    {"^wall/harmonic", REPEATABLE, "a function of positions and the place of the wall"},
    {"^wall/lj", REPEATABLE, "as wall/harmonic: wall/lj93, wall/lj126 and wall/lj1043"},
    {"^wall/morse", REPEATABLE, "as wall/harmonic"},
    {"^wall/colloid", REPEATABLE, "as wall/harmonic"},
    {"^wall/region$", REPEATABLE, "a function of positions; the region may follow variables"},
    {"^wall/table", REPEATABLE, "as wall/harmonic"},
    {"^OMP", THREADS, "FixOMP::pre_force() calls ThrData::init_force()"},
    {"^store/force", NO_FORCE, "copies forces"},
    {"^numdiff", NO_FORCE, "differences of energies, after which forces are put back"},
    {"^nonaffine/displacement", NO_FORCE, "reads positions"},
    {"^INTEL", NO_FORCE, "adds up what threads have computed"},
    {"^GPU", NO_FORCE, "receives what a device has computed"},
    {"^langevin", RANDOM | CHANGE | AT_INTEGRATION, "with gjf it also changes velocities",
     "leave out its keyword gjf"},
    {"^brownian", RANDOM, "random displacements, and it integrates itself"},
    {"^gle", RANDOM, "random changes of velocities with memory"},
    {"^gld", RANDOM, "random forces with memory, and it integrates itself"},
    {"^ttm", RANDOM, "random forces by the temperature of electrons"},
    {"^qtb", RANDOM, "random forces with memory, with friction"},
    {"^srd", RANDOM | BESIDE_GROUP, "collisions with atoms of another group, each in a step"},
    {"^wall/gran", DISSIPATIVE, "friction of contacts"},
    {"^damping/cundall", DISSIPATIVE, "its forces change sign with velocities"},
    {"^dt/reset", TIME_STEP, "sets update->dt by velocities and forces"},
    {"^deform", CARRIES_BODIES, "with remap x; with v and none no atom is moved"},
    {"^np[th]$", CARRIES_BODIES, "FixNH::remap()"},
    {"^np[th]/[abceigos]", CARRIES_BODIES, "variants of npt and nph, but not npt/uef and npt/kk"},
    {"^press/", CARRIES_BODIES, "remap() of press/berendsen and press/langevin"},
    {"^rigid/np[th]", CARRIES_BODIES, "FixRigidNH::remap()"},
    {"^bocs", CARRIES_BODIES, "FixBocs::remap()"},
    {"^tgnp[th]", CARRIES_BODIES, "FixTGNHDrude::remap()"},
    {"^box/relax", CARRIES_BODIES, "remap() between minimizations"},

    // doc/src/fix_gear_quat.rst has the same table of effects on atoms

    {"^momentum", CHANGE, "subtracts velocities of a rigid motion, of the group or of chunks",
     MOMENTUM},
    {"^temp/rescale", CHANGE, "scales velocities, or with eff those of electrons", TEMP},
    {"^temp/berendsen", CHANGE, "scales velocities", TEMP},
    {"^temp/csvr", CHANGE, "scales velocities", TEMP},
    {"^heat$", CHANGE, "scales velocities, and subtracts one of them", GROUP},
    {"^wall/reflect", REFLECTION, "mirrors atoms beyond the wall", WALL},
    {"^wall/piston$", REFLECTION, "as wall/reflect", WALL},
    {"^temp/csld", CHANGE, "mixes each velocity with a random one", TEMP},
    {"^lambda_thermostat", CHANGE, "changes some velocities at a time", TEMP},
    {"^ehex", CHANGE, "displaces atoms besides scaling velocities", GROUP},
    {"^thermal/conductivity", CHANGE, "exchanges the energies of two atoms", GROUP},
    {"^viscosity", CHANGE, "exchanges momenta of two atoms", GROUP},
    {"^oneway", CHANGE, "reverses velocities of atoms in a region", GROUP},
    {"^shardlow", CHANGE, "random changes of velocities, pair by pair", GROUP},
    {"^lb/momentum", CHANGE, "subtracts a velocity of the fluid, too", MOMENTUM},
    {"^lb/viscous", CHANGE, "exchanges momentum with the fluid in each step",
     "use fix rigid for them"},
    {"^wall/flow", CHANGE, "gives a new random velocity to atoms that pass a plane", GROUP},
    {"^smd/setvel", CHANGE, "sets velocities", GROUP},
    {"^sph/stationary", CHANGE, "advances densities, as this fix does", GROUP},
    {"^tmd$", CHANGE, "moves atoms towards a target", "use fix spring or fix spring/self"},
    {"^recenter", CHANGE | ANY, "shifts positions, also of another group",
     "subtract the center of mass in the analysis"},
    {"^shake", CHANGE | CONSTRAINED, "subtracts the degrees of freedom as well", BONDS},
    {"^rattle", CHANGE | CONSTRAINED, "as shake, and corrects velocities", BONDS},
    {"^ilves", CHANGE | CONSTRAINED, "as shake", BONDS},
    {"^atom/swap", CHANGE, "exchanges types of two atoms", GROUP},
    {"^mol/swap", CHANGE, "exchanges types of atoms of a molecule", GROUP},
    {"^neighbor/swap", CHANGE, "exchanges types of two atoms", GROUP},
    {"^sgcmc", CHANGE, "changes types of atoms", GROUP},
    {"^gcmc", EXCHANGE, "with mol and rigid it inserts and removes whole bodies",
     "to exchange whole bodies use its keywords mol and rigid, without MC moves, and keyword mol "
     "of fix gear/quat"},
    {"^charge/regulation", CHANGE, "inserts and removes ions", GROUP},
    {"^gemc", CHANGE | ANY, "exchanges atoms between two boxes and changes these", ONE},
    {"^hmc", CHANGE | ANY, "puts back atoms and knows rigid/small alone",
     "use fix rigid/small with fix hmc"},
    {"^pimd", CHANGE, "integrates beads of a ring polymer", GROUP},
    {"^ipi", CHANGE | ANY, "takes positions and the box from a server", ONE},
};

/* ----------------------------------------------------------------------
   matching
------------------------------------------------------------------------- */

template <int N, typename Matches>
static const Style *find(const Style (&table)[N], unsigned any_of, Matches matches)
{
  for (const auto &row : table)
    if (row.is(any_of) && matches(row.pattern)) return &row;
  return nullptr;
}

const Style *GearQuat::known(unsigned any_of, const Fix *fix)
{
  return find(FIXES, any_of, [fix](const char *pattern) {
    return utils::strmatch(fix->style, pattern);
  });
}

const Style *GearQuat::known_pair(unsigned any_of, const Force *force)
{
  return find(PAIRS, any_of, [force](const char *pattern) {
    return force->pair && const_cast<Force *>(force)->pair_match(pattern, 0, 1);
  });
}

/// Pair::ev_tally() calls computes with this ending for every pair of every evaluation.
bool GearQuat::adds_up(const Compute *compute)
{
  return utils::strmatch(compute->style, "/tally");
}

/* ---------------------------------------------------------------------- */

std::string GearQuat::name_of(const Fix *fix)
{
  return fmt::format("fix {} ({})", fix->id, fix->style);
}

std::vector<const Fix *> GearQuat::fixes_with_forces(LAMMPS *lmp, const Fix *owner)
{
  std::vector<const Fix *> found;
  for (auto *other : lmp->modify->get_fix_list())
    if (other != owner && (lmp->modify->get_fix_mask(other) & POST_FORCE) &&
        !known(NO_FORCE, other))
      found.push_back(other);
  return found;
}

// where other fixes may read the velocities of predicted sites

static constexpr int WITHIN_STEP = POST_INTEGRATE | PRE_EXCHANGE | PRE_NEIGHBOR | POST_NEIGHBOR |
    PRE_FORCE | PRE_REVERSE | POST_FORCE | POST_INTEGRATE_RESPA | PRE_FORCE_RESPA |
    POST_FORCE_RESPA;

std::string GearQuat::reader_of_predicted_velocities(LAMMPS *lmp, const Fix *owner)
{
  if (lmp->comm->ghost_velocity) return "velocities are sent to ghost atoms";
  if (lmp->atom->vest) return "atom style " + lmp->atom->get_style() + " has them as data";
  for (auto *other : lmp->modify->get_fix_list())
    if (other != owner && (lmp->modify->get_fix_mask(other) & WITHIN_STEP))
      return name_of(other) + " may read them";
  return "";
}

/// Called in every step: Modify::get_fix_list() would make a list.
bool GearQuat::reads_at_end(LAMMPS *lmp, const Fix *owner)
{
  const bigint now = lmp->update->ntimestep;
  const Modify *modify = lmp->modify;
  if (lmp->output->next == now) return true;
  for (int i = 0; i < modify->nfix; ++i) {
    const Fix *other = modify->fix[i];
    if ((modify->fmask[i] & END_OF_STEP) && other != owner && other->nevery > 0 &&
        now % other->nevery == 0)
      return true;
  }
  return false;
}

/* ----------------------------------------------------------------------
   other fixes that act on atoms of bodies
------------------------------------------------------------------------- */

OtherFixes::OtherFixes(LAMMPS *lmp, const Fix *fix, const Bodies &bodies,
                       const Ownership &ownership, const Sites &sites, const Arguments &args) :
    Pointers(lmp),
    fix(fix), bodies(bodies), ownership(ownership), sites(sites), args(args)
{
}

void OtherFixes::init()
{
  watched.clear();
  for (auto *other : modify->get_fix_list()) {
    const Style *row = known(Fact::ON_ATOMS, other);
    const bool heats = args.thermostat.damp > 0.0 && other->ecouple_flag && !other->time_integrate;
    if (other == fix || (!row && !heats)) continue;
    const tagint atom = shared_atom(lmp, ownership, other);
    if (heats && atom)
      error->all(FLERR,
                 "Fix gear/quat {} is a thermostat of the bodies, and {} is another one; "
                 "leave out one of the two, or give the other one a group without atoms of bodies",
                 args.thermostat.keyword(), name_of(other));
    if (!row) continue;
    if (row->is(Fact::REFLECTION) || (row->is(Fact::EXCHANGE) && !args.mol.empty()))
      watched.push_back(other);
    else
      refuse(other, *row, atom);
  }
}

/// Ends the run if a fix changes atoms of bodies.
void OtherFixes::refuse(Fix *other, const Style &row, tagint atom) const
{
  if (row.is(Fact::ANY))
    error->all(FLERR, "Fix gear/quat cannot be used with {}: bodies do not follow it; {}",
               name_of(other), row.instead);
  if (!atom || (row.is(Fact::CONSTRAINED) && other->dof(fix->igroup) == 0) ||
      (row.is(Fact::AT_INTEGRATION) &&
       !(modify->get_fix_mask(other) & FixConst::INITIAL_INTEGRATE)))
    return;
  error->all(FLERR,
             "Fix gear/quat: {} changes atoms of bodies, such as atom {}, and bodies do not "
             "follow; {}",
             name_of(other), atom, row.instead);
}

void OtherFixes::warn_of_noise() const
{
  if (args.control.eps > 0.0) return;
  const NoisyForces found = noise_of_forces(lmp, ownership);
  const bool first = args.scheme.first() && found.noise == Noise::RANDOM;
  if (!first && (args.automatic_values || suits_noise(args.scheme, found.noise))) return;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: {}, and {} cannot follow them; leave out keywords {}values and "
                   "corrector",
                   found.words(),
                   first ? "formulation first" : fmt::format("{} values", args.scheme.values()),
                   first ? "formulation, " : "");
}

NoisyForces GearQuat::noise_of_forces(LAMMPS *lmp, const Ownership &ownership)
{
  const auto noise_of = [](const Style *row) {
    return !row ? Noise::NONE : row->is(Fact::RANDOM) ? Noise::RANDOM : Noise::DISSIPATIVE;
  };
  constexpr unsigned NOISY = Fact::RANDOM | Fact::DISSIPATIVE;
  NoisyForces found;
  found.noise = known_pair(Fact::RANDOM, lmp->force) ? Noise::RANDOM
                                                     : noise_of(known_pair(NOISY, lmp->force));
  if (found.noise != Noise::NONE)
    found.style = fmt::format("pair style {}", lmp->force->pair_style);
  for (const auto *fix : lmp->modify->get_fix_list()) {
    if (found.noise == Noise::RANDOM) break;
    const Noise noise = noise_of(known(NOISY, fix));
    if (noise == Noise::NONE || noise == found.noise) continue;
    if (known(Fact::BESIDE_GROUP, fix) || shared_atom(lmp, ownership, fix))
      found = {noise, name_of(fix)};
  }
  return found;
}

tagint GearQuat::shared_atom(LAMMPS *lmp, const Ownership &ownership, const Fix *other)
{
  const Atom *atom = lmp->atom;
  tagint shared = 0;
  for (int i = 0; i < atom->nlocal; ++i)
    if (ownership.in_body(i) && (atom->mask[i] & other->groupbit))
      shared = std::max(shared, atom->tag[i]);
  return over_ranks(MPI_MAX, shared, lmp->world);
}

void OtherFixes::watch_places() const
{
  if (watched.empty()) return;
  std::vector<std::string> names;
  for (const auto *one : watched) names.push_back(name_of(one));
  for (const Site &site : sites)
    if (!sites.is_there(site))
      error->one(FLERR,
                 "Fix gear/quat: {} has moved atom {} of body {} in step {}, and bodies do not "
                 "follow; {}",
                 utils::join_words(names, ", "), atom->tag[site.atom], bodies.body_at(site.body).id,
                 update->ntimestep, known(Fact::ON_ATOMS, watched.front())->instead);
}
