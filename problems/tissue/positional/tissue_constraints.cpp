#include "problems/tissue/positional/tissue_constraints.hpp"

#include <algorithm>

#include <Eigen/Dense>

#include "core/instructions/compiled_for.hpp"
#include "core/instructions/lanes.hpp"
#include "problems/tissue/positional/colouring.hpp"
#include "problems/tissue/positional/element_constraints.hpp"
#include "problems/tissue/positional/free_points.hpp"

namespace hmax {

/// The same constraint of some tetrahedra.
struct TissueConstraints::SideBySide {
  const double* q;
  bool volumetric;
  std::array<const Tetrahedron*, Lanes::count> of_lane;
  Lanes value;
  Lanes gradients[4][3];  ///< dC/dq_i of each corner
};

namespace {

using Eigen::Vector3d;

void evaluate_spring(const Eigen::VectorXd& q, const TissueConstraints::Spring& spring,
                     CompliantConstraint& at) {
  const Vector3d d =
      spring.rest + displacement_of(q, spring.points[1]) - displacement_of(q, spring.points[0]);
  double gradients[2][3];
  at.set(spring_constraint(d.data(), spring.length, gradients), 1 / spring.stiffness);
  for (std::size_t i = 0; i < 2; ++i) at.add(spring.points[i], Vector3d(gradients[i]));
}

void evaluate_anchor(const Eigen::VectorXd& q, const TissueConstraints::Anchor& anchor, Eigen::Index axis,
                     CompliantConstraint& at) {
  at.set(q[3 * static_cast<Eigen::Index>(anchor.point) + axis], 1 / anchor.stiffness);
  at.add(anchor.point, Vector3d::Unit(axis));
}

}  // namespace

[[gnu::always_inline]] inline void TissueConstraints::evaluate_tetrahedra(SideBySide& all) {
  std::array<std::array<const double*, Lanes::count>, 4> u;
  for (std::size_t corner = 0; corner < 4; ++corner)
    for (std::size_t lane = 0; lane < Lanes::count; ++lane)
      u[corner][lane] = displacement_at(all.q, all.of_lane[lane]->points[corner]);
  Lanes U[3][3], g[3][3];
  for (int i = 0; i < 3; ++i) {
    const Lanes origin([&](std::size_t lane) { return u[0][lane][i]; });
    for (int a = 0; a < 3; ++a) {
      const auto& corner = u[static_cast<std::size_t>(a) + 1];
      U[a][i] = Lanes([&](std::size_t lane) { return corner[lane][i]; }) - origin;
      g[a][i] = Lanes([&](std::size_t lane) { return all.of_lane[lane]->gradients(a, i); });
    }
  }
  const Lanes excess([&](std::size_t lane) { return all.of_lane[lane]->excess; });
  tetrahedron_constraint<Lanes>(U, g, all.volumetric, excess, all.value, all.gradients);
}

TissueConstraints::Tetrahedron::Tetrahedron(const std::array<Index, 4>& its_points, const RestShape& rest,
                                            const Lame& lame)
    : points(its_points),
      gradients(rest.gradients),
      deviatoric(1 / (lame.mu * rest.volume)),
      volumetric(1 / ((lame.lambda + lame.mu) * rest.volume)),
      excess(lame.mu / (lame.lambda + lame.mu)) {}

TissueConstraints::TissueConstraints()
    : evaluate_tetrahedra_(CompiledFor<evaluate_tetrahedra>::of(instruction_sets().front())) {}

std::vector<std::vector<TissueConstraints::Index>> TissueConstraints::points() const {
  std::vector<std::vector<Index>> all;
  for (const Spring& each : springs_) all.emplace_back(each.points.begin(), each.points.end());
  for (const Tetrahedron& each : elements_)
    all.insert(all.end(), 2, std::vector<Index>(each.points.begin(), each.points.end()));
  for (const Anchor& each : anchors_) all.insert(all.end(), 3, std::vector<Index>{each.point});
  return all;
}

Colours TissueConstraints::colours() const {
  Colours colours = colours_by_points(points());
  for (std::vector<std::int32_t>& colour : colours)
    std::ranges::stable_sort(colour, {}, [&](std::int32_t c) { return place(c).kind; });
  return colours;
}

TissueConstraints::Place TissueConstraints::place(std::int32_t constraint) const {
  std::size_t i = static_cast<std::size_t>(constraint);
  if (i < springs_.size()) return {Kind::spring, i};
  i -= springs_.size();
  if (i < 2 * elements_.size()) return {i % 2 == 1 ? Kind::volumetric : Kind::deviatoric, i / 2};
  return {Kind::anchor, i - 2 * elements_.size()};
}

void TissueConstraints::evaluate(const Eigen::VectorXd& q, std::span<const std::int32_t> constraints,
                                 std::span<CompliantConstraint> at) const {
  for (std::size_t i = 0; i < constraints.size();) {
    const auto [kind, number] = place(constraints[i]);
    if (kind == Kind::spring) {
      evaluate_spring(q, springs_[number], at[i++]);
      continue;
    }
    if (kind == Kind::anchor) {
      evaluate_anchor(q, anchors_[number / 3], static_cast<Eigen::Index>(number % 3), at[i++]);
      continue;
    }
    // The next of the same kind, side by side; lanes that are left over repeat the first.
    SideBySide some;
    some.q = q.data();
    some.volumetric = kind == Kind::volumetric;
    some.of_lane.fill(&elements_[number]);
    std::size_t used = 1;
    for (; used < Lanes::count && i + used < constraints.size(); ++used) {
      const Place next = place(constraints[i + used]);
      if (next.kind != kind) break;
      some.of_lane[used] = &elements_[next.number];
    }
    evaluate_tetrahedra_(some);
    for (std::size_t lane = 0; lane < used; ++lane, ++i) {
      const Tetrahedron& element = *some.of_lane[lane];
      at[i].set(some.value[lane], some.volumetric ? element.volumetric : element.deviatoric);
      for (std::size_t a = 0; a < 4; ++a) {
        const Lanes(&slope)[3] = some.gradients[a];
        at[i].add(element.points[a], {slope[0][lane], slope[1][lane], slope[2][lane]});
      }
    }
  }
}

}  // namespace hmax
