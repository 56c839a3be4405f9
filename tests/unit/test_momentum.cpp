/* Formulation momentum: rows of the angular momentum, and quaternions that turn with it. */

#include "gear_quat_friction.h"
#include "scenes.h"

#include <gtest/gtest.h>

#include <numeric>

using namespace Drive;

namespace {

Scheme momentum(int values, bool tuned = true)
{
  Scheme scheme = scheme_of(Formulation::MOMENTUM, values, 0, true);
  scheme.method = tuned ? Method::TUNED : Method::GEAR;
  return scheme;
}

/// Coefficients of h L(t), with this angle in a step; terms fall as those of a vibration.
struct Wobble {
  Turn::Momentum rows = {};
  int terms;

  explicit Wobble(double h, int terms = 8, double frequency = 1.0) : terms(terms)
  {
    const double first[3] = {0.5, -0.3, 0.4};
    double power = h;
    for (int k = 0; k < terms; ++k, power *= frequency * h / (k + 1))
      for (int i = 0; i < 3; ++i) rows[k][i] = power * first[(i + k) % 3];
  }
};

/// The same rotation in many short parts.
void turn_in_parts(const Wobble &whole, int parts, double *q)
{
  for (int part = 0; part < parts; ++part) {
    Turn::Momentum rows = {};
    const double begin = double(part) / parts;
    for (int k = 0; k < whole.terms; ++k)
      for (int j = k; j < whole.terms; ++j) {
        double binomial = 1.0;
        for (int m = 0; m < k; ++m) binomial = binomial * (j - m) / (m + 1);
        const double factor = binomial * std::pow(begin, j - k) * std::pow(1.0 / parts, k + 1);
        for (int i = 0; i < 3; ++i) rows[k][i] += factor * whole.rows[j][i];
      }
    Turn(whole.terms).advance(TOP, rows, q);
  }
}

double error_of_turn(const Wobble &wobble, const Turn &turn)
{
  double q[4] = {0.1, -0.3, 0.5, 0.8}, exact[4];
  project_norm(q);
  std::copy_n(q, 4, exact);
  turn_in_parts(wobble, 16, exact);
  turn.advance(TOP, wobble.rows, q);
  return Check::attitude_distance(q, exact);
}

}    // namespace

TEST(Turn, HasTheOrderOfItsSeries)
{
  for (const int terms : {4, 5, 6, 7}) {
    const auto error = [terms](double h) {
      return error_of_turn(Wobble(h, terms, 10.0), {terms, terms + 1, 1.0e-3});
    };
    EXPECT_GT(std::log2(error(0.04) / error(0.02)), terms + 1.5) << terms;
  }
}

TEST(Turn, CoefficientsAddUpToTheTurn)
{
  const Wobble wobble(0.1);
  double q[4] = {0.1, -0.3, 0.5, 0.8}, series[Turn::MOST + 1][4], sum[4] = {};
  project_norm(q);
  Turn::coefficients(TOP, wobble.rows, wobble.terms, q, series);
  for (const auto &term : series)
    for (int i = 0; i < 4; ++i) sum[i] += term[i];
  Turn(wobble.terms).advance(TOP, wobble.rows, q);
  EXPECT_LT(Check::largest_difference(sum, q, 4), 1.0e-13);
}

TEST(Momentum, BodiesSideBySideMoveAsEachAlone)
{
  const double h = 0.1;
  for (const bool compensate : {false, true})
    for (int count = 1; count <= LANES; ++count) {
      Scheme scheme = momentum(7);
      scheme.compensate = compensate;
      const Integrator integrator(scheme, h);
      RigidBody bodies[LANES];
      std::vector<double> alone[LANES], together[LANES];
      BodyState states[LANES];
      BodyFrame frames[LANES];
      Load loads[LANES];
      Correction last[LANES];
      Friction friction = Multipliers{0.3, 0.2};
      friction.implicit = true;
      friction.common[1] = 0.1;
      Block block;
      for (int n = 0; n < count; ++n) {
        bodies[n] = TOP;
        if (n == 1) bodies[n].inertia[2] = 0.0;
        states[n] = top_state(0.3 * n);
        loads[n] = {{0.1 * n, 0.2, -0.3}, {0.4, -0.1 * n, 0.2}};
        alone[n].resize(scheme.size());
        seed(scheme, bodies[n], local_series(bodies[n], states[n], loads[n], h), h, h,
             alone[n].data());
        together[n] = alone[n];
        block.bodies[n] = &bodies[n];
        block.rows[n] = together[n].data();
        block.states[n] = &states[n];
        block.frames[n] = &frames[n];
        block.loads[n] = &loads[n];
        block.last[n] = &last[n];
        block.count = n + 1;
      }
      integrator.predict(block);
      integrator.correct(block, friction);
      integrator.find_states(block);
      for (int n = 0; n < count; ++n) {
        integrator.predict(bodies[n], alone[n].data());
        const Correction one = integrator.correct(bodies[n], loads[n], alone[n].data(), friction);
        const BodyState state = integrator.body_state(bodies[n], alone[n].data());
        EXPECT_EQ(alone[n], together[n]) << n << " of " << count;
        EXPECT_EQ(one.work, last[n].work);
        EXPECT_EQ(one.position_error2, last[n].position_error2);
        for (int i = 0; i < 3; ++i) EXPECT_EQ(state.omega_body[i], states[n].omega_body[i]);
      }
    }
}

// without torque the method is exact, for any step and number of values

TEST(Momentum, AFreeTopIsExact)
{
  const Scene scene = free_top();
  for (const int values : {5, 7, 9, 12})
    for (const double h : {0.1, 0.5}) {
      Motion motion(scene.body, scene.start, scene.load, momentum(values), h, Start::BOOTSTRAP, h);
      double before[3], after[3];
      momentum_along_space(scene.body, motion.state(), before);
      motion.run(scene.time);
      momentum_along_space(scene.body, motion.state(), after);
      EXPECT_LT(scene.missed(motion.state()), values < 6 ? 1.0e-10 : 5.0e-12)
          << values << " values, h " << h;
      EXPECT_LT(Check::largest_difference(before, after, 3), 5.0e-15);
    }
}

TEST(Momentum, OrdersInTheCage)
{
  const Scene scene = cage(CageScene(1, true));
  struct Steps {
    int values;
    double wide, narrow;
  };
  for (const Steps &s : {Steps{4, 0.25, 0.16},
                         {5, 0.1, 0.05},
                         {6, 0.16, 0.08},
                         {7, 0.08, 0.05},
                         {8, 0.1, 0.05},
                         {9, 0.08, 0.05},
                         {10, 0.1, 0.08}}) {
    const Scheme scheme = momentum(s.values, false);
    EXPECT_GT(error_slopes(scene, scheme, {s.wide, s.narrow})[0], scheme.order() - 0.4) << scheme;
  }
}

TEST(Momentum, OrdersOfOrientationsInTheCage)
{
  const CageScene cage_scene(1, true);
  const auto end = [&](const Scheme &scheme, double h) {
    Motion motion(cage_scene.body, cage_scene.start, cage_scene, scheme, h, Start::BOOTSTRAP, h);
    motion.run(40.0);
    return motion.state();
  };
  const BodyState exact = end(momentum(12, false), 0.02);
  for (const int values : {5, 7, 9}) {
    const auto error = [&](double h) {
      return Check::attitude_distance(end(momentum(values, false), h).q, exact.q);
    };
    EXPECT_GT(std::log2(error(0.16) / error(0.08)), values - 1.4) << values;
  }
}

// t^N, for which the rows deviate from the derivatives by constants: the deviations of their own
// accord, and a velocity with which the positions are exact

TEST(Momentum, TheMomentIsThatOfASteadyMotion)
{
  for (const int n : {5, 6, 7, 9, 12}) {
    const CorrectorCoefficients c(momentum(n));
    const auto binomial = [](int k, int j) {
      return std::round(std::tgamma(k + 1) / std::tgamma(j + 1) / std::tgamma(k - j + 1));
    };
    std::vector<double> e(n);
    double residual = 0.0;
    for (int step = 0; step < 3000; ++step) {
      std::vector<double> predicted(n);
      for (int j = 2; j < n; ++j) {
        predicted[j] = -binomial(n, j);
        for (int k = j; k < n; ++k) predicted[j] += binomial(k, j) * e[k];
      }
      residual = -predicted[2];
      for (int j = 2; j < n; ++j) e[j] = predicted[j] + c.c[j] * residual;
    }
    e[1] = 1.0 - c.c[0] * residual - std::accumulate(e.begin() + 2, e.end(), 0.0);
    double moment = -1.0 / (n + 1);
    for (int j = 1; j < n; ++j) moment += e[j] / (j + 1);
    EXPECT_NEAR(moment / residual, c.moment, 1.0e-9) << n;
    EXPECT_GT(std::fabs(c.moment), 0.01) << n;
  }
}

// wells that hold the axes of a body at those of space; without the term of kappa the larger
// amplitude loses energy

TEST(Momentum, LibrationsKeepTheirEnergyAtAnyAmplitude)
{
  const RigidBody body = {1.0, {0.6, 1.15, 1.75}};
  const double depth[3] = {0.884, 0.284, 0.0}, h = 0.5;    // angular frequencies 0.7 to 1.4
  const auto wells = [&](const BodyState &s, double norm2) {
    Load load = {};
    double a[9];
    rotation_matrix(s.q, norm2, a);
    for (int i = 0; i < 3; ++i) {
      double pull[3] = {}, torque[3];
      pull[i] = depth[i];
      cross3(a + 3 * i, pull, torque);
      for (int k = 0; k < 3; ++k) load.torque_space[k] += torque[k];
    }
    return load;
  };
  const auto energy = [&](const BodyState &s) {
    double a[9];
    rotation_matrix(s.q, dot4(s.q, s.q), a);
    return rotational_energy(body, s.omega_body) - depth[0] * a[0] - depth[1] * a[4];
  };
  for (const double amplitude : {0.01, 0.2}) {
    BodyState start = {};
    start.q[3] = 1.0;
    for (int i = 0; i < 3; ++i) start.omega_body[i] = amplitude * (i == 1 ? -1.0 : 0.8);
    Motion motion(body, start, wells, momentum(5), h, Start::BOOTSTRAP, 0.3);
    const auto mean = [&] {
      double sum = 0.0;
      for (int step = 0; step < 400; ++step) {
        motion.step();
        sum += energy(motion.state()) / 400;
      }
      return sum;
    };
    const double before = mean();
    motion.steps(3000);
    const double change = (mean() - before) / rotational_energy(body, start.omega_body);
    EXPECT_LT(std::fabs(change), 1.0e-3) << amplitude;
  }
}

TEST(Momentum, VelocitiesAreWrittenAndRead)
{
  const Scheme scheme = momentum(9);
  const Integrator integrator(scheme, 0.2);
  std::vector<double> rows(scheme.size());
  BodyState state = top_state(0.0);
  seed(scheme, TOP, local_series(TOP, state, Load{}, 0.2), 0.2, 0.2, rows.data());
  for (int i = 0; i < 3; ++i) {
    state.velocity[i] += 0.3 * i;
    state.omega_body[i] -= 0.2 * i;
  }
  integrator.set_velocities(TOP, state, Load{}, rows.data());
  const BodyState found = integrator.body_state(TOP, rows.data());
  EXPECT_LT(Check::largest_difference(found.velocity, state.velocity, 3), 1.0e-15);
  EXPECT_LT(Check::largest_difference(found.omega_body, state.omega_body, 3), 1.0e-15);
}
