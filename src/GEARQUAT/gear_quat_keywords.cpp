/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_keywords.h"

#include "gear_quat_arguments.h"

#include "error.h"
#include "lammps.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace LAMMPS_NS;
using namespace GearQuat;

// A third pass rarely pays, and a number with too many digits would seem to hang.

static constexpr int PASSES_MOST = 100;

static constexpr char INTEGRATION[] = "integration", STEP[] = "step", BODIES[] = "bodies",
                      PHYSICS[] = "physics", OUTPUT[] = "output";

static constexpr char HELD[] =
    "it acts on all momenta; define a second fix for the bodies that are held";
static constexpr char FOR_CORRECTED[] = "tuned coefficients are those for the corrected one";
static constexpr char ONE_TEMPERATURE[] =
    "both hold the kinetic energy of the bodies; leave out one of the two";
static constexpr char RENUMBERED[] = "the numbers of bodies change when bodies come";

using Value = KeywordValue;

/* ----------------------------------------------------------------------
   the table; what decided the defaults is in doc/decisions.md
------------------------------------------------------------------------- */

// clang-format off

static std::vector<Keyword> make_table()
{
  return {
    Keyword("formulation", INTEGRATION, "which equations of motion are integrated",
            [](Arguments &a, const Value &v) {
              a.scheme.formulation = v.is("first") ? Formulation::FIRST : Formulation::SECOND;
            }).word({"second", "first"}),
    Keyword("values", INTEGRATION, "how many values a history keeps of each function",
            [](Arguments &a, const Value &v) { a.scheme.rows = v.integer; })
        .integer({{SECOND_FEWEST, SECOND_MOST, 9, 8}, {FIRST_FEWEST, FIRST_MOST, 8, 6}}, VARIABLE_MOST)
        .with_tables(),
    Keyword("corrector", INTEGRATION, "which coefficients correct a history",
            [](Arguments &a, const Value &v) { a.scheme.tuned = v.is("tuned"); })
        .word({"tuned", "gear"}).standard_with_tolerance("gear")
        .cannot_go_with({"tolerance", "tuned", "rows of tuned coefficients forget a change of the "
                         "step too slowly; leave out corrector, or write corrector gear"}),
    Keyword("passes", INTEGRATION, "how many corrections a step makes with the same forces",
            [](Arguments &a, const Value &v) { a.scheme.passes = v.integer; })
        .integer({{1, PASSES_MOST, 2}}),
    Keyword("compensate", INTEGRATION, "whether sums carry along what rounding takes from them",
            [](Arguments &a, const Value &v) { a.scheme.compensate = v.is("yes"); })
        .word({"no", "yes"}),
    Keyword("start", INTEGRATION, "which derivatives a history begins with",
            [](Arguments &a, const Value &v) {
              a.start = v.is("zero") ? Arguments::Start::ZERO : Arguments::Start::BOOTSTRAP;
            }).word({"bootstrap", "zero"}),
    Keyword("c0", INTEGRATION, "which right-hand sides the first coefficient belongs to",
            [](Arguments &a, const Value &v) { a.scheme.velocity_c0 = v.is("velocity"); })
        .word({"position", "velocity"}).requires_also({"formulation", "second", ""})
        .requires_also({"corrector", "gear", "tuned coefficients have a c_0 of their own"}),
    Keyword("omega", INTEGRATION, "which angular velocity corrects the quaternion",
            [](Arguments &a, const Value &v) { a.scheme.predicted_omega = v.is("predicted"); })
        .word({"corrected", "predicted"}).requires_also({"formulation", "first", ""})
        .requires_also({"corrector", "gear", FOR_CORRECTED, "predicted"}),
    Keyword("momentum", INTEGRATION, "which momentum corrects the position",
            [](Arguments &a, const Value &v) { a.scheme.predicted_momentum = v.is("predicted"); })
        .word({"corrected", "predicted"}).requires_also({"formulation", "first", ""})
        .requires_also({"corrector", "gear", FOR_CORRECTED, "predicted"}),
    Keyword("project", INTEGRATION, "whether quaternions are kept at unit length",
            [](Arguments &a, const Value &v) { a.scheme.project = v.is("yes"); })
        .word({"yes", "no"}),
    Keyword("tolerance", STEP, "the error that a step may make, which the time step follows",
            [](Arguments &a, const Value &v) {
              a.control.eps = v.number * v.unit;
              a.control.energy = v.measure == "energy";
            }).number({"length", "energy"})
        .cannot_go_with({"isokinetic", "", "heat and multipliers are those of one step and one "
                         "number of values"}),
    Keyword("dtmin", STEP, "the time step does not become shorter",
            [](Arguments &a, const Value &v) { a.control.shortest = v.number; })
        .number().requires_also({"tolerance", "", ""}),
    Keyword("dtmax", STEP, "the time step does not become longer",
            [](Arguments &a, const Value &v) { a.control.longest = v.number; })
        .number().requires_also({"tolerance", "", ""}),
    Keyword("every/time", STEP, "the interval of time at whose multiples steps end",
            [](Arguments &a, const Value &v) { a.every_time = v.number; })
        .number().requires_also({"tolerance", "", ""}),
    Keyword("infile", BODIES, "the file that states bodies",
            [](Arguments &a, const Value &v) { a.infile = v.text; })
        .follows(Keyword::NAME, {"filename"}),
    Keyword("reinit", BODIES, "whether changes in the atoms are taken over between runs",
            [](Arguments &a, const Value &v) { a.reinit = v.is("yes"); })
        .word({"yes", "no"})
        .cannot_go_with({"infile", "yes", "the file states the bodies once and for all"}),
    Keyword("mol", BODIES, "the template of bodies that other fixes insert",
            [](Arguments &a, const Value &v) { a.mol = v.text; })
        .follows(Keyword::NAME, {"template-ID"}).requires_also({"bodystyle", "molecule", ""})
        .cannot_go_with({"isokinetic", "", "bodies that come bring kinetic energy"}),
    Keyword("force", PHYSICS, "which components of the total force act on bodies M",
            [](Arguments &a, const Value &v) { a.masks.push_back(v.mask); })
        .follows(Keyword::MASK, {"M", "xflag", "yflag", "zflag"})
        .cannot_go_with({"mol", "", RENUMBERED}).cannot_go_with({"isokinetic", "", HELD}),
    Keyword("torque", PHYSICS, "which components of the total torque act on bodies M",
            [](Arguments &a, const Value &v) { a.masks.push_back(v.mask); })
        .follows(Keyword::MASK, {"M", "xflag", "yflag", "zflag"})
        .cannot_go_with({"mol", "", RENUMBERED}).cannot_go_with({"isokinetic", "", HELD}),
    Keyword("isokinetic", PHYSICS, "which kinetic energy of all bodies is kept constant",
            [](Arguments &a, const Value &v) {
              a.isokinetic = v.is("total") ? Isokinetic::TOTAL
                  : v.is("separate")       ? Isokinetic::SEPARATE
                                           : Isokinetic::NONE;
            }).word({"none", "total", "separate"})
        .requires_also({"formulation", "first", "its constraint acts on momenta, which formulation "
                        "second does not have"}),
    Keyword("rescale", PHYSICS, "whether momenta are scaled to exactly that energy",
            [](Arguments &a, const Value &v) { a.rescale = v.is("yes"); })
        .word({"yes", "no"}).requires_also({"isokinetic", "", ""}),
    Keyword("temp", PHYSICS, "the temperature of all bodies, at the beginning and at the end of a run",
            [](Arguments &a, const Value &v) {
              a.thermostat.start = v.numbers[0];
              a.thermostat.stop = v.numbers[1];
              a.thermostat.damp = v.numbers[2];
            }).follows(Keyword::NUMBERS, {"Tstart", "Tstop", "Tdamp"})
        .cannot_go_with({"isokinetic", "", ONE_TEMPERATURE}),
    Keyword("tchain", PHYSICS, "how many variables a thermostat has",
            [](Arguments &a, const Value &v) { a.thermostat.length = v.integer; })
        .integer({{1, Chain::LONGEST, 3}}).requires_also({"temp", "", ""}),
    Keyword("thermostat", PHYSICS, "whether translation and rotation have one thermostat each",
            [](Arguments &a, const Value &v) { a.thermostat.separate = v.is("separate"); })
        .word({"total", "separate"}).requires_also({"temp", "", ""}),
    Keyword("report", OUTPUT, "what the log says about the scene",
            [](Arguments &a, const Value &v) {
              a.report = v.is("no") ? Arguments::Report::NO
                  : v.is("long")    ? Arguments::Report::LONG
                                    : Arguments::Report::SHORT;
            }).word({"no", "short", "long"}, "short"),
  };
}

// clang-format on

/* ----------------------------------------------------------------------
   words of the rigid fixes
------------------------------------------------------------------------- */

static constexpr char BAROSTAT[] =
    "there is no barostat, the box does not change; use fix rigid/npt/small for that";

/// doc/howto/from_rigid.md has the same table.
static const std::vector<std::pair<std::vector<std::string>, const char *>> RIGID_WORDS = {
    {{"langevin"},
     "define fix langevin on the same group, and use corrector gear with values 6 at most "
     "(formulation first: 4)"},
    {{"tparam"}, "a thermostat is integrated with the bodies, without iterations; leave it out"},
    {{"iso", "aniso", "tri", "x", "y", "z", "xy", "yz", "xz", "couple", "pparam", "pchain",
      "dilate", "fixedpoint", "scalexy", "scalexz", "scaleyz"},
     BAROSTAT},
    {{"gravity"},
     "keep fix gravity, on a group with the bodies, and leave out its keyword disable"},
    {{"bodyforces"}, "forces are always summed late, in the end of the step"},
};

/// What to write instead of a keyword of fix rigid and its kin; empty for any other word.
static std::string instead_of_rigid_keyword(const std::string &keyword)
{
  for (const auto &[keywords, instead] : RIGID_WORDS)
    if (std::count(keywords.begin(), keywords.end(), keyword)) return instead;
  return "";
}

int GearQuat::modify_like_rigid(LAMMPS *lmp, int narg, char **arg)
{
  const std::string word = arg[0];
  if (word == "temp" || word == "press")
    lmp->error->all(FLERR, "Fix gear/quat has no fix_modify {}: it computes no {}", word,
                    word == "temp" ? "temperature" : "pressure");
  if (word != "bodyforces") return 0;
  if (narg < 2) utils::missing_cmd_args(FLERR, "fix_modify bodyforces", lmp->error);
  const std::string when = arg[1];
  if (when != "late")
    lmp->error->all(FLERR,
                    "Fix gear/quat has no fix_modify bodyforces {}: {}; define fixes whose forces "
                    "bodies should not feel on a group without them",
                    when, instead_of_rigid_keyword(word));
  return 2;
}

/* ----------------------------------------------------------------------
   rows of the table
------------------------------------------------------------------------- */

const std::vector<Keyword> &GearQuat::keyword_table()
{
  static const std::vector<Keyword> table = make_table();
  return table;
}

const Keyword &GearQuat::find_keyword(LAMMPS *lmp, const std::string &name, const Keyword *before)
{
  for (const auto &row : keyword_table())
    if (row.name == name) return row;
  const std::string instead = instead_of_rigid_keyword(name);
  if (!instead.empty())
    lmp->error->all(FLERR, "Fix gear/quat has no keyword {} of the rigid fixes: {}", name, instead);
  std::vector<std::string> names;
  for (const auto &row : keyword_table()) names.emplace_back(row.name);
  const std::string values = before ? fmt::format("; {} takes {}", before->name, before->required())
                                    : "";
  lmp->error->all(FLERR, "Unknown fix gear/quat keyword: {}{}; the keywords are {}", name, values,
                  utils::join_words(names, ", "));
}

/// In brackets, where there are two ranges, the formulation.
template <typename Text> static std::string of_formulations(const Keyword &row, Text text)
{
  if (row.ranges.size() == 1) return text(row.ranges[0]);
  return text(row.range(false)) + " (second), " + text(row.range(true)) + " (first)";
}

std::string GearQuat::tuned_numbers(bool first, const std::string &between)
{
  std::vector<std::string> numbers;
  for (const int n : tuned_values(first ? Formulation::FIRST : Formulation::SECOND))
    numbers.push_back(std::to_string(n));
  return utils::join_words(numbers, between);
}

std::string Keyword::required() const
{
  if (kind == NUMBER)
    return words.empty() ? "a positive number"
                         : "a positive number and perhaps " + utils::join_words(words, " or ") +
            " and perhaps its unit";
  if (kind == INTEGER)
    return of_formulations(*this, [](const Range &range) {
      return fmt::format("{} to {}", range.fewest, range.most);
    });
  if (kind != WORD) return utils::join_words(words, " ");
  std::string text;
  for (size_t n = 0; n < words.size(); ++n)
    text += (n == 0 ? "" : n + 1 == words.size() ? " or " : ", ") + words[n];
  return text;
}

std::string Keyword::possible_values() const
{
  std::string text = required();
  if (most_with_tolerance) text += fmt::format(", at most {} (tolerance)", most_with_tolerance);
  if (of_tables)
    for (const bool first : {false, true})
      text +=
          fmt::format(", {} ({}, tuned)", tuned_numbers(first, " "), first ? "first" : "second");
  return text;
}

/// An integer that is too large for its type becomes the largest of it, which no range contains.
bool GearQuat::read_integer(const std::string &text, int &integer)
{
  if (!utils::is_integer(text)) return false;
  const long long number = std::strtoll(text.c_str(), nullptr, 10);
  integer = (int) std::clamp(number, -(long long) MAXSMALLINT, (long long) MAXSMALLINT);
  return true;
}

/// Whether a word is a positive number, and which.
static bool read_positive(const std::string &text, double &number)
{
  number = utils::is_double(text) ? std::strtod(text.c_str(), nullptr) : 0.0;
  return number > 0.0 && std::isfinite(number);
}

int Keyword::read(LAMMPS *lmp, int narg, char **arg, KeywordValue &value) const
{
  Error *error = lmp->error;
  const bool several = kind == MASK || kind == NUMBERS;
  const int count = several ? (int) words.size() : 1;
  if (narg <= count)
    error->all(FLERR, "Fix gear/quat {}: {} is missing; required: {}", name,
               several ? words[narg - 1] : "the value", required());
  value.text = arg[1];
  if (value.text.empty()) error->all(FLERR, "Fix gear/quat {}: the value is an empty word", name);

  if (kind == WORD && !std::count(words.begin(), words.end(), value.text))
    error->all(FLERR, "Fix gear/quat {}: unknown value {} ({})", name, value.text, required());
  if (kind == INTEGER && !read_integer(value.text, value.integer))
    error->all(FLERR, "Fix gear/quat {}: {} is not an integer; required: {}", name, value.text,
               required());
  if (kind == NUMBER && !read_positive(value.text, value.number))
    error->all(FLERR, "Fix gear/quat {}: {} is not a positive number", name, value.text);
  if (kind == NUMBER && narg > 2 && std::count(words.begin(), words.end(), arg[2])) {
    value.measure = arg[2];
    if (narg == 3 || !utils::is_double(arg[3])) return 2;
    if (!read_positive(arg[3], value.unit))
      error->all(FLERR, "Fix gear/quat {}: the unit of {}, {}, is not a positive number", name,
                 value.measure, arg[3]);
    return 3;
  }
  if (kind == NUMBERS) {
    value.numbers.resize(count);
    for (int k = 0; k < count; ++k)
      if (!read_positive(arg[1 + k], value.numbers[k]))
        error->all(FLERR, "Fix gear/quat {}: {} {} is not a positive number", name, words[k],
                   arg[1 + k]);
  }
  if (kind == MASK) {
    value.mask = {std::string("torque") == name, value.text, {}};
    for (int k = 0; k < 3; ++k) {
      const std::string flag = arg[2 + k];
      if (flag != "on" && flag != "off")
        error->all(FLERR, "Fix gear/quat {}: unknown {} {} (on or off)", name, words[1 + k], flag);
      value.mask.on[k] = flag == "on";
    }
  }
  return count;
}

/* ----------------------------------------------------------------------
   the list
------------------------------------------------------------------------- */

namespace {

std::string default_cell(const Keyword &row)
{
  if (row.kind != Keyword::INTEGER)
    return row.standard +
        (row.with_tolerance.empty() ? "" : ", with tolerance " + row.with_tolerance);
  const auto standard = [&row](bool tolerance, bool gear) {
    return of_formulations(row, [&row, tolerance, gear](const Keyword::Range &range) {
      return std::to_string(row.standard_of(range, tolerance, gear));
    });
  };
  std::string cell = standard(false, false);
  if (row.of_tables) cell += ", with corrector gear " + standard(false, true);
  if (row.most_with_tolerance) cell += ", with tolerance " + standard(true, true);
  return cell;
}

/// A value in brackets belongs to the keyword of the row, any other to the other keyword.
std::string conditions_cell(const std::vector<Keyword::Condition> &conditions, bool excluded)
{
  std::vector<std::string> parts;
  for (const auto &one : conditions) {
    if (one.value.empty())
      parts.push_back(one.keyword);
    else
      parts.push_back(excluded ? fmt::format("{} ({})", one.keyword, one.value)
                               : one.keyword + " " + one.value +
                              (one.only_for.empty() ? "" : fmt::format(" ({})", one.only_for)));
  }
  return utils::join_words(parts, ", ");
}

}    // namespace

std::string GearQuat::list_of_keywords()
{
  static const char *const KINDS[] = {"word", "integer", "number", "name", "mask", "numbers"};
  std::vector<std::vector<std::string>> lines = {
      {"keyword", "about", "kind", "values", "default", "requires", "excludes", "meaning"}};
  for (const auto &row : keyword_table())
    lines.push_back({row.name, row.about, KINDS[row.kind], row.possible_values(), default_cell(row),
                     conditions_cell(row.needs, false), conditions_cell(row.excludes, true),
                     row.meaning});
  std::vector<size_t> width(lines[0].size(), 1);
  for (const auto &line : lines)
    for (size_t n = 0; n + 1 < line.size(); ++n) width[n] = std::max(width[n], line[n].size());
  std::string text;
  for (const auto &line : lines) {
    for (size_t n = 0; n + 1 < line.size(); ++n)
      text += fmt::format("{:<{}}  ", line[n].empty() ? "-" : line[n], width[n]);
    text += line.back() + "\n";
  }
  return text;
}
