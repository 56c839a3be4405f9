/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The words of the fix command, which state how atoms form bodies and how bodies are integrated.  The
   tables of gear_quat_keyword_table.cpp define the keywords. */

#ifndef LMP_GEAR_QUAT_ARGUMENTS_H
#define LMP_GEAR_QUAT_ARGUMENTS_H

#include "gear_quat_chain.h"
#include "gear_quat_keywords.h"
#include "gear_quat_remembered_loads.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

// in gear_quat_keyword_table.cpp

/// All rows, in the order of the manual.
const KeywordTable &keyword_table();
/// All rules, in the order in which they are checked.
const KeywordRules &keyword_rules();
/// The keywords of constant pressure.
const std::vector<std::string> &pressure_keywords();

/// Values of keywords temp, tchain and thermostat, or of langevin.
struct ThermostatWords {
  double start = 0.0, stop = 0.0, damp = 0.0;    ///< damp 0: none
  int length = 0;
  bool separate = false;
  int seed = 0;             ///< of langevin; 0: chains
  int subtracted = -1;      ///< by fix_modify extra/dof; negative: as the scene is
  bool may_wait = false;    ///< bodies may be inserted later, so a run may start without any

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

  // values of the keywords; the table in gear_quat_keyword_table.cpp has the defaults

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

  /// Keyword tolerance and the keywords that bound its steps, as in the command; empty without it.
  std::string words_of_control() const;
  /// Keywords of the pressure, as in the command.
  std::string words_of_pressure() const;

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
  void check_directions() const;
  void check_coupling() const;

  /// The atoms that the body style assigns to bodies.
  struct Selection {
    int group, points;    ///< bits of groups
    bool has(int mask) const { return (mask & group) && !(mask & points); }
  };
  std::vector<tagint> ids_by_style(const Selection &selection) const;
  std::vector<tagint> molecule_ids(const Selection &selection) const;
  std::vector<tagint> group_ids(const Selection &selection) const;
  std::vector<tagint> custom_ids(const Selection &selection) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
