/* Nose-Hoover chains: energy balance, response to the target compared with a reference solution,
   orders of the conserved quantity, step changes, and stiff chains far from the target. */

#include "chain_record.h"
#include "thermostatted.h"
#include "tied_bodies.h"

using namespace Thermostatted;
using Check::slopes;

namespace {

Scheme with(Formulation formulation, int values)
{
  return scheme_of(formulation, values, 2);
}

Host tied(const Scheme &scheme, int length, double h, const TargetOf &target_of)
{
  return Host{
      TiedBodies::BODIES, TiedBodies::at_start(), TiedBodies::loads, target_of, scheme, length, h};
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

}    // namespace

TEST(Chain, WhatItTakesIsWhatItsFrictionDoes)
{
  // E(1) - E(0) = integral of 2K xi_1, for every length, with a target that moves, forwards and
  // backwards
  for (int length = 1; length <= Chain::LONGEST; ++length)
    for (const double h : {0.3, -0.3}) {
      Check::Numbers numbers(length);
      const ChainTarget at = {0.7, 0.11, 9.0, 1.3};
      ChainRecord begun = {};
      for (int k = 0; k < length; ++k) begun.y[k] = numbers.next();
      Chain chain(length);
      begun.restore(chain);
      const double when[] = {-1.0, 0.0, 1.0}, twice[] = {4.2, 5.0, 4.7};
      const ChainDrive drive = ChainDrive::through(3, when, twice);
      const auto energy_after = [&](double until) {
        ChainTarget then = at;
        then.kt += at.kt_rate * h * until;
        Chain other(length);
        ChainRecord all = {};
        all.y = chain.flow(at, drive, h, until).y;
        all.restore(other);
        return other.energy(then);
      };
      // Gauss' rule of five points in ten pieces
      constexpr double NODES[] = {0.0, 0.5384693101056831, 0.9061798459386640},
                       WEIGHTS[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
      double work = 0.0;
      for (int piece = 0; piece < 10; ++piece)
        for (int i = 0; i < 5; ++i) {
          const int k = (i + 1) / 2;
          const double s = 0.1 * piece + 0.05 + 0.05 * (i % 2 ? NODES[k] : -NODES[k]);
          const double twice_then = drive.c[0] + s * (drive.c[1] + s * drive.c[2]);
          work += 0.05 * WEIGHTS[k] * h * twice_then * chain.flow(at, drive, h, s).y[0];
        }
      EXPECT_NEAR(energy_after(1.0) - energy_after(0.0), work, 1.0e-12);
    }
}

TEST(Chain, FollowsAKineticEnergyAsAReferenceSolution)
{
  const double period = 0.8, freedoms = 5.0, until = 4.0;
  const TargetOf target = ramp(1.0, 1.6, until, freedoms, period);
  const auto twice = [&](double t) {
    return 6.0 + 2.0 * std::sin(1.7 * t);
  };
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

  for (int n = 4; n <= 12; ++n) {
    vector<double> errors;
    const vector<double> steps = Check::halvings(n < 8 ? 0.1 : n < 11 ? 0.2 : 0.4, 3);
    for (const double h : steps) {
      Chain chain(3);
      const int pairs = (n + 1) / 2;
      vector<double> nodes;
      for (int k = -pairs; k <= pairs; ++k) nodes.push_back(twice(k * h));
      chain.seed(nodes.data() + pairs, pairs, h, n);
      for (long k = 1; k <= std::lround(until / h); ++k) {
        // a pass with another kinetic energy has no lasting effect
        ASSERT_TRUE(chain.advance(target((k - 1) * h), 1.01 * twice(k * h), h, n));
        ASSERT_TRUE(chain.advance(target((k - 1) * h), twice(k * h), h, n));
        chain.conclude();
      }
      double error = 0.0;
      for (int v = 0; v < chain.size(); ++v)
        error = std::max(error, std::fabs(chain.values()[v] - double(exact[v])));
      errors.push_back(error);
    }
    EXPECT_GT(slopes(steps, errors)[n < 8 ? 2 : 1], n - 0.4) << n;
    EXPECT_LT(errors[2], 2.0e-4) << n;
  }
}

TEST(Chain, ConservedQuantityToTheOrderOfTheMethod)
{
  for (const Formulation formulation : FORMULATIONS)
    for (int values = 5; values <= (formulation == FIRST ? 8 : 9); ++values) {
      const Scheme scheme = with(formulation, values);
      const TargetOf targets[] = {constant_target(0.5, 12.0, 0.7), ramp(0.4, 0.8, 4.0, 12.0, 0.7)};
      // one halving of the step, or two if the first error is too large
      const auto order = [&](int length, const TargetOf &target, Change &fine) {
        fine = change(scheme, length, 0.02, target);
        return std::max(std::log2(change(scheme, length, 0.04, target).all / fine.all),
                        0.5 * std::log2(change(scheme, length, 0.08, target).all / fine.all));
      };
      Change fine;
      const double alone = order(0, targets[0], fine);
      for (const auto &target : targets) {
        EXPECT_GT(order(3, target, fine), std::min(alone, 1.0 * values) - 0.5) << scheme;
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
      const Host host{bodies, states, nullptr, target, with(SECOND, 8), 3, 0.1};
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
    const auto exact = reference(1.0);
    for (const Formulation formulation : FORMULATIONS) {
      const Scheme scheme = with(formulation, 8);
      vector<double> errors;
      for (const double h : {0.1, 0.0125}) {    // three halvings
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
      EXPECT_GT(std::log2(errors[0] / errors[1]) / 3.0, 6.2) << errors[0] << " " << errors[1];
    }
  }
}

TEST(Chain, OtherStepsKeepTheConservedQuantity)
{
  const TargetOf target = constant_target(0.5, 12.0, 0.7);
  const Scheme scheme = with(SECOND, 8);
  for (const double ratio : {0.7, 1.3}) {
    Host host = tied(scheme, 3, 0.02, target);
    const double before = all_energy(host);
    host.run(1.0, [] {
    });
    host.change_step(ratio);
    for (int n = 0; n < 50; ++n) host.step();
    EXPECT_LT(std::fabs(all_energy(host) - before), 1.0e-7) << ratio;
  }
}

TEST(Chain, ARecordIsTheChain)
{
  const TargetOf target = constant_target(0.5, 12.0, 0.7);
  Host host = tied(with(SECOND, 8), 3, 0.02, target);
  host.run(1.0, [] {
  });
  Host other = host;
  other.chain = Chain(3);
  ChainRecord::of(host.chain).restore(other.chain);
  EXPECT_NE(other.chain.friction(), 0.0);
  for (Host *one : {&host, &other})
    for (int n = 0; n < 20; ++n) one->step();
  EXPECT_EQ(other.chain.values(), host.chain.values());
  EXPECT_EQ(other.rows, host.rows);
}

TEST(Chain, OtherDegreesOfFreedomLeaveItsEnergyAndItsFriction)
{
  const TargetOf target = constant_target(0.5, 12.0, 0.7);
  Host host = tied(with(SECOND, 8), 3, 0.02, target);
  host.run(1.0, [] {
  });
  const ChainTarget before = target(0.0), more = {0.5, 0.0, 18.0, 0.7};
  const Chain was = host.chain;
  const double twice = 1.5 * ChainRecord::of(was).sums[0];
  host.chain.join(before, more, twice);
  EXPECT_DOUBLE_EQ(host.chain.energy(more), was.energy(before));
  EXPECT_EQ(host.chain.friction(), was.friction());
  EXPECT_GT(std::fabs(was.energy(more) - was.energy(before)), 1.0e-2);
  // 2K per degree of freedom is as before, and so is the motion
  Chain still = was;
  ASSERT_TRUE(still.advance(before, 4.0, 0.02, 8));
  ASSERT_TRUE(host.chain.advance(more, 6.0, 0.02, 8));
  EXPECT_NEAR(host.chain.friction(), still.friction(), 1.0e-3 * std::fabs(still.friction()));
}

TEST(Chain, WithoutDegreesOfFreedomNothingMoves)
{
  Chain chain(3);
  ChainRecord some = {};
  some.y = {0.3, 0.2, 0.1, 7.0};
  some.restore(chain);
  EXPECT_TRUE(chain.advance({1.0, 0.0, 0.0, 1.0}, 0.0, 0.1, 8));
  EXPECT_EQ(chain.values(), some.y);
}

/* ----------------------------------------------------------------------
   far from the target, and with many degrees of freedom
------------------------------------------------------------------------- */

namespace {

/// An ideal gas: one point that has the kinetic energy of all g degrees of freedom.
Host gas(const Scheme &scheme, double freedoms, double kt, double target, double damp, int length,
         double h)
{
  const RigidBody point = {1.0, {0.0, 0.0, 0.0}};
  const BodyState moving = {{}, {0, 0, 0, 1}, {std::sqrt(freedoms * kt), 0.0, 0.0}, {}};
  return Host{{point},
              {moving},
              [](const vector<BodyState> &) {
                return vector<Load>(1, Load{});
              },
              constant_target(target, freedoms, damp),
              scheme,
              length,
              h};
}

/// Change of the conserved quantity in a gas, in units of g kT.
double gas_change(const Scheme &scheme, double freedoms, double kt, double target, double damp,
                  int length, double h, double time)
{
  Host host = gas(scheme, freedoms, kt, target, damp, length, h);
  const double before = host.kinetic_and_chain();
  double worst = 0.0;
  host.run(time, [&] {
    const double now = host.kinetic_and_chain();
    worst = std::isfinite(now) ? std::max(worst, std::fabs(now - before)) : HUGE_VAL;
  });
  return worst / (freedoms * std::max(kt, target));
}

}    // namespace

TEST(Chain, ManyDegreesOfFreedomDoNotMakeItUnstable)
{
  for (const Formulation formulation : FORMULATIONS)
    EXPECT_LT(gas_change(with(formulation, 8), 1.0e5, 1.0, 1.5, 25.0, 3, 1.0, 1000.0), 1.0e-4)
        << with(formulation, 8);
}

TEST(Chain, IsStableFarFromTheTargetWithAnyNumberOfVariables)
{
  for (const double freedoms : {30.0, 3.0e4, 1.0e6})
    for (const double ratio : {0.1, 0.95, 10.0})
      for (const double damp : {10.0, 100.0})
        for (const int length : {1, 2, 3, 10})
          EXPECT_LT(
              gas_change(with(MOMENTUM, 8), freedoms, ratio, 1.0, damp, length, 1.0, 5.0 * damp),
              damp > 10.0 ? 1.0e-4 : 0.05)
              << freedoms << " " << ratio << " " << damp << " " << length;
}

TEST(Chain, AStiffOneHasTheOrderOfTheMethod)
{
  for (const Formulation formulation : {FIRST, SECOND})
    for (const int values : {6, 8}) {
      const Scheme scheme = with(formulation, values);
      const vector<double> steps = Check::halvings(2.0, 2);
      vector<double> changes;
      for (const double h : steps)
        changes.push_back(gas_change(scheme, 1.0e5, 1.0, 1.5, 25.0, 3, h, 200.0));
      EXPECT_GT(slopes(steps, changes).back(), values - 1.0) << scheme;
    }
}

TEST(Chain, AStiffOneSurvivesJumpsOfTheTargetAndOfTheStep)
{
  Host host = gas(with(SECOND, 8), 1.0e5, 1.0, 1.5, 25.0, 3, 1.0);
  host.run(40.0, [] {
  });
  ASSERT_TRUE(host.chain.is_stiff(host.target_of(0.0), host.twice_kinetic(), host.h, 1));
  host.target_of = constant_target(0.5, 1.0e5, 25.0);
  const double jumped = host.kinetic_and_chain();
  for (int n = 0; n < 400; ++n) {
    host.change_step(n % 2 ? 1.25 : 0.8);
    host.step();
  }
  EXPECT_NEAR(host.kinetic_and_chain(), jumped, 1.0e-3 * jumped);
  EXPECT_NEAR(host.twice_kinetic(), 0.5e5, 0.1e5);
}

TEST(Chain, AKineticEnergyThatIsAbsurdIsNotFollowed)
{
  const ChainTarget target = {1.0, 0.0, 1.0e5, 1.0};
  for (const double twice : {1.0e25, 1.0e300}) {
    Chain chain(3);
    EXPECT_TRUE(chain.advance(target, 1.0e5, 0.1, 8));
    EXPECT_FALSE(chain.advance(target, twice, 0.1, 8)) << twice;
  }
}
