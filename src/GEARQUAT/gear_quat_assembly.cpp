/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_assembly.h"

#include "gear_quat_box.h"
#include "gear_quat_exact_sum.h"
#include "gear_quat_extended.h"
#include "gear_quat_ranks.h"
#include "gear_quat_shapes.h"

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

// the most terms in a sum whose scale bounds each term

static constexpr double MANY = 524288.0;

static constexpr double ROUNDED = 1.0e-3;    // of a moment written with few digits

static constexpr double ON_AXIS = 1.0e-6;    // of the body's size: on neither side

/// Texts in the order of Assembly's faults; the first fault found is reported.
static const char *const FAULT_TEXTS[] = {
    "Fix gear/quat: body {} has no mass; the masses of its atoms must add up to more than zero",
    "Fix gear/quat: inertia or velocities of body {} are not finite numbers",
    "Fix gear/quat, infile or template: the inertia tensor of body {} has a negative principal "
    "moment, which is impossible",
    "Fix gear/quat, infile or template: the largest principal moment of body {} is more than the "
    "sum of the two others, which is impossible",
    "Fix gear/quat, infile or template: the center of mass of body {} is far away from all its "
    "atoms; are its position and its image flags right?"};

namespace {

/// The site with the smallest value, and among these with the smallest atom ID.
struct First {
  double value = NONE;
  tagint tag = MAXTAGINT;    ///< as long as there is no such site
  int rank = 0, local = 0;
  double x[3] = {};    ///< its place, or another number

  void take(const First &other)
  {
    if (other.value < value || (other.value == value && other.tag < tag)) *this = other;
  }
};

/// Results of one pass over the sites, for each part; merged, for the whole body: the largest of
/// some numbers, sums, and sites.
template <size_t LARGEST, size_t SUMS, size_t SITES> struct Pass {
  std::array<double, LARGEST> largest;
  std::array<ExactSum, SUMS> sums;
  std::array<First, SITES> sites;

  Pass() { largest.fill(-NONE); }
  void raise(int k, double number) { largest[k] = std::max(largest[k], number); }
  void merge(const Pass &other)
  {
    for (size_t k = 0; k < LARGEST; ++k) raise(k, other.largest[k]);
    for (size_t k = 0; k < SUMS; ++k) sums[k].add(other.sums[k]);
    for (size_t k = 0; k < SITES; ++k) sites[k].take(other.sites[k]);
  }
};

class Assembly : protected Pointers {
 public:
  Assembly(LAMMPS *lmp, const GivenBodies &given, const Extended *extended,
           const std::vector<tagint> &ids) :
      Pointers(lmp),
      given(given), extended(extended), parts(comm, world, ids.data(), (int) ids.size()),
      made(parts.number(), AssembledBody())
  {
    find_sizes();
    find_extremes();
    refuse_faults();
    find_moments();
    const std::vector<Momenta> momenta = find_momenta();
    for (int part = 0; part < parts.number(); ++part) {
      made[part].body.extent = std::sqrt(momenta[part].largest[EXTENT2]);
      if (made[part].body.from_file) check_place(part, momenta[part]);
      find_axes(part, momenta[part]);
    }
    orient_axes();
    for (int part = 0; part < parts.number(); ++part) find_rotation(part, momenta[part]);
    refuse_faults();
    refuse_missing();
  }

  const std::vector<AssembledBody> &bodies() const { return made; }
  void for_sites(const OfSite &act) const
  {
    for (int part = 0; part < parts.number(); ++part)
      for (const int i : parts.atoms(part)) {
        double x[3], arm[3], arm_body[3];
        unwrapped(part, i, x);
        find_arm(x, made[part].state.center, arm);
        to_body(made[part].axes, arm, arm_body);
        act(made[part], i, arm_body);
      }
  }

 private:
  const GivenBodies &given;
  const Extended *extended;
  Parts parts;
  std::vector<AssembledBody> made;

  enum { MASSLESS, NOT_FINITE, NEGATIVE, UNBALANCED, APART, FAULTS, TORN = FAULTS, FINDINGS };
  tagint faulty[FINDINGS] = {};    ///< a body with each fault on this rank, 0 for none
  std::vector<tagint> found;       ///< given bodies whose owner atoms are here

  struct Site {
    double mass;
    double x[3];    ///< unwrapped
    const double *v;
    int local;
    tagint tag;
  };

  // A pass needs the results of earlier passes.

  enum { MASS, SPEED, OWN_INERTIA, OWN_MOMENTUM, SIZES };    ///< of a component
  /// Scales of the sums; the number of sites; the first site, where image flags are relative to.
  using Sizes = Pass<SIZES, 1, 1>;
  /// The box around the sites: coordinates at its upper faces, and negative ones at its lower faces;
  /// the mass.
  using Extremes = Pass<6, 1, 0>;
  /// First moments of mass and velocity about the middle of this box; the site nearest to it.
  using Moments = Pass<0, 6, 1>;
  enum { EXTENT2, MINUS_FROM_CENTER2, DISTANCES };    ///< from the owner atom, squared, and so on
  /// About the center of mass: inertia xx, xy, xz, yy, yz, zz and angular momentum in space.
  using Momenta = Pass<DISTANCES, 9, 0>;
  /// The heaviest site outside of the plane across each axis, and its distance from the plane.
  using Sides = Pass<0, 0, 3>;
  std::vector<Sizes> sizes;
  std::vector<Extremes> extremes;
  std::vector<Moments> moments;

  /// Rows and columns of the six components of a symmetric tensor.
  static constexpr int ROW[6] = {0, 0, 0, 1, 1, 2}, COLUMN[6] = {0, 1, 2, 1, 2, 2};

  double mass_of(int i) const { return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]]; }

  void unwrapped(int part, int i, double *x) const
  {
    const double *first = sizes[part].sites[0].x;
    domain->unmap(atom->x[i], atom->image[i], x);
    double way[3];
    through(domain->h, image_flag_overflow(domain, first, x).data(), way);
    for (int k = 0; k < 3; ++k) x[k] += way[k];
  }

  /// act: of every site of a part.
  template <class Act> void visit(int part, Act act) const
  {
    for (const int i : parts.atoms(part)) act(site_of(part, i));
  }
  struct Scales {
    double mass, center, momentum, inertia, angular_momentum;
  };
  /// add: takes the sites of a part into its item.  Returns the items of whole bodies.
  template <class Item, class Add> std::vector<Item> over_sites(Add add) const
  {
    std::vector<Item> items(parts.number());
    for (int part = 0; part < parts.number(); ++part) add(items[part], part);
    parts.merge(items);
    return items;
  }

  /// The vector from the center of mass to a site; zero if the two coincide up to rounding.
  void find_arm(const double *x, const double *center, double *arm) const
  {
    for (int k = 0; k < 3; ++k) arm[k] = x[k] - center[k];
    const double size = domain->xprd + domain->yprd + domain->zprd + length(x);
    if (length(arm) <= ROUNDING * size) std::fill_n(arm, 3, 0.0);
  }

  Site site_of(int part, int i) const
  {
    Site site = {mass_of(i), {}, atom->v[i], i, atom->tag[i]};
    unwrapped(part, i, site.x);
    return site;
  }

  bigint number_of_sites(int part) const { return (bigint) sizes[part].sums[0].value(); }

  std::array<double, 3> middle(int part) const
  {
    const double *hi = extremes[part].largest.data();
    return {0.5 * (hi[0] - hi[3]), 0.5 * (hi[1] - hi[4]), 0.5 * (hi[2] - hi[5])};
  }

  /// No site is further away from the middle of the box around the sites.
  double radius(int part) const
  {
    const double *hi = extremes[part].largest.data();
    const double edges[3] = {hi[0] + hi[3], hi[1] + hi[4], hi[2] + hi[5]};
    return 0.5 * length(edges);
  }

  /// The scales of sums over all sites of a body, from bounds of the terms: no arm is longer than twice
  /// the radius.
  Scales scales(int part) const
  {
    const auto &size = sizes[part].largest;
    const double r = extremes.empty() ? 0.0 : radius(part), mass = size[MASS];
    const double many = std::max(1.0, (double) number_of_sites(part) / MANY);
    const auto of = [many](double bound) {
      return ExactSum::scale_of(bound * many);
    };
    return {of(mass), of(mass * r), of(mass * size[SPEED]),
            of(mass * 4.0 * r * r + size[OWN_INERTIA]),
            of(mass * 8.0 * r * size[SPEED] + size[OWN_MOMENTUM])};
  }

  void find_sizes()
  {
    sizes = over_sites<Sizes>([this](Sizes &all, int part) {
      Body &body = made[part].body;
      body.id = parts.key(part);
      body.from_file = given.count(body.id) > 0;
      for (const int i : parts.atoms(part)) {
        const double mass = mass_of(i), *v = atom->v[i];
        double inertia[9] = {}, momentum[3] = {};
        First site = {0.0, atom->tag[i]};
        domain->unmap(atom->x[i], atom->image[i], site.x);
        if (extended) extended->own_momenta(i, mass, inertia, momentum);
        all.sums[0].add(1.0, 1.0);
        all.sites[0].take(site);
        all.raise(MASS, std::fabs(mass));
        for (int k = 0; k < 3; ++k) {
          all.raise(SPEED, std::fabs(v[k]));
          all.raise(OWN_MOMENTUM, std::fabs(momentum[k]));
        }
        for (const double one : inertia) all.raise(OWN_INERTIA, std::fabs(one));
        double sum = mass + site.x[0] + site.x[1] + site.x[2];
        if (!body.from_file)
          for (int k = 0; k < 3; ++k) sum += v[k] + momentum[k] + inertia[4 * k];
        if (!std::isfinite(sum)) faulty[NOT_FINITE] = body.id;
      }
    });
  }

  void find_extremes()
  {
    extremes = over_sites<Extremes>([this](Extremes &all, int part) {
      const double unit = scales(part).mass;
      visit(part, [&](const Site &site) {
        for (int k = 0; k < 3; ++k) {
          all.raise(k, site.x[k]);
          all.raise(3 + k, -site.x[k]);
        }
        all.sums[0].add(site.mass, unit);
      });
    });
    for (int part = 0; part < parts.number(); ++part) {
      Body &body = made[part].body;
      body.natoms = (tagint) number_of_sites(part);
      body.rigid.mass = extremes[part].sums[0].value();
      if (!body.from_file && !(body.rigid.mass > 0.0)) faulty[MASSLESS] = body.id;
    }
  }

  /// The owner is the site nearest to the middle of the body, which needs the fewest ghosts.
  void find_moments()
  {
    moments = over_sites<Moments>([&](Moments &all, int part) {
      const Scales scale = scales(part);
      const auto center = middle(part);
      visit(part, [&](const Site &site) {
        First one = {distance2(site.x, center.data()), site.tag, comm->me, site.local};
        std::copy_n(site.x, 3, one.x);
        all.sites[0].take(one);
        for (int k = 0; k < 3; ++k) {
          all.sums[k].add(site.mass * (site.x[k] - center[k]), scale.center);
          all.sums[3 + k].add(site.mass * site.v[k], scale.momentum);
        }
      });
    });
    for (int part = 0; part < parts.number(); ++part) {
      AssembledBody &one = made[part];
      const auto from = middle(part);
      const double mass = one.body.rigid.mass;
      const First &owner = moments[part].sites[0];
      one.owner = owner.tag;
      one.owner_rank = owner.rank;
      one.local = owner.local;
      for (int k = 0; k < 3; ++k) {
        one.state.center[k] = from[k] + moments[part].sums[k].value() / mass;
        one.state.velocity[k] = moments[part].sums[3 + k].value() / mass;
      }
      if (one.body.natoms == 1)    // without rounding
        std::copy_n(atom->v[parts.atoms(part).first[0]], 3, one.state.velocity);
      check_parts(part);
      if (one.body.from_file) take_given(given.at(one.body.id), part);
    }
  }

  std::vector<Momenta> find_momenta()
  {
    return over_sites<Momenta>([this](Momenta &all, int part) {
      const Scales scale = scales(part);
      const BodyState &state = made[part].state;
      const bool counts = !made[part].body.from_file;
      visit(part, [&](const Site &site) {
        double arm[3], speed[3], spin[3], own_inertia[9] = {}, own_momentum[3] = {};
        find_arm(site.x, state.center, arm);
        for (int k = 0; k < 3; ++k) speed[k] = site.v[k] - state.velocity[k];
        cross3(arm, speed, spin);
        const double r2 = dot3(arm, arm);
        all.raise(EXTENT2, distance2(site.x, moments[part].sites[0].x));
        all.raise(MINUS_FROM_CENTER2, -r2);
        if (!counts) return;
        if (extended) extended->own_momenta(site.local, site.mass, own_inertia, own_momentum);
        for (int k = 0; k < 3; ++k)
          all.sums[6 + k].add(own_momentum[k] + site.mass * spin[k], scale.angular_momentum);
        for (int m = 0; m < 6; ++m) {
          const int k = ROW[m], l = COLUMN[m];
          all.sums[m].add(own_inertia[3 * k + l] +
                              site.mass * ((k == l ? r2 : 0.0) - arm[k] * arm[l]),
                          scale.inertia);
        }
      });
    });
  }

  /// Only the owner's rank counts a body of the file.
  void take_given(const GivenBody &given_body, int part)
  {
    AssembledBody &one = made[part];
    if (one.owner_rank == comm->me) found.push_back(one.body.id);
    one.body.rigid.mass = given_body.mass;
    if (!(given_body.mass > 0.0)) faulty[MASSLESS] = one.body.id;
    for (int k = 0; k < 3; ++k) {
      one.state.center[k] = given_body.center[k];
      one.state.velocity[k] = given_body.velocity[k];
    }
    const imageint image = ((imageint) (given_body.image[0] + IMGMAX) & IMGMASK) |
        (((imageint) (given_body.image[1] + IMGMAX) & IMGMASK) << IMGBITS) |
        (((imageint) (given_body.image[2] + IMGMAX) & IMGMASK) << IMG2BITS);
    domain->unmap(one.state.center, image);
  }

  /// Principal moments, and axes without directions.
  void find_axes(int part, const Momenta &momenta)
  {
    double tensor[9];
    for (int m = 0; m < 6; ++m)
      tensor[3 * ROW[m] + COLUMN[m]] = tensor[3 * COLUMN[m] + ROW[m]] = momenta.sums[m].value();
    AssembledBody &one = made[part];
    if (one.body.from_file) {
      const double *i = given.at(one.body.id).inertia;
      const double given_tensor[9] = {i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2]};
      std::copy_n(given_tensor, 9, tensor);
    }
    // in two dimensions bodies turn about the z axis, which does not change at all
    if (domain->dimension == 2) tensor[2] = tensor[5] = tensor[6] = tensor[7] = 0.0;
    double *moments = one.body.rigid.inertia;
    principal_axes(tensor, moments, one.axes);
    check_moments(one);
    drop_vanishing_moments(moments);
    if (domain->dimension == 3) sort_axes(moments, one.axes);
  }

  /// Orientation and angular velocity.
  void find_rotation(int part, const Momenta &momenta)
  {
    AssembledBody &one = made[part];
    const double *moments = one.body.rigid.inertia;
    double momentum_space[3], momentum_body[3];
    for (int k = 0; k < 3; ++k)
      momentum_space[k] = one.body.from_file ? given.at(one.body.id).angular_momentum_space[k]
                                             : momenta.sums[6 + k].value();
    quaternion_from_matrix(one.axes, one.state.q);
    to_body(one.axes, momentum_space, momentum_body);
    for (int k = 0; k < 3; ++k)
      one.state.omega_body[k] = moments[k] > 0.0 ? momentum_body[k] / moments[k] : 0.0;
    if (domain->dimension == 2)
      one.state.velocity[2] = one.state.omega_body[0] = one.state.omega_body[1] = 0.0;
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(one.state.omega_body[k]) || !std::isfinite(one.state.velocity[k]))
        faulty[NOT_FINITE] = one.body.id;
  }

  /// Directs the axes by the body itself, not by its orientation at the start: the first and the
  /// third axis point to the side of the heaviest site that is not in the plane perpendicular to the
  /// axis; among equally heavy sites the first one counts.
  void orient_axes()
  {
    if (domain->dimension != 3) return;
    const auto sides = over_sites<Sides>([this](Sides &all, int part) {
      visit(part, [&](const Site &site) {
        double arm[3], side[3];
        for (int k = 0; k < 3; ++k) arm[k] = site.x[k] - made[part].state.center[k];
        to_body(made[part].axes, arm, side);
        for (int k = 0; k < 3; ++k)
          if (std::fabs(side[k]) >= ON_AXIS * radius(part))
            all.sites[k].take({-site.mass, site.tag, 0, 0, {side[k]}});
      });
    });
    for (int part = 0; part < parts.number(); ++part) direct(made[part].axes, sides[part]);
  }

  /// Sets two directions; the third axis follows from them.
  void direct(double *axes, const Sides &sides)
  {
    // false if all sites are in the plane perpendicular to the axis

    const auto turn = [&](int k) {
      if (sides.sites[k].tag == MAXTAGINT) return false;
      if (sides.sites[k].x[0] < 0.0)
        for (int i = 3 * k; i < 3 * k + 3; ++i) axes[i] = -axes[i];
      return true;
    };
    const bool first = turn(0), third = turn(2);
    const int last = first == third ? 1 : first ? 2 : 0;
    if (last != 1) turn(1);
    cross3(axes + 3 * ((last + 1) % 3), axes + 3 * ((last + 2) % 3), axes + 3 * last);
  }

  /// Two plates may be one body, but two halves of a molecule at opposite faces of the box may not: then
  /// even the site nearest to the middle is far from it.
  void check_parts(int part)
  {
    constexpr double FAR = 1.0 / 3.0;    // of a period
    const auto center = middle(part);
    double way[3], periods[3];
    for (int k = 0; k < 3; ++k) way[k] = moments[part].sites[0].x[k] - center[k];
    to_periods(domain, way, periods);
    for (int k = 0; k < domain->dimension; ++k)
      if (domain->periodicity[k] && std::fabs(periods[k]) > FAR) faulty[TORN] = parts.key(part);
  }

  /// A given center may lie outside of the body, but not by half a box, since image flags belong to
  /// it.
  void check_place(int part, const Momenta &momenta)
  {
    const double longest = std::max({domain->xprd, domain->yprd, domain->zprd});
    const double far = made[part].body.extent + 0.5 * longest;
    if (!(-momenta.largest[MINUS_FROM_CENTER2] <= far * far)) faulty[APART] = made[part].body.id;
  }

  /// Sums over masses satisfy all of this automatically, up to rounding.
  void check_moments(const AssembledBody &one)
  {
    const double *moments = one.body.rigid.inertia;
    const double largest = std::max({moments[0], moments[1], moments[2]});
    const double smallest = std::min({moments[0], moments[1], moments[2]});
    const double sum = moments[0] + moments[1] + moments[2];
    if (!std::isfinite(sum))
      faulty[NOT_FINITE] = one.body.id;
    else if (smallest < -LINEAR_FRACTION * largest)
      faulty[NEGATIVE] = one.body.id;
    else if (one.body.from_file && domain->dimension == 3 &&
             (1.0 - ROUNDED) * largest > sum - largest)
      faulty[UNBALANCED] = one.body.id;
  }

  void refuse_faults()
  {
    const auto any = over_ranks(MPI_MAX, faulty, world);
    for (int fault = 0; fault < FAULTS; ++fault)
      if (any[fault] > 0) error->all(FLERR, FAULT_TEXTS[fault], any[fault]);
    if (any[TORN] > 0 && comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat: parts of body {} are more than half of a periodic box apart; if "
          "they belong together, the image flags of its atoms are wrong: unwrap the atoms "
          "in the data file, or use set image before this fix",
          any[TORN]);
  }

  void refuse_missing()
  {
    const auto all = gather_sorted(found, world);
    for (const auto &stated : given)
      if (!std::binary_search(all.begin(), all.end(), stated.first))
        error->all(FLERR, "Fix gear/quat infile: no atom belongs to body {}", stated.first);
  }
};

}    // namespace

std::vector<AssembledBody> GearQuat::assemble(LAMMPS *lmp, const GivenBodies &given,
                                              const Extended *extended,
                                              const std::vector<tagint> &ids, const OfSite &act)
{
  const Assembly assembly(lmp, given, extended, ids);
  assembly.for_sites(act);
  return assembly.bodies();
}
