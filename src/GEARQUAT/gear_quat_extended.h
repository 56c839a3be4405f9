/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Atoms of bodies that are more than points: spheres, ellipsoids, lines, triangles, and dipoles.
   The source has a table of all per-atom data of LAMMPS: how they follow a rigid motion.

   When bodies are made, own_momenta() gives the contributions of an atom to inertia and angular
   momentum, and attach() records its position and orientation in its body.  The record travels with
   the atom.  While bodies move, the store lists such atoms after every exchange, calls place()
   wherever it places sites, and add_torques() wherever it gathers forces.  Without such atoms there
   are no records, no list, and none of these calls.

   Ellipsoids, lines and triangles have their orientation in LAMMPS' atom styles.  Where a plugin
   cannot read these, refuse() reports it. */

#ifndef LMP_GEAR_QUAT_EXTENDED_H
#define LMP_GEAR_QUAT_EXTENDED_H

#include "gear_quat_bodies.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {
class AtomVecEllipsoid;
class AtomVecLine;
class AtomVecTri;
}    // namespace LAMMPS_NS

namespace LAMMPS_NS::GearQuat {

class Extended : protected Pointers {
 public:
  explicit Extended(LAMMPS *lmp);

  /// Ends the run on all ranks, naming an atom, if one of `atoms` (local indices) cannot be moved;
  /// or naming the atom style, if it has data that this fix cannot move.
  void refuse(const std::vector<int> &atoms) const;

  // bodies are made; earlier records are dropped

  /// True if one of the atoms, on any rank, is more than a point.  Collective.
  bool any(const std::vector<int> &atoms) const;
  /// Drop all records; keep: then allocate new records, one for each of nmax atoms.
  void reset(bool keep, int nmax);
  bool has_records() const { return !records.empty(); }
  /// Contributions of the atom itself to its body's inertia tensor (row-major) and angular
  /// momentum.
  void own_momenta(int atom, double mass, double *inertia_space,
                   double *angular_momentum_space) const;
  /// Records the position and orientation of the atom in its body, whose orientation is q_body.
  void attach(int atom, double mass, const double *q_body);
  /// Rotational degrees of freedom that LAMMPS counts for the atom itself.
  int freedoms(int atom) const;

  // bodies move

  struct Site {
    int atom, body;
    double corners[4];    ///< of a triangle: quaternion of LAMMPS' frame of the corners in its own
  };
  std::vector<Site>
      sites;    ///< owned atoms that are more than points; stays until the next exchange

  /// Lists the atom if it is more than a point.
  void list(int atom, int body);
  /// Sets orientations and dipoles, and rates (angular velocities or momenta) if requested.
  void place(const Bodies &bodies, bool orientations, bool rates) const;
  void add_torques(double **torque, std::vector<Load> &loads) const;
  /// True if sizes, orientations, dipoles and rates of these atoms match their bodies.
  bool match(int atom, double mass, const Bodies &bodies, int ibody) const;

  // per-atom records

  void grow(int nmax)
  {
    if (has_records()) records.resize(nmax);
  }
  void set(int atom)
  {
    if (has_records()) records[atom] = Record();
  }
  void copy(int from, int to)
  {
    if (has_records()) records[to] = records[from];
  }
  static constexpr int RECORD_SIZE = 11;    ///< doubles of a record
  int packed_size() const { return has_records() ? RECORD_SIZE : 0; }
  int pack(int atom, double *buf) const;
  int unpack(int atom, const double *buf);
  double memory_usage() const
  {
    return records.capacity() * sizeof(Record) + sites.capacity() * sizeof(Site);
  }

 private:
  enum Shape { POINT, SPHERE, ELLIPSOID, LINE, TRIANGLE, BODY };

  struct Record {          ///< an atom relative to its body
    double kind;           ///< 2 * shape, plus 1 for a dipole; 0: the rest is unused
    double moments[3];     ///< of the atom itself, along its principal axes, its own frame
    double relative[4];    ///< quaternion of this frame in the body frame
    double mu_body[3];

    int shape() const { return (int) kind / 2; }
    bool dipole() const { return (int) kind % 2; }
  };
  static_assert(sizeof(Record) == RECORD_SIZE * sizeof(double));

  struct Own {    ///< an atom in the atom style
    int shape, dipole;
    double moments[3];
    double q[4];
    double momentum[3];    ///< angular, in space
  };

  struct Pose {    ///< an atom as computed from its body
    double q[4], mu[3], omega[3], momentum[3];
  };

  std::vector<Record> records;

  AtomVecEllipsoid *ellipsoids = nullptr;    ///< components of the atom style
  AtomVecLine *lines = nullptr;
  AtomVecTri *triangles = nullptr;

  static const bool READS_ATOM_STYLES;
  void find_atom_styles();
  int shape_of(int atom) const;
  int has_dipole(int atom) const;
  Own own(int atom, double mass) const;
  Pose pose(const Record &record, int atom, const Bodies &bodies, int ibody) const;
  void read_bonus(int atom, double mass, Own &mine) const;
  void find_corners(Site &site) const;
  void write_bonus(const Site &site, int shape, const double *q) const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
