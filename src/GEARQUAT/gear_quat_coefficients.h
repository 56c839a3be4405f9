/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Corrector coefficients of Gear's predictor-corrector in Nordsieck form.

   Row j of a history is y_j = h^j/j! d^j y/dt^j.  After prediction the residual r of the
   differential equation is fed back into every row, y_j += c_j r, with
     first-order equation   r = h y' - y_1           c_1 = 1
     second-order equation  r = h^2/2 y'' - y_2      c_2 = 1
   Source: C. W. Gear, "Numerical Initial Value Problems in Ordinary Differential Equations" (1971);
   Pratt & Bin Mohamad Zaini, Tables 1 and 2 (beta_2 = 1: the printed 4 is a misprint). */

#ifndef GEAR_QUAT_COEFFICIENTS_H
#define GEAR_QUAT_COEFFICIENTS_H

#include <array>

namespace GearQuat {

/// An exact coefficient; the tests check the fractions themselves.
struct Fraction {
  long numerator, denominator;
  constexpr double value() const { return double(numerator) / double(denominator); }
};

constexpr int FIRST_VALUES = 5;     ///< rows kept for a first-order equation
constexpr int SECOND_VALUES = 6;    ///< rows kept for a second-order equation

/// First-order equation, order 5 (Table 1).
constexpr std::array<Fraction, FIRST_VALUES> FIRST_ORDER = {
    {{251, 720}, {1, 1}, {11, 12}, {1, 3}, {1, 24}}};

/// Second-order equation whose right side depends on positions only, order 7.
constexpr std::array<Fraction, SECOND_VALUES> SECOND_ORDER_POSITION = {
    {{3, 20}, {251, 360}, {1, 1}, {11, 18}, {1, 6}, {1, 60}}};

/// Second-order equation whose right side depends on velocities too, order 5 (Table 2).
constexpr std::array<Fraction, SECOND_VALUES> SECOND_ORDER_VELOCITY = {
    {{3, 16}, {251, 360}, {1, 1}, {11, 18}, {1, 6}, {1, 60}}};

}    // namespace GearQuat

#endif
