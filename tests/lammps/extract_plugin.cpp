/* A command for tests: prints what fix gear/quat hands out by Fix::extract(), summed over ranks.
     extract_test fix-ID template-ID   (NULL for no template) */

#include "lammpsplugin.h"

#include "atom.h"
#include "comm.h"
#include "command.h"
#include "error.h"
#include "fix.h"
#include "modify.h"
#include "version.h"

#include <cstring>

using namespace LAMMPS_NS;

class ExtractTest : public Command {
 public:
  ExtractTest(LAMMPS *lmp) : Command(lmp) {}

  void command(int, char **arg) override
  {
    fix = modify->get_fix_by_id(arg[0]);
    const auto *body = (const int *) get("body", 1);
    const auto *mass = (const double *) get("masstotal", 1);
    const int nbody = *(const int *) get("nbody", 0);

    // atoms in bodies, of sensible numbers; masses of the bodies of all these atoms; bodies that ranks know

    double here[4] = {0, 0, 0, double(nbody)}, all[4];
    for (int i = 0; i < atom->nlocal; ++i) {
      if (body[i] < 0) continue;
      here[0] += 1.0;
      if (body[i] < nbody) here[1] += 1.0;
      here[2] += mass[body[i]];
    }
    MPI_Allreduce(here, all, 4, MPI_DOUBLE, MPI_SUM, world);

    Molecule **molecules = nullptr;
    if (strcmp(arg[1], "NULL") != 0) molecules = &atom->molecules[atom->find_molecule(arg[1])];
    const int same = molecules == (Molecule **) get("onemol", 0);
    int dim;
    const int unknown = fix->extract("nonsense", dim) == nullptr;
    if (comm->me == 0)
      utils::logmesg(lmp, "extracted {} {} {:.17g} {} {} {}\n", all[0], all[1], all[2], same, unknown, all[3]);
  }

 private:
  Fix *fix;

  const void *get(const char *name, int expected)
  {
    int dim = -1;
    const void *found = fix->extract(name, dim);
    if (dim != expected) error->all(FLERR, "{} has dimension {}", name, dim);
    return found;
  }
};

static Command *create(LAMMPS *lmp)
{
  return new ExtractTest(lmp);
}

extern "C" void lammpsplugin_init(void *lmp, void *handle, void *regfunc)
{
  lammpsplugin_t plugin;
  plugin.version = LAMMPS_VERSION;
  plugin.style = "command";
  plugin.name = "extract_test";
  plugin.info = "for the tests of GEARQUAT";
  plugin.author = "GEARQUAT";
  plugin.creator.v1 = (lammpsplugin_factory1 *) &create;
  plugin.handle = handle;
  ((lammpsplugin_regfunc) regfunc)(&plugin, lmp);
}
