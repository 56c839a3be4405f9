/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* What needs headers that an installed LAMMPS lacks.  A plugin for such a LAMMPS has
   cmake/plugin/without_headers.cpp instead. */

#include "gear_quat_assembly.h"
#include "gear_quat_extended.h"
#include "gear_quat_forces.h"
#include "gear_quat_shapes.h"

#include "atom.h"
#include "atom_vec_ellipsoid.h"
#include "atom_vec_line.h"
#include "atom_vec_tri.h"
#include "comm.h"
#include "lammps.h"
#include "molecule.h"
#include "respa.h"
#include "update.h"
#include "utils.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   run styles
------------------------------------------------------------------------- */

std::vector<double> GearQuat::respa_steps(LAMMPS *lmp)
{
  const auto *respa = dynamic_cast<Respa *>(lmp->update->integrate);
  if (!respa) return {};
  return std::vector<double>(respa->step, respa->step + respa->nlevels);
}

void Forces::clear()
{
  update->integrate->force_clear();
}

/* ----------------------------------------------------------------------
   mass, center and inertia in a molecule template
------------------------------------------------------------------------- */

static constexpr double SAME = 1.0e-6;    // numbers of a file have few digits

/// The current properties of the molecule: given properties, and sums over its atoms for the rest.
static StatedMolecule present(Molecule *molecule)
{
  molecule->compute_center();
  molecule->compute_mass();
  molecule->compute_com();
  molecule->compute_inertia();
  const double *t = molecule->itensor;    // xx yy zz yz xz xy
  StatedMolecule now = {
      molecule->masstotal, {}, {t[0], t[5], t[4], t[5], t[1], t[3], t[4], t[3], t[2]}};
  for (int k = 0; k < 3; ++k) now.center[k] = molecule->com[k] - molecule->center[k];
  return now;
}

static bool differ(const StatedMolecule &a, const StatedMolecule &b, double size)
{
  double largest = 0.0;
  for (const double moment : b.inertia) largest = std::max(largest, std::fabs(moment));
  bool any = std::fabs(a.mass - b.mass) > SAME * b.mass;
  for (int k = 0; k < 3; ++k) any = any || std::fabs(a.center[k] - b.center[k]) > SAME * size;
  for (int k = 0; k < 9; ++k) any = any || std::fabs(a.inertia[k] - b.inertia[k]) > SAME * largest;
  return any;
}

/// The sums over the atoms; the molecule keeps its given properties.
static StatedMolecule summed(Molecule *molecule)
{
  const double mass = molecule->masstotal;
  double com[3], tensor[6];
  std::copy_n(molecule->com, 3, com);
  std::copy_n(molecule->itensor, 6, tensor);
  molecule->massflag = molecule->comflag = molecule->inertiaflag = 0;
  const StatedMolecule sums = present(molecule);
  molecule->masstotal = mass;
  std::copy_n(com, 3, molecule->com);
  std::copy_n(tensor, 6, molecule->itensor);
  present(molecule);    // compute dependent quantities
  return sums;
}

/// Fixes such as gcmc compute these properties and mark them as given, so only others count.
std::map<int, StatedMolecule> GearQuat::read_stated(LAMMPS *lmp, const std::string &template_id)
{
  std::map<int, StatedMolecule> all;
  Molecule **molecules = find_template(lmp, template_id);
  for (int n = 0; molecules && n < molecules[0]->nset; ++n) {
    Molecule *one = molecules[n];
    const bool states = one->massflag || one->comflag || one->inertiaflag;
    const StatedMolecule stated = present(one);
    if (!states) continue;
    const StatedMolecule sums = summed(one);
    if (!differ(stated, sums, std::max(one->maxextent, one->molradius))) continue;
    all[n] = stated;
    if (lmp->comm->me == 0)
      utils::logmesg(
          lmp,
          "Fix gear/quat: molecule template {} gives a mass, center of mass or inertia "
          "that differ from its atoms; bodies use the given values (mass {:g}, atoms {:g})\n",
          template_id, stated.mass, sums.mass);
  }
  return all;
}

/* ----------------------------------------------------------------------
   orientations in LAMMPS' atom styles.  LAMMPS keeps the corners of a triangle in a frame that is
   principal only if its data file has the triangle at the origin: the own frame follows from the
   corners, which do not change
------------------------------------------------------------------------- */

const bool Extended::READS_ATOM_STYLES = true;

void Extended::find_atom_styles()
{
  ellipsoids = dynamic_cast<AtomVecEllipsoid *>(atom->style_match("ellipsoid"));
  lines = dynamic_cast<AtomVecLine *>(atom->style_match("line"));
  triangles = dynamic_cast<AtomVecTri *>(atom->style_match("tri"));
}

void Extended::read_bonus(int i, double mass, Own &mine) const
{
  if (mine.shape == ELLIPSOID) {
    const auto &bonus = ellipsoids->bonus[atom->ellipsoid[i]];
    ellipsoid_moments(mass, bonus.shape, mine.moments);
    from_lammps(bonus.quat, mine.q);
  } else if (mine.shape == LINE) {
    const auto &bonus = lines->bonus[atom->line[i]];
    line_moments(mass, bonus.length, mine.moments);
    quaternion_about_z(bonus.theta, mine.q);
  } else if (mine.shape == TRIANGLE) {
    const auto &bonus = triangles->bonus[atom->tri[i]];
    double of_corners[4], principal[4];
    triangle_moments(mass, bonus.c1, bonus.c2, bonus.c3, mine.moments, principal);
    from_lammps(bonus.quat, of_corners);
    w_times(of_corners, principal, mine.q);
  }
}

void Extended::find_corners(Site &site) const
{
  const auto &bonus = triangles->bonus[atom->tri[site.atom]];
  double moments[3], principal[4];
  triangle_moments(1.0, bonus.c1, bonus.c2, bonus.c3, moments, principal);
  for (int k = 0; k < 3; ++k) site.corners[k] = -principal[k];
  site.corners[3] = principal[3];
}

void Extended::write_bonus(const Site &site, int shape, const double *q) const
{
  const int i = site.atom;
  if (shape == ELLIPSOID) {
    to_lammps(q, ellipsoids->bonus[atom->ellipsoid[i]].quat);
  } else if (shape == LINE) {
    lines->bonus[atom->line[i]].theta = angle_about_z(q);
  } else if (shape == TRIANGLE) {
    double of_corners[4];
    w_times(q, site.corners, of_corners);
    to_lammps(of_corners, triangles->bonus[atom->tri[i]].quat);
  }
}
