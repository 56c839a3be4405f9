/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_assembly.h"

#include "gear_quat_images.h"
#include "gear_quat_ranks.h"

#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double ON_AXIS = 1.0e-6;      // of the body's size: neither side
static constexpr double ROUNDED = 1.0e-3;      // of a moment that was written with few digits
static constexpr double ROUNDING = 1.0e-14;    // of positions: an arm that is shorter is none

/// Two plates may be one body, but two halves of a molecule at opposite faces of the box are not.
void Assembly::warn_of_clumps() const
{
  const tagint any = over_ranks(MPI_MAX, in_clumps, world);
  if (any && comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: parts of body {} are more than half of a periodic box apart; if "
                   "they belong together, the image flags of its atoms do not: unwrap them in the "
                   "data file, or use set image before this fix",
                   any);
}

/* ----------------------------------------------------------------------
   every site goes to the rank that its body's ID names, which makes the body and replies where the
   site is in it; then the bodies go to the ranks of their owners
------------------------------------------------------------------------- */

std::vector<Assembly::PlacedSite> Assembly::place_sites(const std::vector<Site> &mine)
{
  std::vector<int> ranks;
  for (const auto &site : mine) ranks.push_back((int) (site.id % comm->nprocs));
  std::vector<Site> sites = send_to_ranks(comm, mine, ranks);
  std::sort(sites.begin(), sites.end(), [](const Site &a, const Site &b) {
    return a.id != b.id ? a.id < b.id : a.tag < b.tag;
  });
  const int n = (int) sites.size();
  std::vector<PlacedSite> replies(n);
  ranks.resize(n);
  for (int first = 0, last; first < n; first = last) {
    for (last = first; last < n && sites[last].id == sites[first].id; ++last) {
      undo_image_flag_overflow(domain, sites[first].x, sites[last].x);
      ranks[last] = sites[last].rank;
    }
    place(&sites[first], last - first, &replies[first]);
  }
  const std::vector<PlacedSite> placed = send_to_ranks(comm, replies, ranks);
  report_faults();
  warn_of_clumps();
  return placed;
}

std::vector<Assembly::OwnedBody> Assembly::owned_bodies()
{
  return send_to_ranks(comm, made, owner_ranks);
}

/// Make a body of its sites, and say where each of them is in it.
void Assembly::place(const Site *sites, int n, PlacedSite *replies)
{
  double axes[9];
  int owner;
  const OwnedBody body = make_body(sites, n, axes, owner);
  std::vector<const double *> positions;
  for (int i = 0; i < n; ++i) {
    double arm[3];
    find_arm(sites[i], body.state.center, arm);
    to_body(axes, arm, replies[i].site_body);
    std::copy_n(body.state.q, 4, replies[i].q_body);
    replies[i].local = sites[i].local;
    replies[i].owner = sites[owner].tag;
    positions.push_back(sites[i].x);
  }
  if (lies_in_clumps(domain, positions)) in_clumps = sites[0].id;
  made.push_back(body);
  owner_ranks.push_back(sites[owner].rank);
}

/* ----------------------------------------------------------------------
   one body from its sites, sorted by atom ID
------------------------------------------------------------------------- */

Assembly::OwnedBody Assembly::make_body(const Site *sites, int n, double axes[9], int &owner)
{
  // owner: the site nearest to the middle of the body's bounding box needs the fewest ghosts

  double lo[3], hi[3];
  for (int k = 0; k < 3; ++k) lo[k] = hi[k] = sites[0].x[k];
  for (int i = 1; i < n; ++i)
    for (int k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], sites[i].x[k]);
      hi[k] = std::max(hi[k], sites[i].x[k]);
    }
  const double middle[3] = {0.5 * (lo[0] + hi[0]), 0.5 * (lo[1] + hi[1]), 0.5 * (lo[2] + hi[2])};
  owner = 0;
  for (int i = 1; i < n; ++i)
    if (distance2(sites[i].x, middle) < distance2(sites[owner].x, middle)) owner = i;

  OwnedBody owned = OwnedBody();
  std::fill(axes, axes + 9, 0.0);
  owned.local = sites[owner].local;
  owned.body.id = sites[0].id;
  owned.body.natoms = n;
  for (int i = 0; i < n; ++i)
    owned.body.extent =
        std::max(owned.body.extent, std::sqrt(distance2(sites[i].x, sites[owner].x)));

  const auto stated = given.find(owned.body.id);
  if (stated != given.end()) {
    found.push_back(owned.body.id);
    owned.body.from_file = 1;
    const Momenta momenta = take_given(stated->second, owned);
    check_place(sites, n, owned);
    find_frame(momenta, sites, n, axes, owned);
  } else {
    const Momenta momenta = average(sites, n, owned);
    if (owned.body.rigid.mass > 0.0)
      find_frame(momenta, sites, n, axes, owned);
    else
      faulty[MASSLESS] = owned.body.id;
  }
  return owned;
}

/// From the center of mass to a site; zero if the site is there up to rounding.
void Assembly::find_arm(const Site &site, const double *center, double arm[3]) const
{
  for (int k = 0; k < 3; ++k) arm[k] = site.x[k] - center[k];
  const double size = domain->xprd + domain->yprd + domain->zprd + length(site.x);
  if (length(arm) <= ROUNDING * size) std::fill_n(arm, 3, 0.0);
}

/// Mass, center, inertia and momenta as sums over the sites.
Assembly::Momenta Assembly::average(const Site *sites, int n, OwnedBody &owned) const
{
  Momenta momenta = Momenta();
  double mass = 0.0, center[3] = {0, 0, 0}, velocity[3] = {0, 0, 0};
  for (int i = 0; i < n; ++i) {
    mass += sites[i].mass;
    for (int k = 0; k < 3; ++k) {
      center[k] += sites[i].mass * sites[i].x[k];
      velocity[k] += sites[i].mass * sites[i].v[k];
    }
  }
  owned.body.rigid.mass = mass;
  if (!(mass > 0.0)) return momenta;

  for (int k = 0; k < 3; ++k) {    // a lone site is at its center, without rounding
    owned.state.center[k] = n == 1 ? sites[0].x[k] : center[k] / mass;
    owned.state.velocity[k] = n == 1 ? sites[0].v[k] : velocity[k] / mass;
  }

  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) momenta.angular_momentum_space[k] += sites[i].own_momentum_space[k];
    for (int k = 0; k < 9; ++k) momenta.inertia_space[k] += sites[i].own_inertia_space[k];
  }
  if (n == 1) return momenta;    // a lone point has no rotation, rounding or not

  for (int i = 0; i < n; ++i) {
    double arm[3], spin[3];
    find_arm(sites[i], owned.state.center, arm);
    cross3(arm, sites[i].v, spin);
    const double r2 = dot3(arm, arm);
    for (int k = 0; k < 3; ++k) {
      momenta.angular_momentum_space[k] += sites[i].mass * spin[k];
      for (int l = 0; l < 3; ++l)
        momenta.inertia_space[3 * k + l] += sites[i].mass * ((k == l ? r2 : 0.0) - arm[k] * arm[l]);
    }
  }
  return momenta;
}

Assembly::Momenta Assembly::take_given(const GivenBody &given_body, OwnedBody &owned) const
{
  const double *i = given_body.inertia;
  const double *l = given_body.angular_momentum_space;
  owned.body.rigid.mass = given_body.mass;
  for (int k = 0; k < 3; ++k) {
    owned.state.center[k] = given_body.center[k];
    owned.state.velocity[k] = given_body.velocity[k];
  }
  const imageint image = ((imageint) (given_body.image[0] + IMGMAX) & IMGMASK) |
      (((imageint) (given_body.image[1] + IMGMAX) & IMGMASK) << IMGBITS) |
      (((imageint) (given_body.image[2] + IMGMAX) & IMGMASK) << IMG2BITS);
  domain->unmap(owned.state.center, image);
  return {{i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2]}, {l[0], l[1], l[2]}};
}

/// Principal frame, orientation and angular velocity.
void Assembly::find_frame(const Momenta &momenta, const Site *sites, int n, double axes[9],
                          OwnedBody &owned)
{
  double *moments = owned.body.rigid.inertia;
  principal_axes(momenta.inertia_space, moments, axes);
  check_moments(owned);
  drop_vanishing_moments(moments);
  if (domain->dimension == 3) {    // in two dimensions the z axis stays where it is, exactly
    sort_axes(moments, axes);
    orient_axes(sites, n, owned.state.center, axes);
  }
  quaternion_from_matrix(axes, owned.state.q);
  double momentum_body[3];
  to_body(axes, momenta.angular_momentum_space, momentum_body);
  for (int k = 0; k < 3; ++k)
    owned.state.omega_body[k] = moments[k] > 0.0 ? momentum_body[k] / moments[k] : 0.0;
  for (int k = 0; k < 3; ++k)
    if (!std::isfinite(owned.state.omega_body[k]) || !std::isfinite(owned.state.velocity[k]))
      faulty[NOT_FINITE] = owned.body.id;
}

/// Directs the axes by the body itself, not by its orientation at the start: the first and the
/// third axis point to the side of the heaviest site that is not in the plane across the axis; of
/// equally heavy sites the first one counts.
void Assembly::orient_axes(const Site *sites, int n, const double *center, double axes[9]) const
{
  std::vector<const Site *> order(n);
  for (int i = 0; i < n; ++i) order[i] = sites + i;
  std::stable_sort(order.begin(), order.end(), [](const Site *a, const Site *b) {
    return a->mass > b->mass;
  });

  auto along = [center](const Site *site, const double *axis) {
    const double arm[3] = {site->x[0] - center[0], site->x[1] - center[1], site->x[2] - center[2]};
    return dot3(axis, arm);
  };
  double largest = 0.0;
  for (const auto *site : order)
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::fabs(along(site, axes + 3 * k)));

  // false if all sites are in the plane across the axis

  auto orient = [&](int k) {
    for (const auto *site : order) {
      const double side = along(site, axes + 3 * k);
      if (std::fabs(side) < ON_AXIS * largest) continue;
      if (side < 0.0)
        for (int i = 3 * k; i < 3 * k + 3; ++i) axes[i] = -axes[i];
      return true;
    }
    return false;
  };
  const bool first = orient(0), third = orient(2);
  const int last = first == third ? 1 : first ? 2 : 0;
  if (last != 1) orient(1);
  cross3(axes + 3 * ((last + 1) % 3), axes + 3 * ((last + 2) % 3), axes + 3 * last);
}

/* ----------------------------------------------------------------------
   what no body can be
------------------------------------------------------------------------- */

/// In the order of Assembly's faults, of which the first one is reported.
static const char *const FAULT_TEXTS[] = {
    "Fix gear/quat: body {} has no mass; the masses of its atoms must add up to more than zero",
    "Fix gear/quat: inertia or velocities of body {} are not finite numbers",
    "Fix gear/quat infile: the inertia tensor of body {} has a negative principal moment; no body "
    "has",
    "Fix gear/quat infile: the largest principal moment of body {} is more than the sum of the two "
    "others; no body has",
    "Fix gear/quat infile: the center of mass of body {} is far away from all its atoms; are its "
    "position and its image flags right?"};

/// A given center may lie outside of the body, but not by half a box: image flags belong to it.
void Assembly::check_place(const Site *sites, int n, const OwnedBody &owned)
{
  const double longest = std::max({domain->xprd, domain->yprd, domain->zprd});
  const double far = owned.body.extent + 0.5 * longest;
  for (int i = 0; i < n; ++i)
    if (distance2(sites[i].x, owned.state.center) <= far * far) return;
  faulty[APART] = owned.body.id;
}

/// Of sums over masses all this holds by itself, up to rounding.
void Assembly::check_moments(const OwnedBody &owned)
{
  const double *moments = owned.body.rigid.inertia;
  const double largest = std::max({moments[0], moments[1], moments[2]});
  const double smallest = std::min({moments[0], moments[1], moments[2]});
  const double sum = moments[0] + moments[1] + moments[2];
  if (!std::isfinite(sum))
    faulty[NOT_FINITE] = owned.body.id;
  else if (smallest < -LINEAR_FRACTION * largest)
    faulty[NEGATIVE] = owned.body.id;
  else if (owned.body.from_file && domain->dimension == 3 &&
           (1.0 - ROUNDED) * largest > sum - largest)
    faulty[UNBALANCED] = owned.body.id;
}

void Assembly::report_faults()
{
  const auto any = over_ranks(MPI_MAX, faulty, world);
  for (int fault = 0; fault < FAULTS; ++fault)
    if (any[fault] > 0) error->all(FLERR, FAULT_TEXTS[fault], any[fault]);

  if (over_ranks(MPI_SUM, (int) found.size(), world) == (int) given.size()) return;
  for (const auto &stated : given) {
    const int here = std::count(found.begin(), found.end(), stated.first) > 0;
    if (!over_ranks(MPI_MAX, here, world))
      error->all(FLERR, "Fix gear/quat infile: no atom belongs to body {}", stated.first);
  }
}
