/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#ifndef LMP_GEAR_QUAT_GATHER_H
#define LMP_GEAR_QUAT_GATHER_H

#include <mpi.h>
#include <numeric>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// What all ranks have, in their order, on every one of them.  Collective.
template <typename T>
std::vector<T> gather_all(std::vector<T> &mine, MPI_Datatype type, MPI_Comm world)
{
  int here = (int) mine.size(), ranks;    // not const: MPI without MPI wants it so
  MPI_Comm_size(world, &ranks);
  std::vector<int> counts(ranks), starts(ranks, 0);
  MPI_Allgather(&here, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  std::partial_sum(counts.begin(), counts.end() - 1, starts.begin() + 1);
  std::vector<T> all(starts.back() + counts.back());
  MPI_Allgatherv(mine.data(), here, type, all.data(), counts.data(), starts.data(), type, world);
  return all;
}

}    // namespace LAMMPS_NS::GearQuat

#endif
