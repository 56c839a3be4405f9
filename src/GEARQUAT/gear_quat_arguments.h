/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The words of the fix command, which state how atoms form bodies and how bodies are integrated.

   The keywords of the fix command: a table of keywords, and a table of rules between them.

   A row of the first table gives the words after a keyword, the default, the member that stores the
   value, and the meaning; a row of the second gives what keywords require or exclude.  The parser is
   a loop over these tables, error messages are built from their rows, and `fix ID group gear/quat
   keywords` prints them for people and for programs. */

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
  std::string range;    ///< of bodies, counted from 1 in the order of their IDs
  Mask stated, off;     ///< all components of the force or of the torque; those that do not act
};

/// The words after a keyword, parsed.
struct KeywordValue {
  std::string text;                    ///< the first word as written
  int integer = 0;                     ///< of an INTEGER
  double number = 0.0;                 ///< of a NUMBER
  std::string measure = {};            ///< of a NUMBER, the word after it
  std::vector<double> numbers = {};    ///< of NUMBERS
  MaskWords mask = {};                 ///< of a MASK

  bool is(const char *word) const { return text == word; }
};

/// A row of the table of keywords.
struct Keyword {
  /// WORD: one of some words, the first is the default; NUMBER: a positive one, optionally followed
  /// by a word; NUMBERS: some, of which the first `any_sign` may be negative or zero; NAME: any word
  /// that is not empty; MASK: four words, and the keyword may be given many times.
  enum Kind { WORD, INTEGER, NUMBER, NAME, MASK, NUMBERS };
  struct Range {
    int fewest, most, standard;
    int standard_gear = 0;    ///< the default with corrector gear; 0: the same
  };
  /// The default of a WORD beside this value of another keyword; an empty value means any.
  struct Standard {
    std::string keyword, value, word;
  };

  const char *name;
  const char *about;    ///< integration, step, bodies, physics or output
  Kind kind;
  std::vector<std::string> words;    ///< WORD: the possible ones; NUMBER: the words after it, the
                                     ///< first is the default; NAME, MASK, NUMBERS: what follows
  void (*store)(Arguments &, const KeywordValue &);
  const char *meaning;
  std::vector<Range> ranges = {};    ///< INTEGER: one, or two, the second for formulation first
  std::vector<Standard> standards = {};    ///< WORD: other defaults, the first that applies counts
  int any_sign = 0;

  /// With a range for each formulation the word auto is possible, and the default.
  bool may_be_auto() const { return ranges.size() > 1; }
  /// The range for a formulation, if there are two ranges.
  const Range &range(bool first) const { return ranges[first ? ranges.size() - 1 : 0]; }

  /// Reads the words after arg[0] into value and returns their number.  Invalid words end the run
  /// on all ranks.
  int read(LAMMPS *lmp, int narg, char **arg, KeywordValue &value) const;
  /// The words required, as in a sentence: "no, short or long", "1 to 100", "M xflag yflag zflag".
  std::string required() const;
};

/// What keywords require or exclude.
struct Rule {
  enum Kind { REQUIRE, EXCLUDE };

  std::vector<std::string> names;
  std::string own;    ///< the value for which the rule applies; empty: all but the word none
  Kind kind;
  std::vector<std::string> others;    ///< REQUIRE: one of them is enough
  std::vector<std::string> values;    ///< of one of the others, as `own`
  std::string reason;                 ///< ends the error message, may be empty

  bool is_for(const std::string &name) const;
};

/// All rows, in the order of the manual.
const std::vector<Keyword> &keyword_table();
/// All rules, in the order in which they are checked.
const std::vector<Rule> &keyword_rules();

/// The row of a keyword.  An unknown keyword ends the run on all ranks; the message gives the words
/// allowed after the previous keyword, `before`.
const Keyword &find_keyword(LAMMPS *lmp, const std::string &name, const Keyword *before = nullptr);

/// Returns true if `text` is an integer, and stores its value in `integer`.
bool read_integer(const std::string &text, int &integer);

/// "one, two or three".
std::string alternatives(const std::vector<std::string> &words);

/// The tables as text: a line of titles and a line for each keyword, whose columns are separated by
/// two or more blanks; an empty cell is a hyphen.
std::string list_of_keywords();

/* ---------------------------------------------------------------------- */

/// Values of keywords temp, tchain and thermostat, or of langevin.
struct ThermostatWords {
  double start = 0.0, stop = 0.0, damp = 0.0;    ///< damp 0: none
  int length = 0;
  bool separate = false;
  int seed = 0;             ///< of langevin; 0: chains
  int subtracted = -1;      ///< by fix_modify extra/dof; negative: as the scene is
  bool takes_in = false;    ///< what other fixes insert becomes bodies

  bool is_random() const { return seed > 0; }
  const char *keyword() const { return is_random() ? "langevin" : "temp"; }
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

/* ---------------------------------------------------------------------- */

struct Arguments : protected Pointers {
  enum class BodyStyle { SINGLE, MOLECULE, GROUP, CUSTOM };
  enum class Start { BOOTSTRAP, ZERO };

  BodyStyle bodystyle = BodyStyle::SINGLE;
  std::vector<std::string> groups;    ///< group: one per body
  std::string custom;                 ///< custom: i_name or v_name

  // values of the keywords; the table in gear_quat_keywords.cpp has the defaults

  Scheme scheme;
  bool automatic_values = false;    ///< `scheme` has the number of values for smooth motion
  StepControl control;              ///< eps 0: the step is LAMMPS' own
  double every_time = 0.0;          ///< steps end at multiples of it; 0: at any time
  Start start;
  bool reinit;
  bool report;
  std::string infile;
  std::string mol;       ///< template of bodies that are inserted
  std::string points;    ///< group of atoms that are bodies of one atom each
  std::vector<MaskWords> masks;
  Isokinetic isokinetic;
  bool rescale;
  ThermostatWords thermostat;
  PressureWords pressure;    ///< no component on: the box does not move

  /// Parses the words after the style.  Any error ends the run on all ranks with a message that
  /// gives the word and the words required.
  Arguments(LAMMPS *lmp, int narg, char **arg);

  /// True if the command has this keyword.
  bool states(const std::string &keyword) const { return given.count(keyword) > 0; }

  /// A point has this number plus the atom ID as ID of its body.
  static constexpr tagint POINTS = 1000000000;

  /// Body of every owned atom, 0 for atoms in none; error messages give the atom.  Collective.
  std::vector<tagint> body_ids(int groupbit) const;

  /// Components turned off by keywords force and torque, for bodies with at least one; later
  /// keywords replace earlier keywords.  ids: of all bodies, sorted.  An invalid range, a range
  /// with bodies that do not exist, or motion out of the plane in two dimensions ends the run.
  std::map<tagint, Mask> masks_of(const std::vector<tagint> &ids) const;

 private:
  std::map<std::string, KeywordValue> given;    ///< of the command, its bodystyle among them

  int parse_bodystyle(int narg, char **arg);
  void parse_keywords(int narg, char **arg);
  void take_preset();
  bool is_on(const std::string &keyword, const std::string &value) const;
  const std::string &standard_word(const Keyword &row) const;
  void check_rules() const;
  void check_ranges();
  void check_control();
  void check_random();
  void check_pressure();

  /// The atoms that the body style assigns to bodies.
  struct Selection {
    int group, points;    ///< bits of groups
    bool has(int mask) const { return (mask & group) && !(mask & points); }
  };
  int find_group(const char *keyword, const std::string &name) const;
  std::vector<tagint> ids_by_style(const Selection &selection) const;
  std::vector<tagint> molecule_ids(const Selection &selection) const;
  std::vector<tagint> group_ids(const Selection &selection) const;
  std::vector<tagint> custom_ids(const Selection &selection) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
