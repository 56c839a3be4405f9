/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_blowup.h"

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

/// Codes of LAMMPS from this one on mean faces that follow the atoms.
static constexpr int SHRINKS = 2;

static constexpr double NEARLY_LINEAR = 0.01;    // smallest moment by the largest
static constexpr bigint MANY = 10;               // bodies that share their energy
static constexpr char MEND[] = "or make the body linear by an infile with a smallest moment of 0";

/* ----------------------------------------------------------------------
   rotations that are too fast, before the first step
------------------------------------------------------------------------- */

namespace {

/// Finds the axes of the smallest and of the largest moment.  False unless the smallest one is
/// tiny.
bool thin(const RigidBody &body, int &smallest, int &largest)
{
  smallest = largest = 0;
  for (int k = 1; k < 3; ++k) {
    if (body.inertia[k] < body.inertia[smallest]) smallest = k;
    if (body.inertia[k] > body.inertia[largest]) largest = k;
  }
  return body.inertia[smallest] > 0.0 &&
      body.inertia[smallest] < NEARLY_LINEAR * body.inertia[largest];
}

/// The numbers in the message about a body that rotates too fast.
struct Lost {
  double moment, largest_moment, omega, longest_step;
};

bool is_lost(const Scheme &scheme, const RigidBody &body, const BodyState &state, double h,
             Lost &lost)
{
  const double omega = length(state.omega_body);
  if (std::fabs(h) * omega < FLIGHT_SLOW || survives_flight(scheme, body, state, h)) return false;
  int smallest, largest;
  const bool is_thin = thin(body, smallest, largest);
  lost = {is_thin ? body.inertia[smallest] : 0.0, body.inertia[largest], omega,
          longest_step(scheme, body, state, h)};
  return true;
}

}    // namespace

void GearQuat::check_spins(LAMMPS *lmp, const Bodies &bodies, const Scheme &scheme, double h)
{
  double energy[2] = {0.0, 0.0};    // twice the kinetic one, degrees of freedom
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.rigid_of(ibody);
    const BodyState &state = bodies.state_of(ibody);
    energy[0] += 2.0 *
        (translational_energy(rigid, state.velocity) + rotational_energy(rigid, state.omega_body));
    energy[1] += 3.0 + rigid.rotational_freedoms();
  }
  const auto all_energy = over_ranks(MPI_SUM, energy, lmp->world);
  const double share = bodies.number() < MANY ? 0.0 : all_energy[0] / all_energy[1];

  // the body with the smallest ID, of those lost as they are (0) and of those that will be (1)

  tagint id[2] = {MAXTAGINT, MAXTAGINT};
  Lost lost[2] = {}, all_lost[2];
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body_at(ibody);
    int smallest, largest;
    if (body.id < id[0] && is_lost(scheme, body.rigid, bodies.state_of(ibody), h, lost[0]))
      id[0] = body.id;
    if (body.id > id[1] || !thin(body.rigid, smallest, largest)) continue;
    BodyState warm = bodies.state_of(ibody);
    for (double &omega : warm.omega_body) omega = 0.0;
    warm.omega_body[smallest] = std::sqrt(share / body.rigid.inertia[smallest]);
    if (is_lost(scheme, body.rigid, warm, h, lost[1])) id[1] = body.id;
  }
  const auto all_id = over_ranks(MPI_MIN, id, lmp->world);
  for (int which = 0; which < 2; ++which)
    if (id[which] != all_id[which]) lost[which] = Lost();
  MPI_Allreduce(lost, all_lost, 8, MPI_DOUBLE, MPI_SUM, lmp->world);

  const auto told = [&](int which, const char *turns) {
    const Lost &one = all_lost[which];
    std::string text =
        fmt::format("Fix gear/quat: body {} {} {:g}", all_id[which], turns, one.omega);
    if (one.moment > 0.0)
      text +=
          fmt::format(" about the axis of its smallest moment of inertia, {:g}, the largest being "
                      "{:g}",
                      one.moment, one.largest_moment);
    text +=
        fmt::format(": {:g} radians in a step are more than {} values can follow; use a time step "
                    "of {:g} or shorter or fewer values",
                    one.omega * std::fabs(h), scheme.values(), one.longest_step);
    if (one.moment > 0.0) text += std::string(", ") + MEND;
    return text;
  };
  if (all_id[0] < MAXTAGINT)
    lmp->error->all(FLERR, told(0, "turns with an angular velocity of"));
  else if (all_id[1] < MAXTAGINT && lmp->comm->me == 0)
    lmp->error->warning(FLERR,
                        told(1,
                             "will turn, once it has its share of the kinetic energy, with "
                             "an angular velocity of"));
}

/// What to do about a body that is lost while it turns so, if it is nearly linear and turns about
/// its axis; else empty.
static std::string advice_on_spin(const RigidBody &body, const double *omega_body)
{
  int smallest, largest;
  if (!thin(body, smallest, largest)) return "";
  const double about = omega_body[smallest] * omega_body[smallest];
  if (!(2.0 * about > dot3(omega_body, omega_body))) return "";
  return fmt::format(", for it turns about the axis of its smallest moment of inertia, {:g}, the "
                     "largest being {:g}; {},",
                     body.inertia[smallest], body.inertia[largest], MEND);
}

/* ----------------------------------------------------------------------
   in a step
------------------------------------------------------------------------- */

MotionLimits Blowup::limits(double h) const
{
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int *faces = domain->boundary[k];
    const bool follows = faces[0] >= SHRINKS || faces[1] >= SHRINKS;
    longest = std::max(longest, follows ? NONE : domain->prd[k]);
  }
  return MotionLimits(h, longest);
}

void Blowup::check_loads(double h, double **f) const
{
  for (const auto *list : {&bodies.points, &bodies.tops, &bodies.fresh})
    for (const int ibody : *list) check_load(ibody, h, f);
}

void Blowup::check_load(int ibody, double h, double **f) const
{
  const BodyState after =
      kicked(bodies.rigid_of(ibody), bodies.state_of(ibody), bodies.load_of(ibody), h);
  if (!limits(h).keep_velocities(after)) stop(ibody, after, h, f);
}

void Blowup::stop(int ibody, const BodyState &s, double h, double **f) const
{
  const tagint id = bodies.body_at(ibody).id;
  const double time = update->atime + (update->ntimestep - update->atimestep) * update->dt;
  std::string molecule;
  int bad = -1;    // a site on which the force is no number
  for (const auto &site : bodies.sites) {
    if (site.body != ibody) continue;
    if (atom->molecule_flag && atom->molecule[site.atom] != id)
      molecule = fmt::format(" (molecule {})", atom->molecule[site.atom]);
    if (!std::isfinite(length(f[site.atom]))) bad = site.atom;
  }
  if (bodies.is_large(ibody)) bodies.tell_ids_to_ghosts();
  const Meeting met = nearest(ibody, bad);
  const std::string change = std::fabs(h) <= shortest
      ? fmt::format("a dtmin smaller than {:g},", shortest)
      : scheme.trial
      ? fmt::format("a smaller tolerance, or a dtmax shorter than {:g},", std::fabs(h))
      : fmt::format("a smaller time step than {:g} or fewer values than {},", std::fabs(h),
                    scheme.values());
  const std::string text = fmt::format(
      "Fix gear/quat: blow-up in step {}, time {:g}: body {}{} {}{}. Use {}{} or "
      "begin with atoms further apart",
      update->ntimestep, time, id, molecule, what_happened(ibody, s, h), where(ibody, bad, met),
      change, advice_on_spin(bodies.rigid_of(ibody), s.omega_body));
  if (bodies.is_large(ibody)) error->all(FLERR, agree(text, ibody, bad, met));
  error->one(FLERR, text);
}

/// All ranks notice that a large body is unstable, each with its own sites.  Returns the text of
/// the rank whose site is nearest to another atom.
std::string Blowup::agree(const std::string &text, int ibody, int bad, const Meeting &met) const
{
  const bool any = std::any_of(bodies.sites.begin(), bodies.sites.end(), [&](const auto &site) {
    return site.body == ibody;
  });
  struct {
    double distance2;
    int rank;
  } here = {NONE, comm->me}, best;
  if (any) here.distance2 = std::min(met.distance2, std::numeric_limits<double>::max());
  if (bad >= 0) here.distance2 = -1.0;
  MPI_Allreduce(&here, &best, 1, MPI_DOUBLE_INT, MPI_MINLOC, world);
  return broadcast(text, world, best.rank);
}

/// Says which limit is exceeded; the cause comes before its effects.
std::string Blowup::what_happened(int ibody, const BodyState &s, double h) const
{
  const Load &l = bodies.load_of(ibody);
  const double push = length(l.force) / force->ftm2v, twist = length(l.torque_space) / force->ftm2v;
  if (!std::isfinite(push)) return "meets a force that is not a finite number";
  if (!std::isfinite(twist)) return "meets a torque that is not a finite number";
  const std::string under = fmt::format("under a force of {:g} and a torque of {:g}", push, twist);
  if (!limits(h).keep_velocities(s))
    return fmt::format("moves by {:g} and turns by {:g} radians in one step, {}",
                       length(s.velocity) * std::fabs(h), length(s.omega_body) * std::fabs(h),
                       under);
  return fmt::format("has a quaternion of squared length {:g} instead of 1, {}", dot4(s.q, s.q),
                     under);
}

/// A site on which the force is no number, or else the one that is nearest to another atom.
std::string Blowup::where(int ibody, int bad, const Meeting &met) const
{
  if (met.other < 0)
    return bad < 0 ? std::string()
                   : fmt::format("; the force on its atom {} is no number", atom->tag[bad]);
  return fmt::format("; its atom {} is {:g} away from atom {}{}", atom->tag[met.site],
                     std::sqrt(met.distance2), atom->tag[met.other],
                     bad < 0 ? "" : ", and the force on it is no number");
}

/// Of the sites here, or of the one asked for, the nearest to an atom that is not of this body.
Blowup::Meeting Blowup::nearest(int ibody, int only) const
{
  Meeting found = {-1, -1, NONE};
  std::vector<int> others;    // along x: only those are looked at that may be nearer
  for (int j = 0; j < atom->nlocal + atom->nghost; ++j)
    if (bodies.id_of(j) != bodies.body_at(ibody).id && std::isfinite(atom->x[j][0]))
      others.push_back(j);
  std::sort(others.begin(), others.end(), [this](int i, int j) {
    return atom->x[i][0] < atom->x[j][0];
  });

  for (const auto &site : bodies.sites) {
    if (site.body != ibody || (only >= 0 && site.atom != only)) continue;
    const double *x = atom->x[site.atom];
    const auto look = [&](int j) {    // false: this atom and those beyond are too far away
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
