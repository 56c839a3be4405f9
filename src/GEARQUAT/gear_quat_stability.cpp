/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_stability.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

double GearQuat::fastest_oscillation(const Scheme &scheme)
{
  constexpr int FEWEST = 3;    // values of the first column
  constexpr double FASTEST[][MAX_VALUES - FEWEST + 1] = {
      {2.0, 1.40, 0.36, 0.42, 0.62, 0.46, 0.32, 0.24, 0.16, 0.12},     // Gear's
      {0.0, 0.24, 0.32, 0.44, 0.60, 0.44, 0.32, 0.22, 0.16, 0.12},     // with c0 of velocities
      {1.00, 0.92, 0.28, 0.34, 0.24, 0.12},                            // first formulation
      {0.72, 0.42, 0.22, 0.10, 0.04, 0.02},                            // with predicted momentum
      {2.00, 1.04, 0.96, 0.54, 0.70, 0.66, 0.60, 0.56, 0.60, 0.50},    // tuned
  };
  const int row = scheme.tuned()
      ? 4
      : 2 * scheme.first() + (scheme.first() ? scheme.predicted_momentum : scheme.velocity_c0);
  return FASTEST[row][scheme.values() - FEWEST];
}

/* ----------------------------------------------------------------------
   the fast edge
------------------------------------------------------------------------- */

void MotionSums::add(const RigidBody &body, const BodyState &state, const TaylorSeries &series,
                     double step)
{
  constexpr int LEVELS = 4;    // derivatives, from the second on
  const int known = std::min(series.terms - 2, LEVELS);
  if (known <= 2) return;
  const double *inertia = body.inertia;
  const int freedoms = std::max(1, body.rotational_freedoms());
  const double mean = (inertia[0] + inertia[1] + inertia[2]) / freedoms;
  double axes[9], per_inertia[3], size[LEVELS] = {};    // squares of step^k y^(k)
  rotation_matrix(state.q, dot4(state.q, state.q), axes);
  inverse_moments(body.inertia, per_inertia);
  double factorial = 1.0;
  for (int k = 0; k < known; ++k) {
    factorial *= k + 2;
    const double *x = series.c[k + 2], *rate = series.momentum[k + 1];
    double along[3], all = body.mass * dot3(x, x);
    to_body(axes, rate, along);
    for (int i = 0; i < 3; ++i) along[i] *= per_inertia[i] / (k + 2);
    all += mean * dot3(along, along);
    size[k] = factorial * factorial * all;
  }
  const double per_step4 = 1.0 / (step * step * step * step);    // in units of y''
  sums[0] += per_step4 * per_step4 * (size[2] + size[3]);
  sums[1] += per_step4 * (size[0] + size[1]);
  sums[2] += body.mass * dot3(state.velocity, state.velocity);
  for (int k = 0; k < 3; ++k) sums[2] += inertia[k] * state.omega_body[k] * state.omega_body[k];
}

double MotionSums::fast_edge(double h) const
{
  // a smaller change of velocities in a step is from rounding: the forces between atoms of a body
  // cancel only up to rounding
  constexpr double LEAST_CHANGE = 1.0e-10;
  const bool accelerates = sums[1] > 0.0 && h * h * sums[1] > LEAST_CHANGE * LEAST_CHANGE * sums[2];
  return accelerates ? std::fabs(h) * std::pow(sums[0] / sums[1], 0.25) : 0.0;
}

/* ----------------------------------------------------------------------
   the number of values
------------------------------------------------------------------------- */

bool GearQuat::suits_noise(const Scheme &scheme, Noise noise)
{
  if (noise == Noise::NONE || scheme.is_verlet()) return true;
  if (noise == Noise::RANDOM && !scheme.first()) return false;
  return !scheme.tuned() && scheme.values() <= (scheme.first() ? 3 : 4);
}

Choice::Choice(const Scheme &given, double edge, Noise noise, bool stated, int present) :
    scheme(given), reason(FORMULATION)
{
  if (given.tuned()) {
    const double band = present == 9 ? BAND : present == 5 ? 1.0 / BAND : 1.0;
    scheme.rows = edge <= band * EDGE_OF_NINE ? 9 : 5;
    reason = MOTION;
  }
  if (suits_noise(scheme, noise)) return;
  reason = NOISE;
  if (noise == Noise::RANDOM && !given.first()) {
    scheme.rows = VERLET;
  } else {
    if (!stated) scheme.method = Method::GEAR;
    scheme.rows = given.first() ? FIRST_FEWEST : SECOND_FEWEST;
  }
}
