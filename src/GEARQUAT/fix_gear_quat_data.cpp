/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.

   See the README file in the package's directory.
------------------------------------------------------------------------- */

/* The hooks of LAMMPS for data: with atoms from rank to rank, and in restart files. */

#include "fix_gear_quat.h"

#include "gear_quat_arguments.h"
#include "gear_quat_outputs.h"
#include "gear_quat_restart.h"
#include "gear_quat_template.h"

#include "atom.h"
#include "comm.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   per-atom data, forwarded to the ownership of bodies
------------------------------------------------------------------------- */

void FixGearQuat::grow_arrays(int nmax)
{
  ownership->grow_arrays(nmax);
}

void FixGearQuat::copy_arrays(int i, int j, int delflag)
{
  ownership->copy_arrays(i, j, delflag);
}

/// A new atom is outside all bodies until set_molecule() assigns it to one.
void FixGearQuat::set_arrays(int i)
{
  ownership->set_arrays(i);
  if (atom->mask[i] & groupbit) ownership->note_outside_atom(1);
}

/// Another fix has inserted a molecule of the template.
void FixGearQuat::set_molecule(int first, tagint /*before*/, int which, double *center,
                               double *velocity, double *quat)
{
  for (int i = first; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) ownership->note_outside_atom(-1);
  const bool known = which >= 0 && which < (int) stated.size();
  add_molecule(lmp, *ownership, first, known ? &stated[which] : nullptr, {center, velocity, quat});
}

void *FixGearQuat::extract(const char *name, int &dim)
{
  return extracts->extract(name, dim);
}

int FixGearQuat::pack_exchange(int i, double *buf)
{
  return ownership->pack_exchange(i, buf);
}

int FixGearQuat::unpack_exchange(int nlocal, double *buf)
{
  return ownership->unpack_exchange(nlocal, buf);
}

int FixGearQuat::pack_forward_comm(int n, int *list, double *buf, int /*pbc_flag*/, int * /*pbc*/)
{
  return ownership->pack_forward(n, list, buf);
}

void FixGearQuat::unpack_forward_comm(int n, int first, double *buf)
{
  ownership->unpack_forward(n, first, buf);
}

int FixGearQuat::pack_reverse_comm(int n, int first, double *buf)
{
  return ownership->pack_reverse(n, first, buf);
}

void FixGearQuat::unpack_reverse_comm(int n, int *list, double *buf)
{
  ownership->unpack_reverse(n, list, buf);
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

void FixGearQuat::write_restart(FILE *fp)
{
  if (comm->me == 0) restarts->write(fp);
}

void FixGearQuat::write_restart_file(const char *file)
{
  if (!met_atoms) return;    // the user may still change the atoms
  show_bodies();
  restarts->write_bodies(fmt::format("{}.{}.gear_quat", file, id), array_local);
}

void FixGearQuat::restart(char *buf)
{
  restarts->read(buf);
}

/// The bodies of a restart file continue if the command creates the same bodies.
void FixGearQuat::resume()
{
  if (!restarts->was_read()) return;
  const bool others_come = !args->mol.empty();    // insertions may come from outside of the group
  met_atoms = restarts->resume(others_come ? groupbit : 0);
  if (!met_atoms) create_bodies();
}

int FixGearQuat::pack_restart(int i, double *buf)
{
  return restarts->pack(i, buf);
}

void FixGearQuat::unpack_restart(int /*nlocal*/, int nth)
{
  restarts->note_place(nth);
}

int FixGearQuat::size_restart(int i)
{
  return restarts->size(i);
}

int FixGearQuat::maxsize_restart()
{
  return restarts->max_size();
}
