/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_bodies.h"

#include <cstring>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

Bodies::Bodies(const Scheme &scheme)
{
  set_scheme(scheme);
}

void Bodies::set_scheme(const Scheme &other)
{
  scheme = other;
  row_size = scheme.size() * (scheme.remembers() ? 2 : 1);
  rows.assign((size_t) nhere() * row_size, 0.0);
}

/* ----------------------------------------------------------------------
   the columns
------------------------------------------------------------------------- */

void Bodies::resize(int nhere)
{
  for_columns(*this, ALL, [nhere](auto &column, int width) {
    column.resize((size_t) nhere * width);
  });
}

void Bodies::remove_owned(int ibody)
{
  const int end = --nown;
  for_columns(*this, MOVING, [=](auto &column, int width) {
    std::copy_n(&column[(size_t) end * width], width, &column[(size_t) ibody * width]);
  });
  drop_copies();
}

void Bodies::permute(const std::vector<int> &from)
{
  for_columns(*this, MOVING, [&from](auto &column, int width) {
    const auto before = column;
    for (size_t n = 0; n < from.size(); ++n)
      std::copy_n(&before[(size_t) from[n] * width], width, &column[n * width]);
  });
}

int Bodies::packed_size(Part part) const
{
  size_t bytes = 0;
  for_columns(*this, part, [&bytes](const auto &column, int width) {
    bytes += width * sizeof(column[0]);
  });
  return (int) (bytes / sizeof(double));
}

int Bodies::pack(int ibody, Part part, double *buf) const
{
  char *to = reinterpret_cast<char *>(buf);
  for_columns(*this, part, [&to, ibody](const auto &column, int width) {
    const size_t bytes = width * sizeof(column[0]);
    std::memcpy(to, &column[(size_t) ibody * width], bytes);
    to += bytes;
  });
  return packed_size(part);
}

void Bodies::unpack(int ibody, Part part, const double *buf, int size)
{
  const char *from = reinterpret_cast<const char *>(buf), *end = from + size * sizeof(double);
  for_columns(*this, part, [&from, end, ibody](auto &column, int width) {
    const size_t bytes = std::min(width * sizeof(column[0]), (size_t) (end - from));
    std::memcpy(static_cast<void *>(&column[(size_t) ibody * width]), from, bytes);
    from += bytes;
  });
}

double Bodies::memory_usage() const
{
  size_t bytes = (tops.capacity() + points.capacity()) * sizeof(int);
  for_columns(*this, ALL, [&bytes](const auto &column, int) {
    bytes += column.capacity() * sizeof(column[0]);
  });
  return (double) bytes;
}

/* ----------------------------------------------------------------------
   lists of bodies
------------------------------------------------------------------------- */

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
