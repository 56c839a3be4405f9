/* gear_quat_startup.h: the initial rows of a history, compared with exact Taylor coefficients,
   under reversal of time, and for the shorter starts. */

#include "scenes.h"

using namespace Drive;
using Check::largest_difference;
using Check::slopes;
using Oracle::exact_rows;

namespace {

vector<double> rows_of(const Scheme &scheme, double h, double spacing,
                       Start start = Start::BOOTSTRAP, double time = 0.0)
{
  return started(scheme, TOP, top_state(time), swing, h, start, spacing);
}

/// The same with as many evaluations as the polynomial can use.
vector<double> settled_rows(const Scheme &scheme, double h)
{
  vector<double> rows(scheme.size());
  seed(scheme, TOP, settled_series(scheme.values(), TOP, top_state(0.0), swing, h), h, h,
       rows.data());
  return rows;
}

/// Momenta and angular velocities are derivatives themselves.
bool is_rate(const Scheme &scheme, int i)
{
  const int column = i % scheme.width();
  return scheme.first() && ((column >= 3 && column < 6) || column >= 10);
}

}    // namespace

TEST(Startup, EveryRowIsItsTaylorCoefficient)
{
  // row by row, relative to its size; at these spacings truncation and rounding are below 0.3 % in
  // the highest row
  for (const Scheme &scheme : every_scheme()) {
    const double h = scheme.first() ? 0.02 : scheme.values() > 10 ? 0.07 : 0.05;
    const vector<double> exact = exact_rows(scheme, h);
    const vector<double> rows = settled_rows(scheme, h);
    for (std::size_t i = 0; i < rows.size(); ++i)
      EXPECT_NEAR(rows[i], exact[i], 0.005 * std::fabs(exact[i])) << scheme;
  }
}

TEST(Startup, RowsHaveTheOrderTheMethodNeeds)
{
  // an error d of a row causes an error d in a position of the first formulation, and d/h in a
  // velocity of the second: the start must not limit the order
  for (const Scheme &scheme : every_scheme()) {
    const int n = scheme.values();
    const vector<double> h = n > 8 ? vector<double>{0.6, 0.45}
        : n > 6                    ? vector<double>{0.4, 0.3}
                                   : vector<double>{0.2, 0.1, 0.05};
    vector<double> error;
    for (double step : h)
      error.push_back(largest_difference(settled_rows(scheme, step), exact_rows(scheme, step)));
    EXPECT_GT(Check::smallest(slopes(h, error)), scheme.order() + (scheme.first() ? 0 : 1) - 0.2)
        << scheme;
  }
}

TEST(Startup, TwoTermsAreThePapersZeroStart)
{
  // known: the state and its rates; with forces one more derivative of everything, and no further
  // one
  for (const Scheme &scheme : every_scheme())
    for (int terms : {2, 3}) {
      const vector<double> exact = exact_rows(scheme, 0.1);
      const Start start = terms == 2 ? Start::ZERO : Start::FORCES;
      const vector<double> rows = rows_of(scheme, 0.1, 0.1, start);
      for (int i = 0; i < scheme.size(); ++i) {
        const bool known = i / scheme.width() < terms - is_rate(scheme, i);
        EXPECT_NEAR(rows[i], known ? exact[i] : 0.0, known ? 1e-15 : 0.0) << scheme;
      }
    }
}
