/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Body store, in a step: states to ghost bodies, atoms to their places, forces to bodies. */

#include "gear_quat_bodies.h"

#include "atom.h"
#include "comm.h"
#include "force.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

void Bodies::keep_histories()
{
  for (int ibody = 0; ibody < nmove; ++ibody)
    std::copy_n(history(ibody), row_size / 2, history(ibody) + row_size / 2);
}

void Bodies::put_back_histories()
{
  for (int ibody = 0; ibody < nmove; ++ibody)
    std::copy_n(history(ibody) + row_size / 2, row_size / 2, history(ibody));
}

void Bodies::spread_states()
{
  for (const int ibody : tops) update_frame(ibody);
  spread_moved();
}

void Bodies::spread_moved()
{
  if (!any_ghosts) return;
  forward = Forward::STATES;
  comm->forward_comm(fix, STATE_SIZE);
  for (const int ibody : ghost_tops) update_frame(ibody);
}

/// What the atoms of all ranks have added to the loads of bodies that this rank moves.
void Bodies::sum_loads()
{
  if (any_ghosts) comm->reverse_comm(fix, LOAD_SIZE);
  if (!large.empty()) sum_large_loads();
}

void Bodies::spread_loads()
{
  if (!any_ghosts) return;
  forward = Forward::LOADS;
  comm->forward_comm(fix, LOAD_SIZE);
}

void Bodies::update_frame(int ibody)
{
  const BodyState &s = state[ibody];
  rotation_matrix(s.q, scheme.norm2(s.q), frame[ibody].axes);
  to_space(frame[ibody].axes, s.omega_body, frame[ibody].omega_space);
}

template <bool POSITIONS, bool VELOCITIES, bool WRAPPED> void Bodies::place()
{
  const Site *site = sites.data(), *const arms = site + ncentered, *const end = site + sites.size();
  for (; site != arms; ++site) {
    const BodyState &s = state[site->body];
    for (int k = 0; k < 3; ++k) {
      if (POSITIONS) atom->x[site->atom][k] = WRAPPED ? s.center[k] - site->wrap[k] : s.center[k];
      if (VELOCITIES) atom->v[site->atom][k] = s.velocity[k];
    }
  }
  for (; site != end; ++site) {
    const BodyState &s = state[site->body];
    const BodyFrame &fr = frame[site->body];
    double arm[3], spin[3];
    to_space(fr.axes, site->arm_body, arm);
    if (POSITIONS) {
      double *x = atom->x[site->atom];
      for (int k = 0; k < 3; ++k) {
        x[k] = s.center[k] + arm[k];
        if (WRAPPED) x[k] -= site->wrap[k];
      }
    }
    if (VELOCITIES) {
      double *v = atom->v[site->atom];
      cross3(fr.omega_space, arm, spin);
      for (int k = 0; k < 3; ++k) v[k] = s.velocity[k] + spin[k];
    }
  }
}

template <bool POSITIONS, bool VELOCITIES> void Bodies::place()
{
  wrapped ? place<POSITIONS, VELOCITIES, true>() : place<POSITIONS, VELOCITIES, false>();
}

void Bodies::place_sites(bool velocities)
{
  velocities ? place<true, true>() : place<true, false>();
  if (!extended.sites.empty()) extended.place(state, true, velocities);
}

void Bodies::place_velocities()
{
  place<false, true>();
  if (!extended.sites.empty()) extended.place(state, false, true);
}

void Bodies::place_extended()
{
  if (!extended.sites.empty()) extended.place(state, true, true);
}

void Bodies::gather_loads(double **f, double **torque)
{
  if (!any_forces) return;
  for (auto &one : load) one = Load();
  const Site *site = sites.data(), *const arms = site + ncentered, *const end = site + sites.size();
  for (; site != arms; ++site) add3(f[site->atom], load[site->body].force);
  for (; site != end; ++site) {
    const double *force = f[site->atom];
    Load &sum = load[site->body];
    double arm[3], moment[3];
    to_space(frame[site->body].axes, site->arm_body, arm);
    cross3(arm, force, moment);
    add3(force, sum.force);
    add3(moment, sum.torque_space);
  }
  if (!extended.sites.empty()) extended.add_torques(torque, load);
  sum_loads();

  const double ftm2v = force->ftm2v;
  if (ftm2v == 1.0) return;
  for (int ibody = 0; ibody < nmove; ++ibody)
    for (int k = 0; k < 3; ++k) {
      load[ibody].force[k] *= ftm2v;
      load[ibody].torque_space[k] *= ftm2v;
    }
}

Bodies::ConstraintForce Bodies::constraint_force(const Site &site, double **f) const
{
  ConstraintForce constraint;
  double *arm_space = constraint.arm[0], *lacking = constraint.force[0];
  const BodyFrame &fr = frame[site.body];
  const Load &l = load[site.body];
  const RigidBody &rigid = body[site.body].rigid;
  double torque_body[3], alpha_body[3], alpha_space[3], tangential[3], spin[3], radial[3];
  to_body(fr.axes, l.torque_space, torque_body);
  angular_acceleration(rigid, torque_body, state[site.body].omega_body, alpha_body);
  to_space(fr.axes, alpha_body, alpha_space);

  to_space(fr.axes, site.arm_body, arm_space);
  cross3(alpha_space, arm_space, tangential);
  cross3(fr.omega_space, arm_space, spin);
  cross3(fr.omega_space, spin, radial);
  const double mass = atom_mass(site.atom) / force->ftm2v;
  for (int k = 0; k < 3; ++k)
    lacking[k] = mass * (l.force[k] / rigid.mass + tangential[k] + radial[k]) - f[site.atom][k];
  for (int k = 0; k < 3; ++k) constraint.virial[k] = arm_space[k] * lacking[k];
  constraint.virial[3] = arm_space[0] * lacking[1];
  constraint.virial[4] = arm_space[0] * lacking[2];
  constraint.virial[5] = arm_space[1] * lacking[2];
  return constraint;
}

std::vector<Load> Bodies::centroids()
{
  std::vector<Load> means(body.size(), Load());
  for (const Site &site : sites) {
    double arm[3];
    to_space(frame[site.body].axes, site.arm_body, arm);
    for (int k = 0; k < 3; ++k) means[site.body].force[k] += arm[k] / body[site.body].natoms;
  }
  load.swap(means);    // they travel as loads do
  sum_loads();
  spread_loads();
  load.swap(means);
  return means;
}

double Bodies::atom_mass(int i) const
{
  return atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
}
