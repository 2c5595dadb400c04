#include "problems/tissue/forces/nodal_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Dense>

#include "core/sort_unique.hpp"
#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/kernels/element_pull.hpp"
#include "problems/tissue/forces/kernels/element_stiffness.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"

namespace hmax {

using Eigen::Matrix3d;
using Eigen::Vector3d;

NodalPressure::NodalPressure(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern) {
  elements_.reserve(at(mesh.tetrahedron_count()));
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    std::array<Index, 4> points;
    for (std::size_t a = 0; a < 4; ++a) points[a] = mesh.tetrahedra(static_cast<Eigen::Index>(a), t);
    const Lame& all = lame[at(mesh.region(t))];
    elements_.push_back(
        {.points = points, .rest = RestShape(mesh, points), .own = {std::min(all.lambda, 0.0), all.mu}});
  }
  make_averages(mesh, lame);
  find_slots(pattern);
}

void NodalPressure::make_averages(const TetMesh& mesh, std::span<const Lame> lame) {
  // By point, then by region.
  struct Corner {
    Index point, region, element, corner;
    auto operator<=>(const Corner&) const = default;
  };
  std::vector<Corner> corners;
  corners.reserve(4 * elements_.size());
  for (std::size_t e = 0; e < elements_.size(); ++e)
    for (Index a = 0; a < 4; ++a)
      corners.push_back({elements_[e].points[at(a)],
                         static_cast<Index>(mesh.region(static_cast<Eigen::Index>(e))), static_cast<Index>(e),
                         a});
  std::ranges::sort(corners);
  for (std::size_t i = 0; i < corners.size();) {
    const Corner& first = corners[i];
    Average average{.lambda = std::max(lame[at(first.region)].lambda, 0.0), .first = points_.size()};
    std::size_t end = i;
    std::vector<Index> around;
    for (; end < corners.size() && corners[end].point == first.point && corners[end].region == first.region;
         ++end) {
      const Element& e = elements_[at(corners[end].element)];
      around.insert(around.end(), e.points.begin(), e.points.end());
      average.volume += e.rest.volume / 4;
    }
    sort_unique(around);
    std::erase(around, first.point);
    around.insert(around.begin(), first.point);
    if (around.size() > std::numeric_limits<std::uint16_t>::max())
      throw std::invalid_argument("more than 65535 points lie around point " + std::to_string(first.point) +
                                  "; use another model than fem_nodal_pressure");
    for (; i < end; ++i) {
      Element& e = elements_[at(corners[i].element)];
      const std::size_t own = at(corners[i].corner);
      e.averages[own] = static_cast<Index>(averages_.size());
      for (std::size_t b = 0; b < 4; ++b)
        e.place[4 * own + b] = static_cast<std::uint16_t>(
            e.points[b] == around.front()
                ? 0
                : std::lower_bound(around.begin() + 1, around.end(), e.points[b]) - around.begin());
    }
    points_.insert(points_.end(), around.begin(), around.end());
    average.last = points_.size();
    averages_.push_back(average);
  }
}

void NodalPressure::find_slots(const BlockPattern& pattern) {
  for (const Element& e : elements_) element_slots_.push_back(pattern.slots(e.points));
  for (Average& average : averages_) {
    average.first_slot = slots_.size();
    for (std::size_t i = average.first; i < average.last; ++i)
      for (std::size_t j = average.first; j < average.last; ++j)
        slots_.push_back(pattern.slot(points_[i], points_[j]));
  }
}

NodalPressure::Scratch& NodalPressure::scratch() {
  thread_local Scratch now;
  return now;
}

void NodalPressure::average(const NodeRows& u, Scratch& now) const {
  using Lanes = OneElement<double>;
  now.H.resize(elements_.size());
  now.change.assign(averages_.size(), 0);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const Element& e = elements_[i];
    double U[3][3], g[3][3];
    edge_vectors(u, e.points, U);
    e.rest.write_rows(g);
    kernel_loops::displacement_gradient<Lanes, double>(U, g, now.H[i].rows);
    const double share = e.rest.volume / 4 * kernel_loops::volume_change<Lanes, double>(now.H[i].rows);
    for (const Index a : e.averages) now.change[at(a)] += share;
  }
  for (std::size_t a = 0; a < averages_.size(); ++a) now.change[a] /= averages_[a].volume;
}

double NodalPressure::pressure(const Element& e, const Scratch& now) const {
  double sum = 0;
  for (const Index a : e.averages) sum += averages_[at(a)].lambda * now.change[at(a)];
  return sum / 4;
}

double NodalPressure::energy_density(std::size_t element, const Scratch& now) const {
  const Element& e = elements_[element];
  double shared = 0;
  for (const Index a : e.averages) {
    const double change = now.change[at(a)];
    shared += averages_[at(a)].lambda / 2 * change * change;
  }
  return StableNeoHookean(now.H[element].matrix(), e.own).energy() + shared / 4;
}

double NodalPressure::energy(const NodeRows& u) const {
  Scratch& now = scratch();
  average(u, now);
  double sum = 0;
  for (std::size_t e = 0; e < elements_.size(); ++e) sum += elements_[e].rest.volume * energy_density(e, now);
  return sum;
}

void NodalPressure::write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const {
  Scratch& now = scratch();
  average(u, now);
  for (std::size_t e = 0; e < elements_.size(); ++e) W[static_cast<Eigen::Index>(e)] = energy_density(e, now);
}

void NodalPressure::add_force(const NodeRows& u, NodeRows& f) const {
  using Lanes = OneElement<double>;
  Scratch& now = scratch();
  average(u, now);
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const Element& e = elements_[i];
    const double V = e.rest.volume;
    double g[3][3], P[3][3], pull[3][3];
    e.rest.write_rows(g);
    kernel_loops::neo_hookean_stress<Lanes, double>(now.H[i].rows, V * e.own.lambda / 2, V * e.own.mu, P,
                                                    V * pressure(e, now));
    kernel_loops::corner_pull<Lanes, double>(P, g, pull);
    subtract_pull(e.points, pull, f);
  }
}

template <class OfElement>
void NodalPressure::visit_elements(Scratch& now, const OfElement& of_element) const {
  using namespace kernel_loops;
  now.G.assign(points_.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const Element& e = elements_[i];
    const double V = e.rest.volume;
    NeoHookeanParts<OneElement<double>> parts;
    e.rest.write_rows(parts.g + 1);
    first_gradient(parts.g);
    neo_hookean_parts_of(now.H[i].rows, V * e.own.lambda / 2, V * e.own.mu, parts, V * pressure(e, now));
    for (std::size_t a = 0; a < 4; ++a) {
      Vector3d* const G = now.G.data() + averages_[at(e.averages[a])].first;
      // dJ/du of point b is C g_b.
      for (std::size_t b = 0; b < 4; ++b)
        for (int k = 0; k < 3; ++k) G[e.place[4 * a + b]][k] += V / 4 * parts.Cg[b][k];
    }
    of_element(i, symmetric_stiffness<4>(
                      [&](int a, int b, double(*block)[3]) { neo_hookean_stiffness(parts, a, b, block); }));
  }
  for (const Average& average : averages_)
    for (std::size_t i = average.first; i < average.last; ++i)
      now.G[i] *= std::sqrt(average.lambda / average.volume);
}

void NodalPressure::write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  std::fill_n(values, pattern.entries(), 0.0);
  Scratch& now = scratch();
  average(u, now);
  visit_elements(now, [&](std::size_t e, const ElementStiffness& K) {
    pattern.add_element(values, element_slots_[e], elements_[e].points, K);
  });
  for (const Average& average : averages_) {
    const Index* slot = slots_.data() + average.first_slot;
    for (std::size_t i = average.first; i < average.last; ++i)
      for (std::size_t j = average.first; j < average.last; ++j)
        pattern.add(values, *slot++, points_[j], Matrix3d(now.G[i] * now.G[j].transpose()));
  }
}

void NodalPressure::visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const {
  Scratch now;  // of its own: a visitor may ask for forces
  average(u, now);
  visit_elements(now, [&](std::size_t e, const ElementStiffness& K) { visit(elements_[e].points, K); });
  for (const Average& average : averages_) {
    const Eigen::Map<const Eigen::VectorXd> G(now.G[average.first].data(),
                                              static_cast<Eigen::Index>(3 * (average.last - average.first)));
    visit({points_.data() + average.first, average.last - average.first}, G * G.transpose());
  }
}

}  // namespace hmax
