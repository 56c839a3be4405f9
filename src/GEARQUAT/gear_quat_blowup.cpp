/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_blowup.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

std::string GearQuat::words_of(const Rate &rate)
{
  return fmt::format("{} {:.2g} in a step, and the method follows {:.2g}; {}", rate.what,
                     rate.radians, rate.limit, rate.remedy);
}

void Blowup::watch_loads(double h, double **f) const
{
  for (const auto *list : {&bodies.points, &bodies.tops, &bodies.fresh})
    for (const int ibody : *list) watch_load(ibody, h, f);
}

void Blowup::watch_load(int ibody, double h, double **f) const
{
  const BodyState after =
      kicked(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.load_of(ibody), h);
  if (!limits.keep_velocities(after)) stop(ibody, after, h, f);
}

void Blowup::stop(int ibody, const BodyState &s, double h, double **f) const
{
  double largest = -1.0;    // force on an atom; infinite if it is not a finite number
  tagint worst = 0;
  for (const Site &site : sites) {
    if (site.body != ibody) continue;
    const double size = length(f[site.atom]);
    if (std::isfinite(size) && size <= largest) continue;
    largest = std::isfinite(size) ? size : HUGE_VAL;
    worst = atom->tag[site.atom];
  }
  const bool large = bodies.is_large(ibody);
  if (large && over_ranks(MPI_MAX, largest, world) > largest) worst = 0;
  if (large) worst = over_ranks(MPI_MAX, worst, world);
  const double time = update->atime + (update->ntimestep - update->atimestep) * update->dt;
  const std::string text = fmt::format(
      "Fix gear/quat: blow-up in step {}, time {:g}: body {} {}; the largest force acts on its "
      "atom {}; {}",
      update->ntimestep, time, bodies.body_at(ibody).id, what_happened(ibody, s, h), worst,
      remedy(ibody, s, h));
  if (large) error->all(FLERR, text);
  error->one(FLERR, text);
}

/// Text for the limit that is exceeded; causes are tested before effects.
std::string Blowup::what_happened(int ibody, const BodyState &s, double h) const
{
  const Load &l = bodies.load_of(ibody);
  const double push = length(l.force) / force->ftm2v, twist = length(l.torque_space) / force->ftm2v;
  if (!std::isfinite(push)) return "meets a force that is not a finite number";
  if (!std::isfinite(twist)) return "meets a torque that is not a finite number";
  const std::string under = fmt::format("under a force of {:g} and a torque of {:g}", push, twist);
  if (!limits.keep_velocities(s))
    return fmt::format("moves by {:g} and turns by {:g} radians in one step, {}",
                       length(s.velocity) * std::fabs(h), length(s.omega_body) * std::fabs(h),
                       under);
  return fmt::format("has a quaternion of squared length {:g} instead of 1, {}", dot4(s.q, s.q),
                     under);
}

std::string Blowup::remedy(int ibody, const BodyState &s, double h) const
{
  constexpr char APART[] = "begin with atoms farther apart, for example after minimize or a run "
                           "with keywords tolerance and temp";
  constexpr double OVERLAP = 100.0;    // times the limit: due to an overlap, and not to the step
  constexpr double SMALL = 0.01;       // moment of inertia by mass and extent
  const Body &body = bodies.body_at(ibody);
  const double size = std::fabs(h), push = length(bodies.load_of(ibody).force);
  const double spin = length(s.omega_body);
  if (!std::isfinite(push + length(bodies.load_of(ibody).torque_space))) return APART;

  double moment = 0.0;    // about the axis of rotation
  for (int k = 0; k < 3; ++k)
    moment += body.rigid.inertia[k] * s.omega_body[k] * s.omega_body[k] / (spin * spin);
  if (spin * size > 1.0 && moment < SMALL * body.rigid.mass * body.extent * body.extent)
    return fmt::format("its moment of inertia about the axis of this rotation, {:g}, is small for "
                       "its size; state a larger one, or 0 along this axis, by an infile",
                       moment);
  std::vector<Rate> table = rates;
  for (const auto &rate : bath.rates(h)) table.push_back(rate);
  for (const auto &rate : table)
    if (rate.part() > 1.0) return rate.part() < OVERLAP ? words_of(rate) : APART;
  if (size <= args.control.shortest)
    return fmt::format("leave out dtmin, or use one much shorter than {:g}", args.control.shortest);
  if (args.scheme.remembers)
    return fmt::format("use a smaller tolerance, or a dtmax shorter than {:g}", size);
  return fmt::format("halve the time step, {:g}, until the run is stable; atoms that overlap have "
                     "to begin farther apart",
                     size);
}
