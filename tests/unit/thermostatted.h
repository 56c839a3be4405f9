/* Bodies under one Nose-Hoover chain: `Host` takes the place of gear_quat_thermostat and _bootstrap. */

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
  vector<Integrator::Pending> pending{};
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

  /// What the bodies and the chain have but for potential energy.
  double kinetic_and_chain() const
  {
    return 0.5 * twice_kinetic() + (length ? chain.energy(target_of(time())) : 0.0);
  }

  /// All bodies and the chain as the host of find_start().
  struct Search {
    Host &our;
    const Collocation &collocation;
    vector<BodyState> at_start;
    vector<Collocation::Workspace> work;
    vector<Collocation::Scalar> scalars;

    Search(Host &our, const Collocation &collocation) :
        our(our), collocation(collocation), at_start(our.states), work(our.bodies.size()),
        scalars(our.chain.size())
    {
    }
    vector<Load> acting(double friction) const
    {
      vector<Load> loads = our.loads_of(our.states);
      for (size_t b = 0; b < loads.size(); ++b)
        loads[b] =
            damped_load(our.bodies[b], our.states[b], loads[b], Multipliers{friction, friction});
      return loads;
    }
    Chain::Variables rates(double time, const Chain::Variables &y) const
    {
      return our.length ? our.chain.rates(our.target_of(time), our.twice_kinetic(), y)
                        : Chain::Variables();
    }
    void begin(double)
    {
      our.states = at_start;
      const auto y = our.chain.values(), rate = rates(0.0, y);
      const vector<Load> loads = acting(y[0]);
      for (size_t b = 0; b < work.size(); ++b)
        collocation.begin(local_series(our.bodies[b], our.states[b], loads[b], our.h), work[b]);
      for (size_t v = 0; v < scalars.size(); ++v) collocation.begin(y[v], rate[v], scalars[v]);
    }
    void foretell()
    {
      for (auto &w : work) collocation.foretell(w);
      for (auto &s : scalars) collocation.foretell(s);
    }
    bool visit(int pair, double &change)
    {
      change = 0.0;
      for (const int node : {-pair, pair}) {
        Chain::Variables y = {};
        for (size_t v = 0; v < scalars.size(); ++v)
          y[v] = collocation.value_at(node, scalars[v], our.h);
        for (size_t b = 0; b < work.size(); ++b)
          our.states[b] = collocation.state_at(node, work[b], our.h);
        const vector<Load> loads = acting(y[0]);
        const auto rate = rates(node * our.h, y);
        for (size_t v = 0; v < scalars.size(); ++v) collocation.set_rate(node, rate[v], scalars[v]);
        for (size_t b = 0; b < work.size(); ++b)
          change = std::max(change,
                            collocation.set_load(node, our.bodies[b], our.states[b], loads[b],
                                                 our.h, 1.0, work[b]));
      }
      for (auto &w : work) collocation.settle(pair, w);
      for (auto &s : scalars) collocation.settle(pair, s);
      return true;
    }
  };

  void start()
  {
    const Collocation collocation(scheme.start_values());
    Search search(*this, collocation);
    const StartFound found = find_start(scheme.start_values(), h, search);
    states = search.at_start;
    ASSERT_EQ(found.spacing, h);
    rows.assign(bodies.size(), vector<double>(scheme.size()));
    for (size_t b = 0; b < bodies.size(); ++b)
      seed(scheme, bodies[b], collocation.series(search.work[b], found.pairs), h, h,
           rows[b].data());
    vector<double> series(collocation.number_of_nodes() + 1);
    for (int v = 0; v < chain.size(); ++v) {
      const int terms =
          collocation.integrate(search.scalars[v].rate, found.pairs, h, series.data());
      chain.seed(v, series.data(), terms, h, h);
    }
    pending.resize(bodies.size());
  }

  void step()
  {
    const int n = scheme.values();
    ++steps;
    for (size_t b = 0; b < bodies.size(); ++b) {
      integrator.predict(rows[b].data());
      states[b] = integrator.body_state(bodies[b], rows[b].data());
    }
    if (length) chain.predict(n);
    const vector<Load> loads = loads_of(states);
    for (size_t b = 0; b < bodies.size(); ++b)
      pending[b] =
          integrator.begin(loads[b], integrator.axes_of(rows[b].data()).data(), rows[b].data());
    for (int pass = 0; pass < scheme.passes; ++pass) {
      if (length)
        chain.correct(target_of(time()), twice_kinetic(), h, n,
                      integrator.scalar_coefficients().data());
      const double xi = length ? chain.friction() : 0.0;
      for (size_t b = 0; b < bodies.size(); ++b) {
        integrator.correct_pass(bodies[b], loads[b], Multipliers{xi, xi}, rows[b].data(),
                                pending[b]);
        integrator.velocities_of_pass(bodies[b], rows[b].data(), pending[b], states[b].velocity,
                                      states[b].omega_body);
      }
    }
    if (length) chain.conclude(n);
    for (size_t b = 0; b < bodies.size(); ++b) {
      integrator.finish(loads[b], rows[b].data(), pending[b]);
      states[b] = integrator.body_state(bodies[b], rows[b].data());
    }
  }

  /// Calls what watches after each step.
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

/// Solution of y' = f(t, y) at a time by the classical Runge-Kutta method in long double.
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
