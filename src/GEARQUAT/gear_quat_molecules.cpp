/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_molecules.h"

#include "gear_quat_arguments.h"
#include "gear_quat_fleet.h"
#include "gear_quat_parts.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "group.h"
#include "modify.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

namespace {

/// The atoms of a molecule.
struct Membership {
  bigint in_bodies, unmoved;    ///< unmoved: in no body, and no fix moves them
  bigint all;
  int first_rank;    ///< the lowest one that has some of them

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

/// What to write, if the molecules are rigid.
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
  const Parts parts(lmp->comm, molecule.data(), atom->nlocal);
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
