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

#include "gear_quat_arguments.h"
#include "gear_quat_assembly.h"
#include "gear_quat_fields.h"
#include "gear_quat_forces.h"
#include "gear_quat_step.h"
#include "gear_quat_styles.h"

#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace LAMMPS_NS {

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
  void post_force(int) override;    ///< with a pressure only
  void initial_integrate(int) override;
  void final_integrate() override;
  void initial_integrate_respa(int, int, int) override;
  void final_integrate_respa(int, int) override;
  void end_of_step() override { step.choose_next(); }    ///< with keyword tolerance only
  void post_run() override;
  void reset_dt() override { step.follow_length(); }
  void deform(int) override;

  void min_setup(int) override;
  void min_pre_exchange() override;
  void min_pre_neighbor() override { pre_neighbor(); }
  void min_pre_force(int) override;
  void min_post_force(int) override;
  double min_energy(double *) override;
  void min_store() override;
  /// A single degree of freedom, which stays 0: with it LAMMPS calls min_energy() and min_store().
  /// The minimizer moves bodies by the degrees of freedom of their atoms.
  int min_dof() override { return 1; }
  double max_alpha(double *) override { return HUGE_VAL; }

  double compute_scalar() override;
  double compute_vector(int) override;
  double compute_array(int, int) override;
  bigint dof(int) override;
  int modify_param(int, char **) override;
  double memory_usage() override;

  void set_arrays(int i) override { ownership.set_arrays(i); }
  void set_molecule(int, tagint, int, double *, double *, double *) override;

  // data of atoms

  void grow_arrays(int nmax) override { ownership.grow_arrays(nmax); }
  void copy_arrays(int i, int j, int flag) override { ownership.copy_arrays(i, j, flag); }
  int pack_exchange(int i, double *buf) override { return ownership.pack_exchange(i, buf); }
  int unpack_exchange(int i, double *buf) override { return ownership.unpack_exchange(i, buf); }
  int pack_forward_comm(int n, int *list, double *buf, int, int *) override
  {
    return ownership.pack_forward(n, list, buf);
  }
  void unpack_forward_comm(int n, int i, double *buf) override
  {
    ownership.unpack_forward(n, i, buf);
  }
  int pack_reverse_comm(int n, int i, double *buf) override
  {
    return ownership.pack_reverse(n, i, buf);
  }
  void unpack_reverse_comm(int n, int *list, double *buf) override
  {
    ownership.unpack_reverse(n, list, buf);
  }

  void write_restart(FILE *) override;
  void restart(char *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int nth) override { place = nth; }
  int size_restart(int i) override { return HEAD + ownership.packed_size(i); }
  int maxsize_restart() override { return HEAD + ownership.max_exchange(); }
  void *extract(const char *, int &) override;

 private:
  // each object depends only on objects before it

  GearQuat::Arguments args;
  GearQuat::Fleet fleet;
  GearQuat::Bodies bodies;
  GearQuat::Ownership ownership;
  GearQuat::Sites sites;
  GearQuat::Scene scene;
  GearQuat::Step step;

  std::map<int, GearQuat::StatedMolecule> stated;    ///< of molecules of the template, by numbers

  GearQuat::Fields file;            ///< the numbers of a restart file that were not read yet
  int place = 0;                    ///< number of other fixes whose data of an atom precede in it
  static constexpr int HEAD = 2;    ///< numbers of an atom before its data: their count, and its ID

  std::vector<double> summed[2];    ///< over levels of r-RESPA: forces, and torques of atoms
  std::vector<double *> rows_of_sums[2];    ///< of them; empty where atoms have none

  // a box that another fix changes

  const Fix *driver = nullptr;    ///< that fix in this run
  void find_driver();
  void remap_bodies();
  void move_center(int ibody, const double *way);
  void place_in_box();
  void follow_change();
  void pass_faces(int ibody, const double *images);
  void note_images();
  void follow_images();

  // outputs

  static constexpr int ELEMENTS = 8;    ///< of the vector, before those of Step
  static constexpr int COLUMNS = 28;    ///< of a row
  using Row = std::array<double, COLUMNS>;
  std::vector<Row> mine, all;
  std::vector<double *> rows;       ///< of `mine`
  int gathered = -1;                ///< number of placements when `all` was gathered
  std::vector<int> body_of_atom;    ///< the last results of extract()
  int nbody = 0;
  std::vector<double> masstotal;
  std::vector<Row> owned_rows() const;

  bigint loose = 0;          ///< atoms of the group in no body, when a run began
  int told_of_groups = 0;    ///< their bits: a warning about parts of bodies was given
  static constexpr int PROJECTED = -1;
  /// vflag of the current evaluation in a minimization; or forces were projected
  int min_vflag = 0;

  bool is_minimized() const;
  void refuse_minimizer() const;
  void project_forces();
  void put_back_poses();
  void create_bodies();
  void update_bodies();
  void put_back();
  bigint loose_atoms() const;
  void resume();
  bool sum_levels(int level);
  void begin_step(int, double **, double **);
  void end_step(double **, double **);
  void tally_virial(int, double **);
  void count_rows();
  void show_bodies();
};

}    // namespace LAMMPS_NS

#endif
#endif
