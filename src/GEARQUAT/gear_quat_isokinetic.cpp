/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_isokinetic.h"

#include "gear_quat_ranks.h"

#include "error.h"
#include "force.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

// a kinetic energy less than this part of the other one is rounding of velocities

static constexpr double NOTHING = 1.0e-24;

/* ---------------------------------------------------------------------- */

IsokineticConstraint::IsokineticConstraint(LAMMPS *lmp, Bodies &bodies, const Scheme &scheme,
                                           Isokinetic mode, bool rescale) :
    Pointers(lmp),
    bodies(bodies), scheme(scheme), mode(mode), rescale(rescale), counted(0), heat{}
{
}

KineticSums IsokineticConstraint::over_all(KineticSums here) const
{
  static constexpr int N = sizeof(KineticSums) / sizeof(double);
  KineticSums all;
  MPI_Allreduce(&here, &all, N, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

void IsokineticConstraint::measure()
{
  KineticSums here;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    here.add(bodies.rigid_of(ibody), bodies.load_of(ibody), bodies.state_of(ibody));
  sums = over_all(here);
  alpha = multipliers(mode, sums);
}

void IsokineticConstraint::begin_run(bool afresh)
{
  measure();
  refuse_rest();
  if (!afresh && counted == bodies.number()) return;
  target = sums;
  counted = bodies.number();
}

/// Without kinetic energy there is no multiplier.
void IsokineticConstraint::refuse_rest() const
{
  int turn = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    if (bodies.rigid_of(ibody).rotational_freedoms() > 0) turn = 1;
  turn = over_ranks(MPI_MAX, turn, world);

  const char *missing = nullptr;
  if (sums.translation + sums.rotation <= 0.0)
    missing = "";
  else if (mode == Isokinetic::SEPARATE && sums.translation <= NOTHING * sums.rotation)
    missing = "translational ";
  else if (mode == Isokinetic::SEPARATE && turn && sums.rotation <= NOTHING * sums.translation)
    missing = "rotational ";
  if (missing)
    error->all(FLERR,
               "Fix gear/quat isokinetic {}: the {}kinetic energy of the bodies is zero and would "
               "stay so; give them velocities first",
               mode == Isokinetic::SEPARATE ? "separate" : "total", missing);
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

/// Sums with the torques at the predicted pose and the present velocities.
KineticSums IsokineticConstraint::of_pending() const
{
  KineticSums here;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const BodyState &s = bodies.state_of(ibody);
    here.add(bodies.rigid_of(ibody), bodies.load_of(ibody).force, pending[ibody].torque_body,
             s.velocity, s.omega_body);
  }
  return over_all(here);
}

void IsokineticConstraint::correct(const Integrator &integrator)
{
  const int n = bodies.nmoved();
  pending.resize(n);
  for (int ibody = 0; ibody < n; ++ibody)
    pending[ibody] =
        integrator.begin(bodies.load_of(ibody), bodies.axes(ibody), bodies.history(ibody));

  for (int pass = 0; pass < scheme.passes; ++pass) {
    alpha = multipliers(mode, of_pending());
    for (int ibody = 0; ibody < n; ++ibody) {
      const RigidBody &rigid = bodies.rigid_of(ibody);
      double *rows = bodies.history(ibody);
      integrator.correct_pass(rigid, bodies.load_of(ibody), alpha, rows, pending[ibody]);
      bodies.change_state(ibody) = integrator.body_state(rigid, rows);
    }
  }

  sums = of_pending();
  alpha = multipliers(mode, sums);
  integrator.advance(heat, sums.power());
  if (counted != bodies.number()) {    // some were removed, with what they had
    target = sums;
    counted = bodies.number();
  }
  const Multipliers factor = scale_factors(mode, target, sums);
  if (rescale)
    heat[0] += 0.5 * (sums.translation + sums.rotation - target.translation - target.rotation);

  for (int ibody = 0; ibody < n; ++ibody) {
    double *rows = bodies.history(ibody);
    bodies.change_last(ibody) = integrator.finish(bodies.load_of(ibody), rows, pending[ibody]);
    if (rescale) integrator.scale_momenta(bodies.rigid_of(ibody), factor, rows);
    integrator.body_state(bodies.rigid_of(ibody), rows, bodies.change_state(ibody),
                          bodies.change_frame(ibody));
  }
}

/* ----------------------------------------------------------------------
   heat
------------------------------------------------------------------------- */

void IsokineticConstraint::seed_heat(const double *series, int terms, double series_step, double h)
{
  double power = 1.0;
  for (int j = 1; j < scheme.values(); ++j) {
    power *= h / series_step;
    heat[j] = j < terms ? power * series[j] : 0.0;
  }
}

void IsokineticConstraint::rescale_step(double ratio)
{
  Nordsieck<1>::rescale(heat, scheme.values(), ratio);
}

double IsokineticConstraint::element(int n) const
{
  if (n == HEAT) return heat[0] * force->mvv2e;
  return n == ALPHA_TRANSLATION ? alpha.translation : alpha.rotation;
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

void IsokineticConstraint::write(Sections &file) const
{
  file.put("isokinetic",
           {(double) mode, (double) counted, target.force_power, target.torque_power,
            target.translation, target.rotation});
  file.put("heat", {heat, heat + MAX_VALUES});
}

std::string IsokineticConstraint::read(const Sections &file)
{
  const auto &saved = file.get("isokinetic"), &rows = file.get("heat");
  if (saved.size() < 6 || rows.empty()) return "the kinetic energy that isokinetic keeps";
  counted = (bigint) saved[1];
  target = {saved[2], saved[3], saved[4], saved[5]};
  std::fill_n(heat, MAX_VALUES, 0.0);
  std::copy_n(rows.begin(), std::min(rows.size(), (size_t) MAX_VALUES), heat);
  return "";
}
