/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Start-up of all bodies inside LAMMPS, for all fixes together: the loop over nodes and bodies
   around the kernel's collocation (gear_quat_startup.h), with LAMMPS' own forces at every node. */

#ifndef LMP_GEAR_QUAT_START_H
#define LMP_GEAR_QUAT_START_H

#include "gear_quat_bodies.h"
#include "gear_quat_forces.h"
#include "gear_quat_startup.h"
#include "gear_quat_step.h"

#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Start : protected Pointers {
 public:
  /// Of all fixes that start together, with one set of nodes.  h: the step of the histories.
  Start(LAMMPS *lmp, const std::vector<Step *> &fixes, double h);
  ~Start() override;

  /// Computes derivatives consistent with the trajectory; if forces cannot be followed, the
  /// derivatives from the present loads, with a message on rank 0.  After the call atoms are as
  /// before, and fixes with new histories are told.  Collective.
  void run();

  // the host of find_start()

  void begin(double spacing);
  void foretell();
  bool visit(int pair, double &change);
  int values_that_do(int values) const;

 private:
  /// The bodies of one fix, with the states and loads of the start.
  struct Starter {
    Step *step;
    Bodies::Snapshot before;
    std::vector<Collocation::Workspace> work;
  };
  std::vector<Starter> starters;
  Forces forces;
  Collocation collocation;
  StartNodes nodes;       ///< the present spacing
  int evaluations = 0;    ///< of the forces, so far
  std::string reason;     ///< why forces cannot be followed, or the last spacing failed

  int most_values() const;
  std::vector<const Fix *> owners() const;
  double first_spacing() const;
  StartFound search();
  bool visit_node(int node, double &change);
  void put_back();
  double fast_edge(const Starter &one, int pairs) const;
  void seed_all(int pairs);
};

}    // namespace LAMMPS_NS::GearQuat

#endif
