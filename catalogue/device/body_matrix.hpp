/// The stiffness and damping of a body, for newton_step.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "catalogue/device/newton_step.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

/// The arrays of BodyMatrix, as they are copied to a device.
struct MatrixArrays {
  struct Lists {
    std::vector<std::int32_t> first, of;
  };
  std::vector<std::int32_t> first, row, column, sum_of, rim;
  TetLaw law = TetLaw::green;
  std::vector<StiffTet> tets;
  Lists terms, spring_terms, triangle_terms, damper_terms;
  std::vector<double> constant, damping;  ///< empty: none
  std::vector<StiffSpring> springs;
  std::vector<StiffTriangle> triangles;
  std::vector<StiffDamper> dampers;
  double alpha = 0;

  [[nodiscard]] std::size_t blocks() const { return column.size(); }
  [[nodiscard]] std::size_t sums() const { return terms.first.empty() ? 0 : terms.first.size() - 1; }
};

/// @param body    one that unsuited_for_patches() has nothing against
/// @param number  of each point of the mesh among those of BodyArrays
MatrixArrays matrix_arrays(const TissueBody& body, std::span<const std::int32_t> number);

}  // namespace hmax
