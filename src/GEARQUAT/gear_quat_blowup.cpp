/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_blowup.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double NONE = std::numeric_limits<double>::infinity();

/// LAMMPS' code for a face that follows the atoms begins with this one.
static constexpr int SHRINKS = 2;

static double length(const double *a)
{
  return std::sqrt(dot3(a, a));
}

/* ---------------------------------------------------------------------- */

MotionLimits GearQuatBlowup::limits(double h) const
{
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int *faces = domain->boundary[k];
    const bool follows = faces[0] >= SHRINKS || faces[1] >= SHRINKS;
    longest = std::max(longest, follows ? NONE : domain->prd[k]);
  }
  return MotionLimits(h, longest);
}

void GearQuatBlowup::check_loads(double h, double **f) const
{
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) check_load(ibody, h, f);
}

void GearQuatBlowup::check_load(int ibody, double h, double **f) const
{
  const BodyState after =
      kicked(bodies.body[ibody].rigid, bodies.state[ibody], bodies.load[ibody], h);
  if (!limits(h).keep_velocities(after)) stop(ibody, after, h, f);
}

void GearQuatBlowup::stop(int ibody, const BodyState &s, double h, double **f) const
{
  const tagint id = bodies.body[ibody].id;
  const double time = update->atime + (update->ntimestep - update->atimestep) * update->dt;
  std::string molecule;
  for (const auto &site : bodies.sites)
    if (site.body == ibody && atom->molecule_flag && atom->molecule[site.atom] != id)
      molecule = fmt::format(" (molecule {})", atom->molecule[site.atom]);
  const std::string change = scheme.trial
      ? fmt::format("a smaller tolerance, or a dtmax shorter than {:g},", std::fabs(h))
      : fmt::format("a smaller time step than {:g} or fewer values than {},", std::fabs(h),
                    scheme.values());
  error->one(FLERR,
             "Fix gear/quat: blow-up in step {}, time {:g}: body {}{} {}{}. Use {} or begin with "
             "atoms further apart",
             update->ntimestep, time, id, molecule, what_happened(ibody, s, h), where(ibody, f),
             change);
}

/// What is beyond the limits, the first thing in the order of cause and effect.
std::string GearQuatBlowup::what_happened(int ibody, const BodyState &s, double h) const
{
  const Load &l = bodies.load[ibody];
  const double push = length(l.force) / force->ftm2v, twist = length(l.torque_space) / force->ftm2v;
  if (!std::isfinite(push)) return "meets a force that is not a finite number";
  if (!std::isfinite(twist)) return "meets a torque that is not a finite number";
  const std::string under = fmt::format("under a force of {:g} and a torque of {:g}", push, twist);
  if (!limits(h).keep_velocities(s))
    return fmt::format("moves by {:g} and turns by {:g} radians in one step, {}",
                       length(s.velocity) * std::fabs(h), length(s.omega_body) * std::fabs(h),
                       under);
  return fmt::format("has a quaternion of squared length {:g} instead of 1, {}", dot4(s.q, s.q),
                     under);
}

/// A site on which the force is no number, or else the one that is nearest to another atom.
std::string GearQuatBlowup::where(int ibody, double **f) const
{
  int bad = -1;
  for (const auto &site : bodies.sites)
    if (site.body == ibody && !std::isfinite(length(f[site.atom]))) bad = site.atom;
  const Meeting met = nearest(ibody, bad);
  if (met.other < 0)
    return bad < 0 ? std::string()
                   : fmt::format("; the force on its atom {} is no number", atom->tag[bad]);
  return fmt::format("; its atom {} is {:g} away from atom {}{}", atom->tag[met.site],
                     std::sqrt(met.distance2), atom->tag[met.other],
                     bad < 0 ? "" : ", and the force on it is no number");
}

/// Of the sites here, or of the one asked for, the nearest to an atom that is not of this body.
GearQuatBlowup::Meeting GearQuatBlowup::nearest(int ibody, int only) const
{
  Meeting found = {-1, -1, NONE};
  for (const auto &site : bodies.sites) {
    if (site.body != ibody || (only >= 0 && site.atom != only)) continue;
    const double *x = atom->x[site.atom];
    for (int j = 0; j < atom->nlocal + atom->nghost; ++j) {
      if (bodies.id_of(j) == bodies.body[ibody].id) continue;
      const double *y = atom->x[j], d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
      if (dot3(d, d) < found.distance2) found = {site.atom, j, dot3(d, d)};
    }
  }
  return found;
}
