/// Contact of a tool with the surface of a body.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "problems/mesh/topology.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/node_rows.hpp"
#include "problems/tissue/loads.hpp"

namespace hmax {

/// The pressure of a tool on the triangles of a surface, integrated by the trapezoidal rule: samples stand at
/// the barycentric coordinates (i, j, k) / n, i + j + k = n, and each has its share w of the area at rest. At
/// sample s of the triangle a, x_s = sum of b_a x_a, and with the energy per area e of the tool
///   E = sum of w_s e(x_s),   F_a = sum of w_s b_a p(x_s),   K_ab = -sum of w_s b_a b_b dp/dx(x_s).
/// The samples are dense enough for the tool not to slip between them.
class ToolContact {
 public:
  using Index = TetMesh::Index;

  /// @param rest  shape (3, points); every triangle has an area
  ToolContact(const Eigen::Matrix3Xd& rest, const MeshTriangles& surface, const SphereTool& tool);

  /// 2/5 k d^(5/2) integrated [J].
  [[nodiscard]] double energy(double t, const NodeRows& x) const;
  void add_force(double t, const NodeRows& x, const NodeRows& v, NodeRows& f) const;
  /// @param pattern  holds the pairs of points of every triangle
  void add_stiffness(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                     double* values) const;
  void add_damping(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern,
                   double* values) const;

  /// How far the tool has come, and what it has done to the surface [m].
  struct Reach {
    double depth = 0;         ///< that the tool has moved
    double indentation = 0;   ///< of it from the surface at rest on, less the penetration; 0 without contact
    double penetration = 0;   ///< the largest d of a sample: how far the surface stands inside the tool
    double displacement = 0;  ///< the largest one along the path of a sample that touches
  };
  [[nodiscard]] Reach reach(double t, const NodeRows& x) const;
  /// How far the tool moves until it meets the surface at rest [m]; infinity where it passes by.
  [[nodiscard]] double gap() const { return gap_; }

  struct Triangle {
    std::array<Index, 3> points;
    SampledTriangle<double> samples;
  };
  /// In the order in which they are added up.
  [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }

 private:
  /// Calls visit(triangle, b, w, touch) with the samples that touch, as if the surface moved with the tool.
  template <class Visit>
  void visit_samples(double t, const NodeRows& x, const Visit& visit) const;
  template <class Derivative>
  void add_blocks(double t, const NodeRows& x, const NodeRows& v, const BlockPattern& pattern, double* values,
                  const Derivative& derivative) const;

  SphereTool tool_;
  Eigen::Matrix3Xd rest_;  ///< of the points of the mesh
  std::vector<Triangle> triangles_;
  double gap_;
};

}  // namespace hmax
