/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_report.h"

#include "gear_quat_arguments.h"
#include "gear_quat_bodies.h"
#include "gear_quat_known_styles.h"
#include "gear_quat_ranks.h"
#include "gear_quat_scene.h"
#include "gear_quat_sites.h"

#include "citeme.h"
#include "comm.h"
#include "domain.h"
#include "fix.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace GearQuat;

namespace {

/// The bodies of the simulation, the same on all ranks.
struct Scene {
  /// Bodies by their principal moments; moments are equal if they differ by less than 1e-7 of the
  /// largest.
  enum Top { POINT, LINEAR, SPHERICAL, SYMMETRIC, ASYMMETRIC, PLANAR, TOPS };
  enum { BODIES = TOPS, FREEDOMS, SITES_OFF_CENTER, EXTENDED_SITES, SITES_OF_GHOSTS, COUNTS };

  std::array<bigint, COUNTS> count;    ///< bodies of each kind, and of all kinds listed here
  bigint fewest_sites, most_sites;     ///< of a body
  bigint large;                        ///< bodies that every rank has
  double farthest;                     ///< largest coordinate of a center of mass, unwrapped
};

/// A row of the report.  omits: the omitted contributions, with a bound.
struct Effect {
  const char *name;
  bool on;
  std::string reason;
  std::string omits;
  bool in_part = false;    ///< may omit something while it is on
};

}    // namespace

static constexpr char NOTHING[] = "nothing: the trajectory is the same to the last bit";

/* ----------------------------------------------------------------------
   papers to cite; LAMMPS shows the first line of each
------------------------------------------------------------------------- */

static const char cite_first[] =
    "fix gear/quat: quaternions in the equations of motion, first-order form: "
    "https://doi.org/10.1080/00268977700101751\n\n"
    "@Article{Evans1977,\n"
    " author = {Denis J. Evans},\n"
    " title = {On the Representation of Orientation Space},\n"
    " journal = {Molecular Physics},\n"
    " year = 1977,\n"
    " volume = 34,\n"
    " pages = {317--325}\n"
    "}\n\n";

static const char cite_second[] =
    "fix gear/quat: quaternions in the equations of motion, second-order form: "
    "https://doi.org/10.1016/0021-9991(85)90009-9\n\n"
    "@Article{Rapaport1985,\n"
    " author = {Dennis C. Rapaport},\n"
    " title = {Molecular Dynamics Simulation Using Quaternions},\n"
    " journal = {Journal of Computational Physics},\n"
    " year = 1985,\n"
    " volume = 60,\n"
    " pages = {306--314}\n"
    "}\n\n";

static const char cite_isokinetic[] =
    "fix gear/quat isokinetic: constant kinetic energy by Gauss' principle: "
    "https://doi.org/10.1103/PhysRevA.28.1016\n\n"
    "@Article{EvansGauss1983,\n"
    " author = {Denis J. Evans and William G. Hoover and Bruce H. Failor and Bill Moran and "
    "Anthony "
    "J. C. Ladd},\n"
    " title = {Nonequilibrium Molecular Dynamics via {Gauss's} Principle of Least Constraint},\n"
    " journal = {Physical Review A},\n"
    " year = 1983,\n"
    " volume = 28,\n"
    " pages = {1016--1021}\n"
    "}\n\n";

static const char cite_chains[] =
    "fix gear/quat temp: chains of thermostats: https://doi.org/10.1063/1.463940\n\n"
    "@Article{Martyna1992,\n"
    " author = {Glenn J. Martyna and Michael L. Klein and Mark Tuckerman},\n"
    " title = {{Nos\\'e--Hoover} Chains: The Canonical Ensemble via Continuous Dynamics},\n"
    " journal = {Journal of Chemical Physics},\n"
    " year = 1992,\n"
    " volume = 97,\n"
    " pages = {2635--2643}\n"
    "}\n\n";

static const char cite_pressure[] =
    "fix gear/quat iso, aniso, x, y and z: constant pressure: https://doi.org/10.1063/1.467468\n\n"
    "@Article{Martyna1994,\n"
    " author = {Glenn J. Martyna and Douglas J. Tobias and Michael L. Klein},\n"
    " title = {Constant Pressure Molecular Dynamics Algorithms},\n"
    " journal = {Journal of Chemical Physics},\n"
    " year = 1994,\n"
    " volume = 101,\n"
    " pages = {4177--4189}\n"
    "}\n\n";

static const char cite_adams[] =
    "fix gear/quat tolerance: method of Adams with variable step and order\n\n"
    "@Book{Shampine1975,\n"
    " author = {L. F. Shampine and M. K. Gordon},\n"
    " title = {Computer Solution of Ordinary Differential Equations: The Initial Value Problem},\n"
    " publisher = {Freeman},\n"
    " year = 1975\n"
    "}\n\n";

static const char cite_gear[] =
    "fix gear/quat: predictor-corrector method\n\n"
    "@Book{Gear1971,\n"
    " author = {C. William Gear},\n"
    " title = {Numerical Initial Value Problems in Ordinary Differential Equations},\n"
    " publisher = {Prentice-Hall},\n"
    " year = 1971\n"
    "}\n\n";

void GearQuat::add_citations(LAMMPS *lmp, const Arguments &args)
{
  if (!lmp->citeme) return;
  lmp->citeme->add(args.scheme.remembers ? cite_adams : cite_gear);
  if (args.scheme.first()) lmp->citeme->add(cite_first);
  if (args.scheme.formulation == Formulation::SECOND) lmp->citeme->add(cite_second);
  if (args.isokinetic != Isokinetic::NONE) lmp->citeme->add(cite_isokinetic);
  if (args.thermostat.damp > 0.0) lmp->citeme->add(cite_chains);
  if (args.pressure.any()) lmp->citeme->add(cite_pressure);
}

/* ----------------------------------------------------------------------
   bodies
------------------------------------------------------------------------- */

static Scene::Top top_of(const RigidBody &rigid, int dimension)
{
  double i[3];
  std::copy_n(rigid.inertia, 3, i);
  std::sort(i, i + 3);
  if (i[2] <= 0.0) return Scene::POINT;
  if (dimension == 2) return Scene::PLANAR;
  if (i[0] <= 0.0) return Scene::LINEAR;
  const bool low = i[1] - i[0] < LINEAR_FRACTION * i[2],
             high = i[2] - i[1] < LINEAR_FRACTION * i[2];
  if (low && high) return Scene::SPHERICAL;
  return low || high ? Scene::SYMMETRIC : Scene::ASYMMETRIC;
}

/// Collective; bodies: after their ghosts were updated.
static Scene look_at(LAMMPS *lmp, const Bodies &bodies, const Ownership &ownership,
                     const Sites &sites)
{
  const int dimension = lmp->domain->dimension;
  bigint here[Scene::COUNTS] = {};
  double largest_here[3] = {0.0, -(double) MAXTAGINT, 0.0};
  here[Scene::BODIES] = bodies.nowned();
  for (int ibody = 0; ibody < bodies.nowned(); ++ibody) {
    const Body &body = bodies.body_at(ibody);
    ++here[top_of(body.rigid, dimension)];
    here[Scene::FREEDOMS] += body.rigid.freedoms(dimension);
    for (const double x : bodies.state_of(ibody).center)
      largest_here[0] = std::max(largest_here[0], std::fabs(x));
    largest_here[1] = std::max(largest_here[1], -(double) body.natoms);
    largest_here[2] = std::max(largest_here[2], (double) body.natoms);
  }
  for (const Site &site : sites) {
    here[Scene::SITES_OFF_CENTER] += dot3(site.arm_body, site.arm_body) > 0.0;
    here[Scene::SITES_OF_GHOSTS] += site.body >= bodies.nowned();
  }
  here[Scene::EXTENDED_SITES] = sites.number_of_extended();
  const auto count = over_ranks(MPI_SUM, here, lmp->world);
  const auto largest = over_ranks(MPI_MAX, largest_here, lmp->world);
  const bool any = count[Scene::BODIES] > 0;
  return {count, any ? (bigint) -largest[1] : 0, any ? (bigint) largest[2] : 0,
          ownership.number_of_large(), largest[0]};
}

/* ----------------------------------------------------------------------
   effects
------------------------------------------------------------------------- */

static std::string listed(const Scene &scene)
{
  static const char *const TOPS[] = {"points",         "linear",          "spherical tops",
                                     "symmetric tops", "asymmetric tops", "in a plane"};
  std::vector<std::string> parts;
  for (int top = 0; top < Scene::TOPS; ++top)
    if (scene.count[top]) parts.push_back(fmt::format("{}: {}", TOPS[top], scene.count[top]));
  return utils::join_words(parts, ", ");
}

static Effect rotation(const Scene &scene)
{
  const bool on = scene.count[Scene::POINT] < scene.count[Scene::BODIES];
  std::string omits;
  if (scene.count[Scene::POINT] || scene.count[Scene::LINEAR])
    omits =
        fmt::format("rotation about axes whose moment of inertia is below {:g} of the largest of "
                    "the body; of the energy of an equally fast one about that axis, less than "
                    "this",
                    LINEAR_FRACTION);
  return {"rotation", on, listed(scene), omits, true};
}

static Effect torques(const Scene &scene, bool forces)
{
  const bigint arms = scene.count[Scene::SITES_OFF_CENTER];
  const bool on = arms > 0 && forces;
  return {"torques of forces", on,
          !forces  ? "nothing in the scene makes forces"
              : on ? fmt::format("{} sites are off the center of mass", arms)
                   : "every site is at its center of mass",
          NOTHING};
}

static Effect images(const Domain *domain)
{
  std::string axes;
  if (domain->xperiodic) axes += " x";
  if (domain->yperiodic) axes += " y";
  if (domain->zperiodic) axes += " z";
  return {"images", !axes.empty(),
          axes.empty() ? "no direction is periodic"
                       : "periodic in" + axes + "; while sites are in other images",
          NOTHING};
}

static Effect ghost_bodies(const Scene &scene, int ranks)
{
  const bigint sites = scene.count[Scene::SITES_OF_GHOSTS];
  std::string reason = ranks == 1 ? "one rank"
      : sites                     ? fmt::format("{} sites have their body on another rank", sites)
                                  : "every site is on the rank of its body";
  if (scene.large)
    reason +=
        fmt::format("; {} bodies reach further than ghost atoms, all ranks have them", scene.large);
  return {"ghost bodies", sites > 0 || scene.large > 0, reason, NOTHING};
}

static Effect compensation(const Arguments &args, const Scene &scene)
{
  const double rounding = 0.5 * std::numeric_limits<double>::epsilon() * scene.farthest;
  return {"compensated sums", args.scheme.compensate,
          args.scheme.compensate ? "compensate yes" : "compensate no",
          fmt::format("rounding of a coordinate, at most {:.1e} of length in a sum", rounding)};
}

/// The control of the kinetic energy: at most one keyword.
static Effect temperature(const Arguments &args)
{
  const ThermostatWords &words = args.thermostat;
  const bool isokinetic = args.isokinetic != Isokinetic::NONE;
  if (words.damp == 0.0)
    return {"isokinetic", isokinetic, isokinetic ? "keyword isokinetic" : "isokinetic none",
            NOTHING};
  return {"thermostat", true,
          fmt::format("temp {:g} {:g} {:g}, tchain {}, {}", words.start, words.stop, words.damp,
                      words.length, words.separate ? "separate" : "total"),
          NOTHING};
}

/// The rows of the report.
static std::vector<Effect> effects(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                                   const Scene &scene)
{
  const std::string reader = reader_of_predicted_velocities(lmp, fix);
  const bigint extended = scene.count[Scene::EXTENDED_SITES];
  const bool masks = !args.masks.empty();
  std::vector<Effect> rows = {
      rotation(scene),
      torques(scene, makes_forces(lmp, fix)),
      {"finite size", extended > 0,
       extended ? fmt::format("{} sites are more than points", extended) : "all sites are points",
       NOTHING},
      images(lmp->domain),
      ghost_bodies(scene, lmp->comm->nprocs),
      {"masks", masks, masks ? "keywords force and torque" : "no keyword force or torque", NOTHING},
      temperature(args),
      {"virial", fix->thermo_virial != 0,
       fix->thermo_virial ? "in steps that ask for pressure or stress" : "fix_modify virial no",
       "pressure and stress of the forces of constraint; of the trajectory nothing"},
      {"predicted velocities", !reader.empty(), reader.empty() ? "nothing reads them" : reader,
       NOTHING},
      compensation(args, scene),
      {"changing step", args.control.eps > 0.0,
       args.control.eps > 0.0 ? args.words_of_control() : "no tolerance",
       "control of the error of a step: the time step determines it"},
  };
  if (args.pressure.any()) rows.push_back({"barostat", true, args.words_of_pressure(), ""});
  return rows;
}

/// Settings of the integration.
static std::string settings(const Arguments &args)
{
  const Scheme &scheme = args.scheme;
  if (scheme.remembers)
    return fmt::format("  formulation {}, at most {} remembered loads\n",
                       word_of(scheme.formulation), MOST_LOADS);
  const std::string values = args.automatic_values ? "values auto"
                                                   : fmt::format("{} values", scheme.values());
  const std::string passes = scheme.momentum()
      ? ""
      : fmt::format(" {} pass{},", scheme.passes, scheme.passes == 1 ? "" : "es");
  return fmt::format("  formulation {}, {},{} corrector {}\n", word_of(scheme.formulation), values,
                     passes, scheme.tuned ? "tuned" : "gear");
}

/* ---------------------------------------------------------------------- */

void GearQuat::report_scene(LAMMPS *lmp, const Fix *fix, const Arguments &args, const Fleet &fleet,
                            const Bodies &bodies, Ownership &ownership, const Sites &sites)
{
  const auto advice = advice_on_surroundings(lmp, fix, args, fleet, bodies, ownership);
  if (args.report == Arguments::Report::NO) return;
  const Scene scene = look_at(lmp, bodies, ownership, sites);
  const auto rows = effects(lmp, fix, args, scene);
  if (lmp->comm->me != 0) return;

  const std::string numbers = scene.fewest_sites == scene.most_sites
      ? fmt::format("{}", scene.most_sites)
      : fmt::format("{} to {}", scene.fewest_sites, scene.most_sites);
  std::string text =
      fmt::format("Fix gear/quat {}: {} bodies of {} sites, {} degrees of freedom\n", fix->id,
                  scene.count[Scene::BODIES], numbers, scene.count[Scene::FREEDOMS]);
  text += settings(args);
  for (const auto &row : rows) {
    text += fmt::format("  {:<20} {:<3}  {}\n", row.name, row.on ? "on" : "off", row.reason);
    if (args.report == Arguments::Report::LONG && (!row.on || row.in_part) && !row.omits.empty())
      text += fmt::format("  {:<20}      leaves out {}\n", "", row.omits);
  }
  if (args.report == Arguments::Report::LONG) {
    text += "  forces that can be evaluated again in a step\n";
    for (const auto &line : repeatable_forces(lmp)) text += "    " + line + "\n";
  }
  for (const auto &line : advice) text += "  " + line + "\n";
  utils::logmesg(lmp, text);
}
