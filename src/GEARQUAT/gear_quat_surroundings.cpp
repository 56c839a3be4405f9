/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_report.h"

#include "gear_quat_arguments.h"
#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"
#include "gear_quat_scene.h"
#include "gear_quat_step.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "pair.h"
#include "utils.h"

#include <algorithm>
#include <functional>

using namespace LAMMPS_NS;
using namespace GearQuat;

// labels of an atom: the label of its body, or one of these

static constexpr double STILL = 0.0, MOVED_BY_OTHERS = -1.0;

static constexpr double WORTH = 0.01;    // minimum share of pairs for a line of the script

static constexpr char WITH_KSPACE[] =
    " (LAMMPS then warns of exclusions with a kspace style; the part of that style in this "
    "energy remains, and is constant, too)";

static constexpr int MOST_GROUPS = 8 * sizeof(int);    // one bit of the mask each

namespace {

class Surroundings : protected Pointers {
 public:
  Surroundings(LAMMPS *lmp, const Fix *fix, const Arguments &args, const Fleet &fleet,
               const Bodies &bodies, Ownership &ownership) :
      Pointers(lmp),
      fix(fix), args(args), fleet(fleet), bodies(bodies), ownership(ownership), label(labels())
  {
  }
  std::vector<std::string> advice() const;
  void warn_of_own_pairs() const;

 private:
  const Fix *fix;
  const Arguments &args;
  const Fleet &fleet;
  const Bodies &bodies;
  Ownership &ownership;
  const std::vector<double> label;    ///< of atoms, including ghosts: the style that moves them

  std::vector<double> labels() const;
  void visit_pairs(const std::function<void(int, int, int)> &visit) const;
  std::array<bigint, 3> count_pairs() const;
  std::array<bigint, 3> count_atoms() const;
  std::string exclude_still(bigint still) const;
  std::string exclude_own() const;
  bool meets_itself() const;
};

/// The ID of a body is positive.
std::vector<double> Surroundings::labels() const
{
  std::vector<double> made(atom->nlocal + atom->nghost, STILL);
  for (auto *other : modify->get_fix_list()) {
    if (!other->time_integrate || other == fix) continue;
    for (int i = 0; i < atom->nlocal; ++i)
      if (fleet.moves(other, atom, i)) made[i] = MOVED_BY_OTHERS;
  }
  for (int i = 0; i < atom->nlocal; ++i)
    if (ownership.in_body(i)) made[i] = (double) ownership.id_of(i);
  ownership.spread_labels(made);
  return made;
}

/// The pairs of atoms in the neighbor lists of pair styles in every step, and their bonds.
void Surroundings::visit_pairs(const std::function<void(int, int, int)> &visit) const
{
  for (int which = 0; which < neighbor->nlist; ++which) {
    const NeighList *list = neighbor->lists[which];
    if (!list || list->requestor_type != NeighList::PAIR || list->occasional || list->kokkos ||
        !list->ilist)
      continue;
    for (int ii = 0; ii < list->inum; ++ii) {
      const int i = list->ilist[ii];
      const int *neighbors = list->firstneigh[i];
      for (int jj = 0; jj < list->numneigh[i]; ++jj)
        visit(i, neighbors[jj] & NEIGHMASK, neighbors[jj] >> SBBITS & 3);
    }
  }
}

/// Counts all pairs, pairs between atoms that nothing moves, and pairs within bodies.
std::array<bigint, 3> Surroundings::count_pairs() const
{
  bigint here[3] = {0, 0, 0};
  visit_pairs([&](int i, int j, int /*bonded*/) {
    ++here[0];
    if (label[i] != label[j] || label[i] == MOVED_BY_OTHERS) return;
    ++here[label[i] == STILL ? 1 : 2];
  });
  return over_ranks(MPI_SUM, here, world);
}

/// Counts atoms that nothing moves, atoms of the fix group in no body, and atoms that belong to
/// both kinds.
std::array<bigint, 3> Surroundings::count_atoms() const
{
  bigint here[3] = {0, 0, 0};
  for (int i = 0; i < atom->nlocal; ++i) {
    here[0] += label[i] == STILL;
    if (!(atom->mask[i] & fix->groupbit) || ownership.in_body(i)) continue;
    ++here[1];
    here[2] += label[i] == STILL;
  }
  return over_ranks(MPI_SUM, here, world);
}

/* ----------------------------------------------------------------------
   sentences and lines for the input script
------------------------------------------------------------------------- */

std::vector<std::string> Surroundings::advice() const
{
  const auto [pairs, still_pairs, own_pairs] = count_pairs();
  const auto [still, unused, unused_still] = count_atoms();
  std::vector<std::string> text;
  const auto share = [pairs = pairs](bigint some) {
    return fmt::format("{} of {} pairs in the neighbor lists ({:.0f} %)", some, pairs,
                       100.0 * (double) some / (double) pairs);
  };
  const auto worth = [pairs = pairs](bigint some) {
    return (double) some >= WORTH * (double) pairs && some > 0;
  };
  const char *kspace = force->kspace ? WITH_KSPACE : "";
  if (worth(still_pairs)) {
    text.push_back(
        share(still_pairs) +
        fmt::format(" are among {} atoms that no fix moves; without them, and the constant "
                    "they add to the energy{}:",
                    still, kspace));
    text.push_back("  " + exclude_still(still));
  }
  if (worth(own_pairs) && !meets_itself()) {
    text.push_back(
        share(own_pairs) +
        fmt::format(" are within bodies and do not move them; without them, and the constant they "
                    "add to the energy{}:",
                    kspace));
    text.push_back("  " + exclude_own());
  }
  if (unused > 0 && args.bodystyle == Arguments::BodyStyle::GROUP) {
    text.push_back(fmt::format("{} atoms of group {} are in no body, and {} of them are moved by "
                               "no fix; the following group has only atoms of bodies:",
                               unused, group->names[fix->igroup],
                               unused == unused_still ? "all" : std::to_string(unused_still)));
    text.push_back(fmt::format("  group bodies union {}; fix {} bodies gear/quat ...",
                               utils::join_words(args.groups, " "), fix->id));
  }
  return text;
}

/// The energy of overlapping atoms of a body may be so large that all other energies are lost in
/// rounding.
void Surroundings::warn_of_own_pairs() const
{
  if (!exerts_forces(force->pair, force->pair_style) || meets_itself()) return;
  using Example = std::array<tagint, 3>;    // body, two of its atoms
  std::vector<Example> found;               // the first body on this rank
  visit_pairs([&](int i, int j, int bonded) {
    if (label[i] != label[j] || label[i] <= STILL) return;
    if (force->special_lj[bonded] == 0.0 && force->special_coul[bonded] == 0.0) return;
    if (distance2(atom->x[i], atom->x[j]) >= force->pair->cutsq[atom->type[i]][atom->type[j]])
      return;
    const auto [one, other] = std::minmax(atom->tag[i], atom->tag[j]);
    const Example example = {(tagint) label[i], one, other};
    if (found.empty() || example < found[0]) found.assign(1, example);
  });
  const auto all = gather_sorted(found, world);
  if (all.empty() || comm->me != 0) return;
  const auto [body, one, other] = all.front();
  error->warning(FLERR,
                 "Fix gear/quat {}: pair style {} acts between atoms of the same body, such as {} "
                 "and {} of body {}; these forces do not move bodies, but they take time and add a "
                 "constant to the energy, which is large where atoms overlap; the line that leaves "
                 "them out{}: {}",
                 fix->id, force->pair_style, one, other, body, force->kspace ? WITH_KSPACE : "",
                 exclude_own());
}

/// True if a body may be large enough to interact with its periodic image, so that these forces
/// move it.
bool Surroundings::meets_itself() const
{
  double extent = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    extent = std::max(extent, bodies.body_at(ibody).extent);
  const double largest = over_ranks(MPI_MAX, extent, world);
  for (int k = 0; k < 3; ++k)
    if (domain->periodicity[k] && domain->prd[k] < 2.0 * largest + neighbor->cutneighmax)
      return true;
  return false;
}

/// The largest existing group of atoms that nothing moves, or a new group.
std::string Surroundings::exclude_still(bigint still) const
{
  std::string best;
  bigint most = 0;
  for (int g = 0; g < MOST_GROUPS; ++g) {
    if (!group->names[g] || group->dynamic[g]) continue;
    bigint here[2] = {0, 0};    // atoms of the group: that nothing moves, others
    for (int i = 0; i < atom->nlocal; ++i)
      if (atom->mask[i] & group->bitmask[g]) ++here[label[i] == STILL ? 0 : 1];
    const auto all = over_ranks(MPI_SUM, here, world);
    if (all[1] > 0 || all[0] <= most) continue;
    most = all[0];
    best = group->names[g];
  }
  if (most == still) return fmt::format("neigh_modify exclude group {0} {0}", best);

  std::vector<std::string> moving;
  for (auto *other : modify->get_fix_list()) {
    const std::string name = group->names[other->igroup];
    if (other->time_integrate && std::find(moving.begin(), moving.end(), name) == moving.end())
      moving.push_back(name);
  }
  return fmt::format("group still subtract all {}; neigh_modify exclude group still still",
                     utils::join_words(moving, " "));
}

std::string Surroundings::exclude_own() const
{
  const std::string name = group->names[fix->igroup];
  switch (args.bodystyle) {
    case Arguments::BodyStyle::MOLECULE:
      return "neigh_modify exclude molecule/intra " + name;
    case Arguments::BodyStyle::SINGLE:
      return fmt::format("neigh_modify exclude group {0} {0}", name);
    case Arguments::BodyStyle::GROUP: {
      std::string line = "neigh_modify";
      for (const auto &body : args.groups) line += fmt::format(" exclude group {0} {0}", body);
      return line;
    }
    default:
      return "neigh_modify exclude molecule/intra " + name + ", with a molecule ID for every body";
  }
}

}    // namespace

std::vector<std::string> GearQuat::advice_on_surroundings(LAMMPS *lmp, const Fix *fix,
                                                          const Arguments &args, const Fleet &fleet,
                                                          const Bodies &bodies,
                                                          Ownership &ownership)
{
  const Surroundings surroundings(lmp, fix, args, fleet, bodies, ownership);
  surroundings.warn_of_own_pairs();
  return surroundings.advice();
}
