/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_arguments.h"

#include "gear_quat_rigid_words.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "group.h"
#include "input.h"
#include "lammps.h"
#include "utils.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

using namespace LAMMPS_NS;
using namespace GearQuat;

// what is used unless the user says otherwise; measured, see doc/decisions.md

static constexpr int FIRST_VALUES = 6, SECOND_VALUES = 8, PASSES = 2;

// a pass more is of no use from three on; a number with too many digits would seem to hang

static constexpr int PASSES_MOST = 100;

static constexpr int MASK_WORDS = 5;    // force M xflag yflag zflag

static constexpr int FIRST_WORD = 3;    // fix ID group gear/quat ...

Arguments::Arguments(LAMMPS *lmp, int narg, char **arg)
{
  const int used = parse_bodystyle(lmp, narg, arg);
  parse_keywords(lmp, narg - used, arg + used);
}

/// Returns the number of words used so far.
int Arguments::parse_bodystyle(LAMMPS *lmp, int narg, char **arg)
{
  Error *error = lmp->error;
  if (narg <= FIRST_WORD)
    error->all(FLERR,
               "Fix gear/quat: the body style is missing, which says what makes a body: single, "
               "molecule, group N ID1 ID2 ..., custom i_name or custom v_name");
  const std::string style = arg[FIRST_WORD];
  const int next = FIRST_WORD + 1;

  if (style == "single") {
    bodystyle = BodyStyle::SINGLE;
    return next;
  }
  if (style == "molecule") {
    bodystyle = BodyStyle::MOLECULE;
    return next;
  }
  if (style == "custom") {
    bodystyle = BodyStyle::CUSTOM;
    if (narg <= next) utils::missing_cmd_args(FLERR, "fix gear/quat custom", error);
    custom = arg[next];
    return next + 1;
  }
  if (style == "group") {
    bodystyle = BodyStyle::GROUP;
    if (narg <= next) utils::missing_cmd_args(FLERR, "fix gear/quat group", error);
    const int n = utils::inumeric(FLERR, arg[next], false, lmp);
    if (n <= 0)
      error->all(FLERR, "Fix gear/quat group: number of groups is {} and must be positive", n);
    if (narg - next - 1 < n)
      error->all(FLERR, "Fix gear/quat group: {} group IDs expected, {} given", n, narg - next - 1);
    for (int i = 0; i < n; ++i) {
      groups.emplace_back(arg[next + 1 + i]);
      if (lmp->group->find(groups.back()) < 0)
        error->all(FLERR, "Fix gear/quat group: group ID {} does not exist", groups.back());
    }
    return next + 1 + n;
  }
  error->all(FLERR, "Unknown fix gear/quat bodystyle: {} (single, molecule, group or custom)",
             style);
  return 0;
}

static Isokinetic isokinetic_of(const std::string &value, Error *error)
{
  const std::map<std::string, Isokinetic> words = {
      {"none", Isokinetic::NONE}, {"total", Isokinetic::TOTAL}, {"separate", Isokinetic::SEPARATE}};
  const auto found = words.find(value);
  if (found == words.end())
    error->all(FLERR, "Fix gear/quat isokinetic: unknown value {} (none, total or separate)",
               value);
  return found->second;
}

static Arguments::Report report_of(const std::string &value, Error *error)
{
  using Report = Arguments::Report;
  const std::map<std::string, Report> words = {
      {"no", Report::NO}, {"short", Report::SHORT}, {"long", Report::LONG}};
  const auto found = words.find(value);
  if (found == words.end())
    error->all(FLERR, "Fix gear/quat report: unknown value {} (no, short or long)", value);
  return found->second;
}

void Arguments::parse_keywords(LAMMPS *lmp, int narg, char **arg)
{
  Error *error = lmp->error;
  std::set<std::string> seen;

  // one of two words, the first meaning false

  auto choice = [&](const std::string &key, const std::string &value, const char *no,
                    const char *yes) {
    if (value != no && value != yes)
      error->all(FLERR, "Fix gear/quat {}: unknown value {} ({} or {})", key, value, no, yes);
    return value == yes;
  };

  for (int iarg = 0; iarg < narg; iarg += 2) {
    const std::string key = arg[iarg];
    const std::set<std::string> known = {
        "formulation", "values",     "passes",    "start",  "c0",         "omega",  "momentum",
        "project",     "compensate", "tolerance", "dtmin",  "dtmax",      "infile", "reinit",
        "mol",         "force",      "torque",    "report", "isokinetic", "rescale"};
    if (!known.count(key)) {
      const std::string instead = instead_of_rigid_keyword(key);
      if (!instead.empty())
        error->all(FLERR, "Fix gear/quat has no keyword {} of the rigid fixes: {}", key, instead);
      error->all(FLERR, "Unknown fix gear/quat keyword: {}", key);
    }
    if (key == "force" || key == "torque") {    // may be given many times
      masks.push_back(parse_mask(lmp, narg - iarg, arg + iarg));
      iarg += MASK_WORDS - 2;
      continue;
    }
    if (!seen.insert(key).second) error->all(FLERR, "Fix gear/quat keyword {} is given twice", key);
    if (iarg + 1 >= narg) utils::missing_cmd_args(FLERR, "fix gear/quat " + key, error);
    const std::string value = arg[iarg + 1];
    if (value.empty()) error->all(FLERR, "Fix gear/quat {}: the value is an empty word", key);

    if (key == "formulation")
      scheme.formulation = choice(key, value, "first", "second") ? Formulation::SECOND
                                                                 : Formulation::FIRST;
    else if (key == "values")
      scheme.rows = utils::inumeric(FLERR, value, false, lmp);
    else if (key == "passes")
      scheme.passes = utils::inumeric(FLERR, value, false, lmp);
    else if (key == "compensate")
      scheme.compensate = choice(key, value, "no", "yes");
    else if (key == "start")
      start = choice(key, value, "bootstrap", "zero") ? Start::ZERO : Start::BOOTSTRAP;
    else if (key == "c0")
      scheme.velocity_c0 = choice(key, value, "position", "velocity");
    else if (key == "omega")
      scheme.predicted_omega = choice(key, value, "corrected", "predicted");
    else if (key == "momentum")
      scheme.predicted_momentum = choice(key, value, "corrected", "predicted");
    else if (key == "project")
      scheme.project = choice(key, value, "no", "yes");
    else if (key == "reinit")
      reinit = choice(key, value, "no", "yes");
    else if (key == "tolerance" || key == "dtmin" || key == "dtmax") {
      const double number = utils::numeric(FLERR, value, false, lmp);
      if (!(number > 0.0) || !std::isfinite(number))
        error->all(FLERR, "Fix gear/quat {}: {} is not a positive number", key, value);
      (key == "tolerance"   ? control.eps
           : key == "dtmin" ? control.shortest
                            : control.longest) = number;
    } else if (key == "report")
      report = report_of(value, error);
    else if (key == "isokinetic")
      isokinetic = isokinetic_of(value, error);
    else if (key == "rescale")
      rescale = choice(key, value, "no", "yes");
    else if (key == "mol")
      mol = value;
    else
      infile = value;
  }

  const int fewest = scheme.first() ? FIRST_FEWEST : SECOND_FEWEST;
  const int most = scheme.first() ? FIRST_MOST : SECOND_MOST;
  const bool tolerance = seen.count("tolerance");
  if (!seen.count("values"))
    scheme.rows = tolerance ? std::min(most, VARIABLE_MOST)
        : scheme.first()    ? FIRST_VALUES
                            : SECOND_VALUES;
  if (!seen.count("passes")) scheme.passes = PASSES;
  if (scheme.rows < fewest || scheme.rows > most)
    error->all(FLERR, "Fix gear/quat values: {} is not from {} to {}, as formulation {} requires",
               scheme.rows, fewest, most, scheme.first() ? "first" : "second");
  if (scheme.passes < 1 || scheme.passes > PASSES_MOST)
    error->all(FLERR, "Fix gear/quat passes: {} is not from 1 to {}", scheme.passes, PASSES_MOST);
  scheme.trial = tolerance;
  if (tolerance) check_control(lmp, fewest);
  for (const auto *key : {"dtmin", "dtmax"})
    if (!tolerance && seen.count(key))
      error->all(FLERR, "Fix gear/quat keyword {} requires keyword tolerance", key);

  if (scheme.first() && seen.count("c0"))
    error->all(FLERR, "Fix gear/quat keyword c0 belongs to formulation second");
  for (const auto *key : {"omega", "momentum"})
    if (!scheme.first() && seen.count(key))
      error->all(FLERR, "Fix gear/quat keyword {} belongs to formulation first", key);

  check_isokinetic(lmp, seen.count("rescale"));
  if (!mol.empty() && !masks.empty())
    error->all(FLERR,
               "Fix gear/quat keywords force and torque cannot be used with mol: the numbers of "
               "bodies change when bodies come");
  if (!mol.empty() && bodystyle != BodyStyle::MOLECULE)
    error->all(FLERR, "Fix gear/quat keyword mol requires bodystyle molecule");

  // what a file states must not be computed again from the atoms

  if (!infile.empty()) {
    if (reinit && seen.count("reinit"))
      error->all(FLERR,
                 "Fix gear/quat reinit yes cannot be used with infile, which states the "
                 "bodies once and for all");
    reinit = false;
  }
}

void Arguments::check_control(LAMMPS *lmp, int fewest)
{
  control.fewest = fewest;
  control.most = scheme.rows;
  if (control.most > VARIABLE_MOST)
    lmp->error->all(FLERR,
                    "Fix gear/quat tolerance: {} values are more than {}, the largest number with "
                    "which a step may shrink",
                    control.most, VARIABLE_MOST);
  if (control.longest > 0.0 && control.shortest > control.longest)
    lmp->error->all(FLERR, "Fix gear/quat dtmin: {} is larger than dtmax, {}", control.shortest,
                    control.longest);
}

void Arguments::check_isokinetic(LAMMPS *lmp, bool rescale_given) const
{
  Error *error = lmp->error;
  if (isokinetic == Isokinetic::NONE) {
    if (rescale_given)
      error->all(FLERR, "Fix gear/quat keyword rescale belongs to isokinetic total or separate");
    return;
  }
  if (!scheme.first())
    error->all(FLERR,
               "Fix gear/quat keyword isokinetic belongs to formulation first: its constraint acts "
               "on momenta, which formulation second does not have");
  if (!masks.empty())
    error->all(FLERR,
               "Fix gear/quat keywords force and torque cannot be used with isokinetic, which acts "
               "on all momenta: define a second fix for the bodies that are held");
  if (!mol.empty())
    error->all(FLERR,
               "Fix gear/quat keyword mol cannot be used with isokinetic: bodies that come bring "
               "kinetic energy");
  if (control.eps > 0.0)
    error->all(FLERR,
               "Fix gear/quat keyword tolerance cannot be used with isokinetic: heat and "
               "multipliers are those of one step and one number of values");
}

/// arg: the keyword and what follows.
MaskWords Arguments::parse_mask(LAMMPS *lmp, int narg, char **arg)
{
  const std::string key = arg[0];
  if (narg < MASK_WORDS) utils::missing_cmd_args(FLERR, "fix gear/quat " + key, lmp->error);
  MaskWords words = {key == "torque", arg[1], {}};
  for (int k = 0; k < 3; ++k) {
    const std::string flag = arg[2 + k];
    if (flag != "on" && flag != "off")
      lmp->error->all(FLERR, "Fix gear/quat {}: unknown {}flag {} (on or off)", key, "xyz"[k],
                      flag);
    words.on[k] = flag == "on";
  }
  return words;
}

/* ----------------------------------------------------------------------
   atoms to bodies
------------------------------------------------------------------------- */

std::vector<tagint> Arguments::body_ids(LAMMPS *lmp, int groupbit) const
{
  switch (bodystyle) {
    case BodyStyle::MOLECULE:
      return molecule_ids(lmp, groupbit);
    case BodyStyle::GROUP:
      return group_ids(lmp, groupbit);
    case BodyStyle::CUSTOM:
      return custom_ids(lmp, groupbit);
    default:
      break;
  }
  std::vector<tagint> ids(lmp->atom->nlocal);
  for (size_t i = 0; i < ids.size(); ++i) ids[i] = (lmp->atom->mask[i] & groupbit) ? 1 : 0;
  return ids;
}

/// The largest of a fault's atom IDs on all ranks, 0 for none.
static tagint anywhere(LAMMPS *lmp, tagint tag)
{
  tagint all;
  MPI_Allreduce(&tag, &all, 1, MPI_LMP_TAGINT, MPI_MAX, lmp->world);
  return all;
}

std::vector<tagint> Arguments::molecule_ids(LAMMPS *lmp, int groupbit) const
{
  Atom *atom = lmp->atom;
  if (!atom->molecule_flag)
    lmp->error->all(FLERR, "Fix gear/quat molecule requires an atom style with molecule IDs");
  std::vector<tagint> ids(atom->nlocal, 0);
  tagint without = 0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    ids[i] = atom->molecule[i];
    if (ids[i] <= 0) without = atom->tag[i];
  }
  if ((without = anywhere(lmp, without)))
    lmp->error->all(FLERR,
                    "Fix gear/quat molecule: atom {} of the fix group has molecule ID 0; "
                    "take it out of the group or give it the ID of its body",
                    without);
  return ids;
}

std::vector<tagint> Arguments::group_ids(LAMMPS *lmp, int groupbit) const
{
  Atom *atom = lmp->atom;
  std::vector<tagint> ids(atom->nlocal, 0);
  tagint twice = 0;
  std::vector<int> used(groups.size(), 0), used_anywhere(groups.size(), 0);
  for (size_t g = 0; g < groups.size(); ++g) {
    const int bit = lmp->group->bitmask[lmp->group->find(groups[g])];
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!(atom->mask[i] & bit) || !(atom->mask[i] & groupbit)) continue;
      if (ids[i] != 0) twice = atom->tag[i];
      ids[i] = (tagint) g + 1;
      used[g] = 1;
    }
  }
  if ((twice = anywhere(lmp, twice)))
    lmp->error->all(FLERR,
                    "Fix gear/quat group: atom {} is in more than one of the groups; an "
                    "atom belongs to one body at most",
                    twice);
  MPI_Allreduce(used.data(), used_anywhere.data(), (int) groups.size(), MPI_INT, MPI_MAX,
                lmp->world);
  for (size_t g = 0; g < groups.size(); ++g)
    if (!used_anywhere[g])
      lmp->error->all(
          FLERR,
          "Fix gear/quat group: no atom of the fix group is in group {}, which makes no "
          "body; leave it out",
          groups[g]);
  return ids;
}

/// What a value may be, and how far values may be apart: every double here is an integer.
static constexpr double MOST_CUSTOM = std::min((double) MAXTAGINT, 9007199254740992.0);

/// Bodies are numbered from the smallest value in the group, as fix rigid numbers them.
std::vector<tagint> Arguments::custom_ids(LAMMPS *lmp, int groupbit) const
{
  Atom *atom = lmp->atom;
  Error *error = lmp->error;
  std::vector<tagint> ids(atom->nlocal, 0);

  if (utils::strmatch(custom, "^i_")) {
    int is_double, columns;
    const int index = atom->find_custom(custom.c_str() + 2, is_double, columns);
    if (index < 0 || is_double || columns)
      error->all(FLERR,
                 "Fix gear/quat custom {} requires an integer vector of that name, made by "
                 "fix property/atom",
                 custom);
    std::copy_n(atom->ivector[index], atom->nlocal, ids.begin());
  } else if (utils::strmatch(custom, "^v_")) {
    Variable *variable = lmp->input->variable;
    const int index = variable->find(custom.c_str() + 2);
    if (index < 0 || !variable->atomstyle(index))
      error->all(FLERR,
                 "Fix gear/quat custom {} requires an atom-style or atomfile-style variable "
                 "of that name",
                 custom);
    std::vector<double> value(atom->nlocal + 1);
    variable->compute_atom(index, 0, value.data(), 1, 0);
    tagint unusable = 0;
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!(atom->mask[i] & groupbit)) continue;
      if (std::fabs(value[i]) < MOST_CUSTOM)
        ids[i] = (tagint) std::llround(value[i]);
      else
        unusable = atom->tag[i];
    }
    if ((unusable = anywhere(lmp, unusable)))
      error->all(FLERR, "Fix gear/quat custom {}: the value of atom {} is no number below {:g}",
                 custom, unusable, MOST_CUSTOM);
  } else
    error->all(FLERR, "Fix gear/quat custom: {} is neither i_name nor v_name", custom);

  bigint largest[2] = {-MAXBIGINT, -MAXBIGINT}, all[2];    // of the value, and of its negative
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) {
      largest[0] = std::max(largest[0], (bigint) ids[i]);
      largest[1] = std::max(largest[1], -(bigint) ids[i]);
    }
  MPI_Allreduce(largest, all, 2, MPI_LMP_BIGINT, MPI_MAX, lmp->world);
  if ((double) all[0] + (double) all[1] >= MOST_CUSTOM)
    error->all(FLERR, "Fix gear/quat custom {}: values from {} to {} are too far apart", custom,
               -all[1], all[0]);
  for (int i = 0; i < atom->nlocal; ++i)
    ids[i] = (atom->mask[i] & groupbit) ? (tagint) (ids[i] + all[1] + 1) : 0;
  return ids;
}
