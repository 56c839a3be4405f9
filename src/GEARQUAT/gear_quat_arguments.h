/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The words of the fix command, which state how atoms form bodies and how bodies are integrated.

   The keywords are listed in one table with one row each.  A row gives the words after the keyword,
   the default, the other keywords that it requires or excludes, its meaning, and the member that
   stores its value.  The parser is a loop over these rows, error messages are built from the rows,
   and `fix ID group gear/quat keywords` prints the rows for people and for programs. */

#ifndef LMP_GEAR_QUAT_ARGUMENTS_H
#define LMP_GEAR_QUAT_ARGUMENTS_H

#include "gear_quat_chain.h"
#include "gear_quat_remembered_loads.h"
#include "pointers.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

struct Arguments;

/// Keyword force or torque with its words: the components that act, and the bodies.
struct MaskWords {
  bool torque;          ///< or force
  std::string range;    ///< of bodies, counted from 1 in the order of their IDs
  bool on[3];
};

/// Values of keywords temp, tchain and thermostat.
struct ThermostatWords {
  double start = 0.0, stop = 0.0, damp = 0.0;    ///< damp 0: none
  int length = 0;
  bool separate = false;
  int subtracted = -1;      ///< by fix_modify extra/dof; negative: as the scene is
  bool may_wait = false;    ///< bodies may be inserted later, so a run may start without any
};

/// Values of the pressure keywords, for the components xx yy zz yz xz xy.
struct PressureWords {
  static constexpr int COMPONENTS = 6;
  bool on[COMPONENTS] = {};
  double start[COMPONENTS] = {}, stop[COMPONENTS] = {}, period[COMPONENTS] = {};
  int tied[3] = {0, 1, 2};    ///< directions with the same number change by the same factor
  int length = 0;             ///< of the chain of the box; 0: none
  double temperature = 0.0;
  std::vector<double> fixed;    ///< point; empty: the center of the box
  bool flip = true;
  std::string bodies,
      in_bodies;    ///< formulas of an atom: number of its body, 1 for an atom in one

  bool any() const { return std::count(on, on + COMPONENTS, true) > 0; }
  bool shears() const { return on[3] || on[4] || on[5]; }
  void set(int component, const std::vector<double> &numbers)
  {
    on[component] = true;
    start[component] = numbers[0];
    stop[component] = numbers[1];
    period[component] = numbers[2];
  }
  void set_all(const std::vector<double> &numbers)
  {
    for (int k = 0; k < 3; ++k) set(k, numbers);
  }
};

/// The words after a keyword, parsed.
struct KeywordValue {
  std::string text;                    ///< the first word as written
  int integer = 0;                     ///< of an INTEGER
  double number = 0.0;                 ///< of a NUMBER, in units of `unit`
  std::string measure = {};            ///< of a NUMBER, the word after it
  double unit = 1.0;                   ///< of a NUMBER, the number after that word
  std::vector<double> numbers = {};    ///< of NUMBERS
  MaskWords mask = {};                 ///< of a MASK

  bool is(const char *word) const { return text == word; }
};

struct Keyword {
  /// WORD: one of some words; NUMBER: a positive one, optionally followed by a word, which may have
  /// a unit, another positive number; NUMBERS: some positive ones; NAME: any word that is not
  /// empty; MASK: four words, and the keyword may be given many times.
  enum Kind { WORD, INTEGER, NUMBER, NAME, MASK, NUMBERS };
  struct Range {
    int fewest, most, standard;
    int standard_gear = 0;    ///< the default with corrector gear; 0: the same
  };
  /// Another keyword that is required or excluded; an empty value means any value except "none".
  struct Condition {
    std::string keyword, value;
    std::string reason;    ///< ends the error message, may be empty
    std::string only_for =
        "";    ///< required only by this value of the keyword; empty: by any value
  };
  /// The default of a WORD beside this value of another keyword; an empty value means any.
  struct Standard {
    std::string keyword, value, word;
  };
  using Store = void (*)(Arguments &, const KeywordValue &);

  const char *name;
  const char *about;    ///< integration, step, bodies, physics or output
  const char *meaning;
  Store store;

  Kind kind = WORD;
  std::vector<std::string> words;     ///< WORD: the possible ones; NUMBER: the words after it, the
                                      ///< first is the default; NAME, MASK, NUMBERS: what follows
  std::string standard;               ///< WORD: the default
  std::vector<Standard> standards;    ///< WORD: other defaults, the first that applies counts
  std::vector<Range> ranges;          ///< INTEGER: one, or two, the second for formulation first
  int any_sign = 0;                   ///< NUMBERS: how many of the first may be negative or zero
  bool may_be_auto = false;           ///< INTEGER: the word auto is possible, and the default
  std::vector<Condition> needs, excludes;

  Keyword(const char *name, const char *about, const char *meaning, Store store) :
      name(name), about(about), meaning(meaning), store(store)
  {
  }

  // functions for the rows of the table; an empty default means the first word

  Keyword &word(const std::vector<std::string> &possible, const std::string &default_word = "")
  {
    standard = default_word.empty() ? possible.front() : default_word;
    return follows(WORD, possible);
  }
  Keyword &integer(const std::vector<Range> &possible)
  {
    ranges = possible;
    return follows(INTEGER, {});
  }
  Keyword &standard_with(const char *keyword, const char *value, const char *word)
  {
    standards.push_back({keyword, value, word});
    return *this;
  }
  Keyword &or_auto()
  {
    may_be_auto = true;
    return *this;
  }
  Keyword &number(const std::vector<std::string> &measures = {})
  {
    return follows(NUMBER, measures);
  }
  Keyword &numbers(const std::vector<std::string> &names, int of_any_sign)
  {
    any_sign = of_any_sign;
    return follows(NUMBERS, names);
  }
  Keyword &follows(Kind what, const std::vector<std::string> &names)
  {
    kind = what;
    words = names;
    return *this;
  }
  Keyword &requires_also(const Condition &condition)
  {
    needs.push_back(condition);
    return *this;
  }
  Keyword &cannot_go_with(const Condition &condition)
  {
    excludes.push_back(condition);
    return *this;
  }

  /// The range for a formulation, if there are two ranges.
  const Range &range(bool first) const { return ranges[first ? ranges.size() - 1 : 0]; }

  /// The default of an INTEGER.
  int standard_of(const Range &range, bool gear) const
  {
    return gear && range.standard_gear ? range.standard_gear : range.standard;
  }

  /// Reads the words after arg[0] into value and returns their number.  Invalid words end the run
  /// on all ranks.
  int read(LAMMPS *lmp, int narg, char **arg, KeywordValue &value) const;
  /// The words required, as in a sentence: "no, short or long", "1 to 100", "M xflag yflag zflag".
  std::string required() const;
  /// The words required, with the values that depend on other keywords.
  std::string possible_values() const;
};

/// All rows, in the order of the manual.
const std::vector<Keyword> &keyword_table();

/// The row of a keyword.  An unknown keyword ends the run on all ranks.  The message gives the
/// equivalent of a keyword of the rigid fixes, otherwise the words allowed after the previous
/// keyword, `before`.
const Keyword &find_keyword(LAMMPS *lmp, const std::string &name, const Keyword *before = nullptr);

/// Returns true if `text` is an integer, and stores its value in `integer`.
bool read_integer(const std::string &text, int &integer);

/// The table as text: a line of titles and a line for each row, whose columns are separated by two
/// or more blanks; an empty cell is a hyphen.
std::string list_of_keywords();

// words of the rigid fixes that this fix does not have

/// Handles the words of fix_modify that the rigid fixes have and returns how many were used.  Ends
/// the run on all ranks if this fix does not support the request.
int modify_like_rigid(LAMMPS *lmp, int narg, char **arg);

/* ---------------------------------------------------------------------- */

struct Arguments : protected Pointers {
  enum class BodyStyle { SINGLE, MOLECULE, GROUP, CUSTOM };
  enum class Start { BOOTSTRAP, ZERO };
  enum class Report { NO, SHORT, LONG };

  BodyStyle bodystyle = BodyStyle::SINGLE;
  std::vector<std::string> groups;    ///< group: one per body
  std::string custom;                 ///< custom: i_name or v_name

  // values of the keywords; the table in gear_quat_keyword_table.cpp has the defaults

  Scheme scheme;
  bool automatic_values = false;    ///< `scheme` has the number of values for smooth motion
  StepControl control;              ///< eps 0: the step is LAMMPS' own
  double every_time = 0.0;          ///< steps end at multiples of it; 0: at any time
  Start start;
  bool reinit;
  Report report;
  std::string infile;
  std::string mol;    ///< template of bodies that are inserted
  std::vector<MaskWords> masks;
  Isokinetic isokinetic;
  bool rescale;
  ThermostatWords thermostat;    ///< damp 0: none
  PressureWords pressure;        ///< no component on: the box does not move

  /// Parses the words after the style.  Any error ends the run on all ranks with a message that
  /// gives the word and the words required.
  Arguments(LAMMPS *lmp, int narg, char **arg);

  /// True if the command has this keyword.
  bool states(const std::string &keyword) const { return given.count(keyword) > 0; }

  /// Keyword tolerance and the keywords that bound its steps, as in the command; empty without it.
  std::string words_of_control() const;
  /// Keywords of the pressure, as in the command.
  std::string words_of_pressure() const;

  /// Body of every owned atom, 0 for atoms in none; error messages give the atom.  Collective.
  std::vector<tagint> body_ids(int groupbit) const;

  /// Components turned off by keywords force and torque, for bodies with at least one; later
  /// keywords replace earlier keywords.  ids: of all bodies, sorted.  An invalid range, a range
  /// with bodies that do not exist, or motion out of the plane in two dimensions ends the run.
  std::map<tagint, Mask> masks_of(const std::vector<tagint> &ids) const;

 private:
  std::map<std::string, KeywordValue> given;    ///< of the command, its bodystyle among them

  int parse_bodystyle(int narg, char **arg);
  void find_formulas(const std::string &group_of_fix);
  void parse_keywords(int narg, char **arg);
  void take_preset();
  bool is_on(const std::string &keyword, const std::string &value) const;
  const std::string &standard_word(const Keyword &row) const;
  void check_conditions() const;
  void check_ranges();
  void check_control();
  void check_pressure();
  void check_directions() const;
  void check_coupling() const;
  std::vector<tagint> molecule_ids(int groupbit) const;
  std::vector<tagint> group_ids(int groupbit) const;
  std::vector<tagint> custom_ids(int groupbit) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
