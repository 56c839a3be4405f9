/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Assembly: from sites with positions and velocities to rigid bodies.

   Owner, mass properties, pose and velocities of a body follow from sums, extremes and counts over
   its sites.  Every rank sums over the sites that it owns, and a few numbers per body and rank are
   sent (gear_quat_ranks.h), so that memory and messages do not grow with the sites of a body.  The
   sums do not depend on the order of the sites (gear_quat_exact_sum.h), so bodies are the same, to
   the last bit, on any number of ranks.  For a small body the sums are plain sums in the order of
   the atom IDs: every rank that has one of its sites receives the other sites. */

#ifndef LMP_GEAR_QUAT_ASSEMBLY_H
#define LMP_GEAR_QUAT_ASSEMBLY_H

#include "gear_quat_bodies.h"
#include "gear_quat_exact_sum.h"
#include "gear_quat_infile.h"
#include "gear_quat_ranks.h"
#include "pointers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

namespace LAMMPS_NS::GearQuat {

class Extended;

/// A sum over the sites of a body; unit: the scale of an exact sum, 0 for a plain sum, which is not
/// merged.
struct SiteSum {
  ExactSum exact;
  double plain = 0.0;

  void add(double term, double unit)
  {
    unit > 0.0 ? exact.add(term, unit) : (void) (plain += term);
  }
  void merge(const SiteSum &other) { exact.add(other.exact); }
  double value(double unit) const { return unit > 0.0 ? exact.value(unit) : plain; }
};

/// Poses of owned atoms in bodies that are made again.
struct Former {
  std::vector<std::array<double, 3>> arm;    ///< along the principal axes
  std::vector<std::array<double, 9>> axes;
};

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
  /// ranks.  Collective.
  Assembly(LAMMPS *lmp, const GivenBodies &given, const Extended *extended,
           const std::vector<tagint> &ids, const Former *former);

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
  /// Warns of bodies of the same atom types with different shapes.  True if there are any.
  bool warn_of_shapes() const;

 private:
  const GivenBodies &given;
  const Extended *extended;
  const Former *former;    ///< null for new bodies
  Parts parts;
  std::vector<Made> made;
  double certain;    ///< sites closer to each other than this have consistent image flags

  enum { MASSLESS, NOT_FINITE, NEGATIVE, UNBALANCED, APART, FAULTS };
  tagint faulty[FAULTS] = {};    ///< a body with each fault on this rank, 0 for none
  std::vector<tagint> found;     ///< given bodies whose owner atoms are here

  struct Site {
    int rank, local;
    tagint tag;
    double mass;
    double x[3], v[3];                             ///< unwrapped
    double former_arm[3];                          ///< along the axes of the former body
    double inertia_space[9], momentum_space[3];    ///< of the site about its own center
  };
  std::map<int, std::vector<Site>> whole;    ///< small bodies on several ranks: part -> all sites

  // Results of one pass over the sites, for each part; merged, for the whole body.  A pass needs
  // the results of earlier passes.

  struct Sizes {    ///< scales of the sums
    bigint natoms;
    tagint first;         ///< smallest atom ID
    double first_x[3];    ///< of this atom, unwrapped: where image flags are relative to
    double mass, speed, own_inertia, own_momentum;    ///< largest component of a site
    int finite;
    uint64_t types;    ///< the same for the same atom types
    void merge(const Sizes &other);
  };
  struct Extremes {
    double lo[3], hi[3];    ///< box around the sites
    SiteSum mass;
    void merge(const Extremes &other);
  };
  struct Moments {    ///< about the middle of the box around the sites
    double distance2;
    tagint owner;    ///< atom ID of the site nearest to the middle
    int rank, local;
    double x[3];    ///< of this site
    SiteSum center[3], momentum[3];
    void merge(const Moments &other);
  };
  struct Momenta {          ///< about the center of mass
    double extent2;         ///< largest distance of a site from the owner atom, squared
    double from_center2;    ///< smallest one from the center of mass
    SiteSum inertia_space[6], angular_momentum_space[3];    ///< xx, xy, xz, yy, yz, zz
    void merge(const Momenta &other);
  };
  struct Reach {
    double largest;    ///< distance along a principal axis from the center of mass
    void merge(const Reach &other) { largest = std::max(largest, other.largest); }
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
  /// act: of every site of a part, or of the whole body if that is small.
  template <class Act> void visit(int part, Act act) const
  {
    const auto found = whole.find(part);
    if (found != whole.end())
      for (const Site &site : found->second) act(site);
    else
      for (const int i : parts.atoms(part)) act(site_of(part, i));
  }
  bool is_small(int part) const;
  double radius(int part) const;
  double scale_of(int part, double bound) const;
  double unit_of(int part, double bound) const;
  struct MomentaUnits {
    double inertia, momentum;
  };
  MomentaUnits units_of_momenta(int part) const;
  /// add: takes the sites of a part into its item.  Returns the items of whole bodies.
  template <class Item, class Add> std::vector<Item> over_sites(const Item &none, Add add) const
  {
    std::vector<Item> items(parts.number(), none);
    for (int part = 0; part < parts.number(); ++part) add(items[part], part);
    parts.merge(items);
    return items;
  }

  void find_sizes();
  void gather_small();
  void find_extremes();
  void find_moments();
  std::vector<Momenta> find_momenta();
  void take_given(const GivenBody &given_body, int part);
  void find_axes(int part, const Momenta &momenta);
  void orient_axes();
  static void direct(double *axes, const Sides &sides);
  void keep_axes();
  void find_rotation(int part, const Momenta &momenta);
  void check_place(int part, const Momenta &momenta);
  void check_moments(const Made &one);
  void report_faults();
  void report_missing() const;
  std::array<double, 2> bounds(int part, int direction) const;
  void warn_of_clumps() const;
};

}    // namespace LAMMPS_NS::GearQuat

#endif
