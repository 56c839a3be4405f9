/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_spins.h"

#include "gear_quat_bodies.h"
#include "gear_quat_flight.h"

#include "comm.h"
#include "error.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr double NEARLY_LINEAR = 0.01;    // smallest moment by the largest
static constexpr bigint MANY = 10;               // bodies that share their energy
static constexpr char MEND[] = "or make the body linear by an infile with a smallest moment of 0";

namespace {

/// Finds the axes of the smallest and of the largest moment.  False unless the smallest one is tiny.
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
  if (std::fabs(h) * std::sqrt(dot3(state.omega_body, state.omega_body)) < FLIGHT_SLOW)
    return false;
  if (survives_flight(scheme, body, state, h)) return false;
  int smallest, largest;
  const bool is_thin = thin(body, smallest, largest);
  lost = {is_thin ? body.inertia[smallest] : 0.0, body.inertia[largest],
          std::sqrt(dot3(state.omega_body, state.omega_body)),
          longest_step(scheme, body, state, h)};
  return true;
}

}    // namespace

void GearQuat::check_spins(LAMMPS *lmp, const Bodies &bodies, const Scheme &scheme, double h)
{
  double energy[2] = {0.0, 0.0}, all_energy[2];    // twice the kinetic one, degrees of freedom
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.body[ibody].rigid;
    const BodyState &state = bodies.state_of(ibody);
    energy[0] += 2.0 *
        (translational_energy(rigid, state.velocity) + rotational_energy(rigid, state.omega_body));
    energy[1] += 3.0 + rigid.rotational_freedoms();
  }
  MPI_Allreduce(energy, all_energy, 2, MPI_DOUBLE, MPI_SUM, lmp->world);
  const double share = bodies.number() < MANY ? 0.0 : all_energy[0] / all_energy[1];

  // the body with the smallest ID, of those lost as they are (0) and of those that will be (1)

  tagint id[2] = {MAXTAGINT, MAXTAGINT}, all_id[2];
  Lost lost[2] = {}, all_lost[2];
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body[ibody];
    int smallest, largest;
    if (body.id < id[0] && is_lost(scheme, body.rigid, bodies.state_of(ibody), h, lost[0]))
      id[0] = body.id;
    if (body.id > id[1] || !thin(body.rigid, smallest, largest)) continue;
    BodyState warm = bodies.state_of(ibody);
    for (double &omega : warm.omega_body) omega = 0.0;
    warm.omega_body[smallest] = std::sqrt(share / body.rigid.inertia[smallest]);
    if (is_lost(scheme, body.rigid, warm, h, lost[1])) id[1] = body.id;
  }
  MPI_Allreduce(id, all_id, 2, MPI_LMP_TAGINT, MPI_MIN, lmp->world);
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

std::string GearQuat::advice_on_spin(const RigidBody &body, const double *omega_body)
{
  int smallest, largest;
  if (!thin(body, smallest, largest)) return "";
  const double about = omega_body[smallest] * omega_body[smallest];
  if (!(2.0 * about > dot3(omega_body, omega_body))) return "";
  return fmt::format(", for it turns about the axis of its smallest moment of inertia, {:g}, the "
                     "largest being {:g}; {},",
                     body.inertia[smallest], body.inertia[largest], MEND);
}
