/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.

   See the README file in the package's directory.
------------------------------------------------------------------------- */

/* The hooks of LAMMPS and the objects behind them; the step itself is in gear_quat_step.cpp. */

#include "fix_gear_quat.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "input.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

FixGearQuat::FixGearQuat(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), args(lmp, narg, arg), bodies(args.scheme), ownership(lmp, this, bodies),
    sites(lmp, bodies, ownership), scene(lmp, this, args, bodies, ownership, sites),
    step(scene, fleet, [this](int vflag, double **f) {
      tally_virial(vflag, f);
    })
{
  time_integrate = rigid_flag = 1;
  scalar_flag = vector_flag = array_flag = local_flag = 1;
  global_freq = local_freq = 1;
  extscalar = 1;
  extvector = -1;
  extarray = 0;
  size_array_rows = 0;
  size_array_cols = size_local_cols = COLUMNS;
  energy_global_flag = virial_global_flag = virial_peratom_flag = 1;
  centroidstressflag = CENTROID_AVAIL;
  thermo_virial = 1;
  dof_flag = 1;
  create_attribute = 1;
  restart_global = restart_peratom = 1;

  ecouple_flag = args.thermostat.damp > 0.0 || args.pressure.any();
  constexpr int CHANGES[] = {BOX_CHANGE_X,  BOX_CHANGE_Y,  BOX_CHANGE_Z,
                             BOX_CHANGE_YZ, BOX_CHANGE_XZ, BOX_CHANGE_XY};
  for (int k = 0; k < PressureWords::COMPONENTS; ++k)
    if (args.pressure.on[k]) box_change |= CHANGES[k];
  if (args.pressure.any()) no_change_box = 1;
  force_reneighbor = args.pressure.shears() || !args.reinit || !args.mol.empty();
  next_reneighbor = -1;
  maxexchange = ownership.max_exchange();
  comm_forward = ownership.max_forward();
  comm_reverse = Ownership::MOST_NUMBERS;
  size_vector = ELEMENTS + step.elements();

  if (group->dynamic[igroup])
    error->all(
        FLERR,
        "Fix gear/quat: group {} is dynamic, but bodies keep their atoms; use a static group",
        group->names[igroup]);
  find_template(lmp, args.mol);    // it must exist
  create_bodies();
  if (bodies.number() == 0 && args.mol.empty())
    error->all(FLERR, "Fix gear/quat: no atom of the fix group is in a body");
  step.meet_bodies();
  count_rows();
  size_array_rows_variable = !args.mol.empty();    // rows may be requested before they exist

  // callbacks last, because LAMMPS would call a fix whose constructor has failed
  extlist = new int[size_vector]{1, 1};
  for (int n = 0; n < step.elements(); ++n) extlist[ELEMENTS + n] = step.extensive(n);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  if (comm->me == 0)
    utils::logmesg(lmp, "  {} rigid bodies with {} atoms\n", bodies.number(),
                   ownership.number_of_atoms());
}

void FixGearQuat::create_bodies()
{
  ownership.create(args.body_ids(groupbit), read_given_bodies(lmp, args.infile));
}

FixGearQuat::~FixGearQuat()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  delete[] extlist;
}

/// LAMMPS calls this on all ranks, when a new fix has received its restart data.
int FixGearQuat::setmask()
{
  resume();
  show_bodies();    // local data may be requested before the first run
  return INITIAL_INTEGRATE | FINAL_INTEGRATE | PRE_EXCHANGE | PRE_NEIGHBOR |
      INITIAL_INTEGRATE_RESPA | FINAL_INTEGRATE_RESPA | (step.tolerance ? END_OF_STEP : 0) |
      (step.bath.moves_box() ? POST_FORCE : 0) | MIN_PRE_EXCHANGE | MIN_PRE_NEIGHBOR |
      MIN_PRE_FORCE | MIN_POST_FORCE | MIN_ENERGY;
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void FixGearQuat::init()
{
  fleet.members.clear();
  for (auto *other : modify->get_fix_list())
    if (auto *same = dynamic_cast<FixGearQuat *>(other)) fleet.members.push_back(&same->step);
  step.refuse_scene();
  if (is_minimized()) {
    driver = nullptr;
    refuse_minimizer();
    return;
  }
  find_driver();
  if (ecouple_flag && thermo_energy)
    error->all(FLERR,
               "Fix gear/quat {} cannot be used with fix_modify energy yes: the scalar has the "
               "energy of the thermostat, too, which thermo keyword econserve adds; leave it out",
               args.thermostat.damp > 0.0 ? args.thermostat.keyword() : "with a pressure");
  if (!step.had_run()) stated = read_stated(lmp, args.mol);
  step.init();
  step.velocities_read = !reader_of_predicted_velocities(lmp, this).empty();
}

/// In a minimization, LAMMPS continues from the end of the last line search.
void FixGearQuat::deform(int flag)
{
  if (flag == 0 && is_minimized()) put_back_poses();
  flag == 0 ? ownership.note_box() : remap_bodies();
}

/// Bodies keep their state between runs, and adopt changes that the user has made in the atoms.
void FixGearQuat::setup_pre_neighbor()
{
  ownership.check_whole();
  update_bodies();
  follow_images();
  const bool defined = step.phase == Phase::DEFINED;
  const bool takes_over = args.infile.empty() && stated.empty() && (args.reinit || defined);
  if (takes_over && sites.any_changes()) {
    sites.take_out_flow();
    ownership.recreate();
    note_images();
    update_bodies();
    step.forget("Fix gear/quat: atoms were changed since the last run; bodies are rebuilt from "
                "them");
  }
  if (!takes_over && !defined) put_back();
  ownership.note_box();
  step.impose_masks();
  if (defined) step.phase = Phase::COMPARED;
  count_rows();
}

/// Moves atoms back into their bodies before forces are evaluated, except in rerun.  Ghost atoms were
/// chosen before this move.  If it is shorter than the skin of neighbor lists, they suffice for the
/// first step, and then the lists are built again.
void FixGearQuat::put_back()
{
  const double farthest = sites.farthest();
  if (farthest == 0.0 || strcmp(input->command, "rerun") == 0) return;
  if (farthest > neighbor->skin)
    error->all(
        FLERR,
        "Fix gear/quat: atoms of bodies were moved by up to {:.3g} since the last run, but with "
        "{} bodies stay where they are; undo the change, or define the fix again",
        farthest,
        !args.infile.empty()  ? "infile"
            : !stated.empty() ? "mol"
                              : "reinit no");
  sites.place(true);
  comm->forward_comm();
  next_reneighbor = update->ntimestep + 1;
}

/// Atoms are changed only after all checks that may end the run.
void FixGearQuat::setup(int vflag)
{
  const bool first = !step.had_run();
  ownership.spread_states();
  sites.gather_loads(atom->f, atom->torque);
  follow_change();
  step.begin_run();
  step.bath.measure_virial(atom->f);
  sites.place_velocities();
  bodies.forget_work();    // positions belong to the corrected poses
  tally_virial(vflag, atom->f);
  show_bodies();
  if (first) step.report();
  loose = loose_atoms();
}

/// Atoms of the group that are in no body, with keyword mol.  Collective.
bigint FixGearQuat::loose_atoms() const
{
  bigint here = 0;
  for (int i = 0; !args.mol.empty() && i < atom->nlocal; ++i)
    here += (atom->mask[i] & groupbit) && !ownership.in_body(i);
  return args.mol.empty() ? 0 : over_ranks(MPI_SUM, here, world);
}

void FixGearQuat::count_rows()
{
  size_array_rows = std::max(size_array_rows, (int) bodies.number());
}

void FixGearQuat::pre_exchange()
{
  step.bath.flip();
}

/// Atoms were exchanged, and other fixes may have inserted or removed bodies.
void FixGearQuat::pre_neighbor()
{
  update_bodies();
  follow_images();
  if (driver) ownership.note_box();    // fix deform may have flipped the box
  count_rows();
}

void FixGearQuat::update_bodies()
{
  ownership.update();
  sites.list();
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

/// f, torque: from all pair styles and fixes in the previous step.
void FixGearQuat::begin_step(int vflag, double **f, double **torque)
{
  step.start(f, torque);
  follow_change();
  sites.advance_densities(update->dt);
  step.begin(vflag, f);
}

/// vflag is 0 where forces of other fixes are evaluated alone.
void FixGearQuat::post_force(int vflag)
{
  if (vflag) step.bath.measure_virial(atom->f);
}

void FixGearQuat::end_step(double **f, double **torque)
{
  step.end(f, torque);
  sites.advance_densities(update->dt);
  if (box_change != NO_BOX_CHANGE) ownership.note_box();
  if (reads_at_end(lmp, this)) show_bodies();
  if (step.bath.is_tilted()) next_reneighbor = update->ntimestep + 1;
  compare_calls(world);
}

void FixGearQuat::post_run()
{
  if (is_minimized()) {
    sites.place_velocities();
    ownership.note_box();
    show_bodies();
    return;
  }
  step.end_run();
  if (driver) {
    follow_change();
    place_in_box();
  }
  const bigint before = loose;
  loose = loose_atoms();
  if (loose > before && comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat {0}: other fixes have inserted {1} atoms into its group that are "
                   "in no body, so this fix does not move them; a fix that inserts molecules of "
                   "template {2} as bodies needs its keyword rigid {0}",
                   id, loose - before, args.mol);
}

/// Virial of the constraint forces, at the pose at which the forces were evaluated.
void FixGearQuat::tally_virial(int vflag, double **f)
{
  v_init(vflag);
  if (!evflag) return;
  const auto motion = is_minimized() ? Sites::Turning::NO : Sites::Turning::YES;
  sites.visit_constraint_forces(f, cvflag_atom != 0, motion,
                                [this](int i, Sites::ConstraintForce &constraint) {
                                  v_tally(1, &i, 1.0, constraint.virial, constraint.arm,
                                          constraint.force, constraint.centroid);
                                });
}

/* ----------------------------------------------------------------------
   r-RESPA with one step for all levels: forces are summed over the levels
------------------------------------------------------------------------- */

void FixGearQuat::initial_integrate(int vflag)
{
  begin_step(vflag, atom->f, atom->torque);
}

void FixGearQuat::final_integrate()
{
  end_step(atom->f, atom->torque);
}

bool FixGearQuat::is_minimized() const
{
  return update->whichflag == 2;
}

/// Sums the latest forces of all levels, including all fixes, where the outermost level begins or ends
/// a step.  LAMMPS keeps the forces of the inner levels in a fix that packs for each atom 3 numbers
/// per level: forces, then torques.  Atoms have those of the outermost level.
bool FixGearQuat::sum_levels(int level)
{
  const int levels = (int) respa_steps(lmp).size(), all = 3 * levels, n = atom->nlocal;
  if (level + 1 != levels) return false;
  Fix *store = modify->get_fix_by_id("RESPA");
  std::vector<double> stored(2 * (size_t) all);
  double **const outer[] = {atom->f, atom->torque_flag ? atom->torque : nullptr};
  for (int k = 0; k < 2; ++k) {
    rows_of_sums[k].clear();
    if (n == 0 || !outer[k]) continue;
    summed[k].assign(outer[k][0], outer[k][0] + 3 * (size_t) n);
    for (int i = 0; i < n; ++i) rows_of_sums[k].push_back(&summed[k][3 * (size_t) i]);
  }
  for (int i = 0; i < n; ++i) {
    store->pack_exchange(i, stored.data());
    for (int k = 0; k < 2 && !rows_of_sums[k].empty(); ++k)
      for (int j = 0; j < all - 3; ++j) rows_of_sums[k][i][j % 3] += stored[(size_t) k * all + j];
  }
  return true;
}

void FixGearQuat::initial_integrate_respa(int vflag, int ilevel, int /*iloop*/)
{
  if (sum_levels(ilevel)) begin_step(vflag, rows_of_sums[0].data(), rows_of_sums[1].data());
}

void FixGearQuat::final_integrate_respa(int ilevel, int /*iloop*/)
{
  if (sum_levels(ilevel)) end_step(rows_of_sums[0].data(), rows_of_sums[1].data());
}

/* ----------------------------------------------------------------------
   requests of other commands
------------------------------------------------------------------------- */

/// The command velocity create gives every atom its own velocity, of which bodies adopt the rigid
/// part in their first run: until then, as for fix rigid, all degrees of freedom of atoms count.
bigint FixGearQuat::dof(int tgroup)
{
  if (update->whichflag != 1 && !step.had_run() && !step.continues()) return 0;
  const Comparison found = ownership.count_atoms(group->bitmask[tgroup]);
  if (found.divided && !(told_of_groups & group->bitmask[tgroup])) {
    told_of_groups |= group->bitmask[tgroup];
    if (comm->me == 0)
      error->warning(
          FLERR,
          "Fix gear/quat {}: a compute takes the temperature of group {}, which has only "
          "some atoms of bodies such as {}; it counts all degrees of freedom of these "
          "atoms, so the temperature is too low; use a group of whole bodies",
          id, group->names[tgroup], found.divided);
  }
  return found.removed_freedoms;
}

int FixGearQuat::modify_param(int narg, char **arg)
{
  if (narg < 2) return 0;
  if (strcmp(arg[0], "bodyforces") == 0 && strcmp(arg[1], "late") == 0) return 2;    // as always
  if (strcmp(arg[0], "extra/dof") != 0) return 0;
  args.thermostat.subtracted = utils::inumeric(FLERR, arg[1], false, lmp);
  if (args.thermostat.subtracted < 0 || !ecouple_flag)
    error->all(
        FLERR,
        "Fix gear/quat: fix_modify extra/dof is the number of degrees of freedom, 0 or more, "
        "that temp or a pressure does not count; keywords of neither are in the command, or "
        "the number is negative");
  return 2;
}

/* ----------------------------------------------------------------------
   per-atom data, forwarded to the ownership of bodies
------------------------------------------------------------------------- */

/// Another fix has inserted a molecule of the template.
/// Makes one body of the atoms that were just created on all ranks, from index `first` on; its ID is
/// the smallest molecule ID of its atoms.
void FixGearQuat::set_molecule(int first, tagint /*before*/, int which, double *center,
                               double *velocity, double *quat)
{
  tagint smallest = MAXTAGINT;
  for (int i = first; i < atom->nlocal; ++i) smallest = std::min(smallest, atom->molecule[i]);
  const tagint molecule = over_ranks(MPI_MIN, smallest, world);

  GivenBodies given;
  if (const auto one = stated.find(which); one != stated.end())
    given[molecule] = given_at(one->second, center, velocity, quat);
  std::vector<tagint> ids(atom->nlocal, 0);
  std::fill(ids.begin() + first, ids.end(), molecule);
  ownership.add(ids, given, true);
}

/* ----------------------------------------------------------------------
   restart
------------------------------------------------------------------------- */

void FixGearQuat::write_restart(FILE *fp)
{
  Fields written;
  double extended = ownership.extended().has_records();
  written(extended);
  step.write(written);
  if (comm->me != 0) return;
  const auto &numbers = written.numbers();
  const double head[] = {Fields::MAGIC, Fields::FORMAT, (double) numbers.size()};
  const int size = (int) (sizeof(head) + numbers.size() * sizeof(double));
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(head, sizeof(head), 1, fp);
  fwrite(numbers.data(), size - sizeof(head), 1, fp);
}

/// LAMMPS does not pass the size of the block, so the part that every release wrote is read first.
void FixGearQuat::restart(char *buf)
{
  double head[3];
  std::memcpy(head, buf, sizeof(head));
  if (head[0] != Fields::MAGIC || head[1] != Fields::FORMAT || !(head[2] >= 0.0))
    error->all(FLERR,
               "Fix gear/quat: the data of fix {} in the restart file are from another release of "
               "GEARQUAT, whose format this release does not read; continue with that release, or "
               "give the fix another ID, with which its bodies start from their atoms",
               id);
  Fields::Numbers numbers((size_t) head[2]);
  std::memcpy(numbers.data(), buf + sizeof(head), numbers.size() * sizeof(double));
  file = Fields(numbers);
}

/// The first number is the count of numbers, with which other fixes skip these data.
int FixGearQuat::pack_restart(int i, double *buf)
{
  const int n = HEAD + ownership.pack_exchange(i, buf + HEAD);
  buf[0] = n;
  buf[1] = ubuf(atom->tag[i]).d;
  return n;
}

/// The bodies of a restart file continue if the command creates the same bodies.  Atoms that have
/// come or gone since the file was read do not have their own data.
void FixGearQuat::resume()
{
  if (!file.reads()) return;
  Fields data;
  std::swap(data, file);
  double extended = 0.0;
  data(extended);
  step.adopt_scheme(data);
  std::vector<const double *> packed(atom->nlocal, nullptr);
  for (int i = 0; i < atom->nlocal; ++i) {
    const double *row = atom->extra[i];
    for (int n = 0; n < place; ++n) row += (int) row[0];
    if ((tagint) ubuf(row[1]).i == atom->tag[i]) packed[i] = row + HEAD;
  }
  // insertions may come from outside of the group
  if (ownership.resume(packed, extended != 0.0, args.mol.empty() ? 0 : groupbit)) {
    if (!step.read(data))
      error->all(FLERR, "Fix gear/quat: the data of fix {} in the restart file are damaged", id);
    step.phase = Phase::COMPARED;
    return;
  }
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: the bodies of this command do not consist of the same atoms as "
                   "in the restart file; they are rebuilt from their atoms");
  create_bodies();
}
