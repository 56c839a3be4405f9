/* A command for tests: forces and all arrays that are cleared with them, by GEARQUAT between steps and by LAMMPS.
     evaluate_test ARRAY ...
   After a run 0 without post_force() of any fix.  The named per-atom arrays, forces and torques of owned and ghost
   atoms are set to 1 before each of two evaluations; prints for each array the largest value that LAMMPS had left, and
   the largest difference. */

#include "plugin_api.h"

#include "gear_quat_forces.h"

#include "atom.h"
#include "command.h"
#include "comm.h"
#include "error.h"
#include "modify.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace LAMMPS_NS;

class EvaluateTest : public Command {
 public:
  EvaluateTest(LAMMPS *lmp) : Command(lmp) {}

  void command(int narg, char **arg) override
  {
    std::vector<std::string> names(arg, arg + narg);
    names.emplace_back("f");
    if (atom->torque_flag) names.emplace_back("torque");
    std::vector<std::vector<double>> left;
    for (const auto &name : names) left.push_back(values_of(name));

    std::vector<const Fix *> owners;
    for (const auto *fix : modify->get_fix_by_style("^gear/quat")) owners.push_back(fix);
    GearQuat::Forces forces(lmp, owners);
    const std::string text = forces.reason();    // that of an evaluation for the step, if there is one
    for (int again = 0; again < 2; ++again) {
      for (const auto &name : names) poison(name);
      forces.evaluate();
    }
    for (size_t n = 0; n < names.size(); ++n) {
      const std::vector<double> found = values_of(names[n]);
      double here[2] = {0.0, 0.0}, all[2];
      for (size_t k = 0; k < found.size(); ++k) {
        here[0] = std::max(here[0], std::fabs(left[n][k]));
        here[1] = std::max(here[1], std::fabs(found[k] - left[n][k]));
      }
      MPI_Allreduce(here, all, 2, MPI_DOUBLE, MPI_MAX, world);
      if (comm->me == 0)
        utils::logmesg(lmp, "evaluated {} {:.17g} {:.17g}\n", names[n], all[0], all[1]);
    }
    if (comm->me == 0) utils::logmesg(lmp, "reason: {}\n", text);
  }

 private:
  /// An array of doubles, and its columns.
  std::pair<double *, int> array(const std::string &name)
  {
    for (const auto &one : atom->peratom) {
      if (one.name != name || one.datatype != Atom::DOUBLE) continue;
      if (one.cols == 0) return {*static_cast<double **>(one.address), 1};
      return {(*static_cast<double ***>(one.address))[0], one.cols};
    }
    error->all(FLERR, "no array {}", name);
    return {nullptr, 0};
  }

  std::vector<double> values_of(const std::string &name)
  {
    const auto [data, columns] = array(name);
    const int cleared = atom->firstgroup >= 0 ? atom->nfirst : atom->nlocal;    // of owned atoms
    return std::vector<double>(data, data + (size_t) columns * cleared);
  }

  void poison(const std::string &name)
  {
    const auto [data, columns] = array(name);
    std::fill_n(data, (size_t) columns * (atom->nlocal + atom->nghost), 1.0);
  }
};

static void *create(void *lmp)
{
  return new EvaluateTest(static_cast<LAMMPS *>(lmp));
}

extern "C" void lammpsplugin_init(void *lmp, void *handle, void *regfunc)
{
  gearquat_plugin::Style style{};
  style.lammps_version = "any";
  style.category = "command";
  style.name = "evaluate_test";
  style.description = "for the tests of GEARQUAT";
  style.author = "GEARQUAT";
  style.creator.v1 = &create;
  style.handle = handle;
  reinterpret_cast<gearquat_plugin::RegisterStyle *>(regfunc)(&style, lmp);
}
