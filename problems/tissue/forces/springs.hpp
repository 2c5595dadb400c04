/// Springs and dampers between the points of a mesh.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/topology.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/kernels/kernels.hpp"
#include "problems/tissue/forces/kernels/spring_law.hpp"
#include "problems/tissue/forces/node_rows.hpp"
#include "problems/tissue/forces/point_strips.hpp"

namespace hmax {

/// A spring law is a function phi of the strain s = (l - L) / L, from which a spring of stiffness k [N/m] has
/// the tension T = k L phi(s) [N]. It answers with phi, its slope and its integral from 0.

// All but TableSpring are those of kernels/spring_law.hpp.

/// Straight lines through measured points (strain, phi), prolonged beyond the first and the last. At a point
/// the slope is that of the line to its right.
class TableSpring {
 public:
  /// @param strain  ascending, at least two
  /// @param phi     as many values
  /// @throws std::invalid_argument  when the strains do not ascend, the counts differ, or phi(0) is not 0: a
  ///         spring is at rest at its own length
  TableSpring(std::vector<double> strain, std::vector<double> phi);
  [[nodiscard]] double phi(double s) const { return lines().phi(s); }
  [[nodiscard]] double slope(double s) const { return lines().slope(s); }
  [[nodiscard]] double integral(double s) const;
  /// @returns what lives as long as this
  [[nodiscard]] SpringLines<double> lines() const {
    return {strain_.data(), phi_.data(), slope_.data(), static_cast<std::int32_t>(slope_.size())};
  }

 private:
  [[nodiscard]] double up_to(double s) const;  ///< integral from the first strain
  std::vector<double> strain_, phi_, slope_, sum_;
};

using SpringLaw = std::variant<LinearSpring, CubicSpring, ExponentialSpring, TableSpring>;

/// Stiffness [N/m] of a spring on each edge such that the springs resist a uniform stretch like a solid of
/// the given Young's modulus: k = sum over the tetrahedra at the edge of E V / L^2. Together they have the
/// energy of an isotropic solid with Poisson's ratio 1/4 under uniform dilation, whatever the mesh. That is
/// the only ratio that springs alone can have.
/// @param young  E of each region [Pa]
/// @source  [vangelder1998approximate]
std::vector<double> edge_stiffness(const TetMesh& mesh, const EdgeTable& edges,
                                   std::span<const double> young);

/// Springs of one law, each with a damper along it: a pulls b, with d = xb - xa, l = |d|, e = d / l, w = vb -
/// va,
///   F_a = (k L phi((l - L) / L) + c e.w) e = -F_b.
class SpringSet {
 public:
  using Index = TetMesh::Index;
  struct Spring {
    std::array<Index, 2> points;
    double stiffness;   ///< k [N/m]
    double damper = 0;  ///< c [N s/m]
  };

  /// @param rest     positions at which the springs are as long as they like to be, shape (3, points)
  /// @param pattern  holds the pair of points of every spring
  /// @throws std::invalid_argument  when a spring has no length, or pushes more the longer it is
  SpringSet(const Eigen::Matrix3Xd& rest, std::vector<Spring> springs, SpringLaw law,
            const BlockPattern& pattern, const TissueKernels& kernels = tissue_kernels());

  [[nodiscard]] double energy(const NodeRows& x) const;
  /// f += the elastic forces [N] at the positions x.
  void add_force(const NodeRows& x, NodeRows& f) const;
  /// f += the forces of the dampers [N] at positions x and velocities v.
  void add_damper_force(const NodeRows& x, const NodeRows& v, NodeRows& f) const;
  /// values += K = -dF/dx of the springs [N/m].
  void add_stiffness(const NodeRows& x, const BlockPattern& pattern, double* values) const;
  /// values += -dF/dx of the dampers, which is not symmetric.
  void add_damper_stiffness(const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                            double* values) const;
  /// values += C = -dF/dv [N s/m].
  void add_damping(const NodeRows& x, const BlockPattern& pattern, double* values) const;

  [[nodiscard]] std::size_t size() const { return springs_.size(); }
  [[nodiscard]] const Spring& spring(std::size_t i) const { return springs_[i]; }
  [[nodiscard]] double length(std::size_t i) const { return length_[i]; }  ///< L [m]
  [[nodiscard]] const SpringLaw& law() const { return law_; }
  [[nodiscard]] bool has_dampers() const { return has_dampers_; }
  /// The springs in the order in which their forces are added up, slice after slice, and b of phi = s + b
  /// s^3.
  struct Sliced {
    std::span<const SpringSlice> slices;
    std::span<const SpringBlock> blocks;
    std::span<const SpringEnds> ends;
    double cubic;
  };
  /// Nothing where the law is another one.
  [[nodiscard]] std::optional<Sliced> sliced() const;
  /// The block of spring i: its stiffness is (B, -B; -B, B).
  [[nodiscard]] Eigen::Matrix3d stiffness(const NodeRows& x, std::size_t i) const;

 private:
  class ByPoint;
  void make_slices(std::size_t points);
  void add_slice(const ByPoint& springs, std::span<const std::size_t> points);

  std::vector<Spring> springs_;
  std::vector<double> length_;  // L [m]
  // The same once more, for laws that the kernels know.
  std::vector<SpringSlice> slices_;
  std::vector<SpringBlock> blocks_;
  std::vector<SpringEnds> ends_;
  PointStrips strips_;
  std::vector<std::array<Index, 4>> slots_;
  SpringLaw law_;
  const TissueKernels* kernels_;
  bool has_dampers_ = false;
};

}  // namespace hmax
