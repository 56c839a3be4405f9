/* gear_quat_any_norm.h: the equations are valid for any |q|, to the order of the method; passes
   converge; energy is conserved better than with a projection; fast bodies move as with a
   projection. */

#include "gear_quat_limits.h"
#include "scenes.h"

using namespace Drive;

namespace {

Scheme tuned(int values, Projection projection = Projection::AUTO, int passes = 0)
{
  Scheme scheme = scheme_of(SECOND, values, passes);
  scheme.tuned = true;
  scheme.projection = projection;
  return scheme;
}

Scheme projected(int values)
{
  return tuned(values, Projection::YES, 2);
}

constexpr int VALUES[] = {5, 7, 9};

/// TOP turns by 1.2 h in a step.
double top_error(const Scheme &scheme, double h)
{
  return error(free_top(), scheme, h, h);
}

/// The largest relative error of the energy of a free top.
double energy_error(const Scheme &scheme, double h, double time)
{
  Motion motion(TOP, top_state(0.0), free_of_load, scheme, h, Start::BOOTSTRAP, h);
  const double exact = rotational_energy(TOP, motion.state().omega_body);
  double worst = 0.0;
  for (int n = std::lround(time / h); n > 0; --n) {
    motion.step();
    worst =
        std::max(worst, std::fabs(rotational_energy(TOP, motion.state().omega_body) / exact - 1.0));
  }
  return worst;
}

/// Energies of a ball on springs: its libration about z and its center along y, which have the same
/// frequency.  The logarithmic changes in a step of z radians.
struct Losses {
  double rotation, center;
};

Losses losses(const Scheme &scheme, double z)
{
  const RigidBody ball = {2.0, {0.7, 0.7, 0.7}};
  const auto angle = [](const BodyState &s) {
    return 2.0 * std::atan2(s.q[2], s.q[3]);
  };
  const auto springs = [&](const BodyState &s, double) {
    Load l = {};
    l.force[1] = -ball.mass * s.center[1];
    l.torque_space[2] = -ball.inertia[2] * angle(s);
    return l;
  };
  BodyState start = {};
  start.center[1] = 0.01;
  start.q[2] = std::sin(0.025);
  start.q[3] = std::cos(0.025);
  Motion motion(ball, start, springs, scheme, z, Start::BOOTSTRAP, z);
  const auto logarithms = [&]() -> Losses {
    const BodyState s = motion.state();
    return {std::log(s.omega_body[2] * s.omega_body[2] + angle(s) * angle(s)),
            std::log(s.velocity[1] * s.velocity[1] + s.center[1] * s.center[1])};
  };
  constexpr int STEPS = 4000;
  motion.steps(200);    // spurious roots decay
  const Losses before = logarithms();
  motion.steps(STEPS);
  const Losses after = logarithms();
  return {(after.rotation - before.rotation) / STEPS, (after.center - before.center) / STEPS};
}

}    // namespace

// --- the methods

TEST(AnyNorm, IsForTunedOddNumbersOfTheSecondFormulation)
{
  for (Scheme scheme : every_scheme())
    for (const bool with_tuned : {false, true})
      for (const Projection projection : {Projection::AUTO, Projection::YES, Projection::NO}) {
        scheme.tuned = with_tuned;
        scheme.projection = projection;
        const int n = scheme.values();
        EXPECT_EQ(scheme.any_norm(),
                  projection == Projection::AUTO && with_tuned && !scheme.first() &&
                      (n == 5 || n == 7 || n == 9));
      }
  EXPECT_EQ(tuned(5).order(), 4);
  EXPECT_EQ(projected(5).order(), 5 - (tuned_set(SECOND, 5, Columns::DRIVEN)->solves_c0() ? 0 : 1));
}

TEST(AnyNorm, ElsewhereAutomaticMeansProjectionAndTwoPasses)
{
  for (const bool with_tuned : {false, true})
    for (Scheme scheme : every_scheme(2)) {
      scheme.tuned = with_tuned;
      if (with_tuned && !has_tuned(scheme.formulation, scheme.values())) continue;
      Scheme automatic = scheme;
      automatic.passes = 0;
      automatic.projection = Projection::AUTO;
      if (automatic.any_norm()) continue;
      Motion one(TOP, top_state(0.0), swing, scheme, 0.05, Start::BOOTSTRAP, 0.05);
      Motion other(TOP, top_state(0.0), swing, automatic, 0.05, Start::BOOTSTRAP, 0.05);
      one.steps(20);
      other.steps(20);
      EXPECT_EQ(one.history, other.history) << scheme;
    }
}

// --- the equation

TEST(AnyNorm, TheEquationIsThatOfAScaledQuaternion)
{
  // q = r(t) u(t) with known r and unit vector u: the second derivative by differences
  const auto place = [](double t, double *q) {
    const double u[4] = {std::sin(0.3 * t), std::cos(0.7 * t), 0.4 + 0.2 * t, 0.9 - 0.1 * t * t};
    const double norm = std::sqrt(dot4(u, u)), r = 1.1 + 0.3 * t + 0.2 * t * t;
    for (int i = 0; i < 4; ++i) q[i] = r * u[i] / norm;
  };
  const auto rate = [&](double t, double *qdot) {
    constexpr double D = 1e-3;
    double a[4], b[4], c[4], d[4];
    place(t + D, a), place(t - D, b), place(t + 2 * D, c), place(t - 2 * D, d);
    for (int i = 0; i < 4; ++i) qdot[i] = (8 * (a[i] - b[i]) - (c[i] - d[i])) / (12 * D);
  };
  const auto omega = [&](double t, double *w) {
    double q[4], qdot[4];
    place(t, q), rate(t, qdot);
    angular_velocity(q, dot4(q, q), qdot, w);
  };
  const double t = 0.4, d = 1e-3;
  double q[4], qdot[4], w[3], wdot[3], exact[4], before[4], after[4], found[4];
  place(t, q), rate(t, qdot), omega(t, w);
  rate(t + d, after), rate(t - d, before);
  for (int i = 0; i < 4; ++i) exact[i] = (after[i] - before[i]) / (2 * d);
  double w1[3], w0[3];
  omega(t + d, w1), omega(t - d, w0);
  for (int i = 0; i < 3; ++i) wdot[i] = (w1[i] - w0[i]) / (2 * d);
  // r''/r = -1/2 stiffness (r^2 - 1)
  const double r = 1.1 + 0.3 * t + 0.2 * t * t, stiffness = -2.0 * 0.4 / r / (r * r - 1.0);
  quaternion_acceleration(q, qdot, w, wdot, stiffness, 0.0, found);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(found[i], exact[i], 3e-6);
  w[1] *= 1.01;
  quaternion_acceleration(q, qdot, w, wdot, stiffness, 0.0, found);
  EXPECT_GT(Check::largest_difference(found, exact, 4), 1e-4);

  // Eq. 6 alone, and a mixture
  double eq6[4], any[4];
  quaternion_acceleration(q, qdot, wdot, eq6);
  quaternion_acceleration(q, qdot, w, wdot, stiffness, 1.0, found);
  EXPECT_LT(Check::largest_difference(found, eq6, 4), 1e-14);
  quaternion_acceleration(q, qdot, w, wdot, stiffness, 0.0, any);
  quaternion_acceleration(q, qdot, w, wdot, stiffness, 0.25, found);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(found[i], 0.25 * eq6[i] + 0.75 * any[i], 1e-14);
}

TEST(AnyNorm, LengthsAreOfNoConsequence)
{
  // the same motion with q and all its derivatives longer by 2 %, which the spring reduces
  for (const int n : VALUES) {
    const Scheme scheme = tuned(n);
    const double h = n == 9 ? 0.1 : 0.05;
    const auto turn = [&](const Scheme &with) {
      Motion motion(TOP, top_state(0.0), free_of_load, with, h, Start::BOOTSTRAP, h);
      for (int j = 0; j < with.values(); ++j)
        for (int i = 0; i < 4; ++i) motion.rows[j * with.width() + with.quaternion() + i] *= 1.02;
      motion.steps(std::lround(24.0 / h));
      return Check::attitude_distance(motion.q(), top_state(24.0).q);
    };
    EXPECT_LT(turn(scheme), 5e-3) << n;
    EXPECT_LT(turn(scheme), 0.05 * turn(projected(n))) << n;    // at first these turn faster
  }
}

// --- the benefit

TEST(AnyNorm, HasItsOrder)
{
  for (const int n : VALUES) {
    const Scheme scheme = tuned(n);
    for (const double slope : error_slopes(free_top(), scheme, {0.08, 0.06, 0.05, 0.04}))
      EXPECT_NEAR(slope, scheme.order(), n == 9 ? 0.7 : 0.4) << n;
    RigidBody off = TOP;
    off.inertia[0] *= 1.01;
    EXPECT_GT(error(free_top(off), scheme, 0.06, 0.06), 1e-2);
  }
}

TEST(AnyNorm, KeepsTheEnergyOfAFreeTopBetter)
{
  for (const int n : VALUES) {
    const double without = energy_error(tuned(n), 0.1, 2000.0);
    EXPECT_LT(without, 0.2 * energy_error(projected(n), 0.1, 2000.0)) << n;
    EXPECT_LT(without, n == 5 ? 1e-4 : 1e-6) << n;
  }
}

TEST(AnyNorm, QuaternionsStayCloseToUnitLength)
{
  const CageScene scene(1, true);
  for (const int n : VALUES) {
    Motion motion(scene.body, scene.start, scene, tuned(n), 0.1, Start::BOOTSTRAP, 0.1);
    double worst = 0.0;
    for (int k = 0; k < 20000; ++k) {
      motion.step();
      worst = std::max(worst, std::fabs(dot4(motion.q(), motion.q()) - 1.0));
    }
    EXPECT_LT(worst, 1e-3) << n;
    EXPECT_GT(worst, 0.0) << n;
  }
}

TEST(AnyNorm, FiveValuesAreStableToTheLimitOfTheManual)
{
  EXPECT_NEAR(fastest_oscillation(tuned(5)), 0.96, 0.021);
}

TEST(AnyNorm, LibrationsLoseWhatCentersLose)
{
  // with seven values, nearly the same with a projection; not with five
  for (const int n : {5, 7})
    for (const double z : {0.2, 0.35}) {
      const Losses any = losses(tuned(n), z), other = losses(projected(n), z);
      EXPECT_NEAR(any.rotation, any.center, 0.02 * std::fabs(any.center)) << n << ' ' << z;
      EXPECT_GT(std::fabs(other.rotation - other.center), 0.05 * std::fabs(other.center));
      if (n == 7) EXPECT_NEAR(other.rotation, other.center, 0.15 * std::fabs(other.center));
    }
}

// --- passes

TEST(AnyNorm, PassesConverge)
{
  for (const int n : VALUES) {
    const double many = top_error(tuned(n, Projection::AUTO, 40), 0.1);
    EXPECT_NEAR(top_error(tuned(n), 0.1), many, 0.03 * many) << n;
    EXPECT_GT(std::fabs(top_error(tuned(n, Projection::AUTO, 2), 0.1) - many), 0.03 * many) << n;
  }
}

TEST(AnyNorm, AGivenNumberOfPassesIsMade)
{
  int calls = 0;
  double total[4] = {1.0, 0.0, 0.0, 0.0};
  AnyNorm::repeat(0.0, total, [&] {
    ++calls;
  });    // converged at once
  EXPECT_EQ(calls, 2);
  calls = 0;
  AnyNorm::repeat(0.0, total, [&] {
    total[0] += std::pow(0.01, ++calls);
  });
  EXPECT_EQ(calls, 2);
  calls = 0;
  AnyNorm::repeat(0.5, total, [&] {
    total[0] += std::pow(0.5, ++calls);
  });
  EXPECT_EQ(calls, 8);
  calls = 0;
  AnyNorm::repeat(0.0, total, [&] {
    total[0] = std::pow(1e9, ++calls);
  });    // without convergence
  EXPECT_EQ(calls, 3);
  EXPECT_TRUE(AnyNorm(tuned(9)).converges(0.0));
  EXPECT_FALSE(AnyNorm(tuned(9)).converges(1.0));
  EXPECT_FALSE(AnyNorm(tuned(9, Projection::AUTO, 2)).converges(0.0));
}

// --- fast bodies

TEST(AnyNorm, FastBodiesMoveAsWithProjection)
{
  for (const int n : {7, 9}) {
    const double h = 0.27;    // 0.32 radians
    Motion one(TOP, top_state(0.0), free_of_load, tuned(n), h, Start::BOOTSTRAP, h);
    Motion other(TOP, top_state(0.0), free_of_load, projected(n), h, Start::BOOTSTRAP, h);
    one.steps(200);
    other.steps(200);
    EXPECT_EQ(one.history, other.history) << n;
  }
}

/// With a coupling, fast bodies are projected and have as many passes as the others.
TEST(AnyNorm, ThreePassesOfAllBodiesLoseNoMoreFastOnesThanTwo)
{
  EXPECT_EQ(tuned(9).coupled_passes(), 2);
  EXPECT_EQ(projected(7).coupled_passes(), 2);
  for (const int n : {5, 7}) {
    EXPECT_EQ(tuned(n).coupled_passes(), 3);
    Check::Numbers numbers(41);
    int lost[4] = {};    // by passes
    for (int trial = 0; trial < 400; ++trial) {
      const vector<double> m = numbers.list(3), along = numbers.list(3);
      BodyState state = top_state(0.0);
      std::copy_n(numbers.unit_quaternion().data(), 4, state.q);
      for (int i = 0; i < 3; ++i) state.omega_body[i] = 0.5 * along[i] / length(along.data());
      // moments of three masses on the axes
      const double x = m[0] * m[0] + 0.02, y = m[1] * m[1] + 0.02, z = m[2] * m[2] + 0.02;
      const RigidBody body = {1.0, {y + z, x + z, x + y}};
      for (int passes = 1; passes < 4; ++passes) {
        Scheme scheme = projected(n);
        scheme.passes = passes;
        lost[passes] += !survives_flight(scheme, body, state, 1.0, 1000);
      }
    }
    EXPECT_LT(lost[3], lost[2]) << n;
    EXPECT_LT(lost[2], lost[1]) << n;
  }
}

TEST(AnyNorm, NoFewerBodiesAreStableThanWithProjection)
{
  const RigidBody bodies[] = {TOP,
                              {1, {1, 1, 1}},
                              {1, {0.6, 1.2, 1.8}},
                              {1, {2, 2, 3}},
                              {1, {0.001, 1, 1.001}},
                              {1, {0.1, 1, 1.05}}};
  const double directions[][3] = {{0.6, -0.64, 0.48}, {0.1, 0.99, -0.1}, {-0.3, 0.3, 0.906}};
  for (const int n : VALUES)
    for (const double fastest : {0.27, 0.5, 0.8}) {
      int without = 0, with = 0;
      for (double turn = 0.1; turn < fastest; turn += 0.02)
        for (const RigidBody &body : bodies)
          for (const auto &along : directions) {
            BodyState state = top_state(0.0);
            for (int i = 0; i < 3; ++i) state.omega_body[i] = turn * along[i];
            without += survives_flight(tuned(n), body, state, 1.0, 2000);
            with += survives_flight(projected(n), body, state, 1.0, 2000);
          }
      EXPECT_GE(without, 0.99 * with) << n << ", " << fastest;
    }
}

TEST(AnyNorm, TheEnergyHasNoJumpWhereProjectionSetsIn)
{
  // a constant torque about the axis of an axially symmetric body accelerates it
  const RigidBody body = {1.0, {1.0, 1.0, 1.7}};
  BodyState start = {};
  start.q[3] = 1.0;
  const double torque = 1e-4;
  for (const int n : {7, 9}) {
    start.omega_body[2] = 0.1;
    Motion motion(
        body, start,
        [&](const BodyState &, double) {
          return Load{{}, {0.0, 0.0, torque}};
        },
        tuned(n), 1.0, Start::BOOTSTRAP, 1.0);
    double angle = 0.0, worst = 0.0;
    while (motion.state().omega_body[2] < 0.35) {
      const double before = motion.state().omega_body[2];
      motion.step();
      const double after = motion.state().omega_body[2];
      angle += 0.5 * (before + after);
      const double missing = 0.5 * 1.7 * (after * after - 0.01) - torque * angle;
      worst = std::max(worst, std::fabs(missing) / (0.5 * 1.7 * after * after));
    }
    EXPECT_LT(worst, n == 7 ? 1e-3 : 1e-4) << n;
  }
}
