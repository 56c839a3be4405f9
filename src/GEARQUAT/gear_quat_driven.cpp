/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* A box that another fix changes during a run (doc/theory.md, Boxes that other commands change).

   A fix that remaps atoms with the box notifies the rigid fixes before and after (Fix::deform()).
   Then the centers of mass are remapped, and bodies keep their shapes, orientations and velocities:
   an error of first order, as with fix rigid.

   If the box changes without a remap, atoms do not move.  The center of mass of a body, which is
   unwrapped, stays with its owner atom, and the other images of the body move with the box.  With
   fix deform remap v a body gets the velocity of the image beyond a face when its owner atom
   crosses it, and each atom has the velocity of its own image, like LAMMPS' atoms. */

#include "fix_gear_quat.h"

#include "gear_quat_box.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "modify.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   a box that another fix changes: before a run
------------------------------------------------------------------------- */

static bool changes_box(const Fix *one)
{
  return one->box_change & (Fix::BOX_CHANGE_SIZE | Fix::BOX_CHANGE_SHAPE);
}

/// Ends the run if another fix changes the box in a way that bodies cannot follow.
void FixGearQuat::find_driver()
{
  driver = nullptr;
  for (const auto *other : modify->get_fix_list()) {
    if (other == this || !changes_box(other)) continue;
    driver = other;
    if (!known(Fact::CARRIES_BODIES, other))
      error->all(FLERR,
                 "Fix gear/quat: {} changes the box without informing other fixes of "
                 "the remap, so bodies cannot follow; {}",
                 name_of(other),
                 utils::strmatch(other->style, "^gear/quat")
                     ? "put all bodies in one fix"
                     : "use fix deform, fix press/berendsen, or fix npt on other atoms");
    if (args.pressure.any())
      error->all(FLERR,
                 "Fix gear/quat: keywords of constant pressure change the box, and {} "
                 "changes it, too; leave out one of the two",
                 name_of(other));
    if (args.control.eps > 0.0)
      error->all(FLERR,
                 "Fix gear/quat tolerance cannot be used with {}, whose box is a function "
                 "of the number of the step; leave out keyword tolerance",
                 name_of(other));
  }
  if (driver && domain->deform_vremap && args.isokinetic != Isokinetic::NONE)
    error->all(FLERR,
               "Fix gear/quat isokinetic: the velocities of bodies contain the flow of fix deform "
               "remap v, which is not thermal motion; use keyword temp, or remap x");
}

/* ----------------------------------------------------------------------
   atoms are remapped with the box
------------------------------------------------------------------------- */

/// Another fix has remapped atoms with the box, from Ownership::box().
void FixGearQuat::remap_bodies()
{
  const double *before = ownership.box().data();
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const double *center = bodies.state[ibody].center;
    double moved[3], way[3];
    follow_box(domain, before, center, moved);
    for (int k = 0; k < 3; ++k) way[k] = moved[k] - center[k];
    move_center(ibody, way);
  }
  place_in_box();
}

/// Moves the centers of the state and of the history.
void FixGearQuat::move_center(int ibody, const double *way)
{
  double *center = bodies.state[ibody].center;
  for (int k = 0; k < 3; ++k) center[k] += way[k];
  if (!step.started) return;
  double *row = bodies.history(ibody) + Scheme::POSITION;
  for (int k = 0; k < 3; ++k) row[k] += way[k];
}

void FixGearQuat::place_in_box()
{
  ownership.spread_moved();
  sites.place(false);
  ownership.note_box();
}

/* ----------------------------------------------------------------------
   atoms do not move
------------------------------------------------------------------------- */

/// Before a step, and when the box may have changed without a remap.
void FixGearQuat::follow_change()
{
  const auto &box = ownership.box();
  if (!driver || std::equal(domain->h, domain->h + 6, box.begin())) return;
  double change[6], way[3];
  for (int k = 0; k < 6; ++k) change[k] = domain->h[k] - box[k];
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    through(change, bodies.body[ibody].image.data(), way);
    move_center(ibody, way);
  }
  ownership.note_box();
}

/// The body keeps its velocity relative to the faces that its owner atom has crossed since the last
/// call, also if fix deform has flipped the box.  images: of the owner atom, now.
void FixGearQuat::pass_faces(int ibody, const double *images)
{
  const double *rates = step.phase == Phase::BEGUN ? domain->h_rate : sites.rates_of_faces().data();
  double away[2][3], periods[3], velocity[3];
  through(ownership.box().data(), bodies.body[ibody].image.data(), away[0]);
  through(domain->h, images, away[1]);
  for (int k = 0; k < 3; ++k) away[1][k] = away[0][k] - away[1][k];
  to_periods(domain, away[1], periods);
  for (double &number : periods) number = std::round(number);
  through(rates, periods, velocity);
  add3(velocity, bodies.state[ibody].velocity);
  if (!step.started || ibody >= bodies.nmoved()) return;
  const Scheme &scheme = step.scheme();
  double *rows = bodies.history(ibody), *first = rows + scheme.width() + Scheme::POSITION;
  for (int k = 0; k < 3; ++k) first[k] += step.length() * velocity[k];
  if (!scheme.first()) return;
  const double mass = bodies.body[ibody].rigid.mass;
  for (int k = 0; k < 3; ++k) rows[Scheme::MOMENTUM + k] += mass * velocity[k];
}

/// Every rank changes the same body in the same way.
void FixGearQuat::follow_images()
{
  if (!driver) return;
  std::vector<Load> found(bodies.nhere());    // images, and whether faces change the velocity
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const int owner = ownership.owner_of(ibody);
    const auto image = sites.image_of({owner, ibody, {}});
    std::copy_n(image.begin(), 3, found[ibody].force);
    const bool passes = domain->deform_vremap && !bodies.body[ibody].fresh &&
        (atom->mask[owner] & domain->deform_groupbit);
    found[ibody].torque_space[0] = passes;
  }
  ownership.sum(found);
  ownership.spread(found);
  for (int ibody = 0; ibody < bodies.nhere(); ++ibody) {
    if (found[ibody].torque_space[0] != 0.0) pass_faces(ibody, found[ibody].force);
    std::copy_n(found[ibody].force, 3, bodies.body[ibody].image.begin());
  }
}

/// Bodies were made again.
void FixGearQuat::note_images()
{
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    bodies.body[ibody].image = sites.image_of({ownership.owner_of(ibody), ibody, {}});
}

/// A box of this fix that another command has changed begins again.  In a box with flow, LAMMPS would
/// wrap the atoms of bodies with the present motion of the faces, instead of the motion with which
/// their velocities were placed.
void FixGearQuat::setup_pre_exchange()
{
  for (int i = 0; atom->vest && i < atom->nlocal; ++i)    // no fix extrapolates the first ones
    if (ownership.in_body(i)) std::copy_n(atom->v[i], 3, atom->vest[i]);
  const auto &box = ownership.box();
  if (args.pressure.any() &&
      !(std::equal(domain->h, domain->h + 6, box.begin()) &&
        std::equal(domain->boxlo, domain->boxlo + 3, box.begin() + 6)))
    step.forget("Fix gear/quat: the box was changed since the last run; histories are rebuilt");
  if (!driver) return;
  note_images();
  follow_change();
  if (!domain->deform_vremap) return;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!ownership.in_body(i)) continue;
    auto passed = periods_of(atom->image[i]);
    domain->remap(atom->x[i], atom->image[i]);
    const auto now = periods_of(atom->image[i]);
    for (int k = 0; k < 3; ++k) passed[k] -= now[k];
    double flow[3];
    through(sites.rates_of_faces().data(), passed.data(), flow);
    add3(flow, atom->v[i]);
  }
}
