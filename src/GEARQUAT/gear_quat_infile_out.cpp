/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_infile_out.h"

#include "gear_quat_bodies.h"
#include "gear_quat_table.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

namespace {

/// A line of the file; the ID apart, for it is an integer of any size.
struct Line {
  tagint id;
  int image[3];
  double mass, center[3], inertia_space[6], velocity[3], angular_momentum_space[3];
};

Line line_of(const Body &body, const BodyState &state, const double *row)
{
  Line line = Line();
  line.id = body.id;
  line.mass = body.rigid.mass;
  std::copy_n(row + BodyTable::CENTER, 3, line.center);
  std::copy_n(row + BodyTable::VELOCITY, 3, line.velocity);
  std::copy_n(row + BodyTable::ANGULAR_MOMENTUM, 3, line.angular_momentum_space);
  for (int k = 0; k < 3; ++k) line.image[k] = (int) row[BodyTable::IMAGE + k];

  // A^T I A, the rows of A being the principal axes; xx yy zz xy xz yz

  static constexpr int FIRST[6] = {0, 1, 2, 0, 0, 1}, SECOND[6] = {0, 1, 2, 1, 2, 2};
  double a[9];
  rotation_matrix(state.q, dot4(state.q, state.q), a);
  for (int m = 0; m < 6; ++m)
    for (int k = 0; k < 3; ++k)
      line.inertia_space[m] += body.rigid.inertia[k] * a[3 * k + FIRST[m]] * a[3 * k + SECOND[m]];
  return line;
}

/// All lines on rank 0, sorted; empty elsewhere.
std::vector<Line> gather(LAMMPS *lmp, std::vector<Line> &mine)
{
  MPI_Datatype type;
  MPI_Type_contiguous(sizeof(Line), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  int here = (int) mine.size();    // not const: nor are the arguments of LAMMPS' own MPI
  std::vector<int> counts(lmp->comm->nprocs), starts(lmp->comm->nprocs, 0);
  MPI_Gather(&here, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, lmp->world);
  std::partial_sum(counts.begin(), counts.end() - 1, starts.begin() + 1);
  std::vector<Line> all(lmp->comm->me == 0 ? starts.back() + counts.back() : 0);
  MPI_Gatherv(mine.data(), here, type, all.data(), counts.data(), starts.data(), type, 0,
              lmp->world);
  MPI_Type_free(&type);
  std::sort(all.begin(), all.end(), [](const Line &a, const Line &b) {
    return a.id < b.id;
  });
  return all;
}

void print(FILE *file, const Line &line)
{
  fprintf(file, TAGINT_FORMAT " %.16e", line.id, line.mass);
  for (const double value : line.center) fprintf(file, " %.16e", value);
  for (const double value : line.inertia_space) fprintf(file, " %.16e", value);
  for (const double value : line.velocity) fprintf(file, " %.16e", value);
  for (const double value : line.angular_momentum_space) fprintf(file, " %.16e", value);
  fprintf(file, " %d %d %d\n", line.image[0], line.image[1], line.image[2]);
}

}    // namespace

void GearQuat::write_given_bodies(LAMMPS *lmp, const std::string &filename,
                                  const std::string &fix_id, const Bodies &bodies, double **rows)
{
  std::vector<Line> mine;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    mine.push_back(line_of(bodies.body[ibody], bodies.state[ibody], rows[ibody]));
  const std::vector<Line> all = gather(lmp, mine);
  if (lmp->comm->me != 0) return;

  const auto refuse = [&] {
    lmp->error->one(FLERR, "Fix gear/quat: cannot write file {}: {}", filename,
                    utils::getsyserror());
  };
  const std::string unfinished = filename + ".tmp";
  FILE *file = fopen(unfinished.c_str(), "w");
  if (!file) refuse();
  fprintf(file,
          "# fix %s gear/quat: mass, center of mass, inertia tensor and momenta of %zu bodies on "
          "timestep " BIGINT_FORMAT "\n\n%zu\n",
          fix_id.c_str(), all.size(), lmp->update->ntimestep, all.size());
  for (const Line &line : all) print(file, line);
  const bool failed = ferror(file) != 0;
  if (fclose(file) != 0 || failed || rename(unfinished.c_str(), filename.c_str()) != 0) refuse();
}
