/* ----------------------------------------------------------------------
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.

   See the README file in the package's directory.
------------------------------------------------------------------------- */

/* One step:
     initial_integrate   predict every body, place its sites
     LAMMPS              forces at the predicted sites, once
     final_integrate     gather force and torque, correct, project, place its sites */

#include "fix_gear_quat.h"

#include "gear_quat_arguments.h"
#include "gear_quat_blowup.h"
#include "gear_quat_bodies.h"
#include "gear_quat_bootstrap.h"
#include "gear_quat_checks.h"
#include "gear_quat_extract.h"
#include "gear_quat_infile_out.h"
#include "gear_quat_isokinetic.h"
#include "gear_quat_masks.h"
#include "gear_quat_report.h"
#include "gear_quat_scene.h"
#include "gear_quat_sums.h"
#include "gear_quat_table.h"
#include "gear_quat_template.h"
#include "gear_quat_tolerance.h"

#include "atom.h"
#include "citeme.h"
#include "comm.h"
#include "error.h"
#include "group.h"
#include "library.h"
#include "memory.h"
#include "modify.h"
#include "output.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace GearQuat;

static const char cite_gear_quat[] =
    "fix gear/quat: quaternions in the equations of motion, first-order form\n\n"
    "@Article{Evans1977,\n"
    " author = {Denis J. Evans},\n"
    " title = {On the Representation of Orientation Space},\n"
    " journal = {Molecular Physics},\n"
    " year = 1977,\n"
    " volume = 34,\n"
    " pages = {317--325}\n"
    "}\n\n"
    "fix gear/quat: quaternions in the equations of motion, second-order form\n\n"
    "@Article{Rapaport1985,\n"
    " author = {Dennis C. Rapaport},\n"
    " title = {Molecular Dynamics Simulation Using Quaternions},\n"
    " journal = {Journal of Computational Physics},\n"
    " year = 1985,\n"
    " volume = 60,\n"
    " pages = {306--314}\n"
    "}\n\n";

/* ---------------------------------------------------------------------- */

FixGearQuat::FixGearQuat(LAMMPS *lmp, int narg, char **arg) :
    Fix(lmp, narg, arg), started(false), met_atoms(false), reported(false), h(0.0),
    velocities_read(true), f_sum(nullptr), torque_sum(nullptr), nmax_sum(0)
{
  if (lmp->citeme) lmp->citeme->add(cite_gear_quat);

  time_integrate = 1;
  scalar_flag = vector_flag = 1;
  global_freq = 1;
  extscalar = 1;
  extvector = -1;
  array_flag = local_flag = 1;
  extarray = 0;
  local_freq = 1;
  size_array_cols = size_local_cols = GearQuatTable::COLUMNS;
  energy_global_flag = 1;
  virial_global_flag = virial_peratom_flag = 1;
  thermo_virial = 1;
  dof_flag = 1;
  create_attribute = 1;
  restart_global = restart_peratom = restart_file = 1;

  if (atom->map_style == Atom::MAP_NONE)
    error->all(FLERR, "Fix gear/quat requires an atom map, see atom_modify");
  if (!atom->tag_enable) error->all(FLERR, "Fix gear/quat requires atom IDs");

  args.reset(new GearQuatArguments(lmp, narg, arg));
  const bool variable = args->control.eps > 0.0;
  args->scheme.trial = variable;
  bodies.reset(new GearQuatBodies(lmp, this, args->scheme));
  if (variable)
    tolerance.reset(new GearQuatTolerance(lmp, this, args->scheme, args->control, *bodies));
  size_vector = GearQuatSums::ELEMENTS + (variable ? GearQuatTolerance::ELEMENTS : 0);
  if (args->isokinetic != Isokinetic::NONE) {    // not with tolerance
    isokinetic.reset(
        new GearQuatIsokinetic(lmp, *bodies, args->scheme, args->isokinetic, args->rescale));
    size_vector += GearQuatIsokinetic::ELEMENTS;
  }
  blowup.reset(new GearQuatBlowup(lmp, *bodies, args->scheme));
  table.reset(new GearQuatTable(lmp, *bodies));
  sums.reset(new GearQuatSums(lmp, *bodies));
  find_template(lmp, args->mol);    // it has to exist
  extracts.reset(new GearQuatExtract(lmp, *bodies, args->mol));
  maxexchange = bodies->max_exchange();
  comm_forward = bodies->max_forward();
  comm_reverse = sizeof(Load) / sizeof(double);

  GivenBodies given;
  if (!args->infile.empty()) given = read_given_bodies(lmp, args->infile);
  bodies->create(args->body_ids(lmp, groupbit), given);

  if (bodies->number() == 0 && args->mol.empty())
    error->all(FLERR, "Fix gear/quat: no atom of the fix group is in a body");
  masks.reset(new GearQuatMasks(lmp, args->masks, *bodies));
  size_array_rows = bodies->number();

  // only now that nothing can fail: LAMMPS would go on calling a fix that does not exist
  extlist = new int[size_vector]{1, 1};
  if (isokinetic) extlist[GearQuatSums::ELEMENTS + GearQuatIsokinetic::HEAT] = 1;
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  if (comm->me == 0)
    utils::logmesg(lmp, "  {} rigid bodies with {} atoms\n", bodies->number(),
                   bodies->number_of_sites());
}

/* ---------------------------------------------------------------------- */

FixGearQuat::~FixGearQuat()
{
  if (copymode) return;
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  delete[] extlist;
  memory->destroy(f_sum);
  memory->destroy(torque_sum);
}

/* ---------------------------------------------------------------------- */

int FixGearQuat::setmask()
{
  return INITIAL_INTEGRATE | FINAL_INTEGRATE | PRE_NEIGHBOR | INITIAL_INTEGRATE_RESPA |
      FINAL_INTEGRATE_RESPA | (tolerance ? END_OF_STEP : 0);
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void FixGearQuat::init()
{
  refuse_scene(lmp, this, *bodies);
  if (tolerance) tolerance->refuse_scene();
  if (tolerance && started) tolerance->keep_step(h);
  follow_time_step();
  velocities_read = !reader_of_predicted_velocities(lmp, this).empty();
  bodies->expect_forces(makes_forces(lmp, this));
}

bool FixGearQuat::moves(int i) const
{
  return bodies->in_body(i);
}

const Scheme &FixGearQuat::present_scheme() const
{
  return tolerance ? tolerance->scheme() : args->scheme;
}

void FixGearQuat::make_integrator(double step)
{
  integrator.reset(new Integrator(present_scheme(), step));
}

/// Called whenever the time step may have changed; histories keep their polynomials.
void FixGearQuat::follow_time_step()
{
  const double step = update->dt;
  if (step == 0.0 || !std::isfinite(step)) return;
  if (integrator && step == h) return;
  const double ratio = step / h;
  if (integrator)
    integrator->set_step(step);
  else
    make_integrator(step);
  if (started && ratio != 1.0) {
    for (int ibody = 0; ibody < bodies->nowned(); ++ibody)
      integrator->rescale(bodies->history(ibody), ratio);
    if (isokinetic) isokinetic->rescale_step(ratio);
  }
  h = step;
}

void FixGearQuat::reset_dt()
{
  if (tolerance && started && !tolerance->owns_step()) return;    // it is put back in init()
  follow_time_step();
}

/// Bodies keep their state between runs; what the user changed in the atoms is taken over.
void FixGearQuat::setup_pre_neighbor()
{
  bodies->check_whole();
  bodies->update_ghosts();
  const bool take_over = args->infile.empty() && (args->reinit || !met_atoms);
  if (take_over && !bodies->atoms_match()) {
    bodies->recreate();
    bodies->update_ghosts();
    if (started && comm->me == 0)
      utils::logmesg(lmp,
                     "Fix gear/quat: atoms were changed since the last run, bodies start "
                     "anew from them\n");
    started = false;
  }
  if (masks->impose(*bodies) && started) {    // only those of a restart file can be others
    started = false;
    if (comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat: keywords force and torque turn off other components than in "
                     "the run that wrote the restart file; poses and velocities are kept, the "
                     "higher derivatives start anew");
  }
  met_atoms = true;
  size_array_rows = bodies->number();
}

void FixGearQuat::setup(int vflag)
{
  bodies->spread_states();
  bodies->place_velocities();
  for (auto &one : bodies->last) one.work = 0.0;    // positions are the corrected ones
  v_init(vflag);
  bodies->gather_loads(atom->f, atom->torque);
  if (isokinetic) isokinetic->begin_run(!started);
  if (evflag) tally_virial(atom->f);
  table->forget();
  show_bodies();
  if (!reported) report_scene(lmp, this, *args, *bodies);
  reported = true;
}

/// Local data have to be there whenever something may read them.
void FixGearQuat::show_bodies()
{
  array_local = table->local();
  size_local_rows = bodies->nowned();
}

/// Atoms were exchanged; other fixes may have inserted or removed bodies.
void FixGearQuat::pre_neighbor()
{
  bodies->update_ghosts();
  size_array_rows = bodies->number();
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void FixGearQuat::initial_integrate(int vflag)
{
  v_init(vflag);
  if (!started) {
    // forces of the step before are still there, those of all other fixes among them
    bodies->spread_states();
    bodies->gather_loads(atom->f, atom->torque);
    blowup->check_loads(h, atom->f);
    start();
  }
  begin_step();
}

void FixGearQuat::final_integrate()
{
  finish_step(atom->f, atom->torque);
}

/// Higher rows of the histories: `h`, poses, velocities and present loads are known.
void FixGearQuat::start()
{
  GearQuatBootstrap bootstrap(lmp, this, *bodies, isokinetic.get(),
                              tolerance ? tolerance->scheme_of_start() : args->scheme, h);
  bool full = false;
  if (args->start == GearQuatArguments::Start::ZERO)
    bootstrap.zero();
  else
    full = bootstrap.run();
  started = true;
  if (!tolerance) return;
  tolerance->begin(full);
  make_integrator(h);
  if (full) tolerance->shorten_first_step();
}

void FixGearQuat::begin_step()
{
  const MotionLimits limits = blowup->limits(h);
  const auto check = [&](int ibody) {
    const BodyState &state = bodies->state[ibody];
    if (!limits.keep_velocities(state)) blowup->stop(ibody, state, h, atom->f);
  };
  for (const int ibody : bodies->points) {
    double *rows = bodies->history(ibody);
    integrator->predict_center(rows);
    integrator->center_state(bodies->body[ibody].rigid, rows, bodies->state[ibody]);
    check(ibody);
  }
  for (const int ibody : bodies->tops) {
    double *rows = bodies->history(ibody);
    integrator->predict(rows);
    bodies->state[ibody] = integrator->body_state(bodies->body[ibody].rigid, rows);
    check(ibody);
  }
  bodies->spread_states();
  bodies->place_sites(velocities_read);
}

void FixGearQuat::finish_step(double **f, double **torque)
{
  bodies->gather_loads(f, torque);
  if (evflag) tally_virial(f);

  if (isokinetic)
    correct_together(f);
  else
    masks->any() ? correct_bodies<true>(f) : correct_bodies<false>(f);
  bodies->spread_states();
  bodies->place_sites(true);
  if (output->next == update->ntimestep || modify->n_end_of_step > (tolerance ? 1 : 0))
    show_bodies();
}

/// MASKED: some components of the loads do not act.
template <bool MASKED> void FixGearQuat::correct_bodies(double **f)
{
  const MotionLimits limits = blowup->limits(h);
  const auto correct = [&](auto changing) {
    for (const int ibody : bodies->points) {
      correct_body<MASKED, true, changing>(ibody);
      if (!limits.keep(bodies->state[ibody])) blowup->stop(ibody, bodies->state[ibody], h, f);
    }
    for (const int ibody : bodies->tops) {
      correct_body<MASKED, false, changing>(ibody);
      if (!limits.keep(bodies->state[ibody])) blowup->stop(ibody, bodies->state[ibody], h, f);
    }
  };
  tolerance ? correct(std::true_type()) : correct(std::false_type());

  const int known = args->start == GearQuatArguments::Start::ZERO ? 2
                                                                  : 3;    // terms of a fresh body
  for (const int ibody : bodies->fresh) {
    blowup->check_load(ibody, h, f);
    GearQuatBootstrap::seed_body(*bodies, ibody, bodies->acting(ibody), present_scheme(), h, known);
    if (tolerance) tolerance->note_fresh();
  }
  bodies->take_in_fresh();
}

/// Under a constraint of all of them.
void FixGearQuat::correct_together(double **f)
{
  isokinetic->correct(*integrator);
  const MotionLimits limits = blowup->limits(h);
  for (int ibody = 0; ibody < bodies->nowned(); ++ibody)
    if (!limits.keep(bodies->state[ibody])) blowup->stop(ibody, bodies->state[ibody], h, f);
}

/// POINT: without moments of inertia.  CHANGING: the time step follows the error.
template <bool MASKED, bool POINT, bool CHANGING> void FixGearQuat::correct_body(int ibody)
{
  double *rows = bodies->history(ibody);
  const RigidBody &rigid = bodies->body[ibody].rigid;
  const Load load = MASKED ? bodies->acting(ibody) : bodies->load[ibody];
  BodyState &state = bodies->state[ibody];
  const BodyState before = state;
  Correction &last = bodies->last[ibody];
  if (CHANGING)
    last = tolerance->correct(*integrator, ibody, load);
  else
    last = POINT ? integrator->correct_center(rigid, load, rows)
                 : integrator->correct(rigid, load, rows);
  if (POINT)
    integrator->center_state(rigid, rows, state);
  else
    state = integrator->body_state(rigid, rows);
  if (MASKED) last.work = work_between(bodies->load[ibody], before, state);
}

/// With tolerance only: all fixes have finished the step.
void FixGearQuat::end_of_step()
{
  if (tolerance->choose()) make_integrator(h);
  tolerance->change_step();
}

/// Virial of the constraint forces m a - f, at the pose where the forces were taken.
void FixGearQuat::tally_virial(double **f)
{
  bodies->spread_loads();
  for (size_t n = bodies->first_arm(); n < bodies->sites.size(); ++n) {
    const auto &site = bodies->sites[n];
    double arm[3], constraint[3], virial_i[6];
    bodies->constraint_force(site, f, arm, constraint);
    for (int k = 0; k < 3; ++k) virial_i[k] = arm[k] * constraint[k];
    virial_i[3] = arm[0] * constraint[1];
    virial_i[4] = arm[0] * constraint[2];
    virial_i[5] = arm[1] * constraint[2];
    int i = site.atom;
    v_tally(1, &i, 1.0, virial_i);
  }
}

/* ----------------------------------------------------------------------
   r-RESPA with one step for all levels: forces are summed over the levels
------------------------------------------------------------------------- */

void FixGearQuat::initial_integrate_respa(int vflag, int ilevel, int /*iloop*/)
{
  const auto *levels = (int *) lammps_extract_global(lmp, "respa_levels");
  if (ilevel != *levels - 1) return;
  v_init(vflag);
  if (!started) {
    GearQuatBootstrap::gather_present_loads(lmp, this, *bodies);
    blowup->check_loads(h, atom->f);
    start();
  }
  begin_step();
}

void FixGearQuat::final_integrate_respa(int ilevel, int /*iloop*/)
{
  const auto *levels = (int *) lammps_extract_global(lmp, "respa_levels");
  if (ilevel == 0) {    // the first of a step; atoms were exchanged since it began
    if (atom->nmax > nmax_sum) {
      nmax_sum = atom->nmax;
      memory->destroy(f_sum);
      memory->destroy(torque_sum);
      memory->create(f_sum, nmax_sum, 3, "gear/quat:f_sum");
      if (atom->torque_flag) memory->create(torque_sum, nmax_sum, 3, "gear/quat:torque_sum");
    }
    std::fill_n(f_sum[0], 3 * (size_t) nmax_sum, 0.0);
    if (torque_sum) std::fill_n(torque_sum[0], 3 * (size_t) nmax_sum, 0.0);
  }
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = 0; k < 3; ++k) f_sum[i][k] += atom->f[i][k];
  if (torque_sum)
    for (int i = 0; i < atom->nlocal; ++i)
      for (int k = 0; k < 3; ++k) torque_sum[i][k] += atom->torque[i][k];
  if (ilevel == *levels - 1) finish_step(f_sum, torque_sum);
}

/* ----------------------------------------------------------------------
   outputs
------------------------------------------------------------------------- */

double FixGearQuat::compute_scalar()
{
  return sums->energy_correction();
}

double FixGearQuat::compute_vector(int n)
{
  const int further = n - GearQuatSums::ELEMENTS;
  if (further >= 0) return tolerance ? tolerance->element(further) : isokinetic->element(further);
  return sums->element(n, started ? integrator.get() : nullptr);
}

double FixGearQuat::compute_array(int i, int j)
{
  return table->global(i, j);
}

bigint FixGearQuat::dof(int tgroup)
{
  return bodies->removed_freedoms(group->bitmask[tgroup]);
}

double FixGearQuat::memory_usage()
{
  return bodies->memory_usage() + table->memory_usage() + 3.0 * nmax_sum * sizeof(double);
}

/* ----------------------------------------------------------------------
   per-atom data, forwarded to the body store
------------------------------------------------------------------------- */

void FixGearQuat::grow_arrays(int nmax)
{
  bodies->grow_arrays(nmax);
}

void FixGearQuat::copy_arrays(int i, int j, int delflag)
{
  bodies->copy_arrays(i, j, delflag);
}

/// A new atom: in no body, unless set_molecule() follows.
void FixGearQuat::set_arrays(int i)
{
  bodies->set_arrays(i);
  if (atom->mask[i] & groupbit) bodies->note_stranger(1);
}

/// Another fix has inserted a molecule of the template, on all ranks together.
void FixGearQuat::set_molecule(int first, tagint /*before*/, int /*which*/, double * /*center*/,
                               double * /*velocity*/, double * /*quat*/)
{
  for (int i = first; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) bodies->note_stranger(-1);
  add_molecule(lmp, *bodies, first);
}

void *FixGearQuat::extract(const char *name, int &dim)
{
  if (std::strcmp(name, "tolerance") == 0) {
    dim = 0;
    return tolerance ? &args->control.eps : nullptr;
  }
  return extracts->extract(name, dim);
}

int FixGearQuat::pack_exchange(int i, double *buf)
{
  return bodies->pack_exchange(i, buf);
}

int FixGearQuat::unpack_exchange(int nlocal, double *buf)
{
  return bodies->unpack_exchange(nlocal, buf);
}

int FixGearQuat::pack_forward_comm(int n, int *list, double *buf, int /*pbc_flag*/, int * /*pbc*/)
{
  return bodies->pack_forward(n, list, buf);
}

void FixGearQuat::unpack_forward_comm(int n, int first, double *buf)
{
  bodies->unpack_forward(n, first, buf);
}

int FixGearQuat::pack_reverse_comm(int n, int first, double *buf)
{
  return bodies->pack_reverse(n, first, buf);
}

void FixGearQuat::unpack_reverse_comm(int n, int *list, double *buf)
{
  bodies->unpack_reverse(n, list, buf);
}

/* ----------------------------------------------------------------------
   restart: the global part says what the histories are, the per-atom part holds them
------------------------------------------------------------------------- */

struct GlobalRestart {
  double formulation, values, compensate, started, h, extended, variable;
  GearQuatTolerance::Memory memory;
  GearQuatIsokinetic::Kept isokinetic;
};

void FixGearQuat::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  const Scheme &scheme = args->scheme;
  const GlobalRestart data = {(double) scheme.first(),
                              (double) scheme.values(),
                              (double) scheme.compensate,
                              (double) started,
                              h,
                              (double) bodies->has_extended(),
                              (double) scheme.trial,
                              tolerance ? tolerance->memory() : GearQuatTolerance::Memory(),
                              isokinetic ? isokinetic->keep() : GearQuatIsokinetic::Kept()};
  const int size = sizeof(data);
  fwrite(&size, sizeof(int), 1, fp);
  fwrite(&data, size, 1, fp);
}

/// All bodies in the format of keyword infile, beside the binary restart file.
void FixGearQuat::write_restart_file(const char *file)
{
  if (!met_atoms) return;    // the atoms may still be changed by the user
  show_bodies();
  write_given_bodies(lmp, fmt::format("{}.{}.gear_quat", file, id), id, *bodies, array_local);
}

/// Called before the per-atom data arrive: what the constructor made of the atoms is dropped.
void FixGearQuat::restart(char *buf)
{
  GlobalRestart data;
  std::memcpy(&data, buf, sizeof(data));
  bodies->clear(data.extended != 0.0);
  const Scheme &scheme = args->scheme;
  const bool same = data.formulation == (double) scheme.first() &&
      data.values == (double) scheme.values() && data.compensate == (double) scheme.compensate &&
      data.variable == (double) scheme.trial &&
      (isokinetic ? isokinetic->take(data.isokinetic)
                  : data.isokinetic.mode == (double) Isokinetic::NONE);
  started = data.started != 0.0 && same;
  if (tolerance && started) tolerance->recall(data.memory);
  met_atoms = true;
  h = data.h;
  if (data.started != 0.0 && !same && comm->me == 0)
    error->warning(
        FLERR,
        "Fix gear/quat: the restart file has histories of another formulation, another "
        "number of values or another isokinetic, or only one of the two runs has a tolerance; "
        "poses and velocities are kept, the higher derivatives start anew");
}

int FixGearQuat::pack_restart(int i, double *buf)
{
  const int n = 1 + bodies->pack_exchange(i, buf + 1);
  buf[0] = ubuf(n).d;
  return n;
}

void FixGearQuat::unpack_restart(int nlocal, int nth)
{
  const double *data = atom->extra[nlocal];
  for (int i = 0; i < nth; ++i) data += (int) ubuf(data[0]).i;
  bodies->unpack_exchange(nlocal, data + 1);
}

int FixGearQuat::size_restart(int i)
{
  return 1 + bodies->packed_size(i);
}

int FixGearQuat::maxsize_restart()
{
  return 1 + bodies->max_exchange();
}
