/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_step.h"

#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "modify.h"
#include "universe.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

Step::Step(const Scene &scene, const Fleet &fleet, Tally tally) :
    Scene(scene), time_step(lmp), bath(scene), fleet(fleet), present(args.scheme),
    tally(std::move(tally))
{
  if (args.control.eps > 0.0) tolerance = std::make_unique<Tolerance>(scene, time_step);
}

const Step *Fleet::find(const Fix *fix) const
{
  for (const Step *one : members)
    if (one->fix == fix) return one;
  return nullptr;
}

bool Fleet::moves(const Fix *fix, const Atom *atom, int i) const
{
  const Step *one = find(fix);
  return one ? one->ownership.in_body(i) : (atom->mask[i] & fix->groupbit) != 0;
}

/* ----------------------------------------------------------------------
   before a run
------------------------------------------------------------------------- */

void Step::meet_bodies()
{
  if (!args.masks.empty()) masks = args.masks_of(ownership.all_ids());
}

void Step::init()
{
  refuse_fixes();
  if (!had_run()) warn_of_noise();
  if (tolerance && utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR,
               "Fix gear/quat tolerance cannot be used with run_style respa, whose levels "
               "have different steps");
  for (const auto *other : modify->get_fix_list())
    if (tolerance && other != fix && (fleet.find(other) || known(Fact::TIME_STEP, other)))
      error->all(FLERR,
                 "Fix gear/quat tolerance cannot be used with fix {} ({}), which changes the time "
                 "step, too, or has histories of constant steps",
                 other->id, other->style);
  if (tolerance && started) tolerance->keep_step();
  follow_length();
}

void Step::forget(const std::string &why)
{
  if (started && comm->me == 0) utils::logmesg(lmp, why + "\n");
  started = false;
}

void Step::impose_masks()
{
  if (!ownership.change_masks(masks) || !started)
    return;    // only the scheme of a restart file may differ
  started = false;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: keywords force and torque turn off other components than in "
                   "the run that wrote the restart file; poses and velocities are kept, the "
                   "higher derivatives start anew");
}

void Step::begin_run()
{
  const double h = length();
  bath.begin_run(!started, tolerance ? std::min(h, bath.longest_step()) : h);
  if (update->nsteps > 0) note_rates(edge_rate * std::fabs(h));
  if (update->nsteps > 0 && !started) {    // before anything has changed
    find_limits(h);
    watch_all(atom->f);
  }
  phase = Phase::SET_UP;
}

/// After a run of no step, the next run may begin without a setup.
void Step::end_run()
{
  constexpr int SHORT = 100;
  if (started && update->nsteps >= SHORT) {
    note_rates(edge_rate * std::fabs(length()));
    warn_of_rates();
  }
  if (phase == Phase::CORRECTED) {    // LAMMPS has ended the run before its last step
    for (int ibody = 0; ibody < bodies.nmoved() && !reads_states(); ++ibody) {
      BodyState &state = bodies.state[ibody];
      integrator->body_state(bodies.body[ibody].rigid, bodies.history(ibody), state,
                             bodies.frame[ibody]);
      if (bath.moves_box()) bath.to_space(state);
    }
    place_correction();
  }
  if (phase == Phase::ENDED) phase = Phase::BETWEEN;
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Step::begin(int vflag, double **f)
{
  vflag_of_step = vflag;
  if (tolerance) tolerance->begin_step();
  if (tolerance) bath.keep();
  bath.take_random_half(*integrator, 0);
  predict(f);
  place_prediction();
  phase = Phase::BEGUN;
}

void Step::end(double **f, double **torque)
{
  watch_places();
  const bool is_placed = has_to_place();
  for (;;) {
    sites.gather_loads(f, torque);
    // here, since the atoms are at the positions of the forces
    if (bath.others_ask_for_virial()) tally(vflag_of_step, f);
    correct(f, is_placed || reads_states());
    if (!tolerance || tolerance->accepts()) break;
    shorten();
    predict(f);
    place_prediction();
    tolerance->evaluate(vflag_of_step);
  }
  accept(f);
  phase = Phase::CORRECTED;
  if (is_placed) place_correction();
}

void Step::choose_next()
{
  const double next = tolerance->choose(bath.longest_step());
  make_integrator();
  time_step.change(next);
  adopt_length();
}

/* ----------------------------------------------------------------------
   its parts
------------------------------------------------------------------------- */

void Step::predict(double **f)
{
  if (tolerance) {
    tolerance->prepare();
    make_integrator();
  }
  const double h = integrator->step();
  time_step.begin();
  find_limits(h);
  const bool may_repeat = tolerance && std::fabs(h) > args.control.shortest;
  const auto check = [&](int ibody) {
    const BodyState &state = bodies.state[ibody];
    if (!may_repeat && !limits.keep(state)) stop(ibody, state, h, f);
  };
  constexpr int WIDTH = Scheme::SECOND_WIDTH;    // with velocities of half a step before
  std::array<double, 2 * WIDTH> half;
  const bool verlet = scheme().is_verlet();
  const auto seen = [&half, verlet](const double *rows) {
    if (!verlet) return rows;
    std::copy_n(rows, 2 * WIDTH, half.begin());
    for (int i = WIDTH; i < 2 * WIDTH; ++i) half[i] -= rows[i + WIDTH];
    return (const double *) half.data();
  };
  for (const int ibody : bodies.points) {
    double *rows = bodies.history(ibody);
    integrator->predict_center(rows);
    integrator->center_state(bodies.body[ibody].rigid, seen(rows), bodies.state[ibody]);
    check(ibody);
  }
  for (size_t first = 0; first < bodies.tops.size();) {
    const Block block = block_of(bodies.tops, first, LANES);
    integrator->predict(block);
    if (verlet)
      for (int k = 0; k < block.count; ++k)
        integrator->body_state(*block.bodies[k], seen(block.rows[k]), *block.states[k],
                               *block.frames[k]);
    else
      integrator->find_states(block);
    for (int k = 0; k < block.count; ++k) check(bodies.tops[first + k]);
    first += block.count;
  }
  bath.predict(*integrator);
}

/// A shrink-wrapped box sets no limits.
void Step::find_limits(double h)
{
  constexpr int SHRINKS = 2;    // LAMMPS' boundary codes from this code on are shrink-wrapped
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int *faces = domain->boundary[k];
    const bool follows = faces[0] >= SHRINKS || faces[1] >= SHRINKS;
    longest = std::max(longest, follows ? HUGE_VAL : domain->prd[k]);
  }
  limits = MotionLimits(h, longest);
  if (tolerance && args.control.shortest == 0.0)    // turns are exact, and errors small
    limits.rate2 = HUGE_VAL;
}

void Step::place_prediction()
{
  ownership.spread_moved();
  sites.place(velocities_read);
}

/// Up to `most` bodies of a list; one with masks is alone.
Block Step::block_of(const std::vector<int> &list, size_t first, size_t most)
{
  Block block;
  const size_t end = std::min(list.size(), first + most);
  for (size_t n = first; n < end; ++n) {
    const int ibody = list[n], k = block.count;
    const Body &body = bodies.body[ibody];
    if (body.off && k > 0) break;
    block.bodies[k] = &body.rigid;
    block.rows[k] = bodies.history(ibody);
    block.states[k] = &bodies.state[ibody];
    block.frames[k] = &bodies.frame[ibody];
    block.loads[k] = &bodies.load[ibody];
    block.last[k] = &bodies.last[ibody];
    ++block.count;
    if (body.off) break;
  }
  return block;
}

/// Replaces the loads of a block where they are not those of the bodies.
void Step::scale(Block &block, const int *ids, Scaled &scaled) const
{
  const bool in_box = bath.moves_box();
  for (int k = 0; k < block.count && (in_box || bodies.body[*ids].off); ++k) {
    scaled.loads[k] = bath.scaled(bodies.acting(ids[k]));
    block.loads[k] = &scaled.loads[k];
    std::copy_n(block.rows[k], 3, scaled.centers[k]);
  }
}

/// states: they will be read, and are determined.
void Step::correct(double **f, bool states)
{
  if (bath.acts()) {
    bath.begin_correction(integrator->step());
    if (bath.needs_sums()) {
      for (const auto *list : {&bodies.points, &bodies.tops}) sum(*list);
      bath.find_friction(*integrator);
    }
  }
  correct<true>(bodies.points, f, states);
  correct<false>(bodies.tops, f, states);
  if (bath.acts()) bath.end_correction(*integrator);
  if (bath.acts() && states) watch_all(f);    // otherwise their predictions were tested
  if (bath.moves_box() && tolerance)
    tolerance->include({bath.error_of_box(args.control.energy, length())});
}

void Step::sum(const std::vector<int> &list)
{
  for (size_t first = 0; first < list.size();) {
    Block block = block_of(list, first, LANES);
    const int *const ids = &list[first];
    Scaled scaled;
    scale(block, ids, scaled);
    bath.add(*integrator, block, ids);
    first += block.count;
  }
}

template <bool ARE_POINTS> void Step::correct(const std::vector<int> &list, double **f, bool states)
{
  using Last = RememberedLoads::Last;
  const bool coupled = bath.acts(), has_flow = coupled && bath.has_flow();
  const size_t most = has_flow ? 1 : LANES;    // a body in a flow has a friction of its own
  for (size_t first = 0; first < list.size();) {
    Block block = block_of(list, first, most);
    const int *const ids = &list[first];
    const Body &body = bodies.body[*ids];
    const bool is_special = body.off || has_flow, masked = body.off && !bath.moves_box();
    const BodyState before = masked ? *block.states[0] : BodyState();
    Scaled scaled;
    scale(block, ids, scaled);
    Friction own;
    if (is_special && coupled) own = bath.friction_of(*ids);
    const Friction &friction = is_special ? own : bath.friction();
    if (tolerance) tolerance->note_prediction(block);
    if (ARE_POINTS)
      integrator->correct_centers(block, friction);
    else
      integrator->correct(block, friction);
    if (tolerance)
      tolerance->note_correction(*integrator, block, ids,
                                 coupled ? Last::KEPT : Last::INTEGRATED_AGAIN);
    first += block.count;
    if (!states && !masked) continue;
    if (!ARE_POINTS) integrator->find_states(block);
    for (int k = 0; ARE_POINTS && k < block.count; ++k)
      integrator->center_state(*block.bodies[k], block.rows[k], *block.states[k]);
    if (masked) block.last[0]->work = work_between(bodies.load[*ids], before, *block.states[0]);
    bath.place(block, ids, scaled.centers);
    for (int k = 0; k < block.count && !coupled && !tolerance; ++k) watch(ids[k], f);
  }
}

/// False if no output, fix or command reads the atoms before the next prediction replaces their
/// positions.  At forces, fixes read the prediction.
bool Step::has_to_place() const
{
  constexpr int AT_FORCES = FixConst::PRE_FORCE | FixConst::PRE_REVERSE | FixConst::POST_FORCE |
      FixConst::END_OF_STEP | FixConst::MIN_PRE_EXCHANGE | FixConst::MIN_PRE_NEIGHBOR |
      FixConst::MIN_POST_NEIGHBOR | FixConst::MIN_PRE_FORCE | FixConst::MIN_PRE_REVERSE |
      FixConst::MIN_POST_FORCE | FixConst::MIN_ENERGY;
  if (update->ntimestep == update->laststep || reads_at_end(lmp, fix)) return true;
  if (lmp->universe->nworlds > 1 || !utils::strmatch(update->integrate_style, "^verlet"))
    return true;
  for (int i = 0; i < modify->nfix; ++i) {
    const Fix *other = modify->fix[i];
    if (((modify->fmask[i] & ~AT_FORCES) && !fleet.find(other)) ||
        utils::strmatch(other->style, "^event"))
      return true;
  }
  return false;
}

/// Atoms get the corrected states.
void Step::place_correction()
{
  ownership.spread_moved();
  sites.place(true);
  if (reads_at_end(lmp, fix)) comm->forward_comm();    // ghosts are where forces were evaluated
  phase = Phase::ENDED;
}

/// Restores the histories to the beginning of the step, for another try.
void Step::shorten()
{
  bodies.put_back_histories();
  bath.put_back();
  tolerance->shorten();
  make_integrator();
  adopt_length();
  bodies.keep_histories();
  bath.keep();
}

/// Histories of bodies inserted in this step start with the known derivatives.
void Step::accept(double **f)
{
  const double h = integrator->step();
  if (tolerance) watch_all(f);    // otherwise correct() has done this
  bath.note_step(h);
  const int known = args.start == Arguments::Start::ZERO ? 2 : 3;
  for (const int ibody : bodies.fresh) {
    watch_load(ibody, f);
    seed(ibody, known);
  }
  if (!bodies.fresh.empty()) bodies.take_in_fresh();
  bath.follow_changes(h);
  bath.take_random_half(*integrator, 1);
}

/// Tests a corrected state.
inline void Step::watch(int ibody, double **f) const
{
  const BodyState &state = bodies.state[ibody];
  if (!limits.keep(state)) stop(ibody, state, integrator->step(), f);
}

void Step::watch_all(double **f) const
{
  bodies.for_moved([&](int ibody) {
    watch(ibody, f);
  });
}

/* ----------------------------------------------------------------------
   the length of the step
------------------------------------------------------------------------- */

void Step::make_integrator()
{
  integrator = std::make_unique<Integrator>(tolerance ? tolerance->integrator()
                                                      : Integrator(scheme(), length()));
}

void Step::set_scheme(const Scheme &scheme)
{
  present = scheme;
  bodies.set_scheme(scheme);
  bath.set_scheme(scheme);
  if (length() != 0.0) make_integrator();
}

void Step::follow_length()
{
  if (!tolerance || !started) adopt_length();    // otherwise LAMMPS' length will be restored
}

void Step::adopt_length()
{
  const double ratio = time_step.follow();
  if (ratio == 0.0) return;
  if (integrator)
    integrator->set_step(length());
  else
    make_integrator();
  if (!started) return;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    integrator->rescale(bodies.history(ibody), ratio);
  bath.rescale(ratio);
}
