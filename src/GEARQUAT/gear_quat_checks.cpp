/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_checks.h"

#include "gear_quat_arguments.h"
#include "gear_quat_box.h"
#include "gear_quat_forces.h"
#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"
#include "gear_quat_sites.h"
#include "gear_quat_step.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   unsupported settings
------------------------------------------------------------------------- */

/// Forces are evaluated once per step, so all levels of r-RESPA need the same time step.
static void refuse_respa_with_steps(LAMMPS *lmp)
{
  const std::vector<double> steps = RespaForces::steps(lmp);
  for (size_t level = 1; level < steps.size(); ++level)
    if (steps[level] != steps[0])
      lmp->error->all(FLERR,
                      "Fix gear/quat requires run_style respa to have the same step at all levels "
                      "(loop factors of 1); levels 1 and {} have {} and {}",
                      level + 1, steps[0], steps[level]);
}

static void refuse_other_integrators(LAMMPS *lmp, const Fix *fix, const Fleet &fleet,
                                     const Ownership &ownership)
{
  for (auto *other : lmp->modify->get_fix_list()) {
    if (other == fix || !other->time_integrate) continue;
    int dim;
    const int *its_body =
        known(Fact::BODY_OF_ATOMS, other) && !utils::strmatch(other->style, "/small")
        ? static_cast<const int *>(other->extract("body", dim))
        : nullptr;
    const Atom *atom = lmp->atom;
    tagint shared = 0;
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!ownership.in_body(i) || !fleet.moves(other, atom, i)) continue;
      if (its_body && its_body[i] < 0) continue;
      shared = atom->tag[i];
    }
    shared = over_ranks(MPI_MAX, shared, lmp->world);
    if (shared)
      lmp->error->all(FLERR,
                      "Fix gear/quat: atom {} is also moved by fix {} ({}); take it out of the "
                      "group of one of the two",
                      shared, other->id, other->style);
  }
}

void GearQuat::refuse_scene(LAMMPS *lmp, const Fix *fix, const Fleet &fleet,
                            const Ownership &ownership)
{
  const bool steps = lmp->update->whichflag != 2;
  if (steps && (lmp->update->dt == 0.0 || !std::isfinite(lmp->update->dt)))
    lmp->error->all(FLERR, "Fix gear/quat requires a time step that is not zero, it is {}",
                    lmp->update->dt);
  if (steps) refuse_respa_with_steps(lmp);
  refuse_other_integrators(lmp, fix, fleet, ownership);
}

/* ----------------------------------------------------------------------
   shapes of bodies
------------------------------------------------------------------------- */

namespace {

/// The smallest and largest coordinates of sites along each direction, in units of the periods.
struct Bounds {
  std::array<double, 3> lo = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
  std::array<double, 3> hi = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  void merge(const Bounds &other)
  {
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], other.lo[k]);
      hi[k] = std::max(hi[k], other.hi[k]);
    }
  }
};

/// The body with the smallest ID of those that should be equal.
struct Model {
  tagint id = MAXTAGINT;
  double radii[3];    ///< of gyration, about the principal axes
  void merge(const Model &other)
  {
    if (other.id < id) *this = other;
  }
};

}    // namespace

void GearQuat::warn_of_gaps(LAMMPS *lmp, const Ownership &ownership)
{
  const Atom *atom = lmp->atom;
  std::vector<tagint> id(atom->nlocal, 0);
  std::vector<std::array<double, 3>> at(atom->nlocal);    // unwrapped, in periods
  for (int i = 0; i < atom->nlocal; ++i) {
    double x[3];
    lmp->domain->unmap(atom->x[i], atom->image[i], x);
    to_periods(lmp->domain, x, at[i].data());
    if (ownership.in_body(i)) id[i] = ownership.id_of(i);
  }
  const Parts parts(lmp->comm, lmp->world, id.data(), atom->nlocal);
  std::vector<Bounds> all(parts.number()), next(parts.number());    // next: to the middle of all
  for (int part = 0; part < parts.number(); ++part)
    for (const int i : parts.atoms(part)) all[part].merge({at[i], at[i]});
  parts.merge(all);
  for (int part = 0; part < parts.number(); ++part)
    for (const int i : parts.atoms(part)) {
      Bounds one;
      for (int k = 0; k < 3; ++k)
        (2.0 * at[i][k] > all[part].lo[k] + all[part].hi[k] ? one.lo : one.hi)[k] = at[i][k];
      next[part].merge(one);
    }
  parts.merge(next);
  tagint torn = 0;
  for (int part = 0; part < parts.number(); ++part)
    for (int k = 0; k < lmp->domain->dimension; ++k) {
      const double gap = next[part].lo[k] - next[part].hi[k];
      constexpr double OVERFLOW_OF_FLAGS = 512.0;
      if (lmp->domain->periodicity[k] && gap > 0.5 && gap < OVERFLOW_OF_FLAGS)
        torn = parts.key(part);
    }
  torn = over_ranks(MPI_MAX, torn, lmp->world);
  if (torn && lmp->comm->me == 0)
    lmp->error->warning(FLERR,
                        "Fix gear/quat: parts of body {} are more than half of a periodic box "
                        "apart; if they belong together, the image flags of its atoms are wrong: "
                        "unwrap the atoms in the data file, or use set image before this fix",
                        torn);
}

/// Atoms of finite size have different radii and masses with the same type.
void GearQuat::warn_of_shapes(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership)
{
  constexpr double OTHER = 0.005;    // of the size; coordinates with three decimals differ less
  if (ownership.extended().has_records() || lmp->atom->rmass) return;
  std::vector<tagint> kind(bodies.nowned(), 0);
  std::vector<Model> mine(bodies.nowned());
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body_at(ibody);
    if (body.from_file) continue;
    kind[ibody] = 1 +
        (tagint) ((std::hash<double>{}(body.rigid.mass) + body.natoms) % (size_t) (MAXTAGINT - 1));
    mine[ibody].id = body.id;
    for (int k = 0; k < 3; ++k)
      mine[ibody].radii[k] = std::sqrt(std::max(0.0, body.rigid.inertia[k] / body.rigid.mass));
  }
  const Parts kinds(lmp->comm, lmp->world, kind.data(), bodies.nowned());
  std::vector<Model> models(kinds.number());
  for (int n = 0; n < kinds.number(); ++n)
    for (const int ibody : kinds.atoms(n)) models[n].merge(mine[ibody]);
  kinds.merge(models);
  double largest = OTHER;
  tagint pair[2] = {0, 0};
  for (int n = 0; n < kinds.number(); ++n) {
    const double *radii = models[n].radii, size = std::max({radii[0], radii[1], radii[2]});
    for (const int ibody : kinds.atoms(n))
      for (int k = lmp->domain->dimension == 2 ? 2 : 0; k < 3; ++k) {
        const double off = std::fabs(mine[ibody].radii[k] - radii[k]);
        if (!(off > largest * size)) continue;
        largest = off / size;
        pair[0] = models[n].id;
        pair[1] = mine[ibody].id;
      }
  }
  const double all = over_ranks(MPI_MAX, largest, lmp->world);
  if (largest < all) pair[0] = pair[1] = 0;
  const auto named = over_ranks(MPI_MAX, pair, lmp->world);
  if (named[0] && lmp->comm->me == 0)
    lmp->error->warning(FLERR,
                        "Fix gear/quat: bodies {} and {} have the same atoms, and their shapes "
                        "differ by {:.2g} % of their size; bodies keep the shapes they have when "
                        "the fix is defined: if they are equal molecules, define the fix before "
                        "minimize, or run one step with fix shake before the fix",
                        named[0], named[1], 100.0 * all);
}

/* ----------------------------------------------------------------------
   molecules that are only partly in bodies
------------------------------------------------------------------------- */

/// The kinds of atoms that a molecule has.
struct Membership {
  int in_body, unmoved;    ///< unmoved: in no body, and no fix moves it
  void merge(const Membership &other)
  {
    in_body |= other.in_body;
    unmoved |= other.unmoved;
  }
};

static bool is_moved(LAMMPS *lmp, const Fix *fix, const Fleet &fleet, int i)
{
  const auto &fixes = lmp->modify->get_fix_list();
  return std::any_of(fixes.begin(), fixes.end(), [&](Fix *other) {
    return other != fix && other->time_integrate && fleet.moves(other, lmp->atom, i);
  });
}

/// The remedy, if the molecules are rigid.
static std::string remedy(const LAMMPS *lmp, const Fix *fix, const Arguments &args)
{
  switch (args.bodystyle) {
    case Arguments::BodyStyle::CUSTOM:
      return fmt::format("give all atoms of a molecule the same value of {}, and put them into "
                         "group {}",
                         args.custom, lmp->group->names[fix->igroup]);
    case Arguments::BodyStyle::GROUP:
      return "complete the groups of the bodies, and the group of the fix, with the command "
             "\"group ID include molecule\" before this fix";
    default:
      return fmt::format("write \"group {} include molecule\" before this fix",
                         lmp->group->names[fix->igroup]);
  }
}

void GearQuat::warn_of_partial_molecules(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                                         const Fleet &fleet, const Ownership &ownership)
{
  const Atom *atom = lmp->atom;
  if (!atom->molecule_flag) return;
  std::vector<tagint> molecule(atom->molecule, atom->molecule + atom->nlocal);
  for (auto &id : molecule) id = std::max(id, (tagint) 0);
  const Parts parts(lmp->comm, lmp->world, molecule.data(), atom->nlocal);
  std::vector<Membership> memberships(parts.number(), {0, 0});
  for (int part = 0; part < parts.number(); ++part)
    for (const int i : parts.atoms(part)) {
      const int inside = ownership.in_body(i);
      memberships[part].merge({inside, !inside && !is_moved(lmp, fix, fleet, i)});
    }
  parts.merge(memberships);
  tagint example = MAXTAGINT;
  for (int part = 0; part < parts.number(); ++part)
    if (memberships[part].in_body && memberships[part].unmoved)
      example = std::min(example, parts.key(part));
  example = over_ranks(MPI_MIN, example, lmp->world);
  if (example != MAXTAGINT && lmp->comm->me == 0)
    lmp->error->warning(FLERR,
                        "Fix gear/quat: molecules such as {} are only partly in bodies, and no fix "
                        "moves the rest; if all of these atoms are to move as rigid molecules, {}",
                        example, remedy(lmp, fix, args));
}
