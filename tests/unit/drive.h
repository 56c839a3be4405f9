/* The host for one body and a load that is a function of its state: starts a history, then
   predicts, evaluates and corrects.  LAMMPS is the host of the fix. */

#pragma once

#include "gear_quat_startup.h"

#include <functional>
#include <ostream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace Drive {

using namespace LAMMPS_NS::GearQuat;

/// Load on a body at a state; norm2: divisor for its quaternion (Scheme::norm2).
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
  if (scheme.momentum()) scheme.method = Method::TUNED;
  scheme.rows = values;
  scheme.passes = passes;
  scheme.compensate = compensate;
  return scheme;
}

constexpr Formulation MOMENTUM = Formulation::MOMENTUM, SECOND = Formulation::SECOND,
                      FIRST = Formulation::FIRST;
constexpr Formulation FORMULATIONS[] = {MOMENTUM, SECOND, FIRST};

constexpr int fewest(Formulation f)
{
  return f == FIRST ? FIRST_FEWEST : SECOND_FEWEST;
}
constexpr int most(Formulation f)
{
  return f == FIRST ? FIRST_MOST : SECOND_MOST;
}

/// Schemes with all numbers of values of one formulation.
inline std::vector<Scheme> schemes_of(Formulation formulation, int passes = 1,
                                      bool compensate = false)
{
  std::vector<Scheme> list;
  for (int n = fewest(formulation); n <= most(formulation); ++n)
    list.push_back(scheme_of(formulation, n, passes, compensate));
  return list;
}

/// Schemes of the paper, with Gear's coefficients.
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

// the start, as in the host (gear_quat_start.cpp)

/// The host of find_start(), for one body.
struct StartHost {
  const Collocation &collocation;
  const RigidBody &body;
  BodyState state;
  LoadOf load;
  double length;    ///< the size of the body
  Collocation::Workspace work = {};
  double spacing = 0.0;
  int evaluations = 0;

  void begin(double of)
  {
    spacing = of;
    collocation.begin(body, local_series(body, state, load(state, dot4(state.q, state.q)), spacing),
                      work);
  }
  void foretell() { collocation.foretell(work); }
  int values_that_do(int values) const { return values; }
  bool visit(int pair, double &change)
  {
    change = 0.0;
    for (const int node : {-pair, pair}) {
      const BodyState s = collocation.state_at(node, work, spacing);
      change = std::max(
          change,
          collocation.set_load(node, body, s, load(s, dot4(s.q, s.q)), spacing, length, work));
    }
    collocation.settle(pair, work);
    evaluations += 2;
    return true;
  }
};

/// A series found by collocation, and the effort.
struct Found {
  TaylorSeries series;
  double spacing;
  StartPlan::Verdict verdict;
  int pairs;
  int evaluations;
};

/// length: the size of the body.  Throws if the host would start with known forces only.
inline Found bootstrap(int values, const RigidBody &body, const BodyState &state,
                       const LoadOf &load, double spacing, double length = 1.0)
{
  const Collocation collocation(values);
  StartHost host = {collocation, body, state, load, length};
  const StartFound start = find_start(values, spacing, host);
  if (start.verdict == StartPlan::Verdict::SHORTER_SPACING)
    throw std::runtime_error("forces vary too much within a few steps");
  return {collocation.series(host.work, start.pairs), start.spacing, start.verdict, start.pairs,
          host.evaluations};
}

/// The series after so many evaluations of every pair that only rounding and truncation remain.
inline TaylorSeries settled_series(int values, const RigidBody &body, const BodyState &state,
                                   const LoadOf &load, double spacing)
{
  const Collocation collocation(values);
  StartHost host = {collocation, body, state, load, 1.0};
  host.begin(spacing);
  double change = 0.0;
  for (int outer = 1; outer <= collocation.pairs(); ++outer) {
    host.foretell();
    for (int round = 0; round < 20; ++round)
      for (int pair = 1; pair <= outer; ++pair) host.visit(pair, change);
  }
  return collocation.series(host.work);
}

/// A history of `scheme` at `state`.  The series is found with a step of `spacing`, for any h.
inline std::vector<double> started(const Scheme &scheme, const RigidBody &body,
                                   const BodyState &state, const LoadOf &load, double h,
                                   Start start, double spacing)
{
  Found found;
  if (start == Start::BOOTSTRAP) {
    found = bootstrap(scheme.start_values(), body, state, load, spacing);
  } else {
    found.series = local_series(body, state, load(state, dot4(state.q, state.q)), spacing);
    found.spacing = spacing;
    if (start == Start::ZERO) found.series.terms = 2;
  }
  std::vector<double> rows(scheme.size());
  seed(scheme, body, found.series, found.spacing, h, rows.data());
  return rows;
}

/// One moving body.
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
      Motion(body, load, scheme, CorrectorCoefficients(scheme), h, std::move(history))
  {
  }
  /// With the given coefficients instead of the scheme's.
  Motion(const RigidBody &body, const LoadOf &load, const Scheme &scheme,
         const CorrectorCoefficients &c, double h, std::vector<double> history) :
      body(body),
      scheme(scheme), load(load), h(h), integrator(scheme, h, c), history(std::move(history)),
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

  void predict() { integrator.predict(body, rows); }
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

/// for the messages of tests
namespace LAMMPS_NS::GearQuat {
inline std::ostream &operator<<(std::ostream &out, const Scheme &scheme)
{
  return out << word_of(scheme.formulation) << (scheme.velocity_c0 ? ", velocity c0" : "") << ", "
             << scheme.values() << " values, " << scheme.passes << " passes"
             << (scheme.compensate ? ", compensated" : "");
}
}    // namespace LAMMPS_NS::GearQuat
