/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_neighbors.h"

#include "fix_gear_quat.h"
#include "gear_quat_arguments.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

namespace LAMMPS_NS {

/// A row of the table.
struct Neighbor {
  const char *style;    ///< pattern
  enum { TAKEN, WATCHED, REFUSED } what;
  enum { SHARED, ALWAYS, CONSTRAINED, GJF, IMPULSES } where;    ///< the case that is meant
  const char *instead;
};

}    // namespace LAMMPS_NS

static constexpr char GROUP[] = "give it a group without atoms of bodies";
static constexpr char THERMOSTAT[] =
    "use fix temp/csvr or temp/berendsen, whose change bodies take over, or fix langevin";
static constexpr char CONSTRAINTS[] =
    "take the bonds and angles of bodies out of it: bodies are rigid already";
static constexpr char WALL[] = "use a wall that exerts a force, such as fix wall/harmonic";

/// The first row that matches counts.  doc/src/fix_gear_quat.rst has the same table.
static const Neighbor NEIGHBORS[] = {
    {"^momentum", Neighbor::TAKEN, Neighbor::SHARED, ""},
    {"^temp/rescale$", Neighbor::TAKEN, Neighbor::SHARED, ""},
    {"^temp/berendsen", Neighbor::TAKEN, Neighbor::SHARED, ""},
    {"^temp/csvr", Neighbor::TAKEN, Neighbor::SHARED, ""},
    {"^heat$", Neighbor::TAKEN, Neighbor::SHARED, ""},
    {"^wall/reflect", Neighbor::WATCHED, Neighbor::SHARED, WALL},
    {"^wall/piston$", Neighbor::WATCHED, Neighbor::SHARED, WALL},
    {"^temp/csld", Neighbor::REFUSED, Neighbor::SHARED, THERMOSTAT},
    {"^temp/rescale/eff", Neighbor::REFUSED, Neighbor::SHARED, THERMOSTAT},
    {"^lambda_thermostat", Neighbor::REFUSED, Neighbor::SHARED, THERMOSTAT},
    {"^langevin", Neighbor::REFUSED, Neighbor::GJF, "leave out its keyword gjf"},
    {"^ehex", Neighbor::REFUSED, Neighbor::SHARED, "use fix heat without a region"},
    {"^thermal/conductivity", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^viscosity", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^oneway", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^shardlow", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^lb/momentum", Neighbor::REFUSED, Neighbor::SHARED, "use fix momentum"},
    {"^lb/viscous", Neighbor::REFUSED, Neighbor::IMPULSES, "use fix rigid for them"},
    {"^wall/flow", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^smd/setvel", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^tmd$", Neighbor::REFUSED, Neighbor::SHARED, "use fix spring or fix spring/self"},
    {"^recenter", Neighbor::REFUSED, Neighbor::ALWAYS,
     "use fix momentum, and subtract the center of mass in the analysis"},
    {"^shake", Neighbor::REFUSED, Neighbor::CONSTRAINED, CONSTRAINTS},
    {"^rattle", Neighbor::REFUSED, Neighbor::CONSTRAINED, CONSTRAINTS},
    {"^ilves", Neighbor::REFUSED, Neighbor::CONSTRAINED, CONSTRAINTS},
    {"^atom/swap", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^mol/swap", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^neighbor/swap", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^sgcmc", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^gcmc", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^charge/regulation", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^gemc", Neighbor::REFUSED, Neighbor::ALWAYS, "unfix one of the two"},
    {"^hmc", Neighbor::REFUSED, Neighbor::ALWAYS, "use fix rigid/small with fix hmc"},
    {"^pimd", Neighbor::REFUSED, Neighbor::SHARED, GROUP},
    {"^ipi", Neighbor::REFUSED, Neighbor::ALWAYS, "unfix one of the two"},
};

// relative to the velocities of a site: rounding, and what a rigid motion may be off by

static constexpr double SAME = 1.0e-11, RIGID = 1.0e-6;

/* ---------------------------------------------------------------------- */

GearQuatNeighbors::GearQuatNeighbors(LAMMPS *lmp, const FixGearQuat *fix, GearQuatBodies &bodies,
                                     const GearQuatArguments &args) :
    Pointers(lmp),
    fix(fix), bodies(bodies), args(args), sample(0), told_noise(false), told(false)
{
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void GearQuatNeighbors::init()
{
  taken.clear();
  watched.clear();
  told = false;
  for (auto *other : modify->get_fix_list()) {
    if (other == fix) continue;
    tell_noise(other);
    const Neighbor *row = nullptr;
    for (const auto &one : NEIGHBORS)
      if (!row && utils::strmatch(other->style, one.style)) row = &one;
    if (!row) continue;
    const tagint atom = shared_atom(other);
    if (row->what == Neighbor::REFUSED) {
      refuse(other, *row, atom);
    } else if (row->what == Neighbor::WATCHED) {
      watched.push_back(other);
      if (atom && comm->me == 0)
        error->warning(FLERR,
                       "Fix gear/quat: fix {} ({}) moves single atoms, which bodies do not follow; "
                       "the run will end when it moves one of a body. {}",
                       other->id, other->style, row->instead);
    } else {
      taken.push_back(other);
      if (atom && args.isokinetic != Isokinetic::NONE &&
          !utils::strmatch(other->style, "^momentum"))
        error->all(FLERR,
                   "Fix gear/quat isokinetic keeps the kinetic energy, which fix {} ({}) changes; "
                   "leave out one of the two",
                   other->id, other->style);
    }
  }
}

/// Random forces have no derivatives, and those of collisions last a single step.
void GearQuatNeighbors::tell_noise(const Fix *other)
{
  const bool collides = utils::strmatch(other->style, "^srd");
  if (told_noise || (!collides && !utils::strmatch(other->style, "^langevin"))) return;
  const bool first = args.scheme.first();
  const int most = first ? (collides ? 3 : 4) : (collides ? 4 : 6);
  if (args.scheme.values() <= most || (!collides && !shared_atom(other))) return;
  told_noise = true;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: forces of fix {} ({}) are random, and {} values make heat of "
                   "them; use values {}{}",
                   other->id, other->style, args.scheme.values(), most,
                   most > (first ? 3 : 4) ? " or fewer" : "");
}

/// The largest ID of an atom of a body in the group of that fix, 0 for none.  Collective.
tagint GearQuatNeighbors::shared_atom(const Fix *other) const
{
  tagint shared = 0, any;
  for (int i = 0; i < atom->nlocal; ++i)
    if (bodies.in_body(i) && (atom->mask[i] & other->groupbit))
      shared = std::max(shared, atom->tag[i]);
  MPI_Allreduce(&shared, &any, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  return any;
}

void GearQuatNeighbors::refuse(const Fix *other, const Neighbor &row, tagint shared) const
{
  switch (row.where) {
    case Neighbor::SHARED:
      if (shared) break;
      return;
    case Neighbor::ALWAYS:
      error->all(FLERR,
                 "Fix gear/quat cannot be used with fix {} ({}): bodies do not follow it; {}",
                 other->id, other->style, row.instead);
      return;
    case Neighbor::CONSTRAINED:
      if (shared && const_cast<Fix *>(other)->dof(fix->igroup) > 0) break;
      return;
    case Neighbor::GJF:
      if (shared && (modify->get_fix_mask(const_cast<Fix *>(other)) & FixConst::INITIAL_INTEGRATE))
        break;
      return;
    case Neighbor::IMPULSES:
      if (!shared) return;
      error->all(FLERR,
                 "Fix gear/quat: fix {} ({}) exchanges an impulse with bodies in each step, among "
                 "them that of atom {}, which no number of values can follow; {}",
                 other->id, other->style, shared, row.instead);
      return;
  }
  error->all(FLERR,
             "Fix gear/quat: fix {} ({}) changes single atoms of bodies, among them atom {}, and "
             "bodies do not follow; {}",
             other->id, other->style, shared, row.instead);
}

/// The rigid fixes want it disabled, and apply it themselves to bodies whose mass a file states.
void GearQuatNeighbors::check_gravity()
{
  if (!utils::strmatch(update->integrate_style, "^verlet")) return;
  const size_t n = 3 * (size_t) atom->nlocal;
  for (auto *other : modify->get_fix_by_style("^gravity")) {
    if (!shared_atom(other)) continue;
    std::vector<double> forces;
    if (n) forces.assign(atom->f[0], atom->f[0] + n);
    if (n) std::fill_n(atom->f[0], n, 0.0);
    other->post_force(0);
    bodies.gather_loads(atom->f, atom->torque);
    int here[2] = {0, 0}, any[2];    // atoms that feel it, bodies that should feel more or less
    for (const auto &site : bodies.sites) {
      const double *f = atom->f[site.atom];
      if (dot3(f, f) == 0.0) continue;
      here[0] = 1;
      if (site.body >= bodies.nmoved()) continue;
      const double factor =
          force->ftm2v * bodies.body[site.body].rigid.mass / bodies.atom_mass(site.atom);
      double off[3];
      for (int k = 0; k < 3; ++k) off[k] = factor * f[k] - bodies.load[site.body].force[k];
      if (dot3(off, off) > RIGID * RIGID * factor * factor * dot3(f, f)) here[1] = 1;
    }
    if (n) std::copy(forces.begin(), forces.end(), atom->f[0]);
    MPI_Allreduce(here, any, 2, MPI_INT, MPI_MAX, world);
    if (comm->me != 0) continue;
    if (!any[0])
      error->warning(FLERR,
                     "Fix gear/quat: fix {} (gravity) exerts no force on bodies; if it has the "
                     "keyword disable, as fix rigid/small wants it, leave that out",
                     other->id);
    else if (any[1])
      error->warning(FLERR,
                     "Fix gear/quat: fix {} (gravity) pulls at the masses of atoms, and these are "
                     "not those of the bodies; use fix addforce instead",
                     other->id);
  }
}

/* ----------------------------------------------------------------------
   velocities that bodies take over
------------------------------------------------------------------------- */

std::vector<int> GearQuatNeighbors::take_velocities(bigint step, bool end)
{
  std::vector<int> changed;
  std::vector<const Fix *> acted;
  for (const auto *one : taken)
    if (one->nevery > 0 && step % one->nevery == 0) acted.push_back(one);
  if (acted.empty()) return changed;
  const auto before = bodies.state;
  const auto loads = bodies.load;    // of the last step: accelerations of bodies follow from them
  if (!gather_impulses()) return changed;

  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const RigidBody &rigid = bodies.body[ibody].rigid;
    const Load &impulse = bodies.load[ibody];
    BodyState &state = bodies.state[ibody];
    if (dot3(impulse.force, impulse.force) + dot3(impulse.torque_space, impulse.torque_space) ==
        0.0)
      continue;
    double a[9], twist[3];
    rotation_matrix(state.q, dot4(state.q, state.q), a);
    to_body(a, impulse.torque_space, twist);
    for (int k = 0; k < 3; ++k) {
      state.velocity[k] += impulse.force[k] / rigid.mass;
      if (rigid.inertia[k] > 0.0) state.omega_body[k] += twist[k] / rigid.inertia[k];
    }
    changed.push_back(ibody);
  }
  bodies.load = loads;
  bodies.spread_states();

  tagint torn = 0, any;
  for (const auto &site : bodies.sites) {
    const GearQuatBodies::Placed placed = bodies.placed(site);
    double off[3];
    for (int k = 0; k < 3; ++k) off[k] = atom->v[site.atom][k] - placed.v[k];
    if (!(std::sqrt(dot3(off, off)) <= RIGID * placed.speed)) torn = bodies.body[site.body].id;
  }
  MPI_Allreduce(&torn, &any, 1, MPI_LMP_TAGINT, MPI_MAX, world);
  if (!any) return changed;
  if (end)
    error->all(FLERR,
               "Fix gear/quat: the velocities that {} gave to atoms of body {} in step {} are not "
               "those of a rigid motion; whole bodies have to be in the group, without a region or "
               "a bias that divides them",
               names(acted), any, step);
  bodies.state = before;
  bodies.spread_states();
  return {};
}

/// Momentum and angular momentum that atoms have more than their bodies, as loads.  Collective;
/// false if nowhere any.
bool GearQuatNeighbors::gather_impulses()
{
  int differs = 0, any;
  for (const auto &site : bodies.sites)
    if (!is_as_fast(site)) differs = 1;
  MPI_Allreduce(&differs, &any, 1, MPI_INT, MPI_MAX, world);
  if (!any) return false;

  double **impulse, **twist;
  memory->create(impulse, atom->nlocal + 1, 3, "gear/quat:impulse");
  memory->create(twist, atom->nlocal + 1, 3, "gear/quat:twist");
  std::fill_n(impulse[0], 3 * ((size_t) atom->nlocal + 1), 0.0);
  std::fill_n(twist[0], 3 * ((size_t) atom->nlocal + 1), 0.0);
  for (const auto &site : bodies.sites) {
    const GearQuatBodies::Placed placed = bodies.placed(site);
    const double mass = bodies.atom_mass(site.atom) / force->ftm2v;
    for (int k = 0; k < 3; ++k)
      impulse[site.atom][k] = mass * (atom->v[site.atom][k] - placed.v[k]);
  }
  bodies.gather_loads(impulse, twist);
  memory->destroy(impulse);
  memory->destroy(twist);
  return true;
}

/* ----------------------------------------------------------------------
   changes that bodies do not follow
------------------------------------------------------------------------- */

bool GearQuatNeighbors::is_there(const GearQuatBodies::Site &site) const
{
  const GearQuatBodies::Placed placed = bodies.placed(site);
  for (int k = 0; k < 3; ++k)
    if (!(std::fabs(atom->x[site.atom][k] - placed.x[k]) <= SAME * placed.length)) return false;
  return true;
}

bool GearQuatNeighbors::is_as_fast(const GearQuatBodies::Site &site) const
{
  const GearQuatBodies::Placed placed = bodies.placed(site);
  for (int k = 0; k < 3; ++k)
    if (!(std::fabs(atom->v[site.atom][k] - placed.v[k]) <= SAME * placed.speed)) return false;
  return true;
}

void GearQuatNeighbors::check_velocities()
{
  if (told || bodies.sites.empty()) return;
  const auto &site = bodies.sites[++sample % bodies.sites.size()];
  if (!is_as_fast(site)) tell(site, "velocity");
}

void GearQuatNeighbors::check_places()
{
  if (!watched.empty()) {
    for (const auto &site : bodies.sites)
      if (!is_there(site))
        error->one(FLERR,
                   "Fix gear/quat: {} has moved atom {} of body {} in step {}, and bodies do not "
                   "follow; " +
                       std::string(WALL),
                   names(watched), atom->tag[site.atom], bodies.body[site.body].id,
                   update->ntimestep);
    return;
  }
  if (told || bodies.sites.empty()) return;
  const auto &site = bodies.sites[sample % bodies.sites.size()];
  if (!is_there(site)) tell(site, "place");
}

void GearQuatNeighbors::check_all()
{
  for (const auto &site : bodies.sites) {
    if (told) return;
    if (!is_there(site))
      tell(site, "place");
    else if (!is_as_fast(site))
      tell(site, "velocity");
  }
}

void GearQuatNeighbors::tell(const GearQuatBodies::Site &site, const char *what)
{
  told = true;
  std::vector<const Fix *> others;
  for (const auto *other : modify->get_fix_list())
    if (other != fix) others.push_back(other);
  error->warning(FLERR,
                 "Fix gear/quat: the {} of atom {} of body {} was changed before step {} by "
                 "something else, and bodies do not follow; other fixes are: {}",
                 what, atom->tag[site.atom], bodies.body[site.body].id, update->ntimestep,
                 others.empty() ? "none" : names(others));
}

std::string GearQuatNeighbors::names(const std::vector<const Fix *> &fixes) const
{
  std::vector<std::string> words;
  for (const auto *one : fixes) words.push_back(fmt::format("fix {} ({})", one->id, one->style));
  return utils::join_words(words, ", ");
}
