/* A moving cell: orders beside a reference solution of the equations in unscaled coordinates, and the
   balance of its energy. */

#include "in_a_cell.h"
#include "thermostatted.h"
#include "tied_bodies.h"

using namespace InACell;
using Check::slopes;

namespace {

// --- springs between sites, and to the fixed point, as in the tests of chains

Met springs(const vector<BodyState> &states, const Upper &)
{
  const auto all = TiedBodies::springs(states);
  Met met = {all.loads, Upper(), all.energy};
  for (size_t b = 0; b < states.size(); ++b)
    for (int k = 0; k < Upper::SIZE; ++k)
      met.virial[k] += all.loads[b].force[ROW[k]] * states[b].center[COLUMN[k]];
  return met;
}

enum Mode { ISO, UNEQUAL, TRICLINIC };

/// chains: of particles and cell, with targets that move; otherwise NPH.
Law law_of(Mode mode, bool chains)
{
  constexpr double TRANSLATION = 6.0;
  Law law;
  law.alike = mode == ISO;
  law.volume = 1.3;
  law.kt = 0.4;
  law.mass = 2.5;
  law.pressure = {{0.3, 0.3, 0.3, 0.0, 0.0, 0.0}};
  for (double &b : law.b) b = 1.0 / TRANSLATION;
  if (mode != ISO) law.pressure = {{0.3, -0.2, 0.5, 0.0, 0.0, 0.0}};
  if (mode == TRICLINIC) {
    law.on.fill(true);
    law.pressure = {{0.3, -0.2, 0.5, 0.1, -0.15, 0.2}};
    for (int k = 0; k < 3; ++k) law.b[k] = (3.0 - 2.0 * k) / TRANSLATION;
  }
  if (!chains) return law;
  law.chain = 3;
  law.box_chain = 3;
  law.freedoms = 12.0;
  law.period = 0.9;
  law.box_period = 1.4;
  law.kt_rate = 0.05;
  for (int k = 0; k < Upper::SIZE; ++k) law.pressure_rate[k] = law.on[k] ? 0.04 * (k + 1) : 0.0;
  if (mode == ISO) law.pressure_rate = {{0.1, 0.1, 0.1, 0.0, 0.0, 0.0}};
  return law;
}

Host tied(const Scheme &scheme, const Law &law, double h)
{
  Host host{TiedBodies::BODIES, TiedBodies::at_start(), springs, law, scheme, h};
  for (int k = 0; k < Upper::SIZE; ++k)
    if (law.on[k]) host.rate[k] = 0.1 * (k + 1) * (k % 2 ? -1 : 1);
  if (law.alike) host.rate = {{0.2, 0.2, 0.2, 0.0, 0.0, 0.0}};
  return host;
}

// --- the same in unscaled coordinates: R, v, axes and omega of both bodies, M, G, chains, S

using Real = long double;
constexpr size_t BODY = 18, M0 = 2 * BODY, G0 = M0 + 6, XI0 = G0 + 6, BOX0 = XI0 + 4,
                 HEAT = BOX0 + 4, SIZE = HEAT + 1;
using Vector = std::array<Real, SIZE>;

/// u * v for an upper triangular u in the order of Upper
void times(const Real *u, const Real *v, Real *out)
{
  out[0] = u[0] * v[0] + u[5] * v[1] + u[4] * v[2];
  out[1] = u[1] * v[1] + u[3] * v[2];
  out[2] = u[2] * v[2];
}

Vector beginning(const Host &host)
{
  Vector y = {};
  for (size_t b = 0; b < 2; ++b) {
    const BodyState &s = host.scaled[b];
    Real *of = &y[BODY * b];
    double a[9];
    rotation_matrix(s.q, dot4(s.q, s.q), a);
    for (int k = 0; k < 3; ++k) {
      of[k] = s.center[k];
      of[3 + k] = s.velocity[k];
      of[15 + k] = s.omega_body[k];
    }
    std::copy_n(a, 9, of + 6);
  }
  for (int k = 0; k < 6; ++k) {
    y[M0 + k] = k < 3;
    y[G0 + k] = host.rate[k];
  }
  return y;
}

struct Acting {
  Real force[2][3], arm[2][3], kinetic[6], virial[6], rotation, energy;
};
Acting acting(const Vector &y)
{
  Acting found = {};
  Real site[2][3];
  for (size_t b = 0; b < 2; ++b) {
    const Real *of = &y[BODY * b], *a = of + 6;
    const RigidBody &body = TiedBodies::BODIES[b];
    for (int k = 0; k < 3; ++k) {
      found.arm[b][k] = 0.0L;
      for (int i = 0; i < 3; ++i) found.arm[b][k] += TiedBodies::ARMS[b][i] * a[3 * i + k];
      site[b][k] = of[k] + found.arm[b][k];
      found.rotation += body.inertia[k] * of[15 + k] * of[15 + k];
    }
    for (int k = 0; k < 6; ++k) found.kinetic[k] += body.mass * of[3 + ROW[k]] * of[3 + COLUMN[k]];
  }
  for (size_t b = 0; b < 2; ++b) {
    for (int k = 0; k < 3; ++k) {
      const Real apart = site[1][k] - site[0][k];
      found.force[b][k] = (b == 0 ? apart : -apart) - site[b][k];
      found.energy += 0.5L * site[b][k] * site[b][k] + 0.25L * apart * apart;
    }
    for (int k = 0; k < 6; ++k) found.virial[k] += found.force[b][ROW[k]] * y[BODY * b + COLUMN[k]];
  }
  return found;
}

/// A chain of three and its S: 2K, freedoms, kT, its rate, tau.
void chain_rates(const Real *y, Real twice, Real g, Real kt, Real kt_rate, Real tau, Real *rate)
{
  const Real w = 1.0L / (tau * tau);
  rate[0] = (twice / (g * kt) - 1.0L) * w - y[0] * y[1];
  rate[1] = g * y[0] * y[0] - w - y[1] * y[2];
  rate[2] = y[1] * y[1] - w;
  rate[3] = kt * (g * y[0] + y[1] + y[2]) -
      0.5L * kt_rate / w * (g * y[0] * y[0] + y[1] * y[1] + y[2] * y[2]);
}

/// The equations of doc/theory.md, literally.
Vector flow(const Law &law, Real t, const Vector &y)
{
  Vector rate = {};
  const Acting now = acting(y);
  const Real *m = &y[M0], *g = &y[G0], xi = law.chain ? y[XI0] : 0.0L;
  const Real kt = law.kt + law.kt_rate * t, mass = law.mass * kt / law.kt;
  const Real trace = law.b[0] * g[0] + law.b[1] * g[1] + law.b[2] * g[2] + xi;
  const Real twice = now.kinetic[0] + now.kinetic[1] + now.kinetic[2];
  for (size_t b = 0; b < 2; ++b) {
    const RigidBody &body = TiedBodies::BODIES[b];
    const Real *of = &y[BODY * b], *a = of + 6, *w = of + 15, *d = now.arm[b], *f = now.force[b];
    Real *out = &rate[BODY * b], moved[3];
    times(g, of, moved);
    for (int k = 0; k < 3; ++k) out[k] = of[3 + k] + moved[k];
    times(g, of + 3, moved);
    for (int k = 0; k < 3; ++k) out[3 + k] = f[k] / body.mass - moved[k] - trace * of[3 + k];
    const Real torque[3] = {d[1] * f[2] - d[2] * f[1], d[2] * f[0] - d[0] * f[2],
                            d[0] * f[1] - d[1] * f[0]};
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      Real about = 0.0L;
      for (int c = 0; c < 3; ++c) {
        about += a[3 * i + c] * torque[c];
        out[6 + 3 * i + c] = w[k] * a[3 * j + c] - w[j] * a[3 * k + c];    // omega x axis i
      }
      out[15 + i] =
          (about + Real(body.inertia[j] - body.inertia[k]) * w[j] * w[k]) / body.inertia[i] -
          xi * w[i];
    }
  }
  const Real gm[6] = {g[0] * m[0],
                      g[1] * m[1],
                      g[2] * m[2],
                      g[1] * m[3] + g[3] * m[2],
                      g[0] * m[4] + g[5] * m[3] + g[4] * m[2],
                      g[0] * m[5] + g[5] * m[1]};
  const Real volume = law.volume * m[0] * m[1] * m[2];
  const Real box_xi = law.box_chain ? y[BOX0] : 0.0L;
  Real push[6], pressure[6], twice_box = 0.0L, mean = 0.0L;
  for (int k = 0; k < 6; ++k) {
    pressure[k] = law.pressure[k] + t * law.pressure_rate[k];
    if (k < 3) mean += pressure[k] / 3.0L;
    push[k] =
        now.kinetic[k] + now.virial[k] - volume * pressure[k] + (k < 3 ? law.b[k] * twice : 0);
  }
  if (law.alike) push[0] = push[1] = push[2] = (push[0] + push[1] + push[2]) / 3.0L;
  Real &heat = rate[HEAT];
  for (int k = 0; k < 6; ++k) {
    rate[M0 + k] = gm[k];
    if (!law.on[k]) continue;
    rate[G0 + k] = push[k] / mass - box_xi * g[k];
    twice_box += mass * g[k] * g[k];
    heat += volume * (pressure[k] - (k < 3 ? mean : 0.0L)) * g[k];
    if (k < 3) heat -= volume * law.pressure_rate[k] / 3.0L;
  }
  heat -= 0.5L * law.kt_rate / kt * twice_box;
  if (law.chain)
    chain_rates(&y[XI0], twice + now.rotation, law.freedoms, kt, law.kt_rate, law.period,
                &rate[XI0]);
  if (law.box_chain)
    chain_rates(&y[BOX0], twice_box, law.free_components(), kt, law.kt_rate, law.box_period,
                &rate[BOX0]);
  return rate;
}

/// H'
Real conserved(const Law &law, Real t, const Vector &y)
{
  const Acting now = acting(y);
  const Real kt = law.kt + law.kt_rate * t;
  const auto chain = [&](const Real *xi, Real g, Real tau) {
    return 0.5L * kt * tau * tau * (g * xi[0] * xi[0] + xi[1] * xi[1] + xi[2] * xi[2]) + xi[3];
  };
  Real mean = 0.0L, twice_box = 0.0L;
  for (int k = 0; k < 3; ++k) mean += (law.pressure[k] + t * law.pressure_rate[k]) / 3.0L;
  for (int k = 0; k < 6; ++k) twice_box += law.mass * kt / law.kt * y[G0 + k] * y[G0 + k];
  Real sum = now.energy + 0.5L * (now.kinetic[0] + now.kinetic[1] + now.kinetic[2] + now.rotation) +
      0.5L * twice_box + mean * law.volume * y[M0] * y[M0 + 1] * y[M0 + 2] + y[HEAT];
  if (law.chain) sum += chain(&y[XI0], law.freedoms, law.period);
  if (law.box_chain) sum += chain(&y[BOX0], law.free_components(), law.box_period);
  return sum;
}

constexpr double TIME = 1.0;

/// The final quantities compared: positions, axes, cell and its rate.
vector<double> end_of(const Law &law, int steps = 1000)
{
  const Vector y = Thermostatted::runge_kutta(
      [&](Real t, const Vector &at) {
        return flow(law, t, at);
      },
      beginning(tied(with(MOMENTUM, 7), law, 0.1)), Real(TIME), steps);
  vector<double> all;
  for (size_t b = 0; b < 2; ++b) {
    for (int k = 0; k < 3; ++k) all.push_back(y[BODY * b + k]);
    for (int k = 6; k < 15; ++k) all.push_back(y[BODY * b + k]);
  }
  all.insert(all.end(), y.begin() + M0, y.begin() + M0 + 12);
  return all;
}
vector<double> end_of(const Host &host)
{
  vector<double> all;
  for (const BodyState &s : host.states()) {
    double a[9];
    rotation_matrix(s.q, dot4(s.q, s.q), a);
    all.insert(all.end(), s.center, s.center + 3);
    all.insert(all.end(), a, a + 9);
  }
  all.insert(all.end(), host.matrix.m.begin(), host.matrix.m.end());
  all.insert(all.end(), host.rate.m.begin(), host.rate.m.end());
  return all;
}

struct Errors {
  double end, cell, energy;
};
Errors errors(const Scheme &scheme, const Law &law, double h, const vector<double> &exact,
              int pairs = 0, bool frozen = false)
{
  Host host = tied(scheme, law, h);
  host.frozen_nodes = frozen;
  const double before = host.conserved();
  Errors found = {};
  host.run(
      TIME,
      [&] {
        found.energy = std::max(found.energy, std::fabs(host.conserved() - before));
      },
      pairs);
  const vector<double> end = end_of(host);
  const size_t of_cell = end.size() - 12;
  found.end = Check::largest_difference(end, exact);
  found.cell = Check::largest_difference(end.data() + of_cell, exact.data() + of_cell, 12);
  return found;
}

}    // namespace

TEST(Cell, AllEquationsConserveTheEnergyAndOthersDoNot)
{
  // dH'/dt along the flow, by differences
  for (const Mode mode : {ISO, UNEQUAL, TRICLINIC})
    for (const bool chains : {false, true}) {
      const Law right = law_of(mode, chains);
      Host host = tied(with(MOMENTUM, 7), right, 0.1);
      Vector at = beginning(host);
      Check::Numbers numbers(17);
      for (size_t i = XI0; i < SIZE; ++i) at[i] = 0.3 * numbers.next();
      for (size_t i = 3; i < 6; ++i) at[M0 + i] = right.on[i] ? 0.2 * numbers.next() : 0.0;
      const Real t = 0.4;
      const auto change = [&](const Law &law) {
        const Vector rate = flow(law, t, at);
        Real found = 0.0L;
        for (const Real by : {1e-4L, 2e-4L}) {
          Vector there = at, back = at;
          for (size_t i = 0; i < SIZE; ++i) {
            there[i] += by * rate[i];
            back[i] -= by * rate[i];
          }
          const Real slope =
              (conserved(right, t + by, there) - conserved(right, t - by, back)) / (2.0L * by);
          found += (by < 1.5e-4L ? 4.0L : -1.0L) / 3.0L * slope;
        }
        return double(found);
      };
      EXPECT_LT(std::fabs(change(right)), 1e-9) << mode << chains;
    }
}

TEST(Cell, OrdersOfPositionBoxAndEnergyAreThoseOfTheScheme)
{
  for (const Mode mode : {ISO, UNEQUAL, TRICLINIC})
    for (const bool chains : {false, true}) {
      const Law law = law_of(mode, chains);
      const auto exact = end_of(law, 2000);
      for (const Formulation formulation : FORMULATIONS)
        for (int n = 5; n <= (formulation == FIRST ? 8 : 9); ++n) {
          const Scheme scheme = with(formulation, n);
          // longer steps where rounding would dominate, one more halving where signs differ
          const double wide = n < 7 ? 0.05 : 0.1, narrow = n < 9 ? 0.0125 : 0.025;
          const Errors first = errors(scheme, law, wide, exact);
          const Errors last = errors(scheme, law, narrow, exact);
          const double halvings = std::log2(wide / narrow);
          // with forces that depend on velocities the order is n - 1
          EXPECT_GT(std::log2(first.end / last.end) / halvings, n - 1.5)
              << scheme << mode << chains;
          EXPECT_GT(std::log2(first.cell / last.cell) / halvings, n - 1.8)
              << scheme << mode << chains;
          EXPECT_GT(std::log2(first.energy / last.energy) / halvings, n - 1.65)
              << scheme << mode << chains;
        }
    }
}

TEST(Cell, EachPairOfNodesOfAStartGainsTwoOrders)
{
  const Scheme scheme = with(MOMENTUM, 9);
  const auto order = [&](const Law &law, const vector<double> &exact, int pairs, bool frozen) {
    const double wide = errors(scheme, law, 0.05, exact, pairs, frozen).end;
    return 0.5 * std::log2(wide / errors(scheme, law, 0.0125, exact, pairs, frozen).end);
  };
  for (const Mode mode : {ISO, UNEQUAL, TRICLINIC})
    for (const bool chains : {false, true}) {
      const Law law = law_of(mode, chains);
      const auto exact = end_of(law, 2000);
      for (int pairs = 1; pairs <= 3; ++pairs) {
        EXPECT_GT(order(law, exact, pairs, false), 2.0 * pairs + 1.5) << mode << chains;
        // with the cell of the start at all nodes
        EXPECT_LT(order(law, exact, pairs, true), 2.5) << mode << chains;
      }
    }
}
