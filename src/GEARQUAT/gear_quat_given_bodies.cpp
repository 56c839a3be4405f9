/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_assembly.h"

#include "gear_quat_ranks.h"
#include "gear_quat_shapes.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "lammps.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr int COLUMNS = 20;

namespace {

/// A line of the file.
struct GivenLine {
  tagint id;
  GivenBody body;
};

static constexpr int NUMBERS = GivenBody::NUMBERS;
static_assert(offsetof(GivenBody, image) == NUMBERS * sizeof(double), "as many words in a line");

/// An error in the file, kept until all ranks can report it together.
[[noreturn]] void fail(const std::string &text)
{
  throw std::runtime_error(text);
}

/// LAMMPS' own splitting interprets quotation marks, and reads beyond the line if one is not
/// closed.
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
    fail(where + ": '" + word.c_str() + "' is not a number");
  if (!std::isfinite(value)) fail(where + ": '" + word + "' is not a finite number");
  return value;
}

/// Between -most and most; a larger value is returned as most + 1, so that the caller can report
/// it.
bigint integer(const std::string &word, const std::string &where, const char *what, bigint most)
{
  char *end = nullptr;
  const bigint value = std::strtoll(word.c_str(), &end, 10);    // on overflow the limit
  if (!utils::is_integer(word) || end != word.c_str() + word.size())
    fail(where + ": '" + word.c_str() + "' is not an integer (" + what + ")");
  return value > most || value < -most ? most + 1 : value;
}

GivenLine parse_line(const std::vector<std::string> &words, const std::string &where)
{
  if (words.size() != COLUMNS)
    fail(where + " has " + std::to_string(words.size()) + " words instead of " +
         std::to_string(COLUMNS) +
         ": ID mass x y z ixx iyy izz ixy ixz iyz vx vy vz lx ly lz ix iy iz");
  static constexpr const char *INTEGERS = "body ID and image flags are";
  GivenLine line;
  const bigint id = integer(words[0], where, INTEGERS, MAXTAGINT - 1);
  if (id < 1 || id == MAXTAGINT)
    fail(where + ": body ID " + words[0] + " is not positive or too large");
  line.id = (tagint) id;
  for (int i = 0; i < 3; ++i) {
    const std::string &word = words[1 + NUMBERS + i];
    line.body.image[i] = (int) integer(word, where, INTEGERS, IMGMAX - 1);
    if (line.body.image[i] == IMGMAX) fail(where + ": image flag " + word + " is too large");
  }
  double numbers[NUMBERS];
  for (int i = 0; i < NUMBERS; ++i) numbers[i] = number(words[1 + i], where);
  if (numbers[0] <= 0.0)
    fail(where + ": mass " + words[1] + " of body " + words[0] + " is not positive");
  std::memcpy(&line.body, numbers, sizeof(numbers));
  return line;
}

std::vector<GivenLine> parse_file(const std::string &filename)
{
  std::ifstream file(filename);
  if (!file) fail("cannot open file " + filename);

  std::vector<GivenLine> lines;
  std::map<tagint, int> seen;
  std::string text;
  bigint expected = -1;
  for (int n = 1; std::getline(file, text); ++n) {
    const auto words = words_of(text);
    if (words.empty()) continue;
    const std::string where = "file " + filename + ", line " + std::to_string(n);
    if (expected < 0) {
      if (words.size() != 1 || !utils::is_integer(words[0]))
        fail(where + ": the first line must be the number of bodies");
      expected = integer(words[0], where, "the number of bodies is", MAXSMALLINT);
      continue;
    }
    lines.push_back(parse_line(words, where));
    int &line = seen[lines.back().id];
    if (line > 0)
      fail(where + ": body " + words[0] + " was given on line " + std::to_string(line) +
           " already");
    line = n;
  }
  if (expected != (bigint) lines.size())
    fail("the first line of file " + filename + " is not the number of its bodies, " +
         std::to_string(lines.size()));
  return lines;
}

}    // namespace

GivenBodies GearQuat::read_given_bodies(LAMMPS *lmp, const std::string &filename)
{
  if (filename.empty()) return {};
  std::vector<GivenLine> lines;
  std::string fault;
  if (lmp->comm->me == 0) {
    try {
      lines = parse_file(filename);
    } catch (const std::exception &e) {
      fault = e.what();
    }
  }

  fault = broadcast(fault, lmp->world, 0);
  if (!fault.empty()) lmp->error->all(FLERR, "Fix gear/quat infile: {}", fault);

  GivenBodies bodies;
  for (const auto &line : gather(lines, lmp->world)) bodies[line.id] = line.body;
  return bodies;
}

/* ----------------------------------------------------------------------
   molecules of a template
------------------------------------------------------------------------- */

Molecule **GearQuat::find_template(LAMMPS *lmp, const std::string &template_id)
{
  if (template_id.empty()) return nullptr;
  const int first = lmp->atom->find_molecule(template_id.c_str());
  if (first < 0)
    lmp->error->all(FLERR, "Fix gear/quat mol: molecule template ID {} does not exist",
                    template_id);
  return &lmp->atom->molecules[first];
}

GivenBody GearQuat::given_at(const StatedMolecule &stated, const double *center,
                             const double *velocity, const double *wxyz)
{
  const double q[4] = {wxyz[1], wxyz[2], wxyz[3], wxyz[0]};
  double a[9], arm[3], t[9];
  rotation_matrix(q, dot4(q, q), a);
  to_space(a, stated.center, arm);
  tensor_to_space(a, stated.inertia, t);
  GivenBody given = GivenBody();
  given.mass = stated.mass;
  for (int k = 0; k < 3; ++k) {
    given.center[k] = center[k] + arm[k];
    given.velocity[k] = velocity[k];
  }
  const double tensor[6] = {t[0], t[4], t[8], t[1], t[2], t[5]};
  std::copy_n(tensor, 6, given.inertia);
  return given;
}
