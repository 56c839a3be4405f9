/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_virial.h"

#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"

#include "angle.h"
#include "atom.h"
#include "bond.h"
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

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

// bits of vflag in LAMMPS: pairs are tallied, or forces on owned and ghost atoms

static constexpr int PAIR_BY_PAIR = 1, BY_FORCES = 2;

// exact sums represent terms up to 2^20 units, since overlaps have large forces

static constexpr double LARGE = 1048576.0;    // 2^20

// LAMMPS' order of a virial is xx yy zz xy xz yz

static constexpr int PLACES[] = {0, 1, 2, 5, 4, 3};

/* ---------------------------------------------------------------------- */

MolecularVirial::MolecularVirial(LAMMPS *lmp, const Fix *fix, const Sites &sites) :
    Pointers(lmp), id(std::string(fix->id) + "_virial"), fix(fix), sites(sites)
{
  modify->add_compute(id + " all pressure NULL pair bond angle dihedral improper kspace");
}

MolecularVirial::~MolecularVirial()
{
  if (own()) modify->delete_compute(id);
}

Compute *MolecularVirial::own() const
{
  return modify->get_compute_by_id(id);
}

static bool counts(const Fix *other)
{
  return other->virial_global_flag && other->thermo_virial;
}

void MolecularVirial::refuse_scene() const
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

void MolecularVirial::request(bigint step) const
{
  own()->addstep(step);
}

bool MolecularVirial::others_ask(bigint step) const
{
  for (auto *one : modify->get_compute_list())
    if ((one->pressflag || one->pressatomflag) && id != one->id && one->matchstep(step))
      return true;
  return false;
}

int MolecularVirial::flag() const
{
  return force->newton_pair ? BY_FORCES : PAIR_BY_PAIR;
}

template <class Style> static void add_virial(const Style *style, double (&sum)[6])
{
  if (!style) return;
  for (int k = 0; k < 6; ++k) sum[k] += style->virial[k];
}

void MolecularVirial::measure(double **f, double energy)
{
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
  const double scale = LARGE * ExactSum::scale_of(energy);
  sites.add_arm_virial(f, of_arms, scale);
  sum_over_ranks(of_arms, world);
  const auto all_styles = over_ranks(MPI_SUM, styles, world);
  for (int k = 0; k < 6; ++k) {
    virial[k] = all_styles[PLACES[k]] - of_arms[k].value(scale);
    if (force->kspace) virial[k] += force->kspace->virial[PLACES[k]];    // the sum over all ranks
    virial[k] /= force->mvv2e;
  }
  if (!force->pair || !force->pair->tail_flag) return;
  const double *edges = domain->prd;
  const double volume = edges[0] * edges[1] * (domain->dimension == 3 ? edges[2] : 1.0);
  for (int k = 0; k < domain->dimension; ++k)
    virial[k] += force->pair->ptail / (volume * force->mvv2e);
}
