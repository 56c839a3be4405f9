/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_keywords.h"

#include "error.h"
#include "lammps.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   words of the rigid fixes
------------------------------------------------------------------------- */

static constexpr char SCALED_TILT[] = "the tilts xy and xz scale with the edge along x, and yz "
                                      "with the edge along y; leave it out";

/// doc/howto/from_rigid.md has the same table.
static const std::vector<std::pair<std::vector<std::string>, const char *>> RIGID_WORDS = {
    {{"tparam"}, "a thermostat is integrated with the bodies, without iterations; leave it out"},
    {{"pparam"}, "a barostat is integrated with the bodies, without iterations; leave it out"},
    {{"scalexy", "scalexz", "scaleyz"}, SCALED_TILT},
    {{"drag"}, "the equations of motion of the box have no drag; use a longer Pdamp instead"},
    {{"mtk"}, "its terms always belong to the equations of motion; leave it out"},
    {{"nreset"}, "pressures refer to the present box, not to a reference cell; leave it out"},
    {{"tloop", "ploop"}, "chains choose their own sub-steps; leave it out"},
    {{"update"}, "rotations are always integrated; leave it out"},
    {{"gravity"},
     "keep fix gravity, on a group with the bodies, and leave out its keyword disable"},
    {{"bodyforces"}, "forces are always summed late, in the end of the step"},
};

/// The alternative to a keyword of fix rigid and its variants; empty for any other word.
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
    lmp->error->all(FLERR,
                    "Fix gear/quat has no fix_modify {}: it uses the {} of the bodies, which its "
                    "vector shows",
                    word, word == "temp" ? "temperatures" : "molecular pressure");
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

bool Rule::is_for(const std::string &name) const
{
  return std::count(names.begin(), names.end(), name) > 0;
}

const Keyword &GearQuat::find_keyword(LAMMPS *lmp, const KeywordTable &table,
                                      const std::string &name, const Keyword *before)
{
  for (const auto &row : table)
    if (row.name == name) return row;
  const std::string instead = instead_of_rigid_keyword(name);
  if (!instead.empty())
    lmp->error->all(FLERR, "Fix gear/quat has no keyword {} of the rigid fixes: {}", name, instead);
  std::vector<std::string> names;
  for (const auto &row : table) names.emplace_back(row.name);
  const std::string values = before ? fmt::format("; {} takes {}", before->name, before->required())
                                    : "";
  lmp->error->all(FLERR, "Unknown fix gear/quat keyword: {}{}; the keywords are {}", name, values,
                  utils::join_words(names, ", "));
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
    return words.empty()
        ? "a positive number"
        : "a positive number and perhaps " + alternatives(words) + " and perhaps its unit";
  if (kind == INTEGER)
    return (may_be_auto ? "auto or " : "") + of_formulations(*this, [](const Range &range) {
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
  if (kind == INTEGER && !(may_be_auto && value.is("auto")) &&
      !read_integer(value.text, value.integer))
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
      if (k < any_sign ? !read_number(arg[1 + k], value.numbers[k])
                       : !read_positive(arg[1 + k], value.numbers[k]))
        error->all(FLERR, "Fix gear/quat {}: {} {} is not a {}number", name, words[k], arg[1 + k],
                   k < any_sign ? "" : "positive ");
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
  if (row.kind != Keyword::INTEGER) {
    std::string cell = row.kind == Keyword::WORD ? row.words.front() : "";
    for (const auto &other : row.standards)
      cell += fmt::format(", with {}{}{} {}", other.keyword, other.value.empty() ? "" : " ",
                          other.value, other.word);
    return cell;
  }
  return row.may_be_auto ? "auto" : of_formulations(row, [&row](const Keyword::Range &range) {
    return std::to_string(row.standard_of(range, false));
  });
}

/// A value in brackets belongs to the keyword of the row, any other to the other keyword.
std::string rules_cell(const KeywordRules &rules, const std::string &name, Rule::Kind kind)
{
  std::vector<std::string> parts;
  for (const auto &rule : rules) {
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

std::string GearQuat::list_of_keywords(const KeywordTable &table, const KeywordRules &rules)
{
  static const char *const KINDS[] = {"word", "integer", "number", "name", "mask", "numbers"};
  std::vector<std::vector<std::string>> lines = {
      {"keyword", "about", "kind", "values", "default", "requires", "excludes", "meaning"}};
  for (const auto &row : table)
    lines.push_back({row.name, row.about, KINDS[row.kind], row.required(), default_cell(row),
                     rules_cell(rules, row.name, Rule::REQUIRE),
                     rules_cell(rules, row.name, Rule::EXCLUDE), row.meaning});
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
