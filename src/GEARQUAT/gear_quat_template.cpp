/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_template.h"

#include "gear_quat_bodies.h"

#include "atom.h"
#include "error.h"
#include "lammps.h"

#include <algorithm>

using namespace LAMMPS_NS;

Molecule **LAMMPS_NS::find_template(LAMMPS *lmp, const std::string &template_id)
{
  if (template_id.empty()) return nullptr;
  const int first = lmp->atom->find_molecule(template_id.c_str());
  if (first < 0)
    lmp->error->all(FLERR, "Fix gear/quat mol: molecule template ID {} does not exist",
                    template_id);
  return &lmp->atom->molecules[first];
}

void LAMMPS_NS::add_molecule(LAMMPS *lmp, GearQuatBodies &bodies, int first)
{
  const Atom *atom = lmp->atom;
  tagint smallest = MAXTAGINT, id;
  for (int i = first; i < atom->nlocal; ++i) smallest = std::min(smallest, atom->molecule[i]);
  MPI_Allreduce(&smallest, &id, 1, MPI_LMP_TAGINT, MPI_MIN, lmp->world);

  std::vector<tagint> ids(atom->nlocal, 0);
  std::fill(ids.begin() + first, ids.end(), id);
  const int before = bodies.nowned();
  bodies.add(ids, GivenBodies());
  for (int ibody = before; ibody < bodies.nowned(); ++ibody) bodies.body[ibody].fresh = 1;
}
