/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_temperature.h"

#include "gear_quat_box.h"
#include "gear_quat_ranks.h"
#include "gear_quat_styles.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

// a kinetic energy smaller than this part of the subtracted energy is due to rounding

static constexpr double ROUNDING_OF_ENERGY = 1.0e-13;

// exact sums represent terms up to 2^20 units, also of a fast common motion

static constexpr double LARGE_MOMENTA = 1024.0;    // 2^10

/* ---------------------------------------------------------------------- */

Temperature::Temperature(const Scene &scene) :
    Scene(scene), words(args.thermostat),
    start(words.damp > 0.0 ? words.start : args.pressure.temperature),
    stop(words.damp > 0.0 ? words.stop : args.pressure.temperature), wanted{1.0,
                                                                            1.0,
                                                                            args.pressure.any(),
                                                                            {}}
{
}

void Temperature::begin_run(bool anew)
{
  if (anew && start == 0.0) find_start();
  if (update->nsteps > 0 || line.kt == 0.0) aim(update->ntimestep);
  count();
  sum_present();
}

/// The temperature of the bodies when the box starts to move.
void Temperature::find_start()
{
  double here[2] = {0.0, 0.0};
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.body[ibody].rigid;
    const BodyState &s = bodies.state[ibody];
    here[0] += 2.0 * translational_energy(rigid, s.velocity) +
        2.0 * rotational_energy(rigid, s.omega_body);
    here[1] += rigid.freedoms(domain->dimension);
  }
  const auto all = over_ranks(MPI_SUM, here, world);
  if (!(all[0] > 0.0))
    error->all(FLERR,
               "Fix gear/quat: the mass of the box needs a temperature, and the bodies have "
               "none; give them velocities first, or add keyword ptemp");
  start = stop = all[0] / all[1] * force->mvv2e / force->boltz;
}

void Temperature::aim(bigint step)
{
  const double per_degree = force->boltz / force->mvv2e;
  const bigint steps = update->endstep - update->beginstep;
  line = {per_degree * start, 0.0};
  if (steps <= 0) return;
  line.kt_step = per_degree * (stop - start) / steps;
  line.kt += line.kt_step * (step - update->beginstep);
}

ChainTarget Temperature::target(double of_freedoms, double period, double steps_ahead,
                                double h) const
{
  return {line.kt + line.kt_step * steps_ahead, h == 0.0 ? 0.0 : line.kt_step / h, of_freedoms,
          period};
}

/* ----------------------------------------------------------------------
   degrees of freedom, and the common motion
------------------------------------------------------------------------- */

std::string Temperature::find_outside() const
{
  if (words.is_random()) return "keyword langevin exerts random forces";
  if (has_flow()) return "fix deform moves the faces of the box";
  bigint here = 0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) here += bodies.body[ibody].natoms;
  const bigint others = atom->natoms - over_ranks(MPI_SUM, here, world);
  if (others > 0) return fmt::format("{} atoms are in no body of this fix", others);
  const auto with_forces = fixes_with_forces(lmp, fix);
  if (!with_forces.empty()) return name_of(with_forces.front()) + " may exert forces";
  if (words.takes_in) return "keyword mol takes in bodies that other fixes insert";
  for (const auto *other : modify->get_fix_list())
    if (known(Fact::EXCHANGE, other)) return name_of(other) + " may insert atoms";
  if (known_pair(Fact::BACKGROUND, lmp->force))
    return std::string("pair style ") + lmp->force->pair_style + " exerts forces from outside";
  return "";
}

void Temperature::count()
{
  const int d = domain->dimension;
  double heaviest = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    heaviest = std::max(heaviest, bodies.body[ibody].rigid.mass);
  heaviest = over_ranks(MPI_MAX, heaviest, world);
  const double unit = ExactSum::scale_of(heaviest * std::max((bigint) 1, bodies.number()));

  ExactSum masses[3];
  double here[4] = {};    // directions of translation, and of rotation
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const RigidBody &rigid = bodies.body[ibody].rigid;
    if (has(ibody, ROTATION)) here[3] += rigid.freedoms(d) - d;
    for (int k = 0; k < 3; ++k) {
      if (!has(ibody, TRANSLATION, k)) continue;
      masses[k].add(rigid.mass, unit);
      ++here[k];
    }
  }
  sum_over_ranks(masses, world);
  const auto all = over_ranks(MPI_SUM, here, world);

  stated = words.subtracted >= 0;
  outside = find_outside();
  of_total = 0;
  for (int k = 0; k < 3; ++k) {
    mass[k] = masses[k].value();
    count_of[k] = all[k];
    constant[k] = count_of[k] > 0.0 &&
        (stated ? words.subtracted >= d
                : domain->periodicity[k] && outside.empty() &&
                 count_of[k] == (double) bodies.number());
    of_total += constant[k];
  }
  if (stated) of_total = words.subtracted;
  freedoms[TRANSLATION] = all[0] + all[1] + all[2] - of_total;
  freedoms[ROTATION] = all[3];
  changes = bodies.changes();
  natoms = atom->natoms;
}

bool Temperature::is_counted() const
{
  return changes == bodies.changes() && natoms == atom->natoms;
}

/* ----------------------------------------------------------------------
   sums over bodies
------------------------------------------------------------------------- */

/// The same in all steps with one target.
double Temperature::unit_of_energies() const
{
  return ExactSum::scale_of(std::max(1.0, freedoms[TRANSLATION] + freedoms[ROTATION]) * line.kt);
}

void Temperature::begin()
{
  wanted.energies = unit_of_energies();
  wanted.momenta = LARGE_MOMENTA *
      ExactSum::scale_of(std::sqrt(line.kt * std::max({mass[0], mass[1], mass[2]})));
  std::copy_n(constant, 3, wanted.constant);
  for (auto &sum : sums) sum = ExactSumOf<Lanes>();
}

GEAR_QUAT_VARIANTS void Temperature::add_to(ExactSumOf<Lanes> *sums, const Moving &moving,
                                            const Wanted &wanted)
{
  Lanes rotation = {}, p[3];
  for (int k = 0; k < 3; ++k) {
    p[k] = moving.mass * moving.velocities.linear[k];
    rotation +=
        moving.inertia[k] * moving.velocities.omega_body[k] * moving.velocities.omega_body[k];
    if (wanted.constant[k]) sums[MOMENTUM + k].add(p[k], wanted.momenta);
  }
  sums[ROTATION].add(rotation, wanted.energies);
  if (!wanted.tensor) sums[TRANSLATION].add(dot3(p, moving.velocities.linear), wanted.energies);
  for (int k = 0; wanted.tensor && k < Upper::SIZE; ++k)
    sums[TENSOR + k].add(p[Upper::ROW[k]] * moving.velocities.linear[Upper::COLUMN[k]],
                         wanted.energies);
}

void Temperature::add(int count, const int *ids, const Velocities &velocities)
{
  Moving moving = {{}, {}, velocities};    // a lane without a body has no mass
  for (int lane = 0; lane < LANES; ++lane) {
    const int ibody = ids[std::min(lane, count - 1)];
    const Body &body = bodies.body[ibody];
    const bool counts = lane < count && ibody < bodies.nowned();
    Velocities &v = moving.velocities;
    set(moving.mass, lane, counts ? body.rigid.mass : 0.0);
    for (int k = 0; k < 3; ++k) {
      set(moving.inertia[k], lane, counts ? body.rigid.inertia[k] : 0.0);
      if (!counts) set(v.linear[k], lane, 0.0), set(v.omega_body[k], lane, 0.0);
    }
    if (counts && has_flow()) {
      const auto flow = flow_at(ibody);
      for (int k = 0; k < 3; ++k) set(v.linear[k], lane, get(v.linear[k], lane) - flow[k]);
    }
    for (int k = 0; body.off && k < 3; ++k) {
      if (!has(ibody, TRANSLATION, k)) set(v.linear[k], lane, 0.0);
      if (!has(ibody, ROTATION)) set(moving.inertia[k], lane, 0.0);
    }
  }
  add_to(sums, moving, wanted);
}

bool Temperature::has_flow() const
{
  return domain->deform_vremap != 0;
}

/// As compute temp/deform.  A body has the velocity of the image of its owner atom.
std::array<double, 3> Temperature::flow_at(int ibody) const
{
  double place[3], fraction[3], away[3];
  through(domain->h, bodies.body[ibody].image.data(), away);
  for (int k = 0; k < 3; ++k) place[k] = bodies.state[ibody].center[k] - away[k];
  domain->x2lamda(place, fraction);
  std::array<double, 3> flow;
  through(domain->h_rate, fraction, flow.data());
  for (int k = 0; k < 3; ++k) flow[k] += domain->h_ratelo[k];
  return flow;
}

void Temperature::sum()
{
  ExactSum all[SUMS];
  for (int k = 0; k < SUMS; ++k)
    for (int lane = 0; lane < LANES; ++lane) all[k].add_lane(sums[k], lane);
  sum_over_ranks(all, world);
  double of_common = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double momentum = all[MOMENTUM + k].value();
    common[k] = constant[k] ? momentum / mass[k] : 0.0;
    of_common += momentum * common[k];
  }
  for (int k = 0; k < Upper::SIZE; ++k) {
    const int a = Upper::ROW[k], b = Upper::COLUMN[k];
    tensor[k] = all[TENSOR + k].value() - mass[a] * common[a] * common[b];
  }
  twice[ROTATION] = all[ROTATION].value();
  twice[TRANSLATION] = wanted.tensor ? tensor.trace() : all[TRANSLATION].value() - of_common;
  if (twice[TRANSLATION] < ROUNDING_OF_ENERGY * of_common) twice[TRANSLATION] = 0.0;
  begin();
}

void Temperature::sum_present()
{
  begin();
  for (int first = 0; first < bodies.nowned(); first += LANES) {
    const int count = std::min(LANES, bodies.nowned() - first);
    int ids[LANES];
    Velocities velocities = {};
    for (int lane = 0; lane < count; ++lane) {
      const BodyState &state = bodies.state[ids[lane] = first + lane];
      for (int k = 0; k < 3; ++k) {
        set(velocities.linear[k], lane, state.velocity[k]);
        set(velocities.omega_body[k], lane, state.omega_body[k]);
      }
    }
    add(count, ids, velocities);
  }
  sum();
}

/* ----------------------------------------------------------------------
   messages and restart
------------------------------------------------------------------------- */

std::string Temperature::description() const
{
  if (!has_translation()) return "";
  if (stated) return fmt::format(", without {} by fix_modify extra/dof,", of_total);
  if (!outside.empty()) return ", with those of the total momentum because " + outside + ",";
  std::vector<std::string> along;
  for (int k = 0; k < 3; ++k)
    if (constant[k]) along.emplace_back(1, "xyz"[k]);
  if (along.empty()) return ", with those of the total momentum,";
  const bool all = (int) along.size() == domain->dimension;
  return ", without those of the total momentum" +
      (all ? std::string() : " along " + utils::join_words(along, " and ")) + ",";
}

void Temperature::tell_freedoms(const char *of)
{
  std::string message = fmt::format("{} of {:.0f} degrees of freedom of translation{}", of,
                                    freedoms[TRANSLATION], description());
  if (words.damp > 0.0)
    message += fmt::format(" and {:.0f} of rotation", freedoms[ROTATION]);
  else if (message.back() == ',')
    message.pop_back();
  if (message != told && comm->me == 0)
    utils::logmesg(lmp, "Fix gear/quat {}: {}\n", fix->id, message);
  told = message;
}

void Temperature::fields(Fields &v)
{
  double found = start;
  v(found, line, freedoms);
  if (v.reads() && start == 0.0) start = stop = found;    // no keyword states one
}
