/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The words of the fix command: which atoms make bodies, and how they are integrated. */

#ifndef LMP_GEAR_QUAT_ARGUMENTS_H
#define LMP_GEAR_QUAT_ARGUMENTS_H

#include "gear_quat_keywords.h"
#include "gear_quat_step_control.h"
#include "lmptype.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

struct Arguments {
  enum class BodyStyle { SINGLE, MOLECULE, GROUP, CUSTOM };
  enum class Start { BOOTSTRAP, ZERO };
  enum class Report { NO, SHORT, LONG };

  BodyStyle bodystyle = BodyStyle::SINGLE;
  std::vector<std::string> groups;    ///< group: one per body
  std::string custom;                 ///< custom: i_name or v_name

  // what the keywords say; the table in gear_quat_keywords.cpp has the defaults

  Scheme scheme;
  StepControl control;    ///< eps 0: the step is LAMMPS' own
  Start start;
  bool reinit;
  Report report;
  std::string infile;
  std::string mol;    ///< template of bodies to come
  std::vector<MaskWords> masks;
  Isokinetic isokinetic;
  bool rescale;

  /// Parse the words after the style.  Any fault ends the run on all ranks with a message that
  /// names the word and what is required.
  Arguments(LAMMPS *lmp, int narg, char **arg);

  /// Body of every owned atom, 0 for atoms in none; faults name the atom.  Collective.
  std::vector<tagint> body_ids(LAMMPS *lmp, int groupbit) const;

 private:
  std::map<std::string, KeywordValue> given;    ///< of the command, its bodystyle among them

  int parse_bodystyle(LAMMPS *lmp, int narg, char **arg);
  void parse_keywords(LAMMPS *lmp, int narg, char **arg);
  bool is_on(const std::string &keyword, const std::string &value) const;
  void check_conditions(LAMMPS *lmp) const;
  void check_ranges(LAMMPS *lmp);
  void check_control(LAMMPS *lmp);
  std::vector<tagint> molecule_ids(LAMMPS *lmp, int groupbit) const;
  std::vector<tagint> group_ids(LAMMPS *lmp, int groupbit) const;
  std::vector<tagint> custom_ids(LAMMPS *lmp, int groupbit) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
