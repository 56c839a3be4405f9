/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The form of the keywords of the fix command: a table of keywords, and a table of rules between them
   (gear_quat_keyword_table.cpp).

   A row of the first table gives the words after a keyword, the default, the member that stores the
   value, and the meaning; a row of the second gives what keywords require or exclude.  The parser is
   a loop over these tables, error messages are built from their rows, and `fix ID group gear/quat
   keywords` prints them for people and for programs. */

#ifndef LMP_GEAR_QUAT_KEYWORDS_H
#define LMP_GEAR_QUAT_KEYWORDS_H

#include "pointers.h"

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

/// A row of the table of keywords.
struct Keyword {
  /// WORD: one of some words, the first is the default; NUMBER: a positive one, optionally followed
  /// by a word, which may have a unit, another positive number; NUMBERS: some, of which the first
  /// `any_sign` may be negative or zero; NAME: any word that is not empty; MASK: four words, and the
  /// keyword may be given many times.
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
  bool may_be_auto = false;    ///< INTEGER: the word auto is possible, and the default

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

using KeywordTable = std::vector<Keyword>;
using KeywordRules = std::vector<Rule>;

/// The row of a keyword.  An unknown keyword ends the run on all ranks.  The message gives the
/// equivalent of a keyword of the rigid fixes, otherwise the words allowed after the previous
/// keyword, `before`.
const Keyword &find_keyword(LAMMPS *lmp, const KeywordTable &table, const std::string &name,
                            const Keyword *before = nullptr);

/// Returns true if `text` is an integer, and stores its value in `integer`.
bool read_integer(const std::string &text, int &integer);

/// "one, two or three".
std::string alternatives(const std::vector<std::string> &words);

/// The tables as text: a line of titles and a line for each keyword, whose columns are separated by
/// two or more blanks; an empty cell is a hyphen.
std::string list_of_keywords(const KeywordTable &table, const KeywordRules &rules);

/// Handles the words of fix_modify that the rigid fixes have and returns how many were used.  Ends
/// the run on all ranks if this fix does not support the request.
int modify_like_rigid(LAMMPS *lmp, int narg, char **arg);

}    // namespace LAMMPS_NS::GearQuat

#endif
