/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_sites.h"

#include "gear_quat_box.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "domain.h"
#include "force.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double SAME = 1.0e-11;    // rounding of coordinates and velocities

/// LAMMPS' arrays of vectors are one block of memory.
static double *first_of(double **vectors)
{
  return vectors ? vectors[0] : nullptr;
}

/* ---------------------------------------------------------------------- */

Sites::Sites(LAMMPS *lmp, Bodies &bodies, Ownership &ownership) :
    Pointers(lmp), bodies(bodies), ownership(ownership), extended(ownership.extended())
{
}

/* ----------------------------------------------------------------------
   the list
------------------------------------------------------------------------- */

void Sites::list()
{
  ++nplacements;
  sort();
  std::map<std::array<int, 3>, int> known;
  images.clear();
  image.resize(sites.size());
  for (size_t n = 0; n < sites.size(); ++n) {
    const auto periods = image_of(sites[n]);
    if (n > 0 && periods == images[image[n - 1]]) {
      image[n] = image[n - 1];
      continue;
    }
    const auto entry = known.emplace(periods, (int) images.size());
    if (entry.second) images.push_back(periods);
    image[n] = entry.first->second;
  }
  extended.sites.clear();
  if (extended.has_records())
    for (const Site &site : sites) extended.list(site.atom, site.body);
}

/// Counts the sites of each body, then moves each to its position.
void Sites::sort()
{
  const int n = bodies.nhere();
  const auto is_centered = [this](int i) {
    const double *arm = ownership.arm_of(i);
    return dot3(arm, arm) == 0.0;
  };
  first.assign(n + 1, 0);
  first_arm.assign(n, 0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int ibody = ownership.body_of(i);
    if (ibody < 0) continue;
    ++first[ibody + 1];
    first_arm[ibody] += is_centered(i);
  }
  for (int ibody = 0; ibody < n; ++ibody) {
    first[ibody + 1] += first[ibody];
    first_arm[ibody] += first[ibody];
  }
  if ((size_t) first[n] > sites.capacity()) sites = std::vector<Site>();    // not both
  sites.resize(first[n]);
  std::vector<int> next(first.begin(), first.end() - 1), next_arm(first_arm);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int ibody = ownership.body_of(i);
    if (ibody < 0) continue;
    const double *arm = ownership.arm_of(i);
    sites[is_centered(i) ? next[ibody]++ : next_arm[ibody]++] = {
        i, ibody, {arm[0], arm[1], arm[2]}};
  }
}

std::array<int, 3> Sites::image_of(const Site &site) const
{
  const imageint flags = atom->image[site.atom];
  std::array<int, 3> periods = periods_of(flags);
  double away[3] = {0.0, 0.0, 0.0}, arm[3], expected[3];
  domain->unmap(away, flags);
  to_space(bodies.frame[site.body].axes, site.arm_body, arm);
  const double *center = bodies.state[site.body].center, *x = atom->x[site.atom];
  for (int k = 0; k < 3; ++k) expected[k] = center[k] + arm[k] - x[k];
  const auto turns = image_flag_overflow(domain, expected, away);
  for (int k = 0; k < 3; ++k) periods[k] += (int) turns[k];
  return periods;
}

/* ----------------------------------------------------------------------
   positions and velocities
------------------------------------------------------------------------- */

/// Computes the displacements of the images in the present box.
void Sites::find_ways()
{
  ways.resize(images.size());
  for (size_t m = 0; m < images.size(); ++m) through(domain->h, images[m].data(), ways[m].data());
}

template <bool POSITIONS, bool VELOCITIES> void Sites::place_points()
{
  ++nplacements;
  if (POSITIONS) find_ways();
  const auto *way = ways.data();
  const Site *const all = sites.data(), *site = all;
  double *const x = first_of(atom->x), *const v = first_of(atom->v);
  const int n = bodies.nhere();
  for (int ibody = 0; ibody < n; ++ibody) {
    const BodyState &s = bodies.state[ibody];
    const BodyFrame &frame = bodies.frame[ibody];
    const Site *const arms = all + first_arm[ibody], *const end = all + first[ibody + 1];
    for (; site != arms; ++site) {
      const size_t i = 3 * (size_t) site->atom;
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        if (POSITIONS) x[i + k] = s.center[k] - way[image[site - all]][k];
        if (VELOCITIES) v[i + k] = s.velocity[k];
      }
    }
    for (; site != end; ++site) {
      const size_t i = 3 * (size_t) site->atom;
      double arm[3], spin[3];
      to_space(frame.axes, site->arm_body, arm);
      if (VELOCITIES) cross3(frame.omega_space, arm, spin);
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) {
        if (POSITIONS) x[i + k] = s.center[k] + arm[k] - way[image[site - all]][k];
        if (VELOCITIES) v[i + k] = s.velocity[k] + spin[k];
      }
    }
  }
  if (VELOCITIES) {
    note_rates();
    if (domain->deform_vremap)
      for (const Site &site : sites) add_flow(site, 1.0, atom->v[site.atom]);
  }
  if (VELOCITIES && atom->vest)
    for (const Site &site : sites) std::copy_n(atom->v[site.atom], 3, atom->vest[site.atom]);
  if (!extended.sites.empty()) extended.place(bodies, POSITIONS, VELOCITIES);
}

void Sites::place(bool velocities)
{
  velocities ? place_points<true, true>() : place_points<true, false>();
}

void Sites::place_velocities()
{
  place_points<false, true>();
}

void Sites::advance_densities(double step)
{
  if (!atom->rho || !atom->esph || !atom->vest) return;    // of atom style sph alone
  const double half = 0.5 * step * force->ftm2v;
  for (const Site &site : sites) {
    atom->rho[site.atom] += half * atom->drho[site.atom];
    atom->esph[site.atom] += half * atom->desph[site.atom];
  }
}

void Sites::place_extended()
{
  if (!extended.sites.empty()) extended.place(bodies, true, true);
}

void Sites::note_rates()
{
  face_rates = {};
  if (!domain->deform_vremap) return;
  std::copy_n(domain->h_rate, face_rates.size(), face_rates.begin());
  face_group = domain->deform_groupbit;
}

/// Adds the velocity of a site's image relative to the image of its body.
void Sites::add_flow(const Site &site, double factor, double *velocity) const
{
  const auto &mine = images[image[&site - begin()]], &of_body = bodies.body[site.body].image;
  if (mine == of_body || !(atom->mask[site.atom] & face_group)) return;
  double periods[3], flow[3];
  for (int k = 0; k < 3; ++k) periods[k] = factor * (of_body[k] - mine[k]);
  through(face_rates.data(), periods, flow);
  add3(flow, velocity);
}

void Sites::take_out_flow()
{
  note_rates();
  if (!domain->deform_vremap) return;
  for (const Site &site : sites) add_flow(site, -1.0, atom->v[site.atom]);
}

/// The displacement of its image.
void Sites::wrap(const Site &site, double *away) const
{
  through(domain->h, images[image[&site - begin()]].data(), away);
}

Sites::Expected Sites::expected_position(const Site &site) const
{
  const double box = std::max({domain->xprd, domain->yprd, domain->zprd});
  const double *center = bodies.state[site.body].center;
  double arm[3], away[3];
  Expected x;
  wrap(site, away);
  to_space(bodies.frame[site.body].axes, site.arm_body, arm);
  for (int k = 0; k < 3; ++k) x.value[k] = center[k] + arm[k] - away[k];
  x.size = box + std::sqrt(dot3(center, center) + dot3(away, away));
  return x;
}

Sites::Expected Sites::expected_velocity(const Site &site) const
{
  const double *velocity = bodies.state[site.body].velocity;
  const BodyFrame &frame = bodies.frame[site.body];
  double arm[3], spin[3];
  Expected v;
  to_space(frame.axes, site.arm_body, arm);
  cross3(frame.omega_space, arm, spin);
  double flow[3] = {0.0, 0.0, 0.0};
  if (face_rates != Rates()) add_flow(site, 1.0, flow);
  for (int k = 0; k < 3; ++k) v.value[k] = velocity[k] + spin[k] + flow[k];
  v.size = length(velocity) + length(spin) + length(flow);
  return v;
}

static bool near(const double *a, const Sites::Expected &expected)
{
  for (int k = 0; k < 3; ++k)
    if (!(std::fabs(a[k] - expected.value[k]) <= SAME * expected.size)) return false;
  return true;
}

double Sites::displacement(const Site &site) const
{
  const Expected there = expected_position(site);
  const double *x = atom->x[site.atom];
  return near(x, there) ? 0.0 : std::sqrt(distance2(x, there.value));
}

bool Sites::is_as_fast(const Site &site) const
{
  return near(atom->v[site.atom], expected_velocity(site));
}

/* ----------------------------------------------------------------------
   masses, positions and velocities
------------------------------------------------------------------------- */

double Sites::farthest() const
{
  double here = 0.0;
  for (const Site &site : sites) here = std::max(here, displacement(site));
  return over_ranks(MPI_MAX, here, world);
}

bool Sites::any_changes() const
{
  int here = 0;
  for (const Site &site : sites) {
    const int i = site.atom;
    if (displacement(site) != 0.0 || !is_as_fast(site) || ownership.has_other_mass(i) ||
        !extended.match(i, ownership.mass_of(i), bodies, site.body))
      here = 1;
  }
  return over_ranks(MPI_MAX, here, world) != 0;
}

/* ----------------------------------------------------------------------
   sums over sites
------------------------------------------------------------------------- */

/// One sum for each body on this rank: start(ibody) initializes it, add(sum, site, arm_space) adds
/// a site, finish(ibody, sum) uses it.  arm_space: null for a site at the center of mass.
template <class Start, class Add, class Finish>
void Sites::sum_over_sites(Start start, Add add, Finish finish) const
{
  const int nbodies = bodies.nhere();
  for (int ibody = 0, n = 0; ibody < nbodies; ++ibody) {
    auto sum = start(ibody);
    for (; n < first_arm[ibody]; ++n) add(sum, sites[n], nullptr);
    for (; n < first[ibody + 1]; ++n) {
      double arm[3];
      to_space(bodies.frame[ibody].axes, sites[n].arm_body, arm);
      add(sum, sites[n], arm);
    }
    finish(ibody, sum);
  }
}

void Sites::gather_loads(double **f, double **torque)
{
  const double *const forces = first_of(f);
  std::vector<Load> &loads = bodies.load;
  sum_over_sites(
      [](int) {
        return Load();
      },
      [forces](Load &sum, const Site &site, const double *arm) {
        const double *f = forces + 3 * (size_t) site.atom;
        add3(f, sum.force);
        if (!arm) return;
        double moment[3];
        cross3(arm, f, moment);
        add3(moment, sum.torque_space);
      },
      [&loads](int ibody, const Load &sum) {
        loads[ibody] = sum;
      });
  if (!extended.sites.empty()) extended.add_torques(torque, loads);
  ownership.sum(loads);
  for (int ibody = 0; ibody < bodies.nmoved() && domain->dimension == 2; ++ibody)
    loads[ibody].force[2] = loads[ibody].torque_space[0] = loads[ibody].torque_space[1] = 0.0;

  const double ftm2v = force->ftm2v;
  if (ftm2v == 1.0) return;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    for (int k = 0; k < 3; ++k) {
      loads[ibody].force[k] *= ftm2v;
      loads[ibody].torque_space[k] *= ftm2v;
    }
}

void Sites::add_arm_virial(double **f, ExactSum *sums, double scale) const
{
  using Products = std::array<double, 6>;
  sum_over_sites(
      [](int) {
        return Products{};
      },
      [f](Products &sum, const Site &site, const double *arm) {
        if (!arm) return;
        const double *on_site = f[site.atom];
        for (int k = 0; k < 3; ++k) sum[k] += on_site[k] * arm[k];
        sum[3] += on_site[1] * arm[2];
        sum[4] += on_site[0] * arm[2];
        sum[5] += on_site[0] * arm[1];
      },
      [sums, scale](int, const Products &sum) {
        if (sum == Products{}) return;    // no arms
        for (int k = 0; k < 6; ++k) sums[k].add(sum[k], scale);
      });
}

/// Mean of the arms of all sites of each body, owned and ghost.  Collective.
std::vector<std::array<double, 3>> Sites::centroids()
{
  std::vector<std::array<double, 3>> means(bodies.nhere());
  for (const Site &site : sites) {
    double arm[3];
    to_space(bodies.frame[site.body].axes, site.arm_body, arm);
    for (int k = 0; k < 3; ++k) means[site.body][k] += arm[k] / bodies.body[site.body].natoms;
  }
  ownership.sum(means);
  ownership.spread(means);
  return means;
}

void Sites::visit_constraint_forces(double **f, bool all, Turning turning,
                                    const std::function<void(int, ConstraintForce &)> &tally)
{
  struct Acceleration {
    double linear[3], angular[3];    // in space
  };
  ownership.spread(bodies.load);
  std::vector<std::array<double, 3>> means;
  if (all) means = centroids();
  sum_over_sites(
      [this, turning](int ibody) {
        const RigidBody &rigid = bodies.body[ibody].rigid;
        const Load &load = bodies.load[ibody];
        Acceleration acceleration = {};
        for (int k = 0; k < 3; ++k) acceleration.linear[k] = load.force[k] / rigid.mass;
        if (turning == Turning::NO) return acceleration;
        double torque_body[3], alpha_body[3];
        to_body(bodies.frame[ibody].axes, load.torque_space, torque_body);
        angular_acceleration(rigid, torque_body, bodies.state[ibody].omega_body, alpha_body);
        to_space(bodies.frame[ibody].axes, alpha_body, acceleration.angular);
        return acceleration;
      },
      [&](const Acceleration &acceleration, const Site &site, const double *arm) {
        if (!arm && !all) return;
        ConstraintForce constraint = {};
        double *lacking = constraint.force[0], *arm_space = constraint.arm[0];
        if (arm) std::copy_n(arm, 3, arm_space);
        if (all) std::copy_n(means[site.body].begin(), 3, constraint.centroid);
        double tangential[3], radial[3] = {0.0, 0.0, 0.0};
        cross3(acceleration.angular, arm_space, tangential);
        if (turning == Turning::YES) {
          const double *omega_space = bodies.frame[site.body].omega_space;
          double spin[3];
          cross3(omega_space, arm_space, spin);
          cross3(omega_space, spin, radial);
        }
        const double mass = ownership.mass_of(site.atom) / force->ftm2v;
        for (int k = 0; k < 3; ++k)
          lacking[k] =
              mass * (acceleration.linear[k] + tangential[k] + radial[k]) - f[site.atom][k];
        for (int k = 0; k < 3; ++k) constraint.virial[k] = arm_space[k] * lacking[k];
        // if forces act only at the center of mass, a torque remains, and the virial is not
        // symmetric: it depends on whether the box shears y into x (and z into both) or x into y
        const bool turns = turning == Turning::YES;
        const double *to = turns ? arm_space : lacking, *from = turns ? lacking : arm_space;
        constraint.virial[3] = to[0] * from[1];
        constraint.virial[4] = to[0] * from[2];
        constraint.virial[5] = to[1] * from[2];
        tally(site.atom, constraint);
      },
      [](int, const Acceleration &) {
      });
}

double Sites::memory_usage() const
{
  return sites.capacity() * sizeof(Site) + images.capacity() * sizeof(images[0]) +
      ways.capacity() * sizeof(ways[0]) +
      (image.capacity() + first.capacity() + first_arm.capacity()) * sizeof(int);
}
