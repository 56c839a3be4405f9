/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Gear's coefficients for any number of values follow from the polynomial P_n(s) = (1 + s)(1 + s/2)...
   (1 + s/n) and the weights gamma_k of Adams and Moulton, 1/2 1/12 1/24 19/720 3/160 ...  (their
   magnitudes).
   Source: C. W. Gear, "Numerical Initial Value Problems in Ordinary Differential Equations" (1971);
   for 5 and 6 values Pratt & Bin Mohamad Zaini, Tables 1 and 2 (beta_2 = 1: the printed 4 is a
   misprint).

Tuned coefficients, for formulation momentum: Gear's coefficients put every spurious root of the corrector at zero.  The order does not require
   this: of the N coefficients the order determines c_0 and c_1, and c_2 is 1 by definition.  The
   other coefficients, the tail, are free.  The table below has tails optimized for rigid bodies, as
   decimals; c_1 and, where it is not given, c_0 are computed from them.

   Five values are for long steps, at which the energy drift is important.  With c = (0, 17/24, 1,
   7/12, 7/24) the method is symmetric in time and has no drift, but noise does not decay.  The set
   of the table has spurious roots of modulus 0.98 and the angle and c_0 of the least drift in
   liquids (doc/theory.md).

   Order conditions.  Let the right-hand side of a second-order equation be a given function of time
   and the solution a polynomial of degree N, y_N = h^N/N! y^(N) = 1 for all times.  The rows then
   deviate from the exact rows, y_j = exact + e_j, by an e_j that is constant above row 1, with a
   constant residual r:

     row N-1           c_(N-1) r = N
     rows N-2 ... 2    sum_(k>j) binom(k, j) e_k = binom(N, j) - c_j r,   e_2 = 0
     row 1             its deviation does not grow if
                       c_1 r = N - sum_(k>=2) k e_k                                          (1)

   This gives order N - 1, and a polynomial of one degree more determines c_0.  With y_(N+1) = 1, y_N
   = (N + 1) n after n steps, deviations and residual are (N + 1) e_j n + b_j and (N + 1) r n + s:

     row N-1           c_(N-1) s = binom(N+1, N-1) + (N + 1) e_(N-1)
     rows N-2 ... 2    sum_(k>j) binom(k, j) b_k = binom(N+1, j) - c_j s + (N + 1) e_j,   b_2 = 0
     row 1             deviates by g = sum_(k>=2) k b_k - (N + 1) + c_1 s in a step

   and the predicted position, at which forces are evaluated, has the correct second derivative if

     c_0 r = 1 - sum_(k>=2) e_k - g/(N + 1)                                                 (2)

   Gear's c_0 and c_1 are the solutions for Gear's tails (tests/unit/test_tuned.cpp). */

#include "gear_quat_coefficients.h"

#include <stdexcept>
#include <string>

using namespace LAMMPS_NS;
using namespace GearQuat;

using Coefficients = std::vector<long double>;

/* ----------------------------------------------------------------------
   Gear's coefficients
------------------------------------------------------------------------- */

long double GearQuat::adams_moulton(int k)
{
  Coefficients signed_weight = {1.0L};
  for (int m = 1; m <= k; ++m) {
    long double sum = 0.0L;
    for (int i = 0; i < m; ++i) sum -= signed_weight[i] / (m + 1 - i);
    signed_weight.push_back(sum);
  }
  return -signed_weight[k];
}

Coefficients GearQuat::first_order_coefficients(int values)
{
  Coefficients p = {1.0L};    // P_(N-2)
  for (int i = 1; i <= values - 2; ++i) {
    p.push_back(0.0L);
    for (int j = i; j > 0; --j) p[j] += p[j - 1] / i;
  }
  Coefficients c = {1.0L};
  for (int k = 1; k < values; ++k) c[0] -= adams_moulton(k);
  for (int j = 0; j < values - 1; ++j) c.push_back(p[j] / (j + 1));
  return c;
}

Coefficients GearQuat::second_order_coefficients(int values, bool velocity_c0)
{
  const Coefficients a = first_order_coefficients(values - 1);
  Coefficients c = {2 * (velocity_c0 ? values - 1 : values - 2) * adams_moulton(values - 1)};
  for (int j = 0; j < values - 1; ++j) c.push_back(2 * a[j] / (j + 1));
  return c;
}

/* ----------------------------------------------------------------------
   order conditions
------------------------------------------------------------------------- */

namespace {

/// Steady deviations of the rows of a second-order equation.
class SteadyDeviations {
 public:
  /// c: N coefficients, used from row 2 on.
  explicit SteadyDeviations(const Coefficients &c) :
      n((int) c.size()), residual(n / c[n - 1]), e(descend(c, n, residual, {}))
  {
  }

  /// c_1 by Eq. (1).
  long double consistent() const { return (n - sum(1, e)) / residual; }

  /// Deviation of row 1 per step for y_(N+1) = 1; c: with c_1.
  long double growth(const Coefficients &c) const
  {
    const long double s = (binomial(n + 1, n - 1) + (n + 1) * e[n - 1]) / c[n - 1];
    return sum(1, descend(c, n + 1, s, e)) - (n + 1) + c[1] * s;
  }

  /// c_0 by Eq. (2); c: with c_1.
  long double position_c0(const Coefficients &c) const
  {
    return (1.0L - sum(0, e) - growth(c) / (n + 1)) / residual;
  }

  /// The change of row 0 in a step, minus the exact change from the same
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
  int n;
  long double residual;
  Coefficients e;

  static long double binomial(int m, int k)
  {
    long double b = 1.0L;
    for (int i = 1; i <= k; ++i) b = b * (m - k + i) / i;
    return b;
  }

  /// Sum over k > j of binom(k, j) d_k.
  long double sum(int j, const Coefficients &d) const
  {
    long double total = 0.0L;
    for (int k = n - 1; k > j; --k) total += binomial(k, j) * d[k];
    return total;
  }

  /// Coefficients N-2 ... 2 for an exact solution of this degree; slope: e if deviations grow, or empty.
  Coefficients descend(const Coefficients &c, int degree, long double residual,
                       const Coefficients &slope) const
  {
    Coefficients d(n, 0.0L);
    for (int j = n - 2; j >= 2; --j) {
      const long double growth = slope.empty() ? 0.0L : degree * slope[j];
      d[j + 1] = (binomial(degree, j) - c[j] * residual + growth - sum(j, d)) / (j + 1);
    }
    return d;
  }
};

}    // namespace

/* ----------------------------------------------------------------------
   tuned coefficients
------------------------------------------------------------------------- */

Coefficients TunedSet::coefficients() const
{
  Coefficients c = {0.0L, 0.0L, 1.0L};
  c.insert(c.end(), tail.begin(), tail.end());
  const SteadyDeviations deviations(c);
  c[1] = deviations.consistent();
  c[0] = solves_c0() ? deviations.position_c0(c) : c0;
  return c;
}

const std::vector<TunedSet> &GearQuat::tuned_sets()
{
  static const std::vector<TunedSet> sets = {
      {{0.518283853L}},
      {{0.605389137L, 0.296087276L}, 0.002163953L},
      {{0.68109688L, 0.214659532L, 0.054497661L}},
      {{0.764735219L, 0.414859115L, 0.077867825L, 0.021600975L}, 0.027779193L},
      {{0.767583958L, 0.315047149L, 0.095050269L, 0.010917458L, 0.001670165L}},
      {{0.829069459L, 0.46120882L, 0.12299792L, 0.033749712L, 0.00278766L, 0.000443347L},
       0.029954015L},
      {{0.818972309L, 0.393430724L, 0.123551592L, 0.022405726L, 0.00342492L, 0.000208526L,
        0.000017462L}},
      {{0.830377065L, 0.45130325L, 0.132203956L, 0.034419801L, 0.00409732L, 0.000602561L,
        0.00002542L, 0.000002296L},
       0.050487162L},
      {{0.842921325L, 0.426882413L, 0.141189304L, 0.030361428L, 0.004952253L, 0.000496751L,
        0.000043465L, 0.000001784L, 0.000000083L}},
  };
  return sets;
}

const TunedSet *GearQuat::tuned_set(int values)
{
  for (const TunedSet &set : tuned_sets())
    if (set.values() == values) return &set;
  return nullptr;
}

/// With a separate c_0, positions have an error of h^(N-1) that is bounded in time.
int Scheme::order() const
{
  if (!tuned()) return (velocity_c0 ? values() - 1 : values()) | 1;
  const TunedSet *set = tuned_set(values());
  return set && !set->solves_c0() ? values() - 1 : values();
}

/* ----------------------------------------------------------------------
   coefficients for the integrator
------------------------------------------------------------------------- */

CorrectorCoefficients::CorrectorCoefficients(const Scheme &scheme)
{
  const int n = scheme.values();
  Coefficients exact;
  long double weight;    // of the residual in the local error
  if (scheme.is_verlet()) {
    exact = {0.0L, 1.0L, 1.0L};
    weight = 1.0L / 3.0L;
  } else if (scheme.tuned()) {
    const TunedSet *set = scheme.momentum() ? tuned_set(n) : nullptr;
    if (!set)
      throw std::domain_error(std::string("formulation ") + word_of(scheme.formulation) +
                              " has no tuned coefficients for " + std::to_string(n) + " values");
    exact = set->coefficients();
    weight = std::fabs(SteadyDeviations(exact).local_error(exact[0]));
  } else if (scheme.first()) {    // the corrector of the next lower order: c_0(N - 1) - c_0(N)
    exact = first_order_coefficients(n);
    weight = adams_moulton(n - 1);
  } else {
    exact = second_order_coefficients(n, scheme.velocity_c0);
    weight = 2.0L * adams_moulton(n - 1);
  }
  for (int j = 0; j < n; ++j) c[j] = double(exact[j]);
  weight2 = double(weight) * double(weight);
  if (!scheme.momentum() || scheme.is_verlet()) return;
  const Coefficients rounded(c.begin(), c.begin() + n);
  moment = double(SteadyDeviations(rounded).moment(rounded[0]));
}
