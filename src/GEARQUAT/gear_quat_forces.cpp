/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_forces.h"

#include "gear_quat_math.h"
#include "gear_quat_ranks.h"
#include "gear_quat_styles.h"

#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "compute.h"
#include "dihedral.h"
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
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

// step numbers for testing a dependence on time: a multiple of all intervals, and a multiple of no
// interval

static constexpr bigint EVERY_TIMES = 0, AT_NO_TIMES = 1000003;

// forces count as equal up to this part of the largest one, since sums may run in another order

static constexpr double SAME = 1.0e-13;

/* ---------------------------------------------------------------------- */

Forces::Forces(LAMMPS *lmp, const std::vector<const Fix *> &owners) : Pointers(lmp)
{
  look_at_styles();
  if (why.empty()) look_at_fixes(owners);
  if (why.empty()) look_at_time();
  post_force.clear();    // and those of the owners, in the order of LAMMPS
  for (auto *fix : modify->get_fix_list())
    if (modify->get_fix_mask(fix) & FixConst::POST_FORCE) post_force.push_back(fix);
}

void Forces::look_at_styles()
{
  if (lmp->kokkos) why = "the KOKKOS package is on";
  const char *run_style = update->integrate_style;
  if (!utils::strmatch(run_style, "^verlet$") && !utils::strmatch(run_style, "^respa"))
    why = fmt::format("run style {} may evaluate forces elsewhere", run_style);
  if (force->bond && force->bond->partial_flag)
    why = fmt::format("bonds of style {} may break", force->bond_style);
  if (known_pair(Fact::UNREPEATABLE, force))
    why = fmt::format("pair style {} draws random numbers or has a memory", force->pair_style);
}

void Forces::look_at_fixes(const std::vector<const Fix *> &owners)
{
  const int during_force =
      FixConst::PRE_FORCE | FixConst::PRE_REVERSE | FixConst::POST_FORCE | FixConst::POST_INTEGRATE;
  const int within_step = FixConst::INITIAL_INTEGRATE | FixConst::FINAL_INTEGRATE;
  for (auto *fix : modify->get_fix_list()) {
    if (std::find(owners.begin(), owners.end(), fix) != owners.end()) continue;
    const int mask = modify->get_fix_mask(fix);
    if (fix->time_integrate)
      why = name_of(fix) + " moves atoms";
    else if (mask & within_step)
      why = name_of(fix) + " acts within the step";
    else if (known(Fact::THREADS, fix))
      pre_force.push_back(fix);
    else if (known(Fact::REPEATABLE, fix))
      post_force.push_back(fix);
    else if (mask & during_force)
      why = name_of(fix) + " acts on forces in a way that cannot be followed";
    if (!why.empty()) return;
  }
}

/// A style that depends on a variable of the time, or acts every few steps, has different forces at
/// another step.
void Forces::look_at_time()
{
  save();
  const std::vector<double> now = forces_at(update->ntimestep);
  double largest = 0.0;
  for (const double one : now) largest = std::max(largest, std::fabs(one));
  const double same = SAME * over_ranks(MPI_MAX, largest, world);
  int differs = 0;
  for (const bigint step : {EVERY_TIMES, AT_NO_TIMES}) {
    const std::vector<double> then = forces_at(step);
    differs |= !std::equal(now.begin(), now.end(), then.begin(), [same](double a, double b) {
      return !(std::fabs(a - b) > same);
    });
  }
  if (over_ranks(MPI_MAX, differs, world)) why = "forces depend on time";
  for (const auto *one : modify->get_compute_list())
    if (one->timeflag && one->invoked_flag)
      why = "forces depend on energies or pressures, which LAMMPS computes only in steps";
  restore();
}

/// Forces and torques at another step, with energies and virials of the last step as if they were
/// current.
std::vector<double> Forces::forces_at(bigint step)
{
  const bigint present = update->ntimestep;
  const size_t n = 3 * (size_t) atom->nlocal;
  update->ntimestep = step;
  for (auto *tally : steps_of_tallies()) *tally = step;
  evaluate();
  update->ntimestep = present;
  std::vector<double> found;
  for (double **rows : {atom->f, atom->torque})
    if (n && rows) found.insert(found.end(), rows[0], rows[0] + n);
  return found;
}

/// The steps in which LAMMPS has tallied energies and virials.
std::array<bigint *, 4> Forces::steps_of_tallies()
{
  return {&update->eflag_global, &update->vflag_global, &update->eflag_atom, &update->vflag_atom};
}

void Forces::save()
{
  int tally = 0;
  for (const auto *step : steps_of_tallies()) tallied[tally++] = *step;
  modify->clearstep_compute();
  const size_t n = (size_t) atom->nlocal + atom->nghost;
  copies.clear();
  const auto keep = [this, n](double *data, int columns) {
    if (data && n > 0) copies.push_back({data, std::vector<double>(data, data + n * columns)});
  };
  if (n) keep(atom->x[0], 3);
  for (const auto &one : atom->peratom) {
    if (one.datatype != Atom::DOUBLE || one.cols < 0 || one.name == "x") continue;
    if (one.cols == 0)
      keep(*static_cast<double **>(one.address), 1);
    else if (double **rows = *static_cast<double ***>(one.address))
      keep(rows[0], one.cols);
  }
}

void Forces::restore()
{
  constexpr bigint NEVER = -1;
  int tally = 0;
  for (auto *step : steps_of_tallies()) *step = tallied[tally++];
  for (auto *one : modify->get_compute_list()) {
    one->invoked_flag = Compute::INVOKED_NONE;
    for (auto *step : {&one->invoked_scalar, &one->invoked_vector, &one->invoked_array,
                       &one->invoked_peratom, &one->invoked_local})
      *step = NEVER;
  }
  for (const auto &copy : copies) std::copy(copy.values.begin(), copy.values.end(), copy.data);
}

double Forces::largest_displacement() const
{
  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    const double d2 = distance2(atom->x[i], &copies[0].values[3 * (size_t) i]);
    largest = std::isfinite(d2) ? std::max(largest, d2) : std::numeric_limits<double>::infinity();
  }
  return std::sqrt(over_ranks(MPI_MAX, largest, world));
}

void Forces::evaluate(int eflag, int vflag)
{
  evaluate_styles(eflag, vflag);
  for (auto *fix : post_force) fix->post_force(vflag);
}

/// Repeats Verlet::run() for a step without new neighbor lists, up to post_force() of fixes.
void Forces::evaluate_styles(int eflag, int vflag)
{
  comm->forward_comm();
  clear();
  for (auto *fix : pre_force) fix->pre_force(vflag);
  if (force->pair && force->pair->compute_flag) force->pair->compute(eflag, vflag);
  if (atom->molecular != Atom::ATOMIC) {
    if (force->bond) force->bond->compute(eflag, vflag);
    if (force->angle) force->angle->compute(eflag, vflag);
    if (force->dihedral) force->dihedral->compute(eflag, vflag);
    if (force->improper) force->improper->compute(eflag, vflag);
  }
  if (force->kspace && force->kspace->compute_flag) force->kspace->compute(eflag, vflag);
  for (auto *fix : pre_force) fix->pre_reverse(eflag, vflag);
  if (force->newton) comm->reverse_comm();
}
