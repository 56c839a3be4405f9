/* The host with a tolerance, for some bodies and loads that are functions of their states:
   predicts, evaluates, corrects; a failed step is undone, shortened and repeated. */

#pragma once

#include "drive.h"
#include "gear_quat_remembered_loads.h"

namespace Drive {

using std::vector;

struct Follower {
  struct One {
    RigidBody body;
    double reach;
    BodyState state = {};
    vector<double> rows = vector<double>(MAX_SIZE, 0.0);
  };
  /// Loads on all bodies at their states.
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
  long steps = 0, evaluations = 0, repeated = 0;
  RememberedLoads remembered;
  Growth growing = Growth::START;
  Integrator integrator;

  Follower(double eps, bool energy, double h, vector<One> bodies, Loads loads) :
      bodies(std::move(bodies)), loads(std::move(loads)), scheme(RememberedLoads::scheme(true)),
      h(h), remembered(true), integrator(scheme, h, CorrectorCoefficients())
  {
    control.eps = eps;
    control.energy = energy;
  }

  /// Histories from the present loads.
  void begin()
  {
    const vector<Load> met = loads(bodies);
    ++evaluations;
    for (size_t k = 0; k < bodies.size(); ++k) {
      One &one = bodies[k];
      TaylorSeries series = local_series(one.body, one.state, met[k], h);
      seed(scheme, one.body, series, h, h, one.rows.data());
    }
  }

  void set_step(double step)
  {
    for (One &one : bodies) integrator.rescale(one.rows.data(), step / h);
    h = step;
    integrator.set_step(h);
  }

  void change_loads(int loads)
  {
    while (remembered.loads() != loads) {
      remembered.change(loads > remembered.loads(), h, [&](auto act) {
        for (One &one : bodies) act(one.rows.data());
      });
      scheme.rows = remembered.values();
      integrator = Integrator(scheme, h, remembered.coefficients());
    }
  }

  void take_states()
  {
    for (One &one : bodies) one.state = integrator.body_state(one.body, one.rows.data());
  }

  StepErrors try_step()
  {
    StepErrors all;
    remembered.prepare(h);
    integrator = Integrator(scheme, h, remembered.coefficients());
    for (One &one : bodies) integrator.predict(one.body, one.rows.data());
    take_states();
    const vector<Load> met = loads(bodies);
    ++evaluations;
    for (size_t k = 0; k < bodies.size(); ++k) {
      const One &one = bodies[k];
      double *rows = bodies[k].rows.data();
      const auto before = RememberedLoads::accelerations(rows);
      const auto axes = integrator.axes_of(rows);
      integrator.correct(one.body, met[k], rows);
      StepErrors errors = remembered.finish(control, integrator, one.body, one.reach, met[k],
                                            axes.data(), before, rows);
      errors.error *= control.counted(integrator, one.body, one.reach, met[k], rows);
      all.include(errors);
    }
    take_states();
    return all;
  }

  /// An accepted step, possibly after failed tries.
  StepErrors step()
  {
    while (true) {
      const vector<One> before = bodies;
      const StepErrors errors = try_step();
      const double error = errors.error;
      if (!control.fails(error, h)) {
        t += h;
        ++steps;
        remembered.conclude(h);
        largest = std::max(largest, error / control.eps);
        return errors;
      }
      bodies = before;
      ++repeated;
      change(control.repeat(error, h, remembered.loads(), growing));
    }
  }

  void change(const StepControl::Next &next)
  {
    change_loads(next.loads);
    set_step(next.step);
  }

  void follow(const StepErrors &errors)
  {
    change(control.next(errors, h, remembered, growing, farthest(bodies)));
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
