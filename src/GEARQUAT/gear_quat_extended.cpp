/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

#include "gear_quat_extended.h"

#include "gear_quat_ranks.h"
#include "gear_quat_shapes.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using namespace GearQuat;

// an atom counts as changed by the user if its deviation exceeds rounding, relative

static constexpr double SAME = 1.0e-11;

Extended::Extended(LAMMPS *lmp) : Pointers(lmp)
{
  find_atom_styles();
}

/* ----------------------------------------------------------------------
   all per-atom data of LAMMPS, by their names in Atom::peratom; doc/howto/from_rigid.md has the
   same table by atom styles
------------------------------------------------------------------------- */

namespace {

struct Data {
  const char *names;
  const char *refusal;    ///< null: bodies move these data, or a rigid motion leaves them unchanged
};

}    // namespace

static constexpr Data DATA[] = {
    // Sites sets these from the body, vest to the velocity at which forces are evaluated
    {"x v image vest", nullptr},
    // Extended sets these; ellipsoid, line and tri are indices of orientations
    {"mu mu3 omega angmom quat ellipsoid line tri", nullptr},
    // forces and other sums over neighbors, which every evaluation begins with zero
    {"f torque heatflow fm fm_long erforce edpd_flux cc_flux drho desph duChem", nullptr},
    // no direction
    {"id type mask molecule molindex molatom nspecial special nspecial15 special15 id3p id5p",
     nullptr},
    {"num_bond bond_type bond_atom num_angle angle_type angle_atom1 angle_atom2 angle_atom3",
     nullptr},
    {"num_dihedral dihedral_type dihedral_atom1 dihedral_atom2 dihedral_atom3 dihedral_atom4",
     nullptr},
    {"num_improper improper_type improper_atom1 improper_atom2 improper_atom3 improper_atom4",
     nullptr},
    {"q rmass radius temperature espin eradius ervel rho esph cv rheo_status conductivity",
     nullptr},
    {"pressure viscosity dpdTheta uCond uMech uChem uCG uCGnew edpd_cv edpd_temp vest_temp cc",
     nullptr},
    {"area ed em epsilon curvature q_scaled qeff smin", nullptr},
    // a reference state, in which the distances of atoms count
    {"vfrac s0 x0", nullptr},
    {"body", nullptr},    // refused atom by atom
    {"sp",
     "has magnetic spins, which precess by themselves, and no fix would move those of bodies"},
    {"contact_radius smd_data_9 smd_stress eff_plastic_strain eff_plastic_strain_rate damage",
     "has stresses and deformations, which would have to turn with bodies"},
};

/// Data that a table does not know are refused, because they might have a direction.
static std::string refusal_of(const std::string &name)
{
  for (const auto &row : DATA) {
    const auto names = utils::split_words(row.names);
    if (std::find(names.begin(), names.end(), name) != names.end())
      return row.refusal ? row.refusal : "";
  }
  return "has the per-atom data " + name + ", which this fix does not know";
}

/* ----------------------------------------------------------------------
   the kind of an atom: lines and triangles have a radius too, so spheres are tested last; a point
   with an orientation is a sphere of radius 0
------------------------------------------------------------------------- */

int Extended::shape_of(int i) const
{
  if (atom->ellipsoid && atom->ellipsoid[i] >= 0) return ELLIPSOID;
  if (atom->line && atom->line[i] >= 0) return LINE;
  if (atom->tri && atom->tri[i] >= 0) return TRIANGLE;
  if (atom->body && atom->body[i] >= 0) return BODY;
  if (atom->quat || (atom->radius && atom->radius[i] > 0.0)) return SPHERE;
  return POINT;
}

int Extended::has_dipole(int i) const
{
  return atom->mu && atom->mu[i][3] > 0.0;
}

Extended::Own Extended::own(int i, double mass) const
{
  Own mine = {shape_of(i), has_dipole(i), {}, {0.0, 0.0, 0.0, 1.0}, {}};
  if (mine.shape == SPHERE)
    sphere_moments(mass, atom->radius ? atom->radius[i] : 0.0, mine.moments);
  else if (mine.shape != POINT)
    read_bonus(i, mass, mine);
  if (mine.shape == SPHERE && atom->quat) from_lammps(atom->quat[i], mine.q);
  if (mine.shape == ELLIPSOID || mine.shape == TRIANGLE) {
    if (atom->angmom) std::copy_n(atom->angmom[i], 3, mine.momentum);
  } else if (mine.shape != POINT && atom->omega) {
    double a[9];
    rotation_matrix(mine.q, 1.0, a);
    own_angular_momentum(mine.moments, a, atom->omega[i], mine.momentum);
  }
  if (domain->dimension == 2) mine.momentum[0] = mine.momentum[1] = 0.0;
  return mine;
}

/// LAMMPS versions after 2025 have superellipsoids, whose moments differ from an ellipsoid.
template <class A>
static auto has_superellipsoids(const A *atom, int) -> decltype(atom->superellipsoid_flag)
{
  return atom->superellipsoid_flag;
}
template <class A> static int has_superellipsoids(const A *, long)
{
  return 0;
}

void Extended::refuse(const std::vector<int> &atoms) const
{
  for (const auto &data : atom->peratom) {
    if (!*static_cast<void **>(data.address)) continue;
    const std::string refusal = refusal_of(data.name);
    if (!refusal.empty())
      error->all(FLERR, "Fix gear/quat: atom style {} {}; use an atom style without these data",
                 atom->get_style(), refusal);
  }
  const bool superellipsoids = has_superellipsoids(atom, 0) != 0;
  tagint here[2] = {0, 0};    // of a shape that no fix moves, or that this plugin cannot read
  for (const int i : atoms) {
    const int one = shape_of(i);
    if (one == BODY || (one == ELLIPSOID && superellipsoids))
      here[0] = atom->tag[i];
    else if (one != POINT && one != SPHERE && !READS_ATOM_STYLES)
      here[1] = atom->tag[i];
  }
  const auto found = over_ranks(MPI_MAX, here, world);
  if (found[0])
    error->all(FLERR,
               "Fix gear/quat: atom {} is a particle of atom style body or a superellipsoid; the "
               "atoms of a rigid body may be points, spheres, ellipsoids, lines, triangles and "
               "dipoles",
               found[0]);
  if (found[1])
    error->all(
        FLERR,
        "Fix gear/quat: atom {} is an ellipsoid, a line or a triangle, which this plugin cannot "
        "turn, because it was compiled without the headers for that; compile GEARQUAT for the "
        "source tree of your LAMMPS: cmake -B build -D LAMMPS_SOURCE_DIR=/path/to/lammps",
        found[1]);
}

/* ----------------------------------------------------------------------
   bodies are made
------------------------------------------------------------------------- */

bool Extended::any(const std::vector<int> &atoms) const
{
  const int here = std::any_of(atoms.begin(), atoms.end(), [this](int i) {
    return shape_of(i) != POINT || has_dipole(i);
  });
  return over_ranks(MPI_MAX, here, world);
}

void Extended::reset(bool keep, int nmax)
{
  sites.clear();
  records.assign(keep ? nmax : 0, Record());
}

void Extended::own_momenta(int i, double mass, double *inertia_space,
                           double *angular_momentum_space) const
{
  const Own mine = own(i, mass);
  double a[9];
  rotation_matrix(mine.q, 1.0, a);
  std::fill_n(inertia_space, 9, 0.0);
  add_tensor(mine.moments, a, inertia_space);
  std::copy_n(mine.momentum, 3, angular_momentum_space);
}

void Extended::attach(int i, double mass, const double *q_body)
{
  const Own mine = own(i, mass);
  Record &record = records[i];
  record = Record();
  record.kind = 2 * mine.shape + mine.dipole;
  std::copy_n(mine.moments, 3, record.moments);
  relative_orientation(q_body, mine.q, record.relative);
  if (mine.dipole) {
    double a[9];
    rotation_matrix(q_body, dot4(q_body, q_body), a);
    to_body(a, atom->mu[i], record.mu_body);
  }
}

int Extended::freedoms(int i) const
{
  if (!has_records() || records[i].moments[2] == 0.0) return 0;
  return domain->dimension == 2 ? 1 : 3;
}

/* ----------------------------------------------------------------------
   bodies move
------------------------------------------------------------------------- */

void Extended::list(int i, int body)
{
  if (records[i].kind == 0.0) return;
  sites.push_back({i, body, {0.0, 0.0, 0.0, 1.0}});
  if (records[i].shape() == TRIANGLE) find_corners(sites.back());
}

Extended::Pose Extended::pose(const Record &record, int i, const Bodies &bodies, int ibody) const
{
  Pose made;
  double own[9];
  std::copy_n(bodies.frame[ibody].omega_space, 3, made.omega);
  site_orientation(bodies.state[ibody].q, record.relative, made.q);
  rotation_matrix(made.q, 1.0, own);
  own_angular_momentum(record.moments, own, made.omega, made.momentum);
  if (domain->dimension == 2) made.momentum[0] = made.momentum[1] = 0.0;
  std::fill_n(made.mu, 3, 0.0);
  if (record.dipole()) {    // with the length given by the atom style
    to_space(bodies.frame[ibody].axes, record.mu_body, made.mu);
    const double factor = atom->mu[i][3] / length(made.mu);
    for (double &component : made.mu) component *= factor;
  }
  return made;
}

void Extended::place(const Bodies &bodies, bool orientations, bool rates) const
{
  for (const Site &site : sites) {
    const int i = site.atom;
    const Record &record = records[i];
    const Pose made = pose(record, i, bodies, site.body);
    const int shape = record.shape();
    const bool by_momentum = shape == ELLIPSOID || shape == TRIANGLE;
    if (orientations) {
      if (shape == SPHERE && atom->quat) to_lammps(made.q, atom->quat[i]);
      if (shape != POINT && shape != SPHERE) write_bonus(site, shape, made.q);
      if (record.dipole()) std::copy_n(made.mu, 3, atom->mu[i]);
    }
    if (rates && by_momentum && atom->angmom) std::copy_n(made.momentum, 3, atom->angmom[i]);
    if (rates && !by_momentum && shape != POINT && atom->omega)
      std::copy_n(made.omega, 3, atom->omega[i]);
  }
}

void Extended::add_torques(double **torque, std::vector<Load> &loads) const
{
  if (!torque) return;
  for (const Site &site : sites)
    for (int k = 0; k < 3; ++k) loads[site.body].torque_space[k] += torque[site.atom][k];
}

/// True if two vectors are equal up to rounding, relative to their length.
static bool same(const double *a, const double *b, int n)
{
  double largest = 0.0, difference = 0.0;
  for (int k = 0; k < n; ++k) {
    largest = std::max({largest, std::fabs(a[k]), std::fabs(b[k])});
    difference = std::max(difference, std::fabs(a[k] - b[k]));
  }
  return difference <= SAME * largest;
}

bool Extended::match(int i, double mass, const Bodies &bodies, int ibody) const
{
  const Own mine = own(i, mass);
  const Record record = has_records() ? records[i] : Record();
  if (2 * mine.shape + mine.dipole != record.kind) return false;
  if (record.kind == 0.0) return true;

  const Pose made = pose(record, i, bodies, ibody);
  const double opposite[4] = {-made.q[0], -made.q[1], -made.q[2], -made.q[3]};
  return same(mine.moments, record.moments, 3) &&
      (mine.shape == POINT || (mine.shape == SPHERE && !atom->quat) || same(mine.q, made.q, 4) ||
       same(mine.q, opposite, 4)) &&
      (!mine.dipole || same(atom->mu[i], made.mu, 3)) && same(mine.momentum, made.momentum, 3);
}

/* ----------------------------------------------------------------------
   per-atom records
------------------------------------------------------------------------- */

int Extended::pack(int i, double *buf) const
{
  if (has_records()) std::memcpy(buf, &records[i], sizeof(Record));
  return packed_size();
}

int Extended::unpack(int i, const double *buf)
{
  if (has_records()) std::memcpy(&records[i], buf, sizeof(Record));
  return packed_size();
}
