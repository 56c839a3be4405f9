/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_scene.h"

#include "gear_quat_arguments.h"
#include "gear_quat_forces.h"
#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"
#include "gear_quat_sites.h"
#include "gear_quat_step.h"

#include "atom.h"
#include "comm.h"
#include "compute.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <map>

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

/// Granular walls request the masses of bodies only from the first rigid fix; pair styles refuse a
/// second rigid fix.
static void warn_of_walls(LAMMPS *lmp, const Fix *fix)
{
  const Fix *first = nullptr;
  for (const auto *other : lmp->modify->get_fix_list())
    if (!first && other->rigid_flag) first = other;
  if (first == fix || lmp->comm->me != 0) return;
  for (const auto *other : lmp->modify->get_fix_list())
    if (known(Fact::FIRST_RIGID, other))
      lmp->error->warning(FLERR,
                          "Fix gear/quat: fix {} ({}) uses the bodies of fix {} only and damps "
                          "contacts of the bodies of fix {} with the masses of atoms; use one fix "
                          "for all bodies",
                          other->id, other->style, first->id, fix->id);
}

void GearQuat::refuse_scene(LAMMPS *lmp, const Fix *fix, const Fleet &fleet,
                            const Ownership &ownership)
{
  const bool steps = lmp->update->whichflag != 2;
  if (steps && (lmp->update->dt == 0.0 || !std::isfinite(lmp->update->dt)))
    lmp->error->all(FLERR, "Fix gear/quat requires a time step that is not zero, it is {}",
                    lmp->update->dt);
  ownership.refuse_atoms();
  if (steps) refuse_respa_with_steps(lmp);
  refuse_other_integrators(lmp, fix, fleet, ownership);
  warn_of_walls(lmp, fix);
}

/* ----------------------------------------------------------------------
   readers of data, and fixes that act on atoms
------------------------------------------------------------------------- */

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

bool GearQuat::makes_forces(LAMMPS *lmp, const Fix *owner)
{
  constexpr int AROUND_FORCES = PRE_FORCE | PRE_REVERSE | POST_FORCE | FINAL_INTEGRATE |
      PRE_FORCE_RESPA | POST_FORCE_RESPA | FINAL_INTEGRATE_RESPA;
  const Force *force = lmp->force;
  if (exerts_forces(force->pair, force->pair_style) ||
      exerts_forces(force->bond, force->bond_style) ||
      exerts_forces(force->angle, force->angle_style) ||
      exerts_forces(force->dihedral, force->dihedral_style) ||
      exerts_forces(force->improper, force->improper_style) || force->kspace)
    return true;
  for (auto *other : lmp->modify->get_fix_list())
    if (other != owner && (lmp->modify->get_fix_mask(other) & AROUND_FORCES)) return true;
  return false;
}

std::vector<int> GearQuat::readers_at_end(LAMMPS *lmp, const Fix *owner)
{
  std::vector<int> periods;
  for (auto *other : lmp->modify->get_fix_list())
    if (other != owner && other->nevery > 0 && (lmp->modify->get_fix_mask(other) & END_OF_STEP) &&
        !std::count(periods.begin(), periods.end(), other->nevery))
      periods.push_back(other->nevery);
  return periods;
}

/* ----------------------------------------------------------------------
   molecules that are only partly in bodies
------------------------------------------------------------------------- */

namespace {

/// The atoms of a molecule.
struct Membership {
  bigint in_bodies, unmoved;    ///< unmoved: in no body, and no fix moves them
  bigint all;
  int first_rank;    ///< the lowest rank with some of them

  void merge(const Membership &other)
  {
    in_bodies += other.in_bodies;
    unmoved += other.unmoved;
    all += other.all;
    first_rank = std::min(first_rank, other.first_rank);
  }
};

}    // namespace

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
  std::vector<Membership> memberships(parts.number(), {0, 0, 0, lmp->comm->me});
  for (int part = 0; part < parts.number(); ++part)
    for (const int i : parts.atoms(part)) {
      Membership &one = memberships[part];
      ++one.all;
      if (ownership.in_body(i))
        ++one.in_bodies;
      else if (!is_moved(lmp, fix, fleet, i))
        ++one.unmoved;
    }
  parts.merge(memberships);

  bigint number = 0;
  tagint example = MAXTAGINT;
  for (int part = 0; part < parts.number(); ++part) {
    const Membership &one = memberships[part];
    if (one.in_bodies == 0 || one.unmoved == 0) continue;
    example = std::min(example, parts.key(part));
    number += one.first_rank == lmp->comm->me;
  }
  number = over_ranks(MPI_SUM, number, lmp->world);
  if (number == 0) return;
  example = over_ranks(MPI_MIN, example, lmp->world);
  bigint counts[2] = {0, 0};
  const int part = parts.find(example);
  if (part < parts.number() && parts.key(part) == example) {
    counts[0] = memberships[part].in_bodies;
    counts[1] = memberships[part].all;
  }
  const auto of_example = over_ranks(MPI_MAX, counts, lmp->world);
  if (lmp->comm->me == 0)
    lmp->error->warning(FLERR,
                        "Fix gear/quat: {} molecules are only partly in bodies, and no fix moves "
                        "the rest, such as molecule {}, of which {} of {} atoms are in bodies; if "
                        "all of these atoms are to move as rigid molecules, {}",
                        number, example, of_example[0], of_example[1], remedy(lmp, fix, args));
}

/* ----------------------------------------------------------------------
   bodies that meet their own images
------------------------------------------------------------------------- */

/// As NPair::exclusion(), for two atoms of the same molecule or of none.
static bool is_excluded(const LAMMPS *lmp, int i, int j)
{
  const Atom *atom = lmp->atom;
  const Neighbor *list = lmp->neighbor;
  const int *mask = atom->mask;
  if (list->nex_type && list->ex_type[atom->type[i]][atom->type[j]]) return true;
  for (int m = 0; m < list->nex_group; ++m)
    if ((mask[i] & list->ex1_bit[m] && mask[j] & list->ex2_bit[m]) ||
        (mask[i] & list->ex2_bit[m] && mask[j] & list->ex1_bit[m]))
      return true;
  for (int m = 0; m < list->nex_mol; ++m)
    if (mask[i] & mask[j] & list->ex_mol_bit[m] &&
        (atom->molecule[i] == atom->molecule[j]) == (list->ex_mol_intra[m] != 0))
      return true;
  return false;
}

/// Unwrapped positions, which ghosts receive from their atoms, tell images from the body itself.
static bool excludes_image(const LAMMPS *lmp, const std::array<std::vector<double>, 4> &label,
                           double period, int i, int j)
{
  const Atom *atom = lmp->atom;
  double apart2 = 0.0, off = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double apart = atom->x[i][k] - atom->x[j][k];
    apart2 += apart * apart;
    off = std::max(off, std::fabs(apart - (label[k][i] - label[k][j])));
  }
  return off > 0.5 * period && apart2 < lmp->force->pair->cutsq[atom->type[i]][atom->type[j]] &&
      is_excluded(lmp, i, j);
}

void GearQuat::warn_of_excluded_images(LAMMPS *lmp, const Fix *fix, const Bodies &bodies,
                                       Ownership &ownership, const Sites &sites)
{
  const Force *force = lmp->force;
  if (!lmp->neighbor->exclude || !exerts_forces(force->pair, force->pair_style)) return;
  double period = HUGE_VAL, extent = 0.0;
  for (int k = 0; k < 3; ++k)
    if (lmp->domain->periodicity[k]) period = std::min(period, lmp->domain->prd[k]);
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    extent = std::max(extent, bodies.body_at(ibody).extent);
  if (2.0 * over_ranks(MPI_MAX, extent, lmp->world) + force->pair->cutforce < period) return;

  const int nlocal = lmp->atom->nlocal, nall = nlocal + lmp->atom->nghost;
  std::array<std::vector<double>, 4> label;    // unwrapped positions, and IDs of bodies that turn
  for (auto &one : label) one.assign(nall, 0.0);
  for (const Site &site : sites) {
    double x[3], expected[3];
    sites.unwrapped(site, x, expected);
    for (int k = 0; k < 3; ++k) label[k][site.atom] = x[k];
    const Body &body = bodies.body_at(site.body);
    const bool turns = body.rigid.rotational_freedoms() > 0 && !(body.off & torque_off(2));
    if (turns) label[3][site.atom] = (double) body.id;
  }
  for (auto &one : label) ownership.spread_labels(one);
  std::map<double, std::vector<int>> ghosts;    // of each body
  for (int j = nlocal; j < nall; ++j)
    if (label[3][j] > 0.0) ghosts[label[3][j]].push_back(j);
  tagint found = 0;
  for (int i = 0; i < nlocal && !found && !ghosts.empty(); ++i)
    for (const int j : ghosts[label[3][i]])
      if (excludes_image(lmp, label, period, i, j)) found = (tagint) label[3][i];
  found = over_ranks(MPI_MAX, found, lmp->world);
  if (found && lmp->comm->me == 0)
    lmp->error->warning(FLERR,
                        "Fix gear/quat {}: body {} is so long that it meets its own periodic "
                        "images, and neigh_modify exclude leaves out these pairs too, which would "
                        "turn it; do not exclude its pairs, use a larger box, or switch its "
                        "torque off",
                        fix->id, found);
}

/// Bodies are the molecules at the definition of the fix.
bool GearQuat::warn_of_molecule_ids(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                                    const Ownership &ownership)
{
  const Atom *atom = lmp->atom;
  if (args.bodystyle != Arguments::BodyStyle::MOLECULE || !atom->molecule_flag) return false;
  tagint here[2] = {0, 0};    // an atom, and its body
  for (int i = 0; i < atom->nlocal; ++i)
    if (ownership.in_body(i) && atom->molecule[i] != ownership.id_of(i) && atom->tag[i] > here[0]) {
      here[0] = atom->tag[i];
      here[1] = ownership.id_of(i);
    }
  const tagint other = over_ranks(MPI_MAX, here[0], lmp->world);
  if (!other) return false;
  const tagint body = over_ranks(MPI_MAX, other == here[0] ? here[1] : 0, lmp->world);
  if (lmp->comm->me == 0)
    lmp->error->warning(
        FLERR,
        "Fix gear/quat {}: atom {} of body {} has another molecule ID than when the "
        "fix was defined; bodies keep their atoms and IDs: define the fix after "
        "commands such as set mol and reset_atoms mol",
        fix->id, other, body);
  return true;
}
