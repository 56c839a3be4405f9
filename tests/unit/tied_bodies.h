/* Two asymmetric bodies tied to each other and to the origin by springs, at sites off their
   centers, for the tests of couplings. */

#pragma once

#include "drive.h"

namespace TiedBodies {

using namespace LAMMPS_NS::GearQuat;
using std::vector;

const double ARMS[2][3] = {{0.6, -0.3, 0.4}, {-0.2, 0.5, 0.7}};
const vector<RigidBody> BODIES = {{1.0, {1.3, 0.9, 0.6}}, {2.0, {2.2, 1.7, 1.1}}};

inline vector<BodyState> at_start()
{
  vector<BodyState> states = {
      {{0.5, 0.1, -0.8}, {0.1, -0.7, 0.3, 0.6}, {0.2, -0.4, 0.4}, {1.0, 0.3, -0.8}},
      {{-0.9, 0.6, 0.2}, {0.4, 0.2, -0.8, 0.3}, {-0.3, 0.1, 0.5}, {-0.4, 0.6, 0.5}}};
  for (auto &s : states) project_norm(s.q);
  return states;
}

inline void site_of(const BodyState &s, const double *arm_body, double *arm, double *x)
{
  double a[9];
  rotation_matrix(s.q, dot4(s.q, s.q), a);
  to_space(a, arm_body, arm);
  for (int k = 0; k < 3; ++k) x[k] = s.center[k] + arm[k];
}

/// Springs of strength 1 between the sites, and from each site to the origin.
struct Springs {
  vector<Load> loads;
  double energy;
};
inline Springs springs(const vector<BodyState> &states)
{
  Springs all = {vector<Load>(2), 0.0};
  double arm[2][3], x[2][3];
  for (int b = 0; b < 2; ++b) site_of(states[b], ARMS[b], arm[b], x[b]);
  for (int b = 0; b < 2; ++b) {
    for (int k = 0; k < 3; ++k) {
      all.loads[b].force[k] = x[1 - b][k] - 2.0 * x[b][k];
      all.energy += 0.5 * x[b][k] * x[b][k] + 0.25 * std::pow(x[0][k] - x[1][k], 2);
    }
    cross3(arm[b], all.loads[b].force, all.loads[b].torque_space);
  }
  return all;
}

/// The loads requested by a host.
inline vector<Load> loads(const vector<BodyState> &states)
{
  return springs(states).loads;
}

}    // namespace TiedBodies
