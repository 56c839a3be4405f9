/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_arguments.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "input.h"
#include "utils.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr int FIRST_WORD = 3;    // fix ID group gear/quat ...

Arguments::Arguments(LAMMPS *lmp, int narg, char **arg) : Pointers(lmp)
{
  const int used = parse_bodystyle(narg, arg);
  parse_keywords(narg - used, arg + used);
}

/// Returns the number of words used so far.
int Arguments::parse_bodystyle(int narg, char **arg)
{
  if (narg <= FIRST_WORD)
    error->all(FLERR,
               "Fix gear/quat: the body style is missing; required: single, molecule, group N "
               "ID1 ID2 ..., custom i_name or custom v_name");
  const std::string style = arg[FIRST_WORD];
  const int next = FIRST_WORD + 1;
  if (style == "keywords") {
    if (comm->me == 0) utils::logmesg(lmp, list_of_keywords());
    error->all(FLERR, "Fix gear/quat keywords only lists the keywords, and no fix was made");
  }
  given["bodystyle"].text = style;
  static const std::map<std::string, BodyStyle> STYLES = {{"single", BodyStyle::SINGLE},
                                                          {"molecule", BodyStyle::MOLECULE},
                                                          {"group", BodyStyle::GROUP},
                                                          {"custom", BodyStyle::CUSTOM}};
  const auto found = STYLES.find(style);
  if (found == STYLES.end())
    error->all(FLERR, "Unknown fix gear/quat bodystyle: {} (single, molecule, group or custom)",
               style);
  bodystyle = found->second;
  if (bodystyle == BodyStyle::SINGLE || bodystyle == BodyStyle::MOLECULE) return next;
  if (narg <= next)
    error->all(FLERR, "Fix gear/quat {}: {}", style,
               bodystyle == BodyStyle::CUSTOM ? "i_name or v_name is missing"
                                              : "N is missing; required: N ID1 ID2 ...");
  if (bodystyle == BodyStyle::CUSTOM) {
    custom = arg[next];
    return next + 1;
  }
  int n;
  if (!read_integer(arg[next], n) || n <= 0)
    error->all(FLERR, "Fix gear/quat group: number of groups is {} and must be a positive integer",
               arg[next]);
  if (narg - next - 1 < n)
    error->all(FLERR, "Fix gear/quat group: {} group IDs expected, {} given", arg[next],
               narg - next - 1);
  for (int i = 0; i < n; ++i) {
    groups.emplace_back(arg[next + 1 + i]);
    find_group("group", groups.back());
  }
  return next + 1 + n;
}

/* ----------------------------------------------------------------------
   keywords
------------------------------------------------------------------------- */

void Arguments::parse_keywords(int narg, char **arg)
{
  const Keyword *before = nullptr;
  for (int iarg = 0; iarg < narg; ++iarg) {
    const Keyword &row = find_keyword(lmp, arg[iarg], before);
    if (row.kind != Keyword::MASK && given.count(row.name))
      error->all(FLERR, "Fix gear/quat keyword {} is given twice", row.name);
    KeywordValue value;
    iarg += row.read(lmp, narg - iarg, arg + iarg, value);
    row.store(*this, value);
    given[row.name] = value;
    before = &row;
  }
  if (is_on("preset", "paper")) take_preset();
  for (const auto &row : keyword_table())
    if (row.kind == Keyword::WORD && !given.count(row.name)) row.store(*this, {standard_word(row)});
  check_rules();
  check_ranges();
  if (is_on("tolerance", "")) check_control();
  if (is_on("langevin", "")) check_random();
  check_pressure();
  thermostat.takes_in = !mol.empty();
  if (!infile.empty()) reinit = false;    // values in a file are not recomputed from the atoms
}

/// Adds the keywords of the test cases of the paper, except keywords that are given.
void Arguments::take_preset()
{
  using Words = std::vector<std::pair<std::string, std::string>>;
  Words words = {{"formulation", "second"}, {"passes", "1"}, {"start", "zero"}, {"project", "no"}};
  if (is_on("formulation", "first"))
    words.insert(words.end(), {{"values", "5"}, {"momentum", "predicted"}});
  else
    words.insert(words.end(), {{"values", "6"}, {"c0", "velocity"}});
  for (auto &[name, word] : words) {
    if (given.count(name)) continue;
    char *pair[] = {name.data(), word.data()};
    KeywordValue value;
    find_keyword(lmp, name).read(lmp, 2, pair, value);
    find_keyword(lmp, name).store(*this, value);
    given[name] = value;
  }
}

/// True if a keyword has this value, given or by default; with an empty value, true if the keyword
/// has any value other than the word none.
bool Arguments::is_on(const std::string &keyword, const std::string &value) const
{
  const auto place = given.find(keyword);
  if (keyword == "bodystyle") return place->second.text == value;
  const Keyword &row = find_keyword(lmp, keyword);
  const std::string &present = place == given.end() ? standard_word(row) : place->second.text;
  if (!value.empty()) return present == value;
  return !present.empty() && !(row.kind == Keyword::WORD && present == "none");
}

/// The default of a WORD in this command; any other keyword that is not given has no value.
const std::string &Arguments::standard_word(const Keyword &row) const
{
  static const std::string NOTHING;
  for (const auto &other : row.standards)
    if (is_on(other.keyword, other.value)) return other.word;
  return row.kind == Keyword::WORD ? row.words.front() : NOTHING;
}

void Arguments::check_rules() const
{
  for (const auto &rule : keyword_rules())
    for (const auto &name : rule.names) {
      if (!given.count(name) || !is_on(name, rule.own)) continue;
      const std::string user = rule.own.empty() ? name : name + " " + rule.own;
      const std::string because = rule.reason.empty() ? "" : ": " + rule.reason;
      const auto holds = [&](const std::string &other) {
        if (rule.values.empty()) return is_on(other, "");
        return std::any_of(rule.values.begin(), rule.values.end(), [&](const std::string &value) {
          return is_on(other, value);
        });
      };
      const auto &others = rule.others;
      if (rule.kind == Rule::REQUIRE && !std::any_of(others.begin(), others.end(), holds))
        error->all(FLERR, "Fix gear/quat keyword {} requires {}{}", user,
                   rule.values.empty() ? "keyword " + alternatives(others)
                                       : others.front() + " " + alternatives(rule.values),
                   because);
      for (const auto &other : others)
        if (rule.kind == Rule::EXCLUDE && other != name && given.count(other) && holds(other))
          error->all(FLERR, "Fix gear/quat keyword {} cannot be used with {}{}", user, other,
                     because);
    }
}

/// Stores integers, including defaults, and ends the run if one is outside of its range.
void Arguments::check_ranges()
{
  for (const auto &row : keyword_table()) {
    if (row.kind != Keyword::INTEGER) continue;
    const Keyword::Range &range = row.range(scheme.first());
    KeywordValue value;
    const bool other = !scheme.tuned() && range.standard_gear;
    value.integer = other ? range.standard_gear : range.standard;
    const bool is_stated = given.count(row.name) && !given.at(row.name).is("auto");
    if (is_stated) value = given.at(row.name);
    row.store(*this, value);
    if (row.may_be_auto()) automatic_values = !is_stated && !is_on("tolerance", "");
    if (row.may_be_auto() && !is_stated) continue;
    if (value.integer < range.fewest || value.integer > range.most)
      error->all(FLERR, "Fix gear/quat {}: {} is not from {} to {}{}", row.name, value.text,
                 range.fewest, range.most,
                 row.ranges.size() == 1 ? std::string()
                                        : std::string(", as formulation ") +
                         word_of(scheme.formulation) + " requires");
  }
}

void Arguments::check_control()
{
  scheme = RememberedLoads::scheme(scheme.compensate, MOST_LOADS);
  if (control.longest > 0.0 && control.shortest > control.longest)
    error->all(FLERR, "Fix gear/quat dtmin: {} is larger than dtmax, {}", control.shortest,
               control.longest);
  const auto refuse_ramp = [this](char quantity, double start, double stop) {
    if (start != stop)
      error->all(FLERR,
                 "Fix gear/quat: {0}start {1} and {0}stop {2} differ, which cannot be used with "
                 "tolerance: the target depends on the number of the step, but steps differ in "
                 "length; use several runs, each with a constant target",
                 quantity, start, stop);
  };
  refuse_ramp('T', thermostat.start, thermostat.stop);
  for (int k = 0; k < PressureWords::COMPONENTS; ++k)
    if (pressure.on[k]) refuse_ramp('P', pressure.start[k], pressure.stop[k]);
}

void Arguments::check_random()
{
  const double seed = given.at("langevin").numbers[3];
  if (seed != std::floor(seed) || seed > std::numeric_limits<int>::max())
    error->all(FLERR, "Fix gear/quat langevin: seed {:g} is not a positive integer", seed);
  thermostat.seed = (int) seed;
  scheme.rows = VERLET;
  automatic_values = false;
}

/// Directions without a period have no pressure, tilts can only be free together, and coupled
/// directions must have the same numbers.
void Arguments::check_pressure()
{
  PressureWords &p = pressure;
  if (!p.any()) return;
  const bool flat = domain->dimension == 2;
  for (const char *keyword : {"z", "xz", "yz"})
    if (flat && given.count(keyword))
      error->all(FLERR,
                 "Fix gear/quat: in two dimensions there is no pressure component z, xz or yz");
  if (flat) p.on[2] = p.on[3] = p.on[4] = false;
  if (flat && p.tied[1] == 1 && p.tied[2] != 2)    // xyz is equivalent to xy
    error->all(FLERR,
               "Fix gear/quat couple: in two dimensions there is no edge along z; use couple xy");
  for (int k = 0; k < 3; ++k)
    if (p.on[k] && !domain->periodicity[k])
      error->all(
          FLERR,
          "Fix gear/quat: the box is not periodic along {0}, so there is no constant pressure "
          "along {0}; use boundary p for {0}, or keywords for the other directions",
          "xyz"[k]);
  if (p.shears() && !domain->triclinic)
    error->all(FLERR,
               "Fix gear/quat: keywords tri, xy, xz and yz require a triclinic box; write "
               "change_box all triclinic before this fix");
  for (int k = 0; k < PressureWords::COMPONENTS; ++k)
    if (p.shears() && !p.on[k] && !(flat && k >= 2 && k <= 4))
      error->all(FLERR,
                 "Fix gear/quat: tilts of the box are free only if all components of the pressure "
                 "are given, which are {}; use keyword tri, or add those that are missing",
                 flat ? "x, y and xy" : "x, y, z, xy, xz and yz");
  for (int k = 1; k < 3; ++k) {
    const int first = p.tied[k];
    if (first == k || (flat && k == 2)) continue;
    if (!p.on[k] || !p.on[first] || p.start[k] != p.start[first] || p.stop[k] != p.stop[first] ||
        p.period[k] != p.period[first])
      error->all(FLERR,
                 "Fix gear/quat couple: directions {} and {} need keywords with the same Pstart, "
                 "Pstop and Pdamp",
                 "xyz"[first], "xyz"[k]);
  }
  if (thermostat.damp == 0.0 && !given.count("pchain")) p.length = 0;
}

/* ----------------------------------------------------------------------
   atoms to bodies
------------------------------------------------------------------------- */

/// Index of a group that exists and is static.
int Arguments::find_group(const char *keyword, const std::string &name) const
{
  const int found = group->find(name);
  if (found < 0) error->all(FLERR, "Fix gear/quat {}: group ID {} does not exist", keyword, name);
  if (group->dynamic[found])
    error->all(FLERR,
               "Fix gear/quat {}: group {} is dynamic, but bodies keep their atoms; use a static "
               "group",
               keyword, name);
  return found;
}

std::vector<tagint> Arguments::body_ids(int groupbit) const
{
  if (points.empty()) return ids_by_style({groupbit, 0});
  const int bit = group->bitmask[find_group("points", points)];
  auto ids = ids_by_style({groupbit, bit});
  tagint worst[3] = {0, 0, 0};    // an ID, an atom outside of the group, and the largest point
  for (int i = 0; i < atom->nlocal; ++i) {
    worst[0] = std::max(worst[0], ids[i]);
    if (!(atom->mask[i] & bit)) continue;
    worst[2] = std::max(worst[2], atom->tag[i]);
    if (!(atom->mask[i] & groupbit)) worst[1] = atom->tag[i];
    ids[i] = POINTS + atom->tag[i];
  }
  const auto all = over_ranks(MPI_MAX, worst, world);
  if (all[0] > POINTS)
    error->all(FLERR,
               "Fix gear/quat points: body {} has the ID of a point; IDs of bodies are up to {}",
               all[0], POINTS);
  if (all[2] > MAXTAGINT - POINTS)
    error->all(FLERR,
               "Fix gear/quat points: atom {} has too large an ID for a point; use reset_atoms id",
               all[2]);
  if (all[1])
    error->all(
        FLERR,
        "Fix gear/quat points: atom {} of group {} is not in the group of the fix; define the "
        "fix for a group that contains both bodies and points",
        all[1], points);
  return ids;
}

std::vector<tagint> Arguments::ids_by_style(const Selection &selection) const
{
  switch (bodystyle) {
    case BodyStyle::MOLECULE:
      return molecule_ids(selection);
    case BodyStyle::GROUP:
      return group_ids(selection);
    case BodyStyle::CUSTOM:
      return custom_ids(selection);
    default:
      break;
  }
  std::vector<tagint> ids(atom->nlocal);
  for (size_t i = 0; i < ids.size(); ++i) ids[i] = selection.has(atom->mask[i]) ? 1 : 0;
  return ids;
}

std::vector<tagint> Arguments::molecule_ids(const Selection &selection) const
{
  if (!atom->molecule_flag)
    error->all(FLERR, "Fix gear/quat molecule requires an atom style with molecule IDs");
  std::vector<tagint> ids(atom->nlocal, 0);
  tagint without = 0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!selection.has(atom->mask[i])) continue;
    ids[i] = atom->molecule[i];
    if (ids[i] <= 0) without = atom->tag[i];
  }
  if ((without = over_ranks(MPI_MAX, without, world)))
    error->all(FLERR,
               "Fix gear/quat molecule: atom {} of the fix group has molecule ID 0; "
               "take it out of the group, give it the ID of its body, or name it by keyword points",
               without);
  return ids;
}

std::vector<tagint> Arguments::group_ids(const Selection &selection) const
{
  std::vector<tagint> ids(atom->nlocal, 0);
  tagint twice = 0;
  std::vector<int> used(groups.size(), 0), used_anywhere(groups.size(), 0);
  for (size_t g = 0; g < groups.size(); ++g) {
    const int bit = group->bitmask[group->find(groups[g])];
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!(atom->mask[i] & bit) || !selection.has(atom->mask[i])) continue;
      if (ids[i] != 0) twice = atom->tag[i];
      ids[i] = (tagint) g + 1;
      used[g] = 1;
    }
  }
  if ((twice = over_ranks(MPI_MAX, twice, world)))
    error->all(FLERR,
               "Fix gear/quat group: atom {} is in more than one of the groups; an "
               "atom belongs to one body at most",
               twice);
  reduce(MPI_MAX, used.data(), used_anywhere.data(), used.size(), world);
  for (size_t g = 0; g < groups.size(); ++g)
    if (!used_anywhere[g])
      error->all(FLERR,
                 "Fix gear/quat group: no atom of the fix group is in group {}, which makes no "
                 "body; leave it out",
                 groups[g]);
  return ids;
}

/// Bodies are numbered from the smallest value in the group, as in fix rigid.
std::vector<tagint> Arguments::custom_ids(const Selection &selection) const
{
  constexpr double MOST = std::min(0.5 * MAXTAGINT, 1.0e15);    // doubles represent differences
  std::vector<double> value(atom->nlocal + 1);
  if (utils::strmatch(custom, "^i_")) {
    int is_double, columns;
    const int index = atom->find_custom(custom.c_str() + 2, is_double, columns);
    if (index < 0 || is_double || columns)
      error->all(FLERR,
                 "Fix gear/quat custom {} requires an integer vector of that name, made by "
                 "fix property/atom",
                 custom);
    std::copy_n(atom->ivector[index], atom->nlocal, value.begin());
  } else if (utils::strmatch(custom, "^v_")) {
    Variable *variable = input->variable;
    const int index = variable->find(custom.c_str() + 2);
    if (index < 0 || !variable->atomstyle(index))
      error->all(FLERR,
                 "Fix gear/quat custom {} requires an atom-style or atomfile-style variable "
                 "of that name",
                 custom);
    variable->compute_atom(index, 0, value.data(), 1, 0);
  } else
    error->all(FLERR, "Fix gear/quat custom: {} is neither i_name nor v_name", custom);

  tagint unusable = 0;
  double smallest = MOST;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!selection.has(atom->mask[i])) continue;
    value[i] = std::round(value[i]);
    smallest = std::min(smallest, value[i]);
    if (!(std::fabs(value[i]) < MOST)) unusable = atom->tag[i];
  }
  if ((unusable = over_ranks(MPI_MAX, unusable, world)))
    error->all(
        FLERR,
        "Fix gear/quat custom {}: the value of atom {} is not a number between -{:g} and {:g}",
        custom, unusable, MOST, MOST);
  smallest = over_ranks(MPI_MIN, smallest, world);
  std::vector<tagint> ids(atom->nlocal, 0);
  for (int i = 0; i < atom->nlocal; ++i)
    if (selection.has(atom->mask[i])) ids[i] = (tagint) (value[i] - smallest) + 1;
  return ids;
}

/* ----------------------------------------------------------------------
   bodies to masks
------------------------------------------------------------------------- */

std::map<tagint, Mask> Arguments::masks_of(const std::vector<tagint> &ids) const
{
  constexpr size_t MOST_DIGITS = 18;
  std::map<tagint, Mask> off;
  for (const auto &one : masks) {
    const bool torque = one.stated & torque_off(0);
    const char *key = torque ? "torque" : "force";
    const auto number = (bigint) ids.size();
    bigint first = 0, last = 0;    // utils::bounds() ends the program at other texts
    const size_t star = std::min(one.range.find('*'), one.range.size());
    if (utils::strmatch(one.range, "^\\d*\\*?\\d*$") && star <= MOST_DIGITS &&
        one.range.size() <= star + 1 + MOST_DIGITS)
      utils::bounds(FLERR, one.range, 1, number, first, last, nullptr);
    if (first < 1 || first > last || last > number)
      error->all(FLERR,
                 "Fix gear/quat {}: bodies {} are neither a number from 1 to {} nor a range of "
                 "them with an asterisk",
                 key, one.range, ids.size());
    const Mask out_of_plane = torque ? torque_off(0) | torque_off(1) : force_off(2);
    if (domain->dimension == 2 && (one.off & out_of_plane) != out_of_plane)
      error->all(FLERR, "Fix gear/quat {}: the {} has to be off in a 2d simulation", key,
                 torque ? "torque about x and y" : "force along z");
    for (bigint m = first; m <= last; ++m) {
      Mask &mask = off[ids[m - 1]];
      mask = (mask & ~one.stated) | one.off;
    }
  }
  for (auto it = off.begin(); it != off.end();) it = it->second ? std::next(it) : off.erase(it);
  return off;
}
