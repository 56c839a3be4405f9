/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_forces.h"

#include "gear_quat_quaternion.h"
#include "gear_quat_ranks.h"
#include "gear_quat_scene.h"

#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "compute.h"
#include "dihedral.h"
#include "fix.h"
#include "force.h"
#include "improper.h"
#include "info.h"
#include "kspace.h"
#include "memory.h"
#include "modify.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

// pair styles that draw random numbers, or keep contacts, bonds or charges from one step to the
// next

static const char *const UNFOLLOWED_PAIRS[] = {"dpd",      "gran",  "brownian", "^dsmc",
                                               "^reax",    "^bpm",  "^amoeba",  "^hippo",
                                               "^tracker", "^peri", "^rheo",    "^smd"};

// random forces, and the most values that leave bodies at their temperature; collisions last one
// step

static const char *const RANDOM_PAIRS[] = {"dpd", "brownian", "^dsmc"};
static const char *const RANDOM_FIXES[] = {"langevin", "brownian", "^gle", "^gld", "^ttm"};
static const char *const COLLISIONS[] = {"^srd"};

// bond styles that break or have a memory

static const char *const UNFOLLOWED_BONDS[] = {"quartic",    "quartic/omp",        "bpm/rotational",
                                               "bpm/spring", "bpm/spring/plastic", "rheo/shell"};

// fixes whose post_force() is a function of positions, velocities and perhaps time

static const char *const FOLLOWED_FIXES[] = {
    "^addforce",     "^efield",       "^enforce2d",     "^freeze$",  "^gravity",
    "^indent$",      "^lineforce",    "^planeforce",    "^setforce", "^spring$",
    "^spring/self",  "^viscous$",     "^wall/harmonic", "^wall/lj",  "^wall/morse",
    "^wall/colloid", "^wall/region$", "^wall/table"};

// those of them that read no variables

static const char *const WITHOUT_VARIABLES[] = {"^enforce2d",  "^freeze$", "^lineforce",
                                                "^planeforce", "^spring$", "^viscous$"};

// functions and styles of variables that give another value whenever they are evaluated

static const char *const UNREPEATABLE[] = {"random(", "normal(", "next(", "py_", "style = python"};

// step numbers for a look at forces that depend on time: multiples of everything and of nothing

static constexpr bigint EVERY_TIMES = 0, AT_NO_TIMES = 1000003;

template <int N> static bool among(const char *const (&styles)[N], const Fix *fix)
{
  return std::any_of(styles, styles + N, [fix](const char *style) {
    return utils::strmatch(fix->style, style);
  });
}

/* ---------------------------------------------------------------------- */

Forces::Forces(LAMMPS *lmp, const std::vector<const Fix *> &owners) : Pointers(lmp), tallies(lmp)
{
  look_at_styles();
  if (why.empty()) look_at_fixes(owners);
  if (why.empty()) look_at_variables();
  if (why.empty()) look_at_time();
}

Noise Forces::noise(const std::function<bool(int)> &in_body) const
{
  Noise found = Noise::NONE;
  for (const auto *style : RANDOM_PAIRS)
    if (force->pair && force->pair_match(style, 0, 1)) found = Noise::RANDOM;
  for (const auto *fix : modify->get_fix_list()) {
    if (among(COLLISIONS, fix)) return Noise::COLLISIONS;
    if (!among(RANDOM_FIXES, fix)) continue;
    int here = 0;
    for (int i = 0; i < atom->nlocal; ++i)
      if ((atom->mask[i] & fix->groupbit) && in_body(i)) here = 1;
    if (over_ranks(MPI_MAX, here, world)) found = Noise::RANDOM;
  }
  return found;
}

void Forces::look_at_styles()
{
  if (lmp->kokkos) why = "the KOKKOS package is on";
  for (const auto *style : UNFOLLOWED_BONDS)
    if (force->bond_match(style))
      why = fmt::format("bonds of style {} may break or change for good", style);
  for (const auto *style : UNFOLLOWED_PAIRS)
    if (force->pair && force->pair_match(style, 0, 1))
      why = fmt::format("pair style {} draws random numbers or has a memory", force->pair_style);
}

void Forces::look_at_fixes(const std::vector<const Fix *> &owners)
{
  const int during_force =
      FixConst::PRE_FORCE | FixConst::PRE_REVERSE | FixConst::POST_FORCE | FixConst::POST_INTEGRATE;
  for (auto *fix : modify->get_fix_list()) {
    if (std::find(owners.begin(), owners.end(), fix) != owners.end()) continue;
    const int mask = modify->get_fix_mask(fix);
    if (fix->time_integrate)
      why = name_of(fix) + " moves atoms";
    else if (utils::strmatch(fix->style, "^OMP"))
      pre_force.push_back(fix);
    else if (among(FOLLOWED_FIXES, fix))
      post_force.push_back(fix);
    else if (mask & during_force)
      why = name_of(fix) + " acts on forces in a way that cannot be followed";
    if (!why.empty()) return;
  }
}

/// A variable that draws or counts must not be evaluated more often than without this fix.
void Forces::look_at_variables()
{
  const auto reader = std::find_if(post_force.begin(), post_force.end(), [](const Fix *fix) {
    return !among(WITHOUT_VARIABLES, fix);
  });
  if (reader == post_force.end()) return;
  Info info(lmp);
  int number = 0;
  const auto names = info.get_variable_names(number);
  for (int i = 0; i < number; ++i) {
    const std::string text = info.get_variable_info(i);
    for (const auto *word : UNREPEATABLE)
      if (text.find(word) != std::string::npos)
        why = fmt::format("{} may read variable {}, which is another one whenever it is evaluated",
                          name_of(*reader), names[i]);
  }
}

/// A fix that follows a variable of time, or acts every few steps, gives another force at another
/// step.
void Forces::look_at_time()
{
  if (post_force.empty()) return;
  save();
  const std::vector<double> now = external_forces(update->ntimestep);
  for (const bigint step : {EVERY_TIMES, AT_NO_TIMES}) {
    if (!why.empty()) break;
    const int differs = now != external_forces(step);
    if (over_ranks(MPI_MAX, differs, world) && why.empty())
      why = "an external force depends on time";
  }
  restore();
}

/// Forces and torques of the fixes alone at another step; reason() says if one of them reads an
/// energy or a pressure.
std::vector<double> Forces::external_forces(bigint step)
{
  const bigint present = update->ntimestep;
  clear_forces();
  update->ntimestep = step;
  tallies.pretend();
  for (auto *fix : post_force) {
    fix->post_force(0);
    if (why.empty() && tallies.used())
      why = name_of(fix) + " depends on energies or pressures, which are known in steps only";
  }
  update->ntimestep = present;
  const size_t n = 3 * (size_t) atom->nlocal;
  std::vector<double> found;
  if (n) found.assign(atom->f[0], atom->f[0] + n);
  if (n && atom->torque_flag) found.insert(found.end(), atom->torque[0], atom->torque[0] + n);
  return found;
}

/* ---------------------------------------------------------------------- */

static void save_array(double **array, int n, std::vector<double> &copy)
{
  if (array && n) copy.assign(array[0], array[0] + 3 * (size_t) n);
}

static void restore_array(double **array, const std::vector<double> &copy)
{
  if (!copy.empty()) std::copy(copy.begin(), copy.end(), array[0]);
}

void Forces::save()
{
  tallies.save();
  const int n = atom->nlocal + atom->nghost;
  save_array(atom->x, n, x);
  save_array(atom->v, n, v);
  save_array(atom->f, n, f);
  if (atom->torque_flag) save_array(atom->torque, n, torque);
}

void Forces::restore()
{
  tallies.restore();
  restore_array(atom->x, x);
  restore_array(atom->v, v);
  restore_array(atom->f, f);
  if (atom->torque_flag) restore_array(atom->torque, torque);
}

double Forces::largest_displacement() const
{
  double largest = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    const double d2 = distance2(atom->x[i], &x[3 * (size_t) i]);
    largest = std::isfinite(d2) ? std::max(largest, d2) : std::numeric_limits<double>::infinity();
  }
  return std::sqrt(over_ranks(MPI_MAX, largest, world));
}

void Forces::evaluate(int eflag, int vflag)
{
  comm->forward_comm();
  clear_forces();
  for (auto *fix : pre_force) fix->pre_force(vflag);
  compute_forces(eflag, vflag);
  for (auto *fix : pre_force) fix->pre_reverse(eflag, vflag);
  if (force->newton) comm->reverse_comm();
  for (auto *fix : post_force) fix->post_force(vflag);
}

void Forces::clear_forces()
{
  const size_t n = 3 * (size_t) (atom->nlocal + (force->newton ? atom->nghost : 0));
  if (n == 0) return;
  std::fill_n(atom->f[0], n, 0.0);
  if (atom->torque_flag) std::fill_n(atom->torque[0], n, 0.0);
}

/// Without flags thermo output of the step stays as it is.
void Forces::compute_forces(int eflag, int vflag)
{
  if (force->pair && force->pair->compute_flag) force->pair->compute(eflag, vflag);
  if (atom->molecular != Atom::ATOMIC) {
    if (force->bond) force->bond->compute(eflag, vflag);
    if (force->angle) force->angle->compute(eflag, vflag);
    if (force->dihedral) force->dihedral->compute(eflag, vflag);
    if (force->improper) force->improper->compute(eflag, vflag);
  }
  if (force->kspace && force->kspace->compute_flag) force->kspace->compute(eflag, vflag);
}

/* ----------------------------------------------------------------------
   what LAMMPS notes of computes
------------------------------------------------------------------------- */

static constexpr bigint NEVER = -1;

/// The notes of a compute that name the step of its last evaluation.
static std::vector<bigint *> steps_of_evaluation(Compute *one)
{
  return {&one->invoked_scalar, &one->invoked_vector, &one->invoked_array, &one->invoked_peratom,
          &one->invoked_local};
}

static std::vector<bigint *> steps_of_tally(Update *update)
{
  return {&update->eflag_global, &update->vflag_global, &update->eflag_atom, &update->vflag_atom};
}

void Tallies::save()
{
  notes.clear();
  for (auto *one : modify->get_compute_list()) {
    Note note = {one->invoked_flag, {}, {}};
    int n = 0;
    for (const auto *step : steps_of_evaluation(one)) note.invoked[n++] = *step;
    if (one->timeflag) note.steps.assign(one->tlist, one->tlist + one->ntime);
    notes.push_back(note);
  }
  int n = 0;
  for (const auto *step : steps_of_tally(update)) tallied[n++] = *step;
  modify->clearstep_compute();
}

void Tallies::pretend()
{
  for (auto *step : steps_of_tally(update)) *step = update->ntimestep;
}

bool Tallies::used() const
{
  const auto &computes = modify->get_compute_list();
  return std::any_of(computes.begin(), computes.end(), [](const Compute *one) {
    return one->timeflag && one->invoked_flag;
  });
}

void Tallies::restore()
{
  size_t which = 0;
  for (auto *one : modify->get_compute_list()) {
    const Note &note = notes[which++];
    int n = 0;
    one->invoked_flag = note.flag;
    for (auto *step : steps_of_evaluation(one)) {
      if (*step != note.invoked[n]) {
        *step = NEVER;
        one->invoked_flag = Compute::INVOKED_NONE;
      }
      ++n;
    }
    if (!one->timeflag) continue;
    one->clearstep();
    for (const bigint step : note.steps) one->addstep(step);
  }
  int n = 0;
  for (auto *step : steps_of_tally(update)) *step = tallied[n++];
}

/* ----------------------------------------------------------------------
   r-RESPA
------------------------------------------------------------------------- */

RespaForces::RespaForces(LAMMPS *lmp) : Pointers(lmp), f(nullptr), torque(nullptr), nmax(0) {}

RespaForces::~RespaForces()
{
  memory->destroy(f);
  memory->destroy(torque);
}

bool RespaForces::outermost(int level) const
{
  return level == levels() - 1;
}

int RespaForces::levels() const
{
  return (int) steps(lmp).size();
}

/// Atoms may have been exchanged since the step began.
void RespaForces::begin()
{
  if (atom->nmax > nmax) {
    nmax = atom->nmax;
    memory->destroy(f);
    memory->destroy(torque);
    memory->create(f, nmax, 3, "gear/quat:f_sum");
    if (atom->torque_flag) memory->create(torque, nmax, 3, "gear/quat:torque_sum");
  }
  std::fill_n(f[0], 3 * (size_t) nmax, 0.0);
  if (torque) std::fill_n(torque[0], 3 * (size_t) nmax, 0.0);
}

void RespaForces::add(int level)
{
  if (level == 0) begin();
  for (int i = 0; i < atom->nlocal; ++i) {
    add3(atom->f[i], f[i]);
    if (torque) add3(atom->torque[i], torque[i]);
  }
}

/// LAMMPS keeps them in a fix of its own, that packs for each atom 3 numbers a level: forces, then
/// torques.
void RespaForces::sum_present()
{
  begin();
  Fix *store = modify->get_fix_by_id("RESPA");
  const int n = levels();
  std::vector<double> stored((torque ? 6 : 3) * (size_t) n);
  for (int i = 0; i < atom->nlocal; ++i) {
    store->pack_exchange(i, stored.data());
    for (int j = 0; j < 3 * n; ++j) {
      f[i][j % 3] += stored[j];
      if (torque) torque[i][j % 3] += stored[3 * n + j];
    }
  }
}

double RespaForces::memory_usage() const
{
  return (torque ? 6.0 : 3.0) * nmax * sizeof(double);
}
