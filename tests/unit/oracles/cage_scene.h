/* The paper's test system: one body of four sites in a cage of 26 fixed spheres (Pratt & Bin
   Mohamad Zaini, Tables 3 to 6).  The paper does not list the charges of the cage: the pattern here
   is RECONSTRUCTED; it reproduces both total energies in the paper. */

#pragma once

#include "euler_angles.h"
#include "gear_quat_shapes.h"

namespace Oracle {

using namespace LAMMPS_NS::GearQuat;

struct CageScene {
  RigidBody body;
  BodyState start;
  double site_body[4][3];    ///< along the axes of the moments, from the center of mass
  double site_charge[4] = {-0.25, -0.25, -0.5, 1.0};
  double site_sigma[4] = {1.0, 1.0, 4.0, 10.0};
  double site_epsilon[4] = {0.0, 0.0, 0.0, 10.0};
  double cage[26][3];
  double cage_charge[26];
  static constexpr double CAGE_SIGMA = 10.0, CAGE_EPSILON = 10.0;

  /// test_case 1 or 3 (case 2 starts as case 1).  consistent: moments along the principal axes of
  /// the sites; otherwise the same moments along the unrotated axes.
  CageScene(int test_case, bool consistent)
  {
    build_cage();
    double axes[9];
    build_body(consistent, axes);

    const double degree = std::acos(-1.0) / 180.0;
    double q_site[4], site_axes[9], a[9] = {};
    euler_quaternion(40.0 * degree, 100.0 * degree, 85.0 * degree, q_site);
    rotation_matrix(q_site, 1.0, site_axes);    // space -> the axes of the sites
    for (int i = 0; i < 9; ++i)
      for (int k = 0; k < 3; ++k) a[i] += axes[3 * (i / 3) + k] * site_axes[3 * k + i % 3];
    start = BodyState{};
    quaternion_from_matrix(a, start.q);
    start.center[0] = test_case == 3 ? 70.0 : 84.0;
    start.velocity[0] = test_case == 3 ? 0.0 : 0.2;
    const double w = (test_case == 3 ? 0.08 : 0.05) * 180.0 * degree;
    start.omega_body[0] = w / 8;
    start.omega_body[1] = -w / 4;
    start.omega_body[2] = w / 8;
  }

  Load load(const BodyState &state, double norm2) const
  {
    Load total = {};
    potential(state, norm2, &total);
    return total;
  }
  Load operator()(const BodyState &state, double norm2) const { return load(state, norm2); }

  double total_energy(const BodyState &state) const
  {
    return potential(state, dot4(state.q, state.q)) + translational_energy(body, state.velocity) +
        rotational_energy(body, state.omega_body);
  }

  double potential(const BodyState &state, double norm2, Load *total = nullptr) const
  {
    double a[9], energy = 0.0;
    rotation_matrix(state.q, norm2, a);
    for (int k = 0; k < 4; ++k) {
      double arm[3], force[3] = {0.0, 0.0, 0.0}, torque[3];
      to_space(a, site_body[k], arm);
      const double sigma = 0.5 * (site_sigma[k] + CAGE_SIGMA);    // Lorentz-Berthelot, Eq. 19a
      const double epsilon = std::sqrt(site_epsilon[k] * CAGE_EPSILON);
      for (int c = 0; c < 26; ++c) {
        double d[3];
        for (int i = 0; i < 3; ++i) d[i] = state.center[i] + arm[i] - cage[c][i];
        const double r2 = dot3(d, d), s2 = sigma * sigma / r2, s6 = s2 * s2 * s2;
        const double coulomb = site_charge[k] * cage_charge[c] / std::sqrt(r2);
        energy += 4.0 * epsilon * (s6 * s6 - s6) + coulomb;    // Eq. 19
        const double over_r = (24.0 * epsilon * (2.0 * s6 * s6 - s6) + coulomb) / r2;
        for (int i = 0; i < 3; ++i) force[i] += over_r * d[i];
      }
      if (!total) continue;
      cross3(arm, force, torque);    // Eq. 12
      for (int i = 0; i < 3; ++i) {
        total->force[i] += force[i];
        total->torque_space[i] += torque[i];
      }
    }
    return energy;
  }

  /// Sites from their center of mass, in the axes of the list, and their inertia tensor.
  static void listed_sites(double offset[4][3], double tensor[9])
  {
    const double site[4][3] = {{3, -4, 0}, {-3, -4, 0}, {0, 0, 0}, {0, 0, 12}};
    const double mass[4] = {2, 2, 10, 50};
    double center[3] = {0, 0, 0};
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 3; ++i) center[i] += mass[k] * site[k][i] / 64.0;
    for (int i = 0; i < 9; ++i) tensor[i] = 0.0;
    for (int k = 0; k < 4; ++k) {
      double *d = offset[k];
      for (int i = 0; i < 3; ++i) d[i] = site[k][i] - center[i];
      for (int i = 0; i < 9; ++i)
        tensor[i] += mass[k] * ((i % 4 == 0) * dot3(d, d) - d[i / 3] * d[i % 3]);
    }
  }

 private:
  void build_cage()
  {
    int n = 0;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const int sign = z ? z : (y ? y : -x);    // the first of (z, y, -x) that is nonzero
          if (sign == 0) continue;
          cage[n][0] = 100.0 * x;
          cage[n][1] = 100.0 * y;
          cage[n][2] = 100.0 * z;
          cage_charge[n++] = sign > 0 ? -1.0 : 1.0;
        }
  }

  /// axes: rows are the axes of site_body, in the axes of the list.
  void build_body(bool consistent, double axes[9])
  {
    double offset[4][3], tensor[9];
    body.mass = 64.0;
    listed_sites(offset, tensor);
    principal_axes(tensor, body.inertia, axes);
    for (int k = 0; k < 3; ++k)    // the axes near +x, +y, +z: omega is listed along them
      if (axes[4 * k] < 0.0)
        for (int i = 0; i < 3; ++i) axes[3 * k + i] = -axes[3 * k + i];
    if (!consistent)
      for (int i = 0; i < 9; ++i) axes[i] = i % 4 == 0;
    for (int k = 0; k < 4; ++k) to_body(axes, offset[k], site_body[k]);
  }
};

}    // namespace Oracle
