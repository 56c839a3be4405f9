/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_template.h"

#include "gear_quat_ownership.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "lammps.h"

#include <algorithm>
#include <cmath>

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
   insertion of a molecule
------------------------------------------------------------------------- */

/// The molecule of the template at its position, rotated.
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

void GearQuat::add_molecule(LAMMPS *lmp, Ownership &ownership, int first,
                            const StatedMolecule *stated, const Insertion &insertion)
{
  const Atom *atom = lmp->atom;
  tagint smallest = MAXTAGINT;
  for (int i = first; i < atom->nlocal; ++i) smallest = std::min(smallest, atom->molecule[i]);
  const tagint id = over_ranks(MPI_MIN, smallest, lmp->world);

  GivenBodies given;
  if (stated && stated->differs) given[id] = given_at(*stated, insertion);
  std::vector<tagint> ids(atom->nlocal, 0);
  std::fill(ids.begin() + first, ids.end(), id);
  ownership.add(ids, given, true);
}
