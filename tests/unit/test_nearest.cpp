/* gear_quat_shapes.h: the rigid motion nearest to displacements of sites. */

#include "checks.h"
#include "gear_quat_shapes.h"

using namespace LAMMPS_NS::GearQuat;
using std::vector;

namespace {

using Vectors = vector<vector<double>>;

/// The displacement of a site by a twist.
void way_of_site(const Twist &twist, const vector<double> &arm, double *out)
{
  cross3(twist.turn, arm.data(), out);
  add3(twist.way, out);
}

/// Random arms, whose mean is not the center of mass.
Vectors some_arms(Check::Numbers &numbers, int n)
{
  Vectors arms(n);
  for (auto &arm : arms) arm = numbers.list(3);
  return arms;
}

Arms sums_of(const Vectors &arms)
{
  Arms sums = {double(arms.size()), {}};
  for (const auto &arm : arms) {
    add3(arm.data(), sums.sums.arm);
    for (int n = 0; n < 9; ++n) sums.sums.products[n] += arm[n / 3] * arm[n % 3];
  }
  return sums;
}

Load loads_of(const Vectors &arms, const Vectors &vectors)
{
  Load load = {};
  for (size_t n = 0; n < arms.size(); ++n) {
    double moment[3];
    cross3(arms[n].data(), vectors[n].data(), moment);
    add3(vectors[n].data(), load.force);
    add3(moment, load.torque_space);
  }
  return load;
}

Twist nearest_to(const Vectors &arms, const Vectors &vectors, Mask off = 0)
{
  return nearest_twist(sums_of(arms), off, loads_of(arms, vectors));
}

Move move_to(const Vectors &arms, const Vectors &motions, Mask off = 0)
{
  Displacements sums = {};
  for (size_t n = 0; n < arms.size(); ++n) {
    add3(motions[n].data(), sums.way);
    for (int k = 0; k < 9; ++k) sums.products[k] += motions[n][k / 3] * arms[n][k % 3];
  }
  return nearest_move(sums_of(arms), off, sums);
}

/// The position of an arm after a move, from the original center of mass.
vector<double> moved(const Move &move, const vector<double> &arm)
{
  double a[9];
  vector<double> out(3);
  rotation_matrix(move.rotation, 1.0, a);
  to_space(a, arm.data(), out.data());
  add3(move.way, out.data());
  return out;
}

/// Sum of squares of the displacements that a move does not represent.
double left_by(const Move &move, const Vectors &arms, const Vectors &motions)
{
  double sum = 0.0;
  for (size_t n = 0; n < arms.size(); ++n) {
    const vector<double> there = moved(move, arms[n]);
    for (int k = 0; k < 3; ++k) sum += std::pow(arms[n][k] + motions[n][k] - there[k], 2);
  }
  return sum;
}

}    // namespace

/// The residual forces have neither sum nor moment, and the product of two twists as vectors on
/// sites equals force times displacement plus torque times rotation.
TEST(NearestTwist, IsAnOrthogonalProjection)
{
  Check::Numbers numbers(32);
  const Vectors arms = some_arms(numbers, 5), forces = some_arms(numbers, 5);
  const Twist found = nearest_to(arms, forces);
  Vectors projected = forces;
  for (size_t n = 0; n < arms.size(); ++n) way_of_site(found, arms[n], projected[n].data());
  const Load all = loads_of(arms, forces), part = loads_of(arms, projected);
  EXPECT_LT(Check::largest_difference(all.force, part.force, 3), 1e-14);
  EXPECT_LT(Check::largest_difference(all.torque_space, part.torque_space, 3), 1e-14);
  double square = 0.0;
  for (const auto &one : projected) square += dot3(one.data(), one.data());
  const double power = dot3(all.force, found.way) + dot3(all.torque_space, found.turn);
  EXPECT_NEAR(square, power, 1e-13);
}

TEST(NearestTwist, HoldsComponents)
{
  Check::Numbers numbers(33);
  const Vectors arms = some_arms(numbers, 4), forces = some_arms(numbers, 4);
  const Mask off = force_off(0) | torque_off(1) | torque_off(2);
  const Twist found = nearest_to(arms, forces, off);
  EXPECT_EQ(found.way[0], 0.0);
  EXPECT_EQ(found.turn[1], 0.0);
  EXPECT_EQ(found.turn[2], 0.0);
  EXPECT_GT(std::fabs(found.turn[0]), 0.01);
  // the residual forces are orthogonal to the allowed motions
  Vectors rest = forces;
  for (size_t n = 0; n < arms.size(); ++n) {
    double one[3];
    way_of_site(found, arms[n], one);
    for (int k = 0; k < 3; ++k) rest[n][k] -= one[k];
  }
  const Load left = loads_of(arms, rest);
  EXPECT_LT(std::fabs(left.force[1]) + std::fabs(left.force[2]) + std::fabs(left.torque_space[0]),
            1e-14);
}

TEST(NearestMove, OfARigidMoveIsThatMove)
{
  Check::Numbers numbers(34);
  for (const double size : {1e-6, 0.1, 1.0}) {
    const Vectors arms = some_arms(numbers, 3);
    Move given = {{0.3 * size, -0.2 * size, 0.1 * size}, {}};
    const double turn[3] = {0.5 * size, 0.7 * size, -0.4 * size};
    quaternion_of_turn(turn, given.rotation);
    Vectors motions(arms.size(), vector<double>(3));
    for (size_t n = 0; n < arms.size(); ++n)
      for (int k = 0; k < 3; ++k) motions[n][k] = moved(given, arms[n])[k] - arms[n][k];
    const Move found = move_to(arms, motions);
    EXPECT_LT(Check::largest_difference(found.way, given.way, 3), 1e-14);
    EXPECT_LT(Check::quaternion_distance(found.rotation, given.rotation), 1e-15);
  }
}

TEST(NearestMove, LeavesLeast)
{
  Check::Numbers numbers(35);
  const Vectors arms = some_arms(numbers, 4);
  Vectors motions = some_arms(numbers, 4);
  for (auto &one : motions)
    for (double &x : one) x *= 0.2;
  for (const Mask off : {0, force_off(1) | torque_off(2)}) {
    const Move found = move_to(arms, motions, off);
    const double least = left_by(found, arms, motions);
    for (int k = 0; k < 6; ++k) {
      if (off & (k < 3 ? force_off(k) : torque_off(k - 3))) continue;
      for (const double step : {-1e-3, 1e-3}) {
        Move other = found;
        double turn[3] = {}, q[4];
        if (k < 3)
          other.way[k] += step;
        else
          turn[k - 3] = step;
        quaternion_of_turn(turn, q);
        w_times(q, found.rotation, other.rotation);
        EXPECT_GT(left_by(other, arms, motions) - least, 1e-7);
      }
    }
    if (off) { EXPECT_EQ(found.way[1], 0.0); }
  }
}
