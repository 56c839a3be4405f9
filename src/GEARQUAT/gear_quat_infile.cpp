/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_infile.h"

#include "gear_quat_bodies.h"
#include "gear_quat_outputs.h"
#include "gear_quat_ranks.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr int COLUMNS = 20;

namespace {

/// A line of the file.
struct Line {
  tagint id;
  GivenBody body;
};

/// The numbers between ID and image flags, as the file and a GivenBody have them.
enum { MASS, INERTIA = 4, NUMBERS = 16 };
static_assert(offsetof(GivenBody, image) == NUMBERS * sizeof(double), "as many words in a line");

/// A fault of the file, kept until all ranks can report it together.
struct Fault {
  std::string text;
};

/// LAMMPS' own splitting takes quotation marks for something, and reads on where one is not closed.
std::vector<std::string> words_of(const std::string &line)
{
  std::istringstream stream(utils::trim_comment(line));
  return {std::istream_iterator<std::string>(stream), std::istream_iterator<std::string>()};
}

double number(const std::string &word, const std::string &where)
{
  char *end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (!utils::is_double(word) || end != word.c_str() + word.size())
    throw Fault{where + ": '" + word.c_str() + "' is not a number"};
  if (!std::isfinite(value)) throw Fault{where + ": '" + word + "' is not a finite number"};
  return value;
}

/// Between -most and most; more is given as most + 1, so that the caller can say what is too large.
bigint integer(const std::string &word, const std::string &where, const char *what, bigint most)
{
  char *end = nullptr;
  const bigint value = std::strtoll(word.c_str(), &end, 10);    // the largest there is, if beyond
  if (!utils::is_integer(word) || end != word.c_str() + word.size())
    throw Fault{where + ": '" + word.c_str() + "' is not an integer (" + what + ")"};
  return value > most || value < -most ? most + 1 : value;
}

Line parse_line(const std::vector<std::string> &words, const std::string &where)
{
  if (words.size() != COLUMNS)
    throw Fault{where + " has " + std::to_string(words.size()) + " words instead of " +
                std::to_string(COLUMNS) +
                ": ID mass x y z ixx iyy izz ixy ixz iyz vx vy vz lx ly lz ix iy iz"};
  static constexpr const char *INTEGERS = "body ID and image flags are";
  Line line;
  const bigint id = integer(words[0], where, INTEGERS, MAXTAGINT - 1);
  if (id < 1 || id == MAXTAGINT)
    throw Fault{where + ": body ID " + words[0] + " is not positive or too large"};
  line.id = (tagint) id;
  for (int i = 0; i < 3; ++i) {
    const std::string &word = words[1 + NUMBERS + i];
    line.body.image[i] = (int) integer(word, where, INTEGERS, IMGMAX - 1);
    if (line.body.image[i] == IMGMAX) throw Fault{where + ": image flag " + word + " is too large"};
  }
  double numbers[NUMBERS];
  for (int i = 0; i < NUMBERS; ++i) numbers[i] = number(words[1 + i], where);
  if (numbers[MASS] <= 0.0)
    throw Fault{where + ": mass " + words[1] + " of body " + words[0] + " is not positive"};
  for (int i = INERTIA; i < INERTIA + 3; ++i)
    if (numbers[i] < 0.0)
      throw Fault{where + ": body " + words[0] + " has a negative diagonal moment of inertia " +
                  words[1 + i]};
  std::memcpy(&line.body, numbers, sizeof(numbers));
  return line;
}

std::vector<Line> parse_file(const std::string &filename)
{
  std::ifstream file(filename);
  if (!file) throw Fault{"cannot open file " + filename};

  std::vector<Line> lines;
  std::map<tagint, int> seen;
  std::string text;
  std::string announced;
  bigint expected = 0;
  for (int n = 1; std::getline(file, text); ++n) {
    const auto words = words_of(text);
    if (words.empty()) continue;
    const std::string where = "file " + filename + ", line " + std::to_string(n);
    if (announced.empty()) {
      announced = words[0];
      if (words.size() != 1 || !utils::is_integer(words[0]))
        throw Fault{where + ": the first line must be the number of bodies"};
      expected = integer(words[0], where, "the number of bodies is", MAXSMALLINT);
      continue;
    }
    lines.push_back(parse_line(words, where));
    const tagint id = lines.back().id;
    if (seen.count(id))
      throw Fault{where + ": body " + words[0] + " was given on line " + std::to_string(seen[id]) +
                  " already"};
    seen[id] = n;
  }
  if (announced.empty())
    throw Fault{"file " + filename +
                " is empty: its first line must be the number "
                "of bodies"};
  if (expected != (bigint) lines.size())
    throw Fault{"file " + filename + " announces " + announced + " bodies and has " +
                std::to_string(lines.size())};
  return lines;
}

}    // namespace

GivenBodies GearQuat::read_given_bodies(LAMMPS *lmp, const std::string &filename)
{
  if (filename.empty()) return {};
  std::vector<Line> lines;
  std::string fault;
  if (lmp->comm->me == 0) {
    try {
      lines = parse_file(filename);
    } catch (const Fault &f) {
      fault = f.text;
    } catch (const std::exception &e) {
      fault = "file " + filename + ": " + e.what();
    }
  }

  fault = broadcast(fault, lmp->world, 0);
  if (!fault.empty()) lmp->error->all(FLERR, "Fix gear/quat infile: {}", fault);

  GivenBodies bodies;
  for (const auto &line : gather(lines, lmp->world)) bodies[line.id] = line.body;
  return bodies;
}

/* ----------------------------------------------------------------------
   writing
------------------------------------------------------------------------- */

namespace {

Line line_of(const Body &body, const BodyState &state, const double *row)
{
  Line line = {body.id, GivenBody()};
  GivenBody &written = line.body;
  written.mass = body.rigid.mass;
  std::copy_n(row + BodyTable::CENTER, 3, written.center);
  std::copy_n(row + BodyTable::VELOCITY, 3, written.velocity);
  std::copy_n(row + BodyTable::ANGULAR_MOMENTUM, 3, written.angular_momentum_space);
  std::copy_n(row + BodyTable::IMAGE, 3, written.image);

  // A^T I A, the rows of A being the principal axes; xx yy zz xy xz yz

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
  double numbers[NUMBERS];
  std::memcpy(numbers, &line.body, sizeof(numbers));
  fprintf(file, TAGINT_FORMAT, line.id);
  for (const double number : numbers) fprintf(file, " %.16e", number);
  fprintf(file, " %d %d %d\n", line.body.image[0], line.body.image[1], line.body.image[2]);
}

}    // namespace

void GearQuat::write_given_bodies(LAMMPS *lmp, const std::string &filename,
                                  const std::string &fix_id, const Bodies &bodies, double **rows)
{
  std::vector<Line> mine;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    mine.push_back(line_of(bodies.body_at(ibody), bodies.state_of(ibody), rows[ibody]));
  const auto before = [](const Line &a, const Line &b) {
    return a.id < b.id;
  };
  const std::vector<Line> all = gather_sorted(mine, lmp->world, before, 0);
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
