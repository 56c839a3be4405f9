/* gear_quat_startup.h: the next pair of nodes, the end of the start, and the number of evaluations
   of the forces. */

#include "scenes.h"

using namespace Drive;
using Verdict = StartPlan::Verdict;

namespace {

/// The pairs in the order of their evaluation, for given results `change`; and the verdict.
struct Course {
  std::string pairs;
  Verdict verdict;
  int known;
};
Course course(int values, const std::function<double(int pair, bool is_new, int known)> &change,
              int enough = MAX_VALUES)
{
  StartPlan plan(values);
  Course course = {"", Verdict::GOES_ON, 0};
  while (course.verdict == Verdict::GOES_ON && course.pairs.size() < 100) {
    course.pairs += std::to_string(plan.pair());
    if (plan.is_new() && plan.pair() == 2) plan.limit(enough);    // as find_start() does
    course.verdict = plan.take(change(plan.pair(), plan.is_new(), plan.pairs()));
  }
  course.known = plan.pairs();
  return course;
}

/// Smooth forces: new pairs have an error of z^(2 m - 1), and a round reduces errors by
/// `contraction`.
Course smooth(int values, double z, double contraction, int enough = MAX_VALUES)
{
  std::vector<double> last(StartPlan::MAX_PAIRS + 1);
  return course(
      values,
      [&](int pair, bool is_new, int) {
        return last[pair] = is_new ? std::pow(z, 2 * pair - 1) : contraction * last[pair];
      },
      enough);
}

/// x'' = -x and a jump of the force at |t| = 0.13, of this height.
LoadOf jumping(double height)
{
  return [height](const BodyState &s, double) {
    Load l = {};
    l.force[0] = -2.5 * s.center[0] + (s.center[1] > 0.13 ? height : 0.0);
    return l;
  };
}

Found oscillating(const LoadOf &load, double spacing)
{
  const Scene scene = oscillator(1.0);
  return bootstrap(8, scene.body, scene.start, load, spacing);
}

}    // namespace

TEST(StartPlan, WhereFewerValuesDoItEndsAsTheirsDoes)
{
  for (const double z : {0.1, 0.3, 0.6})
    for (const int few : {3, 4, 5, 7}) {
      const Course limited = smooth(9, z, 0.05, few), theirs = smooth(few, z, 0.05);
      EXPECT_EQ(limited.pairs, theirs.pairs) << few << ' ' << z;
      EXPECT_EQ(limited.known, theirs.known);
      EXPECT_LE(limited.pairs.size(), smooth(9, z, 0.05).pairs.size());
    }
  EXPECT_LT(smooth(9, 0.3, 0.05, 5).pairs.size(), smooth(9, 0.3, 0.05).pairs.size());
  EXPECT_EQ(smooth(5, 0.3, 0.05, 8).pairs, smooth(5, 0.3, 0.05).pairs);
}

TEST(StartPlan, WhatWouldChangeLessThanTheMethodLeavesOutIsNotEvaluated)
{
  EXPECT_EQ(smooth(8, 0.3, 1e-5).pairs, "11234");
  EXPECT_EQ(smooth(6, 0.3, 1e-5).pairs, "1123");
  EXPECT_EQ(smooth(4, 0.3, 1e-5).pairs, "112");
}

TEST(StartPlan, MorePairsThanRoundingLeavesAreNotAdded)
{
  EXPECT_EQ(smooth(8, 1e-6, 1e-12).known, 2);
  const Course rounding = course(8, [](int pair, bool is_new, int) {
    return is_new ? std::max(std::pow(1e-3, 2 * pair - 1), 1e-13 * std::pow(4, pair)) : 1e-14;
  });
  EXPECT_EQ(rounding.verdict, Verdict::CONVERGED);
  EXPECT_LT(rounding.known, 4);
}

TEST(StartPlan, EvaluationsInTheCage)
{
  // test case 1 at the steps for errors of 1e-4 to 1e-10
  const CageScene scene(1, true);
  for (int values : {7, 8, 9})
    for (double h : {0.35, 0.25, 0.125, 0.0625}) {
      const Found found = bootstrap(values, scene.body, scene.start, scene, h, 12.0);
      EXPECT_EQ(found.verdict, Verdict::CONVERGED);
      EXPECT_LE(found.evaluations, values < 9 ? 24 : 26) << values << ' ' << h;
      EXPECT_EQ(found.spacing, h);
    }
}

TEST(StartPlan, AJumpIsRecognizedAtTheFirstSpacing)
{
  for (double height : {1e-3, 1e-2, 0.1}) {
    const Found found = oscillating(jumping(height), 0.1);
    EXPECT_EQ(found.verdict, Verdict::JUMPS) << height;
    EXPECT_EQ(found.spacing, 0.1);
    EXPECT_LT(found.pairs, 4);
    EXPECT_LE(found.evaluations, 20);
  }
  EXPECT_LE(oscillating(jumping(0.1), 0.1).evaluations, 12);
  EXPECT_EQ(oscillating(jumping(0.0), 0.1).verdict, Verdict::CONVERGED);
}

TEST(StartPlan, HalvesTheSpacingUntilTheFirstPairIsForetold)
{
  const Found wide = bootstrap(12, TOP, top_state(0.0), swing, 1.6);
  EXPECT_LT(wide.spacing, 1.6);
  const LoadOf broken = constant({{std::nan(""), 0, 0}, {0, 0, 0}});
  EXPECT_THROW(bootstrap(6, TOP, top_state(0.0), broken, 0.1), std::runtime_error);
}
