/* Bodies with one Nose-Hoover chain: `Host` replaces gear_quat_bath and the start. */

#pragma once

#include "checks.h"
#include "drive.h"

#include "gear_quat_chain.h"

namespace Thermostatted {

using namespace Drive;
using std::vector;

using LoadsOf = std::function<vector<Load>(const vector<BodyState> &)>;
using TargetOf = std::function<ChainTarget(double time)>;

struct Host {
  vector<RigidBody> bodies;
  vector<BodyState> states;
  LoadsOf loads_of;
  TargetOf target_of;
  Scheme scheme;
  int length;    ///< of the chain; 0: none
  double h;

  Integrator integrator{scheme, h};
  Chain chain{std::max(length, 1)};
  vector<vector<double>> rows{};
  long steps = 0;

  double time() const { return steps * h; }

  double twice_kinetic() const
  {
    double sum = 0.0;
    for (size_t b = 0; b < bodies.size(); ++b)
      sum += 2.0 * translational_energy(bodies[b], states[b].velocity) +
          2.0 * rotational_energy(bodies[b], states[b].omega_body);
    return sum;
  }

  /// Energy of the bodies and the chain without the potential energy.
  double kinetic_and_chain() const
  {
    return 0.5 * twice_kinetic() + (length ? chain.energy(target_of(time())) : 0.0);
  }

  /// All bodies and the chain, as the host of find_start().
  struct Search {
    Host &our;
    const Collocation &collocation;
    vector<BodyState> at_start;
    vector<Collocation::Workspace> work;
    Collocation::Scalar twice = {};

    Search(Host &our, const Collocation &collocation) :
        our(our), collocation(collocation), at_start(our.states), work(our.bodies.size())
    {
    }
    vector<Load> acting(double friction) const
    {
      vector<Load> loads = our.loads_of(our.states);
      const Friction alpha = Multipliers{friction, friction};
      for (size_t b = 0; b < loads.size(); ++b)
        loads[b] = damped_load(our.bodies[b], our.states[b], loads[b], alpha);
      return loads;
    }
    double friction_at(int node) const
    {
      if (!our.length || held) return our.chain.friction();
      vector<double> at;
      for (int k = -twice.pairs; k <= twice.pairs; ++k) at.push_back(k);
      const ChainDrive drive =
          ChainDrive::through(at.size(), at.data(), collocation.rate_at_start(twice) - twice.pairs);
      return our.chain.flow(our.target_of(our.time()), drive, our.h, node).y[0];
    }
    bool held = false;
    void begin(double)
    {
      our.states = at_start;
      const vector<Load> loads = acting(our.chain.friction());
      held = our.length &&
          our.chain.is_stiff(our.target_of(our.time()), our.twice_kinetic(), our.h,
                             collocation.pairs());
      for (size_t b = 0; b < work.size(); ++b)
        collocation.begin(our.bodies[b],
                          local_series(our.bodies[b], our.states[b], loads[b], our.h), work[b]);
      collocation.begin(0.0, our.twice_kinetic(), twice);
    }
    void foretell()
    {
      for (auto &w : work) collocation.foretell(w);
      collocation.foretell(twice);
    }
    int values_that_do(int values) const { return values; }
    bool visit(int pair, double &change)
    {
      change = 0.0;
      for (const int node : {-pair, pair}) {
        for (size_t b = 0; b < work.size(); ++b)
          our.states[b] = collocation.state_at(node, work[b], our.h);
        const vector<Load> loads = acting(friction_at(node));
        collocation.set_rate(node, our.twice_kinetic(), twice);
        for (size_t b = 0; b < work.size(); ++b)
          change = std::max(change,
                            collocation.set_load(node, our.bodies[b], our.states[b], loads[b],
                                                 our.h, 1.0, work[b]));
      }
      for (auto &w : work) collocation.settle(pair, w);
      collocation.settle(pair, twice);
      return true;
    }
  };

  void start()
  {
    const Collocation collocation(scheme.start_values());
    if (length) chain.begin_settled(target_of(0.0), twice_kinetic(), h);
    Search search(*this, collocation);
    const StartFound found = find_start(scheme.start_values(), h, search, StartPlan::COUPLED);
    states = search.at_start;
    ASSERT_EQ(found.spacing, h);
    rows.assign(bodies.size(), vector<double>(scheme.size()));
    for (size_t b = 0; b < bodies.size(); ++b)
      seed(scheme, bodies[b], collocation.series(search.work[b], found.pairs), h, h,
           rows[b].data());
    chain.seed(collocation.rate_at_start(search.twice), found.pairs, h, scheme.values() + 1);
  }

  void step()
  {
    const int n = scheme.values();
    ++steps;
    for (size_t b = 0; b < bodies.size(); ++b) {
      integrator.predict(bodies[b], rows[b].data());
      states[b] = integrator.body_state(bodies[b], rows[b].data());
    }
    const vector<Load> loads = loads_of(states);
    double xi = length ? chain.friction() : 0.0;
    const auto friction = [&] {
      Friction found = Multipliers{xi, xi};
      found.implicit = true;
      return found;
    };
    for (int sum = 0; sum < (scheme.momentum() ? 1 : 3) && length; ++sum) {
      for (size_t b = 0; b < bodies.size(); ++b) {
        vector<double> copy = rows[b];
        integrator.correct(bodies[b], loads[b], copy.data(),
                           scheme.momentum() ? Friction() : friction());
        states[b] = integrator.body_state(bodies[b], copy.data());
      }
      const double free = twice_kinetic();
      for (int round = 0; round < 6; ++round) {
        const double left = 1.0 / (1.0 + integrator.share() * xi);
        ASSERT_TRUE(chain.advance(target_of(time() - h), left * left * free, h, n));
        xi = chain.friction();
      }
    }
    for (size_t b = 0; b < bodies.size(); ++b) {
      integrator.correct(bodies[b], loads[b], rows[b].data(), friction());
      states[b] = integrator.body_state(bodies[b], rows[b].data());
    }
    if (length) chain.conclude();
  }

  /// Multiplies the step by this factor from now on.
  void change_step(double ratio)
  {
    steps = std::lround(time() / (h * ratio));    // not for targets that move
    h *= ratio;
    integrator.set_step(h);
    for (auto &one : rows) integrator.rescale(one.data(), ratio);
  }

  /// Calls watch() after each step.
  template <class Watch> void run(double until, Watch watch)
  {
    start();
    for (long n = std::lround(until / h); n > 0; --n) {
      step();
      watch();
    }
  }
};

inline TargetOf constant_target(double kt, double freedoms, double period)
{
  return [=](double) {
    return ChainTarget{kt, 0.0, freedoms, period};
  };
}

/// Solution of y' = f(t, y) at a time by the classical Runge-Kutta method, in long double.
template <size_t N, class F>
std::array<long double, N> runge_kutta(F f, std::array<long double, N> y, long double until,
                                       int steps)
{
  using Vector = std::array<long double, N>;
  const long double h = until / steps;
  const auto moved = [&](const Vector &rate, long double by) {
    Vector there = y;
    for (size_t i = 0; i < N; ++i) there[i] += by * rate[i];
    return there;
  };
  for (int n = 0; n < steps; ++n) {
    const long double t = n * h;
    const Vector a = f(t, y), b = f(t + h / 2, moved(a, h / 2)), c = f(t + h / 2, moved(b, h / 2)),
                 d = f(t + h, moved(c, h));
    for (size_t i = 0; i < N; ++i) y[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  return y;
}

}    // namespace Thermostatted
