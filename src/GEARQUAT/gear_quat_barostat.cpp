/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_bath.h"

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

Compute *Bath::own() const
{
  return modify->get_compute_by_id(id);
}

/* ----------------------------------------------------------------------
   the box's equation of motion
------------------------------------------------------------------------- */

/// The weight b of the trace term.
double Bath::weight_of(int direction) const
{
  const int d = domain->dimension;
  if (direction >= d) return 0.0;
  return (asked.shears() ? d - 2.0 * direction : 1.0) /
      temperature.freedoms[Temperature::TRANSLATION];
}

/// Of the present time.
double Bath::kt_of_box() const
{
  const auto &line = temperature.line;
  return line.kt + (width != 0.0 ? time_of_node / width * line.kt_step : 0.0);
}

/// W of the components that move, 0 for others; Pdamp of coupled components is the same.
Upper Bath::masses() const
{
  Upper found;
  const double d = domain->dimension;
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k])
      found[k] = (temperature.freedoms[Temperature::TRANSLATION] + d) * kt_of_box() *
          asked.period[k] * asked.period[k] / d;
  return found;
}

double Bath::twice_of_box() const
{
  if (!moves_box()) return 0.0;
  double sum = 0.0;
  const Upper mass = masses();
  for (int k = 0; k < Upper::SIZE; ++k) sum += mass[k] * box_rate[k] * box_rate[k];
  return sum;
}

int Bath::freedoms_of_box() const
{
  int count = 0;
  for (int k = 0; k < Upper::SIZE; ++k) count += asked.on[k] && (k >= 3 || asked.tied[k] == k);
  return count;
}

double Bath::period_of_box() const
{
  double shortest = HUGE_VAL;
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) shortest = std::min(shortest, asked.period[k]);
  return shortest;
}

/// Only directions that move contribute.
double Bath::mean_of(const Upper &pressures) const
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
void Bath::find_target(bigint step, double h)
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
Upper Bath::drive() const
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

double Bath::rate_of_heat() const
{
  if (!moves_box()) return 0.0;
  double sum = 0.0;
  const Upper aim = target();
  const double mean = mean_of(aim), v = box.volume();
  for (int k = 0; k < Upper::SIZE; ++k)
    if (asked.on[k]) sum += v * (aim[k] - (k < 3 ? mean : 0.0)) * box_rate[k];
  sum -= v * mean_of(target_rate);
  const double kt_rate = width != 0.0 ? temperature.line.kt_step / width : 0.0;
  return sum - 0.5 * kt_rate / kt_of_box() * twice_of_box();
}

/// All quantities of bodies that depend on M and G.
void Bath::measure_box()
{
  if (!moves_box()) return;
  note_rates(width);
  combine();
}

void Bath::combine()
{
  const double weights[3] = {weight_of(0), weight_of(1), weight_of(2)};
  of_bodies = friction_in_cell(of_all, box.matrix(), box_rate, weights);
}

/// M and G of the history.
void Bath::note_rates(double h)
{
  box.set(cell.matrix());
  if (h != 0.0) box_rate = cell.rate(h);
}

/// LAMMPS' box becomes the present one.
void Bath::show_box(bool forces)
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
void Bath::show(const Upper &deformation, const Upper &its_rate)
{
  box_rate = its_rate;
  box.set(deformation);
  show_box(true);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) box.to_space(bodies.state[ibody]);
}

void Bath::flip()
{
  if (is_tilted()) box.flip();
}

double Bath::error_of_box(bool as_energy, double h) const
{
  double displacement = 0.0, work = 0.0;
  const Upper push = drive(), mass = masses();
  for (int k = 0; k < Upper::SIZE; ++k) {
    const double strain = std::fabs(local_error[k]);
    displacement = std::max(displacement, 0.5 * domain->prd[k < 3 ? k : k == 3 ? 1 : 0] * strain);
    work += mass[k] * strain * (std::fabs(push[k]) + std::fabs(box_rate[k] / h));
  }
  return as_energy ? work : displacement;
}

/* ----------------------------------------------------------------------
   outputs
------------------------------------------------------------------------- */

double Bath::element_of_box(int n)
{
  const double to_pressure = force->nktv2p * force->mvv2e;
  if (n < P_TARGET) {
    temperature.sum_present();
    if (!(box.volume() > 0.0)) return 0.0;    // there was no run yet
    const Upper found = (temperature.tensor + virial).scaled(to_pressure / box.volume());
    return n == PRESSURE ? found.trace() / domain->dimension : found[PLACES[n - P_COMPONENT]];
  }
  if (n == P_TARGET) return to_pressure * mean_of(target());
  if (n < E_BOX) return box_rate[n - STRAIN_RATE];
  if (n == XI_BOX) return xi[OF_BOX];
  return 0.5 * twice_of_box() * force->mvv2e;
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

static bool counts(const Fix *other)
{
  return other->virial_global_flag && other->thermo_virial;
}

void Bath::refuse_scene() const
{
  if (!moves_box()) return;

  // forces without a virial, and atoms outside of bodies that move by themselves

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
  if (others > 0)
    error->all(
        FLERR,
        "Fix gear/quat: constant pressure requires all moving atoms to be in bodies of this "
        "fix, and {} that {} moves are not: their places would not follow the box; put them "
        "into a group P, define this fix for a group of all atoms with keyword points P, and "
        "let no other fix move them",
        others, movers);
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

/* ----------------------------------------------------------------------
   the start
------------------------------------------------------------------------- */

void Bath::refer_to_box(double h)
{
  if (!moves_box()) return;
  const Upper before = width != 0.0 ? cell.rate(width) : Upper();
  width = h;
  box.refer();
  cell.begin(before, h);
  box_rate = before;
}

Upper Bath::acceleration_of_box() const
{
  return CellHistory::acceleration(box.matrix(), box_rate, drive(), xi[OF_BOX]);
}

void Bath::enter_node(const StartNodes &nodes, int node)
{
  if (!moves_box()) return;
  Upper value, first;
  nodes.collocation.values_at(node, cell_at_nodes, value.m.data(), first.m.data());
  time_of_node = node * nodes.spacing;
  show(value, first.scaled(1.0 / nodes.spacing) * value.inverse());
}

void Bath::leave_nodes()
{
  if (!moves_box()) return;
  time_of_node = 0.0;
  note_rates(width);
  show_box(true);
}

/// Steps of keyword tolerance grow fast after a start.  The loads before it, which are assumed to be
/// constant, are longer ago than these steps, so that their polynomial does not amplify the changes.
static constexpr double FORMER_STEPS = 16.0;

void Bath::seed_box(double h, int terms)
{
  if (!moves_box()) return;
  const Upper second = acceleration_of_box(), &matrix = box.matrix();
  const Upper series[3] = {matrix, (box_rate * matrix).scaled(h), second.scaled(0.5 * h * h)};
  cell.seed(series[0].m.data(), terms, h, h);
  if (times) times->begin(SECOND_PAPER - 2, FORMER_STEPS * std::fabs(h));
}

/// The box is predicted, but LAMMPS still has the old box.
void Bath::refuse_box(const Upper &matrix) const
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
   the virial of centers of mass
------------------------------------------------------------------------- */

// bits of vflag in LAMMPS: pairs are tallied, or forces on owned and ghost atoms

static constexpr int PAIR_BY_PAIR = 1, BY_FORCES = 2;

// exact sums represent terms up to 2^20 units, since overlaps have large forces

static constexpr double LARGE = 1048576.0;    // 2^20

/// LAMMPS will compute it in the next step.
void Bath::request_virial() const
{
  own()->addstep(update->ntimestep + 1);
}

bool Bath::others_ask_for_virial() const
{
  if (!moves_box()) return true;
  for (auto *one : modify->get_compute_list())
    if ((one->pressflag || one->pressatomflag) && id != one->id &&
        one->matchstep(update->ntimestep))
      return true;
  return false;
}

int Bath::vflag() const
{
  if (!moves_box()) return 0;
  return force->newton_pair ? BY_FORCES : PAIR_BY_PAIR;
}

template <class Style> static void add_virial(const Style *style, double (&sum)[6])
{
  if (!style) return;
  for (int k = 0; k < 6; ++k) sum[k] += style->virial[k];
}

/// The scale of energies is that of a body's exact sum.
void Bath::measure_virial(double **f)
{
  if (!moves_box()) return;
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
