/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_barostat.h"

#include "gear_quat_ranks.h"
#include "gear_quat_styles.h"

#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "compute.h"
#include "dihedral.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "improper.h"
#include "kspace.h"
#include "modify.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

// limit for the change of the box in a step

static constexpr double IN_A_STEP = 0.03;

// LAMMPS' order of a virial is xx yy zz xy xz yz

static constexpr int PLACES[] = {0, 1, 2, 5, 4, 3};

/* ---------------------------------------------------------------------- */

Barostat::Barostat(LAMMPS *lmp, const Fix *fix, Bodies &bodies, const Sites &sites,
                   const PressureWords &pressure, Temperature &temperature) :
    Pointers(lmp),
    fix(fix), bodies(bodies), sites(sites), asked(pressure), temperature(temperature),
    box(lmp, pressure.fixed)
{
  if (!asked.any()) return;
  id = std::string(fix->id) + "_virial";
  modify->add_compute(id + " all pressure NULL pair bond angle dihedral improper kspace");
}

Barostat::~Barostat()
{
  if (moves() && own()) modify->delete_compute(id);
}

Compute *Barostat::own() const
{
  return modify->get_compute_by_id(id);
}

void Barostat::set_scheme(const Scheme &scheme)
{
  if (!moves()) return;
  if (scheme.remembers() && !times) times.emplace(false);
  cell.set_scheme(scheme);
}

/* ----------------------------------------------------------------------
   the box's equation of motion
------------------------------------------------------------------------- */

/// The weight b of the trace term.
double Barostat::weight_of(int direction) const
{
  const int d = domain->dimension;
  if (direction >= d) return 0.0;
  return (asked.shears() ? d - 2.0 * direction : 1.0) /
      temperature.freedoms[Temperature::TRANSLATION];
}

/// Of the present time.
double Barostat::kt() const
{
  const auto &line = temperature.line;
  return line.kt + (width != 0.0 ? time_of_node / width * line.kt_step : 0.0);
}

/// W of the components that move, 0 for others; Pdamp of coupled components is the same.
Upper Barostat::masses() const
{
  Upper found;
  const double d = domain->dimension;
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k])
      found[k] = (temperature.freedoms[Temperature::TRANSLATION] + d) * kt() * asked.period[k] *
          asked.period[k] / d;
  return found;
}

double Barostat::twice_kinetic() const
{
  if (!moves()) return 0.0;
  double sum = 0.0;
  const Upper mass = masses();
  for (int k = 0; k < Upper::SIZE; ++k) sum += mass[k] * rate[k] * rate[k];
  return sum;
}

int Barostat::freedoms() const
{
  int count = 0;
  for (int k = 0; k < Upper::SIZE; ++k) count += asked.on[k] && (k >= 3 || asked.tied[k] == k);
  return count;
}

double Barostat::period() const
{
  double shortest = HUGE_VAL;
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) shortest = std::min(shortest, asked.period[k]);
  return shortest;
}

/// Only directions that move contribute.
double Barostat::mean_of(const Upper &pressures) const
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
  for (int k = 0; k < Upper::SIZE; ++k) {
    const double change = asked.stop[k] - asked.start[k];
    present_target[k] = unit * (asked.start[k] + part * change);
    target_rate[k] = steps > 0 && h != 0.0 ? unit * change / (steps * h) : 0.0;
  }
}

/// G' without the friction of the box.
Upper Barostat::drive() const
{
  Upper found;
  const Upper mass = masses(), aim = target(), &tensor = temperature.tensor;
  const double v = box.volume(), trace = tensor.trace();
  for (int k = 0; k < Upper::SIZE; ++k) {
    if (!asked.on[k]) continue;
    double push = tensor[k] + virial[k] - aim[k] * v;
    if (k < 3) push += weight_of(k) * trace;
    found[k] = push / mass[k];
  }
  for (int first = 0; first < 3; ++first) {
    const auto is_tied = [&](int k) {
      return asked.on[k] && asked.tied[k] == first;
    };
    double sum = 0.0, count = 0.0;
    for (int k = first; k < 3; ++k)
      if (is_tied(k)) {
        sum += found[k];
        ++count;
      }
    for (int k = first; k < 3; ++k)
      if (is_tied(k)) found[k] = sum / count;
  }
  return found;
}

double Barostat::rate_of_heat() const
{
  if (!moves()) return 0.0;
  double sum = 0.0;
  const Upper aim = target();
  const double mean = mean_of(aim), v = box.volume();
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) sum += v * (aim[k] - (k < 3 ? mean : 0.0)) * rate[k];
  sum -= v * mean_of(target_rate);
  const double kt_rate = width != 0.0 ? temperature.line.kt_step / width : 0.0;
  return sum - 0.5 * kt_rate / kt() * twice_kinetic();
}

/// All quantities of bodies that depend on M and G.
void Barostat::combine(const Friction &alpha)
{
  const double weights[3] = {weight_of(0), weight_of(1), weight_of(2)};
  of_bodies = friction_in_cell(alpha, box.matrix(), rate, weights);
}

/// M and G of the history.
void Barostat::note_rates(double h)
{
  box.set(cell.matrix());
  if (h != 0.0) rate = cell.rate(h);
}

/// LAMMPS' box becomes the present one.
void Barostat::show_box(bool forces)
{
  std::vector<double *> others;
  if (sites.number() < atom->nlocal) {
    std::vector<bool> in_body(atom->nlocal, false);
    for (const Site &site : sites) in_body[site.atom] = true;
    for (int i = 0; i < atom->nlocal; ++i)
      if (!in_body[i]) others.push_back(atom->x[i]);
  }
  for (double *x : others) domain->x2lamda(x, x);
  box.show(forces);
  for (double *x : others) domain->lamda2x(x, x);
}

/// LAMMPS' box becomes this one, and states, which are scaled, become unscaled.
void Barostat::show(const Upper &deformation, const Upper &its_rate)
{
  rate = its_rate;
  box.set(deformation);
  show_box(true);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) box.to_space(bodies.change_state(ibody));
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Barostat::predict(double h)
{
  if (times) {
    times->prepare(h);
    cell.set_coefficients(times->coefficients());
  }
  cell.predict();
  refuse_box(cell.matrix());
  show(cell.matrix(), cell.rate(h));
}

void Barostat::choose_coefficients(CorrectorCoefficients::Array &c, int values) const
{
  for (int j = 0; times && j < values; ++j) c[j] = 0.5 * (j + 1) * times->coefficients().c[j + 1];
}

void Barostat::measure(const Friction &alpha)
{
  if (!moves()) return;
  note_rates(width);
  combine(alpha);
}

void Barostat::begin_passes(double h)
{
  if (!moves()) return;
  width = h;
  find_target(update->ntimestep, width);
}

void Barostat::pass(const Friction &alpha, double xi, double h)
{
  if (!moves()) return;
  cell.pass(drive(), xi, h);
  note_rates(h);
  combine(alpha);
}

void Barostat::refuse_speed() const
{
  error->all(FLERR,
             "Fix gear/quat: in step {} the box moves so fast that its thermostat cannot follow; "
             "begin nearer to the target pressure, or use a longer Pdamp",
             update->ntimestep);
}

void Barostat::end_passes()
{
  if (!moves()) return;
  correction = cell.correction() * box.inverse_matrix();
  local_error = cell.local_error() * box.inverse_matrix();
  cell.finish();
  note_rates(width);
}

double Barostat::work(const double *force, const double *predicted, const BodyState &state) const
{
  double scaled_way[3], way[3];
  for (int k = 0; k < 3; ++k) scaled_way[k] = state.center[k] - predicted[k];
  box.matrix().times(scaled_way, way);
  return dot3(force, way);
}

void Barostat::end_step()
{
  if (!moves()) return;
  show_box(false);
  request_virial();
}

void Barostat::flip()
{
  if (is_tilted()) box.flip();
}

void Barostat::put_back()
{
  cell = kept;
  if (moves()) box.set(cell.matrix());
}

void Barostat::rescale(double ratio)
{
  cell.rescale(ratio);
  width *= ratio;
}

double Barostat::error_of_step(bool as_energy, double h) const
{
  double displacement = 0.0, work = 0.0;
  const Upper push = drive(), mass = masses();
  for (int k = 0; k < Upper::SIZE; ++k) {
    const double strain = std::fabs(local_error[k]);
    displacement = std::max(displacement, 0.5 * domain->prd[k < 3 ? k : k == 3 ? 1 : 0] * strain);
    work += mass[k] * strain * (std::fabs(push[k]) + std::fabs(rate[k] / h));
  }
  return as_energy ? work : displacement;
}

/* ----------------------------------------------------------------------
   outputs
------------------------------------------------------------------------- */

double Barostat::energy(double heat) const
{
  return mean_of(target()) * box.volume() + heat + 0.5 * twice_kinetic() -
      virial.contracted(correction);
}

double Barostat::element(int n) const
{
  const double to_pressure = force->nktv2p * force->mvv2e;
  if (n < P_TARGET) {
    if (!(box.volume() > 0.0)) return 0.0;    // there was no run yet
    const Upper found = (temperature.tensor + virial).scaled(to_pressure / box.volume());
    return n == PRESSURE ? found.trace() / domain->dimension : found[PLACES[n - P_COMPONENT]];
  }
  if (n == P_TARGET) return to_pressure * mean_of(target());
  if (n < E_BOX) return rate[n - STRAIN_RATE];
  return 0.5 * twice_kinetic() * force->mvv2e;
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

/// Refuses atoms outside of bodies that move by themselves.
void Barostat::refuse_others() const
{
  std::string movers;
  bigint here = 0;
  int bits = 0;
  for (const auto *other : modify->get_fix_list()) {
    if (other == fix || !other->time_integrate) continue;
    bits |= other->groupbit;
    movers += (movers.empty() ? "" : ", ") + name_of(other);
  }
  for (int i = 0; i < atom->nlocal; ++i) here += (atom->mask[i] & bits) != 0;
  for (const Site &site : sites) here -= (atom->mask[site.atom] & bits) != 0;
  const bigint others = over_ranks(MPI_SUM, here, world);
  if (others == 0) return;
  error->all(FLERR,
             "Fix gear/quat: constant pressure requires all moving atoms to be in bodies of this "
             "fix, and {} that {} moves are not: their places would not follow the box; put them "
             "into a group P, define this fix for a group of all atoms with keyword points P, and "
             "let no other fix move them",
             others, movers);
}

void Barostat::refuse_scene() const
{
  if (!moves()) return;
  refuse_forces();
  refuse_others();
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR,
               "Fix gear/quat: constant pressure cannot be used with run_style respa; use "
               "run_style verlet");
  if (force->kspace && force->kspace->scalar_pressure_flag)
    error->all(FLERR, "Fix gear/quat: constant pressure requires kspace_modify pressure/scalar no");
  if (asked.shears() && over_ranks(MPI_SUM, sites.number_of_extended(), world) > 0)
    error->all(FLERR,
               "Fix gear/quat: shear components of the pressure require atoms that are "
               "points: torques on atoms make the virial of LAMMPS unsymmetric");
  if (asked.shears() && asked.flip && !box.can_flip() && comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: this build replaces no tilted box on several ranks (keyword "
                   "flip), because its LAMMPS comes without irregular.h; with a tilt of much more "
                   "than half a period steps take longer");
}

void Barostat::tell_freedoms()
{
  std::vector<std::string> words;
  const Upper mass = masses();
  for (int k = 0; k < Upper::SIZE; ++k) {
    const std::string word = fmt::format("{:.4g}", mass[k] * force->mvv2e);
    if (asked.on[k] && !std::count(words.begin(), words.end(), word)) words.push_back(word);
  }
  temperature.tell_once(
      told,
      fmt::format(
          "barostat for {:.0f} degrees of freedom of translation{} and {} of the box, whose "
          "mass is {} at a temperature of {:.4g}",
          temperature.freedoms[Temperature::TRANSLATION], temperature.description(), freedoms(),
          utils::join_words(words, " and "), kt() * force->mvv2e / force->boltz));
}

void Barostat::begin_run(bool anew, double h)
{
  if (!moves()) return;
  if (temperature.freedoms[Temperature::TRANSLATION] < 1.0)
    error->all(FLERR,
               "Fix gear/quat: constant pressure requires more than one body that is free to move");
  if (update->nsteps > 0 || anew) find_target(update->ntimestep, h);
  tell_freedoms();
  if (anew) refer_to_box(h);
  correction = Upper();    // forces are evaluated in the corrected box
  request_virial();
}

void Barostat::add_setting(std::vector<double> &all) const
{
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) all.insert(all.end(), {present_target[k], target_rate[k], asked.period[k]});
}

/* ----------------------------------------------------------------------
   the start
------------------------------------------------------------------------- */

void Barostat::refer_to_box(double h)
{
  if (!moves()) return;
  const Upper before = width != 0.0 ? cell.rate(width) : Upper();
  width = h;
  box.refer();
  cell.begin(before, h);
  rate = before;
}

/// M'' at the start.
Upper Barostat::begin_acceleration(double xi)
{
  return CellHistory::acceleration(box.matrix(), rate, drive(), xi);
}

void Barostat::begin_start(const StartNodes &nodes, double xi)
{
  if (!moves()) return;
  const double s = nodes.spacing;
  const Upper second = begin_acceleration(xi);
  nodes.collocation.begin(box.matrix().m.data(), (rate * box.matrix()).scaled(s).m.data(),
                          second.scaled(s * s).m.data(), cell_at_nodes);
}

void Barostat::foretell(const StartNodes &nodes)
{
  if (moves()) nodes.collocation.foretell(cell_at_nodes);
}

void Barostat::enter_node(const StartNodes &nodes, int node)
{
  if (!moves()) return;
  Upper value, first;
  nodes.collocation.values_at(node, cell_at_nodes, value.m.data(), first.m.data());
  time_of_node = node * nodes.spacing;
  show(value, first.scaled(1.0 / nodes.spacing) * value.inverse());
}

void Barostat::visit_node(const StartNodes &nodes, int node, const Friction &alpha, double xi)
{
  const Upper second = CellHistory::acceleration(box.matrix(), rate, drive(), xi);
  nodes.collocation.set_rates(node, second.scaled(nodes.spacing * nodes.spacing).m.data(),
                              cell_at_nodes);
  combine(alpha);
}

void Barostat::settle(const StartNodes &nodes, int pair)
{
  if (moves()) nodes.collocation.settle(pair, cell_at_nodes);
}

void Barostat::leave_nodes()
{
  if (!moves()) return;
  time_of_node = 0.0;
  note_rates(width);
  show_box(true);
}

void Barostat::seed(const StartNodes &nodes, int pairs)
{
  double series[Upper::SIZE * TaylorSeries::MAX_TERMS];
  nodes.collocation.expand(cell_at_nodes, pairs, series);
  cell.seed(series, Collocation::terms_of(pairs), nodes.spacing, nodes.h);
}

/// Steps of keyword tolerance grow fast after a start.  The loads before it, which are assumed to be
/// constant, are longer ago than these steps, so that their polynomial does not amplify the changes.
static constexpr double FORMER_STEPS = 16.0;

void Barostat::seed_local(double h, int terms, double xi)
{
  if (!moves()) return;
  const Upper second = begin_acceleration(xi), &matrix = box.matrix();
  const Upper series[3] = {matrix, (rate * matrix).scaled(h), second.scaled(0.5 * h * h)};
  cell.seed(series[0].m.data(), terms, h, h);
  if (times) times->begin(SECOND_PAPER - 2, FORMER_STEPS * std::fabs(h));
}

/// The box is predicted, but LAMMPS still has the old box.
void Barostat::refuse_box(const Upper &matrix) const
{
  const Upper &before = box.matrix();
  for (int k = 0; k < 3; ++k) {
    const double ratio = matrix[k] / before[k];
    if (!(std::fabs(ratio - 1.0) < IN_A_STEP))
      error->all(
          FLERR,
          "Fix gear/quat: in step {} the box would change its length along {} from {:.4g} by "
          "the factor {:.3g}; begin nearer to the target pressure, or use a longer Pdamp, unless a "
          "fluid tears under a target that is negative or too small",
          update->ntimestep, "xyz"[k], domain -> prd[k], ratio);
  }
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

void Barostat::fields(Fields &v)
{
  v(width, present_target, target_rate, correction, virial, box, cell);
  if (times) v(*times);
  if (!v.reads()) return;
  note_rates(width);
}

/* ----------------------------------------------------------------------
   the virial of centers of mass
------------------------------------------------------------------------- */

// bits of vflag in LAMMPS: pairs are tallied, or forces on owned and ghost atoms

static constexpr int PAIR_BY_PAIR = 1, BY_FORCES = 2;

// exact sums represent terms up to 2^20 units, since overlaps have large forces

static constexpr double LARGE = 1048576.0;    // 2^20

static bool counts(const Fix *other)
{
  return other->virial_global_flag && other->thermo_virial;
}

void Barostat::refuse_forces() const
{
  if (!own() || !own()->pressflag)
    error->all(
        FLERR,
        "Fix gear/quat: compute {}, with which the fix asks LAMMPS for the virial, was deleted "
        "or replaced; leave it, or define the fix again",
        id);
  const auto &fixes = modify->get_fix_list();
  const auto place_of = [&](const Fix *one) {
    return std::find(fixes.begin(), fixes.end(), one);
  };
  for (const auto *other : fixes_with_forces(lmp, fix)) {
    const bool before = place_of(other) < place_of(fix);
    if (before == counts(other)) continue;
    error->all(
        FLERR,
        "Fix gear/quat: with a pressure, {} has to be defined {} fix {}, because its force {} "
        "(fix_modify virial {})",
        name_of(other), before ? "after" : "before", fix->id,
        before ? "does not count in the pressure" : "counts in the pressure",
        before ? "no" : "yes");
  }
}

/// LAMMPS will compute it in the next step.
void Barostat::request_virial() const
{
  own()->addstep(update->ntimestep + 1);
}

bool Barostat::others_ask_for_virial() const
{
  if (!moves()) return true;
  for (auto *one : modify->get_compute_list())
    if ((one->pressflag || one->pressatomflag) && id != one->id &&
        one->matchstep(update->ntimestep))
      return true;
  return false;
}

int Barostat::vflag() const
{
  if (!moves()) return 0;
  return force->newton_pair ? BY_FORCES : PAIR_BY_PAIR;
}

template <class Style> static void add_virial(const Style *style, double (&sum)[6])
{
  if (!style) return;
  for (int k = 0; k < 6; ++k) sum[k] += style->virial[k];
}

/// The scale of energies is that of a body's exact sum.
void Barostat::measure_virial(double **f)
{
  if (!moves()) return;
  double styles[6] = {};
  add_virial(force->pair, styles);
  if (atom->molecular != Atom::ATOMIC) {
    add_virial(force->bond, styles);
    add_virial(force->angle, styles);
    add_virial(force->dihedral, styles);
    add_virial(force->improper, styles);
  }
  for (int i = 0; modify->fix[i] != fix; ++i)
    if (counts(modify->fix[i])) add_virial(modify->fix[i], styles);
  ExactSum of_arms[6];
  const double scale = LARGE * ExactSum::scale_of(temperature.unit_of_energies());
  sites.add_arm_virial(f, of_arms, scale);
  sum_over_ranks(of_arms, world);
  const auto all_styles = over_ranks(MPI_SUM, styles, world);
  for (int k = 0; k < 6; ++k) {
    virial[k] = all_styles[PLACES[k]] - of_arms[k].value();
    if (force->kspace) virial[k] += force->kspace->virial[PLACES[k]];    // the sum over all ranks
    virial[k] /= force->mvv2e;
  }
  if (!force->pair || !force->pair->tail_flag) return;
  const double *edges = domain->prd;
  const double volume = edges[0] * edges[1] * (domain->dimension == 3 ? edges[2] : 1.0);
  for (int k = 0; k < domain->dimension; ++k)
    virial[k] += force->pair->ptail / (volume * force->mvv2e);
}
