/* ----------------------------------------------------------------------
   GEARQUAT - accurate motion of rigid bodies in LAMMPS
   This software is distributed under the GNU General Public License, version 2.
------------------------------------------------------------------------- */

/* Keyword temp, the start: chains at the nodes of the bodies' collocation. */

#include "gear_quat_thermostat.h"

using namespace LAMMPS_NS;
using namespace GearQuat;

/* ---------------------------------------------------------------------- */

void Thermostat::begin_start(const Collocation &collocation, double of, double h)
{
  spacing = of;
  step_of_start = h;
  nodes.resize(chains.size());
  for (size_t c = 0; c < chains.size(); ++c) {
    const auto y = chains[c].values();
    const auto rate = chains[c].rates(target_of(c, 0.0, h), twice_of(c), y);
    for (int v = 0; v < chains[c].size(); ++v) collocation.begin(y[v], rate[v], nodes[c][v]);
  }
}

void Thermostat::foretell(const Collocation &collocation)
{
  for (size_t c = 0; c < chains.size(); ++c)
    for (int v = 0; v < chains[c].size(); ++v) collocation.foretell(nodes[c][v]);
}

void Thermostat::measure_node(const Collocation &collocation, int node)
{
  sum_present();
  for (size_t c = 0; c < chains.size(); ++c) {
    Chain::Variables y = {};
    for (int v = 0; v < chains[c].size(); ++v)
      y[v] = collocation.value_at(node, nodes[c][v], spacing);
    friction[c] = y[0];
    const ChainTarget target = target_of(c, node * spacing / step_of_start, step_of_start);
    const auto rate = chains[c].rates(target, twice_of(c), y);
    for (int v = 0; v < chains[c].size(); ++v) collocation.set_rate(node, rate[v], nodes[c][v]);
  }
}

void Thermostat::settle(const Collocation &collocation, int pair)
{
  for (size_t c = 0; c < chains.size(); ++c)
    for (int v = 0; v < chains[c].size(); ++v) collocation.settle(pair, nodes[c][v]);
}

void Thermostat::seed(const Collocation &collocation, int pairs)
{
  std::vector<double> series(collocation.number_of_nodes() + 1);
  for (size_t c = 0; c < chains.size(); ++c)
    for (int v = 0; v < chains[c].size(); ++v) {
      const int terms = collocation.integrate(nodes[c][v].rate, pairs, spacing, series.data());
      chains[c].seed(v, series.data(), terms, spacing, step_of_start);
    }
}

void Thermostat::seed_local(double h)
{
  for (size_t c = 0; c < chains.size(); ++c) {
    const auto rate = chains[c].rates(target_of(c, 0.0, h), twice_of(c), chains[c].values());
    for (int v = 0; v < chains[c].size(); ++v) {
      const double series[2] = {0.0, h * rate[v]};
      chains[c].seed(v, series, 2, h, h);
    }
  }
}
