/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_chain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

ChainDrive ChainDrive::through(int points, const double *x, const double *y)
{
  ChainDrive drive;
  drive.terms = points;
  double d[MOST];
  std::copy_n(y, points, d);
  for (int j = 1; j < points; ++j)
    for (int i = points - 1; i >= j; --i) d[i] = (d[i] - d[i - 1]) / (x[i] - x[i - j]);
  for (int i = points - 1; i >= 0; --i) {
    for (int j = points - 1; j > 0; --j) drive.c[j] = drive.c[j - 1] - drive.c[j] * x[i];
    drive.c[0] = d[i] - drive.c[0] * x[i];
  }
  return drive;
}

/// Taylor series of u_k = h xi_k and of S in the time s in units of h.  With the ratio kappa of
/// 2K to its target and rho = (h/tau)^2, the coefficients of powers of s obey
///   (j+1) u_1[j+1] = rho (kappa[j] - delta_j0) - (u_1 u_2)[j]
///   (j+1) u_2[j+1] = g (u_1 u_1)[j] - rho delta_j0 - (u_2 u_3)[j],   and so on,
/// where (a b)[j] is the sum of a[i] b[j-i].
class Chain::Series {
 public:
  Series(int length, const ChainTarget &target, double h) :
      length(length), g(target.freedoms), kt0(target.kt), kt_rate(h * target.kt_rate), h(h),
      unit(std::fabs(h / target.period)), rho(unit * unit)
  {
  }

  void begin(const Variables &y)
  {
    for (int k = 0; k < length; ++k) u[k][0] = h * y[k];
    u[length][0] = y[length];
  }
  Variables end() const
  {
    Variables y = {};
    for (int k = 0; k < length; ++k) y[k] = u[k][0] / h;
    y[length] = u[length][0];
    return y;
  }

  /// All terms about s.
  void expand(const ChainDrive &drive, double s)
  {
    kt = kt0 + kt_rate * s;
    expand_drive(drive, s);
    for (int j = 0; j < TERMS; ++j) {
      const double per = 1.0 / (j + 1);
      for (int k = 0; k < length; ++k) {
        double rate = k == 0 ? rho * kappa[j] : (k == 1 ? g : 1.0) * product(k - 1, k - 1, j);
        if (j == 0) rate -= rho;
        if (k + 1 < length) rate -= product(k, k + 1, j);
        u[k][j + 1] = per * rate;
      }
      u[length][j + 1] = per * rate_of_heat(j);
    }
  }

  /// The substep at which the last two terms are rounding: a power of two, so that all ranks
  /// agree.
  double longest_substep() const
  {
    int shorter = 0;
    for (int k = 0; k < length; ++k) {
      const double scale =
          std::max(std::fabs(u[k][0]), k == 0 ? unit / std::sqrt(std::max(1.0, g)) : unit);
      for (int j = TERMS - 1; j <= TERMS; ++j) {
        const double term = std::fabs(u[k][j]);
        if (!std::isfinite(term)) return 0.0;
        const int excess = term > 0.0 ? std::ilogb(term) + 1 - std::ilogb(ROUNDING * scale) : 0;
        shorter = std::max(shorter, (excess + j - 1) / j);
      }
    }
    return std::ldexp(1.0, -shorter);
  }

  void sum(double sigma)
  {
    for (int k = 0; k <= length; ++k) {
      double value = u[k][TERMS];
      for (int j = TERMS - 1; j >= 0; --j) value = value * sigma + u[k][j];
      u[k][0] = value;
    }
  }

 private:
  static constexpr int TERMS = 16;
  static constexpr double ROUNDING = 1.0e-14;

  int length;
  double g, kt0, kt_rate, h, unit, rho;
  double kt = 0.0;
  double u[MOST][TERMS + 1], kappa[TERMS + 1];

  double product(int a, int b, int j) const
  {
    double sum = 0.0;
    for (int i = 0; i <= j; ++i) sum += u[a][i] * u[b][j - i];
    return sum;
  }

  /// kappa = 2K/(g kT) about s
  void expand_drive(const ChainDrive &drive, double s)
  {
    std::array<double, ChainDrive::MOST> about = drive.c;
    for (int i = 0; i + 1 < drive.terms; ++i)
      for (int j = drive.terms - 2; j >= i; --j) about[j] += s * about[j + 1];
    for (int j = 0; j <= TERMS; ++j) {
      const double twice = j < drive.terms ? about[j] / g : 0.0;
      kappa[j] = (twice - (j > 0 ? kt_rate * kappa[j - 1] : 0.0)) / kt;
    }
  }

  /// Eq. T4
  double rate_of_heat(int j) const
  {
    double rate = kt * sum_of_frictions(j);
    if (kt_rate == 0.0) return rate;
    if (j > 0) rate += kt_rate * sum_of_frictions(j - 1);
    double squares = g * product(0, 0, j);
    for (int k = 1; k < length; ++k) squares += product(k, k, j);
    return rate - 0.5 * kt_rate / rho * squares;
  }
  double sum_of_frictions(int j) const
  {
    double sum = g * u[0][j];
    for (int k = 1; k < length; ++k) sum += u[k][j];
    return sum;
  }
};

Chain::Flow Chain::flow(const ChainTarget &target, const ChainDrive &drive, double h,
                        double until) const
{
  Flow found = {begun, 0};
  if (target.freedoms <= 0.0) return found;
  Series series(length, target, h);
  series.begin(begun);
  double s = 0.0;
  while (s != until) {
    if (++found.substeps == GIVEN_UP) return found;
    series.expand(drive, s);
    const double left = until - s;
    double sigma = std::min(series.longest_substep(), std::fabs(left));
    if (!(sigma > 0.0) || s + sigma == s) {
      found.substeps = GIVEN_UP;
      return found;
    }
    sigma = std::copysign(sigma, left);
    series.sum(sigma);
    s = sigma == left ? until : s + sigma;
  }
  found.y = series.end();
  return found;
}

bool Chain::is_stiff(const ChainTarget &target, double twice_kinetic, double h, int steps) const
{
  double largest = 0.0;
  for (int k = 0; k < length; ++k) largest = std::max(largest, std::fabs(begun[k]));
  const ChainDrive constant = ChainDrive::through(1, &h, &twice_kinetic);
  return largest * steps * std::fabs(h) > 0.5 || flow(target, constant, h, 1.0).substeps >= STIFF;
}

void Chain::begin_settled(const ChainTarget &target, double twice_kinetic, double h)
{
  if (known > 0 || begun != Variables() || !is_stiff(target, twice_kinetic, h, 1)) return;
  const ChainDrive constant = ChainDrive::through(1, &h, &twice_kinetic);
  const Flow found = flow(target, constant, std::fabs(h), SETTLING);
  if (found.substeps == GIVEN_UP) return;
  now = found.y;
  now[length] = -moving(target, now);
  begun = now;
}

bool Chain::advance(const ChainTarget &target, double twice_kinetic, double h, int values)
{
  known = earlier(h);
  latest = twice_kinetic;
  width = h;
  double x[MOST_SUMS + 1] = {1.0}, y[MOST_SUMS + 1] = {twice_kinetic};
  const int before = std::min(values - 1, known);
  for (int i = 0; i < before; ++i) {
    x[i + 1] = -ages[i] / h;
    y[i + 1] = sums[i];
  }
  const Flow found = flow(target, ChainDrive::through(before + 1, x, y), h, 1.0);
  now = found.y;
  return found.substeps < GIVEN_UP;
}

void Chain::conclude()
{
  begun = now;
  known = std::min(known + 1, MOST_SUMS);
  for (int i = known - 1; i > 0; --i) {
    sums[i] = sums[i - 1];
    ages[i] = ages[i - 1] + width;
  }
  sums[0] = latest;
  ages[0] = 0.0;
}

void Chain::seed(const double *twice, int pairs, double spacing, int count)
{
  const int order = 2 * pairs + 1;
  std::array<double, ChainDrive::MOST + MOST_SUMS> y;
  known = std::min(count, MOST_SUMS);
  for (int k = 0; k < pairs + std::max(known, pairs + 1); ++k) {
    y[k] = 0.0;
    if (k < order) y[k] = twice[pairs - k];
    double binomial = 1.0;
    for (int j = 1; k >= order && j <= order; ++j) {
      binomial *= -double(order - j + 1) / j;
      y[k] -= binomial * y[k - j];
    }
  }
  for (int k = 0; k < known; ++k) {
    sums[k] = y[pairs + k];
    ages[k] = k * spacing;
  }
}

void Chain::join(const ChainTarget &before, const ChainTarget &target)
{
  now[length] += moving(before, now) - moving(target, now);
  begun = now;
  known = 0;
}

double Chain::moving(const ChainTarget &target, const Variables &y) const
{
  double sum = target.freedoms * y[0] * y[0];
  for (int k = 1; k < length; ++k) sum += y[k] * y[k];
  return 0.5 * target.kt * target.period * target.period * sum;
}
