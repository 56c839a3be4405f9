/* The list of an object's state, by which a restart file is written and read. */

#include "checks.h"

#include "gear_quat_fields.h"

#include <array>
#include <limits>

using LAMMPS_NS::GearQuat::Fields;

namespace {

struct Inner {
  double a = 0.0;
  bool b = false;
  template <class V> void fields(V &v) { v(a, b); }
};

enum class Kind { ONE, OTHER };

struct Outer {
  std::int64_t count = 0;
  Kind kind = Kind::ONE;
  Inner inner;
  std::array<double, 3> row = {};
  float unlisted = 0.0F;
  double block[2] = {};
  std::vector<Inner> several = std::vector<Inner>(2);
  template <class V> void fields(V &v) { v(count, kind, inner, row, block, several); }
};

Outer some()
{
  Outer all;
  all.count = 1LL << 52;
  all.kind = Kind::OTHER;
  all.inner = {-2.5, true};
  all.row = {1.0e-300, 0.1, std::numeric_limits<double>::infinity()};
  all.block[1] = 7.0;
  all.several[1].a = 3.0;
  return all;
}

Fields::Numbers numbers_of(Outer one)
{
  Fields file;
  file(one);
  EXPECT_FALSE(file.reads());
  return file.numbers();
}

}    // namespace

TEST(Fields, AreReadAsTheyWereWritten)
{
  const auto numbers = numbers_of(some());
  EXPECT_EQ(numbers.size(), 2U + 2U + 3U + 2U + 4U);
  Outer found;
  Fields file(numbers);
  file(found);
  EXPECT_TRUE(file.reads() && file.is_complete());
  EXPECT_EQ(numbers_of(found), numbers);
  EXPECT_EQ(found.kind, Kind::OTHER);
}

TEST(Fields, KnowIfAFileIsShorterOrLonger)
{
  const auto numbers = numbers_of(some());
  for (size_t size = 0; size < numbers.size() + 2; ++size) {
    Fields::Numbers other = numbers;
    other.resize(size);
    Fields file(other);
    Outer found;
    file(found);
    EXPECT_EQ(file.is_complete(), size == numbers.size()) << size;
  }
}
