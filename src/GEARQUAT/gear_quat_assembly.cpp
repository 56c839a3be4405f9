/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_assembly.h"

#include "gear_quat_extended.h"
#include "gear_quat_images.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double NONE = std::numeric_limits<double>::infinity();

// an arm that is shorter than this part of positions is due to rounding

static constexpr double ROUNDING = 1.0e-14;

// a body with at most this many sites is small

static constexpr bigint SMALL = 1000;

// the most terms in a sum whose scale bounds each term

static constexpr double MANY = 524288.0;

/* ----------------------------------------------------------------------
   passes over the sites
------------------------------------------------------------------------- */

static void merge_sums(SiteSum *sums, const SiteSum *others, int n)
{
  for (int k = 0; k < n; ++k) sums[k].merge(others[k]);
}

void Assembly::Sizes::merge(const Sizes &other)
{
  natoms += other.natoms;
  if (other.first < first) {
    first = other.first;
    std::copy_n(other.first_x, 3, first_x);
  }
  mass = std::max(mass, other.mass);
  speed = std::max(speed, other.speed);
  own_inertia = std::max(own_inertia, other.own_inertia);
  own_momentum = std::max(own_momentum, other.own_momentum);
  types += other.types;
  finite = finite && other.finite;
}

void Assembly::Extremes::merge(const Extremes &other)
{
  for (int k = 0; k < 3; ++k) {
    lo[k] = std::min(lo[k], other.lo[k]);
    hi[k] = std::max(hi[k], other.hi[k]);
  }
  mass.merge(other.mass);
}

void Assembly::Moments::merge(const Moments &other)
{
  if (other.distance2 < distance2 || (other.distance2 == distance2 && other.owner < owner)) {
    distance2 = other.distance2;
    owner = other.owner;
    rank = other.rank;
    local = other.local;
    std::copy_n(other.x, 3, x);
  }
  merge_sums(center, other.center, 3);
  merge_sums(momentum, other.momentum, 3);
}

void Assembly::Momenta::merge(const Momenta &other)
{
  extent2 = std::max(extent2, other.extent2);
  from_center2 = std::min(from_center2, other.from_center2);
  merge_sums(inertia_space, other.inertia_space, 6);
  merge_sums(angular_momentum_space, other.angular_momentum_space, 3);
}

void Assembly::Sides::merge(const Sides &other)
{
  for (int k = 0; k < 3; ++k) {
    if (other.mass[k] < mass[k] || (other.mass[k] == mass[k] && other.tag[k] >= tag[k])) continue;
    mass[k] = other.mass[k];
    tag[k] = other.tag[k];
    side[k] = other.side[k];
  }
}

double Assembly::mass_of(int i) const
{
  return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
}

void Assembly::unwrapped(int part, int i, double *x) const
{
  const double *first = sizes[part].first_x;
  domain->unmap(atom->x[i], atom->image[i], x);
  const double way =
      std::fabs(x[0] - first[0]) + std::fabs(x[1] - first[1]) + std::fabs(x[2] - first[2]);
  if (!(way < certain)) undo_image_flag_overflow(domain, first, x);
}

/// The vector from the center of mass to a site; zero if the two coincide up to rounding.
void Assembly::find_arm(const double *x, const double *center, double *arm) const
{
  for (int k = 0; k < 3; ++k) arm[k] = x[k] - center[k];
  const double size = domain->xprd + domain->yprd + domain->zprd + length(x);
  if (length(arm) <= ROUNDING * size) std::fill_n(arm, 3, 0.0);
}

Assembly::Site Assembly::site_of(int part, int i) const
{
  Site site;    // without initialization, for speed
  site.rank = comm->me;
  site.local = i;
  site.tag = atom->tag[i];
  site.mass = mass_of(i);
  unwrapped(part, i, site.x);
  std::copy_n(atom->v[i], 3, site.v);
  if (former) std::copy_n(former->arm[i].begin(), 3, site.former_arm);
  if (extended) extended->own_momenta(i, site.mass, site.inertia_space, site.momentum_space);
  return site;
}

bool Assembly::is_small(int part) const
{
  return sizes[part].natoms <= SMALL;
}

/// No site is further away from the middle of the box around the sites.
double Assembly::radius(int part) const
{
  return 0.5 * std::sqrt(distance2(extremes[part].lo, extremes[part].hi));
}

/// The unit of a sum over all sites of a body; bound: of its terms.
double Assembly::scale_of(int part, double bound) const
{
  if (is_small(part)) return 0.0;
  return ExactSum::scale_of(bound * std::max(1.0, (double) sizes[part].natoms / MANY));
}

/// The unit of a sum whose terms are proportional to the mass.
double Assembly::unit_of(int part, double bound) const
{
  return scale_of(part, sizes[part].mass * bound);
}

/* ----------------------------------------------------------------------
   bodies from their sites, pass by pass
------------------------------------------------------------------------- */

Assembly::Assembly(LAMMPS *lmp, const GivenBodies &given, const Extended *extended,
                   const std::vector<tagint> &ids, const Former *former) :
    Pointers(lmp),
    given(given), extended(extended), former(former),
    parts(comm, world, ids.data(), (int) ids.size()), made(parts.number(), Made())
{
  double steepest = 0.0;
  for (int k = 0; k < 6; ++k) steepest = std::max(steepest, std::fabs(domain->h_inv[k]));
  certain = 0.25 * (double) IMGMASK / steepest;
  find_sizes();
  gather_small();
  find_extremes();
  report_faults();
  find_moments();
  const std::vector<Momenta> momenta = find_momenta();
  for (int part = 0; part < parts.number(); ++part) {
    made[part].body.extent = std::sqrt(momenta[part].extent2);
    if (made[part].body.from_file) check_place(part, momenta[part]);
    find_axes(part, momenta[part]);
  }
  orient_axes();
  if (former) keep_axes();
  for (int part = 0; part < parts.number(); ++part) find_rotation(part, momenta[part]);
  report_faults();
  report_missing();
  warn_of_clumps();
}

/// Different sums for different numbers of atoms of each type (splitmix64).
static uint64_t mixed(uint64_t type)
{
  uint64_t z = type * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

void Assembly::find_sizes()
{
  const Sizes none = {0, MAXTAGINT, {}, 0.0, 0.0, 0.0, 0.0, 1, 0};
  sizes = over_sites(none, [this](Sizes &all, int part) {
    Body &body = made[part].body;
    body.id = parts.key(part);
    body.from_file = given.count(body.id) > 0;
    for (const int i : parts.atoms(part)) {
      const double mass = mass_of(i), *v = atom->v[i];
      double x[3], inertia[9] = {}, momentum[3] = {};
      domain->unmap(atom->x[i], atom->image[i], x);
      if (extended) extended->own_momenta(i, mass, inertia, momentum);
      ++all.natoms;
      all.types += mixed(atom->type[i]);
      if (atom->tag[i] < all.first) {
        all.first = atom->tag[i];
        std::copy_n(x, 3, all.first_x);
      }
      all.mass = std::max(all.mass, std::fabs(mass));
      for (int k = 0; k < 3; ++k) {
        all.speed = std::max(all.speed, std::fabs(v[k]));
        all.own_momentum = std::max(all.own_momentum, std::fabs(momentum[k]));
      }
      for (const double one : inertia) all.own_inertia = std::max(all.own_inertia, std::fabs(one));
      double sum = mass + x[0] + x[1] + x[2];
      if (!body.from_file)
        for (int k = 0; k < 3; ++k) sum += v[k] + momentum[k] + inertia[4 * k];
      if (!std::isfinite(sum)) all.finite = 0;
    }
  });
  for (int part = 0; part < parts.number(); ++part)
    if (!sizes[part].finite) faulty[NOT_FINITE] = parts.key(part);
}

/// Sends small bodies as a whole, in the order of atom IDs, to all ranks that have some of their
/// sites.
void Assembly::gather_small()
{
  const auto by_tag = [this](int i, int j) {
    return atom->tag[i] < atom->tag[j];
  };
  for (int part = 0; part < parts.number(); ++part)
    if (is_small(part)) parts.sort_atoms(part, by_tag);
  if (comm->nprocs == 1) return;

  struct Message {
    tagint key;
    int rank, part;
    Site site;
  };
  std::vector<Message> messages;
  std::vector<int> ranks;
  for (const int part : parts.on_several_ranks()) {
    if (!is_small(part)) continue;
    for (const int i : parts.atoms(part)) {
      messages.push_back({parts.key(part), comm->me, part, site_of(part, i)});
      ranks.push_back((int) (parts.key(part) % comm->nprocs));
    }
  }
  messages = send_to_ranks(comm, world, std::move(messages), std::move(ranks));
  std::sort(messages.begin(), messages.end(), [](const Message &a, const Message &b) {
    return a.key != b.key  ? a.key < b.key
        : a.rank != b.rank ? a.rank < b.rank
                           : a.site.tag < b.site.tag;
  });
  std::vector<Message> replies;    // all sites to every rank
  ranks.clear();
  for (size_t first = 0, last; first < messages.size(); first = last) {
    for (last = first; last < messages.size() && messages[last].key == messages[first].key;) ++last;
    for (size_t to = first; to < last; ++to) {
      if (to > first && messages[to].rank == messages[to - 1].rank) continue;
      for (size_t i = first; i < last; ++i) {
        replies.push_back(
            {messages[to].key, messages[to].rank, messages[to].part, messages[i].site});
        ranks.push_back(messages[to].rank);
      }
    }
  }
  for (const auto &reply : send_to_ranks(comm, world, std::move(replies), std::move(ranks)))
    whole[reply.part].push_back(reply.site);
  for (auto &one : whole)
    std::sort(one.second.begin(), one.second.end(), [](const Site &a, const Site &b) {
      return a.tag < b.tag;
    });
  parts.complete([this](int part) {
    return is_small(part);
  });
}

void Assembly::find_extremes()
{
  const Extremes none = {{NONE, NONE, NONE}, {-NONE, -NONE, -NONE}, SiteSum()};
  extremes = over_sites(none, [this](Extremes &all, int part) {
    const double unit = unit_of(part, 1.0);
    visit(part, [&](const Site &site) {
      for (int k = 0; k < 3; ++k) {
        all.lo[k] = std::min(all.lo[k], site.x[k]);
        all.hi[k] = std::max(all.hi[k], site.x[k]);
      }
      all.mass.add(site.mass, unit);
    });
  });
  for (int part = 0; part < parts.number(); ++part) {
    Body &body = made[part].body;
    body.natoms = (tagint) sizes[part].natoms;
    body.rigid.mass = extremes[part].mass.value(unit_of(part, 1.0));
    if (!body.from_file && !(body.rigid.mass > 0.0)) faulty[MASSLESS] = body.id;
  }
}

/// The owner is the site nearest to the middle of the body, which needs the fewest ghosts.
void Assembly::find_moments()
{
  const Moments none = {NONE, MAXTAGINT, 0, 0, {}, {}, {}};
  const auto units = [this](int part) {
    return std::array<double, 2>{unit_of(part, radius(part)), unit_of(part, sizes[part].speed)};
  };
  const auto middle = [this](int part) {
    const double *lo = extremes[part].lo, *hi = extremes[part].hi;
    return std::array<double, 3>{0.5 * (lo[0] + hi[0]), 0.5 * (lo[1] + hi[1]),
                                 0.5 * (lo[2] + hi[2])};
  };
  const auto origin = [&](int part) {    // of the sums
    return is_small(part) ? std::array<double, 3>() : middle(part);
  };
  moments = over_sites(none, [&](Moments &all, int part) {
    const auto unit = units(part);
    const auto center = middle(part), from = origin(part);
    visit(part, [&](const Site &site) {
      const double d2 = distance2(site.x, center.data());
      if (d2 < all.distance2 || (d2 == all.distance2 && site.tag < all.owner)) {
        all.distance2 = d2;
        all.owner = site.tag;
        all.rank = site.rank;
        all.local = site.local;
        std::copy_n(site.x, 3, all.x);
      }
      for (int k = 0; k < 3; ++k) {
        all.center[k].add(site.mass * (site.x[k] - from[k]), unit[0]);
        all.momentum[k].add(site.mass * site.v[k], unit[1]);
      }
    });
  });
  for (int part = 0; part < parts.number(); ++part) {
    Made &one = made[part];
    const auto unit = units(part);
    const auto from = origin(part);
    const double mass = one.body.rigid.mass;
    one.owner = moments[part].owner;
    one.owner_rank = moments[part].rank;
    one.local = moments[part].local;
    for (int k = 0; k < 3; ++k) {
      one.state.center[k] = from[k] + moments[part].center[k].value(unit[0]) / mass;
      one.state.velocity[k] = moments[part].momentum[k].value(unit[1]) / mass;
    }
    if (sizes[part].natoms == 1)    // a lone site is at its center, without rounding
      visit(part, [&](const Site &site) {
        std::copy_n(site.x, 3, one.state.center);
        std::copy_n(site.v, 3, one.state.velocity);
      });
    if (one.body.from_file) take_given(given.at(one.body.id), part);
  }
}

/// Bounds of the terms: no arm is longer than twice the radius.
Assembly::MomentaUnits Assembly::units_of_momenta(int part) const
{
  const double r = radius(part), mass = sizes[part].mass;
  return {scale_of(part, mass * 4.0 * r * r + sizes[part].own_inertia),
          scale_of(part, mass * 8.0 * r * sizes[part].speed + sizes[part].own_momentum)};
}

std::vector<Assembly::Momenta> Assembly::find_momenta()
{
  const Momenta none = {0.0, NONE, {}, {}};
  return over_sites(none, [this](Momenta &all, int part) {
    const MomentaUnits unit = units_of_momenta(part);
    const BodyState &state = made[part].state;
    const bool counts = !made[part].body.from_file;
    if (counts && extended)
      visit(part, [&](const Site &site) {
        for (int k = 0; k < 3; ++k)
          all.angular_momentum_space[k].add(site.momentum_space[k], unit.momentum);
        for (int m = 0; m < 6; ++m)
          all.inertia_space[m].add(site.inertia_space[3 * ROW[m] + COLUMN[m]], unit.inertia);
      });
    visit(part, [&](const Site &site) {
      double arm[3], speed[3], spin[3];
      find_arm(site.x, state.center, arm);
      for (int k = 0; k < 3; ++k)
        speed[k] = is_small(part) ? site.v[k] : site.v[k] - state.velocity[k];
      cross3(arm, speed, spin);
      const double r2 = dot3(arm, arm);
      all.extent2 = std::max(all.extent2, distance2(site.x, moments[part].x));
      all.from_center2 = std::min(all.from_center2, r2);
      if (!counts || sizes[part].natoms == 1) return;    // a lone point has no rotation
      for (int k = 0; k < 3; ++k)
        all.angular_momentum_space[k].add(site.mass * spin[k], unit.momentum);
      for (int m = 0; m < 6; ++m) {
        const int k = ROW[m], l = COLUMN[m];
        all.inertia_space[m].add(site.mass * ((k == l ? r2 : 0.0) - arm[k] * arm[l]), unit.inertia);
      }
    });
  });
}

/// Only the owner's rank counts a body of the file.
void Assembly::take_given(const GivenBody &given_body, int part)
{
  Made &one = made[part];
  if (one.owner_rank == comm->me) found.push_back(one.body.id);
  one.body.rigid.mass = given_body.mass;
  for (int k = 0; k < 3; ++k) {
    one.state.center[k] = given_body.center[k];
    one.state.velocity[k] = given_body.velocity[k];
  }
  const imageint image = ((imageint) (given_body.image[0] + IMGMAX) & IMGMASK) |
      (((imageint) (given_body.image[1] + IMGMAX) & IMGMASK) << IMGBITS) |
      (((imageint) (given_body.image[2] + IMGMAX) & IMGMASK) << IMG2BITS);
  domain->unmap(one.state.center, image);
}

double Assembly::memory_usage() const
{
  return parts.memory_usage() + made.capacity() * sizeof(Made) + sizes.capacity() * sizeof(Sizes) +
      extremes.capacity() * sizeof(Extremes) + moments.capacity() * sizeof(Moments) +
      parts.number() * sizeof(Momenta);
}
