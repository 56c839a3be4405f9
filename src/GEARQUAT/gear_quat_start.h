/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Start-up of all bodies inside LAMMPS, for all fixes together: the loop over nodes and bodies
   around the kernel's collocation (gear_quat_startup.h), with LAMMPS' own forces at every node. */

#ifndef LMP_GEAR_QUAT_START_H
#define LMP_GEAR_QUAT_START_H

#include "gear_quat_choice.h"
#include "gear_quat_coupling.h"
#include "gear_quat_forces.h"
#include "gear_quat_sites.h"

#include <functional>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

/// Estimates of the motion, from loads, of the bodies that this rank owns.
MotionSums sums_by_loads(const Bodies &bodies);

/// The bodies of one fix in a start.
struct Starter {
  const Fix *fix;
  Bodies *bodies;    ///< with states and loads of the start
  Ownership *ownership;
  Sites *sites;
  Coupling *coupling;    ///< null if there is none
  Scheme scheme;
  bool needed;    ///< false if there are histories, which are kept if not all rows can be found
  /// Judges this motion, and chooses the scheme unless it is given: histories have the returned
  /// scheme.  Collective.
  std::function<Scheme(const MotionSums &)> choose;
  /// Predicts this choice; null if the scheme is given.  Collective.
  std::function<Scheme(const MotionSums &)> foresee;

  Column<Collocation::Workspace> work = Column<Collocation::Workspace>(*bodies);

  Load acting(int ibody) const { return acting_on(*bodies, coupling, ibody); }
  BodyState scaled(int ibody) const { return scaled_of(*bodies, coupling, ibody); }
  /// Histories of all bodies from states and loads alone.  terms: 2 for the paper's start, in which
  /// all derivatives from the second on are zero, or 3 with the loads.  Collective.
  void seed_local(int terms, double h);
};

/// History of one body from its state, with a scaled center, and from the load that acts on it.
/// terms: 2, or 3 to include the load.
void seed_body(Bodies &bodies, int ibody, const BodyState &state, const Load &acting,
               const Scheme &scheme, double h, int terms);

class Start : protected Pointers {
 public:
  /// starters: all fixes that start together, with one set of nodes.  h: the step of the histories.
  Start(LAMMPS *lmp, const std::vector<Starter> &starters, double h);

  /// Computes derivatives consistent with the trajectory; if forces cannot be followed, the
  /// derivatives from the present loads, with a message on rank 0.  After the call atoms are as
  /// before.  Returns true if all rows are known.  Collective.
  bool run();

 private:
  std::vector<Starter> starters;
  double h;

  Collocation collocation;
  int evaluations = 0;    ///< of the forces, so far
  std::string reason;     ///< why the last spacing failed, or a remark about this spacing

  struct Search;
  std::string names() const;
  bool lowers_order(const StartFound &start) const;
  std::string orders(const StartFound &start) const;
  double first_spacing() const;
  StartFound search(Forces &forces);
  MotionSums sums_of(const Starter &one, const Bodies::Snapshot &snapshot, int pairs,
                     double spacing) const;
  void choose(const StartFound &start, const std::vector<Bodies::Snapshot> &snapshots);
  void seed_all(const StartFound &start);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
