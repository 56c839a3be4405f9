/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_barostat.h"

#include "gear_quat_known_styles.h"
#include "gear_quat_limits.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "kspace.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/// Without temp: words of a thermostat without chains, with the temperature for the box's mass.
static ThermostatWords words_of(const ThermostatWords &words, const PressureWords &pressure)
{
  if (words.damp > 0.0) return words;
  ThermostatWords idle = words;
  idle.start = idle.stop = pressure.temperature;
  idle.length = 0;
  for (int k = 0; k < PressureWords::COMPONENTS; ++k)
    if (pressure.on[k]) idle.damp = std::max(idle.damp, pressure.period[k]);
  return idle;
}

/// A scalar has first-order coefficients in both formulations.
void Barostat::set_heat(const Scheme &scheme)
{
  Scheme of_heat;
  of_heat.formulation = Formulation::FIRST;
  const int values = CellHistory::scheme_of(scheme).values() - scheme.remembers;
  of_heat.rows = values_of_heat = std::min(values, FIRST_MOST);
  heat_coefficients = CorrectorCoefficients(of_heat).c;
}

Barostat::Barostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const Sites &sites,
                   const ThermostatWords &words, const PressureWords &pressure,
                   const Scheme &scheme) :
    Thermostat(lmp, fix, bodies, words_of(words, pressure), scheme),
    asked(pressure), virial(lmp, fix, sites), box(lmp, pressure.fixed), cell(scheme),
    chain(std::max(1, pressure.length)), matrix(Upper::one()), changing_step(scheme.remembers),
    inverse(Upper::one())
{
  set_heat(scheme);
  frequency.set_period(period());
  frequency.set_fastest(fastest_oscillation(CellHistory::scheme_of(scheme)));
  cell.begin(Upper(), 1.0);
}

void Barostat::set_scheme(const Scheme &scheme)
{
  Thermostat::set_scheme(scheme);
  cell.set_scheme(scheme);
  frequency.set_fastest(fastest_oscillation(CellHistory::scheme_of(scheme)));
  set_heat(scheme);
}

/* ----------------------------------------------------------------------
   the box's equation of motion
------------------------------------------------------------------------- */

double Barostat::dimensions() const
{
  return domain->dimension;
}

/// The weight b of the trace term.
double Barostat::weight_of(int direction) const
{
  const int d = domain->dimension;
  if (direction >= d) return 0.0;
  return (asked.shears() ? d - 2.0 * direction : 1.0) / freedoms[TRANSLATION];
}

double Barostat::volume() const
{
  return box.volume(matrix);
}

/// W of a component; Pdamp of coupled components is the same.
double Barostat::mass_of(int component) const
{
  const double d = dimensions(), period = asked.period[component];
  return (freedoms[TRANSLATION] + d) * kt * period * period / d;
}

/// Masses of the components that move, 0 for others.
Upper Barostat::masses() const
{
  Upper found;
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) found[k] = mass_of(k);
  return found;
}

double Barostat::twice_kinetic_of_box() const
{
  double sum = 0.0;
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) sum += mass_of(k) * rate[k] * rate[k];
  return sum;
}

/// Coupled directions have one degree of freedom.
int Barostat::free_components() const
{
  int count = 0;
  for (int k = 0; k < Upper::SIZE; ++k) count += asked.on[k] && (k >= 3 || asked.tied[k] == k);
  return count;
}

ChainTarget Barostat::target_of_box(double steps_ahead, double h) const
{
  ChainTarget of_box;
  of_box.kt = line.kt + line.kt_step * steps_ahead;
  of_box.kt_rate = h == 0.0 ? 0.0 : line.kt_step / h;
  of_box.freedoms = free_components();
  of_box.period = period();
  return of_box;
}

/// The shortest damping time.
double Barostat::period() const
{
  double shortest = HUGE_VAL;
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) shortest = std::min(shortest, asked.period[k]);
  return shortest;
}

double Barostat::mean_target(const Upper &pressures) const
{
  double sum = 0.0, directions = 0.0;
  for (int k = 0; k < 3; ++k)
    if (asked.on[k]) {
      sum += pressures[k];
      ++directions;
    }
  return directions > 0.0 ? sum / directions : 0.0;
}

/// Linear in the number of the step, as in LAMMPS' barostats.
void Barostat::find_target(bigint step, double h)
{
  const bigint steps = update->endstep - update->beginstep;
  const double part = steps > 0 ? double(step - update->beginstep) / steps : 0.0;
  const double unit = 1.0 / (force->nktv2p * force->mvv2e);
  kt = line.kt;
  for (int k = 0; k < Upper::SIZE; ++k) {
    target[k] = unit * (asked.start[k] + part * (asked.stop[k] - asked.start[k]));
    target_rate[k] = steps > 0 && h != 0.0 ? unit * (asked.stop[k] - asked.start[k]) / (steps * h)
                                           : 0.0;
  }
}

/// Advances the target from the start to another time.
void Barostat::move_target(double time)
{
  target = target_at_start + target_rate.scaled(time);
  kt = line.kt + (width != 0.0 ? time / width * line.kt_step : 0.0);
}

/// G' without the friction of the box.
Upper Barostat::drive() const
{
  Upper found;
  const double v = volume(), trace = kinetic.trace();
  for (int k = 0; k < Upper::SIZE; ++k) {
    if (!asked.on[k]) continue;
    double push = kinetic[k] + virial.value()[k] - target[k] * v;
    if (k < 3) push += weight_of(k) * trace;
    found[k] = push / mass_of(k);
  }
  for (int first = 0; first < 3; ++first) {
    double sum = 0.0, count = 0.0;
    for (int k = first; k < 3; ++k)
      if (asked.on[k] && asked.tied[k] == first) {
        sum += found[k];
        ++count;
      }
    for (int k = first; k < 3; ++k)
      if (asked.on[k] && asked.tied[k] == first) found[k] = sum / count;
  }
  return found;
}

/// S' of Eq. P7.
double Barostat::rate_of_heat() const
{
  double sum = 0.0;
  const double mean = mean_target(target), v = volume();
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) sum += v * (target[k] - (k < 3 ? mean : 0.0)) * rate[k];
  // only directions that move contribute to the mean
  sum -= v * mean_target(target_rate);
  const double kt_rate = width != 0.0 ? line.kt_step / width : 0.0;
  return sum - 0.5 * kt_rate / kt * twice_kinetic_of_box();
}

/* ----------------------------------------------------------------------
   sums over bodies
------------------------------------------------------------------------- */

/// The first `count` components.
void Barostat::add_momenta(int ibody, const double *velocity, Tensor &sums, int count) const
{
  const double mass = bodies.rigid_of(ibody).mass;
  for (int k = 0; k < count; ++k)
    sums[k].add(mass * velocity[Upper::ROW[k]] * velocity[Upper::COLUMN[k]], unit);
}

void Barostat::sum_momenta(const Tensor &sums)
{
  bigint limbs[ExactSum::LIMBS * Upper::SIZE];
  for (int k = 0; k < Upper::SIZE; ++k)
    std::copy_n(sums[k].limbs, ExactSum::LIMBS, limbs + ExactSum::LIMBS * k);
  const auto all = over_ranks(MPI_SUM, limbs, world);
  for (int k = 0; k < Upper::SIZE; ++k) {
    ExactSum sum;
    std::copy_n(all.begin() + ExactSum::LIMBS * k, ExactSum::LIMBS, sum.limbs);
    kinetic[k] = sum.value(unit) - total.twice_energy(Upper::ROW[k], Upper::COLUMN[k]);
  }
}

void Barostat::sum_present_momenta()
{
  Tensor sums;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    add_momenta(ibody, bodies.state_of(ibody).velocity, sums, Upper::SIZE);
  sum_momenta(sums);
}

/// Updates all quantities that depend on M and G.
void Barostat::note_box()
{
  const double weights[3] = {weight_of(0), weight_of(1), weight_of(2)};
  inverse = matrix.inverse();
  of_all = CellFriction(Thermostat::of_all, matrix, rate, weights);
}

void Barostat::measure()
{
  Thermostat::measure();
  sum_present_momenta();
  matrix = cell.matrix();
  if (width != 0.0) rate = cell.rate(width);
  friction_of_box = friction_now();
  note_box();
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Barostat::predict(const Integrator &integrator)
{
  prepare(integrator.step());
  cell.predict();
  matrix = cell.matrix();
  rate = cell.rate(integrator.step());
  refuse_box();
  box.set(matrix);
  box.show(true);
  for_moved([this](int ibody) {
    box.to_space(bodies.change_state(ibody));
  });
}

bool Barostat::others_ask_for_virial() const
{
  return virial.others_ask(update->ntimestep);
}

void Barostat::correct(const Integrator &integrator, int passes)
{
  correct_by_passes(*this, integrator, passes);
  box.show(false);
  virial.request(update->ntimestep + 1);
}

bool Barostat::is_tilted() const
{
  return asked.shears() && asked.flip && box.is_tilted();
}

void Barostat::flip_box()
{
  if (is_tilted()) box.flip();
}

void Barostat::begin_passes(const Integrator &integrator)
{
  Thermostat::begin_passes(integrator);
  width = integrator.step();
  std::copy_n(asked.period, Upper::SIZE, periods.begin());
  find_target(update->ntimestep, width);
  for (auto &sum : tensor) sum = ExactSum();
}

void Barostat::add_prediction(const Integrator &integrator, int ibody,
                              const Integrator::Pending &pending)
{
  Thermostat::add_prediction(integrator, ibody, pending);
  add_momenta(ibody, bodies.state_of(ibody).velocity, tensor, moving_components());
}

void Barostat::find_friction(const Integrator &integrator, int pass)
{
  const double h = integrator.step();
  Thermostat::find_friction(integrator, pass);
  sum_momenta(tensor);
  for (auto &sum : tensor) sum = ExactSum();
  if (chain_acts()) advance_box(h, integrator.values());
  friction_of_box = friction_now();
  cell.pass(drive(), friction_of_box, h);
  matrix = cell.matrix();
  rate = cell.rate(h);
  note_box();
}

/// now: the drive at the present poses and in their box.
void Barostat::note_drive(const Upper &now)
{
  for (int k = 0; k < Upper::SIZE; ++k)
    if (std::isfinite(now[k])) strongest[k] = std::max(strongest[k], std::fabs(now[k]));
}

/// A damping time with which the strongest drive of this run does not change the box too much in a
/// step.  A drive d causes a strain rate of sqrt(2 d) until the box has changed by its own size, and
/// of d/omega in an oscillation with this angular frequency, 0 if it is not known.  Both rates are
/// proportional to 1/Pdamp.
double Barostat::period_for_drive(double omega) const
{
  constexpr double MARGIN = 1.3;    // the oscillation is not harmonic
  double needed = 0.0;
  for (int k = 0; k < Upper::SIZE; ++k) {
    if (!asked.on[k]) continue;
    const double most = std::sqrt(2.0 * strongest[k]);
    const double rate = omega > 0.0 ? std::min(most, MARGIN * strongest[k] / omega) : most;
    needed = std::max(needed, 1.05 * asked.period[k] * rate * std::fabs(width) / IN_A_STEP);
  }
  return rounded_up(needed);
}

void Barostat::advance_box(double h, int values)
{
  const double twice = twice_kinetic_of_box();
  if (!std::isfinite(twice) || chain.advance(target_of_box(-1.0, h), twice, h, values)) return;
  error->all(FLERR,
             "Fix gear/quat: in step {} the box moves so fast that its thermostat cannot follow; "
             "begin nearer to the target pressure, or use a Pdamp of {:.2g} or longer",
             update->ntimestep, std::max(period_for_drive(0.0), rounded_up(1.05 * period())));
}

/// scaled_velocity: M^-1 v
void Barostat::add(int ibody, const double *scaled_velocity, const double *omega_body,
                   const Integrator::Pending &)
{
  double velocity[3];
  matrix.times(scaled_velocity, velocity);
  add_kinetic(ibody, velocity, omega_body, here);
  add_momenta(ibody, velocity, tensor, moving_components());
}

void Barostat::end_passes(const Integrator &integrator)
{
  Thermostat::end_passes(integrator);
  if (chain_acts()) chain.conclude();
  correction = cell.correction() * inverse;
  local_error = cell.local_error() * inverse;
  cell.finish();
  matrix = cell.matrix();
  rate = cell.rate(width);
  box.set(matrix);
  heat.advance(heat_coefficients.data(), values_of_heat, width, rate_of_heat());
}

void Barostat::place(int ibody, const Integrator::Pending &pending, BodyState &state,
                     Correction &last) const
{
  double scaled_way[3], way[3];
  for (int k = 0; k < 3; ++k) scaled_way[k] = state.center[k] - pending.x[k];
  matrix.times(scaled_way, way);
  const double *force = bodies.load_of(ibody).force;
  last.work += dot3(force, way) - dot3(force, scaled_way);
  box.to_space(state);
}

void Barostat::keep()
{
  Thermostat::keep();
  kept = std::make_unique<Moving>(Moving{cell, chain, heat});
}

void Barostat::put_back()
{
  Thermostat::put_back();
  cell = kept->cell;
  chain = kept->chain;
  heat = kept->heat;
  box.set(cell.matrix());
}

/// The error as a length is the displacement at the faces of the box; as an energy, its work.
void Barostat::errors(double h, int values, const Include &include) const
{
  Thermostat::errors(h, values, include);
  double length = 0.0, energy = 0.0;
  const Upper push = drive();
  for (int k = 0; k < Upper::SIZE; ++k) {
    const double strain = std::fabs(local_error[k]);
    length = std::max(length, 0.5 * domain->prd[k < 3 ? k : k == 3 ? 1 : 0] * strain);
    if (asked.on[k]) energy += mass_of(k) * strain * (std::fabs(push[k]) + std::fabs(rate[k] / h));
  }
  StepErrors found;
  found.length = length;
  found.energy = energy;
  include(found);
}

/// With a changing step, scalars have the coefficients of velocities.
void Barostat::prepare(double h)
{
  if (!changing_step) return;
  times.prepare(h);
  cell.set_coefficients(times.coefficients());
  const auto &c = times.coefficients().c;
  for (int j = 0; j < values_of_heat; ++j) heat_coefficients[j] = 0.5 * (j + 1) * c[j + 1];
}

void Barostat::note_step(double h)
{
  times.conclude(h);
  Thermostat::note_step(h);
  watch_box(h);
}

/// The mass of the box changes with the degrees of freedom.
void Barostat::follow_changes(double h)
{
  const double before = twice_kinetic_of_box();
  Thermostat::follow_changes(h);
  heat.add(0.5 * (before - twice_kinetic_of_box()));
}

void Barostat::rescale(double ratio)
{
  cell.rescale(ratio);
  heat.rescale(ratio, values_of_heat);
  width *= ratio;
}

/* ----------------------------------------------------------------------
   outputs
------------------------------------------------------------------------- */

double Barostat::energy() const
{
  double sum = mean_target(target) * volume() + heat.value() + 0.5 * twice_kinetic_of_box() -
      virial.value().contracted(correction);
  if (chain_acts()) sum += chain.energy(target_of_box(0.0, 0.0));
  return Thermostat::energy() + sum * force->mvv2e;
}

double Barostat::element(int n)
{
  if (n < Thermostat::ELEMENTS) return Thermostat::element(n);
  static constexpr int PLACES[] = {0, 1, 2, 5, 4, 3};    // of xx yy zz xy xz yz
  const double to_pressure = force->nktv2p * force->mvv2e;
  if (n < P_TARGET) {
    sum_present();
    sum_present_momenta();
    if (!(volume() > 0.0)) return 0.0;    // there was no run yet
    const double unit_of_pressure = to_pressure / volume();
    const Upper found = (kinetic + virial.value()).scaled(unit_of_pressure);
    return n == PRESSURE ? found.trace() / dimensions() : found[PLACES[n - P_COMPONENT]];
  }
  if (n == P_TARGET) return to_pressure * mean_target(target);
  if (n < E_BOX) return rate[n - STRAIN_RATE];
  if (n == E_BOX) return 0.5 * twice_kinetic_of_box() * force->mvv2e;
  return friction_now();
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

/// Refuses atoms outside of bodies.
void Barostat::refuse_others() const
{
  bigint here = 0;
  tagint last = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    here += bodies.body_at(ibody).natoms;
    last = std::max(last, bodies.body_at(ibody).id);
  }
  const bigint others = atom->natoms - over_ranks(MPI_SUM, here, world);
  if (others == 0) return;
  const double number = std::pow(10.0, std::ceil(std::log10(over_ranks(MPI_MAX, last, world) + 1)));
  error->all(FLERR,
             "Fix gear/quat: constant pressure requires all atoms to be in bodies of this fix, and "
             "{3} are not: their places would not follow the box; make each of them a body of its "
             "own with \"variable b atom '({0})*({1})+(1-({0}))*({2:.0f}+id)'\" and with \"custom "
             "v_b\" for a group of all atoms, and let no other fix move them",
             asked.in_bodies, asked.bodies, number, others);
}

/// Refuses forces without a virial, and positions that do not follow the box.
void Barostat::refuse_scene() const
{
  virial.check_compute();
  refuse_others();
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR,
               "Fix gear/quat: constant pressure cannot be used with run_style respa; use "
               "run_style verlet");
  if (force->kspace && force->kspace->scalar_pressure_flag)
    error->all(FLERR, "Fix gear/quat: constant pressure requires kspace_modify pressure/scalar no");
  if (asked.shears() && virial.has_torques())
    error->all(FLERR,
               "Fix gear/quat: shear components of the pressure require atoms that are "
               "points: torques on atoms make the virial of LAMMPS unsymmetric");
  if (const Fix *other = fix_with_forces(lmp, fix))
    error->all(
        FLERR,
        "Fix gear/quat: constant pressure cannot be used with fix {} ({}), which may change "
        "forces: what they add to the pressure is not known; leave it out, or keep the volume",
        other->id, other->style);
  if (asked.shears() && asked.flip && !box.can_flip() && comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: this build replaces no tilted box on several ranks (keyword "
                   "flip), because its LAMMPS comes without irregular.h; with a tilt of much more "
                   "than half a period steps take longer");
}

/// Without temp and ptemp, uses the temperature of the bodies when the box starts to move.
void Barostat::find_temperature()
{
  if (acts() || words.start > 0.0) return;
  double here[2] = {0.0, 0.0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const BodyState &s = bodies.state_of(ibody);
    here[0] += 2.0 * translational_energy(rigid, s.velocity) +
        2.0 * rotational_energy(rigid, s.omega_body);
    here[1] += rigid.freedoms(domain->dimension);
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  if (!(all[0] > 0.0))
    error->all(FLERR,
               "Fix gear/quat: the mass of the box needs a temperature, and the bodies have "
               "none; give them velocities first, or add keyword ptemp");
  words.start = words.stop = all[0] / all[1] * force->mvv2e / force->boltz;
}

void Barostat::tell_freedoms_of_box()
{
  std::vector<std::string> masses;
  for (int k = 0; k < Upper::SIZE; ++k) {
    if (!asked.on[k]) continue;
    const std::string mass = fmt::format("{:.4g}", mass_of(k) * force->mvv2e);
    if (!std::count(masses.begin(), masses.end(), mass)) masses.push_back(mass);
  }
  tell_once(told_of_box,
            fmt::format("barostat for {:.0f} degrees of freedom of translation{} and {} of the "
                        "box, whose mass is {} at a temperature of {:.4g}",
                        freedoms[TRANSLATION], total.description(), free_components(),
                        utils::join_words(masses, " and "), kt * force->mvv2e / force->boltz));
}

void Barostat::begin_run(bool begins, double h)
{
  refuse_scene();
  if (begins) find_temperature();
  Thermostat::begin_run(begins, h);
  if (freedoms[TRANSLATION] < 1.0)
    error->all(FLERR, "Fix gear/quat: constant pressure requires more than one body");
  made_target = target;
  made_rate = target_rate;
  if (update->nsteps > 0 || begins) find_target(update->ntimestep, h);
  tell_freedoms_of_box();
  if (begins) refer_to_box(h);
  correction = Upper();    // forces are evaluated in the corrected box
  std::copy_n(domain->prd, 3, begun_box.m.begin());
  find_longest_body();
  for (int k = 0; k < 3; ++k) refuse_narrow_box(k, domain->prd[k]);
  begun_matrix = matrix;
  frequency.begin_run();
  strongest = Upper();
  warned_mesh = false;
  virial.request(update->ntimestep + 1);
}

const char *Barostat::reason_to_start_anew() const
{
  const char *reason = Thermostat::reason_to_start_anew();
  if (reason) return reason;
  constexpr double ROUNDING = 1.0e-12;
  for (int k = 0; k < Upper::SIZE; ++k) {
    const double size = std::fabs(target[k]) + std::fabs(made_target[k]);
    if (std::fabs(target[k] - made_target[k]) > ROUNDING * size ||
        std::fabs(target_rate[k] - made_rate[k]) >
            ROUNDING * (std::fabs(target_rate[k]) + std::fabs(made_rate[k])))
      return "the barostat has another target than in the last steps";
    if (asked.on[k] && periods[k] != asked.period[k])
      return "the barostat has another damping time than in the last steps";
  }
  return nullptr;
}

/* ----------------------------------------------------------------------
   the start
------------------------------------------------------------------------- */

/// The box keeps its rate.
void Barostat::refer_to_box(double h)
{
  const Upper before = width != 0.0 ? cell.rate(width) : Upper();
  width = h;
  target_at_start = target;
  box.refer();
  cell.begin(before, h);
  matrix = begun_matrix = Upper::one();
  rate = before;
}

void Barostat::begin_start(const StartNodes &nodes)
{
  Thermostat::begin_start(nodes);
  const double s = nodes.spacing;
  if (chain_acts()) {
    const double twice = twice_kinetic_of_box();
    held_box =
        chain.is_stiff(target_of_box(0.0, nodes.h), twice, nodes.h, nodes.collocation.pairs());
  }
  const Upper now = drive();
  note_drive(now);
  friction_of_box = friction_now();
  const Upper second = CellHistory::acceleration(matrix, rate, now, friction_of_box);
  nodes.collocation.begin<Upper::SIZE>(matrix.m.data(), (rate * matrix).scaled(s).m.data(),
                                       second.scaled(s * s).m.data(), cell_at_nodes);
  nodes.collocation.begin(0.0, twice_kinetic_of_box(), twice_box_at_nodes);
  nodes.collocation.begin(heat.value(), rate_of_heat(), heat_at_nodes);
  note_box();
}

void Barostat::foretell(const StartNodes &nodes)
{
  Thermostat::foretell(nodes);
  nodes.collocation.foretell(cell_at_nodes);
  nodes.collocation.foretell(twice_box_at_nodes);
  nodes.collocation.foretell(heat_at_nodes);
}

void Barostat::enter_node(const StartNodes &nodes, int node)
{
  Upper value, first;
  nodes.collocation.values_at(node, cell_at_nodes, value.m.data(), first.m.data());
  matrix = value;
  rate = first.scaled(1.0 / nodes.spacing) * value.inverse();
  move_target(node * nodes.spacing);
  box.set(matrix);
  box.show(true);
  for_moved([this](int ibody) {
    box.to_space(bodies.change_state(ibody));
  });
}

void Barostat::visit_node(const StartNodes &nodes, int node)
{
  Thermostat::visit_node(nodes, node);
  sum_present_momenta();
  if (chain_acts() && !held_box) {
    const ChainDrive of_box = drive_of(nodes.collocation, twice_box_at_nodes);
    friction_of_box = chain.flow(target_of_box(0.0, nodes.h), of_box, nodes.spacing, node).y[0];
  }
  const Upper second = CellHistory::acceleration(matrix, rate, drive(), friction_of_box);
  nodes.collocation.set_rates(node, second.scaled(nodes.spacing * nodes.spacing).m.data(),
                              cell_at_nodes);
  nodes.collocation.set_rate(node, twice_kinetic_of_box(), twice_box_at_nodes);
  nodes.collocation.set_rate(node, rate_of_heat(), heat_at_nodes);
  note_box();
}

void Barostat::settle(const StartNodes &nodes, int pair)
{
  Thermostat::settle(nodes, pair);
  nodes.collocation.settle(pair, cell_at_nodes);
  nodes.collocation.settle(pair, twice_box_at_nodes);
  nodes.collocation.settle(pair, heat_at_nodes);
}

void Barostat::leave_nodes()
{
  move_target(0.0);
  matrix = cell.matrix();
  rate = cell.rate(width);
  box.set(matrix);
  box.show(true);
}

void Barostat::seed(const StartNodes &nodes, int pairs, int values)
{
  Thermostat::seed(nodes, pairs, values);
  double of_cell[Upper::SIZE * TaylorSeries::MAX_TERMS], of_heat[Collocation::MAX_NODES + 1];
  nodes.collocation.expand(cell_at_nodes, pairs, of_cell);
  cell.seed(of_cell, Collocation::terms_of(pairs), nodes.spacing, nodes.h);
  const int terms = nodes.collocation.series(heat_at_nodes, pairs, nodes.spacing, of_heat);
  heat.seed(of_heat, terms, nodes.spacing, nodes.h, values_of_heat);
  chain.seed(nodes.collocation.rate_at_start(twice_box_at_nodes), pairs, nodes.spacing, values + 1);
}

void Barostat::seed_local(double h, int terms)
{
  Thermostat::seed_local(h, terms);
  const Upper now = drive();
  note_drive(now);
  friction_of_box = friction_now();
  const Upper second = CellHistory::acceleration(matrix, rate, now, friction_of_box);
  Upper series[3] = {matrix, (rate * matrix).scaled(h), second.scaled(0.5 * h * h)};
  cell.seed(series[0].m.data(), terms, h, h);
  times.begin(SECOND_PAPER - 2, std::fabs(h));
  const double of_heat[2] = {heat.value(), h * rate_of_heat()};
  heat.seed(of_heat, 2, h, h, values_of_heat);
  const double twice = twice_kinetic_of_box();
  chain.seed(&twice, 0, 0.0, 1);
}

/* ----------------------------------------------------------------------
   oscillation of the box: with one evaluation of the forces per step, its limit is the same as for
   an oscillation of the bodies
------------------------------------------------------------------------- */

// the mesh of long-range forces is made for edges that differ by less than this

static constexpr double OF_MESH = 0.15;

// limits for the change of the shape of the box under unequal targets

static constexpr double IN_SHAPE = 4.0, OF_HEIGHT = 2.0;

/// Strain for measuring the dependence of the pressure on the box at constant scaled centers:
/// positions change by less than a tenth of the neighbor skin.
double Barostat::probing_strain() const
{
  const double longest = std::max({domain->xprd, domain->yprd, domain->zprd});
  return std::min(1.0e-3, 0.1 * neighbor->skin / longest);
}

void Barostat::enter_probe(int side)
{
  for (int k = 0; k < 3; ++k)
    if (asked.on[k]) matrix[k] = 1.0 + side * probing_strain();
  box.set(matrix);
  box.show(true);
  for_moved([this](int ibody) {
    box.to_space(bodies.change_state(ibody));
  });
}

void Barostat::leave_probe(int side)
{
  if (side < 0) {
    drive_of_smaller = drive();
    return;
  }
  const Upper change = drive() - drive_of_smaller;
  double stiffest = 0.0;
  for (int k = 0; k < 3; ++k)
    if (asked.on[k]) stiffest = std::max(stiffest, -change[k] / (2.0 * probing_strain()));
  frequency.begin(std::sqrt(stiffest));
}

double Barostat::longest_step() const
{
  return std::min(Thermostat::longest_step(), frequency.longest_step());
}

void Barostat::watch_box(double h)
{
  const Upper now = drive();
  frequency.note(now, rate, masses(), h);
  note_drive(now);
  watch_mesh();
}

/// LAMMPS chooses the mesh only before a run, but Ewald's wave vectors in every box.
void Barostat::watch_mesh()
{
  const KSpace *kspace = force->kspace;
  if (warned_mesh || !kspace || !(kspace->pppmflag || kspace->msmflag)) return;
  for (int k = 0; k < domain->dimension; ++k) {
    const double ratio = domain->prd[k] / begun_box[k];
    if (std::fabs(ratio - 1.0) < OF_MESH) continue;
    warned_mesh = true;
    if (comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat: in step {} the box is {:.3g} times as long along {} as at the "
          "beginning of the run, for which the mesh of kspace style {} was chosen; begin "
          "another run",
          update->ntimestep, ratio, "xyz"[k], force -> kspace_style);
    return;
  }
}

std::vector<Rate> Barostat::rates(double h, bool ahead) const
{
  std::vector<Rate> rows = Thermostat::rates(h, ahead);
  if (!frequency.is_settled()) return rows;
  const double period = std::max(frequency.needed_period(h), period_for_drive(frequency.value()));
  rows.push_back({"the angle of the oscillation of the box is", frequency.radians(h),
                  frequency.followed(), fmt::format("use a Pdamp of {:g} or longer", period)});
  return rows;
}

/// Collective.
void Barostat::find_longest_body()
{
  double here = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    here = std::max(here, bodies.body_at(ibody).extent);
  longest_body = over_ranks(MPI_MAX, here, world);
}

/// In such a box a body overlaps with its own images, and atoms are lost.
void Barostat::refuse_narrow_box(int direction, double edge) const
{
  if (!asked.on[direction] || edge > longest_body) return;
  error->all(
      FLERR,
      "Fix gear/quat: in step {} the edge of the box along {}, {:.4g}, would be shorter than "
      "a body, whose atoms are {:.4g} apart; use more bodies, a smaller target pressure, or "
      "iso, which keeps the shape of the box",
      update->ntimestep, "xyz"[direction], edge, longest_body);
}

/// The box is predicted, but LAMMPS still has the old box.
void Barostat::refuse_box() const
{
  const Upper &before = box.matrix();
  for (int k = 0; k < 3; ++k) {
    const double ratio = matrix[k] / before[k];
    if (!(std::fabs(ratio - 1.0) < IN_A_STEP))
      error->all(
          FLERR,
          "Fix gear/quat: in step {} the box would change its length along {} from {:.4g} by "
          "the factor {:.3g}; begin nearer to the target pressure, or use a Pdamp of {:.2g} or "
          "longer, unless a fluid tears under a target that is negative or too small",
          update->ntimestep, "xyz"[k], domain -> prd[k], ratio,
          std::max(period_for_drive(0.0), rounded_up(1.05 * period())));
    refuse_narrow_box(k, domain->prd[k] * ratio);
  }
  double deviates = 0.0;
  const double mean = mean_target(target);
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) deviates = std::max(deviates, std::fabs(target[k] - (k < 3 ? mean : 0.0)));
  if (deviates <= 1.0e-12 * std::fabs(mean)) return;
  double stretch[2] = {HUGE_VAL, 0.0}, sheared = 0.0;
  for (int k = 0; k < domain->dimension; ++k) {
    const double now = domain->prd[k] / begun_box[k];
    stretch[0] = std::min(stretch[0], now);
    stretch[1] = std::max(stretch[1], now);
  }
  const Upper strain = matrix * begun_matrix.inverse();    // invariant under flips
  for (int k = 3; k < Upper::SIZE; ++k) sheared = std::max(sheared, std::fabs(strain[k]));
  if (stretch[1] < IN_SHAPE * stretch[0] && sheared < OF_HEIGHT) return;
  error->all(FLERR,
             "Fix gear/quat: in step {} the box has edges of {:.4g}, {:.4g} and {:.4g}, and {} "
             "in this run, because the targets of the pressure are unequal or have shear "
             "components, which a liquid cannot sustain; use iso, or aniso with equal targets, "
             "unless the system is solid",
             update->ntimestep, domain->prd[0], domain->prd[1], domain->prd[2],
             sheared < OF_HEIGHT
                 ? fmt::format("their ratio has changed by a factor of {:g}", IN_SHAPE)
                 : fmt::format("it was sheared by {:g} times its height", OF_HEIGHT));
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

void Barostat::fields(Fields &v)
{
  double temperature = words.start;
  Thermostat::fields(v);
  v(temperature, kt, width, target, target_rate, correction, periods, virial, box, cell, heat,
    chain, frequency);
  if (changing_step) v(times);
  if (!v.reads()) return;
  if (!acts() && asked.temperature == 0.0) words.start = words.stop = temperature;
  matrix = cell.matrix();
  if (width != 0.0) rate = cell.rate(width);
  box.resume(matrix);
}
