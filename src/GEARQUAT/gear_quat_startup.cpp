/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_startup.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

StartPlan::Verdict StartPlan::take(double change)
{
  if (!std::isfinite(change) || (present == 1 && change > TOO_FAR)) return Verdict::SHORTER_SPACING;
  const double before = is_new() ? first[present - 1]
                                 : std::max(last[present], slowest * first[present]);
  const double falls = is_new() ? FALLS : CONTRACTS;
  if (change > CONVERGED && change > falls * before)
    return change < ROUNDING ? Verdict::CONVERGED : Verdict::JUMPS;
  last[present] = change;
  if (is_new()) {
    known = present;
    first[known] = change;
  } else if (before > 0.0)
    contraction = std::max({contraction == 1.0 ? 0.0 : contraction, change / before, slowest});
  return choose();
}

double StartPlan::left_out() const
{
  if (wanted % 2 || known < 2) return first[known];
  return first[known] * std::min(1.0, first[known] / first[known - 1]);
}

StartPlan::Verdict StartPlan::choose()
{
  const bool more = known < pairs_for(wanted) && first[known] > CONVERGED;
  const double part = wanted % 2 || known < 5 ? ALLOWED : std::ldexp(ALLOWED, 3 * (4 - known));
  const double allowed = more ? 0.0 : std::max(CONVERGED, part * left_out());
  while (present < round)
    if (contraction * last[++present] > allowed) return Verdict::GOES_ON;
  const double next = contraction * *std::max_element(last + 1, last + known + 1);
  // extrapolation to the next pair multiplies errors by up to four for each pair inside
  const bool again = more ? round < known && std::ldexp(next, 2 * known) > CLEAR * first[known]
                          : next > allowed;
  if (!again && !more) return Verdict::CONVERGED;
  if (again) {
    round = known;
    present = 0;
    return choose();
  }
  round = 0;
  present = known + 1;
  return Verdict::GOES_ON;
}

TaylorSeries GearQuat::local_series(const RigidBody &body, const BodyState &state, const Load &load,
                                    double h)
{
  TaylorSeries series;
  series.terms = 3;
  double omegadot_body[3], qdot[4], qddot[4];
  angular_acceleration(body, state, dot4(state.q, state.q), load, omegadot_body);
  quaternion_rate(state.q, state.omega_body, qdot);
  quaternion_acceleration(state.q, qdot, omegadot_body, qddot);
  momentum_along_space(body, state, series.momentum[0]);
  for (int i = 0; i < 3; ++i) {
    series.momentum[0][i] *= h;
    series.momentum[1][i] = h * h * load.torque_space[i];
    series.c[0][i] = state.center[i];
    series.c[1][i] = h * state.velocity[i];
    series.c[2][i] = 0.5 * h * h * load.force[i] / body.mass;
  }
  for (int i = 0; i < 4; ++i) {
    series.c[0][3 + i] = state.q[i];
    series.c[1][3 + i] = h * qdot[i];
    series.c[2][3 + i] = 0.5 * h * h * qddot[i];
  }
  return series;
}

void GearQuat::seed(const Scheme &scheme, const RigidBody &body, const TaylorSeries &series,
                    double series_step, double h, double *rows)
{
  const int n = scheme.values(), width = scheme.width(), quat = scheme.quaternion();
  const double ratio = h / series_step;
  for (int i = 0; i < scheme.size(); ++i) rows[i] = 0.0;

  double power = 1.0;
  for (int j = 0; j < n && j < series.terms_of_q(); ++j, power *= ratio) {
    double *row = rows + j * width;
    const bool known = j < series.terms;
    for (int i = 0; i < 3 && known; ++i) row[Scheme::POSITION + i] = power * series.c[j][i];
    if (!scheme.momentum() || j == 0)
      for (int i = 0; i < 4; ++i) row[quat + i] = power * series.c[j][3 + i];
    else if (known)
      for (int i = 0; i < 3; ++i)
        row[Scheme::ANGULAR_MOMENTUM + i] = power / j * series.momentum[j - 1][i];
  }
  if (!scheme.first()) return;

  // p = m x' and omega = 2 W(q)^T q', term by term

  power = 1.0 / series_step;
  for (int j = 0; j < n && j + 1 < series.terms_of_q(); ++j, power *= ratio) {
    double *row = rows + j * width;
    for (int i = 0; i < 3; ++i)
      row[Scheme::MOMENTUM + i] = power * body.mass * (j + 1) * series.c[j + 1][i];
    for (int k = 0; k <= j; ++k) {
      double product[3];
      w_transposed_times(series.c[k] + 3, series.c[j + 1 - k] + 3, product);
      for (int i = 0; i < 3; ++i) row[Scheme::OMEGA + i] += power * 2.0 * (j + 1 - k) * product[i];
    }
  }
}

void Collocation::Polynomial::make(int pairs)
{
  for (int l = -pairs; l <= pairs; ++l) {
    const int column = column_of(l);
    long double basis[MAX_NODES] = {1.0L}, denominator = 1.0L;    // Lagrange's, factor by factor
    int degree = 0;
    for (int root = -pairs; root <= pairs; ++root) {
      if (root == l) continue;
      ++degree;
      for (int j = degree; j >= 0; --j)
        basis[j] = (j > 0 ? basis[j - 1] : 0.0L) - root * (j < degree ? basis[j] : 0.0L);
      denominator *= l - root;
    }
    for (int j = 0; j <= 2 * pairs; ++j) monomial[j][column] = basis[j] / denominator;

    for (int k = -pairs; k <= pairs; ++k) {
      long double twice = 0.0, once = 0.0, power = k;
      for (int j = 0; j <= 2 * pairs; ++j) {
        once += monomial[j][column] * power / (j + 1);
        power *= k;
        twice += monomial[j][column] * power / ((j + 1) * (j + 2));
      }
      value[column_of(k)][column] = double(twice);
      rate[column_of(k)][column] = double(once);
    }
    for (int side = 0; side < 2; ++side) {
      long double sum = 0.0, power = 1.0;
      for (int j = 0; j <= 2 * pairs; ++j, power *= side ? pairs + 1 : -pairs - 1)
        sum += monomial[j][column] * power;
      beyond[side][column] = double(sum);
    }
  }
}

Collocation::Collocation(int values) : half(StartPlan::pairs_for(values)), polynomial(half + 1)
{
  for (int pairs = 0; pairs <= half; ++pairs) polynomial[pairs].make(pairs);
}

void Collocation::begin(const RigidBody &body, const TaylorSeries &series, Workspace &w) const
{
  w.pairs = 0;
  w.body = body;
  std::copy_n(series.c[0] + 3, 4, w.q);
  for (int i = 0; i < 3; ++i) {
    w.start[0][i] = series.c[0][i];
    w.start[1][i] = series.c[1][i];
    w.rate[i][half] = 2.0 * series.c[2][i];
    w.start[0][3 + i] = 0.0;
    w.start[1][3 + i] = series.momentum[0][i];
    w.rate[3 + i][half] = series.momentum[1][i];
  }
}

void Collocation::begin(const double *value, const double *first, const double *second,
                        Nodes &w) const
{
  w.pairs = 0;
  for (int i = 0; i < WIDTH; ++i) {
    w.start[0][i] = value[i];
    w.start[1][i] = first[i];
    w.rate[i][half] = second[i];
  }
}

void Collocation::begin(double start, double rate, Scalar &s) const
{
  s.width = 1;
  s.pairs = 0;
  s.start[0][0] = start;
  s.rate[0][half] = rate;
}

void Collocation::foretell(Nodes &w) const
{
  const Polynomial &inside = polynomial[w.pairs];
  const int next = w.pairs + 1;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < w.width; ++i) {
      double sum = 0.0;
      for (int l = -w.pairs; l <= w.pairs; ++l)
        sum += inside.beyond[side][column_of(l)] * w.rate[i][half + l];
      w.rate[i][half + (side ? next : -next)] = sum;
    }
  w.pairs = next;
}

void Collocation::values_at(int node, const Nodes &w, double *value, double *rate) const
{
  const Polynomial &present = polynomial[w.pairs];
  for (int i = 0; i < WIDTH; ++i) {
    value[i] = w.start[0][i] + node * w.start[1][i];
    rate[i] = w.start[1][i];
    for (int l = -w.pairs; l <= w.pairs; ++l) {
      value[i] += present.value[column_of(node)][column_of(l)] * w.rate[i][half + l];
      rate[i] += present.rate[column_of(node)][column_of(l)] * w.rate[i][half + l];
    }
  }
}

BodyState Collocation::state_at(int node, const Workspace &w, double spacing) const
{
  double value[6], rate[6], axes[9];
  values_at(node, w, value, rate);
  BodyState state;
  for (int i = 0; i < 3; ++i) {
    state.center[i] = value[i];
    state.velocity[i] = rate[i] / spacing;
  }
  std::copy_n(w.q, 4, state.q);
  if (w.body.rotational_freedoms() > 0) {
    Turn::Momentum momentum;
    const int terms = momentum_of(w, w.pairs, node, momentum);
    Turn(terms).advance(w.body, momentum, state.q);
  }
  rotation_matrix(state.q, 1.0, axes);
  to_body(axes, rate + 3, state.omega_body);
  for (int i = 0; i < 3; ++i)
    state.omega_body[i] *= w.body.inertia[i] > 0.0 ? 1.0 / (spacing * w.body.inertia[i]) : 0.0;
  return state;
}

double Collocation::set_load(int node, const RigidBody &body, const BodyState &state,
                             const Load &load, double spacing, double length, Workspace &w) const
{
  double *met = w.met[node > 0], change[6];
  for (int i = 0; i < 3; ++i) {
    met[i] = spacing * spacing * load.force[i] / body.mass;
    met[3 + i] = spacing * spacing * load.torque_space[i];
  }
  for (int i = 0; i < 6; ++i) {
    if (!std::isfinite(met[i])) return std::numeric_limits<double>::infinity();
    change[i] = met[i] - w.rate[i][half + node];
  }
  return relative(change, met, state, length, w);
}

void Collocation::settle(int pair, Nodes &w) const
{
  for (int i = 0; i < w.width; ++i) {
    w.rate[i][half - pair] = w.met[0][i];
    w.rate[i][half + pair] = w.met[1][i];
  }
}

TaylorSeries Collocation::series(const Workspace &w, int pairs) const
{
  TaylorSeries series;
  double c[TaylorSeries::MAX_TERMS][6], q[Turn::MOST + 1][4] = {};
  series.terms = terms_of(pairs);
  static_assert(MAX_NODES + 2 <= TaylorSeries::MAX_TERMS, "series too short for the nodes");
  expand(w, pairs, c[0]);
  const int terms = momentum_of(w, pairs, 1, series.momentum);
  std::copy_n(w.q, 4, q[0]);
  if (w.body.rotational_freedoms() > 0) Turn::coefficients(w.body, series.momentum, terms, w.q, q);
  for (int j = 0; j < TaylorSeries::MAX_TERMS; ++j) {
    for (int i = 0; i < 3; ++i) series.c[j][i] = j < series.terms ? c[j][i] : 0.0;
    std::copy_n(q[j], 4, series.c[j] + 3);
  }
  return series;
}

void Collocation::expand(const Nodes &w, int pairs, double *c) const
{
  for (int i = 0; i < WIDTH; ++i) {
    c[i] = w.start[0][i];
    c[WIDTH + i] = w.start[1][i];
    for (int j = 0; j + 2 < terms_of(pairs); ++j)
      c[WIDTH * (j + 2) + i] = double(coefficient(j, i, w, pairs) / ((j + 1) * (j + 2)));
  }
}

int Collocation::series(const Scalar &s, int pairs, double spacing, double *c) const
{
  c[0] = s.start[0][0];
  for (int j = 0; j <= 2 * pairs; ++j)
    c[j + 1] = double(spacing * coefficient(j, 0, s, pairs) / (j + 1));
  return 2 * pairs + 2;
}

long double Collocation::coefficient(int j, int i, const Nodes &w, int pairs) const
{
  long double sum = 0.0;
  for (int l = -pairs; l <= pairs; ++l)
    sum += polynomial[pairs].monomial[j][column_of(l)] * w.rate[i][half + l];
  return sum;
}

int Collocation::momentum_of(const Workspace &w, int pairs, double spacings,
                             Turn::Momentum &found) const
{
  double c[TaylorSeries::MAX_TERMS][6], power = spacings;
  expand(w, pairs, c[0]);
  const int terms = terms_of(pairs) - 1;
  for (int k = 0; k < terms; ++k, power *= spacings)
    for (int i = 0; i < 3; ++i) found[k][i] = power * (k + 1) * c[k + 1][3 + i];
  return terms;
}

double Collocation::relative(const double *change, const double *second, const BodyState &state,
                             double length, const Workspace &w)
{
  double part[2] = {0.0, 0.0}, scale[2] = {SMALLEST * length, SMALLEST}, axes[9];
  rotation_matrix(state.q, dot4(state.q, state.q), axes);
  for (int p = 0; p < 2; ++p) {
    double of[3][3];
    const double *from[] = {change + 3 * p, w.start[1] + 3 * p, second + 3 * p};
    for (int k = 0; k < 3; ++k)
      p == 0 ? (void) std::copy_n(from[k], 3, of[k]) : to_body(axes, from[k], of[k]);
    for (int i = 0; i < 3; ++i) {
      const double unit = p == 0 ? 1.0 : w.body.inertia[i] > 0.0 ? 0.5 / w.body.inertia[i] : 0.0;
      part[p] = std::max(part[p], unit * std::fabs(of[0][i]));
      scale[p] = std::max({scale[p], unit * std::fabs(of[1][i]), unit * std::fabs(of[2][i])});
    }
  }
  return std::max(part[0] / scale[0], part[1] / scale[1]);
}
