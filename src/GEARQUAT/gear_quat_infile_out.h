/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The file that keyword infile reads (gear_quat_infile.h), written from the present bodies. */

#ifndef LMP_GEAR_QUAT_INFILE_OUT_H
#define LMP_GEAR_QUAT_INFILE_OUT_H

#include <string>

namespace LAMMPS_NS {
class LAMMPS;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Bodies;

/// Write all bodies, sorted by ID, with all digits; a file that cannot be written ends the run.
/// A file of this name is whole at any time: it is written under another name and then renamed.
/// rows: those of BodyTable for this rank's owned bodies.  fix_id: for the comment on line 1.
/// Collective.
void write_given_bodies(LAMMPS *lmp, const std::string &filename, const std::string &fix_id,
                        const Bodies &bodies, double **rows);

}    // namespace LAMMPS_NS::GearQuat

#endif
