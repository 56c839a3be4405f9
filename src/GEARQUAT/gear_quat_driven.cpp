/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_driven.h"

#include "gear_quat_arguments.h"
#include "gear_quat_box.h"
#include "gear_quat_ranks.h"
#include "gear_quat_step.h"
#include "gear_quat_styles.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace GearQuat;

void Minimization::init()
{
  if (!utils::strmatch(update->minimize_style, "^cg") &&
      !utils::strmatch(update->minimize_style, "^sd"))
    error->all(
        FLERR,
        "Fix gear/quat cannot be used with min_style {}, which does not let fixes take part; "
        "use min_style cg or sd",
        update->minimize_style);
}

void Minimization::begin()
{
  std::vector<ArmSums> sums(bodies.nhere());
  for (const Site &site : sites) {
    const double *d = site.arm_body;
    add3(d, sums[site.body].arm);
    for (int n = 0; n < 9; ++n) sums[site.body].products[n] += d[n / 3] * d[n % 3];
  }
  ownership.sum(sums);
  tagint bad = 0;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    stored(ibody).arms = sums[ibody];
    const Load load = bodies.acting(ibody);
    if (!std::isfinite(length(load.force) + length(load.torque_space)))
      bad = bodies.body_at(ibody).id;
  }
  bad = over_ranks(MPI_MAX, bad, world);
  if (bad)
    error->all(FLERR,
               "Fix gear/quat: the force or torque on body {} is not a number, so it cannot be "
               "minimized; atoms must not be in the same place (see delete_atoms overlap)",
               bad);
}

void Minimization::fit()
{
  std::vector<Displacements> sums(bodies.nhere());
  for (const Site &site : sites) {
    Displacements &sum = sums[site.body];
    double found[3], expected[3], arm[3];
    sites.unwrapped(site, found, expected);
    to_space(bodies.axes(site.body), site.arm_body, arm);
    for (int a = 0; a < 3; ++a) {
      const double way = found[a] - expected[a];
      sum.way[a] += way;
      for (int b = 0; b < 3; ++b) sum.products[3 * a + b] += way * arm[b];
    }
  }
  ownership.sum(sums);
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const Move move = nearest_move(arms_of(ibody), bodies.body_at(ibody).off, sums[ibody]);
    BodyState &s = bodies.change_state(ibody);
    double q[4];
    w_times(move.rotation, s.q, q);
    std::copy_n(q, 4, s.q);
    add3(move.way, s.center);
    bodies.update_frame(ibody);
  }
  ownership.spread_moved();
  sites.place(false);
}

void Minimization::project(double **f)
{
  std::vector<Twist> twists(bodies.nhere());
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    Load load = bodies.load_of(ibody);
    for (int k = 0; k < 3; ++k) {
      load.force[k] /= force->ftm2v;
      load.torque_space[k] /= force->ftm2v;
    }
    twists[ibody] = nearest_twist(arms_of(ibody), bodies.body_at(ibody).off, load);
  }
  ownership.spread(twists);
  for (const Site &site : sites) {
    const Twist &of_body = twists[site.body];
    double arm[3];
    to_space(bodies.axes(site.body), site.arm_body, arm);
    cross3(of_body.turn, arm, f[site.atom]);
    add3(of_body.way, f[site.atom]);
  }
}

void Minimization::store()
{
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const BodyState &s = bodies.state_of(ibody);
    std::copy_n(s.center, 3, stored(ibody).center);
    std::copy_n(s.q, 4, stored(ibody).q);
  }
}

void Minimization::put_back()
{
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    BodyState &s = bodies.change_state(ibody);
    std::copy_n(stored(ibody).center, 3, s.center);
    std::copy_n(stored(ibody).q, 4, s.q);
    bodies.update_frame(ibody);
  }
}

/* ----------------------------------------------------------------------
   a box that another fix changes: before a run
------------------------------------------------------------------------- */

static bool changes_box(const Fix *one)
{
  return one->box_change & (Fix::BOX_CHANGE_SIZE | Fix::BOX_CHANGE_SHAPE);
}

void DrivenBox::init()
{
  driver = nullptr;
  for (const auto *other : modify->get_fix_list()) {
    if (other == fix || !changes_box(other)) continue;
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

void DrivenBox::end_remap()
{
  const double *before = ownership.box().data();
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const double *center = bodies.state_of(ibody).center;
    double moved[3], way[3];
    follow_box(domain, before, center, moved);
    for (int k = 0; k < 3; ++k) way[k] = moved[k] - center[k];
    move_center(ibody, way);
  }
  place_sites();
}

/// Moves the centers of the state and of the history.
void DrivenBox::move_center(int ibody, const double *way)
{
  double *center = bodies.change_state(ibody).center;
  for (int k = 0; k < 3; ++k) center[k] += way[k];
  if (!step.started) return;
  double *row = bodies.history(ibody) + Scheme::POSITION;
  for (int k = 0; k < 3; ++k) row[k] += way[k];
}

void DrivenBox::place_sites()
{
  ownership.spread_moved();
  sites.place(false);
  ownership.note_box();
}

/* ----------------------------------------------------------------------
   atoms do not move
------------------------------------------------------------------------- */

void DrivenBox::follow()
{
  const auto &box = ownership.box();
  if (!driver || std::equal(domain->h, domain->h + 6, box.begin())) return;
  double change[6], way[3];
  for (int k = 0; k < 6; ++k) change[k] = domain->h[k] - box[k];
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    through(change, bodies.body_at(ibody).image.data(), way);
    move_center(ibody, way);
  }
  ownership.note_box();
}

/// The body keeps its velocity relative to the faces that its owner atom has crossed since the last
/// call, also if fix deform has flipped the box.  images: of the owner atom, now.
void DrivenBox::pass_faces(int ibody, const double *images)
{
  const double *rates = step.phase == Phase::BEGUN ? domain->h_rate : sites.rates_of_faces().data();
  double away[2][3], periods[3], velocity[3];
  through(ownership.box().data(), bodies.body_at(ibody).image.data(), away[0]);
  through(domain->h, images, away[1]);
  for (int k = 0; k < 3; ++k) away[1][k] = away[0][k] - away[1][k];
  to_periods(domain, away[1], periods);
  for (double &number : periods) number = std::round(number);
  through(rates, periods, velocity);
  add3(velocity, bodies.change_state(ibody).velocity);
  if (!step.started || ibody >= bodies.nmoved()) return;
  const Scheme &scheme = step.scheme();
  double *rows = bodies.history(ibody), *first = rows + scheme.width() + Scheme::POSITION;
  for (int k = 0; k < 3; ++k) first[k] += step.length() * velocity[k];
  if (!scheme.first()) return;
  const double mass = bodies.rigid_of(ibody).mass;
  for (int k = 0; k < 3; ++k) rows[Scheme::MOMENTUM + k] += mass * velocity[k];
}

/// Every rank changes the same body in the same way.
void DrivenBox::follow_images()
{
  if (!driver) return;
  std::vector<Load> found(bodies.nhere());    // images, and whether faces change the velocity
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const int owner = ownership.owner_of(ibody);
    const auto image = sites.image_of({owner, ibody, {}});
    std::copy_n(image.begin(), 3, found[ibody].force);
    const bool passes = domain->deform_vremap && !bodies.body_at(ibody).fresh &&
        (atom->mask[owner] & domain->deform_groupbit);
    found[ibody].torque_space[0] = passes;
  }
  ownership.sum(found);
  ownership.spread(found);
  for (int ibody = 0; ibody < bodies.nhere(); ++ibody) {
    if (found[ibody].torque_space[0] != 0.0) pass_faces(ibody, found[ibody].force);
    std::copy_n(found[ibody].force, 3, bodies.change_body(ibody).image.begin());
  }
}

void DrivenBox::note_images()
{
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    bodies.change_body(ibody).image = sites.image_of({ownership.owner_of(ibody), ibody, {}});
}

/// A moving box that another command has changed begins again.
/// LAMMPS would wrap the atoms of bodies with the present motion of the faces, instead of the motion
/// with which their velocities were placed.
void DrivenBox::begin_setup()
{
  const auto &box = ownership.box();
  if (args.pressure.any() &&
      !(std::equal(domain->h, domain->h + 6, box.begin()) &&
        std::equal(domain->boxlo, domain->boxlo + 3, box.begin() + 6)))
    step.forget("Fix gear/quat: the box was changed since the last run; histories are rebuilt");
  if (!driver) return;
  note_images();
  follow();
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

void DrivenBox::end_run()
{
  if (!driver) return;
  follow();
  place_sites();
}
