/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_arguments.h"

#include "error.h"
#include "lammps.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   the tables
------------------------------------------------------------------------- */

static constexpr char INTEGRATION[] = "integration", STEP[] = "step", BODIES[] = "bodies",
                      PHYSICS[] = "physics", OUTPUT[] = "output";

using A = Arguments;
using V = KeywordValue;
using K = Keyword;

template <int COMPONENT> static void set_pressure(A &a, const V &v)
{
  a.pressure.set(COMPONENT, v.numbers);
}

// clang-format off

/// The reasons for the defaults are in doc/decisions.md.
const std::vector<Keyword> &GearQuat::keyword_table()
{
  static const std::vector<std::string> FLAGS = {"M", "xflag", "yflag", "zflag"};
  static const std::vector<std::string> TEMPERATURES = {"Tstart", "Tstop", "Tdamp"};
  static const std::vector<std::string> PRESSURES = {"Pstart", "Pstop", "Pdamp"};
  static const auto set_temperature = [](A &a, const V &v) {
    a.thermostat.start = v.numbers[0];
    a.thermostat.stop = v.numbers[1];
    a.thermostat.damp = v.numbers[2];
  };
  static const auto pressure = [](const char *name, void (*store)(A &, const V &), const char *meaning) {
    return K{name, PHYSICS, K::NUMBERS, PRESSURES, store, meaning, {}, {}, 2};
  };
  static const std::vector<Keyword> table = {
    {"formulation", INTEGRATION, K::WORD, {"momentum", "second", "first"},
     [](A &a, const V &v) {
       a.scheme.formulation = v.is("first") ? Formulation::FIRST
           : v.is("second")                 ? Formulation::SECOND
                                            : Formulation::MOMENTUM;
     }, "which equations of motion are integrated"},
    {"values", INTEGRATION, K::INTEGER, {},
     [](A &a, const V &v) { a.scheme.rows = v.integer; },
     "how many values a history keeps of each function",
     {{SECOND_FEWEST, SECOND_MOST, 9, 8}, {FIRST_FEWEST, FIRST_MOST, 8, 6}}},
    {"corrector", INTEGRATION, K::WORD, {"tuned", "gear"},
     [](A &a, const V &v) { a.scheme.method = v.is("tuned") ? Method::TUNED : Method::GEAR; },
     "which coefficients correct a history", {},
     {{"formulation", "second", "gear"}, {"formulation", "first", "gear"}}},
    {"passes", INTEGRATION, K::INTEGER, {},
     [](A &a, const V &v) { a.scheme.passes = v.integer; },
     "how many corrections a step makes with the same forces", {{1, 2, 2}}},
    {"compensate", INTEGRATION, K::WORD, {"no", "yes"},
     [](A &a, const V &v) { a.scheme.compensate = v.is("yes"); },
     "whether sums are compensated for round-off", {}, {{"tolerance", "", "yes"}}},
    {"start", INTEGRATION, K::WORD, {"bootstrap", "zero"},
     [](A &a, const V &v) { a.start = v.is("zero") ? A::Start::ZERO : A::Start::BOOTSTRAP; },
     "which derivatives a history begins with"},
    {"project", INTEGRATION, K::WORD, {"yes", "no"},
     [](A &a, const V &v) { a.scheme.project = v.is("yes"); },
     "whether quaternions are projected to unit length"},
    {"tolerance", STEP, K::NUMBER, {"length", "energy"},
     [](A &a, const V &v) {
       a.control.eps = v.number;
       a.control.energy = v.measure == "energy";
     }, "the largest error of a step, to which the time step is adapted"},
    {"dtmin", STEP, K::NUMBER, {}, [](A &a, const V &v) { a.control.shortest = v.number; },
     "the time step does not become shorter"},
    {"dtmax", STEP, K::NUMBER, {}, [](A &a, const V &v) { a.control.longest = v.number; },
     "the time step does not become longer"},
    {"every/time", STEP, K::NUMBER, {}, [](A &a, const V &v) { a.every_time = v.number; },
     "the interval of time at whose multiples steps end"},
    {"infile", BODIES, K::NAME, {"filename"}, [](A &a, const V &v) { a.infile = v.text; },
     "the file that states bodies"},
    {"reinit", BODIES, K::WORD, {"yes", "no"}, [](A &a, const V &v) { a.reinit = v.is("yes"); },
     "whether bodies adopt changes of their atoms between runs"},
    {"mol", BODIES, K::NAME, {"template-ID"}, [](A &a, const V &v) { a.mol = v.text; },
     "the template of bodies that other fixes insert"},
    {"points", BODIES, K::NAME, {"group-ID"}, [](A &a, const V &v) { a.points = v.text; },
     "the group of atoms that are bodies of one atom each"},
    {"force", PHYSICS, K::MASK, FLAGS, [](A &a, const V &v) { a.masks.push_back(v.mask); },
     "which components of the total force act on bodies M"},
    {"torque", PHYSICS, K::MASK, FLAGS, [](A &a, const V &v) { a.masks.push_back(v.mask); },
     "which components of the total torque act on bodies M"},
    {"isokinetic", PHYSICS, K::WORD, {"none", "total", "separate"},
     [](A &a, const V &v) {
       a.isokinetic = v.is("total") ? Isokinetic::TOTAL
           : v.is("separate")       ? Isokinetic::SEPARATE
                                    : Isokinetic::NONE;
     }, "which kinetic energy of all bodies is kept constant"},
    {"rescale", PHYSICS, K::WORD, {"yes", "no"}, [](A &a, const V &v) { a.rescale = v.is("yes"); },
     "whether momenta are scaled to exactly that energy"},
    {"temp", PHYSICS, K::NUMBERS, TEMPERATURES,
     [](A &a, const V &v) { set_temperature(a, v); },
     "the temperature of all bodies, at the beginning and at the end of a run"},
    {"langevin", PHYSICS, K::NUMBERS, {"Tstart", "Tstop", "Tdamp", "seed"},
     [](A &a, const V &v) { set_temperature(a, v); },
     "the temperature of random forces and of the friction 1/Tdamp on all momenta"},
    {"tchain", PHYSICS, K::INTEGER, {}, [](A &a, const V &v) { a.thermostat.length = v.integer; },
     "how many variables a thermostat has", {{1, Chain::LONGEST, 3}}},
    {"thermostat", PHYSICS, K::WORD, {"total", "separate"},
     [](A &a, const V &v) { a.thermostat.separate = v.is("separate"); },
     "whether translation and rotation have one thermostat each"},
    pressure("iso",
             [](A &a, const V &v) {
               a.pressure.set_all(v.numbers);
               std::fill_n(a.pressure.tied, 3, 0);
             }, "the pressure, which changes all edges of the box by the same factor"),
    pressure("aniso", [](A &a, const V &v) { a.pressure.set_all(v.numbers); },
             "the pressure along each edge of the box, and each edge changes independently"),
    pressure("tri",
             [](A &a, const V &v) {
               a.pressure.set_all(v.numbers);
               for (int k = 3; k < 6; ++k) a.pressure.set(k, {0.0, 0.0, v.numbers[2]});
             }, "the pressure along each edge of a triclinic box, without shear stress"),
    pressure("x", set_pressure<0>, "the pressure along x, which changes that edge of the box"),
    pressure("y", set_pressure<1>, "the pressure along y, which changes that edge of the box"),
    pressure("z", set_pressure<2>, "the pressure along z, which changes that edge of the box"),
    pressure("xy", set_pressure<5>, "the shear component xy of the pressure, which changes that tilt"),
    pressure("xz", set_pressure<4>, "the shear component xz of the pressure, which changes that tilt"),
    pressure("yz", set_pressure<3>, "the shear component yz of the pressure, which changes that tilt"),
    {"couple", PHYSICS, K::WORD, {"none", "xyz", "xy", "yz", "xz"},
     [](A &a, const V &v) {
       int *tied = a.pressure.tied;
       if (v.is("xyz")) tied[0] = tied[1] = tied[2] = 0;
       if (v.is("xy")) tied[1] = 0;
       if (v.is("yz")) tied[2] = 1;
       if (v.is("xz")) tied[2] = 0;
     }, "which edges of the box change by the same factor, due to their mean pressure"},
    {"pchain", PHYSICS, K::INTEGER, {}, [](A &a, const V &v) { a.pressure.length = v.integer; },
     "how many variables the thermostat of the box has", {{0, Chain::LONGEST, 3}}},
    {"ptemp", PHYSICS, K::NUMBER, {}, [](A &a, const V &v) { a.pressure.temperature = v.number; },
     "the temperature that determines the mass of the box, without temp"},
    {"flip", PHYSICS, K::WORD, {"yes", "no"}, [](A &a, const V &v) { a.pressure.flip = v.is("yes"); },
     "whether a box that is tilted by more than half a period is replaced"},
    {"dilate", PHYSICS, K::WORD, {"all"}, [](A &, const V &) {},
     "the atoms that follow the box: all, because all are in bodies"},
    {"fixedpoint", PHYSICS, K::NUMBERS, {"x", "y", "z"},
     [](A &a, const V &v) { a.pressure.fixed = v.numbers; },
     "the point of the box that does not move", {}, {}, 3},
    {"report", OUTPUT, K::WORD, {"yes", "no"}, [](A &a, const V &v) { a.report = v.is("yes"); },
     "whether the log reports on the scene"},
    {"preset", INTEGRATION, K::WORD, {"none", "paper"}, [](A &, const V &) {},
     "whose choices apply to keywords that are not given"},
    {"c0", INTEGRATION, K::WORD, {"position", "velocity"},
     [](A &a, const V &v) { a.scheme.velocity_c0 = v.is("velocity"); },
     "which right-hand sides the first coefficient belongs to"},
    {"omega", INTEGRATION, K::WORD, {"corrected", "predicted"},
     [](A &a, const V &v) { a.scheme.predicted_omega = v.is("predicted"); },
     "which angular velocity corrects the quaternion"},
    {"momentum", INTEGRATION, K::WORD, {"corrected", "predicted"},
     [](A &a, const V &v) { a.scheme.predicted_momentum = v.is("predicted"); },
     "which momentum corrects the position"},
  };
  return table;
}

const std::vector<Rule> &GearQuat::keyword_rules()
{
  using R = Rule;
  static const std::vector<std::string> PRESSURE = {"iso", "aniso", "tri", "x", "y", "z", "xy", "xz", "yz"};
  static const std::vector<Rule> rules = {
    {{"preset"}, "paper", R::EXCLUDE, {"tolerance"}, {}, "the paper has constant steps"},
    {{"preset"}, "paper", R::REQUIRE, {"formulation"}, {"second", "first"}, "the paper has these"},
    {{"formulation", "values", "corrector", "start"}, "", R::EXCLUDE, {"tolerance"}, {},
     "with a tolerance, bodies remember their last loads, as many as reduce the error"},
    {{"corrector"}, "tuned", R::REQUIRE, {"formulation"}, {"momentum"}, "the others have Gear's coefficients"},
    {{"passes", "project"}, "", R::REQUIRE, {"formulation"}, {"second", "first"},
     "formulation momentum neither repeats corrections nor projects quaternions"},
    {{"c0"}, "", R::REQUIRE, {"formulation"}, {"second"}, ""},
    {{"omega", "momentum"}, "", R::REQUIRE, {"formulation"}, {"first"}, ""},
    {{"dtmin", "dtmax", "every/time"}, "", R::REQUIRE, {"tolerance"}, {}, ""},
    {{"reinit"}, "yes", R::EXCLUDE, {"infile"}, {}, "the file states the bodies once and for all"},
    {{"mol"}, "", R::REQUIRE, {"bodystyle"}, {"molecule"}, ""},
    {{"mol"}, "", R::EXCLUDE, {"isokinetic"}, {}, "inserted bodies add kinetic energy"},
    {{"force", "torque"}, "", R::EXCLUDE, {"mol"}, {}, "the numbers of bodies change when bodies are inserted"},
    {{"force", "torque"}, "", R::EXCLUDE, {"isokinetic"}, {},
     "it acts on all momenta; define a second fix for bodies whose motion is restricted"},
    {{"isokinetic"}, "", R::REQUIRE, {"formulation"}, {"first"},
     "its constraint is part of equations of the first order"},
    {{"rescale"}, "", R::REQUIRE, {"isokinetic"}, {}, ""},
    {{"temp"}, "", R::EXCLUDE, {"isokinetic"}, {},
     "both keep the kinetic energy of the bodies; leave out one of the two"},
    {{"temp", "langevin"}, "", R::REQUIRE, {"formulation"}, {"momentum"}, "the friction acts on its angular momenta"},
    {{"langevin"}, "", R::EXCLUDE, {"temp", "isokinetic"}, {}, "each determines the temperature; leave out one of the two"},
    {{"langevin"}, "", R::EXCLUDE, {"values", "corrector", "tolerance"}, {},
     "between random steps bodies move by velocity Verlet"},
    {{"tchain", "thermostat"}, "", R::REQUIRE, {"temp"}, {}, ""},
    {PRESSURE, "", R::EXCLUDE, {"isokinetic"}, {}, "constant kinetic energy needs a constant box"},
    {PRESSURE, "", R::REQUIRE, {"formulation"}, {"momentum"}, "the friction acts on its angular momenta"},
    {PRESSURE, "", R::EXCLUDE, {"mol"}, {}, "with a moving box it is not possible yet"},
    {{"force"}, "", R::EXCLUDE, {"tri", "xy", "xz", "yz"}, {},
     "in a box that shears, motion along one axis accelerates motion along another"},
    {{"iso", "aniso", "tri"}, "", R::EXCLUDE, PRESSURE, {}, "it sets all directions"},
    {{"iso"}, "", R::EXCLUDE, {"couple"}, {}, "it couples all edges"},
    {{"tri", "xy", "xz", "yz"}, "", R::EXCLUDE, {"couple"}, {}, "edges of a box that shears change independently"},
    {{"couple"}, "", R::REQUIRE, {"aniso", "x", "y", "z"}, {}, ""},
    {{"pchain", "ptemp", "flip", "dilate", "fixedpoint"}, "", R::REQUIRE, PRESSURE, {}, ""},
    {{"ptemp"}, "", R::EXCLUDE, {"temp", "langevin"}, {}, "their temperature determines the mass of the box"},
  };
  return rules;
}

// clang-format on

/* ----------------------------------------------------------------------
   rows of the table
------------------------------------------------------------------------- */

bool Rule::is_for(const std::string &name) const
{
  return std::count(names.begin(), names.end(), name) > 0;
}

const Keyword &GearQuat::find_keyword(LAMMPS *lmp, const std::string &name, const Keyword *before)
{
  for (const auto &row : keyword_table())
    if (row.name == name) return row;
  std::vector<std::string> names;
  for (const auto &row : keyword_table()) names.emplace_back(row.name);
  const std::string values = before ? fmt::format("; {} takes {}", before->name, before->required())
                                    : "";
  lmp->error->all(
      FLERR,
      "Unknown fix gear/quat keyword: {}{}; the keywords are {}; for keywords of fix rigid "
      "that are not among them see doc/howto/from_rigid.md",
      name, values, utils::join_words(names, ", "));
}

/// A text in brackets, with the formulation if there are two ranges.
template <typename Text> static std::string of_formulations(const Keyword &row, Text text)
{
  if (row.ranges.size() == 1) return text(row.ranges[0]);
  return text(row.range(false)) + " (momentum, second), " + text(row.range(true)) + " (first)";
}

std::string GearQuat::alternatives(const std::vector<std::string> &words)
{
  std::string text;
  for (size_t n = 0; n < words.size(); ++n)
    text += (n == 0 ? "" : n + 1 == words.size() ? " or " : ", ") + words[n];
  return text;
}

std::string Keyword::required() const
{
  if (kind == NUMBER)
    return words.empty() ? "a positive number"
                         : "a positive number and perhaps " + alternatives(words);
  if (kind == INTEGER)
    return (may_be_auto() ? "auto or " : "") + of_formulations(*this, [](const Range &range) {
             return fmt::format("{} to {}", range.fewest, range.most);
           });
  return kind == WORD ? alternatives(words) : utils::join_words(words, " ");
}

/// An integer that is too large for its type becomes its largest value, which no range contains.
bool GearQuat::read_integer(const std::string &text, int &integer)
{
  if (!utils::is_integer(text)) return false;
  const long long number = std::strtoll(text.c_str(), nullptr, 10);
  integer = (int) std::clamp(number, -(long long) MAXSMALLINT, (long long) MAXSMALLINT);
  return true;
}

/// True if a word is a number; returns its value.
static bool read_number(const std::string &text, double &number)
{
  number = utils::is_double(text) ? std::strtod(text.c_str(), nullptr) : HUGE_VAL;
  return std::isfinite(number);
}

static bool read_positive(const std::string &text, double &number)
{
  return read_number(text, number) && number > 0.0;
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
  if (kind == INTEGER && !(may_be_auto() && value.is("auto")) &&
      !read_integer(value.text, value.integer))
    error->all(FLERR, "Fix gear/quat {}: {} is not an integer; required: {}", name, value.text,
               required());
  if (kind == NUMBER && !read_positive(value.text, value.number))
    error->all(FLERR, "Fix gear/quat {}: {} is not a positive number", name, value.text);
  if (kind == NUMBER && narg > 2 && std::count(words.begin(), words.end(), arg[2])) {
    value.measure = arg[2];
    return 2;
  }
  if (kind == NUMBERS) {
    value.numbers.resize(count);
    for (int k = 0; k < count; ++k)
      if (k < any_sign ? !read_number(arg[1 + k], value.numbers[k])
                       : !read_positive(arg[1 + k], value.numbers[k]))
        error->all(FLERR, "Fix gear/quat {}: {} {} is not a {}number", name, words[k], arg[1 + k],
                   k < any_sign ? "" : "positive ");
  }
  if (kind == MASK) {
    value.mask = {value.text, 0, 0};
    for (int k = 0; k < 3; ++k) {
      const Mask component = std::string("torque") == name ? torque_off(k) : force_off(k);
      const std::string flag = arg[2 + k];
      if (flag != "on" && flag != "off")
        error->all(FLERR, "Fix gear/quat {}: unknown {} {} (on or off)", name, words[1 + k], flag);
      value.mask.stated |= component;
      if (flag == "off") value.mask.off |= component;
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
  if (row.kind != Keyword::INTEGER) {
    std::string cell = row.kind == Keyword::WORD ? row.words.front() : "";
    for (const auto &other : row.standards)
      cell += fmt::format(", with {}{}{} {}", other.keyword, other.value.empty() ? "" : " ",
                          other.value, other.word);
    return cell;
  }
  return row.may_be_auto() ? "auto" : of_formulations(row, [](const Keyword::Range &range) {
    return std::to_string(range.standard);
  });
}

/// A value in brackets belongs to the keyword of the row, any other to the other keyword.
std::string rules_cell(const std::string &name, Rule::Kind kind)
{
  std::vector<std::string> parts;
  for (const auto &rule : keyword_rules()) {
    if (rule.kind != kind || !rule.is_for(name)) continue;
    const std::string own = rule.own.empty() ? "" : fmt::format(" ({})", rule.own);
    if (kind == Rule::REQUIRE)
      parts.push_back(utils::join_words(rule.others, "|") + (rule.values.empty() ? "" : " ") +
                      utils::join_words(rule.values, "|") + own);
    else
      for (const auto &other : rule.others)
        if (other != name) parts.push_back(other + own);
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
    lines.push_back({row.name, row.about, KINDS[row.kind], row.required(), default_cell(row),
                     rules_cell(row.name, Rule::REQUIRE), rules_cell(row.name, Rule::EXCLUDE),
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
