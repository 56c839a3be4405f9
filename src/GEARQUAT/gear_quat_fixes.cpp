/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_fixes.h"

#include "gear_quat_arguments.h"
#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double RIGID = 1.0e-6;    // of the velocity of a site, for a motion to be rigid

/* ---------------------------------------------------------------------- */

OtherFixes::OtherFixes(LAMMPS *lmp, const Fix *fix, Bodies &bodies, Ownership &ownership,
                       Sites &sites, const Arguments &args) :
    Pointers(lmp),
    fix(fix), bodies(bodies), ownership(ownership), sites(sites), args(args)
{
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void OtherFixes::init()
{
  taken.clear();
  watched.clear();
  warned_change = false;
  warn_of_noise();
  for (auto *other : modify->get_fix_list()) {
    const Style *row = known(Fact::ON_ATOMS, other);
    const bool heats = args.thermostat.damp > 0.0 && other->ecouple_flag && !other->time_integrate;
    if (other == fix || (!row && !heats)) continue;
    const tagint atom = shared_atom(lmp, ownership, other);
    if (heats && atom)
      error->all(FLERR,
                 "Fix gear/quat {} is a thermostat of the bodies, and fix {} ({}) is another one; "
                 "leave out one of the two, or give the other one a group without atoms of bodies",
                 args.thermostat.keyword(), other->id, other->style);
    if (!row) continue;
    if (row->is(Fact::TEMPERATURE | Fact::MOMENTUM)) {
      taken.push_back(other);
      if (atom && args.isokinetic != Isokinetic::NONE && row->is(Fact::TEMPERATURE))
        error->all(FLERR,
                   "Fix gear/quat isokinetic keeps the kinetic energy, which fix {} ({}) changes; "
                   "leave out one of the two",
                   other->id, other->style);
    } else if (row->is(Fact::REFLECTION) || (row->is(Fact::EXCHANGE) && !args.mol.empty())) {
      watched.push_back(other);
      if (atom && row->is(Fact::REFLECTION) && comm->me == 0)
        error->warning(FLERR,
                       "Fix gear/quat: fix {} ({}) moves single atoms, and bodies do not follow; "
                       "the run will end with an error when it moves an atom of a body; {}",
                       other->id, other->style, row->instead);
    } else {
      refuse(other, *row, atom);
    }
  }
}

/// Ends the run if a fix changes single atoms of bodies.
void OtherFixes::refuse(Fix *other, const Style &row, tagint atom) const
{
  if (row.is(Fact::ANY))
    error->all(FLERR, "Fix gear/quat cannot be used with fix {} ({}): bodies do not follow it; {}",
               other->id, other->style, row.instead);
  if (!atom || (row.is(Fact::CONSTRAINED) && other->dof(fix->igroup) == 0) ||
      (row.is(Fact::AT_INTEGRATION) &&
       !(modify->get_fix_mask(other) & FixConst::INITIAL_INTEGRATE)))
    return;
  error->all(FLERR,
             "Fix gear/quat: fix {} ({}) changes single atoms of bodies, such as atom {}, and "
             "bodies do not follow; {}",
             other->id, other->style, atom, row.instead);
}

void OtherFixes::warn_of_noise()
{
  if (warned_noise || args.control.eps > 0.0) return;
  const NoisyForces found = noise_of_forces(lmp, ownership);
  const bool first = args.scheme.first() && found.noise == Noise::RANDOM;
  if (!first && (args.automatic_values || suits_noise(args.scheme, found.noise))) return;
  warned_noise = true;
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

/// The rigid fixes require keyword disable, and apply gravity to bodies themselves.
void OtherFixes::warn_of_gravity()
{
  if (!utils::strmatch(update->integrate_style, "^verlet")) return;
  const size_t n = 3 * (size_t) atom->nlocal;
  for (auto *other : modify->get_fix_by_style("^gravity")) {
    if (!shared_atom(lmp, ownership, other)) continue;
    std::vector<double> forces;
    if (n) forces.assign(atom->f[0], atom->f[0] + n);
    if (n) std::fill_n(atom->f[0], n, 0.0);
    other->post_force(0);
    sites.gather_loads(atom->f, atom->torque);
    int here[2] = {0, 0};    // atoms that feel it, bodies with a wrong weight
    for (const Site &site : sites) {
      const double *f = atom->f[site.atom];
      if (dot3(f, f) == 0.0) continue;
      here[0] = 1;
      if (site.body >= bodies.nmoved()) continue;
      double weight[3], off[3];
      for (int k = 0; k < 3; ++k) {
        weight[k] =
            f[k] * force->ftm2v * bodies.rigid_of(site.body).mass / ownership.mass_of(site.atom);
        off[k] = weight[k] - bodies.load_of(site.body).force[k];
      }
      if (length(off) > RIGID * length(weight)) here[1] = 1;
    }
    if (n) std::copy(forces.begin(), forces.end(), atom->f[0]);
    const auto any = over_ranks(MPI_MAX, here, world);
    if (comm->me != 0 || (any[0] && !any[1])) continue;
    error->warning(FLERR, "Fix gear/quat: fix {} (gravity) {}", other->id,
                   any[0] ? "acts on the masses of atoms, which differ from the masses of their "
                            "bodies; use fix addforce instead"
                          : "exerts no force on bodies; if it has the keyword disable, which fix "
                            "rigid/small requires, leave that out");
  }
}

/* ----------------------------------------------------------------------
   velocities that bodies adopt
------------------------------------------------------------------------- */

std::vector<int> OtherFixes::take_velocities(bigint step, bool end)
{
  std::vector<int> changed;
  std::vector<const Fix *> acted;
  for (const auto *one : taken)
    if (one->nevery > 0 && step % one->nevery == 0) acted.push_back(one);
  if (acted.empty()) return changed;
  const auto before = bodies.snapshot();    // with the loads of the last step
  if (!sites.gather_impulses()) return changed;

  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const Load &impulse = bodies.load_of(ibody);
    BodyState &state = bodies.change_state(ibody);
    if (dot3(impulse.force, impulse.force) + dot3(impulse.torque_space, impulse.torque_space) ==
        0.0)
      continue;
    double twist[3];
    torque_along_axes(state.q, dot4(state.q, state.q), impulse, twist);
    for (int k = 0; k < 3; ++k) {
      state.velocity[k] += impulse.force[k] / rigid.mass;
      if (rigid.inertia[k] > 0.0) state.omega_body[k] += twist[k] / rigid.inertia[k];
    }
    changed.push_back(ibody);
  }
  bodies.put_back_loads(before);    // accelerations of bodies follow from them
  ownership.spread_states();

  tagint torn = 0;
  for (const Site &site : sites) {
    const Sites::Expected v = sites.expected_velocity(site);
    double off[3];
    for (int k = 0; k < 3; ++k)
      off[k] = k < domain->dimension ? atom->v[site.atom][k] - v.value[k] : 0.0;
    if (!(length(off) <= RIGID * v.size)) torn = std::max(torn, bodies.body_at(site.body).id);
  }
  torn = over_ranks(MPI_MAX, torn, world);
  // a temperature with a bias scales each atom by itself; whole bodies take the rigid part
  if (!torn || std::all_of(acted.begin(), acted.end(), [this](const Fix *one) {
        return known(Fact::TEMPERATURE, one) && !ownership.count_atoms(one->groupbit).divided;
      })) {
    sites.place_velocities();
    return changed;
  }
  if (end)
    error->all(FLERR,
               "Fix gear/quat: the velocities that {} gave to atoms of body {} in step {} do not "
               "form a rigid motion; whole bodies have to be in the group, without a region or a "
               "bias that divides them",
               names(acted), torn, step);
  bodies.put_back_states(before);
  ownership.spread_states();
  return {};
}

/* ----------------------------------------------------------------------
   changes that bodies do not follow
------------------------------------------------------------------------- */

void OtherFixes::watch_velocities(bool all)
{
  if (++sample >= sites.number()) sample = 0;
  const Site *const first = sites.begin() + (all ? 0 : sample);
  for (const Site *site = first; site < sites.end() && !warned_change; ++site) {
    if (all && !sites.is_there(*site))
      warn(*site, "place");
    else if (!sites.is_as_fast(*site))
      warn(*site, "velocity");
    if (!all) break;
  }
}

void OtherFixes::watch_places()
{
  if (!watched.empty()) {
    for (const Site &site : sites)
      if (!sites.is_there(site))
        error->one(FLERR,
                   "Fix gear/quat: {} has moved atom {} of body {} in step {}, and bodies do not "
                   "follow; {}",
                   names(watched), atom->tag[site.atom], bodies.body_at(site.body).id,
                   update->ntimestep, known(Fact::ON_ATOMS, watched.front())->instead);
    return;
  }
  if (warned_change || sample >= sites.number()) return;
  if (!sites.is_there(sites[sample])) warn(sites[sample], "place");
}

void OtherFixes::warn(const Site &site, const char *what)
{
  warned_change = true;
  std::vector<const Fix *> others;
  for (const auto *other : modify->get_fix_list())
    if (other != fix) others.push_back(other);
  error->warning(FLERR,
                 "Fix gear/quat: the {} of atom {} of body {} was changed before step {} by "
                 "something else, and bodies do not follow; other fixes are: {}",
                 what, atom->tag[site.atom], bodies.body_at(site.body).id, update->ntimestep,
                 others.empty() ? "none" : names(others));
}

std::string OtherFixes::names(const std::vector<const Fix *> &fixes) const
{
  std::vector<std::string> words;
  for (const auto *one : fixes) words.push_back(name_of(one));
  return utils::join_words(words, ", ");
}
