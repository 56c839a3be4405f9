/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* How fast a box oscillates: it moves by the pressure, and the pressure by the box (doc/theory.md,
   Eq. P9).  The start measures the frequency by the forces in two boxes.  In a run, its square is the
   mean of -W drive'.G over that of W G.G, in equilibrium, with fading sums. */

#ifndef LMP_GEAR_QUAT_BOX_FREQUENCY_H
#define LMP_GEAR_QUAT_BOX_FREQUENCY_H

#include "gear_quat_cell.h"

namespace LAMMPS_NS::GearQuat {

class BoxFrequency {
 public:
  /// Parts of the fastest oscillation that the method follows: from one on there is a warning, from
  /// the other an error.
  static constexpr double WARNED = 0.6, REFUSED = 0.95;

  /// The method follows so many radians in a step.
  void set_fastest(double radians) { fastest = radians; }
  double followed() const { return fastest; }
  /// The damping time of the box; sums fade in two of them.
  void set_period(double time) { period = time; }
  void begin_run() { since = 0.0; }
  /// An angular frequency that the start has measured.
  void begin(double omega)
  {
    probed = omega;
    against = along = 0.0;
    last = Upper();
  }
  /// A step h has ended.  mass: of the components that move, 0 for others.
  void note(const Upper &drive, const Upper &rate, const Upper &mass, double h)
  {
    const double fades = std::exp(-std::fabs(h) / (MEMORY * period));
    const bool known = last.contracted(last) > 0.0;
    against *= fades;
    along *= fades;
    for (int k = 0; known && k < Upper::SIZE; ++k) {
      against -= mass[k] * (drive[k] - last[k]) / h * rate[k];
      along += mass[k] * rate[k] * rate[k];
    }
    last = drive;
    since += std::fabs(h);
  }
  /// True if the sums are those of this run.
  bool is_settled() const { return since >= MEMORY * period; }

  double value() const
  {
    return along > 0.0 && against > 0.0 ? std::sqrt(against / along) : probed;
  }
  /// Radians in a step h, and these as a part of what the method follows.
  double radians(double h) const { return value() * std::fabs(h); }
  double part(double h) const { return radians(h) / fastest; }
  /// Infinite if the box does not oscillate.
  double longest_step() const
  {
    return value() > 0.0 ? 0.5 * WARNED * fastest / value() : HUGE_VAL;
  }
  /// The damping time at which there is no warning.
  double needed_period(double h) const { return 1.05 * period * part(h) / WARNED; }

 private:
  static constexpr double MEMORY = 2.0;    // damping times

  double fastest = 0.0, period = 0.0;
  Upper last;                           ///< the drive of the last step
  double against = 0.0, along = 0.0;    ///< the sums
  double probed = 0.0;
  double since = 0.0;    ///< time of this run
};

}    // namespace LAMMPS_NS::GearQuat

#endif
