/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Start-up of all bodies inside LAMMPS, for all fixes together: the loop over nodes and bodies
   around the kernel's collocation (gear_quat_startup.h), with LAMMPS' own forces at every node. */

#include "gear_quat_ranks.h"
#include "gear_quat_startup.h"
#include "gear_quat_step.h"

#include "atom.h"
#include "comm.h"
#include "fix.h"
#include "neighbor.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

namespace LAMMPS_NS::GearQuat {

/// The number of pairs of nodes needed for a choice of the number of values.
static constexpr int PAIRS_THAT_TELL = 2;

class Start : protected Pointers {
 public:
  /// Of all fixes that start together, with one set of nodes.  h: the step of the histories.
  Start(LAMMPS *lmp, const std::vector<Step *> &fixes, double h) :
      Pointers(lmp), starters([&] {
        std::vector<Starter> all;
        for (Step *one : fixes) {
          one->bath.refer_to_box(h);
          all.push_back({one, one->bodies.snapshot(), {}});
        }
        return all;
      }()),
      forces(lmp, owners()), collocation(most_values()), nodes{collocation, 0.0, h},
      reason(forces.reason())
  {
  }

  /// Computes derivatives consistent with the trajectory; if forces cannot be followed, the
  /// derivatives from the present loads, with a message on rank 0.  After the call atoms are as
  /// before, and fixes with new histories are told.  Collective.
  void run()
  {
    StartFound start = {StartPlan::Verdict::SHORTER_SPACING};
    if (reason.empty()) start = search();
    const bool found = start.verdict != StartPlan::Verdict::SHORTER_SPACING;
    for (auto &one : starters) {
      Step &step = *one.step;
      std::string text = "start with known forces only (order 2), because " + reason;
      if (!found) {
        step.seed_local(3);
      } else {
        const bool jumps = start.verdict == StartPlan::Verdict::JUMPS;
        const int full = step.scheme().order(),
                  order = jumps ? std::min(full, start.order()) : full;
        text = fmt::format("start of order {} from {} force evaluations", order, evaluations);
        if (order < full)
          text += fmt::format(", because forces change suddenly, by {:.1g} of the motion in a step",
                              start.change);
      }
      if (comm->me == 0 && (!found || step.bodies.number() > 0))
        utils::logmesg(lmp, "Fix gear/quat {}: {}\n", step.fix->id, text);
      step.note_start();
    }
  }

  // the host of find_start()

  void begin(double spacing)
  {
    nodes.spacing = spacing;
    reason = "forces vary too much within a few steps";
    put_back();
    for (auto &one : starters) {
      const Bodies &bodies = one.step->bodies;
      one.step->bath.measure();
      one.step->bath.begin_start(nodes);
      one.work.resize(bodies.nmoved());
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
        collocation.begin(bodies.body[ibody].rigid,
                          local_series(bodies.body[ibody].rigid,
                                       one.step->bath.scaled(bodies.state[ibody]),
                                       one.step->bath.acting(ibody), spacing),
                          one.work[ibody]);
    }
  }

  void foretell()
  {
    for (auto &one : starters) {
      for (auto &work : one.work) collocation.foretell(work);
      one.step->bath.foretell(nodes);
    }
  }

  bool visit(int pair, double &change)
  {
    double here = 0.0;
    for (const int node : {-pair, pair})
      if (!visit_node(node, here)) {
        reason = fmt::format("sites would leave the neighbor skin, {}", neighbor->skin);
        return false;
      }
    for (auto &one : starters) {
      for (auto &work : one.work) collocation.settle(pair, work);
      one.step->bath.settle(nodes, pair);
    }
    change = over_ranks(MPI_MAX, here, world);
    return true;
  }

  /// The result of choose().
  int values_that_do(int values) const
  {
    int most = 0;
    for (const auto &one : starters) {
      if (!one.step->args.automatic_values) return values;
      const Choice choice = one.step->choose(fast_edge(one, PAIRS_THAT_TELL));
      most = std::max(most, choice.scheme.start_values());
    }
    return std::min(values, most);
  }

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

  int most_values() const
  {
    int most = 0;
    for (const auto &one : starters) most = std::max(most, one.step->scheme().start_values());
    return most;
  }

  std::vector<const Fix *> owners() const
  {
    std::vector<const Fix *> fixes;
    for (const auto &one : starters) fixes.push_back(one.step->fix);
    return fixes;
  }

  void put_back()
  {
    for (auto &one : starters) {
      one.step->bodies.put_back(one.before);
      one.step->bath.leave_nodes();
    }
  }

  /// Evaluates forces at one node; change: increased to the largest change.  False, without an
  /// evaluation, if a site would leave the skin.
  bool visit_node(int node, double &change)
  {
    for (auto &one : starters) {
      Bodies &bodies = one.step->bodies;
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
        bodies.state[ibody] = collocation.state_at(node, one.work[ibody], nodes.spacing);
      one.step->bath.enter_node(nodes, node);
      one.step->ownership.spread_states();
      one.step->sites.place(true);
    }
    if (forces.largest_displacement() > 0.5 * neighbor->skin) return false;
    int vflag = 0;
    for (auto &one : starters) vflag |= one.step->bath.vflag();
    forces.evaluate(0, vflag);
    ++evaluations;
    for (auto &one : starters) one.step->sites.gather_loads(atom->f, atom->torque);
    for (auto &one : starters) {
      const Bodies &bodies = one.step->bodies;
      one.step->bath.visit_node(nodes, node);
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
        const Body &body = bodies.body[ibody];
        const double length = body.extent > 0.0 ? body.extent : neighbor->skin;
        change = std::max(change,
                          collocation.set_load(node, body.rigid, bodies.state[ibody],
                                               one.step->bath.acting(ibody), nodes.spacing, length,
                                               one.work[ibody]));
      }
    }
    return true;
  }

  /// After the call atoms, states and loads are as before.
  StartFound search()
  {
    forces.save();
    const bool coupled = std::any_of(starters.begin(), starters.end(), [](const Starter &one) {
      return one.step->bath.acts();
    });
    const StartFound start =
        find_start(most_values(), first_spacing(), *this, coupled ? StartPlan::COUPLED : 0.0);
    if (start.verdict != StartPlan::Verdict::SHORTER_SPACING) {
      for (auto &one : starters)
        one.step->choose_scheme(fast_edge(one, std::min(start.pairs, PAIRS_THAT_TELL)));
      seed_all(start.pairs);
    }
    put_back();
    forces.restore();
    for (auto &one : starters) {
      one.step->ownership.spread_states();
      one.step->sites.place_extended();
    }
    return start;
  }

  /// Node spacing: the step, shortened if necessary to keep every site within half the skin, and the
  /// rotation of every body from its outermost node below 1 radian.
  double first_spacing() const
  {
    constexpr double LARGEST_TURN = 1.0;
    const double span = collocation.pairs() * std::fabs(nodes.h), reach = 0.25 * neighbor->skin;
    double longest = 1.0;    // in units of these limits
    for (const auto &one : starters) {
      for (int i = 0; i < atom->nlocal; ++i)
        if (one.step->ownership.in_body(i))
          longest = std::max(longest, span * length(atom->v[i]) / reach);
      for (int ibody = 0; ibody < one.step->bodies.nowned(); ++ibody)
        longest = std::max(longest,
                           span * length(one.step->bodies.state[ibody].omega_body) / LARGEST_TURN);
    }
    return nodes.h / over_ranks(MPI_MAX, longest, world);
  }

  /// Radians of vibrations in a step, from the derivatives of this number of pairs.
  double fast_edge(const Starter &one, int pairs) const
  {
    MotionSums here;
    for (int ibody = 0; ibody < one.step->bodies.nowned(); ++ibody)
      here.add(one.step->bodies.body[ibody].rigid, one.before.states[ibody],
               collocation.series(one.work[ibody], pairs), nodes.spacing);
    return one.step->fast_edge(here);
  }

  /// Histories of all bodies from the polynomials.
  void seed_all(int pairs)
  {
    for (auto &one : starters) {
      Bodies &bodies = one.step->bodies;
      for (int ibody = 0; ibody < bodies.nmoved(); ++ibody)
        seed(one.step->scheme(), bodies.body[ibody].rigid,
             collocation.series(one.work[ibody], pairs), nodes.spacing, nodes.h,
             bodies.history(ibody));
      one.step->bath.seed(nodes, pairs, one.step->scheme().values());
    }
  }
};

}    // namespace LAMMPS_NS::GearQuat

void GearQuat::start_together(LAMMPS *lmp, const std::vector<Step *> &fixes, double h)
{
  Start(lmp, fixes, h).run();
}
