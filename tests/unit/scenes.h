/* Motions with a known end, and the error of a run of the kernel. */

#pragma once

#include "checks.h"
#include "drive.h"
#include "oracles/cage_scene.h"
#include "oracles/swinging_top.h"

namespace Drive {

using Oracle::CageScene;
using Oracle::swing;
using Oracle::TOP;
using Oracle::top_state;
using std::vector;

struct Scene {
  RigidBody body;
  BodyState start;
  LoadOf load;
  double time;
  std::function<double(const BodyState &end)> missed;
};

inline double error(const Scene &scene, const Scheme &scheme, double h, double spacing,
                    Start start = Start::BOOTSTRAP)
{
  Motion motion(scene.body, scene.start, scene.load, scheme, h, start, spacing);
  motion.run(scene.time);
  return scene.missed(motion.state());
}

/// spacing: of the nodes of the start; 0: the spacing of each run.
inline vector<double> errors(const Scene &scene, const Scheme &scheme, const vector<double> &h,
                             double spacing = 0.0, Start start = Start::BOOTSTRAP)
{
  vector<double> list;
  for (double step : h)
    list.push_back(error(scene, scheme, step, spacing > 0.0 ? spacing : step, start));
  return list;
}

inline vector<double> error_slopes(const Scene &scene, const Scheme &scheme,
                                   const vector<double> &h, double spacing = 0.0,
                                   Start start = Start::BOOTSTRAP)
{
  return Check::slopes(h, errors(scene, scheme, h, spacing, start));
}

/// Center of mass in the paper's cage, in extended precision, accurate to all but the last digit.
struct CageReference {
  int test_case;
  bool consistent;
  double time, center[3];
};
constexpr CageReference CAGE_REFERENCES[] = {
    {1, true, 100, {85.43010788464767, -1.784299103660877, 1.14360193088973}},
    {1, true, 200, {85.56573248988141, -6.06135624295223, 6.86227956266460}},
    {1, false, 100, {86.693409428, -1.437897239, 0.844779738}},
    {1, false, 200, {84.82167549249749, -5.03225661408319, 7.72730548267065}},
    {3, true, 200, {74.503045115, 0.054749072, 0.083234521}}};

inline Scene cage(const CageScene &scene, const CageReference &reference = CAGE_REFERENCES[1])
{
  return {scene.body, scene.start, scene, reference.time, [&reference](const BodyState &s) {
            double d[3];
            for (int i = 0; i < 3; ++i) d[i] = s.center[i] - reference.center[i];
            return std::sqrt(dot3(d, d));
          }};
}

/// x'' = -strength x: cosine, sine, and both; the solution is known for strength 1.
inline Scene oscillator(double time, double strength = 1.0, bool of_velocity = false)
{
  Scene scene = {{2.5, {1.0, 1.0, 1.0}}, {}, {}, time, {}};
  scene.start.q[3] = scene.start.center[0] = scene.start.velocity[1] = 1.0;
  scene.start.center[2] = scene.start.velocity[2] = 0.7;
  scene.load = [strength](const BodyState &s, double) {
    Load l = {};
    for (int i = 0; i < 3; ++i) l.force[i] = -strength * 2.5 * s.center[i];
    return l;
  };
  scene.missed = [time, of_velocity](const BodyState &s) {
    const double c = std::cos(time), d = std::sin(time);
    const double x[3] = {c, d, 0.7 * (c + d)}, v[3] = {-d, c, 0.7 * (c - d)};
    return of_velocity ? Check::largest_difference(v, s.velocity, 3)
                       : Check::largest_difference(x, s.center, 3);
  };
  return scene;
}

/// The orientation of the free asymmetric top; |omega| is 1.2.
inline Scene free_top()
{
  static const BodyState start = top_state(0.0), end = top_state(24.0);
  return {TOP, start, free_of_load, 24.0, [](const BodyState &s) {
            return Check::attitude_distance(s.q, end.q);
          }};
}

}    // namespace Drive
