/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The table of rates, the limits of a step, and the end of a run in which a body has become unstable. */

#include "gear_quat_ranks.h"
#include "gear_quat_step.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   the table of rates
------------------------------------------------------------------------- */

std::string GearQuat::words_of(const Rate &rate)
{
  return fmt::format("{} {:.2g} in a step, and the method follows {:.2g}; {}", rate.what,
                     rate.radians, rate.limit, rate.remedy);
}

/// The rows of bodies, for the present step.  edge: radians of vibrations in a step, infinite if
/// unknown.  Collective.
void Step::note_rates(double edge)
{
  rates.clear();
  if (tolerance) return;
  const bool noisy = noise_of_forces(lmp, ownership).noise != Noise::NONE;
  if (noisy || !std::isfinite(edge)) edge = 0.0;
  const double h = std::fabs(length());
  const auto add = [&](const char *what, double radians, double limit, double advised) {
    rates.push_back({what, radians, limit,
                     fmt::format("use a time step of {:.4g} or shorter", h * advised / radians)});
  };
  double omega = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    omega = std::max(omega, GearQuat::length(bodies.state_of(ibody).omega_body));
  omega = over_ranks(MPI_MAX, omega, world);
  // free rotations are exact in formulation momentum, but the forces on them are not
  constexpr double PART = 2.0 / 3.0, TURN = 0.5;
  const double longest = longest_edge(scheme()), stable = fastest_oscillation(scheme());
  add("the angle of vibrations is", edge, longest, PART * longest);
  add("the angle by which the fastest body turns is", h * omega,
      scheme().momentum() ? MotionLimits::TURN : stable, std::min(PART * stable, TURN));
}

/// The bath is first, because it also accelerates bodies.
std::vector<Rate> Step::all_rates(double h) const
{
  std::vector<Rate> table = bath.rates(h);
  table.insert(table.end(), rates.begin(), rates.end());
  return table;
}

/// Rank 0 warns once of the first rate that is too large; others may have the same cause.
void Step::warn_of_rates()
{
  if (tolerance) return;
  for (const auto &rate : all_rates(length())) {
    if (!(rate.part() > 1.0)) continue;
    if (warned != rate.what && comm->me == 0)
      error->warning(FLERR, "Fix gear/quat {}: {}", fix->id, words_of(rate));
    warned = rate.what;
    return;
  }
}

/* ----------------------------------------------------------------------
   limits
------------------------------------------------------------------------- */

/// A shrink-wrapped box sets no limits.
void Step::find_limits(double h)
{
  constexpr int SHRINKS = 2;    // LAMMPS' boundary codes from this code on are shrink-wrapped
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int *faces = domain->boundary[k];
    const bool follows = faces[0] >= SHRINKS || faces[1] >= SHRINKS;
    longest = std::max(longest, follows ? HUGE_VAL : domain->prd[k]);
  }
  limits = MotionLimits(h, longest);
  if (tolerance && args.control.shortest == 0.0)    // turns are exact, and errors small
    limits.rate2 = HUGE_VAL;
}

/// Ends the run if the present loads would make a body unstable in the next step.  Atoms are at the
/// positions of the loads; f: forces on them.
void Step::watch_loads(double **f)
{
  find_limits(length());
  for (const auto *list : {&bodies.points, &bodies.tops, &bodies.fresh})
    for (const int ibody : *list) watch_load(ibody, length(), f);
}

void Step::watch_load(int ibody, double h, double **f) const
{
  const BodyState after =
      kicked(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.load_of(ibody), h);
  if (!limits.keep_velocities(after)) stop(ibody, after, h, f);
}

/// Ends the run on all ranks, called by the rank that owns the body (for a large one, by all of them
/// together).  The message gives step, time, body, its motion and load, its atom with the largest
/// force, and one remedy.  s: the resulting state, beyond the limits.
void Step::stop(int ibody, const BodyState &s, double h, double **f) const
{
  double largest = -1.0;    // force on an atom; infinite if it is not a finite number
  tagint worst = 0;
  for (const Site &site : sites) {
    if (site.body != ibody) continue;
    const double size = GearQuat::length(f[site.atom]);
    if (std::isfinite(size) && size <= largest) continue;
    largest = std::isfinite(size) ? size : HUGE_VAL;
    worst = atom->tag[site.atom];
  }
  const bool large = bodies.is_large(ibody);
  if (large && over_ranks(MPI_MAX, largest, world) > largest) worst = 0;
  if (large) worst = over_ranks(MPI_MAX, worst, world);
  const std::string text = fmt::format(
      "Fix gear/quat: blow-up in step {}, time {:g}: body {} {}; the largest force acts on its "
      "atom {}; {}",
      update->ntimestep, time_step.time_of(update->ntimestep), bodies.body_at(ibody).id,
      what_happened(ibody, s, h), worst, remedy(ibody, h));
  if (large) error->all(FLERR, text);
  error->one(FLERR, text);
}

/// Text for the limit that is exceeded; causes are tested before effects.
std::string Step::what_happened(int ibody, const BodyState &s, double h) const
{
  const Load &l = bodies.load_of(ibody);
  const double push = GearQuat::length(l.force) / force->ftm2v;
  const double twist = GearQuat::length(l.torque_space) / force->ftm2v;
  if (!std::isfinite(push)) return "meets a force that is not a finite number";
  if (!std::isfinite(twist)) return "meets a torque that is not a finite number";
  const std::string under = fmt::format("under a force of {:g} and a torque of {:g}", push, twist);
  if (limits.keep_velocities(s))
    return fmt::format("has a quaternion of squared length {:g} instead of 1, {}", dot4(s.q, s.q),
                       under);
  return fmt::format("moves by {:g} and turns by {:g} radians in one step, {}",
                     GearQuat::length(s.velocity) * std::fabs(h),
                     GearQuat::length(s.omega_body) * std::fabs(h), under);
}

std::string Step::remedy(int ibody, double h) const
{
  constexpr char APART[] = "begin with atoms farther apart, for example after minimize or a run "
                           "with keywords tolerance and temp";
  constexpr double OVERLAP = 100.0;    // times the limit: due to an overlap, and not to the step
  const Load &l = bodies.load_of(ibody);
  const double size = std::fabs(h);
  if (!std::isfinite(GearQuat::length(l.force) + GearQuat::length(l.torque_space))) return APART;

  for (const auto &rate : all_rates(h))
    if (rate.part() > 1.0) return rate.part() < OVERLAP ? words_of(rate) : APART;
  if (tolerance)
    return fmt::format("use a smaller tolerance, a dtmax shorter than {:g}, and no dtmin", size);
  return fmt::format("halve the time step, {:g}, until the run is stable; atoms that overlap have "
                     "to begin farther apart",
                     size);
}
