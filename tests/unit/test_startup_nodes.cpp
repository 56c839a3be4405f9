/* Collocation in gear_quat_startup.h: its polynomials, how far the first sweep sees ahead, the two
   numbers that end the sweeps, and how many sweeps that takes. */

#include "scenes.h"

using namespace Drive;
using Check::slopes;

namespace {

constexpr int EVERY_PAIRS[] = {2, 3, 4, 5, 6};

/// The fewest values that take so many pairs of nodes.
int values_for(int pairs)
{
  return 2 * pairs - 1;
}

double polynomial(const vector<double> &a, double s)
{
  double sum = 0.0;
  for (std::size_t j = a.size(); j-- > 0;) sum = sum * s + a[j];
  return sum;
}

/// Coefficients of a polynomial of this degree, all terms about 1 at the outermost nodes.
vector<double> of_degree(int degree, int pairs)
{
  vector<double> a = Check::Numbers(degree).list(degree + 1);
  a.back() = 1.0;
  for (int j = 0; j <= degree; ++j) a[j] *= std::pow(pairs, -j);
  return a;
}

/// Second derivatives at the nodes -inner..inner, in all columns; elsewhere none.
Collocation::Workspace nodes_of(const vector<double> &a, int pairs, int inner)
{
  Collocation::Workspace w = {};
  for (int k = -inner; k <= inner; ++k)
    for (double &x : w.second[pairs + k]) x = polynomial(a, k);
  return w;
}

/// The series with sweeps until rounding alone is left, whatever the host's rule says.
TaylorSeries converged(int values, double spacing)
{
  const Collocation collocation(values);
  Collocation::Workspace work;
  const BodyState s = top_state(0.0);
  collocation.begin(local_series(TOP, s, swing(s, 1.0), spacing), work);
  for (int k = 0; k < 40; ++k) sweep(collocation, TOP, swing, spacing, 1.0, k == 0, work);
  return collocation.series(work);
}

}    // namespace

TEST(StartupNodes, AsManyAsTheOrderNeeds)
{
  for (const Scheme &scheme : every_scheme()) {
    const Collocation collocation(scheme.values());
    // the polynomial of x'' has degree 2 pairs, that of x two more
    EXPECT_GE(2 * collocation.pairs() + 2, scheme.order() + (scheme.first() ? 0 : 1));
    EXPECT_GE(2 * collocation.pairs() + 2, scheme.values());    // all rows are found
  }
  for (int pairs : EVERY_PAIRS) EXPECT_EQ(Collocation(values_for(pairs)).pairs(), pairs);
}

TEST(StartupNodes, PolynomialsOfTheirDegreeAreIntegratedExactly)
{
  for (int pairs : EVERY_PAIRS) {
    const int degree = 2 * pairs;
    const Collocation collocation(values_for(pairs));
    const vector<double> a = of_degree(degree, pairs);
    Collocation::Workspace w = nodes_of(a, pairs, pairs);
    for (int i = 0; i < 7; ++i) {
      w.start[0][i] = 0.5;
      w.start[1][i] = -0.25;
    }
    w.start[0][6] = 1e3;    // q far from zero
    const TaylorSeries series = collocation.series(w);
    ASSERT_EQ(series.terms, degree + 3);

    vector<double> terms = {0.5, -0.25};    // of x: a integrated twice
    for (int j = 0; j <= degree; ++j) terms.push_back(a[j] / ((j + 1) * (j + 2)));
    Check::holds_and_refuses_one_percent(terms, [&](const vector<double> &x) {
      for (int j = 0; j < series.terms; ++j)
        if (!(std::fabs(series.c[j][0] - x[j]) <= 0.005 * std::fabs(x[j]))) return false;
      vector<double> rate;
      for (std::size_t j = 1; j < x.size(); ++j) rate.push_back(double(j) * x[j]);
      for (int k = -pairs; k <= pairs; ++k) {
        const BodyState s = collocation.state_at(k, w, 0.5);
        const double value = polynomial(x, k), velocity = polynomial(rate, k) / 0.5;
        if (!(std::fabs(s.center[1] - value) <= 1e-13 * (1.0 + std::fabs(value)))) return false;
        if (!(std::fabs(s.velocity[1] - velocity) <= 1e-13 * (1.0 + std::fabs(velocity))))
          return false;
      }
      return true;
    });
  }
}

TEST(StartupNodes, ForetellingIsExactForWhatTheInnerNodesHold)
{
  for (int pairs : EVERY_PAIRS)
    for (int inner = 1; inner < pairs; ++inner) {
      const Collocation collocation(values_for(pairs));
      auto worst = [&](const vector<double> &told, const vector<double> &truth) {
        Collocation::Workspace w = nodes_of(told, pairs, inner);
        collocation.foretell(inner, w);
        double largest = 0.0;
        for (int k = -pairs; k <= pairs; ++k)
          for (double found : w.second[pairs + k]) {
            const double exact = polynomial(truth, k);
            largest = std::max(largest, std::fabs(found - exact) / (1.0 + std::fabs(exact)));
          }
        return largest;
      };
      const vector<double> a = of_degree(2 * inner, pairs), b = of_degree(2 * inner + 1, pairs);
      EXPECT_LT(worst(a, a), 1e-11) << pairs << ' ' << inner;
      EXPECT_GT(worst(b, b), 1e-2);    // one degree more is not
      vector<double> off = a;
      off[2 * inner] *= 1.01;
      EXPECT_GT(worst(off, a), 1e-3);
    }
}

TEST(StartupNodes, TruncationIsTheHighestTerm)
{
  for (int pairs : EVERY_PAIRS) {
    const int degree = 2 * pairs;
    const Collocation collocation(values_for(pairs));
    Check::Numbers numbers(5);
    Collocation::Workspace w = {};
    // columns differ; x in units of a body of size 2, the scales below set by the first derivatives
    double top[7], x = 0.0, q = 0.0;
    for (int i = 0; i < 7; ++i) {
      vector<double> a = of_degree(degree, pairs);
      top[i] = a[degree] = 1e-5 * numbers.next();
      for (int k = -pairs; k <= pairs; ++k) w.second[pairs + k][i] = polynomial(a, k);
      double &part = i < 3 ? x : q;
      part = std::max(part, std::fabs(top[i]));
    }
    w.start[1][1] = 40.0;
    w.start[1][5] = -80.0;
    const double expected = std::max(x / 40.0, q / 80.0), found = collocation.truncation(2.0, w);
    EXPECT_NEAR(found, expected, 1e-3 * expected);
    for (int i : {1, 5}) {    // 1 % in what it is relative to
      Collocation::Workspace off = w;
      off.start[1][i] *= 1.01;
      const double scale = (i == 1) == (x / 40.0 > q / 80.0) ? expected / 1.01 : expected;
      EXPECT_NEAR(collocation.truncation(2.0, off), scale, 1e-3 * scale);
    }
  }
}

TEST(StartupNodes, ChangeIsRelativeToTheMotion)
{
  // a point with x'' = F/m: what the node held before, what it holds now, and the scale
  const Collocation collocation(5);
  const RigidBody point = {2.0, {0.0, 0.0, 0.0}};
  auto change = [&](double before, double force, double velocity, double length) {
    const double H = 0.5;
    BodyState s = {};
    s.q[3] = 1.0;
    Collocation::Workspace w = {};
    w.start[0][6] = 1.0;
    w.start[1][0] = H * velocity;
    w.second[collocation.pairs() + 1][0] = before;
    return collocation.set_load(1, point, s, Load{{force, 0, 0}, {0, 0, 0}}, H, length, w);
  };
  // H^2 F/m = 0.125 F
  EXPECT_NEAR(change(0.0625, 1.0, 2.0, 1.0), 0.0625 / 1.0, 1e-15);      // H x' = 1 is the larger
  EXPECT_NEAR(change(0.0625, 1.0, 0.1, 1.0), 0.0625 / 0.125, 1e-15);    // H^2 x'' is
  EXPECT_NEAR(change(0.0, 8e-6, 0.0, 3.0), 1e-6 / 3e-4, 1e-15);         // slower than counts
  EXPECT_GT(std::fabs(change(0.0625, 1.01, 2.0, 1.0) - 0.0625), 5e-4);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(change(0.0, infinity, 0.0, 1.0), infinity);
  EXPECT_EQ(change(0.0, std::nan(""), 0.0, 1.0), infinity);
}

TEST(StartupNodes, SeriesApproachesTheExactOneWithTheOrderOfTheNodes)
{
  // n nodes: the terms from the second derivative on are of order n + 2 in the spacing
  const BodyState s = top_state(0.0);
  const Oracle::TaylorTop top(Oracle::MOMENTS, s.q, s.omega_body);
  for (int pairs : EVERY_PAIRS) {
    const int n = 2 * pairs + 1;
    const vector<double> spacing = pairs > 4 ? vector<double>{0.15, 0.12}
                                             : vector<double>{0.2, 0.1};
    vector<double> error;
    for (double H : spacing) {
      const TaylorSeries series = converged(values_for(pairs), H);
      double worst = 0.0;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < 4; ++i)
          worst =
              std::max(worst, std::fabs(series.c[j][3 + i] - double(top.q[j][i]) * std::pow(H, j)));
      error.push_back(worst);
    }
    EXPECT_GT(slopes(spacing, error)[0], n + 2 - 0.5) << pairs;
  }
}

TEST(StartupNodes, SweepsUntilTheRuleOfTheHost)
{
  // the first sweep is of the order of the nodes already; each one more gains two orders
  const CageScene scene(1, true);
  const int most[] = {3, 5, 7, 10, 11};
  for (int pairs : EVERY_PAIRS) {
    const int values = values_for(pairs);
    const Found a = bootstrap(values, TOP, top_state(0.0), swing, 0.1);
    const Found b = bootstrap(values, scene.body, scene.start, scene, 0.05, 12.0);
    EXPECT_EQ(a.evaluations, a.sweeps * 2 * pairs);    // nothing was halved
    EXPECT_EQ(b.evaluations, b.sweeps * 2 * pairs);
    EXPECT_LE(a.sweeps, most[pairs - 2]);
    EXPECT_LE(b.sweeps, 3);

    // and further sweeps change nothing that counts: less than the polynomial leaves out
    const TaylorSeries rest = converged(values, a.spacing);
    double worst = 0.0, left_out = 0.0;
    for (int i = 0; i < 7; ++i) {
      worst = std::max(worst, std::fabs(a.series.c[2][i] - rest.c[2][i]));
      left_out = std::max(left_out, std::fabs(rest.c[rest.terms - 1][i]));
    }
    EXPECT_LT(worst, std::max(100 * left_out, 1e-15)) << pairs;
  }
}

TEST(StartupNodes, ForetellingMakesTheSecondSweepChangeLess)
{
  // what the innermost pair knew too little of is left: no order is gained

  const CageScene scene(1, true);
  for (int pairs : EVERY_PAIRS) {
    const Collocation collocation(values_for(pairs));
    double after[2];
    for (bool foretold : {false, true}) {
      Collocation::Workspace work;
      collocation.begin(local_series(scene.body, scene.start, scene.load(scene.start, 1.0), 0.05),
                        work);
      sweep(collocation, scene.body, scene, 0.05, 12.0, foretold, work);
      after[foretold] = sweep(collocation, scene.body, scene, 0.05, 12.0, false, work);
    }
    EXPECT_LT(after[1], 0.8 * after[0]) << pairs;
  }
}

TEST(StartupNodes, HalvesTheSpacingUntilSweepsConverge)
{
  const Found wide = bootstrap(12, TOP, top_state(0.0), swing, 1.6);
  EXPECT_LT(wide.spacing, 1.6);
  EXPECT_GT(wide.evaluations, wide.sweeps * 12);
  const LoadOf broken = constant({{std::nan(""), 0, 0}, {0, 0, 0}});
  EXPECT_THROW(bootstrap(6, TOP, top_state(0.0), broken, 0.1), std::runtime_error);
}

// --- the rule that ends the sweeps ---

namespace {

using Verdict = SweepRule::Verdict;

/// The last verdict about these changes with one spacing.
Verdict judged(SweepRule &rule, const vector<double> &changes, double truncation = 0.0)
{
  Verdict verdict = Verdict::ANOTHER_SWEEP;
  rule.begin_spacing();
  for (double change : changes) {
    EXPECT_EQ(verdict, Verdict::ANOTHER_SWEEP);
    verdict = rule.judge(change, [&]() {
      return truncation;
    });
  }
  return verdict;
}

}    // namespace

TEST(Sweeps, EndWhenTheNextChangeWouldBeLessThanRoundingOrTruncation)
{
  SweepRule rule;
  EXPECT_EQ(judged(rule, {1e-3, 1e-7}), Verdict::ANOTHER_SWEEP);    // the next one: 1e-11
  EXPECT_EQ(judged(rule, {1e-3, 1e-7}, 2e-11), Verdict::CONVERGED);
  EXPECT_EQ(judged(rule, {1e-3, 1e-7, 1e-12}), Verdict::CONVERGED);
  EXPECT_EQ(judged(rule, {1e-3}, 1.0), Verdict::ANOTHER_SWEEP);    // one change tells nothing
}

TEST(Sweeps, EndWhereTheChangeIsRoundingOfTheForces)
{
  SweepRule rule;
  EXPECT_EQ(judged(rule, {1e-3, 1e-7, 4e-10, 3e-10}), Verdict::CONVERGED);
  EXPECT_EQ(judged(rule, {1e-3, 1e-7, 4e-9, 3e-9}), Verdict::SHORTER_SPACING);
}

TEST(Sweeps, ForcesThatJumpAreTakenAsTheyAreAtTheThirdSpacing)
{
  SweepRule rule;
  const vector<double> stuck = {0.5, 0.06, 0.05};
  EXPECT_EQ(judged(rule, stuck), Verdict::SHORTER_SPACING);
  EXPECT_EQ(judged(rule, {0.5, 0.4, 0.3}), Verdict::SHORTER_SPACING);    // too large for a jump
  EXPECT_EQ(judged(rule, stuck), Verdict::SHORTER_SPACING);
  EXPECT_EQ(judged(rule, stuck), Verdict::JUMPS);
  EXPECT_EQ(judged(rule, {std::nan("")}), Verdict::SHORTER_SPACING);
}
