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

   Tuned coefficients, for formulation momentum: Gear's coefficients put every spurious root of the
   corrector at zero.  The order does not require this: of the N coefficients the order determines c_0 and c_1, and c_2 is 1 by definition.  The
   other coefficients, the tail, are free.  The table below has tails optimized for rigid bodies, as
   decimals, with the c_0 and c_1 that follow from them (tests/unit/test_tuned.cpp); c_0 is free, too,
   where the number of values is odd, and the order is then lower by one.

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
                       c_1 r = N - sum_(k>=2) k e_k

   Gear's c_0 and c_1 are the solutions for Gear's tails. */

#include "gear_quat_history.h"

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
      n((int) c.size()), residual(n / c[n - 1]), e(n, 0.0L)
  {
    for (int j = n - 2; j >= 2; --j)
      e[j + 1] = (binomial(n, j) - c[j] * residual - sum(j)) / (j + 1);
  }

  /// The change of row 0 in a step, minus the exact change from the same
  /// initial values, relative to the residual.
  long double local_error(long double c0) const { return c0 + (sum(0) - 1.0L) / residual; }

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

  /// Sum over k > j of binom(k, j) e_k.
  long double sum(int j) const
  {
    long double total = 0.0L;
    for (int k = n - 1; k > j; --k) total += binomial(k, j) * e[k];
    return total;
  }
};

}    // namespace

/* ----------------------------------------------------------------------
   tuned coefficients
------------------------------------------------------------------------- */

Coefficients GearQuat::tuned_coefficients(int values)
{
  static const std::vector<Coefficients> SETS = {
      {0.166666666666666667L, 0.7408580735L, 1.0L, 0.518283853L},
      {0.002163953L, 0.6973054315L, 1.0L, 0.605389137L, 0.296087276L},
      {0.145200713466666667L, 0.6685345035L, 1.0L, 0.68109688L, 0.214659532L, 0.054497661L},
      {0.027779193L, 0.630610361333333333L, 1.0L, 0.764735219L, 0.414859115L, 0.077867825L,
       0.021600975L},
      {0.136461649147619048L, 0.631771371666666667L, 1.0L, 0.767583958L, 0.315047149L, 0.095050269L,
       0.010917458L, 0.001670165L},
      {0.029954015L, 0.605500313833333333L, 1.0L, 0.829069459L, 0.46120882L, 0.12299792L,
       0.033749712L, 0.00278766L, 0.000443347L},
      {0.129942286533333333L, 0.6105401961L, 1.0L, 0.818972309L, 0.393430724L, 0.123551592L,
       0.022405726L, 0.00342492L, 0.000208526L, 0.000017462L},
      {0.050487162L, 0.6061701995L, 1.0L, 0.830377065L, 0.45130325L, 0.132203956L, 0.034419801L,
       0.00409732L, 0.000602561L, 0.00002542L, 0.000002296L},
      {0.127478188877922078L, 0.601258483L, 1.0L, 0.842921325L, 0.426882413L, 0.141189304L,
       0.030361428L, 0.004952253L, 0.000496751L, 0.000043465L, 0.000001784L, 0.000000083L},
  };
  const int n = values - SECOND_FEWEST;
  return n < 0 || n >= (int) SETS.size() ? Coefficients() : SETS[n];
}

/// With a free c_0, positions have an error of h^(N-1) that is bounded in time.
int Scheme::order() const
{
  if (!tuned() || is_verlet()) return (velocity_c0 ? values() - 1 : values()) | 1;
  return values() - values() % 2;
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
    if (scheme.momentum()) exact = tuned_coefficients(n);
    if (exact.empty())
      throw std::domain_error(std::string("formulation ") + word_of(scheme.formulation) +
                              " has no tuned coefficients for " + std::to_string(n) + " values");
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
