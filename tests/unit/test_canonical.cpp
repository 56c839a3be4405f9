/* Chains generate canonical distributions: for a rotor with a harmonic potential, and for a body
   held by a spring and a field.  A single variable does not: S. Nose, Prog.  Theor.  Phys. Suppl.
   103, 1 (1991). */

#include "thermostatted.h"

#include <cstdio>

using namespace Thermostatted;

namespace {

constexpr int SAMPLES = 4000;
constexpr double KT = 1.0;
/// A probability below which one in a hundred runs of all these tests falls (C. E. Bonferroni,
/// 1936).
constexpr double RARE = 0.01 / 11;

/// Kolmogorov's test: the probability that samples of this distribution deviate more from it.  cdf:
/// of the distribution.  Asymptotic in the number of samples (A. N. Kolmogorov, 1933).
template <class Cdf> double probability(vector<double> samples, Cdf cdf)
{
  std::sort(samples.begin(), samples.end());
  const double n = samples.size();
  double distance = 0.0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const double expected = cdf(samples[i]);
    distance = std::max({distance, (i + 1) / n - expected, expected - i / n});
  }
  const double z = distance * std::sqrt(n);
  if (z < 0.2) return 1.0;
  double sum = 0.0;
  for (int k = 1; k < 100; ++k) sum += (k % 2 ? 2.0 : -2.0) * std::exp(-2.0 * k * k * z * z);
  return sum;
}

double normal(double x)
{
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// Chi-square with an odd or even number of degrees of freedom, by its recurrence.
double chi_square(double x, int freedoms)
{
  double p = freedoms % 2 ? std::erf(std::sqrt(0.5 * x)) : 1.0 - std::exp(-0.5 * x);
  for (int f = freedoms % 2 ? 1 : 2; f < freedoms; f += 2)
    p -= std::exp(0.5 * f * std::log(0.5 * x) - 0.5 * x - std::lgamma(0.5 * f + 1.0));
  return p;
}

/// cos of an angle to a field: density ~ exp(strength u)
double in_field(double u, double strength)
{
  return (std::exp(strength * (u + 1.0)) - 1.0) / (std::exp(2.0 * strength) - 1.0);
}

Scheme fast_scheme(Formulation formulation)
{
  return scheme_of(formulation, formulation == MOMENTUM ? 5 : 6, 2);
}

// --- a rotor about z: potential STIFF/2 angle^2

constexpr double STIFF = 1.0, MOMENT = 1.0;

struct Rotor {
  vector<double> angle, rate, energy;
};

Rotor rotor(Formulation formulation, int length)
{
  const auto load = [](const vector<BodyState> &s) {
    return vector<Load>{{{}, {0.0, 0.0, -STIFF * angle_about_z(s[0].q)}}};
  };
  // so narrow that the angle stays within half a turn
  constexpr double COLD = 0.25;
  Host host{{{1.0, {MOMENT, MOMENT, MOMENT}}},
            {{{}, {0, 0, 0, 1}, {}, {0.0, 0.0, 0.5}}},
            load,
            constant_target(COLD, 1.0, 1.0),
            fast_scheme(formulation),
            length,
            0.1};
  Rotor found;
  const int every = 940;
  int n = 0;
  host.run(host.h * every * (length > 1 ? SAMPLES : SAMPLES / 4), [&] {
    if (++n % every) return;
    const double angle = angle_about_z(host.states[0].q), rate = host.states[0].omega_body[2];
    found.angle.push_back(angle * std::sqrt(STIFF / COLD));
    found.rate.push_back(rate * std::sqrt(MOMENT / COLD));
    found.energy.push_back((STIFF * angle * angle + MOMENT * rate * rate) / COLD);
  });
  return found;
}

// --- a body on springs at a site off its center, its third axis in a field along z

constexpr double SPRINGS[3] = {1.0, 1.7, 2.6}, FIELD = 1.5, ARM[3] = {0.5, -0.3, 0.4};
const RigidBody HELD = {1.0, {0.9, 0.7, 0.4}};

void site_and_axis(const BodyState &s, double *arm, double *site, double *axis)
{
  double a[9];
  rotation_matrix(s.q, dot4(s.q, s.q), a);
  to_space(a, ARM, arm);
  for (int k = 0; k < 3; ++k) {
    site[k] = s.center[k] + arm[k];
    axis[k] = a[6 + k];
  }
}

vector<Load> hold(const vector<BodyState> &states)
{
  double arm[3], site[3], axis[3], turn[3];
  site_and_axis(states[0], arm, site, axis);
  Load load;
  const double field[3] = {0.0, 0.0, FIELD};
  for (int k = 0; k < 3; ++k) load.force[k] = -SPRINGS[k] * site[k];
  cross3(arm, load.force, load.torque_space);
  cross3(axis, field, turn);
  for (int k = 0; k < 3; ++k) load.torque_space[k] += turn[k];
  return {load};
}

struct HeldBody {
  vector<double> cosine, spring, momentum, energy;
};

HeldBody held(Formulation formulation)
{
  Host host{{HELD},
            {{{0.2, 0.1, -0.3}, {0, 0, 0, 1}, {0.8, -0.5, 0.4}, {1.0, 0.6, -0.9}}},
            hold,
            constant_target(KT, 6.0, 0.8),
            fast_scheme(formulation),
            3,
            0.08};
  HeldBody found;
  const int every = 800;
  int n = 0;
  host.run(host.h * every * SAMPLES, [&] {
    if (++n % every) return;
    double arm[3], site[3], axis[3], twice = host.twice_kinetic();
    site_and_axis(host.states[0], arm, site, axis);
    for (int k = 0; k < 3; ++k) twice += SPRINGS[k] * site[k] * site[k];
    found.cosine.push_back(axis[2]);
    found.spring.push_back(site[0] * std::sqrt(SPRINGS[0] / KT));
    found.momentum.push_back(host.states[0].velocity[2] * std::sqrt(HELD.mass / KT));
    found.energy.push_back(twice / KT);
  });
  return found;
}

/// Correlation of each sample with the next one.
double correlation(const vector<double> &x)
{
  double mean = 0.0, square = 0.0, product = 0.0;
  for (const double one : x) mean += one / x.size();
  for (size_t i = 0; i < x.size(); ++i) {
    square += (x[i] - mean) * (x[i] - mean);
    if (i > 0) product += (x[i] - mean) * (x[i - 1] - mean);
  }
  return product / square;
}

/// True if samples are independent and have this distribution.  what: label of the printed
/// probability.
template <class Cdf>
void expect_samples(const char *what, Formulation formulation, const vector<double> &samples,
                    Cdf cdf)
{
  const double p = probability(samples, cdf);
  printf("p = %.4f  %s, %s\n", p, what, word_of(formulation));
  EXPECT_EQ(samples.size(), (size_t) SAMPLES);
  EXPECT_LT(std::fabs(correlation(samples)), 0.05);
  EXPECT_GT(p, RARE);
}

}    // namespace

TEST(Canonical, KolmogorovsTestKnowsDistributions)
{
  EXPECT_NEAR(chi_square(4.351, 5), 0.5, 1.0e-3);
  EXPECT_NEAR(chi_square(5.348, 6), 0.5, 1.0e-3);
  EXPECT_NEAR(in_field(1.0, 2.0), 1.0, 1.0e-15);
  vector<double> uniform;
  for (int i = 0; i < SAMPLES; ++i)
    uniform.push_back((i * 0.6180339887498949) - std::floor(i * 0.6180339887498949));
  const auto identity = [](double x) {
    return std::clamp(x, 0.0, 1.0);
  };
  EXPECT_GT(probability(uniform, identity), 0.99);
  for (double &x : uniform) x = std::pow(x, 1.1);
  EXPECT_LT(probability(uniform, identity), 1.0e-3);
}

TEST(Canonical, AHarmonicRotorNeedsAChain)
{
  const auto energy_of = [](double x) {
    return chi_square(x, 2);
  };
  const Rotor chained = rotor(MOMENTUM, 3), alone = rotor(MOMENTUM, 1);
  expect_samples("angle of the rotor", MOMENTUM, chained.angle, normal);
  expect_samples("rate of the rotor", MOMENTUM, chained.rate, normal);
  expect_samples("energy of the rotor", MOMENTUM, chained.energy, energy_of);
  EXPECT_LT(probability(alone.angle, normal), 1.0e-3);
  EXPECT_LT(probability(alone.energy, energy_of), 1.0e-10);
}

TEST(Canonical, ABodyOnSpringsInAField)
{
  for (const Formulation formulation : {MOMENTUM, FIRST}) {
    const HeldBody found = held(formulation);
    const auto in_this_field = [](double u) {
      return in_field(u, FIELD / KT);
    };
    expect_samples("orientation in the field", formulation, found.cosine, in_this_field);
    expect_samples("place on the springs", formulation, found.spring, normal);
    expect_samples("momentum", formulation, found.momentum, normal);
    expect_samples("energy", formulation, found.energy, [](double x) {
      return chi_square(x, 9);
    });
  }
}
