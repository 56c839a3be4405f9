/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Rigid bodies in LAMMPS' command minimize (doc/theory.md, Energy minimization).

   LAMMPS' minimizers move atoms along straight lines, by linear combinations of the forces on them.
   The forces on the atoms of a body are projected onto its rigid motions, so that these
   combinations are rigid motions, too.  Before each evaluation of the forces the body moves to the
   pose nearest to its atoms, and the atoms move to their positions in the body.  The degrees of
   freedom of a body are thus the degrees of freedom of its atoms, nothing is sent to all ranks, and
   rotations and translations have the same measure, the displacement of the atoms.

   Bodies keep their velocities, and their angular velocities along their principal axes. */

#include "fix_gear_quat.h"

#include "gear_quat_ranks.h"
#include "gear_quat_shapes.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/// In the memory of the history of a body, which a minimization does not need, and which travels
/// with the body.
struct Stored {
  double center[3], q[4];    ///< starting point of a line search
  ArmSums arms;              ///< along the axes of the body
};
static_assert(sizeof(Stored) <= VERLET * Scheme::SECOND_WIDTH * sizeof(double));

static Stored &stored(Bodies &bodies, int ibody)
{
  return *reinterpret_cast<Stored *>(bodies.history(ibody));
}

static Arms arms_of(Bodies &bodies, int ibody)
{
  const Arms along_axes = {(double) bodies.body[ibody].natoms, stored(bodies, ibody).arms};
  return along_axes.in_space(bodies.frame[ibody].axes);
}

void FixGearQuat::refuse_minimizer() const
{
  if (!utils::strmatch(update->minimize_style, "^cg") &&
      !utils::strmatch(update->minimize_style, "^sd"))
    error->all(
        FLERR,
        "Fix gear/quat cannot be used with min_style {}, which does not let fixes take part; "
        "use min_style cg or sd",
        update->minimize_style);
}

/// Ends the run on all ranks if a load is not finite.
void FixGearQuat::min_setup(int vflag)
{
  step.forget("Fix gear/quat: minimize moves the bodies; histories are rebuilt");
  ownership.spread_states();
  min_post_force(vflag);
  std::vector<ArmSums> sums(bodies.nhere());
  for (const Site &site : sites) {
    const double *d = site.arm_body;
    add3(d, sums[site.body].arm);
    for (int n = 0; n < 9; ++n) sums[site.body].products[n] += d[n / 3] * d[n % 3];
  }
  ownership.sum(sums);
  tagint bad = 0;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    stored(bodies, ibody).arms = sums[ibody];
    const Load load = bodies.acting(ibody);
    if (!std::isfinite(length(load.force) + length(load.torque_space))) bad = bodies.body[ibody].id;
  }
  bad = over_ranks(MPI_MAX, bad, world);
  if (bad)
    error->all(FLERR,
               "Fix gear/quat: the force or torque on body {} is not a number, so it cannot be "
               "minimized; atoms must not be in the same place (see delete_atoms overlap)",
               bad);
  project_forces();
  min_vflag = PROJECTED;
}

void FixGearQuat::min_pre_force(int /*vflag*/)
{
  min_pre_exchange();
  comm->forward_comm();
}

/// Fix box/relax may request the pressure next.
void FixGearQuat::min_post_force(int vflag)
{
  sites.gather_loads(atom->f, atom->torque);
  tally_virial(vflag, atom->f);
  min_vflag = vflag;
}

/// Called when all other fixes have added their forces.  In LAMMPS' setup, thermo output is printed
/// before, with the virial of the forces before their projection.
double FixGearQuat::min_energy(double *fextra)
{
  fextra[0] = 0.0;
  if (min_vflag == PROJECTED)
    sites.gather_loads(atom->f, nullptr);    // with the torques of atoms
  else
    min_post_force(min_vflag);
  project_forces();
  return 0.0;
}

/// Moves bodies to their atoms, and atoms to their positions, except ghosts.
void FixGearQuat::min_pre_exchange()
{
  std::vector<Displacements> sums(bodies.nhere());
  for (const Site &site : sites) {
    Displacements &sum = sums[site.body];
    const auto expected = sites.expected_position(site);
    double arm[3];
    to_space(bodies.frame[site.body].axes, site.arm_body, arm);
    for (int a = 0; a < 3; ++a) {
      const double way = atom->x[site.atom][a] - expected.value[a];
      sum.way[a] += way;
      for (int b = 0; b < 3; ++b) sum.products[3 * a + b] += way * arm[b];
    }
  }
  ownership.sum(sums);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const Move move = nearest_move(arms_of(bodies, ibody), bodies.body[ibody].off, sums[ibody]);
    BodyState &s = bodies.state[ibody];
    double q[4];
    w_times(move.rotation, s.q, q);
    std::copy_n(q, 4, s.q);
    add3(move.way, s.center);
    bodies.update_frame(ibody);
  }
  ownership.spread_moved();
  sites.place(false);
}

/// Projects the forces on atoms of bodies onto rigid motions.
void FixGearQuat::project_forces()
{
  std::vector<Twist> twists(bodies.nhere());
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    Load load = bodies.load[ibody];
    for (int k = 0; k < 3; ++k) {
      load.force[k] /= force->ftm2v;
      load.torque_space[k] /= force->ftm2v;
    }
    twists[ibody] = nearest_twist(arms_of(bodies, ibody), bodies.body[ibody].off, load);
  }
  ownership.spread(twists);
  for (const Site &site : sites) {
    const Twist &of_body = twists[site.body];
    double arm[3];
    to_space(bodies.frame[site.body].axes, site.arm_body, arm);
    cross3(of_body.turn, arm, atom->f[site.atom]);
    add3(of_body.way, atom->f[site.atom]);
  }
}

/// The starting point of a line search.
void FixGearQuat::min_store()
{
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const BodyState &s = bodies.state[ibody];
    std::copy_n(s.center, 3, stored(bodies, ibody).center);
    std::copy_n(s.q, 4, stored(bodies, ibody).q);
  }
}

void FixGearQuat::put_back_poses()
{
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    BodyState &s = bodies.state[ibody];
    std::copy_n(stored(bodies, ibody).center, 3, s.center);
    std::copy_n(stored(bodies, ibody).q, 4, s.q);
    bodies.update_frame(ibody);
  }
}
