/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Start-up of all bodies inside LAMMPS: the loop over nodes and bodies around the kernel's
   collocation (gear_quat_startup.h), with LAMMPS' own forces at every node. */

#ifndef LMP_GEAR_QUAT_BOOTSTRAP_H
#define LMP_GEAR_QUAT_BOOTSTRAP_H

#include "gear_quat_bodies.h"
#include "gear_quat_forces.h"
#include "gear_quat_isokinetic.h"
#include "gear_quat_startup.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class GearQuatBootstrap : protected Pointers {
 public:
  /// bodies: states and loads of owned bodies are those of the start.  isokinetic: null without such
  /// a constraint.  h: the step of the histories.
  GearQuatBootstrap(LAMMPS *lmp, const Fix *fix, GearQuatBodies &bodies,
                    GearQuatIsokinetic *isokinetic, const GearQuat::Scheme &scheme, double h);

  /// The paper's start: every second and higher derivative is zero.
  void zero();
  /// History of one body from what its state and the load that acts on it determine.  terms: 2, or
  /// 3 for the load too.
  static void seed_body(GearQuatBodies &bodies, int ibody, const GearQuat::Load &acting,
                        const GearQuat::Scheme &scheme, double h, int terms);
  /// Derivatives consistent with the trajectory; where forces cannot be followed, those that the
  /// present loads determine, and a message on rank 0.  After the call atoms are as before.
  /// Returns true if all rows are known.
  bool run();

 private:
  const Fix *fix;
  GearQuatBodies &bodies;
  GearQuatIsokinetic *isokinetic;
  GearQuat::Scheme scheme;
  double h;

  GearQuat::Collocation collocation;
  std::vector<GearQuat::Collocation::Workspace> work;
  int evaluations;       ///< of the forces, so far
  int jumps;             ///< spacings at which forces seemed to jump
  std::string reason;    ///< why the last spacing failed, or what is to be said about it

  std::vector<double> power;    ///< of all forces at the nodes, where a constraint takes it

  void seed_local(int terms);
  void measure(int node);
  GearQuat::Load acting(int ibody) const;
  double first_spacing() const;
  double length(const GearQuatBody &body) const;
  double truncation() const;
  bool collocate(GearQuatForces &forces, double spacing);
  bool visit(GearQuatForces &forces, int node, double spacing, double &change);
  bool sweep(GearQuatForces &forces, double spacing, bool first, double &change);
};

}    // namespace LAMMPS_NS

#endif
