/* Bodies in a moving cell: `Host` replaces gear_quat_barostat and the start. */

#pragma once

#include "checks.h"
#include "drive.h"

#include "gear_quat_cell.h"
#include "gear_quat_chain.h"
#include "gear_quat_integrator.h"

namespace InACell {

using namespace Drive;
using std::vector;

/// Rows and columns of the components of Upper.
constexpr int ROW[] = {0, 1, 2, 1, 0, 0}, COLUMN[] = {0, 1, 2, 2, 2, 1};

/// All nine components, row by row.
inline vector<double> full(const Upper &u)
{
  vector<double> all(9, 0.0);
  for (int k = 0; k < Upper::SIZE; ++k) all[3 * ROW[k] + COLUMN[k]] = u[k];
  return all;
}

inline Scheme with(Formulation formulation, int values)
{
  return scheme_of(formulation, values, 2);
}

/// Forces on centers and torques in space, the virial sum F_a R_b about the fixed point 0, energy.
struct Met {
  vector<Load> loads;
  Upper virial;
  double energy;
};
using MetIn = std::function<Met(const vector<BodyState> &states, const Upper &matrix)>;

/// The equations of motion of the cell (doc/theory.md, Eqs. P1 to P9), for the free components.
struct Law {
  std::array<bool, Upper::SIZE> on = {true, true, true, false, false, false};
  bool alike = false;    ///< the diagonal has the mean of its right-hand sides
  double b[3] = {};
  double mass = 1.0;    ///< W, at the time 0
  Upper pressure, pressure_rate;
  double volume = 1.0;    ///< with M = 1
  double kt = 1.0, kt_rate = 0.0;
  int chain = 0, box_chain = 0;    ///< lengths; 0: none
  double freedoms = 1.0, period = 1.0, box_period = 1.0;
  double turning = 0.0;    ///< degrees of freedom of rotation, if it has its own chain

  Upper pressures(double t) const { return pressure + pressure_rate.scaled(t); }
  double mass_at(double t) const { return mass * (1.0 + t * kt_rate / kt); }
  double free_components() const { return alike ? 1.0 : std::count(on.begin(), on.end(), true); }
  static double mean(const Upper &p) { return p.trace() / 3.0; }

  /// G' without friction of the cell.  kinetic: sum m v_a v_b
  Upper drive(double t, const Upper &matrix, const Upper &kinetic, const Upper &virial) const
  {
    Upper found;
    const double v = volume * matrix.determinant();
    const Upper p = pressures(t);
    for (int k = 0; k < Upper::SIZE; ++k) {
      if (!on[k]) continue;
      found[k] = kinetic[k] + virial[k] - v * p[k];
      if (k < 3) found[k] += b[k] * kinetic.trace();
      found[k] /= mass_at(t);
    }
    if (alike) found[0] = found[1] = found[2] = found.trace() / 3.0;
    return found;
  }
  double twice_box(double t, const Upper &rate) const { return mass_at(t) * rate.contracted(rate); }
  /// S' of Eq. P7
  double heat_rate(double t, const Upper &matrix, const Upper &rate) const
  {
    const Upper p = pressures(t);
    const double v = volume * matrix.determinant();
    return v * (p.contracted(rate) - mean(p) * rate.trace() - mean(pressure_rate)) -
        0.5 * kt_rate / kt * mass * rate.contracted(rate);
  }
  ChainTarget target(double t) const { return {kt + kt_rate * t, kt_rate, freedoms, period}; }
  ChainTarget turning_target(double t) const
  {
    return {kt + kt_rate * t, kt_rate, turning, period};
  }
  ChainTarget box_target(double t) const
  {
    return {kt + kt_rate * t, kt_rate, free_components(), box_period};
  }
};

struct Host {
  vector<RigidBody> bodies;
  vector<BodyState> scaled;    ///< scaled states in histories
  MetIn met_in;
  Law law;
  Scheme scheme;
  double h;
  Upper rate = {};    ///< G

  Integrator integrator{scheme, h};
  CellHistory cell{scheme};
  Chain chain{std::max(law.chain, 1)}, turning{std::max(law.chain, 1)},
      box_chain{std::max(law.box_chain, 1)};
  ScalarHistory heat{};
  vector<vector<double>> rows{};
  Upper matrix = Upper::one();
  Met met{};
  long steps = 0;
  /// A mutant: all nodes of a start use the first cell.
  bool frozen_nodes = false;

  double time() const { return steps * h; }

  vector<BodyState> states() const
  {
    vector<BodyState> found = scaled;
    for (size_t b = 0; b < scaled.size(); ++b) {
      matrix.times(scaled[b].center, found[b].center);
      matrix.times(scaled[b].velocity, found[b].velocity);
    }
    return found;
  }
  Upper kinetic() const
  {
    Upper sum;
    double v[3];
    for (size_t b = 0; b < scaled.size(); ++b) {
      matrix.times(scaled[b].velocity, v);
      for (int k = 0; k < Upper::SIZE; ++k) sum[k] += bodies[b].mass * v[ROW[k]] * v[COLUMN[k]];
    }
    return sum;
  }
  double twice_turning() const
  {
    double sum = 0.0;
    for (size_t b = 0; b < scaled.size(); ++b)
      sum += 2.0 * rotational_energy(bodies[b], scaled[b].omega_body);
    return sum;
  }
  double twice_kinetic() const { return kinetic().trace() + twice_turning(); }
  double volume() const { return law.volume * matrix.determinant(); }

  /// H'
  double conserved() const
  {
    const double t = time();
    double sum = met_in(states(), matrix).energy + 0.5 * twice_kinetic() +
        0.5 * law.twice_box(t, rate) + Law::mean(law.pressures(t)) * volume() + heat.value();
    if (law.chain) sum += chain.energy(law.target(t));
    if (law.box_chain) sum += box_chain.energy(law.box_target(t));
    return sum;
  }

  Load scaled_load(const Load &load) const
  {
    Load found = load;
    matrix.inverse().times(load.force, found.force);
    return found;
  }
  Friction friction(double xi) const { return friction(xi, xi); }
  Friction friction(double xi, double of_turning) const
  {
    Friction alpha = Multipliers{xi, of_turning};
    alpha.implicit = true;
    return friction_in_cell(alpha, matrix, rate, law.b);
  }

  // the start: `pairs` of nodes, each in its own cell

  struct Search {
    Host &our;
    Collocation collocation;
    vector<BodyState> at_start;
    vector<Collocation::Workspace> work;
    Collocation::Nodes cell = {};
    Collocation::Scalar twice = {}, twice_box = {}, heat = {};

    Search(Host &our) :
        our(our), collocation(our.scheme.start_values()), at_start(our.scaled),
        work(our.bodies.size())
    {
    }
    ChainDrive drive_of(const Collocation::Scalar &sums) const
    {
      vector<double> at;
      for (int k = -sums.pairs; k <= sums.pairs; ++k) at.push_back(k);
      return ChainDrive::through(at.size(), at.data(),
                                 collocation.rate_at_start(sums) - sums.pairs);
    }
    /// Loads with friction, and the acceleration of the cell.
    Upper meet(double xi, double box_xi, double t, vector<Load> &loads)
    {
      our.met = our.met_in(our.states(), our.matrix);
      loads.clear();
      for (size_t b = 0; b < our.bodies.size(); ++b)
        loads.push_back(damped_load(our.bodies[b], our.scaled[b], our.scaled_load(our.met.loads[b]),
                                    our.friction(xi)));
      const Upper drive = our.law.drive(t, our.matrix, our.kinetic(), our.met.virial);
      return CellHistory::acceleration(our.matrix, our.rate, drive, box_xi).scaled(our.h * our.h);
    }
    void begin()
    {
      vector<Load> loads;
      const Upper second = meet(our.chain.friction(), our.box_chain.friction(), 0.0, loads);
      for (size_t b = 0; b < work.size(); ++b)
        collocation.begin(our.bodies[b],
                          local_series(our.bodies[b], our.scaled[b], loads[b], our.h), work[b]);
      collocation.begin(our.matrix.m.data(), (our.rate * our.matrix).scaled(our.h).m.data(),
                        second.m.data(), cell);
      collocation.begin(0.0, our.twice_kinetic(), twice);
      collocation.begin(0.0, our.law.twice_box(0.0, our.rate), twice_box);
      collocation.begin(0.0, our.law.heat_rate(0.0, our.matrix, our.rate), heat);
    }
    void foretell()
    {
      for (auto &w : work) collocation.foretell(w);
      collocation.foretell(cell);
      collocation.foretell(twice);
      collocation.foretell(twice_box);
      collocation.foretell(heat);
    }
    void visit(int node)
    {
      const double h = our.h, t = node * h;
      for (size_t b = 0; b < work.size(); ++b)
        our.scaled[b] = collocation.state_at(node, work[b], h);
      Upper value, first;
      collocation.values_at(node, cell, value.m.data(), first.m.data());
      if (!our.frozen_nodes) our.matrix = value;
      our.rate = first.scaled(1.0 / h) * value.inverse();
      const double xi =
          our.law.chain ? our.chain.flow(our.law.target(0.0), drive_of(twice), h, node).y[0] : 0.0;
      const double box_xi = our.law.box_chain
          ? our.box_chain.flow(our.law.box_target(0.0), drive_of(twice_box), h, node).y[0]
          : 0.0;
      vector<Load> loads;
      const Upper second = meet(xi, box_xi, t, loads);
      for (size_t b = 0; b < work.size(); ++b)
        collocation.set_load(node, our.bodies[b], our.scaled[b], loads[b], h, 1.0, work[b]);
      collocation.set_rates(node, second.m.data(), cell);
      collocation.set_rate(node, our.twice_kinetic(), twice);
      collocation.set_rate(node, our.law.twice_box(t, our.rate), twice_box);
      collocation.set_rate(node, our.law.heat_rate(t, our.matrix, our.rate), heat);
    }
    void settle(int pair)
    {
      for (auto &w : work) collocation.settle(pair, w);
      collocation.settle(pair, cell);
      collocation.settle(pair, twice);
      collocation.settle(pair, twice_box);
      collocation.settle(pair, heat);
    }
    void seed_all(int pairs)
    {
      const double h = our.h;
      const int n = our.scheme.values();
      for (size_t b = 0; b < work.size(); ++b)
        Drive::seed(our.scheme, our.bodies[b], collocation.series(work[b], pairs), h, h,
                    our.rows[b].data());
      double of_cell[Upper::SIZE * TaylorSeries::MAX_TERMS];
      collocation.expand(cell, pairs, of_cell);
      our.cell.seed(of_cell, Collocation::terms_of(pairs), h, h);
      our.chain.seed(collocation.rate_at_start(twice), pairs, h, n + 1);
      our.box_chain.seed(collocation.rate_at_start(twice_box), pairs, h, n + 1);
      double of_heat[Collocation::MAX_NODES + 1];
      const int terms = collocation.series(heat, pairs, h, of_heat);
      our.heat.seed(of_heat, terms, h, h, our.heat_scheme().values());
    }
  };

  Scheme heat_scheme() const
  {
    Scheme found = scheme_of(FIRST, std::min(scheme.values(), FIRST_MOST));
    return found;
  }

  /// pairs 0: as many as the order requires.
  void start(int pairs = 0)
  {
    Search search(*this);
    const Upper first_rate = rate;
    if (pairs == 0) pairs = search.collocation.pairs();
    search.begin();
    for (int outer = 1; outer <= pairs; ++outer) {
      search.foretell();
      for (int round = 0; round < 6; ++round)
        for (int pair = 1; pair <= outer; ++pair) {
          for (const int node : {-pair, pair}) search.visit(node);
          search.settle(pair);
        }
    }
    rows.assign(bodies.size(), vector<double>(scheme.size()));
    search.seed_all(pairs);
    scaled = search.at_start;
    matrix = Upper::one();
    rate = first_rate;
  }

  void step()
  {
    ++steps;
    cell.predict();
    matrix = cell.matrix();
    rate = cell.rate(h);
    for (size_t b = 0; b < bodies.size(); ++b) {
      integrator.predict(bodies[b], rows[b].data());
      scaled[b] = integrator.body_state(bodies[b], rows[b].data());
    }
    met = met_in(states(), matrix);
    for (int sum = 0; sum < (scheme.momentum() ? 1 : 3); ++sum) {
      for (size_t b = 0; b < bodies.size(); ++b) {
        vector<double> copy = rows[b];
        integrator.correct(bodies[b], scaled_load(met.loads[b]), copy.data(),
                           scheme.momentum() ? Friction() : present_friction());
        scaled[b] = integrator.body_state(bodies[b], copy.data());
      }
      find_friction();
    }
    correct();
    finish();
  }
  void advance_chains(double twice, double of_turning, double of_box)
  {
    const int n = scheme.values();
    const double before = time() - h;
    if (law.chain) { ASSERT_TRUE(chain.advance(law.target(before), twice, h, n)); }
    if (law.turning > 0.0) {
      ASSERT_TRUE(turning.advance(law.turning_target(before), of_turning, h, n));
    }
    if (law.box_chain) { ASSERT_TRUE(box_chain.advance(law.box_target(before), of_box, h, n)); }
  }
  Friction present_friction() const
  {
    const double xi = law.chain ? chain.friction() : 0.0;
    return friction(xi, law.turning > 0.0 ? turning.friction() : xi);
  }
  void correct()
  {
    for (size_t b = 0; b < bodies.size(); ++b) {
      integrator.correct(bodies[b], scaled_load(met.loads[b]), rows[b].data(), present_friction());
      scaled[b] = integrator.body_state(bodies[b], rows[b].data());
    }
  }
  void find_friction()
  {
    const double share = integrator.share(), free_turning = twice_turning();
    const Upper free = kinetic(), to_scaled = matrix.inverse();
    for (int round = 0; round < 6; ++round) {
      const Friction now = present_friction();
      const Upper left = (Upper::one() + now.damping.scaled(share)).inverse();
      const Upper tensor = (matrix * left * to_scaled).congruent(free);
      const double twice = now.implicit_torque(share) * now.implicit_torque(share) * free_turning;
      advance_chains(law.turning > 0.0 ? tensor.trace() : tensor.trace() + twice, twice,
                     law.twice_box(time(), rate));
      cell.pass(law.drive(time(), matrix, tensor, met.virial),
                law.box_chain ? box_chain.friction() : 0.0, h);
      matrix = cell.matrix();
      rate = cell.rate(h);
    }
  }
  void finish()
  {
    if (law.chain) chain.conclude();
    if (law.turning > 0.0) turning.conclude();
    if (law.box_chain) box_chain.conclude();
    cell.finish();
    matrix = cell.matrix();
    rate = cell.rate(h);
    const Scheme of_heat = heat_scheme();
    heat.advance(CorrectorCoefficients(of_heat).c.data(), of_heat.values(), h,
                 law.heat_rate(time(), matrix, rate));
  }

  /// Removes the common motion of scaled centers: it is rounding, which may grow in some histories.
  void rest()
  {
    const int n = scheme.values();
    double all = 0.0;
    for (const auto &body : bodies) all += body.mass;
    for (int j = 1; j < n; ++j)
      for (int k = 0; k < 3; ++k) {
        double sum = 0.0;
        for (size_t b = 0; b < bodies.size(); ++b)
          sum += bodies[b].mass * rows[b][j * scheme.width() + k];
        for (auto &one : rows) one[j * scheme.width() + k] -= sum / all;
      }
  }

  /// Calls watch() after each step.
  template <class Watch> void run(double until, Watch watch, int pairs = 0)
  {
    start(pairs);
    for (long n = std::lround(until / h); n > 0; --n) {
      step();
      watch();
    }
  }
};

}    // namespace InACell
