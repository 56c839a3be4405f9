/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_report.h"

#include "gear_quat_arguments.h"
#include "gear_quat_bodies.h"
#include "gear_quat_scene.h"
#include "gear_quat_surroundings.h"

#include "citeme.h"
#include "comm.h"
#include "domain.h"
#include "fix.h"
#include "utils.h"

#include <limits>
#include <string>
#include <vector>

using namespace LAMMPS_NS;
using namespace GearQuat;

namespace {

/// A row of the report.  omits: the contributions that are left out, with a bound.
struct Effect {
  const char *name;
  bool on;
  std::string reason;
  std::string omits;
  bool in_part = false;    ///< may leave out something while it is on
};

}    // namespace

static constexpr char NOTHING[] = "nothing: the trajectory is the same to the last bit";

/* ----------------------------------------------------------------------
   papers to cite; LAMMPS shows the first line of each
------------------------------------------------------------------------- */

static const char cite_first[] =
    "fix gear/quat: quaternions in the equations of motion, first-order form\n\n"
    "@Article{Evans1977,\n"
    " author = {Denis J. Evans},\n"
    " title = {On the Representation of Orientation Space},\n"
    " journal = {Molecular Physics},\n"
    " year = 1977,\n"
    " volume = 34,\n"
    " pages = {317--325}\n"
    "}\n\n";

static const char cite_second[] =
    "fix gear/quat: quaternions in the equations of motion, second-order form\n\n"
    "@Article{Rapaport1985,\n"
    " author = {Dennis C. Rapaport},\n"
    " title = {Molecular Dynamics Simulation Using Quaternions},\n"
    " journal = {Journal of Computational Physics},\n"
    " year = 1985,\n"
    " volume = 60,\n"
    " pages = {306--314}\n"
    "}\n\n";

static const char cite_cases[] =
    "fix gear/quat: both forms side by side, test cases\n\n"
    "@Misc{PrattZaini,\n"
    " author = {Ronald M. Pratt and Khairil Mazwan {Bin Mohamad Zaini}},\n"
    " title = {General Algorithms for {3-D} Motion of a Non-Planar Body in a Steady-State Force "
    "Field}\n"
    "}\n\n";

void GearQuat::add_citations(LAMMPS *lmp)
{
  if (!lmp->citeme) return;
  for (const char *paper : {cite_first, cite_second, cite_cases}) lmp->citeme->add(paper);
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
    if (scene.tops[top]) parts.push_back(fmt::format("{}: {}", TOPS[top], scene.tops[top]));
  return utils::join_words(parts, ", ");
}

static Effect rotation(const Scene &scene)
{
  const bool on = scene.tops[Scene::POINT] < scene.bodies;
  std::string omits;
  if (scene.tops[Scene::POINT] || scene.tops[Scene::LINEAR])
    omits =
        fmt::format("rotation about axes whose moment of inertia is below {:g} of the largest of "
                    "the body; of the energy of an equally fast one about that axis, less than "
                    "this",
                    LINEAR_FRACTION);
  return {"rotation", on, listed(scene), omits, true};
}

static Effect torques(const Scene &scene, bool forces)
{
  const bool on = scene.arms > 0 && forces;
  return {"torques of forces", on,
          !forces  ? "nothing in the scene makes forces"
              : on ? fmt::format("{} sites are off the center of mass", scene.arms)
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
  std::string reason = ranks == 1 ? "one rank"
      : scene.ghosts ? fmt::format("{} sites have their body on another rank", scene.ghosts)
                     : "every site is on the rank of its body";
  if (scene.large)
    reason +=
        fmt::format("; {} bodies reach further than ghost atoms, all ranks have them", scene.large);
  return {"ghost bodies", scene.ghosts > 0 || scene.large > 0, reason, NOTHING};
}

static Effect compensation(const Arguments &args, const Scene &scene)
{
  const double rounding = 0.5 * std::numeric_limits<double>::epsilon() * scene.farthest;
  return {"compensated sums", args.scheme.compensate,
          args.scheme.compensate ? "compensate yes" : "compensate no",
          fmt::format("rounding of a coordinate, at most {:.1e} of length in a sum", rounding)};
}

/// The rows of the report.
static std::vector<Effect> effects(LAMMPS *lmp, const Fix *fix, const Arguments &args,
                                   const Scene &scene)
{
  const std::string reader = reader_of_predicted_velocities(lmp, fix);
  const auto because = [](bool on, const std::string &yes, const std::string &no) {
    return on ? yes : no;
  };
  return {
      rotation(scene),
      torques(scene, makes_forces(lmp, fix)),
      {"finite size", scene.extended > 0,
       because(scene.extended, fmt::format("{} sites are more than points", scene.extended),
               "all sites are points"),
       NOTHING},
      images(lmp->domain),
      ghost_bodies(scene, lmp->comm->nprocs),
      {"masks", !args.masks.empty(),
       because(!args.masks.empty(), "keywords force and torque", "no keyword force or torque"),
       NOTHING},
      {"isokinetic", args.isokinetic != Isokinetic::NONE,
       because(args.isokinetic != Isokinetic::NONE, "keyword isokinetic", "isokinetic none"),
       NOTHING},
      {"virial", fix->thermo_virial != 0,
       because(fix->thermo_virial, "in steps that ask for pressure or stress",
               "fix_modify virial no"),
       "pressure and stress of the forces of constraint; of the trajectory nothing"},
      {"predicted velocities", !reader.empty(),
       because(!reader.empty(), reader, "nothing reads them"), NOTHING},
      compensation(args, scene),
      {"changing step", args.control.eps > 0.0,
       args.control.eps > 0.0 ? fmt::format("tolerance {:g}", args.control.eps) : "no tolerance",
       "control of the error of a step: it is what the time step makes it"},
  };
}

/* ---------------------------------------------------------------------- */

void GearQuat::report_scene(LAMMPS *lmp, const Fix *fix, const Arguments &args, Bodies &bodies)
{
  if (args.report == Arguments::Report::NO) return;
  const Scene scene(lmp, bodies);
  const Surroundings surroundings(lmp, fix, args, bodies);
  const auto rows = effects(lmp, fix, args, scene);
  if (lmp->comm->me != 0) return;

  const std::string sites = scene.fewest_sites == scene.most_sites
      ? fmt::format("{}", scene.most_sites)
      : fmt::format("{} to {}", scene.fewest_sites, scene.most_sites);
  std::string text = fmt::format("Fix gear/quat {}: {} bodies of {} sites, {} degrees of freedom\n",
                                 fix->id, scene.bodies, sites, scene.freedoms);
  for (const auto &row : rows) {
    text += fmt::format("  {:<20} {:<3}  {}\n", row.name, row.on ? "on" : "off", row.reason);
    if (args.report == Arguments::Report::LONG && (!row.on || row.in_part) && !row.omits.empty())
      text += fmt::format("  {:<20}      leaves out {}\n", "", row.omits);
  }
  for (const auto &line : surroundings.lines()) text += "  " + line + "\n";
  utils::logmesg(lmp, text);
}
