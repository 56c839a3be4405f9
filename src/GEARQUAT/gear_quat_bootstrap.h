/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Start-up of all bodies inside LAMMPS, those of several fixes together: the loop over nodes and
   bodies around the kernel's collocation (gear_quat_startup.h), with LAMMPS' own forces at every
   node. */

#ifndef LMP_GEAR_QUAT_BOOTSTRAP_H
#define LMP_GEAR_QUAT_BOOTSTRAP_H

#include "gear_quat_forces.h"
#include "gear_quat_isokinetic.h"
#include "gear_quat_sites.h"
#include "gear_quat_startup.h"
#include "gear_quat_thermostat.h"

#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// The bodies of one fix.
struct Party {
  const Fix *fix;
  Bodies *bodies;    ///< states and loads are those of the start
  Ownership *ownership;
  Sites *sites;
  IsokineticConstraint *isokinetic;    ///< null without such a constraint
  Thermostat *thermostat;              ///< null without
  Scheme scheme;
  bool needed;    ///< false if there are histories, to be kept where not all rows can be found

  std::vector<Collocation::Workspace> work = {};
  std::vector<double> power = {};    ///< of all forces at the nodes, where a constraint takes it

  /// Constraint or thermostat take their sums from the present states and loads.
  void measure();
  /// The load that moves a body, after measure().
  Load acting(int ibody) const;
  /// Histories of all bodies from what states and loads determine.
  void seed_local(int terms, double h);
};

class Bootstrap : protected Pointers {
 public:
  /// parties: all that start together, with one set of nodes.  h: the step of the histories.
  Bootstrap(LAMMPS *lmp, const std::vector<Party> &parties, double h);

  /// The paper's start: every second and higher derivative is zero.
  static void zero(Party party, double h);
  /// History of one body from what its state and the load that acts on it determine.  terms: 2, or
  /// 3 for the load too.
  static void seed_body(Bodies &bodies, int ibody, const Load &acting, const Scheme &scheme,
                        double h, int terms);
  /// Derivatives consistent with the trajectory; where forces cannot be followed, those that the
  /// present loads determine, and a message on rank 0.  After the call atoms are as before.
  /// Returns true if all rows are known.
  bool run();

 private:
  std::vector<Party> parties;
  double h;

  Collocation collocation;
  int evaluations = 0;    ///< of the forces, so far
  std::string reason;     ///< why the last spacing failed, or what is to be said about it

  struct Search;
  void measure(int node);
  std::string names() const;
  bool lowers_order(const StartFound &start) const;
  std::string orders(const StartFound &start) const;
  double first_spacing() const;
  StartFound search(Forces &forces);
  void seed_all(const StartFound &start);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
