/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Before a run: what is refused, and the report about the simulation.  In it and at its end: the
   table of rates, the limits of a step, and the end of a run in which a body has become unstable. */

#include "gear_quat_ranks.h"
#include "gear_quat_step.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "pair.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ----------------------------------------------------------------------
   what is refused
------------------------------------------------------------------------- */

/// Forces are evaluated once per step, so all levels of r-RESPA need the same time step.
void Step::refuse_scene() const
{
  const bool runs = update->whichflag != 2;
  if (runs && (update->dt == 0.0 || !std::isfinite(update->dt)))
    error->all(FLERR, "Fix gear/quat requires a time step that is not zero, it is {}", update->dt);
  const std::vector<double> steps = respa_steps(lmp);
  for (size_t level = 1; level < steps.size() && runs; ++level)
    if (steps[level] != steps[0])
      error->all(FLERR,
                 "Fix gear/quat requires run_style respa to have the same step at all levels "
                 "(loop factors of 1); levels 1 and {} have {} and {}",
                 level + 1, steps[0], steps[level]);
  for (auto *other : modify->get_fix_list()) {
    if (other == fix || !other->time_integrate) continue;
    tagint shared = 0;
    for (int i = 0; i < atom->nlocal; ++i)
      if (ownership.in_body(i) && fleet.moves(other, atom, i)) shared = atom->tag[i];
    shared = over_ranks(MPI_MAX, shared, world);
    if (shared)
      error->all(
          FLERR,
          "Fix gear/quat: atom {} is also moved by {}; take it out of the group of one of the "
          "two",
          shared, name_of(other));
  }
}

/// Other fixes that change velocities, positions or masses of the atoms of bodies end the run, now or
/// when the change occurs.
void Step::refuse_fixes()
{
  watched.clear();
  for (auto *other : modify->get_fix_list()) {
    const Style *row = known(Fact::ON_ATOMS, other);
    const bool heats = args.thermostat.damp > 0.0 && other->ecouple_flag && !other->time_integrate;
    if (other == fix || (!row && !heats)) continue;
    const tagint shared = shared_atom(lmp, ownership, other);
    if (heats && shared)
      error->all(FLERR,
                 "Fix gear/quat {} is a thermostat of the bodies, and {} is another one; "
                 "leave out one of the two, or give the other one a group without atoms of bodies",
                 args.thermostat.keyword(), name_of(other));
    if (!row) continue;
    if (row->is(Fact::ANY))
      error->all(FLERR, "Fix gear/quat cannot be used with {}: bodies do not follow it; {}",
                 name_of(other), row->instead);
    if (row->is(Fact::REFLECTION) || (row->is(Fact::EXCHANGE) && !args.mol.empty()))
      watched.push_back(other);
    else if (shared && !(row->is(Fact::CONSTRAINED) && other->dof(fix->igroup) == 0) &&
             !(row->is(Fact::AT_INTEGRATION) &&
               !(modify->get_fix_mask(other) & FixConst::INITIAL_INTEGRATE)))
      error->all(FLERR,
                 "Fix gear/quat: {} changes atoms of bodies, such as atom {}, and bodies do not "
                 "follow; {}",
                 name_of(other), shared, row->instead);
  }
}

/// Rank 0 warns of forces that the number of values in the command cannot follow.
void Step::warn_of_noise() const
{
  if (args.control.eps > 0.0) return;
  const NoisyForces found = noise_of_forces(lmp, ownership);
  const bool first = args.scheme.first() && found.noise == Noise::RANDOM;
  if (!first && (args.automatic_values || suits_noise(args.scheme, found.noise))) return;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Fix gear/quat: {}, and {} cannot follow them; leave out keywords {}values and "
                   "corrector",
                   found.words(),
                   first ? "formulation first" : fmt::format("{} values", args.scheme.values()),
                   first ? "formulation, " : "");
}

void Step::watch_places() const
{
  if (watched.empty()) return;
  std::vector<std::string> names;
  for (const auto *one : watched) names.push_back(name_of(one));
  for (const Site &site : sites)
    if (sites.displacement(site) != 0.0)
      error->one(FLERR,
                 "Fix gear/quat: {} has moved atom {} of body {} in step {}, and bodies do not "
                 "follow; {}",
                 utils::join_words(names, " or "), atom->tag[site.atom], bodies.body[site.body].id,
                 update->ntimestep, known(Fact::ON_ATOMS, watched.front())->instead);
}

/* ----------------------------------------------------------------------
   the report
------------------------------------------------------------------------- */

namespace {

// labels of an atom: the ID of its body, or one of these

constexpr double STILL = 0.0, MOVED_BY_OTHERS = -1.0;

class Report : protected Scene {
 public:
  explicit Report(const Scene &scene) : Scene(scene) {}
  std::string effects() const;
  /// Warns of own pairs that interact; returns sentences about pairs, each with a line for the input
  /// script.
  std::string pairs(const Fleet &fleet) const;

 private:
  // bodies by their principal moments; moments are equal if they differ by less than 1e-7 of the
  // largest
  enum { POINT, LINEAR, SPHERICAL, SYMMETRIC, ASYMMETRIC, PLANAR, TOPS };
  enum { BODIES = TOPS, FREEDOMS, OFF_CENTER, EXTENDED, OF_GHOSTS, COUNTS };
  int top_of(const RigidBody &rigid) const;
  std::vector<double> labels(const Fleet &fleet) const;
  std::string exclude_own() const;
  bool meets_itself() const;
};

int Report::top_of(const RigidBody &rigid) const
{
  double i[3];
  std::copy_n(rigid.inertia, 3, i);
  std::sort(i, i + 3);
  if (i[2] <= 0.0) return POINT;
  if (domain->dimension == 2) return PLANAR;
  if (i[0] <= 0.0) return LINEAR;
  const bool low = i[1] - i[0] < LINEAR_FRACTION * i[2];
  const bool high = i[2] - i[1] < LINEAR_FRACTION * i[2];
  if (low && high) return SPHERICAL;
  return low || high ? SYMMETRIC : ASYMMETRIC;
}

/// The title and a row for each effect.  Collective.
std::string Report::effects() const
{
  bigint here[COUNTS] = {};
  tagint sizes[2] = {-MAXTAGINT, 0};    // the fewest atoms of a body, negative, and the most
  here[BODIES] = bodies.nowned();
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body[ibody];
    ++here[top_of(body.rigid)];
    here[FREEDOMS] += body.rigid.freedoms(domain->dimension);
    sizes[0] = std::max(sizes[0], -body.natoms);
    sizes[1] = std::max(sizes[1], body.natoms);
  }
  for (const Site &site : sites) {
    here[OFF_CENTER] += dot3(site.arm_body, site.arm_body) > 0.0;
    here[OF_GHOSTS] += site.body >= bodies.nowned();
  }
  here[EXTENDED] = sites.number_of_extended();
  const auto count = over_ranks(MPI_SUM, here, world);
  const auto most = over_ranks(MPI_MAX, sizes, world);

  const tagint fewest = count[BODIES] ? -most[0] : 0;
  std::string text = fmt::format("Fix gear/quat {}: {} bodies of ", fix->id, count[BODIES]);
  if (fewest != most[1]) text += fmt::format("{} to ", fewest);
  text += fmt::format("{} sites, {} degrees of freedom\n", most[1], count[FREEDOMS]);

  const auto row = [&](const char *name, bool on, const std::string &reason) {
    text += fmt::format("  {:<20} {:<3}  {}\n", name, on ? "on" : "off", reason);
  };
  static const char *const NAMES[] = {"points",         "linear",          "spherical tops",
                                      "symmetric tops", "asymmetric tops", "in a plane"};
  std::vector<std::string> tops;
  for (int top = 0; top < TOPS; ++top)
    if (count[top]) tops.push_back(fmt::format("{}: {}", NAMES[top], count[top]));
  row("rotation", count[POINT] < count[BODIES], utils::join_words(tops, ", "));
  row("torques of forces", count[OFF_CENTER] > 0,
      count[OFF_CENTER] ? fmt::format("{} sites are off the center of mass", count[OFF_CENTER])
                        : "every site is at its center of mass");
  row("finite size", count[EXTENDED] > 0,
      count[EXTENDED] ? fmt::format("{} sites are more than points", count[EXTENDED])
                      : "all sites are points");
  std::string axes;
  for (int k = 0; k < 3; ++k)
    if (domain->periodicity[k]) axes += std::string(" ") + "xyz"[k];
  row("images", !axes.empty(),
      axes.empty() ? "no direction is periodic"
                   : "periodic in" + axes + "; while sites are in other images");
  const size_t large = bodies.large.size();
  std::string ghosts = comm->nprocs == 1 ? "one rank" : "every site is on the rank of its body";
  if (count[OF_GHOSTS])
    ghosts = fmt::format("{} sites have their body on another rank", count[OF_GHOSTS]);
  if (large)
    ghosts += fmt::format("; {} bodies reach further than ghost atoms, all ranks have them", large);
  row("ghost bodies", count[OF_GHOSTS] > 0 || large > 0, ghosts);
  row("virial", fix->thermo_virial != 0,
      fix->thermo_virial ? "in steps that ask for pressure or stress" : "fix_modify virial no");
  const std::string reader = reader_of_predicted_velocities(lmp, fix);
  row("predicted velocities", !reader.empty(), reader.empty() ? "nothing reads them" : reader);

  const auto by_keyword = [&](const char *name, bool on, const std::string &keyword) {
    row(name, on, (on ? "keyword " : "no keyword ") + keyword);
  };
  by_keyword("masks", !args.masks.empty(), "force or torque");
  by_keyword("isokinetic", args.isokinetic != Isokinetic::NONE, "isokinetic");
  by_keyword("thermostat", args.thermostat.damp > 0.0,
             args.thermostat.is_random() ? "langevin" : "temp");
  by_keyword("barostat", args.pressure.any(), "of a pressure");
  by_keyword("changing step", args.control.eps > 0.0, "tolerance");
  by_keyword("compensated sums", args.scheme.compensate, "compensate");
  return text;
}

/* ----------------------------------------------------------------------
   pairs of atoms that cost time and move nothing
------------------------------------------------------------------------- */

std::vector<double> Report::labels(const Fleet &fleet) const
{
  std::vector<double> made(atom->nlocal + atom->nghost, STILL);
  const auto &fixes = modify->get_fix_list();
  for (int i = 0; i < atom->nlocal; ++i)
    if (ownership.in_body(i))
      made[i] = (double) ownership.id_of(i);
    else if (std::any_of(fixes.begin(), fixes.end(), [&](Fix *other) {
               return other != fix && other->time_integrate && fleet.moves(other, atom, i);
             }))
      made[i] = MOVED_BY_OTHERS;
  ownership.spread_labels(made);
  return made;
}

std::string Report::pairs(const Fleet &fleet) const
{
  constexpr double WORTH = 0.01;                      // minimum share of pairs for a line
  const std::vector<double> label = labels(fleet);    // of atoms, including ghosts: what moves them
  const bool is_own = !meets_itself();
  const bool acts = force->pair && strcmp(force->pair_style, "zero") != 0;
  bigint here[5] = {};    // pairs, among still atoms, within bodies; still atoms; forces in bodies
  const auto visit = [&](int i, int j, int bonded) {
    ++here[0];
    if (label[i] != label[j] || label[i] == MOVED_BY_OTHERS) return;
    ++here[label[i] == STILL ? 1 : 2];
    here[4] += is_own && acts && label[i] != STILL &&
        (force->special_lj[bonded] != 0.0 || force->special_coul[bonded] != 0.0) &&
        distance2(atom->x[i], atom->x[j]) < force->pair->cutsq[atom->type[i]][atom->type[j]];
  };
  for (int which = 0; which < neighbor->nlist; ++which) {    // of pair styles in every step
    const NeighList *list = neighbor->lists[which];
    if (!list || list->requestor_type != NeighList::PAIR || list->occasional || list->kokkos ||
        !list->ilist)
      continue;
    for (int ii = 0; ii < list->inum; ++ii) {
      const int i = list->ilist[ii];
      for (int jj = 0; jj < list->numneigh[i]; ++jj) {
        const int j = list->firstneigh[i][jj];
        visit(i, j & NEIGHMASK, j >> SBBITS & 3);
      }
    }
  }
  here[3] = std::count(label.begin(), label.begin() + atom->nlocal, STILL);
  const auto all = over_ranks(MPI_SUM, here, world);
  if (all[4] > 0 && comm->me == 0)
    // the energy of overlapping atoms may be so large that all others are lost in rounding
    error->warning(FLERR,
                   "Fix gear/quat {}: pair style {} acts between {} pairs of atoms within bodies; "
                   "{}; the line that leaves them out: {}",
                   fix->id, force->pair_style, all[4],
                   known_pair(Fact::RANDOM | Fact::DISSIPATIVE, force)
                       ? "their friction may brake the rotation of bodies"
                       : "these forces do not move bodies, but they take time and add a constant "
                         "to the energy, which is large where atoms overlap",
                   exclude_own());

  std::string text;
  const auto add = [&](bigint some, const std::string &what, const std::string &line) {
    if (some == 0 || (double) some < WORTH * (double) all[0]) return;
    text +=
        fmt::format("  {} of {} pairs in the neighbor lists ({:.0f} %) are {}; without them, and "
                    "the constant they add to the energy:\n    {}\n",
                    some, all[0], 100.0 * (double) some / (double) all[0], what, line);
  };
  std::vector<std::string> moving;
  for (auto *other : modify->get_fix_list())
    if (other->time_integrate &&
        !std::count(moving.begin(), moving.end(), group->names[other->igroup]))
      moving.emplace_back(group->names[other->igroup]);
  // in a box that moves, these forces count in the pressure
  add(args.pressure.any() ? 0 : all[1], fmt::format("among {} atoms that no fix moves", all[3]),
      fmt::format("group still subtract all {}; neigh_modify exclude group still still",
                  utils::join_words(moving, " ")));
  add(is_own ? all[2] : 0, "within bodies and do not move them", exclude_own());
  return text;
}

/// True if a body may be large enough to interact with its periodic image, so that these forces
/// move it.  Collective.
bool Report::meets_itself() const
{
  double extent = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    extent = std::max(extent, bodies.body[ibody].extent);
  const double largest = over_ranks(MPI_MAX, extent, world);
  for (int k = 0; k < 3; ++k)
    if (domain->periodicity[k] && domain->prd[k] < 2.0 * largest + neighbor->cutneighmax)
      return true;
  return false;
}

std::string Report::exclude_own() const
{
  using Style = Arguments::BodyStyle;
  if (args.bodystyle == Style::GROUP) {
    std::string line = "neigh_modify";
    for (const auto &body : args.groups) line += fmt::format(" exclude group {0} {0}", body);
    return line;
  }
  std::string name = group->names[fix->igroup], before;
  if (!args.points.empty()) {    // flexible molecules keep the forces between their atoms
    before = fmt::format("group rigid subtract {} {}; ", name, args.points);
    name = "rigid";
  }
  if (args.bodystyle == Style::SINGLE)
    return before + fmt::format("neigh_modify exclude group {0} {0}", name);
  return before + "neigh_modify exclude molecule/intra " + name +
      (args.bodystyle == Style::CUSTOM ? ", with a molecule ID for every body" : "");
}

}    // namespace

void Step::report() const
{
  const Report report(*this);
  const std::string of_pairs = report.pairs(fleet);
  if (!args.report) return;
  const std::string text = report.effects() + of_pairs;
  if (comm->me == 0) utils::logmesg(lmp, text);
}

/* ----------------------------------------------------------------------
   the table of rates
------------------------------------------------------------------------- */

std::string GearQuat::words_of(const Rate &rate)
{
  return fmt::format("{} {:.2g} in a step, and the method follows {:.2g}; {}", rate.what,
                     rate.radians, rate.limit, rate.remedy);
}

/// The rows of bodies, for the present step.  edge: radians of vibrations in a step, infinite if
/// unknown.  Collective.
void Step::note_rates(double edge)
{
  rates.clear();
  if (tolerance) return;
  const bool noisy = noise_of_forces(lmp, ownership).noise != Noise::NONE;
  if (noisy || !std::isfinite(edge)) edge = 0.0;
  const double h = std::fabs(length());
  const auto add = [&](const char *what, double radians, double limit, double advised) {
    rates.push_back({what, radians, limit,
                     fmt::format("use a time step of {:.4g} or shorter", h * advised / radians)});
  };
  double omega = 0.0;
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody)
    omega = std::max(omega, GearQuat::length(bodies.state[ibody].omega_body));
  omega = over_ranks(MPI_MAX, omega, world);
  // free rotations are exact in formulation momentum, but the forces on them are not
  constexpr double PART = 2.0 / 3.0, TURN = 0.5;
  const double longest = longest_edge(scheme()), stable = fastest_oscillation(scheme());
  add("the angle of vibrations is", edge, longest, PART * longest);
  add("the angle by which the fastest body turns is", h * omega,
      scheme().momentum() ? MotionLimits::TURN : stable, std::min(PART * stable, TURN));
}

/// The bath is first, because it also accelerates bodies.
std::vector<Rate> Step::all_rates(double h) const
{
  std::vector<Rate> table = bath.rates(h);
  table.insert(table.end(), rates.begin(), rates.end());
  return table;
}

/// Rank 0 warns once of the first rate that is too large; others may have the same cause.
void Step::warn_of_rates()
{
  if (tolerance) return;
  for (const auto &rate : all_rates(length())) {
    if (!(rate.part() > 1.0)) continue;
    if (warned != rate.what && comm->me == 0)
      error->warning(FLERR, "Fix gear/quat {}: {}", fix->id, words_of(rate));
    warned = rate.what;
    return;
  }
}

/* ----------------------------------------------------------------------
   limits
------------------------------------------------------------------------- */

/// Ends the run if the load of a body is no number: atoms are at its positions; f: forces on them.
void Step::watch_load(int ibody, double **f) const
{
  const Load &l = bodies.load[ibody];
  if (!std::isfinite(GearQuat::length(l.force) + GearQuat::length(l.torque_space)))
    stop(ibody, bodies.state[ibody], length(), f);
}

/// Ends the run on all ranks, called by the rank that owns the body (for a large one, by all of them
/// together).  The message gives step, time, body, its motion and load, its atom with the largest
/// force, and one remedy.  s: the resulting state, beyond the limits.
void Step::stop(int ibody, const BodyState &s, double h, double **f) const
{
  double largest = -1.0;    // force on an atom; infinite if it is not a finite number
  tagint worst = 0;
  for (const Site &site : sites) {
    if (site.body != ibody) continue;
    const double size = GearQuat::length(f[site.atom]);
    if (std::isfinite(size) && size <= largest) continue;
    largest = std::isfinite(size) ? size : HUGE_VAL;
    worst = atom->tag[site.atom];
  }
  const bool large = bodies.is_large(ibody);
  if (large && over_ranks(MPI_MAX, largest, world) > largest) worst = 0;
  if (large) worst = over_ranks(MPI_MAX, worst, world);
  const std::string text = fmt::format(
      "Fix gear/quat: blow-up in step {}, time {:g}: body {} {}; the largest force acts on its "
      "atom {}; {}",
      update->ntimestep, time_step.time_of(update->ntimestep), bodies.body[ibody].id,
      what_happened(ibody, s, h), worst, remedy(ibody, h));
  if (large) error->all(FLERR, text);
  error->one(FLERR, text);
}

std::string Step::what_happened(int ibody, const BodyState &s, double h) const
{
  const Load &l = bodies.load[ibody];
  const double push = GearQuat::length(l.force) / force->ftm2v;
  const double twist = GearQuat::length(l.torque_space) / force->ftm2v;
  if (!std::isfinite(push + twist)) return "meets a force or torque that is not a finite number";
  return fmt::format(
      "moves by {:g} and turns by {:g} radians in one step, under a force of {:g} and a torque of "
      "{:g}",
      GearQuat::length(s.velocity) * std::fabs(h), GearQuat::length(s.omega_body) * std::fabs(h),
      push, twist);
}

std::string Step::remedy(int ibody, double h) const
{
  constexpr char APART[] = "begin with atoms farther apart, for example after minimize or a run "
                           "with keywords tolerance and temp";
  constexpr double OVERLAP = 100.0;    // times the limit: due to an overlap, and not to the step
  const Load &l = bodies.load[ibody];
  const double size = std::fabs(h);
  if (!std::isfinite(GearQuat::length(l.force) + GearQuat::length(l.torque_space))) return APART;

  for (const auto &rate : all_rates(h))
    if (rate.part() > 1.0) return rate.part() < OVERLAP ? words_of(rate) : APART;
  if (tolerance)
    return fmt::format("use a smaller tolerance, a dtmax shorter than {:g}, and no dtmin", size);
  return fmt::format("halve the time step, {:g}, until the run is stable; atoms that overlap have "
                     "to begin farther apart",
                     size);
}
