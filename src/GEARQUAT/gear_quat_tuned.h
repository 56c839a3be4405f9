/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Tuned coefficients of the corrector.

   Gear's coefficients put every spurious root of the corrector at zero.  The order does not require
   this: of the N coefficients the order determines one (first-order equation, c_0) or two
   (second-order, c_0 and c_1), and one is 1 by definition.  The other coefficients, the tail, are
   free.  The table below has tails optimized for rigid bodies, as decimals; the coefficients that
   the order determines are computed from them.

   Five values have a second set, for quaternions of any length (gear_quat_any_norm.h), where steps
   are long and the energy drift is important.  With c = (0, 17/24, 1, 7/12, 7/24) the method is
   symmetric in time and has no drift, but noise does not decay.  The set of the table has spurious
   roots of modulus 0.98 and the angle and c_0 of the least drift in liquids (doc/coefficients.md).

   Order conditions.  Let the right-hand side be a given function of time and the solution a
   polynomial of degree N, y_N = h^N/N! y^(N) = 1 for all times.  The rows then deviate from the
   exact rows, y_j = exact + e_j, by an e_j that is constant above row q - 1 (q: the order of the
   equation), with a constant residual r:

     row N-1           c_(N-1) r = N
     rows N-2 ... q    sum_(k>j) binom(k, j) e_k = binom(N, j) - c_j r,   e_q = 0
     row q-1           its deviation does not grow if
                       c_(q-1) r = binom(N, q-1) - sum_(k>=q) binom(k, q-1) e_k             (1)

   For q = 1 this gives order N.  For q = 2 it gives order N - 1, and a polynomial of one degree more
   determines c_0.  With y_(N+1) = 1, y_N = (N + 1) n after n steps, deviations and residual are (N
   + 1) e_j n + b_j and (N + 1) r n + s:

     row N-1           c_(N-1) s = binom(N+1, N-1) + (N + 1) e_(N-1)
     rows N-2 ... 2    sum_(k>j) binom(k, j) b_k = binom(N+1, j) - c_j s + (N + 1) e_j,   b_2 = 0
     row 1             deviates by g = sum_(k>=2) k b_k - (N + 1) + c_1 s in a step

   and the predicted position, at which forces are evaluated, has the correct second derivative if

     c_0 r = 1 - sum_(k>=2) e_k - g/(N + 1)                                                 (2)

   Gear's c_0 and c_1 are the solutions for Gear's tails (tests/unit/test_tuned.cpp). */

#ifndef GEAR_QUAT_TUNED_H
#define GEAR_QUAT_TUNED_H

#include "gear_quat_history.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// Columns driven by forces: momenta and angular velocities, in the second formulation positions
/// and quaternions.  Columns that integrate others: positions and quaternions of formulation first.
enum class Columns { DRIVEN, INTEGRATED };

// ---------------------------------------------------------------------------------------------
// order conditions
// ---------------------------------------------------------------------------------------------

/// Steady deviations of the rows, for coefficients of an equation of order q = 1 or 2.
class SteadyDeviations {
 public:
  /// c: N coefficients, used from row q on.
  SteadyDeviations(int q, const std::vector<long double> &c) :
      q(q), n((int) c.size()), residual(n / c[n - 1]), e(descend(c, n, residual, {}))
  {
  }

  /// c_(q-1) by Eq. (1).
  long double consistent() const { return (binomial(n, q - 1) - sum(q - 1, e)) / residual; }

  /// Deviation of row q - 1 per step for y_(N+1) = 1; c: with c_(q-1).
  long double growth(const std::vector<long double> &c) const
  {
    const long double s = (binomial(n + 1, n - 1) + (n + 1) * e[n - 1]) / c[n - 1];
    return sum(q - 1, descend(c, n + 1, s, e)) - binomial(n + 1, q - 1) + c[q - 1] * s;
  }

  /// c_0 of a second-order equation by Eq. (2); c: with c_1.
  long double position_c0(const std::vector<long double> &c) const
  {
    return (1.0L - sum(0, e) - growth(c) / (n + 1)) / residual;
  }

  /// The change of row 0 of a second-order equation in a step, minus the exact change from the same
  /// initial values, relative to the residual.
  long double local_error(long double c0) const { return c0 + (sum(0, e) - 1.0L) / residual; }

  /// The integral over a step of the error of row 0 as predicted, about the middle of its ends,
  /// relative to the residual.  c0: of the correction at the end.
  long double moment(long double c0) const
  {
    long double integral = -1.0L / (n + 1);
    for (int j = 1; j < n; ++j) integral += e[j] / (j + 1);
    return integral / residual - 0.5L * local_error(c0);
  }

 private:
  using Rows = std::vector<long double>;
  int q, n;
  long double residual;
  Rows e;

  static long double binomial(int m, int k)
  {
    long double b = 1.0L;
    for (int i = 1; i <= k; ++i) b = b * (m - k + i) / i;
    return b;
  }

  /// Sum over k > j of binom(k, j) d_k.
  long double sum(int j, const Rows &d) const
  {
    long double total = 0.0L;
    for (int k = n - 1; k > j; --k) total += binomial(k, j) * d[k];
    return total;
  }

  /// Rows N-2 ... q for an exact solution of this degree; slope: e if deviations grow, or empty.
  Rows descend(const Rows &c, int degree, long double residual, const Rows &slope) const
  {
    Rows d(n, 0.0L);
    for (int j = n - 2; j >= q; --j) {
      const long double growth = slope.empty() ? 0.0L : degree * slope[j];
      d[j + 1] = (binomial(degree, j) - c[j] * residual + growth - sum(j, d)) / (j + 1);
    }
    return d;
  }
};

// ---------------------------------------------------------------------------------------------
// the table
// ---------------------------------------------------------------------------------------------

/// The free coefficients of a kind of columns.
struct TunedSet {
  static constexpr long double SOLVED = std::numeric_limits<long double>::quiet_NaN();

  Formulation formulation;
  Columns columns;                  ///< with these coefficients
  std::vector<long double> tail;    ///< c_2 ... c_(N-1) of formulation first, c_3 ... of second
  long double c0 = SOLVED;          ///< if it is not determined by the order
  bool any_norm = false;            ///< replaces another set if quaternions have any length

  bool solves_c0() const { return std::isnan(c0); }
  int values() const { return (int) tail.size() + (formulation == Formulation::FIRST ? 2 : 3); }

  /// All N.
  std::vector<long double> coefficients() const
  {
    const int q = formulation == Formulation::FIRST ? 1 : 2;
    std::vector<long double> c(q, 0.0L);
    c.push_back(1.0L);
    c.insert(c.end(), tail.begin(), tail.end());
    const SteadyDeviations deviations(q, c);
    c[q - 1] = deviations.consistent();
    if (q == 2) c[0] = deviations.position_c0(c);
    if (!solves_c0()) c[0] = c0;
    return c;
  }
};

inline const std::vector<TunedSet> &tuned_sets()
{
  constexpr Formulation FIRST = Formulation::FIRST, SECOND = Formulation::SECOND;
  constexpr Columns DRIVEN = Columns::DRIVEN, INTEGRATED = Columns::INTEGRATED;
  static const std::vector<TunedSet> sets = {
      {FIRST, DRIVEN, {0.175562493L}},
      {FIRST, INTEGRATED, {0.977598317L}},
      {FIRST, DRIVEN, {0.475599068L, 0.099555627L}},
      {FIRST, INTEGRATED, {0.960138757L, 0.432398391L}},
      {FIRST, DRIVEN, {0.461180408L, 0.133967791L, 0.01451827L}},
      {FIRST, INTEGRATED, {1.066004274L, 0.493718278L, 0.094613588L}},
      {FIRST, DRIVEN, {0.662758587L, 0.239419882L, 0.036198456L, 0.002970522L}},
      {FIRST, INTEGRATED, {1.033527205L, 0.493119035L, 0.118863673L, 0.017378297L}},
      {FIRST, DRIVEN, {0.655569173L, 0.254798431L, 0.042241659L, 0.004677039L, 0.000243648L}},
      {FIRST, INTEGRATED, {1.135923673L, 0.617195984L, 0.176356772L, 0.026360534L, 0.001957985L}},
      {FIRST,
       DRIVEN,
       {0.853952763L, 0.413197347L, 0.09594372L, 0.014247214L, 0.000970305L, 0.000044538L}},
      {FIRST,
       INTEGRATED,
       {1.168083887L, 0.680906246L, 0.213715031L, 0.042664217L, 0.003990708L, 0.000315392L}},
      {SECOND, DRIVEN, {0.518283853L}},
      {SECOND, DRIVEN, {0.612194931L, 0.286697465L}, 0.005707609L},
      {SECOND, DRIVEN, {0.605389137L, 0.296087276L}, 0.002163953L, true},
      {SECOND, DRIVEN, {0.68109688L, 0.214659532L, 0.054497661L}},
      {SECOND, DRIVEN, {0.764735219L, 0.414859115L, 0.077867825L, 0.021600975L}, 0.027779193L},
      {SECOND, DRIVEN, {0.767583958L, 0.315047149L, 0.095050269L, 0.010917458L, 0.001670165L}},
      {SECOND,
       DRIVEN,
       {0.829069459L, 0.46120882L, 0.12299792L, 0.033749712L, 0.00278766L, 0.000443347L},
       0.029954015L},
      {SECOND,
       DRIVEN,
       {0.818972309L, 0.393430724L, 0.123551592L, 0.022405726L, 0.00342492L, 0.000208526L,
        0.000017462L}},
      {SECOND,
       DRIVEN,
       {0.830377065L, 0.45130325L, 0.132203956L, 0.034419801L, 0.00409732L, 0.000602561L,
        0.00002542L, 0.000002296L},
       0.050487162L},
      {SECOND,
       DRIVEN,
       {0.842921325L, 0.426882413L, 0.141189304L, 0.030361428L, 0.004952253L, 0.000496751L,
        0.000043465L, 0.000001784L, 0.000000083L}},
  };
  return sets;
}

/// The tuned set, null if there is none.  any_norm: the set for quaternions of any length, if there
/// is one; formulation momentum has this set, too.
inline const TunedSet *tuned_set(Formulation formulation, int values, Columns columns,
                                 bool any_norm = false)
{
  const TunedSet *found = nullptr;
  any_norm |= formulation == Formulation::MOMENTUM;
  if (any_norm) formulation = Formulation::SECOND;
  for (const TunedSet &set : tuned_sets())
    if (set.formulation == formulation && set.values() == values && set.columns == columns &&
        (any_norm || !set.any_norm) && (!found || set.any_norm))
      found = &set;
  return found;
}

inline const TunedSet *tuned_set(const Scheme &scheme, Columns columns)
{
  return tuned_set(scheme.formulation, scheme.values(), columns, scheme.any_norm());
}

/// Three values have the coefficients of velocity Verlet, c = (0, 1, 1).  Where velocities are read
/// with the forces, they are then those of half a step before.
constexpr int VERLET = 3;
inline bool is_verlet(const Scheme &scheme)
{
  return !scheme.first() && scheme.tuned && scheme.values() == VERLET;
}

/// True if there are tuned coefficients for this number of values.
inline bool has_tuned(Formulation formulation, int values)
{
  return tuned_set(formulation, values, Columns::DRIVEN) != nullptr;
}

/// The numbers of values with tuned coefficients, in ascending order.
inline std::vector<int> tuned_values(Formulation formulation)
{
  std::vector<int> values;
  for (int n = 0; n <= MAX_VALUES; ++n)
    if (has_tuned(formulation, n)) values.push_back(n);
  return values;
}

/// For tuned sets of the second formulation with a separate c_0, positions have an error of h^(N-1)
/// that is bounded in time.
inline int Scheme::order() const
{
  if (!tuned) return (velocity_c0 ? values() - 1 : values()) | 1;
  const TunedSet *set = tuned_set(*this, Columns::DRIVEN);
  return set && !set->solves_c0() ? values() - 1 : values();
}

// ---------------------------------------------------------------------------------------------
// coefficients for the integrator
// ---------------------------------------------------------------------------------------------

/// Coefficients of all columns, and the weight of residuals in the local error.
struct CorrectorCoefficients {
  using Array = std::array<double, MAX_VALUES>;

  Array driven = {}, integrated = {};    ///< see Columns; second: only driven
  double weight2;                        ///< of the residuals of positions and quaternions, squared
  double moment = 0.0;                   ///< see SteadyDeviations; of second-order equations

  /// Throws std::domain_error if the scheme is tuned and has a number of values without a tuned
  /// set.
  explicit CorrectorCoefficients(const Scheme &scheme)
  {
    double weight = fill(scheme, Columns::DRIVEN, driven);
    if (scheme.first()) weight = fill(scheme, Columns::INTEGRATED, integrated);
    weight2 = weight * weight;
    if (scheme.first() || is_verlet(scheme)) return;
    const std::vector<long double> exact(driven.begin(), driven.begin() + scheme.values());
    moment = double(SteadyDeviations(2, exact).moment(exact[0]));
  }

 private:
  /// Returns the weight of the residual in the local error.
  static double fill(const Scheme &scheme, Columns columns, Array &c)
  {
    if (!is_verlet(scheme))
      return scheme.tuned ? fill_tuned(scheme, columns, c) : fill_gear(scheme, c);
    c[1] = c[2] = 1.0;
    return 1.0 / 3.0;
  }

  static double fill_gear(const Scheme &scheme, Array &c)
  {
    const int n = scheme.values();
    const Fractions exact = scheme.first() ? first_order_coefficients(n)
                                           : second_order_coefficients(n, scheme.velocity_c0);
    for (int j = 0; j < n; ++j) c[j] = exact[j].value();
    return (scheme.first() ? first_order_error_weight(n) : second_order_error_weight(n)).value();
  }

  /// First-order equation: h^N y^(N) has the same weight as with Gear's coefficients, or a larger
  /// weight if the error, of one order higher, is larger than Gear's.
  static double fill_tuned(const Scheme &scheme, Columns columns, Array &c)
  {
    const int n = scheme.values();
    const TunedSet *set = tuned_set(scheme, columns);
    if (!set)
      throw std::domain_error("there are no tuned coefficients for " + std::to_string(n) +
                              " values");
    const std::vector<long double> exact = set->coefficients();
    for (int j = 0; j < n; ++j) c[j] = double(exact[j]);
    if (!scheme.first()) return double(std::fabs(SteadyDeviations(2, exact).local_error(exact[0])));
    const double gear = adams_moulton(n).value() * std::tgamma(n + 2);
    const double larger = double(std::fabs(SteadyDeviations(1, exact).growth(exact))) / gear;
    return first_order_error_weight(n).value() * std::tgamma(n) * c[n - 1] * std::max(1.0, larger);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
