/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Bodies in a box that has changed between two runs.

   change_box remap moves every atom to the same position of the new box, relative to its faces, and
   thus stretches bodies.

   The atoms of each body are sent to one rank, which compares their positions with their positions
   in the old box, direction by direction. */

#include "gear_quat_ownership.h"

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

static constexpr double SAME = 1.0e-11;       // of the box: rounding of positions
static constexpr double DEFORMED = 1.0e-3;    // of a distance: more than the precision of a file

namespace {

/// An atom of a body, from its rank.
struct Member {
  int rank, local;
  tagint owner, id;    ///< atom ID of the body's owner, the user's ID of the body
  tagint natoms;       ///< of the body; this and all below are 0 unless the atom is its owner
  BodyState state;
  double arm_body[3];
  double found[3];    ///< unwrapped position

  double expected[3], remapped[3];    ///< from the body in the old box, and mapped to the new box
};

/// Instructions to the rank of an atom: move the atom and, if it is an owner atom, the center of
/// its body.
struct Order {
  int local, owns;
  double way[3], center[3];
};

/// The effect of another box on a body.
enum class Change { NONE, REMAPPED, DEFORMED };

}    // namespace

/// True if all atoms have the same deviation from those positions in one direction.
template <class Position>
static bool are_off_together(const Member *atoms, int n, int k, double same, Position position)
{
  const double off = atoms[0].found[k] - position(atoms[0])[k];
  return std::all_of(atoms, atoms + n, [&](const Member &one) {
    return std::fabs(one.found[k] - position(one)[k] - off) <= same;
  });
}

/// False if the faces of the box have torn the body: that is a separate error.
static bool is_deformed(const Domain *domain, const double *box_before, const Member *atoms, int n)
{
  bool deformed = false;
  for (int i = 1; i < n; ++i) {
    double before[3], now[3], change[3];
    for (int k = 0; k < 3; ++k) {
      before[k] = atoms[i].expected[k] - atoms[0].expected[k];
      now[k] = atoms[i].found[k] - atoms[0].found[k];
      change[k] = now[k] - before[k];
    }
    if (moved_with_faces(domain, box_before, change)) return false;
    if (std::fabs(length(now) - length(before)) > DEFORMED * length(before)) deformed = true;
  }
  return deformed;
}

/// The atoms of a body, its owner first, have positions `expected` and `remapped`.  center: set to
/// the center of a remapped body.
static Change change_of(const Domain *domain, const double *box_before, const Member *atoms, int n,
                        double *center)
{
  const auto expected = [](const Member &one) {
    return one.expected;
  };
  const auto remapped = [](const Member &one) {
    return one.remapped;
  };
  const Member &owner = atoms[0];
  const double *before = owner.state.center;
  const double size = std::max({domain->xprd, domain->yprd, domain->zprd}) + length(before);
  const double same = SAME * size;
  double after[3];
  follow_box(domain, box_before, before, after);
  bool follows = false;
  for (int k = 0; k < 3; ++k) {
    const double off = owner.found[k] - owner.expected[k];
    const double off_remapped = owner.found[k] - owner.remapped[k];
    const bool keeps_shape = are_off_together(atoms, n, k, same, expected);
    const bool is_remapped = are_off_together(atoms, n, k, same, remapped);
    if (!keeps_shape && !is_remapped)
      return is_deformed(domain, box_before, atoms, n) ? Change::DEFORMED : Change::NONE;
    // a single atom, or atoms that the remap has not moved apart
    const bool only_remapped = std::fabs(off) > same && std::fabs(off_remapped) <= same;
    if (is_remapped && (!keeps_shape || only_remapped)) {
      center[k] = after[k] + off_remapped;
      follows = true;
    } else
      center[k] = before[k] + off;
  }
  return follows ? Change::REMAPPED : Change::NONE;
}

/// Positions of the atoms in the body, and their images in the new box.
static void place_members(const Domain *domain, const double *box_before, Member *atoms, int n)
{
  const BodyState &state = atoms[0].state;
  double axes[9];
  rotation_matrix(state.q, dot4(state.q, state.q), axes);
  for (int i = 0; i < n; ++i) {
    Member &one = atoms[i];
    to_space(axes, one.arm_body, one.expected);
    for (int k = 0; k < 3; ++k) one.expected[k] += state.center[k];
    follow_box(domain, box_before, one.expected, one.remapped);
    undo_image_flag_overflow(domain, one.remapped, one.found);
  }
}

/// Instructions for the atoms of all bodies gathered on this rank, and their ranks.  remapped:
/// increased by the number of bodies; deformed: set to the ID of one.
static std::vector<Order> orders_to(const Domain *domain, const double *box_before,
                                    std::vector<Member> &all, std::vector<int> &ranks,
                                    bigint &remapped, tagint &deformed)
{
  std::sort(all.begin(), all.end(), [](const Member &a, const Member &b) {
    return a.owner != b.owner ? a.owner < b.owner : a.natoms > b.natoms;
  });
  std::vector<Order> orders;
  ranks.clear();
  for (size_t first = 0, last; first < all.size(); first = last) {
    for (last = first; last < all.size() && all[last].owner == all[first].owner;) ++last;
    Member *atoms = &all[first];
    const int n = (int) (last - first);
    if (atoms->natoms != n) continue;    // Ownership::check_whole() ends the run
    place_members(domain, box_before, atoms, n);
    double center[3];
    const Change change = change_of(domain, box_before, atoms, n, center);
    if (change == Change::DEFORMED) deformed = atoms->id;
    if (change != Change::REMAPPED) continue;
    ++remapped;
    for (int i = 0; i < n; ++i) {
      Order order = {atoms[i].local, i == 0, {}, {}};
      for (int k = 0; k < 3; ++k) {
        const double arm = atoms[i].expected[k] - atoms->state.center[k];
        order.center[k] = center[k];
        order.way[k] = center[k] + arm - atoms[i].found[k];
      }
      orders.push_back(order);
      ranks.push_back(atoms[i].rank);
    }
  }
  return orders;
}

/// True if any bodies were remapped.  Rank 0 warns.
static bool tell_of_box(LAMMPS *lmp, bigint remapped, tagint deformed)
{
  const bigint all = over_ranks(MPI_SUM, remapped, lmp->world);
  const tagint any = over_ranks(MPI_MAX, deformed, lmp->world);
  if (all && lmp->comm->me == 0)
    lmp->error->warning(
        FLERR,
        "Fix gear/quat: atoms of {} bodies were remapped with the box; the bodies keep "
        "their shapes and orientations, and their centers of mass are remapped",
        all);
  if (any && lmp->comm->me == 0)
    lmp->error->warning(
        FLERR,
        "Fix gear/quat: body {} has another shape than in the last run, and a remap from "
        "the old box to the new one does not explain it; if several commands have "
        "changed the box, put run 0 between them",
        any);
  return all > 0;
}

bool Ownership::follow_box()
{
  if (std::equal(domain->h, domain->h + 6, last_box.begin()) &&
      std::equal(domain->boxlo, domain->boxlo + 3, last_box.begin() + 6))
    return false;

  std::vector<Member> mine;
  std::vector<int> ranks;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!in_body(i)) continue;
    Member one = Member();
    one.rank = comm->me;
    one.local = i;
    one.owner = owner_tag(i);
    one.id = id_of(i);
    std::copy_n(arm_of(i), 3, one.arm_body);
    domain->unmap(atom->x[i], atom->image[i], one.found);
    const int ibody = owned_by(i);
    if (ibody >= 0) {
      one.natoms = bodies.body_at(ibody).natoms;
      one.state = bodies.state_of(ibody);
    }
    mine.push_back(one);
    ranks.push_back((int) (one.owner % comm->nprocs));
  }
  std::vector<Member> all = send_to_ranks(comm, world, mine, ranks);
  bigint remapped = 0;
  tagint deformed = 0;
  const auto orders = orders_to(domain, last_box.data(), all, ranks, remapped, deformed);
  for (const Order &order : send_to_ranks(comm, world, orders, ranks)) {
    for (int k = 0; k < 3; ++k) atom->x[order.local][k] += order.way[k];
    if (order.owns) std::copy_n(order.center, 3, bodies.change_state(owned_by(order.local)).center);
  }
  return tell_of_box(lmp, remapped, deformed);
}
