/// A bound of the spectral radius of a body by the memory of a device.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "catalogue/device/body_matrix.hpp"
#include "catalogue/device/device.hpp"
#include "catalogue/device/patches/body_patches.hpp"
#include "catalogue/device/programs/device_program.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

/// Why the spectral radius of a body that has patches is not found there, "has ..."; empty where it is.
inline std::string unsuited_for_radius(const TissueBody& body) {
  if (std::ranges::any_of(body.spring_sets(), &SpringSet::has_dampers))
    return "has dampers, whose spectral radius is not found there";
  if (!std::ranges::all_of(body.settings().supports,
                           [](const Support& each) { return each.travel.isZero(0); }))
    return "has supports that move, and its spectral radius is not found there";
  if (std::ranges::any_of(body.settings().tools, [](const SphereTool& tool) { return tool.damping != 0; }))
    return "meets a tool that damps, and its spectral radius is not found there";
  return {};
}

/// TissueBody::spectral_radius(): the stiffness is added up and bounded on the device, and its bound is read
/// back. Damping does not change, nor does the stiffness of small strain without tools: their bounds are the
/// processor's.
class RadiusOnDevice {
 public:
  /// @param memory  outlives this
  /// @param body    one that unsuited_for_patches() has nothing against
  RadiusOnDevice(DeviceMemory& memory, const TissueBody& body, const BodyPatches& patches) : memory_(memory) {
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(body.dofs());
    TissueBody::DofMatrix matrix;
    const TetBlocks* const tetrahedra = body.element_parts().tetrahedra;
    if (body.spring_sets().empty() && !body.membrane() && body.contacts().empty() && tetrahedra &&
        tetrahedra->law() == TetLaw::small_strain) {
      body.stiffness(0, still, still, matrix);
      stiffness_ = body.bound_of(matrix);
    } else {
      place_matrix(body, patches);
    }
    body.damping(0, still, still, matrix);
    damping_ = body.bound_of(matrix);
  }

  /// Whether it is the same at all displacements.
  [[nodiscard]] bool is_constant() const { return !matrix_; }

  /// At the displacements of step.q, and where tools are at step.evaluation [1/s].
  [[nodiscard]] double at(BodyStep<double> step) const {
    if (is_constant()) return TissueBody::radius_of_bounds(stiffness_, damping_);
    step.q_next = step.q;
    BoundPieces bound = bound_;
    bound.mass = step.body.mass;
    std::vector<DeviceProgram> programs;
    append_volumes(step, programs);
    matrix_->append(std::numeric_limits<double>::infinity(), step, programs);
    programs.push_back({bound});
    Device& device = memory_.device();
    device.run(programs, 1, {});
    std::vector<double> largest(2 * static_cast<std::size_t>(bound.matrix.pieces()));
    device.read(largest.data(), bound.largest, sizeof(double) * largest.size());
    double column = largest[0], row = largest[1];
    for (std::size_t n = 2; n < largest.size(); n += 2) {
      column = std::max(column, largest[n]);
      row = std::max(row, largest[n + 1]);
    }
    return TissueBody::radius_of_bounds(TissueBody::bound_of_sums(column, row), damping_);
  }

  /// Of at().
  [[nodiscard]] double flops() const { return matrix_ ? matrix_->flops() + 33.0 * blocks() : 0; }
  [[nodiscard]] double bytes() const {
    constexpr double of_a_block = 2 * (9 * sizeof(double) + sizeof(std::int32_t));
    return matrix_ ? matrix_->bytes() + of_a_block * blocks() : 0;
  }

 private:
  [[nodiscard]] std::int32_t blocks() const { return bound_.matrix.blocks; }

  void place_matrix(const TissueBody& body, const BodyPatches& patches) {
    const MatrixArrays made = matrix_arrays(body, patches.number);
    std::vector<std::int32_t> transposed;
    for (std::size_t n = 0; n < made.blocks(); ++n)
      transposed.push_back(static_cast<std::int32_t>(made.block(made.column[n], made.row[n])));
    bound_.matrix = matrix_.emplace(memory_, made, patches).there();
    bound_.transposed = memory_.copy(transposed);
    bound_.largest = memory_.room<double>(2 * static_cast<std::size_t>(bound_.matrix.pieces()));
  }

  DeviceMemory& memory_;
  std::optional<MatrixOnDevice> matrix_;  ///< none where the stiffness is constant
  BoundPieces bound_{};
  double stiffness_ = 0, damping_ = 0;
};

}  // namespace hmax
