/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The words of the fix command: which atoms make bodies, and how they are integrated. */

#ifndef LMP_GEAR_QUAT_ARGUMENTS_H
#define LMP_GEAR_QUAT_ARGUMENTS_H

#include "gear_quat_keywords.h"
#include "gear_quat_step_control.h"
#include "pointers.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

struct Arguments : protected Pointers {
  enum class BodyStyle { SINGLE, MOLECULE, GROUP, CUSTOM };
  enum class Start { BOOTSTRAP, ZERO };
  enum class Report { NO, SHORT, LONG };

  BodyStyle bodystyle = BodyStyle::SINGLE;
  std::vector<std::string> groups;    ///< group: one per body
  std::string custom;                 ///< custom: i_name or v_name

  // what the keywords say; the table in gear_quat_keyword_table.cpp has the defaults

  Scheme scheme;
  StepControl control;        ///< eps 0: the step is LAMMPS' own
  double every_time = 0.0;    ///< steps end at its multiples; 0: at any times
  Start start;
  bool reinit;
  Report report;
  std::string infile;
  std::string mol;    ///< template of bodies to come
  std::vector<MaskWords> masks;
  Isokinetic isokinetic;
  bool rescale;
  ThermostatWords thermostat;    ///< damp 0: none

  /// Parse the words after the style.  Any fault ends the run on all ranks with a message that
  /// names the word and what is required.
  Arguments(LAMMPS *lmp, int narg, char **arg);

  /// Keyword tolerance and those that bound its steps, as in the command; empty without it.
  std::string words_of_control() const;

  /// Body of every owned atom, 0 for atoms in none; faults name the atom.  Collective.
  std::vector<tagint> body_ids(int groupbit) const;

  /// What keywords force and torque turn off, for bodies of which something is off; later keywords
  /// replace earlier ones.  ids: of all bodies, sorted.  A range that is none, or has bodies that
  /// do not exist, ends the run, and so does motion out of the plane in two dimensions.
  std::map<tagint, Mask> masks_of(const std::vector<tagint> &ids) const;

 private:
  std::map<std::string, KeywordValue> given;    ///< of the command, its bodystyle among them

  int parse_bodystyle(int narg, char **arg);
  void parse_keywords(int narg, char **arg);
  bool is_on(const std::string &keyword, const std::string &value) const;
  void check_conditions() const;
  void check_ranges();
  void check_control();
  std::vector<tagint> molecule_ids(int groupbit) const;
  std::vector<tagint> group_ids(int groupbit) const;
  std::vector<tagint> custom_ids(int groupbit) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
