/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* The atoms of bodies: sites, listed body by body, so that a sum over the sites of a body needs no
   data of other bodies.  Positions and velocities of atoms follow from the states of their bodies,
   and loads of bodies follow from the forces on their atoms.

   The periodic images of sites are integers, and their displacements are computed from the present
   box: so no data depend on earlier boxes.

   The fix calls list() after Ownership::update(); and every step:
     [predict states] -> Ownership::spread_moved() -> place() -> [forces] -> gather_loads()
     -> [correct states] -> Ownership::spread_moved() -> place() */

#ifndef LMP_GEAR_QUAT_SITES_H
#define LMP_GEAR_QUAT_SITES_H

#include "gear_quat_exact_sum.h"
#include "gear_quat_fields.h"
#include "gear_quat_ownership.h"

#include <functional>

namespace LAMMPS_NS::GearQuat {

struct Arguments;

/// An owned atom of a body; stays valid until atoms are exchanged.
struct Site {
  int atom, body;
  double arm_body[3];    ///< from the center of mass, along the principal axes
};

class Sites : protected Pointers {
 public:
  Sites(LAMMPS *lmp, Bodies &bodies, Ownership &ownership);

  // body by body; within a body sites at its center of mass first, then by local index

  int number() const { return (int) sites.size(); }
  const Site *begin() const { return sites.data(); }
  const Site *end() const { return begin() + sites.size(); }
  const Site &operator[](int n) const { return sites[n]; }

  /// Lists the sites of all bodies, after atoms were exchanged or bodies were made.
  void list();
  /// Sites on this rank that are more than points.
  bigint number_of_extended() const { return (bigint) extended.sites.size(); }

  // positions and velocities

  /// Sets positions of all sites, and velocities if they are read before the next call.
  void place(bool velocities);
  /// Sets only velocities: before a run positions were set by the last step, or by the user.
  void place_velocities();
  /// Half a step of densities and energies of smoothed particles, as in fix sph.
  void advance_densities(double step);
  /// Sets orientations and rates of extended atoms, if only these have changed.
  void place_extended();
  /// True if masses, positions, velocities or orientations of atoms differ from their bodies.
  /// Collective.
  bool any_changes() const;
  /// The largest distance between an atom and its place in its body, 0 up to rounding.  Collective.
  double farthest() const;
  /// The number of times that sites were listed or placed, the same on all ranks: results computed
  /// from positions or loads at another number are out of date.
  int placements() const { return nplacements; }

  struct Expected {    ///< position or velocity of a site from the state of its body
    double value[3];
    double size;    ///< scale of its rounding error
  };
  // site: one of this list
  Expected expected_position(const Site &site) const;
  Expected expected_velocity(const Site &site) const;
  /// The distance of the atom from its place in its body; 0 up to rounding, relative to box and body.
  double displacement(const Site &site) const;
  /// True if the velocity of the atom matches its body, up to rounding.
  bool is_as_fast(const Site &site) const;

  /// The number of periods between the unwrapped and the wrapped position of an atom of a body.
  std::array<int, 3> image_of(const Site &site) const;

  // With fix deform remap v a site has the velocity of its own image, which moves with the faces of
  // the box relative to the image of its body (Body::image).

  /// The rates of the box, as Domain::h, with which velocities were placed; zero without the above.
  using Rates = std::array<double, 6>;
  const Rates &rates_of_faces() const { return face_rates; }
  void fields(Fields &v) { v(face_rates, face_group); }
  /// Gives the atoms the velocities of the images of their bodies, for the present rates of the box.
  void take_out_flow();

  // sums over sites

  /// Loads of all bodies that this rank moves, from the forces on the sites of all ranks.  torque:
  /// of the atoms themselves, used for extended atoms; null for none.
  void gather_loads(double **f, double **torque);

  /// Adds the products of forces on owned sites and their arms, f_a d_b for xx yy zz yz xz xy: as
  /// exact sums of this scale over the bodies.
  void add_arm_virial(double **f, ExactSum *sums, double scale) const;

  /// Constraint force m a - f of a site under the present loads, its arm from the center of mass,
  /// its virial (xx yy zz xy xz yz), and the mean position of the body's sites.
  struct ConstraintForce {
    double force[1][3], arm[1][3], virial[6], centroid[3];
  };
  /// YES if bodies turn; otherwise the forces on a body act only at its center of mass.
  enum class Turning { NO, YES };
  /// tally: of an atom and its constraint force.  The constraint forces of a body add up to zero,
  /// so the virial does not depend on the origin.  all: include sites at centers of mass and
  /// compute centroids, as required by the centroid form of the virial; otherwise centroids are 0.
  /// Collective.
  void visit_constraint_forces(double **f, bool all, Turning turning,
                               const std::function<void(int, ConstraintForce &)> &tally);

  double memory_usage() const;

 private:
  Bodies &bodies;
  Ownership &ownership;
  Extended &extended;

  std::vector<Site> sites;
  std::vector<std::array<int, 3>> images;     ///< in periods, from wrapped to unwrapped positions
  std::vector<int> image;                     ///< of the sites: index of the image
  std::vector<std::array<double, 3>> ways;    ///< scratch: of the images, in the present box
  std::vector<int> first, first_arm;    ///< the first site of each body, and the first with an arm
  Rates face_rates = {};
  int face_group = 1;    ///< bit of the group of fix deform
  int nplacements = 0;

  void sort();
  void wrap(const Site &site, double *away) const;
  void find_ways();
  void add_flow(const Site &site, double factor, double *velocity) const;
  void note_rates();
  template <bool POSITIONS, bool VELOCITIES> void place_points();
  template <class Start, class Add, class Finish>
  void sum_over_sites(Start start, Add add, Finish finish) const;
  std::vector<std::array<double, 3>> centroids();
};

/// What the objects of a fix share.
struct Scene : protected Pointers {
  const Fix *const fix;
  const Arguments &args;
  Bodies &bodies;
  Ownership &ownership;
  Sites &sites;

  Scene(LAMMPS *lmp, const Fix *fix, const Arguments &args, Bodies &bodies, Ownership &ownership,
        Sites &sites) :
      Pointers(lmp),
      fix(fix), args(args), bodies(bodies), ownership(ownership), sites(sites)
  {
  }
};

}    // namespace LAMMPS_NS::GearQuat

#endif
