/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The assembly of bodies: what no body can be, and what is probably a mistake. */

#include "gear_quat_assembly.h"

#include "gear_quat_images.h"
#include "gear_quat_ranks.h"

#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double ROUNDED = 1.0e-3;    // of a moment that was written with few digits
static constexpr double HALF = 0.5;          // of a period
static constexpr double NONE = std::numeric_limits<double>::infinity();

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
void Assembly::check_place(int part, const Momenta &momenta)
{
  const double longest = std::max({domain->xprd, domain->yprd, domain->zprd});
  const double far = made[part].body.extent + 0.5 * longest;
  if (!(momenta.from_center2 <= far * far)) faulty[APART] = made[part].body.id;
}

/// Of sums over masses all this holds by itself, up to rounding.
void Assembly::check_moments(const Made &one)
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

void Assembly::report_faults()
{
  const auto any = over_ranks(MPI_MAX, faulty, world);
  for (int fault = 0; fault < FAULTS; ++fault)
    if (any[fault] > 0) error->all(FLERR, FAULT_TEXTS[fault], any[fault]);
}

void Assembly::report_missing() const
{
  if (over_ranks(MPI_SUM, (int) found.size(), world) == (int) given.size()) return;
  for (const auto &stated : given) {
    const int here = std::count(found.begin(), found.end(), stated.first) > 0;
    if (!over_ranks(MPI_MAX, here, world))
      error->all(FLERR, "Fix gear/quat infile: no atom belongs to body {}", stated.first);
  }
}

/* ----------------------------------------------------------------------
   bodies of several clumps
------------------------------------------------------------------------- */

/// The sites along one direction, in intervals that are half a period long unless the body extends
/// over many periods: two sites in one interval have no gap of more than half a period between
/// them.
struct Assembly::Clumps {
  static constexpr int INTERVALS = 16;
  double lo[INTERVALS], hi[INTERVALS];

  void merge(const Clumps &other)
  {
    for (int n = 0; n < INTERVALS; ++n) {
      lo[n] = std::min(lo[n], other.lo[n]);
      hi[n] = std::max(hi[n], other.hi[n]);
    }
  }
  bool has_gap() const
  {
    for (int n = 1, last = 0; n < INTERVALS; ++n) {
      if (lo[n] > hi[n]) continue;    // no site
      if (lo[n] - hi[last] > HALF) return true;
      last = n;
    }
    return false;
  }
};

/// Two plates may be one body, but two halves of a molecule at opposite faces of the box are not.
void Assembly::warn_of_clumps() const
{
  tagint in_clumps = 0;
  for (int k = 0; k < 3; ++k) {
    if (!domain->periodicity[k]) continue;
    const auto span = [&](int part) {
      return extremes[part].hi_periods[k] - extremes[part].lo_periods[k];
    };
    int wide = 0;
    for (int part = 0; part < parts.number(); ++part) wide = wide || span(part) > HALF;
    if (!over_ranks(MPI_MAX, wide, world)) continue;

    Clumps none;
    std::fill_n(none.lo, Clumps::INTERVALS, NONE);
    std::fill_n(none.hi, Clumps::INTERVALS, -NONE);
    const std::vector<Clumps> clumps = over_sites(none, [&](Clumps &all, int part) {
      if (!(span(part) > HALF)) return;
      const double interval = std::max(HALF, span(part) / Clumps::INTERVALS);
      for (const int i : parts.atoms(part)) {
        double x[3], periods[3];
        unwrapped(part, i, x);
        to_periods(domain, x, periods);
        const double along = periods[k] - extremes[part].lo_periods[k];
        const int n = std::clamp((int) (along / interval), 0, Clumps::INTERVALS - 1);
        all.lo[n] = std::min(all.lo[n], along);
        all.hi[n] = std::max(all.hi[n], along);
      }
    });
    for (int part = 0; part < parts.number(); ++part)
      if (span(part) > HALF && clumps[part].has_gap()) in_clumps = parts.key(part);
  }
  const tagint any = over_ranks(MPI_MAX, in_clumps, world);
  if (any && comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: parts of body {} are more than half of a periodic box apart; if "
                   "they belong together, the image flags of its atoms do not: unwrap them in the "
                   "data file, or use set image before this fix",
                   any);
}
