/* Collocation in gear_quat_startup.h: its states, extrapolation from the inner nodes, and the convergence measure.
   Its series are in test_startup.cpp. */

#include "scenes.h"

using namespace Drive;

namespace {

constexpr int EVERY_PAIRS[] = {2, 3, 4, 5, 6};

/// The fewest values that require this many pairs of nodes.
int values_for(int pairs)
{
  return 2 * pairs;
}

double polynomial(const vector<double> &a, double s)
{
  double sum = 0.0;
  for (std::size_t j = a.size(); j-- > 0;) sum = sum * s + a[j];
  return sum;
}

/// Coefficients of a polynomial of this degree, with all terms about 1 at the outermost nodes.
vector<double> of_degree(int degree, int pairs)
{
  vector<double> a = Check::Numbers(degree).list(degree + 1);
  a.back() = 1.0;
  for (int j = 0; j <= degree; ++j) a[j] *= std::pow(pairs, -j);
  return a;
}

/// Second derivatives at the nodes -inner..inner, in all columns; zero elsewhere.
Collocation::Workspace nodes_of(const vector<double> &a, int pairs, int inner)
{
  Collocation::Workspace w = {};
  w.pairs = inner;
  for (int k = -inner; k <= inner; ++k)
    for (auto &row : w.rate) row[pairs + k] = polynomial(a, k);
  return w;
}

}    // namespace

TEST(StartupNodes, AsManyAsTheOrderNeeds)
{
  for (const Scheme &scheme : every_scheme()) {
    const Collocation collocation(scheme.start_values());
    // the polynomial of x'' has degree 2 pairs, the one of x two more, and nodes are symmetric
    EXPECT_GE(2 * collocation.pairs() + 2, scheme.order() + (scheme.first() ? 0 : 1));
    EXPECT_GE(2 * collocation.pairs() + 2, scheme.values());    // all rows are found
  }
  for (int pairs : EVERY_PAIRS) EXPECT_EQ(Collocation(values_for(pairs)).pairs(), pairs);
}

TEST(StartupNodes, StatesAreIntegralsOfThePolynomial)
{
  for (int pairs : EVERY_PAIRS) {
    const Collocation collocation(values_for(pairs));
    const vector<double> a = of_degree(2 * pairs, pairs);
    Collocation::Workspace w = nodes_of(a, pairs, pairs);
    std::fill_n(w.start[0], 6, 0.5);
    std::fill_n(w.start[1], 6, -0.25);
    w.body = {1.0, {1e6, 1e6, 1e6}};    // hardly turns
    w.q[3] = 1.0;
    vector<double> x = {0.5, -0.25}, rate;    // a integrated twice
    for (std::size_t j = 0; j < a.size(); ++j) x.push_back(a[j] / ((j + 1) * (j + 2)));
    for (std::size_t j = 1; j < x.size(); ++j) rate.push_back(double(j) * x[j]);
    for (int k = -pairs; k <= pairs; ++k) {
      const BodyState s = collocation.state_at(k, w, 0.5);
      const double place = polynomial(x, k), velocity = polynomial(rate, k) / 0.5;
      EXPECT_NEAR(s.center[1], place, 1e-13 * (1.0 + std::fabs(place))) << k << " of " << pairs;
      EXPECT_NEAR(s.velocity[1], velocity, 1e-13 * (1.0 + std::fabs(velocity)));
    }
  }
}

TEST(StartupNodes, ForetellingIsExactForWhatTheInnerNodesHold)
{
  for (int pairs : EVERY_PAIRS)
    for (int inner = 0; inner < pairs; ++inner) {
      const Collocation collocation(values_for(pairs));
      auto worst = [&](const vector<double> &told, const vector<double> &truth) {
        Collocation::Workspace w = nodes_of(told, pairs, inner);
        collocation.foretell(w);
        EXPECT_EQ(w.pairs, inner + 1);
        double largest = 0.0;
        for (int k = -inner - 1; k <= inner + 1; ++k)
          for (const auto &row : w.rate) {
            const double found = row[pairs + k];
            const double exact = polynomial(truth, k);
            largest = std::max(largest, std::fabs(found - exact) / (1.0 + std::fabs(exact)));
          }
        return largest;
      };
      const vector<double> a = of_degree(2 * inner, pairs), b = of_degree(2 * inner + 1, pairs);
      EXPECT_LT(worst(a, a), 1e-11) << pairs << ' ' << inner;
      EXPECT_GT(worst(b, b), 1e-6);    // one degree more is not exact
    }
}

TEST(StartupNodes, ChangeIsRelativeToTheMotion)
{
  // a point with x'' = F/m: the previous value at the node, the new value, and the scale
  const Collocation collocation(5);
  const RigidBody point = {2.0, {0.0, 0.0, 0.0}};
  auto change = [&](double before, double force, double velocity, double length) {
    const double H = 0.5;
    BodyState s = {};
    s.q[3] = 1.0;
    Collocation::Workspace w = {};
    w.pairs = 1;
    w.body = point;
    w.start[1][0] = H * velocity;
    w.rate[0][collocation.pairs() + 1] = before;
    return collocation.set_load(1, point, s, Load{{force, 0, 0}, {0, 0, 0}}, H, length, w);
  };
  // H^2 F/m = 0.125 F
  EXPECT_NEAR(change(0.0625, 1.0, 2.0, 1.0), 0.0625 / 1.0, 1e-15);      // H x' = 1 is the larger
  EXPECT_NEAR(change(0.0625, 1.0, 0.1, 1.0), 0.0625 / 0.125, 1e-15);    // H^2 x'' is
  EXPECT_NEAR(change(0.0, 8e-6, 0.0, 3.0), 1e-6 / 3e-4, 1e-15);         // slower than the limit
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(change(0.0, infinity, 0.0, 1.0), infinity);
  EXPECT_EQ(change(0.0, std::nan(""), 0.0, 1.0), infinity);
}
