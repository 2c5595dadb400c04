/// The stiffness and damping of a body, for stiffness_step.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "catalogue/device/device.hpp"
#include "catalogue/device/patches/body_patches.hpp"
#include "catalogue/device/programs/device_program.hpp"
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
  std::vector<StiffTenNodes> ten_nodes;
  std::vector<StiffShares> shares;
  std::int32_t averages = 0;                ///< that tetrahedra share
  Lists averages_at_point, gradient_terms;  ///< see StiffPressures
  Lists terms, fibre_terms, spring_terms, triangle_terms, damper_terms, contact_terms;
  std::vector<double> constant, damping;  ///< empty: none
  std::vector<StiffFibre> fibres;
  std::vector<StiffSpring> springs;
  std::vector<StiffTriangle> triangles;
  std::vector<StiffDamper> dampers;
  std::vector<StiffContact> contacts;
  double alpha = 0;

  [[nodiscard]] std::size_t blocks() const { return column.size(); }
  /// The number of a block of the pattern.
  [[nodiscard]] std::size_t block(std::int32_t i, std::int32_t j) const;
  /// The entries of a matrix of this pattern, shape (blocks, 9).
  [[nodiscard]] std::vector<double> entries_of(const TissueBody::DofMatrix& matrix) const;
  [[nodiscard]] std::size_t sums() const { return terms.first.empty() ? 0 : terms.first.size() - 1; }
};

/// @param body    one that unsuited_for_patches() has nothing against
/// @param number  of each point of the mesh among those of BodyArrays
MatrixArrays matrix_arrays(const TissueBody& body, std::span<const std::int32_t> number);

/// Its pattern alone.
MatrixArrays pattern_arrays(const TissueBody& body);

/// The same in the memory of a device, and the programs that add it up.
class MatrixOnDevice {
 public:
  /// @param memory  outlives this
  MatrixOnDevice(DeviceMemory& memory, const MatrixArrays& made, const BodyPatches& patches);

  [[nodiscard]] const BodyMatrix& there() const { return there_; }
  /// Appends A = K + C / h + M / h^2 at step.q_next, which is K for an infinite h. Volumes that tetrahedra
  /// share are known there, see append_volumes().
  void append(double h, const BodyStep<double>& step, std::vector<DeviceProgram>& programs) const;
  /// Of one assembly.
  [[nodiscard]] double flops() const;
  [[nodiscard]] double bytes() const;

 private:
  BodyMatrix there_{};
  double terms_, flops_of_terms_;  ///< of the lists
};

}  // namespace hmax
