/* A command for tests: collective calls that differ between ranks.
     calls_test equal | missing | order */

#include "lammpsplugin.h"

#include "gear_quat_ranks.h"

#include "command.h"
#include "version.h"

#include <cstring>

using namespace LAMMPS_NS;

class CallsTest : public Command {
 public:
  CallsTest(LAMMPS *lmp) : Command(lmp) {}

  void command(int, char **arg) override
  {
    const bool missing = strcmp(arg[0], "missing") == 0, order = strcmp(arg[0], "order") == 0;
    if (!missing || comm->me == 0) GearQuat::over_ranks(MPI_SUM, 1.0, world);
    for (const bool first : {true, false}) {
      const bool largest = first == (order && comm->me == 0);
      if (largest) GearQuat::over_ranks(MPI_MAX, 1.0, world);
      if (!largest) GearQuat::over_ranks(MPI_MIN, 1.0, world);
    }
    GearQuat::compare_calls(world);
    if (comm->me == 0) utils::logmesg(lmp, "equal calls\n");
  }
};

static Command *create(LAMMPS *lmp)
{
  return new CallsTest(lmp);
}

extern "C" void lammpsplugin_init(void *lmp, void *handle, void *regfunc)
{
  lammpsplugin_t plugin;
  plugin.version = LAMMPS_VERSION;
  plugin.style = "command";
  plugin.name = "calls_test";
  plugin.info = "for the tests of GEARQUAT";
  plugin.author = "GEARQUAT";
  plugin.creator.v1 = (lammpsplugin_factory1 *) &create;
  plugin.handle = handle;
  ((lammpsplugin_regfunc) regfunc)(&plugin, lmp);
}
