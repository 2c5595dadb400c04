#include "catalogue/models/free_parts.hpp"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/models/tissue_problem.hpp"
#include "core/dense_solvers.hpp"
#include "core/sort_unique.hpp"
#include "problems/mesh/mesh_parts.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

std::vector<FreePart> free_parts_of(const TissueBody& body) {
  std::vector<Index> free = body.free_points(), held;
  std::ranges::sort(free);
  for (Index i = 0; i < body.mesh().point_count(); ++i)
    if (!std::ranges::binary_search(free, i)) held.push_back(i);
  for (const ElasticSupport& support : body.settings().elastic_supports)
    for (std::size_t i = 0; i < support.points.size(); ++i)
      if (support.stiffness[i] > 0) held.push_back(support.points[i]);
  sort_unique(held);
  return free_parts(body.mesh(), held);
}

/// "the body", "tetrahedron 7", "24 tetrahedra (25, 26, 27, ...)"
std::string part_in_words(const Problem& problem, const FreePart& part) {
  if (static_cast<Index>(part.tetrahedra.size()) == problem.body->mesh().tetrahedron_count())
    return "the body";
  constexpr std::size_t most = 3;
  std::vector<std::int64_t> numbers;
  for (const Index t : part.tetrahedra) numbers.push_back(tetrahedron_number(problem, t));
  std::ranges::sort(numbers);
  // Parts of one element share its number.
  if (problem.body->mesh().has_ten_nodes())
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  const std::size_t count = numbers.size();
  if (count == 1) return fmt::format("tetrahedron {}", numbers.front());
  numbers.resize(std::min(numbers.size(), most));
  return fmt::format("the part of {} tetrahedra ({}{})", count, fmt::join(numbers, ", "),
                     count > most ? ", ..." : "");
}

}  // namespace

Eigen::MatrixXd free_motions(const TissueBody& body) {
  const std::vector<FreePart> parts = free_parts_of(body);
  Eigen::Index count = 0;
  for (const FreePart& part : parts) count += part.motions.cols();
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(body.dofs(), count);
  if (count == 0) return motions;
  Eigen::Index column = 0;
  for (const FreePart& part : parts) {
    for (std::size_t i = 0; i < part.points.size(); ++i)
      if (const Eigen::Index own = body.free_numbers()[static_cast<std::size_t>(part.points[i])]; own >= 0)
        motions.block(3 * own, column, 3, part.motions.cols()) =
            part.motions.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    column += part.motions.cols();
  }
  // Orthonormal with the root of M before them; free motions of different parts are already.
  const Eigen::VectorXd root = body.mass().cwiseSqrt();
  return root.cwiseInverse().asDiagonal() * orthonormal_basis(root.asDiagonal() * motions);
}

std::vector<std::vector<Eigen::Index>> loose_dofs(const TissueBody& body) {
  std::vector<std::vector<Eigen::Index>> dofs;
  for (const FreePart& part : free_parts_of(body)) {
    if (part.motions.cols() < 6) continue;
    dofs.emplace_back();
    for (const Index point : part.points)
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        dofs.back().push_back(3 * body.free_numbers()[static_cast<std::size_t>(point)] + axis);
  }
  return dofs;
}

std::string free_parts_in_words(const Problem& problem) {
  if (!problem.body) return {};
  const std::vector<FreePart> parts = free_parts_of(*problem.body);
  if (parts.empty()) return {};
  const std::string which = part_in_words(problem, parts.front());
  const Eigen::Index left = parts.front().motions.cols();
  std::string words =
      left == 6 ? fmt::format("the supports hold no point of {}, which moves freely", which)
      : left == 3
          ? fmt::format("the supports hold one point of {}, about which it turns freely", which)
          : fmt::format("the supports hold points of {} in one line, about which it turns freely", which);
  if (parts.size() == 2) words += ", and another part is not held either";
  if (parts.size() > 2) words += fmt::format(", and {} other parts are not held either", parts.size() - 1);
  return words + "; hold more points";
}

}  // namespace hmax
