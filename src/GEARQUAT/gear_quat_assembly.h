/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Assembly: from sites with positions and velocities to rigid bodies.

   Owner, mass properties, pose and velocities of a body follow from sums, extremes and counts over
   its sites.  Every rank sums over the sites that it owns, and a few numbers per body and rank are
   sent (gear_quat_ranks.h), so that memory and messages do not grow with the sites of a body.  The
   sums do not depend on the order of the sites (gear_quat_exact_sum.h), so bodies are the same, to
   the last bit, on any number of ranks. */

#ifndef LMP_GEAR_QUAT_ASSEMBLY_H
#define LMP_GEAR_QUAT_ASSEMBLY_H

#include "gear_quat_bodies.h"
#include "gear_quat_exact_sum.h"
#include "gear_quat_given_bodies.h"
#include "gear_quat_ranks.h"
#include "pointers.h"

#include <algorithm>
#include <array>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Extended;

class Assembly : protected Pointers {
 public:
  /// A body with sites on this rank.
  struct Made {
    tagint owner;             ///< atom ID of the owner atom
    int owner_rank, local;    ///< where the owner atom is, and its index there
    Body body;
    BodyState state;
    double axes[9];    ///< principal, rotation matrix space -> body
    /// True if the velocity of a site with this place is not that of the body.
    bool moves_apart(const double *v, const double *arm_body) const;
  };

  /// Creates the bodies.  ids: of every owned atom, 0 for none.  extended: null if all atoms are
  /// points.  Massless bodies, and bodies in the infile that no atom belongs to, end the run on all
  /// ranks.  Rank 0 warns of a body in two parts, which wrong image flags may have made.  Collective.
  Assembly(LAMMPS *lmp, const GivenBodies &given, const Extended *extended,
           const std::vector<tagint> &ids);

  /// The bodies with sites on this rank.
  const std::vector<Made> &bodies() const { return made; }
  /// act: of the body, of a site's atom, and of its place in the body: from the center
  /// of mass, along the principal axes.
  template <class Act> void for_sites(Act act) const
  {
    for (int part = 0; part < parts.number(); ++part)
      for (const int i : parts.atoms(part)) {
        double x[3], arm[3], arm_body[3];
        unwrapped(part, i, x);
        find_arm(x, made[part].state.center, arm);
        to_body(made[part].axes, arm, arm_body);
        act(made[part], i, arm_body);
      }
  }

 private:
  const GivenBodies &given;
  const Extended *extended;
  Parts parts;
  std::vector<Made> made;

  enum { MASSLESS, NOT_FINITE, NEGATIVE, UNBALANCED, APART, FAULTS, TORN = FAULTS, FINDINGS };
  tagint faulty[FINDINGS] = {};    ///< a body with each fault on this rank, 0 for none
  std::vector<tagint> found;       ///< given bodies whose owner atoms are here

  struct Site {
    double mass;
    double x[3];    ///< unwrapped
    const double *v;
    int local;
    tagint tag;
  };

  // Results of one pass over the sites, for each part; merged, for the whole body.  A pass needs
  // the results of earlier passes.

  struct Sizes {    ///< scales of the sums
    bigint natoms;
    tagint first;         ///< smallest atom ID
    double first_x[3];    ///< of this atom, unwrapped: where image flags are relative to
    double mass, speed, own_inertia, own_momentum;    ///< largest component of a site
    int finite;
    void merge(const Sizes &other);
  };
  struct Extremes {
    double lo[3], hi[3];    ///< box around the sites
    ExactSum mass;
    void merge(const Extremes &other);
  };
  struct Moments {    ///< about the middle of the box around the sites
    double distance2;
    tagint owner;    ///< atom ID of the site nearest to the middle
    int rank, local;
    double x[3];    ///< of this site
    ExactSum center[3], momentum[3];
    void merge(const Moments &other);
  };
  struct Momenta {          ///< about the center of mass
    double extent2;         ///< largest distance of a site from the owner atom, squared
    double from_center2;    ///< smallest one from the center of mass
    ExactSum inertia_space[6], angular_momentum_space[3];    ///< xx, xy, xz, yy, yz, zz
    void merge(const Momenta &other);
  };
  struct Sides {    ///< of the heaviest site outside of the plane across each axis
    double mass[3];
    tagint tag[3];     ///< MAXTAGINT: there is no such site
    double side[3];    ///< distance from the plane
    void merge(const Sides &other);
  };
  std::vector<Sizes> sizes;
  std::vector<Extremes> extremes;
  std::vector<Moments> moments;

  /// Rows and columns of the six components of a symmetric tensor.
  static constexpr int ROW[6] = {0, 0, 0, 1, 1, 2}, COLUMN[6] = {0, 1, 2, 1, 2, 2};

  double mass_of(int i) const;
  void unwrapped(int part, int i, double *x) const;
  void find_arm(const double *x, const double *center, double *arm) const;
  Site site_of(int part, int i) const;
  /// act: of every site of a part.
  template <class Act> void visit(int part, Act act) const
  {
    for (const int i : parts.atoms(part)) act(site_of(part, i));
  }
  std::array<double, 3> middle(int part) const;
  double radius(int part) const;
  struct Scales {
    double mass, center, momentum, inertia, angular_momentum;
  };
  Scales scales(int part) const;
  /// add: takes the sites of a part into its item.  Returns the items of whole bodies.
  template <class Item, class Add> std::vector<Item> over_sites(const Item &none, Add add) const
  {
    std::vector<Item> items(parts.number(), none);
    for (int part = 0; part < parts.number(); ++part) add(items[part], part);
    parts.merge(items);
    return items;
  }

  void find_sizes();
  void find_extremes();
  void find_moments();
  std::vector<Momenta> find_momenta();
  void take_given(const GivenBody &given_body, int part);
  void find_axes(int part, const Momenta &momenta);
  void orient_axes();
  static void direct(double *axes, const Sides &sides);
  void find_rotation(int part, const Momenta &momenta);
  void check_parts(int part);
  void check_place(int part, const Momenta &momenta);
  void check_moments(const Made &one);
  void refuse_faults();
  void refuse_missing();
};

}    // namespace LAMMPS_NS::GearQuat

#endif
