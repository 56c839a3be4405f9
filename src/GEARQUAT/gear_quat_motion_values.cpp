/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_motion.h"

#include "gear_quat_ranks.h"
#include "gear_quat_scene.h"

#include "comm.h"
#include "error.h"
#include "fix.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   the number of values, where the command does not state it
------------------------------------------------------------------------- */

/// Input to the choice.  here: of the bodies that this rank owns.  Collective.
ChoiceOfValues Motion::scene_of(const MotionSums &here) const
{
  MotionSums all = here;
  const auto sums = over_ranks(MPI_SUM, all.sums, world);
  std::copy(sums.begin(), sums.end(), all.sums);
  ChoiceOfValues scene;
  scene.edge = bodies.number() > 0 ? all.fast_edge(step.length()) : HUGE_VAL;
  scene.exact = all.knows_derivatives(step.length());
  scene.noise = noise_of_forces(lmp, ownership).noise;
  scene.may_be_gear = !args.states("corrector");
  scene.automatic = args.automatic_values;
  return scene;
}

/// Includes the friction of a coupling whose run has begun.
ChoiceOfValues Motion::scene_of_start(const MotionSums &here) const
{
  ChoiceOfValues scene = scene_of(here);
  if (step.coupling) scene.friction = step.coupling->friction_ahead(step.length());
  return scene;
}

Scheme Motion::foresee_scheme(const MotionSums &here) const
{
  return scene_of_start(here).choose(args.scheme).scheme;
}

/// Histories have this scheme after the call.
Scheme Motion::choose_scheme(const MotionSums &here)
{
  const ChoiceOfValues scene = scene_of_start(here);
  const ChoiceOfValues::Choice choice = scene.choose(args.scheme);
  edge_rate = scene.edge / std::fabs(step.length());
  tell_choice(scene, choice);
  chosen = scene;
  warned_values = false;
  step.set_scheme(choice.scheme);
  return choice.scheme;
}

/// Collective.
void Motion::tell_choice(const ChoiceOfValues &scene, const ChoiceOfValues::Choice &choice) const
{
  using Reason = ChoiceOfValues::Reason;
  const NoisyForces forces = noise_of_forces(lmp, ownership);    // on all ranks
  if (comm->me != 0) return;
  std::string why;
  if (choice.reason == Reason::NOISE)
    why = "because " + forces.words();
  else if (choice.reason == Reason::FRICTION)
    why = "because the thermostat has a strong friction";
  else if (choice.reason == Reason::FORMULATION)
    why = "as always with corrector gear";
  else if (std::isfinite(scene.edge))
    why = fmt::format("for vibrations of {:.2g} radians in a step", scene.edge);
  else
    why = bodies.number() > 0 ? "because the motion is not known before it begins"
                              : "because there are no bodies yet";
  const bool other_corrector = choice.scheme.tuned != args.scheme.tuned;
  utils::logmesg(lmp, "Fix gear/quat {}: {} values{}, {}\n", fix->id, choice.scheme.values(),
                 is_verlet(choice.scheme) ? " (velocity Verlet)"
                     : other_corrector    ? " and corrector gear"
                                          : "",
                 why);
}

/// Warns once, and again if only a much shorter step is short enough.
void Motion::warn_of_vibrations(const ChoiceOfValues &scene, const Scheme &scheme, bool begins)
{
  const double advised = std::fabs(step.length()) * scene.advised_part(scheme);
  if (!scene.too_long(scheme) || advised * ChoiceOfValues::BAND > advised_step) return;
  advised_step = advised;
  if (comm->me != 0) return;
  const std::string who = scene.chooses_longest(scheme)
      ? "any number of values"
      : fmt::format("{} values of formulation {} and corrector {}", scheme.values(),
                    word_of(scheme.formulation), scheme.tuned ? "tuned" : "gear");
  const char *otherwise = "";
  if (begins)
    otherwise = ", or, if atoms overlap, begin with a run with keywords tolerance and temp";
  else if (!scene.chooses_longest(scheme) && !scheme.first())
    otherwise = ", or leave out keywords values and corrector";
  error->warning(FLERR,
                 "Fix gear/quat {}: {}vibrations of {:.2g} radians in a step are "
                 "more than {} can follow for long; use a time step of {:g} or shorter{}",
                 fix->id, begins ? "" : fmt::format("at step {} ", update->ntimestep), scene.edge,
                 who, rounded_down(advised), otherwise);
}

void Motion::look_at_vibrations()
{
  if (step.tolerance) return;
  // short runs with a stated number are not examined, so that effects that are off are free
  if (!args.automatic_values && update->laststep - update->firststep < Vibrations::FIRST_WINDOW)
    return;
  if (!vibrations.note_step(step.length())) return;
  ChoiceOfValues scene = scene_of(vibrations.sums());
  scene.edge = MotionSums::true_edge(scene.edge);
  if (scene.exact && scene.too_long(step.scheme())) {
    warn_of_vibrations(scene, step.scheme(), false);
    return;
  }
  if (scene.exact && args.automatic_values) warn_of_values(scene);
}

/// Warns once for these histories, which keep their number of values.
void Motion::warn_of_values(const ChoiceOfValues &scene)
{
  const int present = step.scheme().values();
  const ChoiceOfValues::Choice suits = scene.choose(args.scheme, present);
  if (warned_values || suits.reason != ChoiceOfValues::Reason::MOTION ||
      suits.scheme.values() >= present)
    return;
  warned_values = true;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat {}: at step {} vibrations of {:.2g} "
                   "radians in a step require {} values, but histories began with {} for a slower "
                   "motion; use keyword values {}, or define the fix again before the next run",
                   fix->id, update->ntimestep, scene.edge, suits.scheme.values(), present,
                   suits.scheme.values());
}

/// Returns the reason to start histories again with another number of values, null for none.
/// Reasons are a change of the step or of forces.  Vibrations are from the last
/// start.  Collective.
const char *Motion::another_scheme_suits()
{
  if (!args.automatic_values || edge_rate == 0.0) return nullptr;
  ChoiceOfValues scene = scene_of(MotionSums());
  scene.edge = edge_rate * std::fabs(step.length());
  using Reason = ChoiceOfValues::Reason;
  const Scheme &present = step.scheme();
  const ChoiceOfValues::Choice choice = scene.choose(args.scheme, present.values());
  if (choice.scheme.values() == present.values() && choice.scheme.tuned == present.tuned)
    return nullptr;
  if (choice.reason != Reason::MOTION && choice.reason != Reason::FORMULATION)
    return "forces suit another number of values";
  return can_start_anew() ? "the motion suits another number of values" : nullptr;
}

/* ----------------------------------------------------------------------
   the method of a restart file
------------------------------------------------------------------------- */

void Motion::adopt_scheme(Fields &file)
{
  file(of_file);
  Scheme scheme = args.scheme;
  if (step.tolerance || of_file.tolerance != 0.0 || !of_file.started ||
      of_file.formulation != (double) scheme.formulation)
    return;
  if (args.automatic_values) scheme.rows = (int) of_file.values;
  if (scheme.values() != of_file.values) return;
  if (!args.states("corrector")) scheme.tuned = of_file.tuned != 0.0;
  step.set_scheme(scheme);
}

std::string Motion::words_of_scheme() const
{
  const Scheme &s = step.scheme();
  return fmt::format("values {}, corrector {}", s.values(), s.tuned ? "tuned" : "gear");
}
