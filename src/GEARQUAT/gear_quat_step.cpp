/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_step.h"

#include "gear_quat_barostat.h"
#include "gear_quat_isokinetic.h"
#include "gear_quat_start.h"

#include "comm.h"
#include "domain.h"
#include "output.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

/// With remembered loads the box and the limits of frictions are those of a constant order.
static Scheme scheme_of_coupling(Scheme scheme)
{
  if (!scheme.remembers) return scheme;
  scheme.formulation = Formulation::SECOND;
  scheme.rows = SECOND_PAPER;
  scheme.passes = 2;
  return scheme;
}

/// The keywords exclude two couplings, and a coupling with a changing step if it does not support
/// one.
std::unique_ptr<Coupling> GearQuat::make_coupling(LAMMPS *lmp, const Fix *fix,
                                                  const Arguments &args, Bodies &bodies,
                                                  const Sites &sites)
{
  if (args.pressure.any())
    return std::make_unique<Barostat>(lmp, fix, bodies, sites, args.thermostat, args.pressure,
                                      scheme_of_coupling(args.scheme));
  if (args.isokinetic != Isokinetic::NONE)
    return std::make_unique<IsokineticConstraint>(lmp, bodies, args.scheme, args.isokinetic,
                                                  args.rescale);
  if (args.thermostat.damp > 0.0)
    return std::make_unique<Thermostat>(lmp, fix, bodies, args.thermostat,
                                        scheme_of_coupling(args.scheme));
  return nullptr;
}

Step::Step(LAMMPS *lmp, const Fix *fix, const Arguments &args, const Fleet &fleet, Bodies &bodies,
           Ownership &ownership, Sites &sites, OtherFixes &others, Tally tally) :
    Pointers(lmp),
    time_step(lmp), blowup(lmp, bodies, ownership, sites, present, args.control.shortest),
    coupling(make_coupling(lmp, fix, args, bodies, sites)), args(args), present(args.scheme),
    bodies(bodies), ownership(ownership), sites(sites), others(others), tally(std::move(tally))
{
  blowup.coupling = coupling.get();
  if (args.control.eps > 0.0)
    tolerance = std::make_unique<Tolerance>(lmp, fix, args.scheme, args.control, args.every_time,
                                            fleet, bodies, time_step);
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Step::begin(int vflag, double **f)
{
  vflag_of_step = vflag;
  check_other_fixes();
  if (tolerance) tolerance->begin_step();
  if (tolerance && coupling) coupling->keep();
  predict(f);
  place_prediction();
  within = true;
}

void Step::end(double **f, double **torque)
{
  others.check_places();
  within = false;
  for (;;) {
    gather(f, torque);
    // here, since the atoms are at the positions of the forces
    if (!coupling || coupling->others_ask_for_virial()) tally(vflag_of_step, f);
    correct(f);
    if (is_accepted()) break;
    shorten();
    predict(f);
    place_prediction();
    tolerance->evaluate(vflag_of_step);
  }
  hold(f);
  if (bodies.have_copies()) ownership.spread_moved();
  sites.place(true);
  if (is_due(readers.of_atoms)) comm->forward_comm();    // ghosts are where forces were evaluated
}

void Step::gather(double **f, double **torque)
{
  sites.gather_loads(f, torque);
  if (coupling) coupling->meet_virial(f);
}

void Step::choose_next()
{
  const double next = tolerance->choose(coupling ? coupling->longest_step() : HUGE_VAL);
  make_integrator();
  time_step.change(next);
  tolerance->order_output();
}

/* ----------------------------------------------------------------------
   its parts
------------------------------------------------------------------------- */

/// In the first step of a run with `pre no` bodies have not been compared with their atoms yet.
void Step::check_other_fixes()
{
  others.check_velocities(update->ntimestep == update->firststep + 1 && !compared);
  compared = false;
}

void Step::predict(double **f)
{
  if (tolerance) {
    tolerance->prepare();
    make_integrator();
  }
  const double h = integrator->step();
  time_step.begin();
  find_limits(h);
  const auto check = [&](int ibody) {
    const BodyState &state = bodies.state_of(ibody);
    if (!tolerance && !blowup.limits.keep_velocities(state)) blowup.stop(ibody, state, h, f);
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
    integrator->center_state(bodies.rigid_of(ibody), seen(rows), bodies.change_state(ibody));
    check(ibody);
  }
  for (size_t first = 0; first < bodies.tops.size(); first += Turn::LANES) {
    const RigidBody *rigid[Turn::LANES];
    double *rows[Turn::LANES];
    const int count = std::min(bodies.tops.size() - first, (size_t) Turn::LANES);
    for (int k = 0; k < count; ++k) {
      rigid[k] = &bodies.rigid_of(bodies.tops[first + k]);
      rows[k] = bodies.history(bodies.tops[first + k]);
    }
    integrator->predict(count, rigid, rows);
  }
  for (const int ibody : bodies.tops) {
    integrator->body_state(bodies.rigid_of(ibody), seen(bodies.history(ibody)),
                           bodies.change_state(ibody), bodies.change_frame(ibody));
    check(ibody);
  }
  if (coupling) coupling->predict(*integrator);
}

void Step::place_prediction()
{
  if (bodies.have_copies()) ownership.spread_moved();
  sites.place(velocities_read);
}

void Step::correct(double **f)
{
  if (coupling)
    correct_together();
  else
    args.masks.empty() ? correct_bodies<false>(f) : correct_bodies<true>(f);
}

/// MASKED: some components of the loads are turned off.
template <bool MASKED> void Step::correct_bodies(double **f)
{
  const auto correct_all = [&](auto changing) {
    for (const int ibody : bodies.points) correct_body<MASKED, true, changing>(ibody, f);
    for (const int ibody : bodies.tops) correct_body<MASKED, false, changing>(ibody, f);
  };
  tolerance ? correct_all(std::true_type()) : correct_all(std::false_type());
}

/// POINT: without moments of inertia.  CHANGING: the time step adapts to the error.
template <bool MASKED, bool POINT, bool CHANGING> void Step::correct_body(int ibody, double **f)
{
  double *rows = bodies.history(ibody);
  const RigidBody &rigid = bodies.rigid_of(ibody);
  const Load masked = MASKED ? bodies.acting(ibody) : Load();
  const Load &load = MASKED ? masked : bodies.load_of(ibody);
  BodyState &state = bodies.change_state(ibody);
  const BodyState before = MASKED ? state : BodyState();
  Correction &last = bodies.change_last(ibody);
  if (CHANGING)
    last = tolerance->correct(*integrator, ibody, load);
  else
    last = POINT ? integrator->correct_center(rigid, load, rows)
                 : integrator->correct(rigid, load, bodies.axes(ibody), rows);
  if (POINT)
    integrator->center_state(rigid, rows, state);
  else
    integrator->body_state(rigid, rows, state, bodies.change_frame(ibody));
  if (MASKED) last.work = work_between(bodies.load_of(ibody), before, state);
  if (!CHANGING) examine(ibody, f);
}

void Step::correct_together()
{
  if (tolerance) tolerance->note_prediction();
  coupling->correct(*integrator, scheme().coupled_passes());
  if (tolerance) tolerance->note_correction(*integrator, *coupling);
}

/// Without step control every step is accepted.
bool Step::is_accepted()
{
  return !tolerance || tolerance->accepts();
}

/// Restores the histories to the beginning of the step, for another try.
void Step::shorten()
{
  bodies.put_back_histories();
  if (coupling) coupling->put_back();
  tolerance->shorten_loads();
  make_integrator();
  tolerance->shorten_step();
  bodies.keep_histories();
  if (coupling) coupling->keep();
}

/// Accepts the step.
void Step::hold(double **f)
{
  if (tolerance || coupling) {    // otherwise correct_body() has done this
    for (const auto *list : {&bodies.points, &bodies.tops})
      for (const int ibody : *list) examine(ibody, f);
  }
  if (coupling) coupling->note_step(integrator->step());
  begin_fresh(f);
}

/// Histories of bodies inserted in this step start with the known derivatives.
void Step::begin_fresh(double **f)
{
  const int known = args.start == Arguments::Start::ZERO ? 2 : 3;
  for (const int ibody : bodies.fresh) {
    blowup.check_load(ibody, integrator->step(), f);
    seed_body(bodies, ibody, scaled_of(bodies, coupling.get(), ibody), acting(ibody), scheme(),
              integrator->step(), known);
  }
  if (!bodies.fresh.empty()) bodies.take_in_fresh();
  if (coupling) coupling->follow_changes(integrator->step());
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
  blowup.limits = MotionLimits(h, longest);
  if (tolerance && args.control.shortest == 0.0)    // turns are exact, and errors small
    blowup.limits.rate2 = HUGE_VAL;
}

/// Tests a corrected state.
inline void Step::examine(int ibody, double **f)
{
  const BodyState &state = bodies.state_of(ibody);
  if (!blowup.limits.keep(state)) blowup.stop(ibody, state, integrator->step(), f);
}

void Step::check_loads(double **f)
{
  find_limits(length());
  blowup.check_loads(length(), f);
}

bool Step::shows_local_data() const
{
  return is_due(readers.of_local_data);
}

/// True if output is due in this step, or if the step is a multiple of one of the periods.
bool Step::is_due(const std::vector<int> &periods) const
{
  const bigint now = update->ntimestep;
  return output->next == now || std::any_of(periods.begin(), periods.end(), [now](int period) {
           return now % period == 0;
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

void Step::set_coupling(std::unique_ptr<Coupling> other)
{
  coupling = std::move(other);
  blowup.coupling = coupling.get();
}

void Step::set_scheme(const Scheme &scheme)
{
  present = scheme;
  bodies.set_scheme(scheme);
  ownership.extended().set_scheme(scheme);
  if (coupling) coupling->set_scheme(scheme);
  if (length() != 0.0) make_integrator();
}

void Step::follow_length()
{
  if (tolerance && started && !time_step.is_changing()) return;    // it will be restored
  const double ratio = time_step.follow();
  if (ratio == 0.0) return;
  if (integrator)
    integrator->set_step(length());
  else
    make_integrator();
  if (!started) return;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
    integrator->rescale(bodies.history(ibody), ratio);
  if (coupling) coupling->rescale(ratio);
}
