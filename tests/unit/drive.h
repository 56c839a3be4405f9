/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The host's part, for one body and a load that is a function of its state: start a history, then
   predict - evaluate - correct.  LAMMPS takes this place in the fix. */

#ifndef GEAR_QUAT_TEST_DRIVE_H
#define GEAR_QUAT_TEST_DRIVE_H

#include "gear_quat_startup.h"

#include <functional>

namespace Drive {

using namespace GearQuat;

/// Load on a body at a state; norm2: what its quaternion's square is taken for (Scheme::norm2).
using LoadOf = std::function<Load(const BodyState &state, double norm2)>;

enum class Start { ZERO, FORCES, BOOTSTRAP };

inline Load free_of_load(const BodyState &, double)
{
  return Load{};
}

inline Scheme scheme_of(Formulation formulation)
{
  Scheme scheme;
  scheme.formulation = formulation;
  return scheme;
}

/// Taylor series at a state, in units of `spacing`.
inline TaylorSeries series_at(const RigidBody &body, const BodyState &state, const LoadOf &load,
                              Start start, double spacing)
{
  TaylorSeries series = local_series(body, state, load(state, dot4(state.q, state.q)), spacing);
  if (start == Start::ZERO) series.terms = 2;
  if (start != Start::BOOTSTRAP) return series;

  const Collocation collocation;
  Collocation::Workspace work;
  collocation.begin(series, work);
  double change = 1.0;
  for (int sweep = 0; sweep < 40 && change > 0.0; ++sweep) {
    const double before = change;
    change = 0.0;
    for (int k = 0; k < Collocation::NODES; ++k) {
      if (k == Collocation::HALF) continue;
      const BodyState s = collocation.state_at(k, work, spacing);
      change = std::max(
          change, collocation.set_load(k, body, s, load(s, dot4(s.q, s.q)), spacing, 1.0, work));
    }
    if (change < 1e-12 && change > 0.5 * before) break;    // rounding alone is left
  }
  return collocation.series(work);
}

/// One body under way.
struct Motion {
  RigidBody body;
  Scheme scheme;
  LoadOf load;
  Integrator integrator;
  double rows[MAX_VALUES * 13];

  Motion(const RigidBody &body, const BodyState &state, const LoadOf &load, const Scheme &scheme,
         double h, Start start, double spacing) :
      body(body),
      scheme(scheme), load(load), integrator(scheme, h)
  {
    seed(scheme, body, series_at(body, state, load, start, spacing), spacing, h, rows);
  }

  BodyState state() const { return integrator.body_state(body, rows); }
  const double *q() const { return rows + scheme.quaternion(); }

  Shift step()
  {
    integrator.predict(rows);
    return integrator.correct(body, load(state(), scheme.norm2(q())), rows);
  }

  void steps(int n)
  {
    for (int i = 0; i < n; ++i) step();
  }
};

}    // namespace Drive

#endif
