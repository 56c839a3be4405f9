/* Declarations in classes of LAMMPS that have the members, and in classes that do not. */

#include "checks.h"

#include "gear_quat_declared.h"

using namespace LAMMPS_NS::GearQuat;

namespace {

struct OldPair {
  int one_coeff = 1;
};
struct NewPair {
  int repeatable = UNDECLARED, no_net_force = UNDECLARED;
};
class ClosedPair {
  int repeatable = 1;    // not for other classes

 public:
  int no_net_force = 1;
  int own() const { return repeatable; }
};

struct OldRun {
  int cleared = 0;
  void force_clear() { ++cleared; }
};
struct NewRun {
  int evaluate_forces_flag = 1, eflag = 0, vflag = 0;
  void evaluate_forces(int e, int v)
  {
    eflag = e;
    vflag = v;
  }
};

}    // namespace

TEST(Declared, NothingWithoutTheMembers)
{
  const OldPair pair;
  EXPECT_EQ(declared_repeatable(&pair), UNDECLARED);
  EXPECT_EQ(declared_no_net_force(&pair), UNDECLARED);
  const ClosedPair closed;
  EXPECT_EQ(closed.own(), 1);
  EXPECT_EQ(declared_repeatable(&closed), UNDECLARED);
  EXPECT_EQ(declared_no_net_force(&closed), 1);
  OldRun run;
  EXPECT_FALSE(evaluated_by(&run, 1, 2));
  EXPECT_EQ(run.cleared, 0);
}

TEST(Declared, WhatTheMembersSay)
{
  NewPair pair;
  EXPECT_EQ(declared_repeatable(&pair), UNDECLARED);
  for (const int flag : {0, 1}) {
    pair.repeatable = flag;
    pair.no_net_force = 1 - flag;
    EXPECT_EQ(declared_repeatable(&pair), flag);
    EXPECT_EQ(declared_no_net_force(&pair), 1 - flag);
  }
}

TEST(Declared, ARunStyleEvaluatesIfItCan)
{
  NewRun run;
  EXPECT_TRUE(evaluated_by(&run, 1, 2));
  EXPECT_EQ(run.eflag, 1);
  EXPECT_EQ(run.vflag, 2);
  NewRun other;
  other.evaluate_forces_flag = 0;
  EXPECT_FALSE(evaluated_by(&other, 1, 2));
  EXPECT_EQ(other.vflag, 0);
}
