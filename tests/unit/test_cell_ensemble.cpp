/* The ensembles sampled by moving cells, where their distributions are known: rotors whose forces
   depend on scaled coordinates, and a cell with an elastic energy.  Energy is conserved with any
   weights b; these tests detect wrong weights. */

#include "in_a_cell.h"

using namespace InACell;

namespace {

constexpr int ROTORS = 4;
constexpr double KT = 1.0, PRESSURE = 1.0;

/// Block averages of a run, and their standard error.
class Mean {
 public:
  explicit Mean(long samples) : block(std::max(1L, samples / BLOCKS)) {}
  void add(double value)
  {
    sum += value;
    if (++count % block) return;
    blocks.push_back(sum / block);
    sum = 0.0;
  }
  double value() const
  {
    double all = 0.0;
    for (const double one : blocks) all += one;
    return all / blocks.size();
  }
  double error() const
  {
    double squares = 0.0;
    for (const double one : blocks) squares += (one - value()) * (one - value());
    return std::sqrt(squares / (blocks.size() * (blocks.size() - 1.0)));
  }

 private:
  static constexpr long BLOCKS = 40;
  long block, count = 0;
  double sum = 0.0;
  vector<double> blocks;
};

/// Waves of scaled coordinates, and their coupling to the third axes of bodies.
constexpr double WAVE = 1.0, TURN = 0.8;

Load scaled_force(const Upper &matrix, const double *along, const double *axis, const double *field)
{
  Load load;
  // F = M^-T of the force on a scaled center; U = C axis . field
  for (int k = 0; k < 3; ++k) {
    double unit[3] = {}, column[3];
    unit[k] = 1.0;
    matrix.inverse().times(unit, column);
    load.force[k] = dot3(column, along);
  }
  const double pull[3] = {-field[0], -field[1], -field[2]};
  cross3(axis, pull, load.torque_space);
  return load;
}
void third_axis(const BodyState &s, double *axis)
{
  double a[9];
  rotation_matrix(s.q, dot4(s.q, s.q), a);
  std::copy_n(a + 6, 3, axis);
}

/// U = sum_k A cos X_k + C axis_k cos X_k for each body: momentum is not conserved.
Met in_a_field(const vector<BodyState> &states, const Upper &matrix)
{
  Met met = {};
  for (const auto &s : states) {
    double x[3], axis[3], along[3], field[3];
    matrix.inverse().times(s.center, x);
    third_axis(s, axis);
    for (int k = 0; k < 3; ++k) {
      along[k] = (WAVE + TURN * axis[k]) * std::sin(x[k]);
      field[k] = TURN * std::cos(x[k]);
      met.energy += (WAVE + TURN * axis[k]) * std::cos(x[k]);
    }
    met.loads.push_back(scaled_force(matrix, along, axis, field));
  }
  return met;
}

/// U = sum over pairs (A + C axis . axis') sum_k cos (X_k - X_k'): momentum is conserved.
Met in_pairs(const vector<BodyState> &states, const Upper &matrix)
{
  const size_t n = states.size();
  Met met = {};
  vector<std::array<double, 3>> x(n), axis(n), along(n), field(n);
  for (size_t b = 0; b < n; ++b) {
    matrix.inverse().times(states[b].center, x[b].data());
    third_axis(states[b], axis[b].data());
  }
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < i; ++j) {
      double waves = 0.0;
      const double strength = WAVE + TURN * dot3(axis[i].data(), axis[j].data());
      for (int k = 0; k < 3; ++k) {
        const double apart = x[i][k] - x[j][k];
        waves += std::cos(apart);
        along[i][k] += strength * std::sin(apart);
        along[j][k] -= strength * std::sin(apart);
      }
      for (int k = 0; k < 3; ++k) {
        field[i][k] += TURN * waves * axis[j][k];
        field[j][k] += TURN * waves * axis[i][k];
      }
      met.energy += strength * waves;
    }
  for (size_t b = 0; b < n; ++b)
    met.loads.push_back(scaled_force(matrix, along[b].data(), axis[b].data(), field[b].data()));
  return met;
}

/// Elastic energy of the cell, K/4 |M^T M - 1|^2, independent of its orientation.
constexpr double STIFFNESS = 60.0;
Met elastic(const vector<BodyState> &states, const Upper &m)
{
  Met met = in_pairs(states, m);
  double full[3][3] = {}, c[3][3] = {}, by_matrix[3][3] = {};
  for (int k = 0; k < Upper::SIZE; ++k) full[ROW[k]][COLUMN[k]] = m[k];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) c[i][j] += full[k][i] * full[k][j];
      c[i][j] -= i == j;
      met.energy += 0.25 * STIFFNESS * c[i][j] * c[i][j];
    }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) by_matrix[i][j] += STIFFNESS * full[i][k] * c[k][j];
  for (int k = 0; k < Upper::SIZE; ++k)
    for (int l = 0; l < 3; ++l) met.virial[k] -= by_matrix[ROW[k]][l] * full[COLUMN[k]][l];
  return met;
}

/// weights: N_f b
Host rotors(const MetIn &met_in, double freedoms, bool conserved, bool flexible,
            const std::array<double, 3> &weights)
{
  const double h = flexible ? 0.04 : 0.08;
  Law law;
  law.alike = !flexible;
  law.kt = KT;
  law.volume = ROTORS;
  const double own = conserved ? 3.0 * (ROTORS - 1) : 3.0 * ROTORS;
  for (int k = 0; k < 3; ++k) {
    law.b[k] = weights[k] / freedoms;
    law.pressure[k] = flexible ? 0.0 : PRESSURE;
  }
  if (flexible) law.on.fill(true);
  law.mass = (flexible ? 3.0 : 1.0) * (own + 3.0) * KT / 3.0;
  law.chain = law.box_chain = 3;
  law.freedoms = own;
  law.turning = 3.0 * ROTORS;
  law.period = law.box_period = 0.7;
  const Scheme scheme = scheme_of(MOMENTUM, 5);
  Host host{{}, {}, met_in, law, scheme, h};
  Check::Numbers numbers(5);
  for (int b = 0; b < ROTORS; ++b) {
    const double size = 1.0 + 0.3 * b;
    host.bodies.push_back({size, {0.5 * size, 0.6 * size, 0.8 * size}});
    BodyState s = {};
    const auto q = numbers.unit_quaternion();
    std::copy(q.begin(), q.end(), s.q);
    for (int k = 0; k < 3; ++k) {
      s.center[k] = 2.0 * numbers.next();
      s.velocity[k] = 1.2 * numbers.next() / size;
      s.omega_body[k] = 1.5 * numbers.next();
    }
    host.scaled.push_back(s);
  }
  if (!conserved) return host;
  double momentum[3] = {}, all = 0.0;
  for (int b = 0; b < ROTORS; ++b) {
    all += host.bodies[b].mass;
    for (int k = 0; k < 3; ++k) momentum[k] += host.bodies[b].mass * host.scaled[b].velocity[k];
  }
  for (auto &s : host.scaled)
    for (int k = 0; k < 3; ++k) s.velocity[k] -= momentum[k] / all;
  return host;
}

struct Volumes {
  Mean mean, variance, box;
};
/// Of a run of this many thousand steps; exact: mean volume.
Volumes volumes(double freedoms, bool conserved, double exact, long thousands)
{
  Host host = rotors(conserved ? MetIn(in_pairs) : MetIn(in_a_field), freedoms, conserved, false,
                     {1.0, 1.0, 1.0});
  const long steps = 1000 * thousands;
  Volumes found = {Mean(steps), Mean(steps), Mean(steps)};
  host.start();
  for (long step = 0; step < 20000 + steps; ++step) {
    host.step();
    if (testing::Test::HasFatalFailure()) return found;
    if (conserved && step % 100 == 0) host.rest();
    if (step < 20000) continue;
    found.mean.add(host.volume());
    found.variance.add((host.volume() - exact) * (host.volume() - exact));
    found.box.add(host.law.twice_box(0.0, host.rate) / KT);
  }
  return found;
}

void expect(const Mean &found, double exact, double most)
{
  EXPECT_LT(std::fabs(found.value() - exact), 4.0 * found.error()) << found.value();
  EXPECT_LT(found.error(), most);
}
}    // namespace

TEST(CellEnsemble, VolumeOfRotorsWithTheirMomentumConserved)
{
  const Volumes right = volumes(3.0 * (ROTORS - 1), true, 4.0, 300);
  expect(right.mean, 4.0, 0.02);
  expect(right.variance, 4.0, 0.15);
  expect(right.box, 1.0, 0.01);
}

TEST(CellEnsemble, VolumeOfRotorsInAField)
{
  const Volumes right = volumes(3.0 * ROTORS, false, 5.0, 300);
  expect(right.mean, 5.0, 0.02);
  expect(right.variance, 5.0, 0.15);
  expect(right.box, 1.0, 0.01);
}

namespace {

struct Edges {
  Mean a2, b2, c2, box;
};
Edges edges(const std::array<double, 3> &weights, long thousands)
{
  Host host = rotors(elastic, 3.0 * (ROTORS - 1), true, true, weights);
  const long steps = 1000 * thousands;
  Edges found = {Mean(steps), Mean(steps), Mean(steps), Mean(steps)};
  host.start();
  for (long step = 0; step < 20000 + steps; ++step) {
    host.step();
    if (testing::Test::HasFatalFailure()) return found;
    if (step % 100 == 0) host.rest();
    if (step < 20000) continue;
    const Upper &m = host.matrix;
    found.a2.add(m[Upper::XX] * m[Upper::XX]);
    found.b2.add(m[Upper::XY] * m[Upper::XY] + m[Upper::YY] * m[Upper::YY]);
    found.c2.add(m[Upper::XZ] * m[Upper::XZ] + m[Upper::YZ] * m[Upper::YZ] +
                 m[Upper::ZZ] * m[Upper::ZZ]);
    found.box.add(host.law.twice_box(0.0, host.rate) / KT);
  }
  return found;
}

}    // namespace

TEST(CellEnsemble, AFlexibleCellDoesNotKnowItsOrientation)
{
  const Edges right = edges({3.0, 1.0, -1.0}, 300);
  const Edges plain = edges({1.0, 1.0, 1.0}, 100);
  const auto apart = [](const Mean &one, const Mean &other) {
    return std::fabs(one.value() - other.value()) / std::hypot(one.error(), other.error());
  };
  EXPECT_LT(
      std::max({apart(right.a2, right.b2), apart(right.b2, right.c2), apart(right.a2, right.c2)}),
      4.0);
  EXPECT_LT(std::max({right.a2.error(), right.b2.error(), right.c2.error()}), 0.005);
  EXPECT_LT(std::fabs(right.box.value() - 6.0), 4.0 * right.box.error());
  EXPECT_LT(right.box.error(), 0.06);
  // the trace term of a cell with three edges
  EXPECT_GT(apart(plain.a2, plain.c2), 6.0);
}
