/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Restart files of releases that had no sections (gear_quat_sections.h), turned into sections. */

#ifndef GEAR_QUAT_RESTART_OLD_H
#define GEAR_QUAT_RESTART_OLD_H

#include "gear_quat_sections.h"

namespace LAMMPS_NS::GearQuat {

/// The format of 0.3.0, of numbers only.
struct Release030 {
  static constexpr double FORMAT = 4;
  static constexpr int VALUES = 12, VARIABLES = 11;    ///< most values; most xi of a chain, and S

  double magic, format;
  double extended, natoms;
  double formulation, values, compensate, started, h, variable, tuned;
  double tolerance[13];
  struct {
    double mode, bodies, target[4], heat[VALUES];
  } isokinetic;
  struct {
    double mode, length;    ///< number of chains, 0 for none; of variables xi
    double bodies, kt, kt_step, period, freedoms[2];
    /// Row 0 is the present value, the next rows are derivatives in units of the step, and the last
    /// row is a trial row.  The last variable of a chain is S.
    double rows[2][VARIABLES][VALUES + 1];
  } thermostat;

  /// The data of atoms.
  static constexpr AtomParts PARTS = {5, 11, 11, 13, 3, 6};

  /// The kinetic energies of past steps, which present chains need, are not in the file.
  Sections sections() const
  {
    Sections to;
    to.put("bodies", {extended, natoms});
    to.put("parts of atoms", PARTS.numbers());
    to.put("scheme", {formulation, values, compensate, variable, tuned});
    to.put("motion", {started, h});
    if (variable != 0.0) to.put("tolerance", {tolerance, tolerance + 13});
    if (isokinetic.mode != 0.0) {
      const double *target = isokinetic.target;
      to.put("isokinetic",
             {isokinetic.mode, isokinetic.bodies, target[0], target[1], target[2], target[3]});
      to.put("heat", {isokinetic.heat, isokinetic.heat + VALUES});
    }
    if (thermostat.mode != 0.0) {
      const auto &t = thermostat;
      to.put("thermostat",
             {t.mode, t.length, t.bodies, t.kt, t.kt_step, t.period, t.freedoms[0], t.freedoms[1]});
      Sections::Numbers variables;
      for (int c = 0; c < std::min((int) t.mode, 2); ++c)
        for (int v = 0; v < std::min((int) t.length + 1, VARIABLES); ++v)
          variables.push_back(t.rows[c][v][0]);
      to.put("chains", variables);
    }
    return to;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
