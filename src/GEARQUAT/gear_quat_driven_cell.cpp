/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_driven_cell.h"

#include "gear_quat_images.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "domain.h"
#include "fix.h"
#include "force.h"
#include "kspace.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/// Without temp: words of a thermostat without chains, whose temperature only scales sums.
static ThermostatWords words_of(const ThermostatWords &words)
{
  if (words.damp > 0.0) return words;
  ThermostatWords idle = words;
  idle.length = 0;
  idle.damp = 1.0;
  return idle;
}

DrivenCell::DrivenCell(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const ThermostatWords &words,
                       const Scheme &scheme) :
    Thermostat(lmp, fix, bodies, words_of(words), scheme),
    scheme(scheme), matrix(Upper::one()), inverse(Upper::one())
{
}

/* ----------------------------------------------------------------------
   boxes
------------------------------------------------------------------------- */

DrivenCell::Cell DrivenCell::present() const
{
  Cell found;
  std::copy_n(domain->h, 6, found.h.begin());
  std::copy_n(domain->boxlo, 3, found.h.begin() + 6);
  return found;
}

void DrivenCell::show(const Cell &cell)
{
  for (int k = 0; k < 3; ++k) {
    domain->boxlo[k] = cell.h[6 + k];
    domain->boxhi[k] = cell.h[6 + k] + cell.h[k];
  }
  if (domain->triclinic) {
    domain->yz = cell.h[Upper::YZ];
    domain->xz = cell.h[Upper::XZ];
    domain->xy = cell.h[Upper::XY];
  }
  domain->set_global_box();
  domain->set_local_box();
}

/// The box that fix deform will make at the end of that step.  No atom is remapped, and no box
/// flipped.
DrivenCell::Cell DrivenCell::ask(bigint step)
{
  asking = true;
  const int natoms = atom->nlocal, periodic[2] = {domain->xperiodic, domain->yperiodic};
  const bigint now = update->ntimestep;
  double rates[9];
  std::copy_n(domain->h_rate, 6, rates);
  std::copy_n(domain->h_ratelo, 3, rates + 6);
  atom->nlocal = domain->xperiodic = domain->yperiodic = 0;
  update->ntimestep = step;
  driver->end_of_step();
  update->ntimestep = now;
  atom->nlocal = natoms;
  domain->xperiodic = periodic[0];
  domain->yperiodic = periodic[1];
  std::copy_n(rates, 6, domain->h_rate);
  std::copy_n(rates + 6, 3, domain->h_ratelo);
  asking = false;
  return present();
}

/// The polynomial through KNOWN boxes from `first` on, at a time in steps of h.  Returns G.
Upper DrivenCell::interpolate(int first, double time, double h, Cell &cell) const
{
  cell = Cell();
  Upper change;
  for (int k = 0; k < KNOWN; ++k) {
    double value = 1.0, slope = 0.0;
    for (int j = 0; j < KNOWN; ++j) {
      if (j == k) continue;
      const double way = time - (first + j), distance = k - j;
      slope = (slope * way + value) / distance;
      value *= way / distance;
    }
    const auto &known = cells[PAST + first + k].h;
    for (size_t c = 0; c < known.size(); ++c) cell.h[c] += value * known[c];
    for (int c = 0; c < Upper::SIZE; ++c) change[c] += slope * known[c];
  }
  return change.scaled(1.0 / h) * cell.edges().inverse();
}

/// Sets M for the mapping of states.
void DrivenCell::move_to(const Cell &cell)
{
  shown = cell;
  matrix = remaps ? cell.edges() * reference.edges().inverse() : Upper::one();
  inverse = matrix.inverse();
  if (!remaps) rate = Upper();
}

void DrivenCell::to_space(const double *scaled, double *space) const
{
  double way[3];
  for (int k = 0; k < 3; ++k) way[k] = scaled[k] - reference.h[6 + k];
  matrix.times(way, space);
  for (int k = 0; k < 3; ++k) space[k] += shown.h[6 + k];
}

void DrivenCell::to_space(BodyState &s) const
{
  const BodyState before = s;
  to_space(before.center, s.center);
  matrix.times(before.velocity, s.velocity);
}

BodyState DrivenCell::scaled(const BodyState &s) const
{
  BodyState found = s;
  if (!remaps) return found;
  double way[3];
  for (int k = 0; k < 3; ++k) way[k] = s.center[k] - shown.h[6 + k];
  inverse.times(way, found.center);
  for (int k = 0; k < 3; ++k) found.center[k] += reference.h[6 + k];
  inverse.times(s.velocity, found.velocity);
  return found;
}

/// In such a step fix deform changes the box before forces are evaluated.
bool DrivenCell::is_flip_due() const
{
  return driver->next_reneighbor == update->ntimestep;
}

void DrivenCell::put_back_box()
{
  if (ahead) show(begun);
  ahead = false;
}

/// Converts earlier boxes to cells of the same lattice as the current box.
void DrivenCell::note_box()
{
  const Cell now = present();
  Cell foretold;
  interpolate(-PAST, 1.0, 1.0, foretold);
  std::copy(cells.begin() + 1, cells.begin() + PAST + 1, cells.begin());
  cells[PAST] = now;
  const auto periods = [](double way, double period) {
    return std::round(way / period);
  };
  const double p = periods(now.h[Upper::YZ] - foretold.h[Upper::YZ], now.h[Upper::YY]);
  const double n = periods(now.h[Upper::XZ] - foretold.h[Upper::XZ] - p * foretold.h[Upper::XY],
                           now.h[Upper::XX]);
  const double m = periods(now.h[Upper::XY] - foretold.h[Upper::XY], now.h[Upper::XX]);
  for (int k = 0; k < PAST; ++k) {
    auto &h = cells[k].h;
    h[Upper::YZ] += p * h[Upper::YY];
    h[Upper::XZ] += p * h[Upper::XY] + n * h[Upper::XX];
    h[Upper::XY] += m * h[Upper::XX];
  }
}

/* ----------------------------------------------------------------------
   before a run, and the start
------------------------------------------------------------------------- */

void DrivenCell::begin_run(bool begins, double h)
{
  if (!acts() && words.start == 0.0) {
    double here = 0.0;
    for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
      here += translational_energy(bodies.rigid_of(ibody), bodies.state_of(ibody).velocity);
    words.start = over_ranks(MPI_SUM, here, world) * force->mvv2e /
        (force->boltz * std::max<bigint>(1, bodies.number()));
    if (words.start == 0.0) words.start = 1.0;
    words.stop = words.start;
  }
  reference = present();
  remaps = false;
  for (int k = -PAST; k <= AHEAD; ++k) cells[PAST + k] = ask(update->ntimestep + k);
  cells[PAST] = reference;
  no_step = true;
  width = h;
  leave_nodes();
  Thermostat::begin_run(begins, h);
}

void DrivenCell::enter_node(const StartNodes &nodes, int node)
{
  Cell there;
  rate = interpolate(-AHEAD, node * nodes.spacing / nodes.h, nodes.h, there);
  move_to(there);
  show(there);
  if (force->kspace) force->kspace->setup();
  for_moved([this](int ibody) {
    BodyState &state = bodies.change_state(ibody);
    if (remaps) {
      to_space(state);
      return;
    }
    const Upper change = shown.edges() - reference.edges();
    double way[3];
    through(change.m.data(), bodies.body_at(ibody).image.data(), way);
    add3(way, state.center);
  });
}

void DrivenCell::visit_node(const StartNodes &nodes, int node)
{
  Thermostat::visit_node(nodes, node);
  note_friction_of_cell();
}

void DrivenCell::leave_nodes()
{
  Cell now;
  rate = interpolate(-AHEAD, 0.0, width, now);
  move_to(reference);
  show(reference);
  if (force->kspace) force->kspace->setup();
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

/// Updates all quantities that depend on M, G and the friction of the thermostat.
void DrivenCell::note_friction_of_cell()
{
  constexpr double NO_WEIGHTS[3] = {0.0, 0.0, 0.0};
  of_all = CellFriction(Thermostat::of_all, matrix, rate, NO_WEIGHTS, 1.0);
}

void DrivenCell::measure()
{
  Thermostat::measure();
  note_friction_of_cell();
}

const DrivenCell::Cell &DrivenCell::foretell()
{
  if (!no_step) note_box();
  no_step = false;
  begun = reference = present();
  rate = interpolate(-PAST, 1.0, update->dt, then);
  face_rate = rate * then.edges();
  ahead = !is_flip_due();
  if (!ahead) then = begun;
  return then;
}

void DrivenCell::predict(const Integrator &integrator)
{
  width = integrator.step();
  move_to(then);
  if (ahead) show(then);
  if (force->kspace) force->kspace->setup();
  if (!remaps) return;
  for_moved([this](int ibody) {
    to_space(bodies.change_state(ibody));
  });
}

void DrivenCell::correct(const Integrator &integrator, int passes)
{
  correct_by_passes(*this, integrator, passes);
  refer_to_shown();
}

void DrivenCell::find_friction(const Integrator &integrator, int pass)
{
  Thermostat::find_friction(integrator, pass);
  note_friction_of_cell();
}

/// scaled_velocity: M^-1 v
void DrivenCell::add(int ibody, const double *scaled_velocity, const double *omega_body,
                     const Integrator::Pending &)
{
  double velocity[3];
  matrix.times(scaled_velocity, velocity);
  add_kinetic(ibody, velocity, omega_body, here);
}

void DrivenCell::finish(const Integrator &, const RigidBody &, double *rows) const
{
  rows_to_space(rows);
}

void DrivenCell::remap(const std::vector<double> &before, bool histories)
{
  std::copy_n(before.begin(), reference.h.size(), reference.h.begin());
  move_to(present());
  for_moved([&](int ibody) {
    to_space(bodies.change_state(ibody));
    if (histories) rows_to_space(bodies.history(ibody));
  });
  refer_to_shown();
}

/// Converts states and histories to the present box.
void DrivenCell::refer_to_shown()
{
  reference = shown;
  matrix = inverse = Upper::one();
}

/// Makes the present box the reference of the history.
void DrivenCell::rows_to_space(double *rows) const
{
  if (!remaps) return;
  const int width = scheme.width(), nrows = scheme.size() / width;
  double now[3];
  to_space(rows + Scheme::POSITION, now);
  for (int j = 0; j < nrows; ++j) {
    double *row = rows + j * width, moved[3];
    matrix.times(row + Scheme::POSITION, moved);
    std::copy_n(moved, 3, row + Scheme::POSITION);
    if (!scheme.first()) continue;
    matrix.times(row + Scheme::MOMENTUM, moved);
    std::copy_n(moved, 3, row + Scheme::MOMENTUM);
  }
  std::copy_n(now, 3, rows + Scheme::POSITION);
}

/// state: already unscaled.
void DrivenCell::place(int ibody, const Integrator::Pending &pending, BodyState &state,
                       Correction &last) const
{
  if (!remaps) return;
  double predicted[3], way[3], scaled_way[3];
  to_space(pending.x, predicted);
  for (int k = 0; k < 3; ++k) way[k] = state.center[k] - predicted[k];
  inverse.times(way, scaled_way);
  const double *force = bodies.load_of(ibody).force;
  last.work += dot3(force, way) - dot3(force, scaled_way);
}
