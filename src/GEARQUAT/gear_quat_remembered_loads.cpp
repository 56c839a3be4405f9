/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_remembered_loads.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

/// The product of (s - s_j)/(1 - s_j) over the times s_j of the latest loads, where s is the time
/// since the last load in units of h: 1 at the new load.
struct Nodal {
  using Array = std::array<double, MOST_LOADS + 4>;
  int terms = 1;
  Array c = {1.0};
  double scale = 1.0;    ///< product of 1 - s_j

  template <class Ages> Nodal(const Ages &ages, int count, double h)
  {
    for (int k = 0; k < count; ++k, ++terms) {
      const double back = ages[std::min(k, MOST_LOADS)] / std::fabs(h), way = 1.0 + back;
      for (int j = terms; j > 0; --j) c[j] = (c[j - 1] + back * c[j]) / way;
      c[0] *= back / way;
      scale *= way;
    }
  }

  /// The integral, weighted by a power of the time until the end of the step.
  double integral(int power, double from, double to) const
  {
    Array p = c;
    for (int k = 1; k <= power; ++k)
      for (int j = terms + k - 1; j > 0; --j) p[j] -= p[j - 1];
    double a = 0.0, b = 0.0;
    for (int j = terms + power - 1; j >= 0; --j) {
      a = a * from + p[j] / (j + 1);
      b = b * to + p[j] / (j + 1);
    }
    return b * to - a * from;
  }

  /// The coefficients about s.
  Array about(double s) const
  {
    Array p = c;
    for (int i = 0; i + 1 < terms; ++i)
      for (int j = terms - 2; j >= i; --j) p[j] += s * p[j + 1];
    return p;
  }
};

/// The displacement of the outermost part of a body in a row.
static double size_of(const RigidBody &body, double reach, const double *axes, const double *row)
{
  double turn[3];
  Integrator::turn_of(body, axes, row + Scheme::ANGULAR_MOMENTUM, turn);
  return std::max(length(row), reach * length(turn));
}

void RememberedLoads::begin(int loads, double interval)
{
  k = known = loads;
  compares = false;
  for (int j = 0; j <= MOST_LOADS; ++j) ages[j] = j * interval;
}

void RememberedLoads::prepare(double h)
{
  const int n = values();
  const Nodal all(ages, k, h), fewer(ages, k - 1, h), more(ages, k + 1, h);
  corrector = CorrectorCoefficients();
  corrector.c[0] = 2.0 * all.integral(1, 0.0, 1.0);
  corrector.c[1] = 2.0 * all.integral(0, 0.0, 1.0);
  corrector.weight2 = corrector.c[0] * corrector.c[0];
  corrector.moment = -all.integral(2, 0.0, 1.0);
  const auto next = fewer.about(1.0);    // the new load replaces the oldest one
  for (int j = 2; j < n; ++j) corrector.c[j] = 2.0 * next[j - 2] / (j * (j - 1));

  const double from_trial = n * (n - 1) * all.scale, from_dropped = (n + 1) * n * more.scale;
  to_trial = 2.0 / from_trial;
  of_fewer = (n - 1) * (n - 2) * fewer.scale * fewer.integral(0, 0.0, 1.0);
  of_more = k < known && compares ? from_trial * more.integral(0, 0.0, 1.0) : 0.0;
  int steps = 0;
  while (steps < std::min({LAG, (k - 2) / 2, known - 1}) &&
         ages[steps + 1] - ages[steps] < LONGER * std::fabs(h))
    ++steps;
  const double back = steps > 0 ? -ages[steps] / std::fabs(h) : 0.0;
  lag = {from_trial * all.integral(1, back, 0.0), from_trial * all.integral(0, back, 0.0)};
  lag_of_dropped = {from_dropped * more.integral(1, back, 0.0),
                    from_dropped * more.integral(0, back, 0.0)};
  if (k >= known) lag_of_dropped = {};
}

void RememberedLoads::change(bool more, double h, const std::function<void(const Act &)> &each)
{
  constexpr int WIDTH = Scheme::SECOND_WIDTH;
  const int n = values(), top = more ? n : n - 1;
  const Nodal nodes(ages, top - 2, h);
  double part[MOST_ROWS];    // of the top row in the rows below it
  for (int j = 2; j < top; ++j)
    part[j] = (more ? top : -top) * (top - 1) * nodes.scale * nodes.c[j - 2] / (j * (j - 1));
  each([&](double *rows) {
    double *behind = rows + n * WIDTH, *trial = trial_of(rows);
    const double *row = more ? behind : trial - WIDTH;
    if (more) {
      std::rotate(behind, trial, trial + WIDTH);
      std::fill_n(trial + WIDTH, MORE_ROWS * WIDTH, 0.0);
    } else {
      std::rotate(behind - WIDTH, behind, trial);    // the trial row becomes the dropped one
    }
    for (int j = 2; j < top; ++j)
      for (int i = 0; i < WIDTH; ++i) rows[j * WIDTH + i] += part[j] * row[i];
  });
  k += more ? 1 : -1;
  if (more) compares = false;
}

StepErrors RememberedLoads::finish(const StepControl &control, const Integrator &integrator,
                                   const RigidBody &body, double reach, const Load &load,
                                   const double *axes, const Row &before, double *rows,
                                   Last last) const
{
  constexpr int WIDTH = Scheme::SECOND_WIDTH;
  double *trial = trial_of(rows), *dropped = trial + WIDTH, *now = rows + 2 * WIDTH;
  const auto size = [&](const double *row) {
    return size_of(body, reach, axes, row);
  };
  Row residual, change, place, rate;
  for (int i = 0; i < WIDTH; ++i) {
    residual[i] = now[i] - before[i];
    change[i] = to_trial * residual[i] - trial[i];
    trial[i] += change[i];
    place[i] = lag[0] * change[i] - lag_of_dropped[0] * dropped[i];
    rate[i] = lag[1] * change[i] - lag_of_dropped[1] * dropped[i];
    dropped[i] = 0.0;
  }
  StepErrors found;
  found.fewer = std::fabs(of_fewer) * size(rows + (k + 1) * WIDTH);
  found.more = std::fabs(of_more) * size(change.data());
  const double most = size(residual.data());
  found.same = std::fabs(corrector.c[1]) * most;
  found.error = std::fabs(corrector.c[0]) * most;
  if (control.energy) {
    double turn[3];
    const BodyState state = integrator.body_state(body, rows);
    Integrator::turn_of(body, axes, &residual[Scheme::ANGULAR_MOMENTUM], turn);
    const double way = length(residual.data()), per_h = 1.0 / integrator.step();
    double rates = body.mass * length(state.velocity) * way;
    for (int i = 0; i < 3; ++i) rates += body.inertia[i] * std::fabs(state.omega_body[i] * turn[i]);
    found.error = std::fabs(corrector.c[0]) *
            (length(load.force) * way + length(load.torque_space) * length(turn)) +
        std::fabs(corrector.c[1] * per_h) * rates;
  }
  if (last == Last::INTEGRATED_AGAIN) integrator.displace(body, place.data(), rate.data(), rows);
  return found;
}

double StepControl::counted(const Integrator &integrator, const RigidBody &body, double reach,
                            const Load &load, const double *rows) const
{
  constexpr double LAST_DIGIT = std::numeric_limits<double>::epsilon();
  const double *x = rows + Scheme::POSITION;
  const BodyState state = integrator.body_state(body, rows);
  double rounding =
      LAST_DIGIT * (std::max({std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])}) + reach);
  if (energy)
    rounding = rounding * length(load.force) +
        2.0 * LAST_DIGIT *
            (translational_energy(body, state.velocity) +
             rotational_energy(body, state.omega_body));
  return eps / (eps + rounding);
}

void RememberedLoads::conclude(double h)
{
  for (int j = std::min(known, (int) ages.size() - 1); j > 0; --j)
    ages[j] = ages[j - 1] + std::fabs(h);
  known = std::min(known + 1, (int) ages.size());
  compares = true;
}

StepControl::Next StepControl::repeat(double error, double step, int loads, Growth &growing) const
{
  double ratio = SHRINK_FAILED;
  if (std::isfinite(error))
    ratio = std::clamp(SAFETY * allowed(error, loads), SHRINK_FAILED, SHRINK_AT_LEAST);
  const bool again = growing == Growth::FAILED;    // the loads are of little use
  growing = Growth::FAILED;
  return {std::copysign(std::max(shortest, ratio * std::fabs(step)), step),
          again && loads > 1 ? loads - 1 : loads};
}

StepControl::Next StepControl::next(const StepErrors &errors, double step,
                                    const RememberedLoads &remembered, Growth &growing,
                                    double farthest) const
{
  const int now = remembered.loads();
  const double ratio = SAFETY * allowed(errors.error, now);
  const bool starts = growing == Growth::START, goes_on = starts && ratio >= GROWS_FAST;
  const int loads = starts ? std::min(now + 1, MOST_LOADS) : remembered.better(errors);
  const double growth = growing == Growth::FAILED ? 1.0 : goes_on ? GROWTH_OF_START : GROWTH;
  growing = goes_on ? Growth::START : Growth::STEADY;
  const double before = std::fabs(step), clear = CLEAR_OF_LIMIT * farthest;
  double size = std::min(std::clamp(ratio, SHRINK, growth) * before,
                         before > farthest ? clear : std::max(clear, before));
  size = std::max(size, shortest);
  if (longest > 0.0) size = std::min(size, longest);
  return {std::copysign(size, step), loads};
}

double StepControl::first_step(double jerk, double speed, double mass) const
{
  if (!energy) return std::cbrt(6.0 * eps / jerk);
  const double rest = std::sqrt(2.0 * eps / mass);    // change of velocity with the energy eps,
                                                      // from rest
  return std::sqrt(2.0 / jerk * std::min(rest, speed > 0.0 ? eps / (mass * speed) : rest));
}

double GearQuat::even_step(double step, double way)
{
  constexpr double FAR = 10.0, ROUNDING = 1.0e-9;
  const double size = std::fabs(step), number = way / size;
  if (!(number < FAR)) return step;
  return std::copysign(way / std::max(1.0, std::ceil(number - ROUNDING)), step);
}
