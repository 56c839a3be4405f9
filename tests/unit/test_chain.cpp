/* Nose-Hoover chains: energy balance, response to the target beside a reference solution, orders of
   the conserved quantity, another step and another number of values. */

#include "thermostatted.h"
#include "tied_bodies.h"

using namespace Thermostatted;
using Check::slopes;

namespace {

/// Scheme with this corrector and two passes.
Scheme with(Formulation formulation, int values, bool tuned)
{
  Scheme scheme = scheme_of(formulation, values, 2);
  scheme.tuned = tuned;
  return scheme;
}

Host tied(const Scheme &scheme, int length, double h, const TargetOf &target_of)
{
  return Host{TiedBodies::BODIES, TiedBodies::at_start(), TiedBodies::loads, target_of, scheme, length, h};
}

double all_energy(const Host &host)
{
  return TiedBodies::springs(host.states).energy + host.kinetic_and_chain();
}

/// Largest change of the conserved quantity, and of kinetic and potential energy.
struct Change {
  double all = 0.0, of_bodies = 0.0;
};
Change change(const Scheme &scheme, int length, double h, const TargetOf &target_of,
              double time = 4.0)
{
  Host host = tied(scheme, length, h, target_of);
  const double before = all_energy(host);
  Change worst;
  host.run(time, [&] {
    const double potential = TiedBodies::springs(host.states).energy;
    worst.all = std::max(worst.all, std::fabs(all_energy(host) - before));
    worst.of_bodies =
        std::max(worst.of_bodies, std::fabs(potential + 0.5 * host.twice_kinetic() - before));
  });
  return worst;
}

/// From one temperature to another within a time.
TargetOf ramp(double from, double to, double time, double freedoms, double period)
{
  return [=](double t) {
    const double rate = (to - from) / time;
    return ChainTarget{from + rate * t, rate, freedoms, period};
  };
}

constexpr Formulation FORMULATIONS[] = {FIRST, SECOND};

}    // namespace

TEST(Chain, WhatItTakesIsWhatItsFrictionDoes)
{
  // E' = 2K xi_1 for every length, with a target that moves
  for (int length = 1; length <= Chain::LONGEST; ++length) {
    Check::Numbers numbers(length);
    const ChainTarget at = {0.7, 0.11, 9.0, 1.3};
    Chain::Variables y = {};
    for (int k = 0; k < length; ++k) y[k] = numbers.next();
    double twice = 4.2;
    const Chain chain(length);
    Chain::Variables rate = chain.rates(at, twice, y);
    const auto energy_at = [&](double t) {    // Eq. T3 along the tangent
      const double kt = at.kt + t * at.kt_rate;
      double sum = 0.0;
      for (int k = 0; k < length; ++k) {
        const double xi = y[k] + t * rate[k];
        sum += 0.5 * (k == 0 ? at.freedoms : 1.0) * kt * at.period * at.period * xi * xi;
      }
      return sum + y[length] + t * rate[length];
    };
    const auto balanced = [&] {
      double slope;
      Check::derivative(
          [&](double t, double *out) {
            *out = energy_at(t);
          },
          1, 1.0e-3, &slope);
      return std::fabs(slope - twice * y[0]) < 1.0e-9;
    };
    vector<double *> needed = {&twice};
    for (int k = 0; k <= length; ++k) needed.push_back(&rate[k]);
    Check::holds_and_needs(needed, balanced);
  }
}

TEST(Chain, FollowsAKineticEnergyAsAReferenceSolution)
{
  const double period = 0.8, freedoms = 5.0, until = 4.0;
  const TargetOf target = ramp(1.0, 1.6, until, freedoms, period);
  const auto twice = [&](double t) {
    return 6.0 + 2.0 * std::sin(1.7 * t);
  };
  constexpr int LENGTH = 3;
  const auto rates_ld = [&](double damp) {
    return [&, damp](long double t, const std::array<long double, 4> &y) {
      const long double kt = 1.0L + 0.6L * t / until, rate = 0.6L / until, g = freedoms;
      const long double per = 1.0L / (damp * damp);
      const long double moving =
          0.5L * kt * damp * damp * (g * y[0] * y[0] + y[1] * y[1] + y[2] * y[2]);
      return std::array<long double, 4>{
          ((6.0L + 2.0L * std::sin(1.7 * double(t))) / (g * kt) - 1.0L) * per - y[0] * y[1],
          g * y[0] * y[0] - per - y[1] * y[2], y[1] * y[1] - per,
          kt * (g * y[0] + y[1] + y[2]) - moving * rate / kt};
    };
  };
  const auto exact = runge_kutta<4>(rates_ld(period), {}, until, 40000);
  const auto other = runge_kutta<4>(rates_ld(1.01 * period), {}, until, 40000);

  for (int n = 4; n <= 8; ++n) {
    vector<double> errors;
    const vector<double> steps = Check::halvings(0.1, 3);
    const Fractions fractions = first_order_coefficients(n);
    vector<double> c;
    for (const auto &one : fractions) c.push_back(one.value());
    for (const double h : steps) {
      Chain chain(LENGTH);
      // rows by a fit to short reference solutions around the start
      const Collocation collocation(n);
      vector<Collocation::Scalar> s(chain.size());
      const auto at = [&](double t, const Chain::Variables &y) {
        return chain.rates(target(t), twice(t), y);
      };
      auto rate = at(0.0, chain.values());
      for (int v = 0; v < chain.size(); ++v) collocation.begin(0.0, rate[v], s[v]);
      for (int outer = 1; outer <= collocation.pairs(); ++outer) {
        for (auto &one : s) collocation.foretell(one);
        for (int round = 0; round < 30; ++round)
          for (int pair = 1; pair <= outer; ++pair) {
            for (const int node : {-pair, pair}) {
              Chain::Variables y = {};
              for (int v = 0; v < chain.size(); ++v) y[v] = collocation.value_at(node, s[v], h);
              rate = at(node * h, y);
              for (int v = 0; v < chain.size(); ++v) collocation.set_rate(node, rate[v], s[v]);
            }
            for (auto &one : s) collocation.settle(pair, one);
          }
      }
      vector<double> series(collocation.number_of_nodes() + 1);
      for (int v = 0; v < chain.size(); ++v) {
        const int terms = collocation.integrate(s[v].rate, collocation.pairs(), h, series.data());
        chain.seed(v, series.data(), terms, h, h);
      }
      for (long k = 1; k <= std::lround(until / h); ++k) {
        chain.predict(n);
        for (int pass = 0; pass < 2; ++pass)
          chain.correct(target(k * h), twice(k * h), h, n, c.data());
        chain.conclude(n);
      }
      double error = 0.0;
      for (int v = 0; v < chain.size(); ++v)
        error = std::max(error, std::fabs(chain.values()[v] - double(exact[v])));
      errors.push_back(error);
    }
    EXPECT_GT(slopes(steps, errors)[2], n - 0.4) << n;
    EXPECT_LT(errors[3], 2.0e-4) << n;
  }
  // a damping time 1 % off would be seen
  EXPECT_GT(std::fabs(double(exact[0] - other[0])), 2.0e-3);
}

TEST(Chain, ConservedQuantityToTheOrderOfTheMethod)
{
  for (const Formulation formulation : FORMULATIONS)
    for (const bool tuned : {false, true})
      for (int values = 5; values <= (formulation == FIRST ? 8 : 9); ++values) {
        const Scheme scheme = with(formulation, values, tuned);
        const double wide = 0.04, narrow = 0.02;
        const TargetOf targets[] = {constant_target(0.5, 12.0, 0.7),
                                    ramp(0.4, 0.8, 4.0, 12.0, 0.7)};
        const double alone = std::log2(change(scheme, 0, wide, targets[0]).all /
                                       change(scheme, 0, narrow, targets[0]).all);
        for (const auto &target : targets) {
          const Change coarse = change(scheme, 3, wide, target),
                       fine = change(scheme, 3, narrow, target);
          EXPECT_GT(std::log2(coarse.all / fine.all), std::min(alone, 1.0 * values) - 0.5)
              << scheme << (tuned ? ", tuned" : ", gear");
          EXPECT_LT(fine.all, 1.0e-4 * fine.of_bodies) << scheme;
        }
      }
}

TEST(Chain, FreeBodiesReachATargetAsTheEquationsSay)
{
  // without forces p = p_0 exp(-int xi): K and the chain are a closed system
  const double until = 6.0, period = 0.9;
  for (const bool ramped : {false, true}) {
    const double from = ramped ? 0.5 : 1.1, to = 1.1;
    const TargetOf target = ramp(from, to, until, 6.0, period);
    const vector<RigidBody> bodies = {{1.4, {1.3, 1.3, 1.3}}};
    const vector<BodyState> states = {{{}, {0, 0, 0, 1}, {0.5, -0.3, 0.6}, {0.4, 0.7, -0.2}}};
    const auto reference = [&](double factor) {
      const Host host{bodies, states, nullptr, target, with(SECOND, 8, false), 3, 0.1};
      const long double twice_at_start = host.twice_kinetic(), damp = period * factor;
      return runge_kutta<4>(
          [&](long double t, const std::array<long double, 4> &y) {
            const long double kt = from + (to - from) * t / until, per = 1.0L / (damp * damp);
            const long double twice = twice_at_start * std::exp(-2.0L * y[3]);
            return std::array<long double, 4>{(twice / (6.0L * kt) - 1.0L) * per - y[0] * y[1],
                                              6.0L * y[0] * y[0] - per - y[1] * y[2],
                                              y[1] * y[1] - per, y[0]};
          },
          {}, until, 40000);
    };
    const auto exact = reference(1.0), other = reference(1.01);
    for (const Formulation formulation : FORMULATIONS) {
      const Scheme scheme = with(formulation, 8, false);
      vector<double> errors;
      for (const double h : {0.05, 0.025}) {
        Host host{bodies,
                  states,
                  [](const vector<BodyState> &) {
                    return vector<Load>(1, Load{});
                  },
                  target,
                  scheme,
                  3,
                  h};
        host.run(until, [] {
        });
        errors.push_back(std::fabs(host.states[0].velocity[0] - 0.5 * std::exp(-double(exact[3]))) +
                         std::fabs(host.chain.friction() - double(exact[0])));
      }
      EXPECT_LT(errors[1], 1.0e-6);
      EXPECT_GT(std::log2(errors[0] / errors[1]), 6.5) << errors[0] << " " << errors[1];
    }
    EXPECT_GT(std::fabs(double(exact[0] - other[0])), 1.0e-3);
  }
}

TEST(Chain, AnotherStepIsAnotherUnitOfTheRows)
{
  const TargetOf target = constant_target(0.5, 12.0, 0.7);
  const Scheme scheme = with(SECOND, 8, false);
  for (const double ratio : {0.7, 1.3}) {
    Host host = tied(scheme, 3, 0.02, target);
    const double before = all_energy(host);
    host.run(1.0, [] {
    });
    host.h *= ratio;
    host.steps = 0;
    host.integrator.set_step(host.h);
    host.integrator.rescale(host.rows[0].data(), ratio);
    host.integrator.rescale(host.rows[1].data(), ratio);
    host.chain.rescale(ratio);
    for (int n = 0; n < 50; ++n) host.step();
    EXPECT_LT(std::fabs(all_energy(host) - before), 1.0e-7) << ratio;
  }
}

TEST(Chain, ARecordIsTheChain)
{
  Host host = tied(with(SECOND, 8, false), 3, 0.02, constant_target(0.5, 12.0, 0.7));
  host.run(1.0, [] {
  });
  Chain other(3);
  other.restore(host.chain.record());
  EXPECT_EQ(other.record(), host.chain.record());
  EXPECT_EQ(other.energy(host.target_of(0.0)), host.chain.energy(host.target_of(0.0)));
  EXPECT_NE(other.friction(), 0.0);
}

TEST(Chain, OtherDegreesOfFreedomLeaveItsEnergyAndChangeItsDerivatives)
{
  const TargetOf target = constant_target(0.5, 12.0, 0.7);
  Host host = tied(with(SECOND, 8, false), 3, 0.02, target);
  host.run(1.0, [] {
  });
  const ChainTarget before = target(0.0), more = {0.5, 0.0, 18.0, 0.7};
  const Chain was = host.chain;
  host.chain.replace_target(before, more, 9.3, 0.02);
  EXPECT_DOUBLE_EQ(host.chain.energy(more), was.energy(before));
  EXPECT_EQ(host.chain.friction(), was.friction());
  EXPECT_GT(std::fabs(was.energy(more) - was.energy(before)), 1.0e-2);
  const auto y = host.chain.values(), rate = host.chain.rates(more, 9.3, y);
  const auto rows = host.chain.record();
  for (int v = 0; v < host.chain.size(); ++v) {
    EXPECT_DOUBLE_EQ(rows[v * (MAX_VALUES + 1) + 1], 0.02 * rate[v]);
  }
}

TEST(Chain, WithoutDegreesOfFreedomNothingMoves)
{
  const Chain chain(3);
  for (const double rate : chain.rates({1.0, 0.0, 0.0, 1.0}, 0.0, chain.values()))
    EXPECT_EQ(rate, 0.0);
}
