/* Sections of restart files, the lengths of an atom's data, and files of releases without
   sections. */

#include "checks.h"

#include "gear_quat_restart_old.h"
#include "gear_quat_sections.h"

#include <cstring>

using LAMMPS_NS::GearQuat::AtomParts;
using LAMMPS_NS::GearQuat::Release030;
using LAMMPS_NS::GearQuat::Sections;
using Numbers = Sections::Numbers;

namespace {

Sections some()
{
  Sections file;
  file.put("tolerance", {9.0, -2.5, 1.0e-300});
  file.put("sixteen letters.", {0.1});
  file.put("nothing", {});
  return file;
}

double bits(std::int64_t integer)
{
  double number;
  std::memcpy(&number, &integer, sizeof(number));
  return number;
}

}    // namespace

TEST(Sections, AreReadAsTheyWereWritten)
{
  Sections file;
  ASSERT_TRUE(file.unpack(some().packed()));
  EXPECT_EQ(file.get("sixteen letters."), Numbers({0.1}));
  EXPECT_TRUE(file.has("nothing", 0));
  EXPECT_FALSE(file.has("nothing", 1));
  EXPECT_FALSE(file.has("other", 0));
  EXPECT_EQ(file.packed(), some().packed());
  const double tolerance[3] = {9.0, -2.5, 1.0e-300};
  Check::holds_and_refuses_one_percent(file.get("tolerance"), [&](const Numbers &v) {
    return v.size() == 3 && std::equal(v.begin(), v.end(), tolerance);
  });
}

TEST(Sections, NumbersThatAreMissingHaveADefault)
{
  const Sections file = some();
  EXPECT_EQ(file.number("tolerance", 1), -2.5);
  EXPECT_EQ(file.number("tolerance", 3), 0.0);
  EXPECT_EQ(file.number("tolerance", 3, 7.0), 7.0);
  EXPECT_EQ(file.number("isokinetic", 0, 7.0), 7.0);
  EXPECT_TRUE(file.get("isokinetic").empty());
}

TEST(Sections, UnknownOnesArePassedOver)
{
  Sections later = some(), file;
  later.put("barostat", {1.0, 2.0});
  later.put("tolerance", {9.0, -2.5, 1.0e-300, 4.0});
  ASSERT_TRUE(file.unpack(later.packed()));
  EXPECT_EQ(file.number("tolerance", 2), 1.0e-300);
  EXPECT_EQ(file.number("sixteen letters.", 0), 0.1);
}

TEST(Sections, WhatIsNotWholeIsRefused)
{
  const Numbers whole = some().packed();
  Sections file;
  for (size_t size = 0; size < whole.size(); ++size) {
    Numbers cut(whole.begin(), whole.begin() + (std::ptrdiff_t) size);
    EXPECT_FALSE(file.unpack(cut)) << size;
    if (size >= (size_t) Sections::HEAD) cut[2] = (double) size;    // truncated by the writer
    // the rest is valid if it ends between two sections
    EXPECT_EQ(file.unpack(cut), size == 3 || size == 6 || size == 10) << size;
    EXPECT_EQ(file.has("tolerance", 0), false);
  }
  for (const double count : {-1.0, 3.1e9, 4.0, std::nan("")}) {
    Numbers wrong = whole;
    wrong[12] = count;    // of the last section
    EXPECT_FALSE(file.unpack(wrong)) << count;
    EXPECT_FALSE(file.has("nothing", 0));
  }
  Check::holds_and_refuses_one_percent({whole[0], whole[1], whole[2]}, [&](const Numbers &head) {
    Numbers buf = whole;
    std::copy(head.begin(), head.end(), buf.begin());
    return file.unpack(buf);
  });
}

/// For a body with an extended site, a body without one, an atom that owns no body, and an atom in
/// no body.
TEST(AtomParts, AreLengthenedAndCutOff)
{
  const AtomParts older = {2, 3, 2, 1, 1, 1}, later = {3, 4, 3, 1, 2, 1};
  const double id = bits(7), history = bits(2), none = bits(0);
  const Numbers owner = {id, 0.1, 1, 2, 3, history, 4, 5, 6, 7, 8, 9, 10};
  const Numbers longer = {id, 0.1, 0, 1, 2, 3, 0, history, 4, 5, 0, 6, 7, 0, 8, 9, 10};
  EXPECT_EQ(older.converted(owner.data(), later, true), longer);
  EXPECT_EQ(later.converted(longer.data(), older, true), owner);
  EXPECT_EQ(older.converted(owner.data(), older, true), owner);

  const Numbers point = {id, 0.1, 0, none}, longer_point = {id, 0.1, 0, 0, none};
  EXPECT_EQ(older.converted(point.data(), later, true), longer_point);
  const Numbers plain = {id, 0.1, none}, longer_plain = {id, 0.1, 0, none};
  EXPECT_EQ(older.converted(plain.data(), later, false), longer_plain);
  EXPECT_EQ(older.converted(&none, later, false), Numbers({none}));

  Check::holds_and_refuses_one_percent(
      {owner.begin() + 6, owner.end()}, [&](const Numbers &of_body) {
        Numbers changed = owner;
        std::copy(of_body.begin(), of_body.end(), changed.begin() + 6);
        return older.converted(changed.data(), later, true) == longer;
      });
}

TEST(AtomParts, AreWrittenAndRead)
{
  const AtomParts parts = {5, 11, 11, 13, 3, 6};
  EXPECT_EQ(parts.numbers().size(), AtomParts::NUMBERS);
  EXPECT_TRUE(AtomParts::of(parts.numbers()) == parts);
  for (size_t n = 0; n < AtomParts::NUMBERS; ++n) {
    Numbers other = parts.numbers();
    other[n] += 1.0;
    EXPECT_FALSE(AtomParts::of(other) == parts);
  }
}

/// Each number equals its position in the struct, and the counts are small.
TEST(Release030, BecomesSections)
{
  Release030 old;
  constexpr int COUNT = sizeof(old) / sizeof(double);
  double numbers[COUNT];
  for (int n = 0; n < COUNT; ++n) numbers[n] = n;
  std::memcpy(&old, numbers, sizeof(old));
  static_assert(COUNT == 4 + 7 + 13 + 18 + 8 + 2 * 11 * 13, "as 0.3.0 wrote it");
  old.thermostat.mode = 2.0;
  old.thermostat.length = 3.0;

  const Sections file = old.sections();
  EXPECT_EQ(file.get("bodies"), Numbers({2, 3}));
  EXPECT_TRUE(AtomParts::of(file.get("parts of atoms")) == Release030::PARTS);
  EXPECT_EQ(file.get("scheme"), Numbers({4, 5, 6, 9, 10}));
  EXPECT_EQ(file.get("motion"), Numbers({7, 8}));
  ASSERT_TRUE(file.has("tolerance", 13));
  EXPECT_EQ(file.get("tolerance").front(), 11.0);
  EXPECT_EQ(file.get("tolerance").back(), 23.0);
  EXPECT_EQ(file.get("isokinetic"), Numbers({24, 25, 26, 27, 28, 29}));
  ASSERT_TRUE(file.has("heat", 12));
  EXPECT_EQ(file.get("heat").back(), 41.0);
  EXPECT_EQ(file.get("thermostat"), Numbers({2, 3, 44, 45, 46, 47, 48, 49}));
  EXPECT_EQ(file.get("chains"), Numbers({50, 63, 76, 89, 193, 206, 219, 232}));
  EXPECT_FALSE(file.has("sums of chains", 0));

  old.variable = old.isokinetic.mode = old.thermostat.mode = 0.0;
  for (const char *name : {"tolerance", "isokinetic", "heat", "thermostat", "chains"})
    EXPECT_FALSE(old.sections().has(name, 0)) << name;
}
