/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_forces.h"

#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "comm.h"
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

// pair styles that draw random numbers or keep a history of contacts

static const char *const UNFOLLOWED_PAIRS[] = {"dpd", "gran", "brownian", "^reax", "^bpm"};

// fixes whose post_force() is a function of positions, velocities and perhaps time

static const char *const FOLLOWED_FIXES[] = {
    "^addforce",     "^efield",       "^enforce2d",     "^freeze$",  "^gravity",
    "^indent$",      "^lineforce",    "^planeforce",    "^setforce", "^spring$",
    "^spring/self",  "^viscous$",     "^wall/harmonic", "^wall/lj",  "^wall/morse",
    "^wall/colloid", "^wall/region$", "^wall/table"};

static bool followed(const Fix *fix)
{
  return std::any_of(std::begin(FOLLOWED_FIXES), std::end(FOLLOWED_FIXES),
                     [fix](const char *style) {
                       return utils::strmatch(fix->style, style);
                     });
}

/* ---------------------------------------------------------------------- */

GearQuatForces::GearQuatForces(LAMMPS *lmp, const Fix *owner) : Pointers(lmp)
{
  look_at_styles();
  if (why.empty()) look_at_fixes(owner);
  if (why.empty()) look_at_time();
}

void GearQuatForces::look_at_styles()
{
  if (lmp->kokkos) why = "the KOKKOS package is on";
  if (!force->pair) return;
  for (const auto *style : UNFOLLOWED_PAIRS)
    if (force->pair_match(style, 0, 1))
      why = std::string("pair style ") + force->pair_style +
          " draws random numbers or keeps a "
          "history of contacts";
}

void GearQuatForces::look_at_fixes(const Fix *owner)
{
  const int during_force =
      FixConst::PRE_FORCE | FixConst::PRE_REVERSE | FixConst::POST_FORCE | FixConst::POST_INTEGRATE;
  for (auto *fix : modify->get_fix_list()) {
    if (fix == owner) continue;
    const int mask = modify->get_fix_mask(fix);
    const std::string name = std::string("fix ") + fix->id + " (" + fix->style + ")";
    if (fix->time_integrate)
      why = name + " moves atoms";
    else if (utils::strmatch(fix->style, "^OMP"))
      pre_force.push_back(fix);
    else if (followed(fix))
      post_force.push_back(fix);
    else if (mask & during_force)
      why = name + " acts on forces in a way that cannot be followed";
    if (!why.empty()) return;
  }
}

/// A fix that follows a variable of time gives another force at another step.
void GearQuatForces::look_at_time()
{
  if (post_force.empty()) return;
  save();
  std::vector<double> now;
  for (const bigint shift : {0, 1000003}) {
    clear_forces();
    update->ntimestep += shift;
    for (auto *fix : post_force) fix->post_force(0);
    update->ntimestep -= shift;
    const size_t n = 3 * (size_t) atom->nlocal;
    std::vector<double> then;
    if (n) then.assign(atom->f[0], atom->f[0] + n);
    if (n && atom->torque_flag) then.insert(then.end(), atom->torque[0], atom->torque[0] + n);
    if (shift == 0)
      now = then;
    else {
      int differs = now != then;
      int any = 0;
      MPI_Allreduce(&differs, &any, 1, MPI_INT, MPI_MAX, world);
      if (any) why = "an external force depends on time";
    }
  }
  restore();
}

/* ---------------------------------------------------------------------- */

static void keep(double **array, int n, std::vector<double> &copy)
{
  if (array && n) copy.assign(array[0], array[0] + 3 * (size_t) n);
}

static void put_back(double **array, const std::vector<double> &copy)
{
  if (!copy.empty()) std::copy(copy.begin(), copy.end(), array[0]);
}

void GearQuatForces::save()
{
  const int n = atom->nlocal + atom->nghost;
  keep(atom->x, n, x);
  keep(atom->v, n, v);
  keep(atom->f, n, f);
  if (atom->torque_flag) {
    torque.resize(3 * (size_t) n);
    if (n) std::copy_n(atom->torque[0], torque.size(), torque.begin());
  }
}

void GearQuatForces::restore()
{
  put_back(atom->x, x);
  put_back(atom->v, v);
  put_back(atom->f, f);
  if (atom->torque_flag) put_back(atom->torque, torque);
}

double GearQuatForces::largest_displacement() const
{
  double largest = 0.0, all;
  for (int i = 0; i < atom->nlocal; ++i) {
    double d2 = 0.0;
    for (int k = 0; k < 3; ++k) d2 += std::pow(atom->x[i][k] - x[3 * (size_t) i + k], 2);
    largest = std::isfinite(d2) ? std::max(largest, d2) : std::numeric_limits<double>::infinity();
  }
  MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return std::sqrt(all);
}

void GearQuatForces::evaluate()
{
  comm->forward_comm();
  clear_forces();
  for (auto *fix : pre_force) fix->pre_force(0);
  compute_forces();
  for (auto *fix : pre_force) fix->pre_reverse(0, 0);
  if (force->newton) comm->reverse_comm();
  for (auto *fix : post_force) fix->post_force(0);
}

void GearQuatForces::clear_forces()
{
  const size_t n = 3 * (size_t) (atom->nlocal + (force->newton ? atom->nghost : 0));
  if (n == 0) return;
  std::fill_n(atom->f[0], n, 0.0);
  if (atom->torque_flag) std::fill_n(atom->torque[0], n, 0.0);
}

/// Without energies and virials: what thermo prints of the step stays as it is.
void GearQuatForces::compute_forces()
{
  if (force->pair && force->pair->compute_flag) force->pair->compute(0, 0);
  if (atom->molecular != Atom::ATOMIC) {
    if (force->bond) force->bond->compute(0, 0);
    if (force->angle) force->angle->compute(0, 0);
    if (force->dihedral) force->dihedral->compute(0, 0);
    if (force->improper) force->improper->compute(0, 0);
  }
  if (force->kspace && force->kspace->compute_flag) force->kspace->compute(0, 0);
}
