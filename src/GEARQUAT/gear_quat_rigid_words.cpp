/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_rigid_words.h"

#include "error.h"
#include "lammps.h"
#include "utils.h"

#include <algorithm>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

struct RigidWords {
  std::vector<std::string> keywords;
  const char *instead;
};

static constexpr char BAROSTAT[] =
    "there is no barostat, the box does not change; use fix rigid/npt/small for that";

/// doc/howto/from_rigid.md has the same table.
static const std::vector<RigidWords> RIGID_WORDS = {
    {{"langevin"}, "define fix langevin on the same group, and use few values (values 4)"},
    {{"temp", "tparam", "tchain"},
     "define fix temp/csvr or temp/berendsen on the same group, or use keyword isokinetic"},
    {{"iso", "aniso", "tri", "x", "y", "z", "xy", "yz", "xz", "couple", "pparam", "pchain",
      "dilate", "fixedpoint", "scalexy", "scalexz", "scaleyz"},
     BAROSTAT},
    {{"gravity"},
     "keep fix gravity, on a group with the bodies, and leave out its keyword disable"},
    {{"bodyforces"}, "forces are always summed late, in the end of the step"},
};

std::string GearQuat::instead_of_rigid_keyword(const std::string &keyword)
{
  for (const auto &row : RIGID_WORDS)
    if (std::count(row.keywords.begin(), row.keywords.end(), keyword)) return row.instead;
  return "";
}

int GearQuat::modify_like_rigid(LAMMPS *lmp, int narg, char **arg)
{
  const std::string word = arg[0];
  if (word == "temp" || word == "press")
    lmp->error->all(FLERR, "Fix gear/quat has no fix_modify {}: it computes no {}", word,
                    word == "temp" ? "temperature" : "pressure");
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
