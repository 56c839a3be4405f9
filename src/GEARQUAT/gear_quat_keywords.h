/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The keywords of the fix command: one table with one row for each.  A row says what follows the
   keyword, what holds without it, which other keywords it requires or excludes, what it means, and
   where its value is stored.  The parser is a loop over these rows, error messages are made from
   them, and `fix ID group gear/quat keywords` prints them for people and for programs. */

#ifndef LMP_GEAR_QUAT_KEYWORDS_H
#define LMP_GEAR_QUAT_KEYWORDS_H

#include "gear_quat_masks.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

struct Arguments;

/// The words behind a keyword, after they were read.
struct KeywordValue {
  std::string text;       ///< the first word as it stands
  int integer = 0;        ///< of an INTEGER
  double number = 0.0;    ///< of a NUMBER
  MaskWords mask = {};    ///< of a MASK

  bool is(const char *word) const { return text == word; }
};

struct Keyword {
  /// WORD: one of some words; NUMBER: a positive one; NAME: any word that is not empty; MASK: four
  /// words, and the keyword may be given many times.
  enum Kind { WORD, INTEGER, NUMBER, NAME, MASK };
  struct Range {
    int fewest, most, standard;
  };
  /// Another keyword that has to be given, or must not be; value: empty for any but "none".
  struct Condition {
    std::string keyword, value;
    std::string reason;    ///< ends the error message, may be empty
  };
  using Store = void (*)(Arguments &, const KeywordValue &);

  const char *name;
  const char *about;    ///< integration, step, bodies, physics or output
  const char *meaning;
  Store store;

  Kind kind = WORD;
  std::vector<std::string> words;    ///< WORD: the possible ones; NAME and MASK: what follows
  std::string standard;              ///< WORD: the default
  std::vector<Range> ranges;         ///< INTEGER: one, or those of formulation second and first
  int most_with_tolerance = 0;       ///< INTEGER: also the default then, within the range
  std::vector<Condition> needs, excludes;

  Keyword(const char *name, const char *about, const char *meaning, Store store) :
      name(name), about(about), meaning(meaning), store(store)
  {
  }

  // what the rows of the table are written with; an empty default is the first word

  Keyword &word(std::vector<std::string> possible, const std::string &default_word = "");
  Keyword &integer(std::vector<Range> possible, int at_most_with_tolerance = 0);
  Keyword &number();
  Keyword &follows(Kind what, std::vector<std::string> names);
  Keyword &requires_also(Condition condition);
  Keyword &cannot_go_with(Condition condition);

  /// Of the formulation, where there are two.
  const Range &range(bool first) const { return ranges[first ? ranges.size() - 1 : 0]; }

  /// Reads the words behind arg[0] into value and returns how many they are.  Words that cannot be
  /// meant end the run on all ranks.
  int read(LAMMPS *lmp, int narg, char **arg, KeywordValue &value) const;
  /// The words that are possible, as a sentence has them: "no, short or long".
  std::string possible_words() const;
};

/// All rows, in the order of the manual.
const std::vector<Keyword> &keyword_table();

/// The row of a keyword that is in the table.
const Keyword &find_keyword(const std::string &name);

/// The row of a word of the user.  An unknown one ends the run on all ranks, with what to write
/// instead if it is a keyword of the rigid fixes.
const Keyword &known_keyword(LAMMPS *lmp, const std::string &name);

/// The table as text: a line of titles and a line for each row, whose columns are separated by two
/// or more blanks; an empty cell is a hyphen.
std::string list_of_keywords();

// words of the rigid fixes that this fix does not have

/// What to write instead of a keyword of fix rigid and its kin; empty for any other word.
std::string instead_of_rigid_keyword(const std::string &keyword);

/// The words of fix_modify that the rigid fixes have: returns how many were used, and ends the run
/// on all ranks where this fix cannot do what they ask for.
int modify_like_rigid(LAMMPS *lmp, int narg, char **arg);

}    // namespace LAMMPS_NS::GearQuat

#endif
