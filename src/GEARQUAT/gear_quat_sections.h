/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Named sections of numbers, which a restart file contains besides the data of atoms.  Each object
   writes and reads the sections with its state.  A reader ignores unknown sections and queries
   the number of elements in a section, so releases read each other's files.  A number keeps its
   position and meaning in a section; new numbers are added at the end.

   Packed, as 64-bit numbers: MAGIC, FORMAT, the total count of numbers; and for each section its
   name in NAME bytes, its count of numbers, and the numbers.

   In the data of atoms, too, new numbers are added at the end of a part; AtomParts has the lengths
   of the parts in a file. */

#ifndef GEAR_QUAT_SECTIONS_H
#define GEAR_QUAT_SECTIONS_H

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Sections {
 public:
  using Numbers = std::vector<double>;
  static constexpr double MAGIC = 0x6765617271756174;    ///< "gearquat"
  static constexpr double FORMAT = 6;
  static constexpr int HEAD = 3;     ///< numbers before the sections
  static constexpr int NAME = 16;    ///< the most characters of a name

  void put(const std::string &name, Numbers numbers) { all[name] = std::move(numbers); }

  /// True if there is such a section with at least this many numbers.
  bool has(const std::string &name, size_t count) const
  {
    const auto found = all.find(name);
    return found != all.end() && found->second.size() >= count;
  }
  /// Empty if there is no such section.
  const Numbers &get(const std::string &name) const
  {
    static const Numbers NONE;
    const auto found = all.find(name);
    return found == all.end() ? NONE : found->second;
  }
  /// One number, `otherwise` if it is missing.
  double number(const std::string &name, size_t n, double otherwise = 0.0) const
  {
    return has(name, n + 1) ? get(name)[n] : otherwise;
  }

  Numbers packed() const
  {
    Numbers buf = {MAGIC, FORMAT, 0.0};
    for (const auto &section : all) {
      double name[IN_NAME] = {};
      std::memcpy(name, section.first.data(), std::min((size_t) NAME, section.first.size()));
      buf.insert(buf.end(), name, name + IN_NAME);
      buf.push_back((double) section.second.size());
      buf.insert(buf.end(), section.second.begin(), section.second.end());
    }
    buf[HEAD - 1] = (double) buf.size();
    return buf;
  }

  /// Replaces the contents.  False, without sections, if buf is incomplete.
  bool unpack(const Numbers &buf)
  {
    all.clear();
    if (buf.size() < HEAD || buf[0] != MAGIC || buf[1] != FORMAT || buf[2] != (double) buf.size())
      return false;
    std::map<std::string, Numbers> found;
    for (size_t at = HEAD; at < buf.size();) {
      if (buf.size() - at <= IN_NAME) return false;
      char name[NAME + 1] = {};
      std::memcpy(name, &buf[at], NAME);
      const double count = buf[at + IN_NAME];
      at += IN_NAME + 1;
      if (!(count >= 0.0 && count <= (double) (buf.size() - at))) return false;
      const auto first = buf.begin() + (std::ptrdiff_t) at;
      found[name].assign(first, first + (std::ptrdiff_t) count);
      at += (size_t) count;
    }
    all = std::move(found);
    return true;
  }

 private:
  static constexpr int IN_NAME = NAME / sizeof(double);
  static_assert(sizeof(double) == 8, "numbers of a file");

  std::map<std::string, Numbers> all;
};

/// The counts of numbers in the parts of an atom's data.  They are in this order:
///   site    of every atom of a body; the first one is the ID of the body, 0 for none: then nothing
///           follows
///   record  its position and orientation in its body, if the file has extended sites: as many
///           numbers, or only a zero
///   the size of the history, 0 for an atom that does not own its body: then nothing follows
///   body, state, last, load, and the history
struct AtomParts {
  int site, record, body, state, last, load;

  bool operator==(const AtomParts &other) const
  {
    return site == other.site && record == other.record && body == other.body &&
        state == other.state && last == other.last && load == other.load;
  }

  Sections::Numbers numbers() const
  {
    return {(double) site,  (double) record, (double) body,
            (double) state, (double) last,   (double) load};
  }
  static AtomParts of(const Sections::Numbers &n)
  {
    return {(int) n[0], (int) n[1], (int) n[2], (int) n[3], (int) n[4], (int) n[5]};
  }
  static constexpr size_t NUMBERS = 6;

  /// Converts the data of an atom whose parts have these lengths to the lengths of `other`: missing
  /// numbers are 0, and numbers unknown to `other` are omitted.  extended: the file has extended
  /// sites.
  Sections::Numbers converted(const double *data, const AtomParts &other, bool extended) const
  {
    Sections::Numbers result;
    const auto take = [&](int count, int wanted) {
      const size_t before = result.size();
      result.insert(result.end(), data, data + std::min(count, wanted));
      result.resize(before + wanted, 0.0);
      data += count;
    };
    const auto is_zero = [&] {
      return integer(*data) == 0;
    };
    if (is_zero()) {
      take(1, 1);
      return result;
    }
    take(site, other.site);
    if (extended && *data == 0.0)
      take(1, 1);
    else if (extended)
      take(record, other.record);
    const int size = (int) integer(*data);
    take(1, 1);
    if (size == 0) return result;
    take(body, other.body);
    take(state, other.state);
    take(last, other.last);
    take(load, other.load);
    take(size, size);
    return result;
  }

 private:
  /// Integers are stored as their bits.
  static std::int64_t integer(const double &number)
  {
    std::int64_t bits;
    std::memcpy(&bits, &number, sizeof(bits));
    return bits;
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
