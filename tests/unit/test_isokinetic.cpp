/* Constant kinetic energy: multipliers without kinetic energy, and of bodies that hardly turn about an axis.  The motion is
   in tests/lammps/test_equations.py and test_isokinetic.py. */

#include "drive.h"
#include "gear_quat_friction.h"

#include <gtest/gtest.h>

using namespace Drive;

TEST(Isokinetic, WithoutKineticEnergyThereIsNoMultiplier)
{
  KineticSums sums;
  sums.force_power = sums.torque_power = 1.0;
  for (const Isokinetic mode : {Isokinetic::TOTAL, Isokinetic::SEPARATE}) {
    EXPECT_EQ(multipliers(mode, sums).translation, 0.0);
    EXPECT_EQ(multipliers(mode, sums).rotation, 0.0);
    EXPECT_EQ(scale_factors(mode, sums, sums).rotation, 1.0);
  }
}

TEST(Isokinetic, AnAxisWithoutInertiaIsLeftAlone)
{
  // a negative multiplier makes momenta grow, and would amplify rounding about the axis
  const RigidBody rod = {1.0, {0.8, 0.8, 0.0}};
  const BodyState state = {{}, {0.5, 0.5, -0.5, 0.5}, {0.1, 0.2, 0.0}, {1.0, 0.3, 1.0e-14}};
  const Scheme scheme = scheme_of(FIRST, 6, 2);
  const double h = 0.01;
  const Multipliers alpha = {-0.2, -0.2}, grown = {1.05, 1.05};
  const Integrator integrator(scheme, h);
  std::vector<double> rows(scheme.size());
  seed(scheme, rod, local_series(rod, state, damped_load(rod, state, Load{}, Friction(alpha)), h),
       h, h, rows.data());
  const double axis = rows[Scheme::OMEGA + 2], across = rows[Scheme::OMEGA];
  for (int n = 0; n < 1000; ++n) {
    integrator.predict(rod, rows.data());
    integrator.correct(rod, Load{}, rows.data(), alpha);
  }
  integrator.scale_momenta(rod, grown, rows.data());
  EXPECT_NEAR(rows[Scheme::OMEGA + 2], axis, 1.0e-15);
  EXPECT_NEAR(rows[Scheme::OMEGA] / across, 1.05 * std::exp(2.0), 1.0e-4);
}
