/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_driven_box.h"

#include "gear_quat_arguments.h"
#include "gear_quat_driven_cell.h"
#include "gear_quat_fixes.h"
#include "gear_quat_images.h"
#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"
#include "gear_quat_step.h"

#include "atom.h"
#include "domain.h"
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
   before a run
------------------------------------------------------------------------- */

void DrivenBox::init()
{
  driven = false;
  for (const auto *other : modify->get_fix_list()) {
    if (other == fix || !(other->box_change & (Fix::BOX_CHANGE_SIZE | Fix::BOX_CHANGE_SHAPE)))
      continue;
    driven = true;
    if (!known(FixFact::CARRIES_BODIES, other))
      error->all(FLERR,
                 "Fix gear/quat: fix {} ({}) changes the box without informing other fixes of "
                 "the remap, so bodies cannot follow; use fix deform, fix press/berendsen, or "
                 "fix npt on other atoms",
                 other->id, other->style);
    if (args.pressure.any())
      error->all(FLERR,
                 "Fix gear/quat: keywords of constant pressure change the box, and fix {} ({}) "
                 "changes it, too; leave out one of the two",
                 other->id, other->style);
    if (args.control.eps > 0.0)
      error->all(FLERR,
                 "Fix gear/quat tolerance cannot be used with fix {} ({}), whose box is a function "
                 "of the number of the step; leave out keyword tolerance",
                 other->id, other->style);
  }
  if (driven && domain->deform_vremap &&
      (args.thermostat.damp > 0.0 || args.isokinetic != Isokinetic::NONE))
    error->all(FLERR,
               "Fix gear/quat: the velocities of bodies contain the flow of fix deform remap v, "
               "which is not thermal motion; leave out keywords temp and isokinetic, or use "
               "remap x");
  drive(smooth_driver());
}

void DrivenBox::rest()
{
  driven = false;
  drive(nullptr);
}

/// The fix that moves the box and is followed with the order of the method, or null.  Fixes that
/// also integrate atoms are of second order, and a discontinuous box has no derivatives.
Fix *DrivenBox::smooth_driver() const
{
  Fix *driver = nullptr;
  for (auto *other : modify->get_fix_list()) {
    if (!(other->box_change & (Fix::BOX_CHANGE_SIZE | Fix::BOX_CHANGE_SHAPE))) continue;
    if (driver || !utils::strmatch(other->style, "^deform$")) return nullptr;
    driver = other;
  }
  const bool alone = ownership.number_of_atoms() == atom->natoms && args.masks.empty() &&
      args.isokinetic == Isokinetic::NONE && utils::strmatch(update->integrate_style, "^verlet");
  return driver && driver->nevery == 1 && alone ? driver : nullptr;
}

/// The variables of the thermostat are kept.
void DrivenBox::drive(Fix *deform)
{
  if (!deform && !cell) return;
  if (!deform == !!cell) {
    Fields kept;
    if (step.coupling) step.coupling->fields(kept);
    auto made = deform
        ? std::make_unique<DrivenCell>(lmp, fix, bodies, args.thermostat, step.scheme(), images)
        : nullptr;
    cell = made.get();
    step.set_coupling(made ? std::move(made) : make_coupling(lmp, fix, args, bodies, sites));
    Fields again(kept.numbers());
    if (step.coupling && !kept.numbers().empty()) step.coupling->fields(again);
  }
  if (cell) cell->obey(deform);
}

/* ----------------------------------------------------------------------
   atoms are remapped with the box
------------------------------------------------------------------------- */

void DrivenBox::begin_remap()
{
  if (!cell) ownership.note_box();    // otherwise bodies are in the box at the end of the step
}

void DrivenBox::end_step()
{
  if (!cell) return;
  ownership.note_box();
  cell->put_back_box();
}

void DrivenBox::end_remap()
{
  if (cell && cell->is_asking()) {
    cell->note_remap();
    return;
  }
  if (cell)
    cell->remap(ownership.box(), step.started);
  else
    remap_centers();
  place_sites();
}

void DrivenBox::remap_centers()
{
  const double *before = ownership.box().data();
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    const double *center = bodies.state_of(ibody).center;
    double moved[3], way[3];
    follow_box(domain, before, center, moved);
    for (int k = 0; k < 3; ++k) way[k] = moved[k] - center[k];
    move_center(ibody, way);
  }
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
  if (bodies.have_copies()) ownership.spread_moved();
  sites.place(false);
  ownership.note_box();
  if (step.is_within()) others.note_place();
}

/* ----------------------------------------------------------------------
   atoms do not move
------------------------------------------------------------------------- */

/// The displacement for this number of periods of a box.
static void through(const double *h, const double *periods, double *way)
{
  way[0] = h[0] * periods[0] + h[5] * periods[1] + h[4] * periods[2];
  way[1] = h[1] * periods[1] + h[3] * periods[2];
  way[2] = h[2] * periods[2];
}

/// Owned bodies have their values; copies of large bodies receive the values of their owners.
void DrivenBox::share(std::vector<Vector> &of_moved) const
{
  if (bodies.large.empty()) return;
  std::vector<double> here(3 * bodies.large.size(), 0.0), all(here.size());
  for (size_t n = 0; n < bodies.large.size(); ++n)
    if (bodies.large[n] < bodies.nowned())
      std::copy_n(of_moved[bodies.large[n]].data(), 3, &here[3 * n]);
  reduce(MPI_SUM, here.data(), all.data(), here.size(), world);
  for (size_t n = 0; n < bodies.large.size(); ++n)
    std::copy_n(&all[3 * n], 3, of_moved[bodies.large[n]].data());
}

std::vector<DrivenBox::Vector> DrivenBox::present_images()
{
  std::vector<Vector> found(bodies.nmoved(), Vector{});
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const auto periods = sites.image_of({ownership.owner_of(ibody), ibody, {}});
    for (int k = 0; k < 3; ++k) found[ibody][k] = periods[k];
  }
  share(found);
  return found;
}

/// Follows the box at the beginning or end of a run, or after a discontinuity of the box.
void DrivenBox::follow()
{
  if (driven) follow(domain->h, domain->boxlo);
}

void DrivenBox::begin_step()
{
  if (!driven) return;
  if (!cell) {
    follow();
    return;
  }
  const auto &then = cell->foretell();
  if (!cell->remaps_atoms()) follow(then.h.data(), then.h.data() + 6);
}

/// Follows the change to the box h with this corner.
void DrivenBox::follow(const double *h, const double *corner)
{
  const auto &box = ownership.box();
  const bool changed = !std::equal(h, h + 6, box.begin());
  if (changed || domain->deform_vremap || cell) images = present_images();
  if (!changed) return;
  double change[6], way[3];
  for (int k = 0; k < 6; ++k) change[k] = h[k] - box[k];
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    through(change, images[ibody].data(), way);
    move_center(ibody, way);
  }
  ownership.note_box(h, corner);
}

/// The periods by which LAMMPS is going to wrap this position, by the same comparisons.
static void wraps_of(Domain *domain, double *x, double *wraps)
{
  double fraction[3];
  if (domain->triclinic) domain->x2lamda(x, fraction);
  const double *place = domain->triclinic ? fraction : x;
  const double *low = domain->triclinic ? domain->boxlo_lamda : domain->boxlo;
  const double *high = domain->triclinic ? domain->boxhi_lamda : domain->boxhi;
  for (int k = 0; k < 3; ++k) {
    wraps[k] = 0.0;
    if (!domain->periodicity[k]) continue;
    if (place[k] < low[k]) wraps[k] = -1.0;
    if (place[k] >= high[k]) wraps[k] = 1.0;
  }
}

/// The change of the images of owner atoms, in periods, since follow(), including the next
/// wrapping.
std::vector<DrivenBox::Vector> DrivenBox::passed_faces()
{
  const auto now = present_images();
  const double *before = ownership.box().data();
  std::vector<Vector> passed(bodies.nmoved(), Vector{});
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const int owner = ownership.owner_of(ibody);
    if (!(atom->mask[owner] & domain->deform_groupbit)) continue;
    double away[2][3], periods[3], wraps[3];
    through(before, images[ibody].data(), away[0]);
    through(domain->h, now[ibody].data(), away[1]);    // fix deform may have flipped the box
    for (int k = 0; k < 3; ++k) away[1][k] -= away[0][k];
    to_periods(domain, away[1], periods);
    wraps_of(domain, atom->x[owner], wraps);
    for (int k = 0; k < 3; ++k) passed[ibody][k] = std::round(periods[k]) + wraps[k];
  }
  share(passed);
  return passed;
}

/// Velocity changes of bodies, by the atom IDs of owned bodies' owner atoms.
std::vector<DrivenBox::Passage> DrivenBox::pass_faces()
{
  std::vector<Passage> passages;
  if (!driven || !domain->deform_vremap) return passages;
  const auto passed = passed_faces();
  const double *rate = cell && step.is_within() ? cell->rate_of_faces().m.data() : domain->h_rate;
  for (int ibody = 0; ibody < bodies.nmoved(); ++ibody) {
    Passage one = {};
    through(rate, passed[ibody].data(), one.velocity);
    if (dot3(one.velocity, one.velocity) == 0.0) continue;
    for (double &component : one.velocity) component = -component;
    add_velocity(ibody, one.velocity);
    if (ibody >= bodies.nowned()) continue;
    one.owner = atom->tag[ownership.owner_of(ibody)];
    passages.push_back(one);
  }
  return passages;
}

void DrivenBox::add_velocity(int ibody, const double *velocity)
{
  double *of_state = bodies.change_state(ibody).velocity;
  for (int k = 0; k < 3; ++k) of_state[k] += velocity[k];
  if (!step.started) return;
  const Scheme &scheme = step.scheme();
  double *rows = bodies.history(ibody), *rates = rows + scheme.width() + Scheme::POSITION;
  for (int k = 0; k < 3; ++k) rates[k] += step.length() * velocity[k];
  if (!scheme.first()) return;
  const double mass = bodies.rigid_of(ibody).mass;
  for (int k = 0; k < 3; ++k) rows[Scheme::MOMENTUM + k] += mass * velocity[k];
}

/// LAMMPS would change the velocities of the atoms of a body one by one, so they are wrapped here.
void DrivenBox::pass_faces_before_run()
{
  follow();
  if (!driven || !domain->deform_vremap) return;
  auto mine = pass_faces();
  const auto passages = gather_sorted(mine, world);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!ownership.in_body(i)) continue;
    domain->remap(atom->x[i], atom->image[i]);
    for (const Passage &one : passages)
      if (one.owner == ownership.owner_tags()[i])
        for (int k = 0; k < 3; ++k) atom->v[i][k] += one.velocity[k];
  }
}

void DrivenBox::end_run()
{
  if (!driven) return;
  follow();
  place_sites();
}
