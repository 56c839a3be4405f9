/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_arguments.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

static constexpr char INTEGRATION[] = "integration", STEP[] = "step", BODIES[] = "bodies",
                      PHYSICS[] = "physics", OUTPUT[] = "output";

static constexpr char HELD[] =
    "it acts on all momenta; define a second fix for bodies whose motion is restricted";
static constexpr char ONE_TEMPERATURE[] =
    "both keep the kinetic energy of the bodies; leave out one of the two";
static constexpr char MOVING_BOX[] = "with a moving box it is not possible yet";
static constexpr char REMEMBERED[] =
    "with a tolerance, bodies remember their last loads, as many as reduce the error";
static constexpr char RENUMBERED[] = "the numbers of bodies change when bodies are inserted";

using Value = KeywordValue;

/* ----------------------------------------------------------------------
   the table; the reasons for the defaults are in doc/decisions.md
------------------------------------------------------------------------- */

/// A keyword that makes components of the pressure constant.
static Keyword pressure(const char *name, const char *meaning, Keyword::Store store)
{
  Keyword row(name, PHYSICS, meaning, store);
  row.numbers({"Pstart", "Pstop", "Pdamp"}, 2)
      .cannot_go_with({"isokinetic", "", "constant kinetic energy needs a constant box"});
  for (const char *other : {"mol", "force", "torque"}) row.cannot_go_with({other, "", MOVING_BOX});
  return row;
}

// clang-format off

static const std::vector<Keyword> TABLE = {
  Keyword("formulation", INTEGRATION, "which equations of motion are integrated",
          [](Arguments &a, const Value &v) {
            a.scheme.formulation = v.is("first") ? Formulation::FIRST
                : v.is("second")                 ? Formulation::SECOND
                                                 : Formulation::MOMENTUM;
          }).word({"momentum", "second", "first"}).cannot_go_with({"tolerance", "", REMEMBERED}),
  Keyword("values", INTEGRATION, "how many values a history keeps of each function",
          [](Arguments &a, const Value &v) { a.scheme.rows = v.integer; })
      .integer({{SECOND_FEWEST, SECOND_MOST, 9, 8}, {FIRST_FEWEST, FIRST_MOST, 8, 6}})
      .or_auto().cannot_go_with({"tolerance", "", REMEMBERED}),
  Keyword("corrector", INTEGRATION, "which coefficients correct a history",
          [](Arguments &a, const Value &v) { a.scheme.tuned = v.is("tuned"); })
      .word({"tuned", "gear"})
      .standard_with("formulation", "second", "gear").standard_with("formulation", "first", "gear")
      .requires_also({"formulation", "momentum", "the others have Gear's coefficients", "tuned"})
      .cannot_go_with({"tolerance", "", REMEMBERED}),
  Keyword("passes", INTEGRATION, "how many corrections a step makes with the same forces",
          [](Arguments &a, const Value &v) { a.scheme.passes = v.integer; })
      .integer({{1, 2, 2}}),
  Keyword("compensate", INTEGRATION, "whether sums are compensated for round-off",
          [](Arguments &a, const Value &v) { a.scheme.compensate = v.is("yes"); })
      .word({"no", "yes"}).standard_with("tolerance", "", "yes"),
  Keyword("start", INTEGRATION, "which derivatives a history begins with",
          [](Arguments &a, const Value &v) {
            a.start = v.is("zero") ? Arguments::Start::ZERO : Arguments::Start::BOOTSTRAP;
          }).word({"bootstrap", "zero"}).cannot_go_with({"tolerance", "", REMEMBERED}),
  Keyword("project", INTEGRATION, "whether quaternions are projected to unit length",
          [](Arguments &a, const Value &v) { a.scheme.project = v.is("yes"); })
      .word({"yes", "no"}),
  Keyword("tolerance", STEP, "the largest error of a step, to which the time step is adapted",
          [](Arguments &a, const Value &v) {
            a.control.eps = v.number * v.unit;
            a.control.energy = v.measure == "energy";
          }).number({"length", "energy"}),
  Keyword("dtmin", STEP, "the time step does not become shorter",
          [](Arguments &a, const Value &v) { a.control.shortest = v.number; })
      .number().requires_also({"tolerance", "", ""}),
  Keyword("dtmax", STEP, "the time step does not become longer",
          [](Arguments &a, const Value &v) { a.control.longest = v.number; })
      .number().requires_also({"tolerance", "", ""}),
  Keyword("every/time", STEP, "the interval of time at whose multiples steps end",
          [](Arguments &a, const Value &v) { a.every_time = v.number; })
      .number().requires_also({"tolerance", "", ""}),
  Keyword("infile", BODIES, "the file that states bodies",
          [](Arguments &a, const Value &v) { a.infile = v.text; })
      .follows(Keyword::NAME, {"filename"}),
  Keyword("reinit", BODIES, "whether bodies adopt changes of their atoms between runs",
          [](Arguments &a, const Value &v) { a.reinit = v.is("yes"); })
      .word({"yes", "no"})
      .cannot_go_with({"infile", "yes", "the file states the bodies once and for all"}),
  Keyword("mol", BODIES, "the template of bodies that other fixes insert",
          [](Arguments &a, const Value &v) { a.mol = v.text; })
      .follows(Keyword::NAME, {"template-ID"}).requires_also({"bodystyle", "molecule", ""})
      .cannot_go_with({"isokinetic", "", "inserted bodies add kinetic energy"}),
  Keyword("force", PHYSICS, "which components of the total force act on bodies M",
          [](Arguments &a, const Value &v) { a.masks.push_back(v.mask); })
      .follows(Keyword::MASK, {"M", "xflag", "yflag", "zflag"})
      .cannot_go_with({"mol", "", RENUMBERED}).cannot_go_with({"isokinetic", "", HELD}),
  Keyword("torque", PHYSICS, "which components of the total torque act on bodies M",
          [](Arguments &a, const Value &v) { a.masks.push_back(v.mask); })
      .follows(Keyword::MASK, {"M", "xflag", "yflag", "zflag"})
      .cannot_go_with({"mol", "", RENUMBERED}).cannot_go_with({"isokinetic", "", HELD}),
  Keyword("isokinetic", PHYSICS, "which kinetic energy of all bodies is kept constant",
          [](Arguments &a, const Value &v) {
            a.isokinetic = v.is("total") ? Isokinetic::TOTAL
                : v.is("separate")       ? Isokinetic::SEPARATE
                                         : Isokinetic::NONE;
          }).word({"none", "total", "separate"})
      .requires_also({"formulation", "first", "its constraint is part of equations of the first "
                      "order"}),
  Keyword("rescale", PHYSICS, "whether momenta are scaled to exactly that energy",
          [](Arguments &a, const Value &v) { a.rescale = v.is("yes"); })
      .word({"yes", "no"}).requires_also({"isokinetic", "", ""}),
  Keyword("temp", PHYSICS, "the temperature of all bodies, at the beginning and at the end of a run",
          [](Arguments &a, const Value &v) {
            a.thermostat.start = v.numbers[0];
            a.thermostat.stop = v.numbers[1];
            a.thermostat.damp = v.numbers[2];
          }).follows(Keyword::NUMBERS, {"Tstart", "Tstop", "Tdamp"})
      .cannot_go_with({"isokinetic", "", ONE_TEMPERATURE}),
  Keyword("tchain", PHYSICS, "how many variables a thermostat has",
          [](Arguments &a, const Value &v) { a.thermostat.length = v.integer; })
      .integer({{1, Chain::LONGEST, 3}}).requires_also({"temp", "", ""}),
  Keyword("thermostat", PHYSICS, "whether translation and rotation have one thermostat each",
          [](Arguments &a, const Value &v) { a.thermostat.separate = v.is("separate"); })
      .word({"total", "separate"}).requires_also({"temp", "", ""}),
  pressure("iso", "the pressure, which changes all edges of the box by the same factor",
           [](Arguments &a, const Value &v) {
             a.pressure.set_all(v.numbers);
             std::fill_n(a.pressure.tied, 3, 0);
           }),
  pressure("aniso", "the pressure along each edge of the box, and each edge changes independently",
           [](Arguments &a, const Value &v) { a.pressure.set_all(v.numbers); }),
  pressure("tri", "the pressure along each edge of a triclinic box, without shear stress",
           [](Arguments &a, const Value &v) {
             a.pressure.set_all(v.numbers);
             for (int k = 3; k < 6; ++k) a.pressure.set(k, {0.0, 0.0, v.numbers[2]});
           }),
  pressure("x", "the pressure along x, which changes that edge of the box",
           [](Arguments &a, const Value &v) { a.pressure.set(0, v.numbers); }),
  pressure("y", "the pressure along y, which changes that edge of the box",
           [](Arguments &a, const Value &v) { a.pressure.set(1, v.numbers); }),
  pressure("z", "the pressure along z, which changes that edge of the box",
           [](Arguments &a, const Value &v) { a.pressure.set(2, v.numbers); }),
  pressure("xy", "the shear component xy of the pressure, which changes that tilt",
           [](Arguments &a, const Value &v) { a.pressure.set(5, v.numbers); }),
  pressure("xz", "the shear component xz of the pressure, which changes that tilt",
           [](Arguments &a, const Value &v) { a.pressure.set(4, v.numbers); }),
  pressure("yz", "the shear component yz of the pressure, which changes that tilt",
           [](Arguments &a, const Value &v) { a.pressure.set(3, v.numbers); }),
  Keyword("couple", PHYSICS, "which edges of the box change by the same factor, due to their "
                             "mean pressure",
          [](Arguments &a, const Value &v) {
            int *tied = a.pressure.tied;
            if (v.is("xyz")) tied[0] = tied[1] = tied[2] = 0;
            if (v.is("xy")) tied[1] = 0;
            if (v.is("yz")) tied[2] = 1;
            if (v.is("xz")) tied[2] = 0;
          }).word({"none", "xyz", "xy", "yz", "xz"}),
  Keyword("pchain", PHYSICS, "how many variables the thermostat of the box has",
          [](Arguments &a, const Value &v) { a.pressure.length = v.integer; })
      .integer({{0, Chain::LONGEST, 3}}),
  Keyword("ptemp", PHYSICS, "the temperature that determines the mass of the box, without temp",
          [](Arguments &a, const Value &v) { a.pressure.temperature = v.number; })
      .number().cannot_go_with({"temp", "", "the temperature of temp determines the mass of the "
                                            "box"}),
  Keyword("flip", PHYSICS, "whether a box that is tilted by more than half a period is replaced",
          [](Arguments &a, const Value &v) { a.pressure.flip = v.is("yes"); }).word({"yes", "no"}),
  Keyword("dilate", PHYSICS, "the atoms that follow the box: all, because all are in bodies",
          [](Arguments &, const Value &) {}).word({"all"}),
  Keyword("fixedpoint", PHYSICS, "the point of the box that does not move",
          [](Arguments &a, const Value &v) { a.pressure.fixed = v.numbers; })
      .numbers({"x", "y", "z"}, 3),
  Keyword("report", OUTPUT, "what the log says about the scene",
          [](Arguments &a, const Value &v) {
            a.report = v.is("no") ? Arguments::Report::NO
                : v.is("long")    ? Arguments::Report::LONG
                                  : Arguments::Report::SHORT;
          }).word({"no", "short", "long"}, "short"),
  Keyword("preset", INTEGRATION, "whose choices apply to keywords that are not given",
          [](Arguments &, const Value &) {}).word({"none", "paper"}),
  Keyword("c0", INTEGRATION, "which right-hand sides the first coefficient belongs to",
          [](Arguments &a, const Value &v) { a.scheme.velocity_c0 = v.is("velocity"); })
      .word({"position", "velocity"}).requires_also({"formulation", "second", ""}),
  Keyword("omega", INTEGRATION, "which angular velocity corrects the quaternion",
          [](Arguments &a, const Value &v) { a.scheme.predicted_omega = v.is("predicted"); })
      .word({"corrected", "predicted"}).requires_also({"formulation", "first", ""}),
  Keyword("momentum", INTEGRATION, "which momentum corrects the position",
          [](Arguments &a, const Value &v) { a.scheme.predicted_momentum = v.is("predicted"); })
      .word({"corrected", "predicted"}).requires_also({"formulation", "first", ""}),
};

// clang-format on

const std::vector<Keyword> &GearQuat::keyword_table()
{
  return TABLE;
}
