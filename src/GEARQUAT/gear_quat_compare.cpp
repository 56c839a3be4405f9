/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Comparison of the atoms of all bodies with the data of the bodies: their number, and before a run
   their masses, positions and velocities. */

#include "gear_quat_sites.h"

#include "gear_quat_images.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double SAME_LENGTH = 1.0e-9;    // of the box, of lengths
static constexpr double SAME_SHAPE = 1.0e-3;     // of distances; files may have few digits
static constexpr double SAME_PLACE = 1.0e-6;     // of positions

/* ----------------------------------------------------------------------
   the number of atoms
------------------------------------------------------------------------- */

namespace {

/// The atoms of a body on one rank, or on all; the data of its owner are 0 on other ranks.
struct AtomsOfBody {
  bigint natoms = 0;
  tagint smallest_id = MAXTAGINT, largest_id = 0;    ///< the user's, of the body
  bigint in_group = 0;                               ///< atoms in the group of the request
  bigint own_freedoms = 0;                           ///< rotations of the atoms themselves
  bigint had = 0, freedoms = 0;    ///< of the owner: atoms when the body was made, its freedoms

  void merge(const AtomsOfBody &other)
  {
    natoms += other.natoms;
    smallest_id = std::min(smallest_id, other.smallest_id);
    largest_id = std::max(largest_id, other.largest_id);
    in_group += other.in_group;
    own_freedoms += other.own_freedoms;
    had += other.had;
    freedoms += other.freedoms;
  }
};

}    // namespace

Comparison Ownership::count_atoms(int groupbit) const
{
  const std::vector<tagint> tags = owner_tags();
  const Parts parts(comm, world, tags.data(), atom->nlocal);
  std::vector<AtomsOfBody> counts(parts.number());
  std::vector<int> owns(parts.number(), 0);
  for (int part = 0; part < parts.number(); ++part) {
    AtomsOfBody &count = counts[part];
    for (const int i : parts.atoms(part)) {
      ++count.natoms;
      count.smallest_id = std::min(count.smallest_id, id_of(i));
      count.largest_id = std::max(count.largest_id, id_of(i));
      count.in_group += (atom->mask[i] & groupbit) ? 1 : 0;
      count.own_freedoms += records.freedoms(i);
      if (owned_by(i) < 0) continue;
      const Body &mine = bodies.body_at(owned_by(i));
      count.had = mine.natoms;
      count.freedoms = mine.rigid.freedoms(domain->dimension);
      owns[part] = 1;
    }
  }
  parts.merge(counts);

  Comparison found;
  for (int part = 0; part < parts.number(); ++part) {
    const AtomsOfBody &body = counts[part];
    if (body.natoms != body.had || body.smallest_id != body.largest_id) {
      found.broken = body.smallest_id;
      found.left = body.natoms;
      found.had = body.had;
    }
    if (!owns[part]) continue;
    if (body.in_group > 0 && body.in_group < body.natoms) found.divided = body.smallest_id;
    if (body.in_group == body.natoms)
      found.removed_freedoms += domain->dimension * body.natoms + body.own_freedoms - body.freedoms;
  }
  found.removed_freedoms = over_ranks(MPI_SUM, found.removed_freedoms, world);
  const tagint broken = over_ranks(MPI_MAX, found.broken, world);
  bigint here[] = {found.divided, 0, 0};
  if (found.broken == broken) here[1] = found.left, here[2] = found.had;
  const auto largest = over_ranks(MPI_MAX, here, world);
  return {found.removed_freedoms, (tagint) largest[0], broken, largest[1], largest[2]};
}

/* ----------------------------------------------------------------------
   masses, positions and velocities
------------------------------------------------------------------------- */

Sites::Changes Sites::changes() const
{
  tagint here[2] = {0, 0}, body = 0;    // whether an atom has changed, and one in another place
  for (const Site &site : sites) {
    const int i = site.atom;
    if (!is_there(site) || !is_as_fast(site) || ownership.has_other_mass(i) ||
        !extended.match(i, ownership.mass_of(i), bodies.state_of(site.body)))
      here[0] = 1;
    if (!is_there(site, SAME_PLACE) && atom->tag[i] > here[1]) {
      here[1] = atom->tag[i];
      body = bodies.body_at(site.body).id;
    }
  }
  const auto all = over_ranks(MPI_MAX, here, world);
  return {all[0] != 0, all[1], over_ranks(MPI_MAX, all[1] == here[1] ? body : 0, world)};
}

namespace {

/// The owner atom of a body: unwrapped position, actual and according to the body.
struct Owner {
  double found[3] = {}, expected[3] = {};

  void merge(const Owner &other)
  {
    add3(other.found, found);    // zero on all ranks but one
    add3(other.expected, expected);
  }
};

}    // namespace

/// The user may have moved, rotated or deformed a body between two runs.  It is torn if its atoms
/// are whole periods further apart than before, or if parts of it have moved with the faces of the
/// box.
void Sites::refuse_tears() const
{
  const std::vector<tagint> tags = ownership.owner_tags();
  const Parts parts(comm, world, tags.data(), atom->nlocal);
  std::vector<Owner> owners(parts.number());
  for (const Site &site : sites)
    if (ownership.owned_by(site.atom) >= 0) {
      Owner &owner = owners[parts.find(tags[site.atom])];
      unwrapped(site, owner.found, owner.expected);
    }
  parts.merge(owners);

  tagint here[3] = {0, 0, 0};    // bodies that are torn, cut by the box, or have another shape
  for (const Site &site : sites) {
    const Owner &owner = owners[parts.find(tags[site.atom])];
    double found[3], expected[3], before[3], now[3], change[3];
    unwrapped(site, found, expected);
    for (int k = 0; k < 3; ++k) {
      before[k] = expected[k] - owner.expected[k];
      now[k] = found[k] - owner.found[k];
      change[k] = now[k] - before[k];
    }
    const double further = length(now) - length(before);
    const double few = SAME_LENGTH * (domain->xprd + domain->yprd + domain->zprd);
    const tagint id = bodies.body_at(site.body).id;
    if (whole_periods_away(domain, change, further)) here[0] = id;
    if (moved_with_faces(domain, ownership.box().data(), change)) here[1] = id;
    if (std::fabs(further) > SAME_SHAPE * length(before) + few) here[2] = id;
  }
  const auto all = over_ranks(MPI_MAX, here, world);
  if (all[0])
    error->all(
        FLERR,
        "Fix gear/quat: some atoms of body {} are displaced from the others by whole periods of "
        "the box; image flags of a body's atoms have to change together (set image, read_dump or "
        "rerun with ix iy iz), or define the fix after they have changed",
        all[0]);
  if (all[1])
    error->all(
        FLERR,
        "Fix gear/quat: the box was changed while body {} lies across its faces, which tears "
        "it; first move the body inside with displace_atoms, or change the box with fix deform",
        all[1]);
  if (all[2] && !std::equal(domain->h, domain->h + 6, ownership.box().begin()))
    error->all(
        FLERR,
        "Fix gear/quat: the box has changed, and body {} has another shape than before: change_box "
        "with remap moves each atom by itself; change the box with fix deform, which moves bodies "
        "as a whole, or, to keep this shape, define the fix after the change",
        all[2]);
  if (all[2] && comm->me == 0)
    error->warning(
        FLERR,
        "Fix gear/quat: atoms of body {} were moved relative to each other since the fix "
        "was defined or last ran, as by displace_atoms or set on single atoms; the body "
        "is made again with this other shape",
        all[2]);
}
