/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_infile.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"
#include "utils.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <vector>

using namespace LAMMPS_NS;

static constexpr int COLUMNS = 20;

using Line = std::array<double, COLUMNS>;

namespace {

/// A fault of the file, kept until all ranks can report it together.
struct Fault {
  std::string text;
};

double number(const std::string &word, const std::string &where)
{
  if (!utils::is_double(word)) throw Fault{where + ": '" + word + "' is not a number"};
  const double value = std::strtod(word.c_str(), nullptr);
  if (!std::isfinite(value)) throw Fault{where + ": '" + word + "' is not a finite number"};
  return value;
}

Line parse_line(const std::vector<std::string> &words, const std::string &where)
{
  if (words.size() != COLUMNS)
    throw Fault{where + " has " + std::to_string(words.size()) + " words instead of " +
                std::to_string(COLUMNS) +
                ": ID mass x y z ixx iyy izz ixy ixz iyz vx vy vz lx ly lz ix iy iz"};
  Line line;
  for (int i = 0; i < COLUMNS; ++i) {
    const bool whole = i == 0 || i >= COLUMNS - 3;
    if (whole && !utils::is_integer(words[i]))
      throw Fault{where + ": '" + words[i] + "' is not an integer (body ID and image flags are)"};
    line[i] = number(words[i], where);
  }
  if (line[0] < 1.0 || line[0] > MAXTAGINT)
    throw Fault{where + ": body ID " + words[0] + " is not positive or too large"};
  for (int i = COLUMNS - 3; i < COLUMNS; ++i)
    if (std::fabs(line[i]) >= IMGMAX)
      throw Fault{where + ": image flag " + words[i] + " is too large"};
  if (line[1] <= 0.0)
    throw Fault{where + ": mass " + words[1] + " of body " + words[0] + " is not positive"};
  for (int i = 5; i < 8; ++i)
    if (line[i] < 0.0)
      throw Fault{where + ": body " + words[0] + " has a negative diagonal moment of inertia " +
                  words[i]};
  return line;
}

std::vector<Line> parse_file(const std::string &filename)
{
  std::ifstream file(filename);
  if (!file) throw Fault{"cannot open file " + filename};

  std::vector<Line> lines;
  std::map<double, int> seen;
  std::string text;
  bool counted = false;
  long expected = 0;
  for (int n = 1; std::getline(file, text); ++n) {
    const auto words = utils::split_words(utils::trim_comment(text));
    if (words.empty()) continue;
    const std::string where = "file " + filename + ", line " + std::to_string(n);
    if (!counted) {
      counted = true;
      if (words.size() != 1 || !utils::is_integer(words[0]))
        throw Fault{where + ": the first line must be the number of bodies"};
      expected = (long) number(words[0], where);
      continue;
    }
    lines.push_back(parse_line(words, where));
    const double id = lines.back()[0];
    if (seen.count(id))
      throw Fault{where + ": body " + words[0] + " was given on line " + std::to_string(seen[id]) +
                  " already"};
    seen[id] = n;
  }
  if (!counted)
    throw Fault{"file " + filename +
                " is empty: its first line must be the number "
                "of bodies"};
  if (expected != (long) lines.size())
    throw Fault{"file " + filename + " announces " + std::to_string(expected) + " bodies and has " +
                std::to_string(lines.size())};
  return lines;
}

}    // namespace

GivenBodies LAMMPS_NS::read_given_bodies(LAMMPS *lmp, const std::string &filename)
{
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

  int size[2] = {(int) fault.size(), (int) lines.size()};
  MPI_Bcast(size, 2, MPI_INT, 0, lmp->world);
  fault.resize(size[0]);
  MPI_Bcast(&fault[0], size[0], MPI_CHAR, 0, lmp->world);
  if (!fault.empty()) lmp->error->all(FLERR, "Fix gear/quat infile: {}", fault);

  lines.resize(size[1]);
  MPI_Bcast(lines.data(), COLUMNS * size[1], MPI_DOUBLE, 0, lmp->world);

  GivenBodies bodies;
  for (const auto &line : lines) {
    GivenBody body;
    body.mass = line[1];
    for (int i = 0; i < 3; ++i) {
      body.center[i] = line[2 + i];
      body.velocity[i] = line[11 + i];
      body.angular_momentum_space[i] = line[14 + i];
      body.image[i] = (int) line[17 + i];
    }
    for (int i = 0; i < 6; ++i) body.inertia[i] = line[5 + i];
    bodies[(tagint) line[0]] = body;
  }
  return bodies;
}
