/* The host's part, for one body and a load that is a function of its state: start a history, then
   predict - evaluate - correct.  LAMMPS takes this place in the fix. */

#pragma once

#include "gear_quat_startup.h"

#include <functional>
#include <ostream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace Drive {

using namespace LAMMPS_NS::GearQuat;

/// Load on a body at a state; norm2: what its quaternion's square is taken for (Scheme::norm2).
using LoadOf = std::function<Load(const BodyState &state, double norm2)>;

enum class Start { ZERO, FORCES, BOOTSTRAP };

inline Load free_of_load(const BodyState &, double)
{
  return Load{};
}

inline LoadOf constant(const Load &load)
{
  return [load](const BodyState &, double) {
    return load;
  };
}

inline Scheme scheme_of(Formulation formulation, int values = 0, int passes = 1,
                        bool compensate = false)
{
  Scheme scheme;
  scheme.formulation = formulation;
  scheme.rows = values;
  scheme.passes = passes;
  scheme.compensate = compensate;
  return scheme;
}

constexpr Formulation FIRST = Formulation::FIRST, SECOND = Formulation::SECOND;

constexpr int fewest(Formulation f)
{
  return f == FIRST ? FIRST_FEWEST : SECOND_FEWEST;
}
constexpr int most(Formulation f)
{
  return f == FIRST ? FIRST_MOST : SECOND_MOST;
}

/// Every number of values of one formulation.
inline std::vector<Scheme> schemes_of(Formulation formulation, int passes = 1,
                                      bool compensate = false)
{
  std::vector<Scheme> list;
  for (int n = fewest(formulation); n <= most(formulation); ++n)
    list.push_back(scheme_of(formulation, n, passes, compensate));
  return list;
}

inline std::vector<Scheme> every_scheme(int passes = 1, bool compensate = false)
{
  std::vector<Scheme> list = schemes_of(FIRST, passes, compensate);
  for (const Scheme &s : schemes_of(SECOND, passes, compensate)) list.push_back(s);
  return list;
}

inline Scheme with_velocity_c0(Scheme scheme)
{
  scheme.velocity_c0 = true;
  return scheme;
}

// The start as the host finds it (gear_quat_bootstrap.cpp).

/// One sweep over all nodes, outwards.  Returns the largest change.
inline double sweep(const Collocation &collocation, const RigidBody &body, const LoadOf &load,
                    double spacing, double length, bool first, Collocation::Workspace &work)
{
  double change = 0.0;
  for (int pair = 1; pair <= collocation.pairs(); ++pair) {
    for (const int node : {-pair, pair}) {
      const BodyState s = collocation.state_at(node, work, spacing);
      change = std::max(
          change,
          collocation.set_load(node, body, s, load(s, dot4(s.q, s.q)), spacing, length, work));
    }
    if (first && pair < collocation.pairs()) collocation.foretell(pair, work);
  }
  return change;
}

/// A series found by collocation, and what it took.
struct Found {
  TaylorSeries series;
  double spacing;
  int sweeps = 0;    ///< of the spacing that was kept
  int evaluations = 0;
};

/// length: the size of the body.  Throws if the host would start with known forces only.
inline Found bootstrap(int values, const RigidBody &body, const BodyState &state,
                       const LoadOf &load, double spacing, double length = 1.0)
{
  const Collocation collocation(values);
  Collocation::Workspace work;
  Found found;
  SweepRule rule;
  using Verdict = SweepRule::Verdict;
  for (int n = 0; n < SweepRule::MAX_SPACINGS; ++n, spacing *= 0.5) {
    collocation.begin(local_series(body, state, load(state, dot4(state.q, state.q)), spacing),
                      work);
    Verdict verdict = Verdict::ANOTHER_SWEEP;
    found.sweeps = 0;
    for (rule.begin_spacing(); verdict == Verdict::ANOTHER_SWEEP; ++found.sweeps) {
      const double change =
          sweep(collocation, body, load, spacing, length, rule.is_first_sweep(), work);
      found.evaluations += 2 * collocation.pairs();
      verdict = rule.judge(change, [&]() {
        return collocation.truncation(length, work);
      });
    }
    if (verdict == Verdict::SHORTER_SPACING) continue;
    found.series = collocation.series(work);
    found.spacing = spacing;
    return found;
  }
  throw std::runtime_error("forces vary too much within a few steps");
}

/// A history of `scheme` at `state`.  The series is found at a step of `spacing`, whatever h is.
inline std::vector<double> started(const Scheme &scheme, const RigidBody &body,
                                   const BodyState &state, const LoadOf &load, double h,
                                   Start start, double spacing)
{
  Found found;
  if (start == Start::BOOTSTRAP) {
    found = bootstrap(scheme.values(), body, state, load, spacing);
  } else {
    found.series = local_series(body, state, load(state, dot4(state.q, state.q)), spacing);
    found.spacing = spacing;
    if (start == Start::ZERO) found.series.terms = 2;
  }
  std::vector<double> rows(scheme.size());
  seed(scheme, body, found.series, found.spacing, h, rows.data());
  return rows;
}

/// One body under way.
struct Motion {
  RigidBody body;
  Scheme scheme;
  LoadOf load;
  double h;
  Integrator integrator;
  std::vector<double> history;
  double *rows;

  Motion(const RigidBody &body, const LoadOf &load, const Scheme &scheme, double h,
         std::vector<double> history) :
      body(body),
      scheme(scheme), load(load), h(h), integrator(scheme, h), history(std::move(history)),
      rows(this->history.data())
  {
  }
  Motion(const RigidBody &body, const BodyState &state, const LoadOf &load, const Scheme &scheme,
         double h, Start start, double spacing) :
      Motion(body, load, scheme, h, started(scheme, body, state, load, h, start, spacing))
  {
  }
  Motion(const Motion &) = delete;

  BodyState state() const { return integrator.body_state(body, rows); }
  const double *q() const { return rows + scheme.quaternion(); }

  void predict() { integrator.predict(rows); }
  Correction correct(const Load &met) { return integrator.correct(body, met, rows); }

  Correction step()
  {
    predict();
    return correct(load(state(), scheme.norm2(q())));
  }

  void steps(int n)
  {
    for (int i = 0; i < n; ++i) step();
  }
  void run(double time) { steps(int(std::lround(time / h))); }
};

}    // namespace Drive

/// In the messages of tests.
namespace LAMMPS_NS::GearQuat {
inline std::ostream &operator<<(std::ostream &out, const Scheme &scheme)
{
  return out << (scheme.first() ? "first" : "second") << (scheme.velocity_c0 ? ", velocity c0" : "")
             << ", " << scheme.values() << " values, " << scheme.passes << " passes"
             << (scheme.compensate ? ", compensated" : "");
}
}    // namespace LAMMPS_NS::GearQuat
