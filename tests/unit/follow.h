/* The host with a tolerance, for some bodies and loads that are functions of their states:
   predicts, evaluates, corrects; a failed step is undone, shortened and repeated. */

#pragma once

#include "drive.h"
#include "gear_quat_step_control.h"

namespace Drive {

using std::vector;

inline Scheme varying(Formulation formulation, int values, bool compensate = false)
{
  Scheme scheme = scheme_of(formulation, values, 2, compensate);
  scheme.trial = true;
  return scheme;
}

struct Follower {
  struct One {
    RigidBody body;
    double reach;
    BodyState state = {};
    vector<double> rows = vector<double>(2 * MAX_SIZE, 0.0);
  };
  /// Loads on all bodies at their states, for quaternions of any length.
  using Loads = std::function<vector<Load>(const vector<One> &)>;
  /// The longest step that the motion allows.
  using Farthest = std::function<double(const vector<One> &)>;

  vector<One> bodies;
  Loads loads;
  Farthest farthest = [](const vector<One> &) {
    return std::numeric_limits<double>::infinity();
  };
  StepControl control;
  Scheme scheme;
  double t = 0.0, h, largest = 0.0;    ///< error of a step, in units of eps
  Steady steady;
  long steps = 0, evaluations = 0, repeated = 0;
  bool repeats = true;    ///< failed steps
  bool rounded = true;    ///< coordinates, whose rounding error is excluded
  Integrator integrator;
  VariableOrder order;

  Follower(Formulation formulation, double eps, bool energy, double h, vector<One> bodies,
           Loads loads) :
      bodies(std::move(bodies)),
      loads(std::move(loads)),
      scheme(varying(formulation, std::min(most(formulation), VARIABLE_MOST))), h(h),
      integrator(scheme, h), order(scheme)
  {
    control.eps = eps;
    control.energy = energy;
    control.short_of = energy && formulation == SECOND ? 1 : 0;
    control.fewest = fewest(formulation);
    control.most = scheme.values();
    steady.repeat = Steady::FOR_LONG;
  }

  /// Histories from the present loads alone, with the fewest values.
  void begin_with_loads()
  {
    use(control.fewest);
    const vector<Load> met = loads(bodies);
    ++evaluations;
    for (size_t k = 0; k < bodies.size(); ++k) {
      One &one = bodies[k];
      TaylorSeries series = local_series(one.body, one.state, met[k], h);
      seed(scheme, one.body, series, h, h, one.rows.data());
    }
  }

  void use(int values)
  {
    scheme.rows = values;
    integrator = Integrator(scheme, h);
    order = VariableOrder(scheme);
    steady.values = 0;
  }

  void set_step(double step)
  {
    for (One &one : bodies) integrator.rescale(one.rows.data(), step / h);
    h = step;
    integrator.set_step(h);
    steady.step = 0;
  }

  void change(const StepControl::Next &next)
  {
    if (next.values != scheme.values()) {
      for (One &one : bodies)
        next.values > scheme.values() ? order.add_row(one.rows.data())
                                      : order.drop_row(one.rows.data());
      use(next.values);
    }
    if (next.step != h) set_step(next.step);
  }

  void take_states()
  {
    for (One &one : bodies) one.state = integrator.body_state(one.body, one.rows.data());
  }

  StepErrors try_step()
  {
    StepMeasures all;
    for (One &one : bodies) integrator.predict(one.body, one.rows.data());
    take_states();
    const vector<Load> met = loads(bodies);
    ++evaluations;
    for (size_t k = 0; k < bodies.size(); ++k) {
      StepMeasures errors;
      double *rows = bodies[k].rows.data();
      order.correct(integrator, bodies[k].body, bodies[k].reach, met[k],
                    integrator.axes_of(rows).data(), rows, errors);
      all.include(rounded ? control.counted(errors) : errors);
    }
    take_states();
    return control.measured(all);
  }

  /// An accepted step, possibly after failed tries.
  StepErrors step()
  {
    while (true) {
      vector<One> before = bodies;
      const StepErrors errors = try_step();
      if (!repeats || !control.fails(errors.same, h)) {
        t += h;
        ++steps;
        steady.count();
        largest = std::max(largest, errors.same / control.eps);
        return errors;
      }
      bodies.swap(before);
      const auto shorter = control.repeat(errors.same, h, scheme.values(), steady);
      steady.repeat = 0;
      ++repeated;
      change(shorter);
    }
  }

  void follow(const StepErrors &errors)
  {
    change(control.next(errors, h, scheme.values(), steady, farthest(bodies)));
  }

  /// Runs to the time `end` exactly; seen: called after every step.
  template <class Seen> void run(double end, Seen seen)
  {
    while (t < end) {
      if (t + h > end) set_step(end - t);    // an ordinary step, only shorter
      const StepErrors errors = step();
      seen();
      if (t < end) follow(errors);
    }
  }
};

}    // namespace Drive
