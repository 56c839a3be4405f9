/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_blowup.h"

#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double NONE = std::numeric_limits<double>::infinity();

static constexpr double NEARLY_LINEAR = 0.01;    // smallest moment by the largest
static constexpr bigint MANY = 10;               // least number of bodies that exchange energy
static constexpr double MARGIN = 0.6;    // of the longest step, since later forces may vary faster
static constexpr double TAIL = 4.0;      // ratio of the fastest thermal rotation to the mean

// a body is inaccurate if its error exceeds this part of its motion in a step; if more than this
// part of all bodies are inaccurate, the cause is not a single collision

static constexpr double INACCURATE = 0.03, WIDESPREAD = 0.1;

// forces that would require a step shorter by this factor are due to an overlap

static constexpr double OVERLAP = 0.01;

static constexpr char CENTRAL[] =
    "nearly all of its mass is at its center; give its outer atoms more mass, or state larger "
    "moments of inertia by an infile";
static constexpr char MEND[] = "or make the body linear by an infile with a smallest moment of 0";

/* ----------------------------------------------------------------------
   speed of the motion
------------------------------------------------------------------------- */

Pace GearQuat::pace_of(LAMMPS *lmp, const Bodies &bodies)
{
  const int dimension = lmp->domain->dimension;
  Pace pace;
  double here[6] = {};    // twice the kinetic energy, degrees of freedom, mass, force
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const BodyState &state = bodies.state_of(ibody);
    here[0] += 2.0 *
        (translational_energy(rigid, state.velocity) + rotational_energy(rigid, state.omega_body));
    here[1] += rigid.freedoms(dimension);
    here[2] += rigid.mass;
    add3(bodies.load_of(ibody).force, here + 3);
  }
  const auto all = over_ranks(MPI_SUM, here, lmp->world);
  if (bodies.number() < MANY || !(all[0] > 0.0)) return pace;
  pace.kt = all[0] / all[1];

  double fastest2 = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const Load &load = bodies.load_of(ibody);
    double force[3], torque_body[3];
    for (int k = 0; k < 3; ++k) force[k] = load.force[k] - rigid.mass * all[3 + k] / all[2];
    to_body(bodies.axes(ibody), load.torque_space, torque_body);
    fastest2 = std::max(fastest2, dot3(force, force) / rigid.mass);
    for (int k = 0; k < 3; ++k)
      if (rigid.turns_about(k, dimension))
        fastest2 = std::max(fastest2, torque_body[k] * torque_body[k] / rigid.inertia[k]);
  }
  pace.vibration = std::sqrt(over_ranks(MPI_MAX, fastest2, lmp->world) / pace.kt);
  if (!std::isfinite(pace.vibration)) pace.vibration = 0.0;
  return pace;
}

double Pace::longest_step(const Scheme &scheme) const
{
  return vibration > 0.0 ? MARGIN * fastest_oscillation(scheme) / vibration : NONE;
}

/* ----------------------------------------------------------------------
   rotations that are too fast, before the first step
------------------------------------------------------------------------- */

namespace {

/// Finds the axes of the smallest and of the largest moment about which bodies turn.  True only if
/// the smallest moment is tiny.
bool thin(const RigidBody &body, int dimension, int &smallest, int &largest)
{
  smallest = largest = 2;
  for (int k = 0; k < 3 && dimension == 3; ++k) {
    if (body.inertia[k] < body.inertia[smallest]) smallest = k;
    if (body.inertia[k] > body.inertia[largest]) largest = k;
  }
  return body.inertia[smallest] > 0.0 &&
      body.inertia[smallest] < NEARLY_LINEAR * body.inertia[largest];
}

/// The numbers in the message about a body that rotates too fast.
struct Lost {
  double moment, largest_moment, omega, longest_step;
  double central;    ///< 1 if nearly all of its mass is at its center
};

/// The fastest rotation among all bodies that rotate too fast.
struct Fastest {
  double omega = 0.0;
  tagint id = 0;
  double extent = 0.0;
  RigidBody rigid = RigidBody();
  BodyState state = BodyState();

  void compare(const Scheme &scheme, const Body &body, const BodyState &its_state, double h)
  {
    const double its_omega = length(its_state.omega_body);
    if (its_omega <= omega || std::fabs(h) * its_omega < FLIGHT_SLOW ||
        survives_flight(scheme, body.rigid, its_state, h))
      return;
    *this = {its_omega, body.id, body.extent, body.rigid, its_state};
  }
};

/// Finds the body over all ranks; returns its ID, 0 if there is none.  Collective.
tagint find_lost(LAMMPS *lmp, const Scheme &scheme, const Fastest &fastest, double h, Lost &lost)
{
  const double omega = over_ranks(MPI_MAX, fastest.omega, lmp->world);
  if (omega == 0.0) return 0;
  const tagint id =
      over_ranks(MPI_MAX, fastest.omega == omega ? fastest.id : (tagint) 0, lmp->world);
  Lost mine = Lost();
  if (fastest.id == id) {
    const RigidBody &rigid = fastest.rigid;
    int smallest, largest;
    const bool is_thin = thin(rigid, lmp->domain->dimension, smallest, largest);
    mine = {is_thin ? rigid.inertia[smallest] : 0.0, rigid.inertia[largest], omega,
            longest_step(scheme, rigid, fastest.state, h),
            double(rigid.inertia[largest] <
                   NEARLY_LINEAR * rigid.mass * fastest.extent * fastest.extent)};
  }
  constexpr size_t N = sizeof(Lost) / sizeof(double);
  reduce(MPI_SUM, reinterpret_cast<double *>(&mine), reinterpret_cast<double *>(&lost), N,
         lmp->world);
  return id;
}

/// The fastest rotation about an axis for bodies at this temperature.
double thermal_rotation(LAMMPS *lmp, const Bodies &bodies, double kt)
{
  double fastest2 = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    for (int k = 0; k < 3; ++k) {
      const RigidBody &rigid = bodies.rigid_of(ibody);
      if (rigid.turns_about(k, lmp->domain->dimension))
        fastest2 = std::max(fastest2, kt / rigid.inertia[k]);
    }
  return TAIL * std::sqrt(over_ranks(MPI_MAX, fastest2, lmp->world));
}

}    // namespace

// a body under forces follows fewer radians in a step than a free one, by this factor, and not more
// than this number

static constexpr double CLEAR_OF_FORCES = 0.8, UNDER_FORCES = 0.5;

void GearQuat::check_spins(LAMMPS *lmp, const Bodies &bodies, const Scheme &scheme,
                           const Pace &pace, double h)
{
  Fastest now, warm;    // now, and with their share of the energy
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body_at(ibody);
    BodyState state = bodies.state_of(ibody);
    int smallest, largest;
    now.compare(scheme, body, state, h);
    if (!thin(body.rigid, lmp->domain->dimension, smallest, largest)) continue;
    for (double &omega : state.omega_body) omega = 0.0;
    state.omega_body[smallest] = std::sqrt(pace.kt / body.rigid.inertia[smallest]);
    warm.compare(scheme, body, state, h);
  }
  Lost lost;
  const auto told = [&](tagint id, const char *turns) {
    std::string text = fmt::format("Fix gear/quat: body {} {} {:g}", id, turns, lost.omega);
    if (lost.moment > 0.0)
      text +=
          fmt::format(" about the axis of its smallest moment of inertia, {:g}, the largest being "
                      "{:g}",
                      lost.moment, lost.largest_moment);
    const double thermal = thermal_rotation(lmp, bodies, pace.kt);
    double step =
        std::min(CLEAR_OF_FORCES * std::fabs(lost.longest_step), UNDER_FORCES / lost.omega) *
        std::min(1.0, lost.omega / thermal);
    const double of_forces = pace.longest_step(scheme);
    if (of_forces > OVERLAP * step) step = std::min(step, of_forces);
    text += fmt::format(": {:g} radians in a step are more than {} values can follow; ",
                        lost.omega * std::fabs(h), scheme.values());
    if (lost.central > 0.0) return text + CENTRAL;
    text += fmt::format("use a time step of {:g} or shorter", rounded_down(step));
    if (lost.moment > 0.0) text += std::string(", ") + MEND;
    return text;
  };
  if (const tagint id = find_lost(lmp, scheme, now, h, lost)) {
    lmp->error->all(FLERR, told(id, "turns with an angular velocity of"));
  } else if (const tagint id = find_lost(lmp, scheme, warm, h, lost)) {
    const std::string text = told(id,
                                  "will turn, once it has its share of the kinetic energy, with an "
                                  "angular velocity of");
    if (lmp->comm->me == 0) lmp->error->warning(FLERR, text);
  }
}

/// Advice for a body that becomes unstable by this rotation, if it is nearly linear and turns about
/// its axis; otherwise empty.
static std::string advice_on_spin(const RigidBody &body, int dimension, const double *omega_body)
{
  int smallest, largest;
  if (!thin(body, dimension, smallest, largest)) return "";
  const double about = omega_body[smallest] * omega_body[smallest];
  if (!(2.0 * about > dot3(omega_body, omega_body))) return "";
  return fmt::format("; the body turns about the axis of its smallest moment of inertia, {:g}, the "
                     "largest being {:g}, {}",
                     body.inertia[smallest], body.inertia[largest], MEND);
}

/* ----------------------------------------------------------------------
   in a step
------------------------------------------------------------------------- */

void Blowup::check_loads(double h, double **f) const
{
  for (const auto *list : {&bodies.points, &bodies.tops, &bodies.fresh})
    for (const int ibody : *list) check_load(ibody, h, f);
}

void Blowup::check_load(int ibody, double h, double **f) const
{
  const BodyState after =
      kicked(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.load_of(ibody), h);
  if (!limits.keep_velocities(after)) stop(ibody, after, h, f);
}

void Blowup::stop(int ibody, const BodyState &s, double h, double **f) const
{
  const tagint id = bodies.body_at(ibody).id;
  const double time = update->atime + (update->ntimestep - update->atimestep) * update->dt;
  std::string molecule;
  int bad = -1;    // a site with a non-finite force
  for (const Site &site : sites) {
    if (site.body != ibody) continue;
    if (atom->molecule_flag && atom->molecule[site.atom] != id)
      molecule = fmt::format(" (molecule {})", atom->molecule[site.atom]);
    if (!std::isfinite(length(f[site.atom]))) bad = site.atom;
  }
  if (bodies.is_large(ibody)) ownership.tell_ids_to_ghosts();
  const Meeting met = nearest(ibody, bad);
  const Cause cause = first_cause(ibody, s, h);
  const std::string text = fmt::format(
      "Fix gear/quat: blow-up in step {}, time {:g}: body {}{} {}{}. {}. {}{}", update->ntimestep,
      time, id, molecule, what_happened(ibody, s, h), where(ibody, bad, met), cause.what,
      cause.remedy, advice_on_spin(bodies.rigid_of(ibody), domain->dimension, s.omega_body));
  if (bodies.is_large(ibody)) error->all(FLERR, agree(text, ibody, bad, met));
  error->one(FLERR, text);
}

/// All ranks find that a large body is unstable, each with its own sites.  Returns the text of the
/// rank whose site is nearest to another atom.
std::string Blowup::agree(const std::string &text, int ibody, int bad, const Meeting &met) const
{
  const bool any = std::any_of(sites.begin(), sites.end(), [&](const auto &site) {
    return site.body == ibody;
  });
  double here = NONE;
  if (any) here = std::min(met.distance2, std::numeric_limits<double>::max());
  if (bad >= 0) here = -1.0;
  const bool best = !(here > over_ranks(MPI_MIN, here, world));
  return broadcast(text, world, over_ranks(MPI_MIN, best ? comm->me : comm->nprocs, world));
}

/// The motion of this body is certainly unstable; the errors of the other bodies in the last step
/// show whether the step is too long for all bodies.
Cause Blowup::first_cause(int ibody, const BodyState &s, double h) const
{
  if (coupling) {
    const Cause cause = coupling->instability(h);
    if (!cause.what.empty()) return cause;
  }
  const std::string apart = known(PairFact::DISSIPATIVE, force) || known(PairFact::RANDOM, force)
      ? fmt::format("The friction of pair style {} may be too strong for the time step. ",
                    force->pair_style)
      : "Begin with atoms farther apart, for example after minimize or a run with keywords "
        "tolerance and temp. ";
  const Load &load = bodies.load_of(ibody);
  if (!std::isfinite(length(load.force) + length(load.torque_space)))
    return {"The forces became unstable first", apart + shorter_step(h)};
  const int others = inaccurate_bodies(ibody, h);
  if (others > 0 && others >= WIDESPREAD * (bodies.nmoved() - 1))
    return {fmt::format("The motion of the bodies became unstable first: {} other bodies on this "
                        "rank also have errors above {:g} % of their motion in the last step",
                        others, 100.0 * INACCURATE),
            shorter_step(h)};
  if (is_pushed(ibody, h))
    return {"The forces became unstable first: they alone move this body by more than its size, or "
            "turn it by more than a radian, in one step",
            apart + shorter_step(h)};
  return {"The motion of this body became unstable first", shorter_step(h)};
}

/// The number of other bodies whose error is a large part of their motion in the last step.
int Blowup::inaccurate_bodies(int ibody, double h) const
{
  int others = 0;
  for (int other = 0; other < bodies.nmoved(); ++other) {
    const Body &body = bodies.body_at(other);
    const BodyState &s = bodies.state_of(other);
    const double way = std::fabs(h) * (length(s.velocity) + body.reach() * length(s.omega_body));
    others += other != ibody && !(body.length(bodies.last_of(other)) <= INACCURATE * way);
  }
  return others;
}

/// True if the load alone moves the body far in a step.
bool Blowup::is_pushed(int ibody, double h) const
{
  const Body &body = bodies.body_at(ibody);
  BodyState still = bodies.state_of(ibody);
  for (int k = 0; k < 3; ++k) still.velocity[k] = still.omega_body[k] = 0.0;
  const BodyState after = kicked(body.rigid, still, bodies.load_of(ibody), h);
  const double way = std::fabs(h) * length(after.velocity);
  const double turn = std::fabs(h) * length(after.omega_body);
  return !(way <= body.reach() + std::fabs(h) * length(bodies.state_of(ibody).velocity)) ||
      !(turn <= 1.0);
}

std::string Blowup::shorter_step(double h) const
{
  const double size = std::fabs(h);
  if (size <= shortest)
    return fmt::format("Leave out dtmin, or use one much shorter than {:g}", shortest);
  if (scheme.remembers)
    return fmt::format("Use a smaller tolerance, or a dtmax shorter than {:g}", size);
  const double step = rounded_down(pace.longest_step(scheme));
  if (step < size && step > OVERLAP * size)
    return fmt::format("Use a time step of {:g} or shorter", step);
  return fmt::format("Halve the time step, {:g}, until the total energy is conserved", size);
}

/// Text for the limit that is exceeded; causes are tested before effects.
std::string Blowup::what_happened(int ibody, const BodyState &s, double h) const
{
  const Load &l = bodies.load_of(ibody);
  const double push = length(l.force) / force->ftm2v, twist = length(l.torque_space) / force->ftm2v;
  if (!std::isfinite(push)) return "meets a force that is not a finite number";
  if (!std::isfinite(twist)) return "meets a torque that is not a finite number";
  const std::string under = fmt::format("under a force of {:g} and a torque of {:g}", push, twist);
  if (!limits.keep_velocities(s))
    return fmt::format("moves by {:g} and turns by {:g} radians in one step, {}",
                       length(s.velocity) * std::fabs(h), length(s.omega_body) * std::fabs(h),
                       under);
  if (scheme.momentum()) return "turns faster than a step can follow, " + under;
  return fmt::format("has a quaternion of squared length {:g} instead of 1, {}", dot4(s.q, s.q),
                     under);
}

/// Text for a site with a non-finite force, or otherwise for the site nearest to another atom.
std::string Blowup::where(int ibody, int bad, const Meeting &met) const
{
  if (met.other < 0)
    return bad < 0 ? std::string()
                   : fmt::format("; the force on its atom {} is not a number", atom->tag[bad]);
  return fmt::format("; its atom {} is {:g} away from atom {}{}", atom->tag[met.site],
                     std::sqrt(met.distance2), atom->tag[met.other],
                     bad < 0 ? "" : ", and the force on it is not a number");
}

/// The site on this rank, or the one given, that is nearest to an atom of no or another body.
Blowup::Meeting Blowup::nearest(int ibody, int only) const
{
  Meeting found = {-1, -1, NONE};
  std::vector<int> others;    // along x, to examine only atoms that may be nearer
  for (int j = 0; j < atom->nlocal + atom->nghost; ++j)
    if (ownership.id_of(j) != bodies.body_at(ibody).id && std::isfinite(atom->x[j][0]))
      others.push_back(j);
  std::sort(others.begin(), others.end(), [this](int i, int j) {
    return atom->x[i][0] < atom->x[j][0];
  });

  for (const Site &site : sites) {
    if (site.body != ibody || (only >= 0 && site.atom != only)) continue;
    const double *x = atom->x[site.atom];
    const auto look = [&](int j) {    // false: this atom and all beyond are too far away
      const double *y = atom->x[j], d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
      if (dot3(d, d) < found.distance2) found = {site.atom, j, dot3(d, d)};
      return d[0] * d[0] < found.distance2;
    };
    const auto middle = std::partition_point(others.begin(), others.end(), [&](int j) {
      return atom->x[j][0] < x[0];
    });
    for (auto j = middle; j != others.end() && look(*j);) ++j;
    for (auto j = middle; j != others.begin() && look(*(j - 1));) --j;
  }
  return found;
}
