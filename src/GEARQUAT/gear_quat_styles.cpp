/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_styles.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "compute.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "output.h"
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
    {"^[emst]?dpd ^dsmc", UNREPEATABLE | RANDOM,
     "random forces or collisions, but not mdpd/rhosum"},
    {"^brownian", UNREPEATABLE | RANDOM | BACKGROUND, "forces of a fluid, by the time step"},
    {"^gran ^bpm ^rheo ^smd", UNREPEATABLE | DISSIPATIVE,
     "histories of contacts, bonds or damage, but not in gran/hooke; friction or viscosity"},
    {"^reax ^amoeba ^hippo ^tracker ^peri", UNREPEATABLE,
     "charges, dipoles, contacts or bonds depend on earlier evaluations"},
    {"^lubricate", DISSIPATIVE | BACKGROUND, "friction of the fluid between particles"},
    {"^sph ^mesocnt/viscous", DISSIPATIVE, "viscosity or friction"},
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
    {"^addforce ^efield ^setforce", REPEATABLE,
     "constants, or variables of positions and the time"},
    {"^freeze$ ^gravity ^lineforce ^planeforce", REPEATABLE, "constants, or components set to 0"},
    {"^indent$ ^spring$ ^spring/self ^wall/region$", REPEATABLE, "functions of positions"},
    {"^wall/harmonic ^wall/lj ^wall/morse ^wall/colloid ^wall/table", REPEATABLE,
     "functions of positions and the place of the wall"},
    {"^viscous$", REPEATABLE, "a function of velocities"},
    {"^enforce2d", REPEATABLE | NO_FORCE, "sets components along z to 0"},
    {"^OMP", THREADS, "FixOMP::pre_force() calls ThrData::init_force()"},
    {"^store/force ^nonaffine/displacement", NO_FORCE, "reads forces or positions"},
    {"^numdiff", NO_FORCE, "differences of energies, after which forces are put back"},
    {"^INTEL ^GPU", NO_FORCE, "adds up what threads or a device have computed"},
    {"^langevin", RANDOM | CHANGE | AT_INTEGRATION, "with gjf it also changes velocities",
     "leave out its keyword gjf"},
    {"^brownian ^gle ^gld ^ttm ^qtb", RANDOM, "random forces or displacements"},
    {"^srd", RANDOM | BESIDE_GROUP, "collisions with atoms of another group, each in a step"},
    {"^wall/gran ^damping/cundall", DISSIPATIVE, "friction of contacts, or by signs of velocities"},
    {"^dt/reset", TIME_STEP, "sets update->dt by velocities and forces"},
    {"^deform", CARRIES_BODIES, "with remap x; with v and none no atom is moved"},
    {"^np[th]$ ^np[th]/[abceigos] ^rigid/np[th] ^tgnp[th] ^bocs ^press/ ^box/relax", CARRIES_BODIES,
     "their remap(), but not of npt/uef and npt/kk"},

    // doc/src/fix_gear_quat.rst has the same table of effects on atoms

    {"^momentum ^lb/momentum", CHANGE, "subtracts velocities of a rigid motion", MOMENTUM},
    {"^temp/rescale ^temp/berendsen ^temp/csvr ^temp/csld ^lambda_thermostat", CHANGE,
     "scales velocities, or mixes them with random ones", TEMP},
    {"^heat$ ^ehex ^thermal/conductivity ^viscosity ^oneway ^shardlow ^wall/flow ^smd/setvel",
     CHANGE, "sets, scales, exchanges or reverses velocities", GROUP},
    {"^set$", CHANGE, "sets positions, velocities or other data", "use command set between runs"},
    {"^atom/swap ^mol/swap ^neighbor/swap ^sgcmc ^charge/regulation", CHANGE,
     "exchanges types, or inserts and removes ions", GROUP},
    {"^sph/stationary ^pimd", CHANGE, "advances densities, or integrates beads", GROUP},
    {"^wall/reflect ^wall/piston$", REFLECTION, "mirrors atoms beyond the wall", WALL},
    {"^lb/viscous", CHANGE, "exchanges momentum with the fluid in each step",
     "use fix rigid for them"},
    {"^tmd$", CHANGE, "moves atoms towards a target", "use fix spring or fix spring/self"},
    {"^recenter", CHANGE | ANY, "shifts positions, also of another group",
     "subtract the center of mass in the analysis"},
    {"^shake ^rattle ^ilves", CHANGE | CONSTRAINED, "subtracts the degrees of freedom as well",
     BONDS},
    {"^gcmc", EXCHANGE, "with mol and rigid it inserts and removes whole bodies",
     "to exchange whole bodies use its keywords mol and rigid, without MC moves, and keyword mol "
     "of fix gear/quat"},
    {"^hmc", CHANGE | ANY, "puts back atoms and knows rigid/small alone",
     "use fix rigid/small with fix hmc"},
    {"^gemc ^ipi", CHANGE | ANY, "exchanges or places atoms, and changes the box", ONE},
};

/* ----------------------------------------------------------------------
   matching
------------------------------------------------------------------------- */

template <int N, typename Matches>
static const Style *find(const Style (&table)[N], unsigned any_of, Matches matches)
{
  for (const auto &row : table)
    if (row.is(any_of))
      for (const auto &pattern : utils::split_words(row.patterns))
        if (matches(pattern)) return &row;
  return nullptr;
}

const Style *GearQuat::known(unsigned any_of, const Fix *fix)
{
  return find(FIXES, any_of, [fix](const std::string &pattern) {
    return utils::strmatch(fix->style, pattern);
  });
}

const Style *GearQuat::known_pair(unsigned any_of, const Force *force)
{
  return find(PAIRS, any_of, [force](const std::string &pattern) {
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
   forces on bodies
------------------------------------------------------------------------- */

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
