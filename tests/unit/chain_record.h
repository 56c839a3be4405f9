/* The state of a chain, as a restart file has it. */

#ifndef CHAIN_RECORD_H
#define CHAIN_RECORD_H

#include "gear_quat_chain.h"
#include "gear_quat_fields.h"

struct ChainRecord {
  using Chain = LAMMPS_NS::GearQuat::Chain;
  using Fields = LAMMPS_NS::GearQuat::Fields;

  Chain::Variables y = {};
  double known = 0.0;
  std::array<double, Chain::MOST_SUMS> sums = {}, ages = {};

  template <class V> void fields(V &v) { v(y, known, sums, ages); }

  static ChainRecord of(Chain chain)
  {
    Fields file;
    file(chain);
    ChainRecord found;
    Fields again(file.numbers());
    again(found);
    return found;
  }
  void restore(Chain &chain)
  {
    Fields file;
    file(*this);
    Fields again(file.numbers());
    again(chain);
  }
};

#endif
