/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_restart.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "utils.h"

#include <cstring>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace GearQuat;

// files of releases up to 0.2.0 begin with the formulation, 0 or 1

static constexpr double MAGIC = 0x6765617271756174;    // "gearquat"
static constexpr double FORMAT = 5;

Restart::Restart(LAMMPS *lmp, const Fix *fix, Ownership &ownership, Motion &motion) :
    Pointers(lmp), fix(fix), ownership(ownership), motion(motion), block(), waiting(false), place(0)
{
}

void Restart::write(FILE *fp) const
{
  const Block data = {MAGIC, FORMAT, (double) ownership.extended().has_records(),
                      (double) atom->natoms, motion.checkpoint()};
  const int size = sizeof(data);
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&data, size, 1, fp);
}

/// LAMMPS does not tell the size of the block: only what every release wrote is read at first.
void Restart::read(const char *buf)
{
  double head[2];
  std::memcpy(head, buf, sizeof(head));
  const bool older = head[0] != MAGIC || head[1] < FORMAT;
  if (older || head[1] != FORMAT)
    error->all(FLERR,
               "Fix gear/quat: the restart file was written by {} release of GEARQUAT, whose "
               "data of fix {} this one cannot read; continue with the release that wrote it, or "
               "let that one write a data file with write_data and start from this",
               older ? "an older (0.3.0 or before)" : "a newer", fix->id);
  std::memcpy(&block, buf, sizeof(block));
  waiting = true;
}

/// Other fixes step over these data: the first number tells how many there are.
int Restart::pack(int i, double *buf) const
{
  const int n = HEAD + ownership.pack_exchange(i, buf + HEAD);
  buf[0] = n;
  buf[1] = ubuf(atom->tag[i]).d;
  return n;
}

/// The data of each atom here, null where there are none.  Rows stay where LAMMPS has read them: if
/// atoms were deleted since, those that took their places have theirs behind the rows of all atoms.
std::vector<const double *> Restart::packed_atoms() const
{
  std::unordered_map<tagint, int> without;
  for (int i = 0; i < atom->nlocal; ++i) without[atom->tag[i]] = i;
  std::vector<const double *> packed(atom->nlocal, nullptr);
  const auto look = [&](int row) {
    const double *data = atom->extra[row];
    for (int i = 0; i < place; ++i) data += (int) data[0];
    const auto found = without.find((tagint) ubuf(data[1]).i);
    if (found == without.end()) return;
    packed[found->second] = data + HEAD;
    without.erase(found);
  };

  for (int i = 0; i < atom->nlocal; ++i) look(i);
  const bigint all = over_ranks(MPI_SUM, (bigint) without.size(), world);
  const bigint deleted = (bigint) block.natoms - atom->natoms;
  if (all > deleted) return packed;    // not only deleted: there may be no such rows
  for (int i = atom->nlocal; !without.empty() && i < atom->nlocal + deleted && i < atom->nmax; ++i)
    look(i);
  return packed;
}

bool Restart::resume(int group)
{
  waiting = false;
  using Resumed = Ownership::Resumed;
  const Resumed found = ownership.resume(packed_atoms(), block.extended != 0.0, group);
  if (found == Resumed::NONE) {
    if (comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat: the bodies of this command consist of other atoms than those "
                     "of the restart file; they begin anew from their atoms");
    return false;
  }
  motion.restore(block.motion);
  if (found == Resumed::FEWER)    // forces have derivatives that the motion of the others made
    motion.forget(fmt::format("Fix gear/quat {}: some bodies of the restart file are in no body of "
                              "this command, histories start anew",
                              fix->id));
  return true;
}
