/* gear_quat_integrator.h, one step, compared with an independent literal implementation of the
   paper's equations; every option of the scheme, and every input number. */

#include "checks.h"
#include "drive.h"
#include "oracles/gear_coefficients.h"
#include "oracles/paper_step.h"

using namespace Drive;
using Check::largest_difference;
using std::vector;

namespace {

const double H = 0.3;

vector<long double> table_of(const Scheme &scheme)
{
  const int n = scheme.values();
  const Oracle::Exact exact = scheme.first()
      ? Oracle::first_order(n)
      : Oracle::second_order(n,
                             scheme.velocity_c0 ? Oracle::velocity_c0(n) : Oracle::position_c0(n));
  vector<long double> table;
  for (const Oracle::Rational &c : exact)
    table.push_back((long double) c.numerator() / (long double) c.denominator());
  return table;
}

/// An arbitrary history, with a quaternion close to but not on |q| = 1.
vector<double> some_history(const Scheme &scheme)
{
  Check::Numbers numbers(31);
  vector<double> rows = numbers.list(scheme.size());
  for (int j = 0; j < scheme.values(); ++j)
    for (int i = 0; i < scheme.width(); ++i) rows[j * scheme.width() + i] *= std::pow(0.2, j);
  for (int k = scheme.values() * scheme.width(); k < scheme.size(); ++k) rows[k] = 0.0;
  double *q = rows.data() + scheme.quaternion();
  project_norm(q);
  for (int i = 0; i < 4; ++i) q[i] *= 1.003;
  return rows;
}

// common input: mass, moments, force, torque
const vector<double> GIVEN = {1.7, 3.0, 2.0, 0.7, 0.4, -0.9, 0.3, 0.25, 0.6, -0.8};

vector<double> kernel_step(const Scheme &scheme, const vector<double> &given)
{
  const RigidBody body = {given[0], {given[1], given[2], given[3]}};
  const Load load = {{given[4], given[5], given[6]}, {given[7], given[8], given[9]}};
  vector<double> rows = some_history(scheme);
  const Integrator integrator(scheme, H);
  integrator.predict(body, rows.data());
  integrator.correct(body, load, rows.data());
  rows.resize(scheme.values() * scheme.width());    // carries are below the digits compared here
  return rows;
}

vector<double> literal_step(const Scheme &scheme, const vector<long double> &table)
{
  Oracle::PaperStep step;
  step.coefficients = table;
  step.dt = H;
  step.mass = GIVEN[0];
  for (int i = 0; i < 3; ++i) {
    step.inertia[i] = GIVEN[1 + i];
    step.force[i] = GIVEN[4 + i];
    step.torque_space[i] = GIVEN[7 + i];
  }
  step.passes = scheme.passes;
  step.predicted_omega = scheme.predicted_omega;
  step.predicted_momentum = scheme.predicted_momentum;
  step.project = scheme.project;

  const vector<double> rows = some_history(scheme);
  const int n = scheme.values(), width = scheme.width();
  Oracle::Derivatives y(n, vector<long double>(width));
  auto factor = [](int j) {
    return std::pow((long double) H, j) / Oracle::PaperStep::factorial(j);
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < width; ++i) y[j][i] = rows[j * width + i] / factor(j);
  if (scheme.first())
    step.first(y);
  else
    step.second(y);
  vector<double> out(n * width);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < width; ++i) out[j * width + i] = double(y[j][i] * factor(j));
  return out;
}

/// The literal step agrees with the kernel's.
void expect_literal(const Scheme &scheme)
{
  const vector<double> paper = literal_step(scheme, table_of(scheme));
  EXPECT_LT(largest_difference(kernel_step(scheme, GIVEN), paper), 2e-15);
}

}    // namespace

TEST(PaperStep, EveryChoiceIsAnotherStep)
{
  for (Formulation formulation : {FIRST, SECOND}) {
    vector<vector<double>> results;
    for (int choice = 0; choice < (formulation == FIRST ? 8 : 4); ++choice) {
      Scheme scheme = scheme_of(formulation);
      scheme.project = choice & 1;
      if (formulation == FIRST) {
        scheme.predicted_omega = choice & 2;
        scheme.predicted_momentum = choice & 4;
      } else {
        scheme.velocity_c0 = choice & 2;
      }
      expect_literal(scheme);
      const vector<double> result = kernel_step(scheme, GIVEN);
      for (const auto &other : results)
        EXPECT_GT(largest_difference(result, other), 1e-5) << choice;
      results.push_back(result);
    }
  }
}

TEST(PaperStep, EveryNumberOfValuesAndPasses)
{
  for (int passes : {1, 2, 3})
    for (bool compensate : {false, true}) {
      for (const Scheme &scheme : every_scheme(passes, compensate)) expect_literal(scheme);
      for (const Scheme &scheme : schemes_of(SECOND, passes, compensate))
        expect_literal(with_velocity_c0(scheme));
    }
}

TEST(PaperStep, ChoicesOfTheOtherFormulationChangeNothing)
{
  Scheme plain = scheme_of(SECOND), other = plain;
  other.predicted_omega = other.predicted_momentum = true;
  EXPECT_EQ(kernel_step(plain, GIVEN), kernel_step(other, GIVEN));
  plain = scheme_of(FIRST);
  EXPECT_EQ(kernel_step(plain, GIVEN), kernel_step(with_velocity_c0(plain), GIVEN));
}
