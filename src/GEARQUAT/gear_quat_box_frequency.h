/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Frequency of the oscillation of a box: the pressure drives the box, and the box changes the
   pressure (doc/theory.md, Eq. P9). The start measures the frequency from the forces in two boxes.
   During a run in equilibrium, the square of the frequency is the ratio of the means of -W drive'.G
   and W G.G, from sums in which old steps fade. */

#ifndef LMP_GEAR_QUAT_BOX_FREQUENCY_H
#define LMP_GEAR_QUAT_BOX_FREQUENCY_H

#include "gear_quat_cell.h"
#include "gear_quat_limits.h"

namespace LAMMPS_NS::GearQuat {

class BoxFrequency {
 public:
  /// The fastest stable oscillation, in radians per step, and the one that is followed for long.
  void set_fastest(double radians) { fastest = radians; }
  double followed() const { return FOLLOWED * fastest; }
  /// The damping time of the box; sums fade over two of them.
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
  /// True if the sums represent this run, or if the start has measured the frequency.
  bool is_settled() const { return since >= MEMORY * period || along == 0.0; }

  double value() const
  {
    return along > 0.0 && against > 0.0 ? std::sqrt(against / along) : probed;
  }
  /// Radians in a step h.
  double radians(double h) const { return value() * std::fabs(h); }
  /// Infinite if the box does not oscillate.
  double longest_step() const { return value() > 0.0 ? 0.5 * followed() / value() : HUGE_VAL; }
  template <class V> void fields(V &v) { v(last, against, along, probed); }
  /// A damping time with which it is followed, rounded up.
  double needed_period(double h) const
  {
    return rounded_up(1.05 * period * radians(h) / followed());
  }

 private:
  static constexpr double MEMORY = 2.0;    // damping times
  static constexpr double FOLLOWED = 0.6;

  double fastest = 0.0, period = 0.0;
  Upper last;                           ///< the drive of the last step
  double against = 0.0, along = 0.0;    ///< the sums
  double probed = 0.0;
  double since = 0.0;    ///< time of this run
};

}    // namespace LAMMPS_NS::GearQuat

#endif
