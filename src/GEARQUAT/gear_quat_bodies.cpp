/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_bodies.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

Bodies::Bodies(const Scheme &scheme) :
    scheme(scheme), row_size(scheme.size() * (scheme.remembers ? 2 : 1))
{
}

void Bodies::set_scheme(const Scheme &other)
{
  scheme = other;
  row_size = scheme.size() * (scheme.remembers ? 2 : 1);
  rows.assign((size_t) nmove * row_size, 0.0);
}

/* ----------------------------------------------------------------------
   list of bodies
------------------------------------------------------------------------- */

void Bodies::resize(int nhere)
{
  ++nlayouts;
  body.resize(nhere);
  state.resize(nhere);
  load.resize(nhere);
  last.resize(nhere);
  frame.resize(nhere);
}

void Bodies::drop_copies()
{
  resize(nown);
  rows.resize((size_t) nown * row_size, 0.0);
  large.clear();
  nmove = nown;
}

int Bodies::add_owned()
{
  ++nown;
  return add_copy();
}

int Bodies::add_copy()
{
  resize(++nmove);
  rows.resize((size_t) nmove * row_size, 0.0);
  return nmove - 1;
}

int Bodies::add_ghost()
{
  resize(nhere() + 1);
  return nhere() - 1;
}

void Bodies::remove_owned(int ibody)
{
  const int end = nown - 1;
  if (ibody != end) {
    body[ibody] = body[end];
    state[ibody] = state[end];
    load[ibody] = load[end];
    last[ibody] = last[end];
    std::copy_n(history(end), row_size, history(ibody));
  }
  --nown;
  drop_copies();
}

void Bodies::permute(const std::vector<int> &from)
{
  ++nlayouts;
  const auto permute_column = [&from](auto &column, int width) {
    auto before = column;
    for (size_t n = 0; n < from.size(); ++n)
      std::copy_n(&before[(size_t) from[n] * width], width, &column[n * width]);
  };
  permute_column(body, 1);
  permute_column(state, 1);
  permute_column(load, 1);
  permute_column(last, 1);
  permute_column(rows, row_size);
}

void Bodies::clear()
{
  nown = 0;
  drop_copies();
}

void Bodies::set_number(bigint all)
{
  nchanges += nbodies != all;
  nbodies = all;
}

void Bodies::list()
{
  list_bodies();
  for (int ibody = 0; ibody < nhere(); ++ibody) update_frame(ibody);
}

void Bodies::list_bodies()
{
  for (auto *list : {&tops, &points, &fresh, &ghost_tops}) list->clear();
  const auto list = [this](int ibody) {
    const bool rotates = body[ibody].rigid.rotational_freedoms() > 0;
    if (ibody >= nmove) {
      if (rotates) ghost_tops.push_back(ibody);
    } else if (body[ibody].fresh)
      fresh.push_back(ibody);
    else
      (rotates ? tops : points).push_back(ibody);
  };
  for (int ibody = 0; ibody < nhere(); ++ibody)
    if (!is_large(ibody)) list(ibody);
  for (const int ibody : large) list(ibody);
}

void Bodies::take_in_fresh()
{
  for (const int ibody : fresh) body[ibody].fresh = 0;
  if (!fresh.empty()) list_bodies();
}

/* ----------------------------------------------------------------------
   a step
------------------------------------------------------------------------- */

void Bodies::update_frame(int ibody)
{
  const BodyState &s = state[ibody];
  rotation_matrix(s.q, scheme.norm2(s.q), frame[ibody].axes);
  to_space(frame[ibody].axes, s.omega_body, frame[ibody].omega_space);
}

void Bodies::keep_histories()
{
  for (int ibody = 0; ibody < nmove; ++ibody)
    std::copy_n(history(ibody), row_size / 2, history(ibody) + row_size / 2);
}

void Bodies::put_back_histories()
{
  for (int ibody = 0; ibody < nmove; ++ibody)
    std::copy_n(history(ibody) + row_size / 2, row_size / 2, history(ibody));
}

double Bodies::memory_usage() const
{
  return rows.capacity() * sizeof(double) + body.capacity() * sizeof(Body) +
      state.capacity() * sizeof(BodyState) + load.capacity() * sizeof(Load) +
      last.capacity() * sizeof(Correction) + frame.capacity() * sizeof(BodyFrame) +
      (tops.capacity() + points.capacity()) * sizeof(int);
}
