/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The numbers of a restart file besides the data of atoms.

   An object with state has a function fields(Fields &), the only list of the members that decide
   about later steps or outputs; it writes them and reads them.  In the file they follow MAGIC, FORMAT
   and their count.  A file is read by releases with the same format. */

#ifndef GEAR_QUAT_FIELDS_H
#define GEAR_QUAT_FIELDS_H

#include <type_traits>
#include <utility>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Fields {
 public:
  using Numbers = std::vector<double>;
  static constexpr double MAGIC = 0x6765617271756174;    ///< "gearquat"
  static constexpr double FORMAT = 13;

  /// To write.
  Fields() = default;
  /// To read.
  explicit Fields(Numbers numbers) : all(std::move(numbers)), at(0) {}

  bool reads() const { return at != WRITES; }
  const Numbers &numbers() const { return all; }
  /// True if all numbers have been read, and no more than these.
  bool is_complete() const { return at == all.size(); }

  /// Numbers, containers of members, and objects with fields().
  template <class... Member> void operator()(Member &...members) { (visit(members), ...); }

 private:
  Numbers all;
  static constexpr size_t WRITES = -1;
  size_t at = WRITES;    ///< the next number to read

  template <class T> void visit(T &member)
  {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      number(member);
    else
      members_of(member, 0);
  }
  template <class T> void number(T &member)
  {
    if (!reads())
      all.push_back((double) member);
    else if (at++ < all.size())
      member = (T) all[at - 1];
  }
  template <class T> auto members_of(T &object, int) -> decltype(object.fields(*this))
  {
    object.fields(*this);
  }
  template <class T> void members_of(T &container, long)
  {
    for (auto &one : container) visit(one);
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
