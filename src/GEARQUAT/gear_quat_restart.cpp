/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_restart.h"

#include "gear_quat_given_bodies.h"
#include "gear_quat_outputs.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace GearQuat;

Restart::Restart(LAMMPS *lmp, const Fix *fix, const Bodies &bodies, Ownership &ownership,
                 Step &step) :
    Pointers(lmp),
    fix(fix), bodies(bodies), ownership(ownership), step(step)
{
}

void Restart::write(FILE *fp) const
{
  Fields numbers;
  double records = ownership.extended().has_records(), all = (double) atom->natoms;
  numbers(records, all);
  step.write(numbers);
  const double head[] = {MAGIC, FORMAT, (double) numbers.numbers().size()};
  const int size = (int) (sizeof(head) + numbers.numbers().size() * sizeof(double));
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(head, sizeof(head), 1, fp);
  fwrite(numbers.numbers().data(), size - sizeof(head), 1, fp);
}

/// LAMMPS does not pass the size of the block, so the part that every release wrote is read first.
void Restart::read(const char *buf)
{
  double head[3];
  std::memcpy(head, buf, sizeof(head));
  if (head[0] != MAGIC || head[1] != FORMAT || !(head[2] >= 0.0))
    error->all(FLERR,
               "Fix gear/quat: the data of fix {} in the restart file are from another release of "
               "GEARQUAT, whose format this release does not read; continue with that release, or "
               "give the fix another ID, with which its bodies start from their atoms",
               fix->id);
  Fields::Numbers data((size_t) head[2]);
  std::memcpy(data.data(), buf + sizeof(head), data.size() * sizeof(double));
  file = Fields(data);
  file(extended, natoms);
}

/// The first number is the count of numbers, with which other fixes skip these data.
int Restart::pack(int i, double *buf) const
{
  const int n = HEAD + ownership.pack_exchange(i, buf + HEAD);
  buf[0] = n;
  buf[1] = ubuf(atom->tag[i]).d;
  return n;
}

/// The data of each atom on this rank, null if there are none.  Rows keep their positions: if atoms
/// were deleted, the rows of the atoms that replaced them are after the rows of all atoms.
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
  const bigint deleted = (bigint) natoms - atom->natoms;
  if (all > deleted) return packed;    // not only deletions: these rows may not exist
  for (int i = atom->nlocal; !without.empty() && i < atom->nlocal + deleted && i < atom->nmax; ++i)
    look(i);
  return packed;
}

bool Restart::resume(int group)
{
  using Resumed = Ownership::Resumed;
  Fields data;
  std::swap(data, file);
  step.adopt_scheme(data);
  const Resumed found = ownership.resume(packed_atoms(), extended != 0.0, group);
  if (found == Resumed::NONE) {
    if (comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat: the bodies of this command do not consist of the same atoms "
                     "as in the restart file; they are rebuilt from their atoms");
    return false;
  }
  if (!step.read(data))
    error->all(FLERR, "Fix gear/quat: the data of fix {} in the restart file are damaged", fix->id);
  if (found == Resumed::FEWER)    // the motion of the others contributes to derivatives of forces
    step.forget(fmt::format("Fix gear/quat {}: some bodies of the restart file are in no body of "
                            "this command; histories are rebuilt",
                            fix->id));
  return true;
}

/* ----------------------------------------------------------------------
   the text file beside a restart file
------------------------------------------------------------------------- */

namespace {

/// A line of the file.
struct Line {
  tagint id;
  GivenBody body;
};

Line line_of(const Body &body, const BodyState &state, const double *row)
{
  Line line = {body.id, GivenBody()};
  GivenBody &written = line.body;
  written.mass = body.rigid.mass;
  std::copy_n(row + Outputs::CENTER, 3, written.center);
  std::copy_n(row + Outputs::VELOCITY, 3, written.velocity);
  std::copy_n(row + Outputs::ANGULAR_MOMENTUM, 3, written.angular_momentum_space);
  std::copy_n(row + Outputs::IMAGE, 3, written.image);

  // A^T I A, where the rows of A are the principal axes; xx yy zz xy xz yz

  static constexpr int FIRST[6] = {0, 1, 2, 0, 0, 1}, SECOND[6] = {0, 1, 2, 1, 2, 2};
  double a[9];
  rotation_matrix(state.q, dot4(state.q, state.q), a);
  for (int m = 0; m < 6; ++m)
    for (int k = 0; k < 3; ++k)
      written.inertia[m] += body.rigid.inertia[k] * a[3 * k + FIRST[m]] * a[3 * k + SECOND[m]];
  return line;
}

void print(FILE *file, const Line &line)
{
  double numbers[GivenBody::NUMBERS];
  std::memcpy(numbers, &line.body, sizeof(numbers));
  fprintf(file, TAGINT_FORMAT, line.id);
  for (const double number : numbers) fprintf(file, " %.16e", number);
  fprintf(file, " %d %d %d\n", line.body.image[0], line.body.image[1], line.body.image[2]);
}

}    // namespace

void Restart::write_bodies(const std::string &filename, double **rows) const
{
  std::vector<Line> mine;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    mine.push_back(line_of(bodies.body_at(ibody), bodies.state_of(ibody), rows[ibody]));
  const auto before = [](const Line &a, const Line &b) {
    return a.id < b.id;
  };
  const std::vector<Line> all = gather_sorted(mine, world, before, 0);
  if (comm->me != 0) return;

  const auto refuse = [&] {
    error->one(FLERR, "Fix gear/quat: cannot write file {}: {}", filename, utils::getsyserror());
  };
  const std::string unfinished = filename + ".tmp";
  FILE *file = fopen(unfinished.c_str(), "w");
  if (!file) refuse();
  fprintf(file,
          "# fix %s gear/quat: mass, center of mass, inertia tensor and momenta of %zu bodies on "
          "timestep " BIGINT_FORMAT "\n\n%zu\n",
          fix->id, all.size(), update->ntimestep, all.size());
  for (const Line &line : all) print(file, line);
  const bool failed = ferror(file) != 0;
  if (fclose(file) != 0 || failed || rename(unfinished.c_str(), filename.c_str()) != 0) refuse();
}
