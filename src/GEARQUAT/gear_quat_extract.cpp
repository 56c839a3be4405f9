/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_extract.h"

#include "gear_quat_template.h"

#include "atom.h"
#include "force.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

void *Extract::extract(const std::string &name, int &dim)
{
  dim = 0;
  nbody = (int) bodies.body.size();
  if (name == "nbody") return &nbody;
  if (name == "onemol") return find_template(lmp, template_id);
  if (name == "ke") {
    ke = energy(false);
    return &ke;
  }
  if (name == "erotational") {
    erotational = energy(true);
    return &erotational;
  }

  if (name == "body") {
    dim = 1;
    body.assign(atom->nlocal + 1, -1);    // one more: no null pointer on a rank without atoms
    for (const auto &site : bodies.sites)
      if (site.atom < atom->nlocal) body[site.atom] = site.body;
    return body.data();
  }
  if (name == "masstotal") {
    dim = 1;
    masstotal.resize(nbody + 1);
    for (int i = 0; i < nbody; ++i) masstotal[i] = bodies.body[i].rigid.mass;
    return masstotal.data();
  }
  if (name == "inertia") {
    dim = 2;
    inertia.resize(3 * (nbody + 1));
    inertia_rows.resize(nbody + 1);
    for (int i = 0; i < nbody; ++i) {
      inertia_rows[i] = inertia.data() + 3 * i;
      std::copy_n(bodies.body[i].rigid.inertia, 3, inertia_rows[i]);
    }
    return inertia_rows.data();
  }
  return nullptr;
}

double Extract::energy(bool rotational) const
{
  double here = 0.0, all;
  for (int i = 0; i < bodies.nowned(); ++i)
    here += rotational ? rotational_energy(bodies.body[i].rigid, bodies.state[i].omega_body)
                       : translational_energy(bodies.body[i].rigid, bodies.state[i].velocity);
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all * force->mvv2e;
}
