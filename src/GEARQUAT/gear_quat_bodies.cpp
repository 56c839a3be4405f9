/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_bodies.h"

#include "gear_quat_images.h"
#include "gear_quat_ranks.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

Bodies::Bodies(LAMMPS *lmp, Fix *fix, const Scheme &scheme) :
    Pointers(lmp), fix(fix), scheme(scheme), row_size(scheme.size() * (scheme.trial ? 2 : 1)),
    extended(lmp, scheme)
{
  if (atom->map_style == Atom::MAP_NONE)
    error->all(FLERR, "Fix gear/quat requires an atom map, see atom_modify");
  if (!atom->tag_enable) error->all(FLERR, "Fix gear/quat requires atom IDs");
  grow_arrays(atom->nmax);
  clear();
}

/* ----------------------------------------------------------------------
   life cycle
------------------------------------------------------------------------- */

void Bodies::clear(bool with_extended)
{
  nown = 0;
  large.clear();
  packed_large.clear();
  drop_ghosts();
  sites.clear();
  frame.clear();
  owner_atom.clear();
  extended.reset(with_extended, (int) owned.size());
  box.clear();
  for (size_t i = 0; i < owned.size(); ++i) set_arrays(i);
}

void Bodies::create(const std::vector<tagint> &ids, const GivenBodies &given)
{
  clear();
  add(ids, given, false);
}

void Bodies::set_number(bigint all)
{
  nchanges += nbodies != all;
  nbodies = all;
}

void Bodies::count()
{
  bigint here[2] = {nown, 0};
  for (int ibody = 0; ibody < nown; ++ibody) here[1] += body[ibody].natoms;
  const auto all = over_ranks(MPI_SUM, here, world);
  set_number(all[0]);
  natoms = all[1];
  note_box();
}

void Bodies::add(const std::vector<tagint> &ids, const GivenBodies &given, bool fresh)
{
  std::vector<int> atoms;
  for (int i = 0; i < atom->nlocal; ++i)
    if (ids[i] != 0) atoms.push_back(i);
  extended.refuse(atoms);
  const bool any_extended = extended.any(atoms);
  if (any_extended && !extended.has_records()) extended.reset(true, (int) owned.size());

  const Assembly assembly(lmp, given, any_extended ? &extended : nullptr, ids);
  note_scratch(assembly.memory_usage() + ids.capacity() * sizeof(tagint));
  assembly.for_sites([&](const Assembly::Made &one, int i, const double *arm_body) {
    body_id[i] = one.body.id;
    owner_tag[i] = one.owner;
    std::copy_n(arm_body, 3, site_body[i].begin());
    if (any_extended) extended.attach(i, atom_mass(i), one.state.q);
  });
  for (const auto &one : assembly.bodies()) {
    if (one.owner_rank != comm->me) continue;
    const int ibody = add_owned(one.local);
    body[ibody] = one.body;
    body[ibody].fresh = fresh;
    state[ibody] = one.state;
  }
  count();
}

void Bodies::recreate()
{
  create(std::vector<tagint>(body_id.begin(), body_id.begin() + atom->nlocal), GivenBodies());
  choose_large();
}

void Bodies::refuse_atoms() const
{
  std::vector<int> atoms;
  for (int i = 0; i < atom->nlocal; ++i)
    if (in_body(i)) atoms.push_back(i);
  extended.refuse(atoms);
}

/* ----------------------------------------------------------------------
   ownership
------------------------------------------------------------------------- */

void Bodies::drop_ghosts()
{
  if (!large.empty()) pack_large();
  body.resize(nown);
  state.resize(nown);
  load.resize(nown);
  last.resize(nown);
  rows.resize((size_t) nown * row_size, 0.0);
  large.clear();
  nmove = nown;
}

int Bodies::add_owned(int atom)
{
  drop_ghosts();
  const int ibody = nown++;
  drop_ghosts();
  owner_atom.push_back(atom);
  owned[atom] = ibody;
  return ibody;
}

void Bodies::remove_owned(int ibody)
{
  drop_ghosts();
  owned[owner_atom[ibody]] = -1;
  const int end = --nown;
  if (ibody != end) {
    body[ibody] = body[end];
    state[ibody] = state[end];
    load[ibody] = load[end];
    last[ibody] = last[end];
    owner_atom[ibody] = owner_atom[end];
    owned[owner_atom[ibody]] = ibody;
    std::copy_n(history(end), row_size, history(ibody));
  }
  drop_ghosts();
  owner_atom.resize(nown);
}

void Bodies::update_ghosts()
{
  do {
    drop_ghosts();
    share_large();
    if (comm->nprocs > 1) {
      std::fill(owned.begin() + atom->nlocal, owned.end(), -1);
      std::fill(shared.begin(), shared.end(), -1);
      if (nlarge < nbodies) {
        share_owners();
        tell_ghosts();
      }
    }
    list_bodies();
    frame.resize(state.size());
    for (size_t ibody = 0; ibody < state.size(); ++ibody) update_frame(ibody);
    list_sites();
  } while (!take_stock());
}

/// Owner atoms of bodies that are not large learn whether sites on other ranks look for them.
void Bodies::share_owners()
{
  std::vector<double> sought(atom->nlocal + atom->nghost, 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int owner = in_body(i) ? atom->map(owner_tag[i]) : -1;
    if (owner >= atom->nlocal) sought[owner] = 1.0;
  }
  labels = sought.data();
  comm->reverse_comm(fix, 1);
  labels = nullptr;
  for (int i = 0; i < atom->nlocal; ++i)
    if (sought[i] > 0.0 && owned[i] >= 0 && !is_large(owned[i])) shared[i] = owned[i];
}

/// The IDs of their bodies for ghost atoms, and the bodies themselves for ghosts of shared owner
/// atoms.
void Bodies::tell_ghosts()
{
  forward = Forward::GHOSTS;
  comm->forward_comm(fix);
  load.resize(body.size());
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
  for (int ibody = 0; ibody < (int) body.size(); ++ibody)
    if (!is_large(ibody)) list(ibody);
  for (const Large &one : large) list(one.body);
}

void Bodies::take_in_fresh()
{
  for (const int ibody : fresh) body[ibody].fresh = 0;
  if (!fresh.empty()) list_bodies();
}

void Bodies::list_sites()
{
  unseen.clear();
  sites.clear();
  extended.sites.clear();
  size_t mine = 0;
  for (int i = 0; i < atom->nlocal; ++i) mine += body_id[i] != 0;
  if (mine > sites.capacity()) sites = std::vector<Site>();    // not both
  sites.reserve(mine);
  const auto list = [this](bool centered) {
    for (int i = 0; i < atom->nlocal; ++i) {
      const double *arm_body = site_body[i].data();
      if (body_id[i] != 0 && (dot3(arm_body, arm_body) == 0.0) == centered) list_site(i);
    }
  };
  list(true);
  ncentered = sites.size();
  list(false);
  wrapped = std::any_of(sites.begin(), sites.end(), [](const Site &site) {
    return dot3(site.wrap, site.wrap) > 0.0;
  });
  if (extended.has_records())
    for (const Site &site : sites) extended.list(site.atom, site.body);
}

void Bodies::list_site(int i)
{
  const int ibody = body_of(i);
  if (ibody < 0) {
    unseen.push_back(owner_tag[i]);
    return;
  }
  Site site = {i, ibody, {}, {}};
  for (int k = 0; k < 3; ++k) site.arm_body[k] = site_body[i][k];
  domain->unmap(site.wrap, atom->image[i]);
  double arm[3], expected[3];    // of what the flags take off
  to_space(frame[ibody].axes, site.arm_body, arm);
  for (int k = 0; k < 3; ++k) expected[k] = state[ibody].center[k] + arm[k] - atom->x[i][k];
  undo_image_flag_overflow(domain, expected, site.wrap);
  sites.push_back(site);
}

/// On a single rank ghosts are images of own atoms, on several their owners tell them.
tagint Bodies::id_of(int i) const
{
  return body_id[atom->map(atom->tag[i])];
}

/// Count what all ranks have.  False if some bodies have become large: all is to be done again.
bool Bodies::take_stock()
{
  const bigint lost = (bigint) unseen.size();
  bigint here[7] = {nown, 0, (bigint) sites.size() + lost, lost, strangers, 0, 0};
  for (int ibody = 0; ibody < nown; ++ibody) {
    here[1] += body[ibody].natoms;
    here[6] += is_large(ibody);
  }
  for (const Site &site : sites) here[5] += site.body >= nmove;
  const auto all = over_ranks(MPI_SUM, here, world);
  set_number(all[0]);
  natoms = all[1];
  any_ghosts = all[5] > 0;
  nlarge = all[6];
  if (all[1] != all[2] || all[3] > 0) check_whole();
  if (nlarge != (bigint) large.size()) return false;    // one was removed
  if (all[3] > 0) {
    promote();
    return false;
  }
  if (all[4] > 0 && !warned_strangers) {
    warned_strangers = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "Fix gear/quat: {} atoms of the fix group were created after the fix was "
                     "defined; they belong to no body and this fix does not move them",
                     all[4]);
  }
  return true;
}

std::vector<tagint> Bodies::all_ids() const
{
  std::vector<tagint> mine;
  for (int ibody = 0; ibody < nown; ++ibody) mine.push_back(body[ibody].id);
  return gather_sorted(mine, world);
}

bool Bodies::change_masks(const std::map<tagint, Mask> &masks)
{
  int changed = 0;
  for (int ibody = 0; ibody < nmove; ++ibody) {
    const auto place = masks.find(body[ibody].id);
    const Mask wanted = place == masks.end() ? 0 : place->second;
    if (body[ibody].off != wanted) changed = 1;
    body[ibody].off = wanted;
  }
  return over_ranks(MPI_MAX, changed, world) != 0;
}

void Bodies::expect_forces(bool any)
{
  any_forces = any;
  if (!any) std::fill(load.begin(), load.end(), Load());
}

void Bodies::spread_labels(std::vector<double> &label)
{
  labels = label.data();
  forward = Forward::LABELS;
  comm->forward_comm(fix, 1);
  labels = nullptr;
}

/* ----------------------------------------------------------------------
   per-atom arrays
------------------------------------------------------------------------- */

void Bodies::grow_arrays(int n)
{
  body_id.resize(n);
  owner_tag.resize(n);
  owned.resize(n, -1);
  shared.resize(n, -1);
  site_body.resize(n);
  extended.grow(n);
}

void Bodies::set_arrays(int i)
{
  body_id[i] = owner_tag[i] = 0;
  owned[i] = shared[i] = -1;
  site_body[i] = {};
  extended.set(i);
}

void Bodies::copy_arrays(int from, int to, int delflag)
{
  if (delflag && owned[to] >= 0) remove_owned(owned[to]);
  body_id[to] = body_id[from];
  owner_tag[to] = owner_tag[from];
  owned[to] = owned[from];
  site_body[to] = site_body[from];
  extended.copy(from, to);
  if (owned[to] >= 0) owner_atom[owned[to]] = to;
}

double Bodies::present_memory() const
{
  const double per_atom = 2 * sizeof(tagint) + 2 * sizeof(int) + 3 * sizeof(double);
  return owned.capacity() * per_atom + rows.capacity() * sizeof(double) +
      body.capacity() * sizeof(Body) + state.capacity() * sizeof(BodyState) +
      load.capacity() * sizeof(Load) + last.capacity() * sizeof(Correction) +
      frame.capacity() * sizeof(BodyFrame) + sites.capacity() * sizeof(Site) +
      large.capacity() * sizeof(Large) +
      (packed_large.capacity() + parts.capacity() + sums.capacity()) * sizeof(double) +
      (owner_atom.capacity() + tops.capacity() + points.capacity()) * sizeof(int) +
      extended.memory_usage();
}

void Bodies::note_scratch(double bytes)
{
  peak = std::max(peak, present_memory() + bytes);
}

double Bodies::memory_usage() const
{
  return std::max(peak, present_memory());
}
