/* -*- c++ -*- ----------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.

   See the README file in the package's directory.
------------------------------------------------------------------------- */

#ifdef FIX_CLASS
// clang-format off
FixStyle(gear/quat,FixGearQuat);
// clang-format on
#else

#ifndef LMP_FIX_GEAR_QUAT_H
#define LMP_FIX_GEAR_QUAT_H

#include "fix.h"

#include <memory>
#include <vector>

namespace LAMMPS_NS {

namespace GearQuat {
  class Bodies;
  class BodyTable;
  class DrivenBox;
  class Extract;
  class Minimization;
  class Motion;
  class OtherFixes;
  class Ownership;
  class RespaForces;
  class Restart;
  class Sites;
  class Step;
  class Sums;
  struct Arguments;
  struct Fleet;
  struct StatedMolecule;
}    // namespace GearQuat

class FixGearQuat : public Fix {
 public:
  FixGearQuat(class LAMMPS *, int, char **);
  ~FixGearQuat() override;

  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void setup_pre_neighbor() override;
  void setup(int) override;
  void pre_exchange() override;
  void pre_neighbor() override;
  void initial_integrate(int) override;
  void final_integrate() override;
  void initial_integrate_respa(int, int, int) override;
  void final_integrate_respa(int, int) override;
  void end_of_step() override;
  void post_run() override;
  void reset_dt() override;
  void deform(int) override;

  void min_setup(int) override;
  void min_pre_exchange() override;
  void min_pre_neighbor() override;
  void min_pre_force(int) override;
  void min_post_force(int) override;
  double min_energy(double *) override;
  void min_store() override;
  int min_dof() override;
  double max_alpha(double *) override;

  double compute_scalar() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;
  bigint dof(int) override;
  int modify_param(int, char **) override;
  double memory_usage() override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;

  void write_restart(FILE *) override;
  void restart(char *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;

  void write_restart_file(const char *) override;
  void set_molecule(int, tagint, int, double *, double *, double *) override;
  void *extract(const char *, int &) override;

 private:
  // each object depends only on objects before it; if the constructor fails, all are freed
  std::unique_ptr<GearQuat::Arguments> args;
  std::unique_ptr<GearQuat::Fleet> fleet;
  std::unique_ptr<GearQuat::Bodies> bodies;
  std::unique_ptr<GearQuat::Ownership> ownership;
  std::unique_ptr<GearQuat::Sites> sites;
  std::unique_ptr<GearQuat::OtherFixes> other_fixes;
  std::unique_ptr<GearQuat::Step> step;
  std::unique_ptr<GearQuat::Motion> motion;
  std::unique_ptr<GearQuat::DrivenBox> driven_box;
  std::unique_ptr<GearQuat::Minimization> minimization;
  std::unique_ptr<GearQuat::Restart> restarts;
  std::unique_ptr<GearQuat::RespaForces> respa;
  std::unique_ptr<GearQuat::BodyTable> table;
  std::unique_ptr<GearQuat::Sums> sums;
  std::unique_ptr<GearQuat::Extract> extracts;

  std::vector<GearQuat::StatedMolecule> stated;    // one for each molecule of the template

  bool met_atoms = false;         // an earlier run has compared bodies and atoms
  bool told_of_ids = false;       ///< a warning about changed molecule IDs was given
  int told_of_groups = 0;         ///< their bits: a warning about parts of bodies was given
  bool reported = false;          // the report was printed
  bool atoms_are_free = false;    // their velocities are not yet those of bodies
  bool min_projected = false;     // forces were projected before a minimization begins
  int min_vflag = 0;              // vflag of the current evaluation in a minimization
  bool motion_acts = true;        // the next step begins with actions of Motion

  void create_bodies();
  void update_bodies();
  void resume();
  void meet_fleet();
  void begin_step(int, double **, double **);
  void end_step(double **, double **);
  void end_minimization();
  void tally_virial(int, double **);
  void count_rows();
  void show_bodies();
};

}    // namespace LAMMPS_NS

#endif
#endif
