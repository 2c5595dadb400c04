/// Elements and springs as they stand in a textbook, for comparison with the loops of
/// problems/tissue/forces/kernels/kernels.hpp: one after the other, with Eigen and three numbers a point.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Dense>

#include "problems/mesh/tet_mesh.hpp"
#include "problems/tissue/forces/block_pattern.hpp"
#include "problems/tissue/forces/elasticity.hpp"

namespace hmax::plain {

using Index = TetMesh::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

inline std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }
inline Eigen::Map<const Vector3d> at_point(const double* x) { return Eigen::Map<const Vector3d>(x); }

/// St. Venant-Kirchhoff elements.
class Green {
 public:
  Green(const TetMesh& mesh, const Lame& lame) : lame_(lame) {
    for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
      Element e;
      Matrix3d rest;
      for (Eigen::Index a = 0; a < 4; ++a) e.points[at(a)] = mesh.tetrahedra(a, t);
      for (Eigen::Index a = 1; a < 4; ++a)
        rest.col(a - 1) = mesh.points.col(mesh.tetrahedra(a, t)) - mesh.points.col(mesh.tetrahedra(0, t));
      e.Bm = rest.inverse();
      e.volume = rest.determinant() / 6;
      elements_.push_back(e);
    }
  }

  void force(const double* x, double* f) const {
    for (const Element& e : elements_) {
      const Matrix3d F = deformation(x, e);
      const Matrix3d E = 0.5 * (F.transpose() * F - Matrix3d::Identity());
      const Matrix3d S = 2 * lame_.mu * E + lame_.lambda * E.trace() * Matrix3d::Identity();
      const Matrix3d H = -e.volume * F * S * e.Bm.transpose();
      for (std::size_t a = 1; a < 4; ++a)
        Eigen::Map<Vector3d>(f + 3L * e.points[a]) += H.col(static_cast<Eigen::Index>(a) - 1);
      Eigen::Map<Vector3d>(f + 3L * e.points[0]) -= H.col(0) + H.col(1) + H.col(2);
    }
  }

  /// All sixteen blocks where the pattern has them, with
  ///   K_ab = V ((g_a.S g_b) I + lambda (F g_a)(F g_b)^T + mu ((F g_b)(F g_a)^T + (g_a.g_b) F F^T)).
  void place(const BlockPattern& pattern) {
    for (const Element& e : elements_) slots_.push_back(pattern.slots(e.points));
  }
  void stiffness(const double* x, const BlockPattern& pattern, double* values) const {
    for (std::size_t n = 0; n < elements_.size(); ++n) {
      const Element& e = elements_[n];
      const Matrix3d F = deformation(x, e), E = 0.5 * (F.transpose() * F - Matrix3d::Identity());
      const double vl = e.volume * lame_.lambda, vm = e.volume * lame_.mu;
      const Matrix3d S = 2 * vm * E + vl * E.trace() * Matrix3d::Identity(), B = vm * F * F.transpose();
      Eigen::Matrix<double, 3, 4> g;
      g.rightCols<3>() = e.Bm.transpose();
      g.col(0) = -g.rightCols<3>().rowwise().sum();
      const Eigen::Matrix<double, 3, 4> h = F * g, s = S * g;
      for (Eigen::Index a = 0; a < 4; ++a)
        for (Eigen::Index b = 0; b <= a; ++b) {
          // In plain loops: half the time that products of Eigen take here.
          const double gg = g.col(a).dot(g.col(b)), sg = g.col(a).dot(s.col(b));
          const Index slot = slots_[n][at(4 * a + b)], mirror = slots_[n][at(4 * b + a)];
          const Index stride = pattern.stride(e.points[at(b)]), other = pattern.stride(e.points[at(a)]);
          for (Eigen::Index j = 0; j < 3; ++j)
            for (Eigen::Index i = 0; i < 3; ++i) {
              const double k =
                  vl * h(i, a) * h(j, b) + vm * h(i, b) * h(j, a) + gg * B(i, j) + (i == j ? sg : 0);
              if (slot >= 0) values[slot + j * stride + i] += k;
              if (mirror >= 0 && a != b) values[mirror + i * other + j] += k;
            }
        }
    }
  }

 private:
  struct Element {
    std::array<Index, 4> points;
    Matrix3d Bm;
    double volume;
  };
  static Matrix3d deformation(const double* x, const Element& e) {
    const Vector3d origin = at_point(x + 3L * e.points[0]);
    Matrix3d Ds;
    Ds << at_point(x + 3L * e.points[1]) - origin, at_point(x + 3L * e.points[2]) - origin,
        at_point(x + 3L * e.points[3]) - origin;
    return Ds * e.Bm;
  }
  Lame lame_;
  std::vector<Element> elements_;
  std::vector<std::array<Index, 16>> slots_;
};

/// Linear springs.
struct Springs {
  struct Spring {
    Index a, b;
    double length, stiffness;
  };
  std::vector<Spring> springs;

  void force(const double* x, double* f) const {
    for (const Spring& s : springs) {
      const Vector3d d = at_point(x + 3L * s.b) - at_point(x + 3L * s.a);
      const Vector3d pull = s.stiffness * (1 - s.length / d.norm()) * d;
      Eigen::Map<Vector3d>(f + 3L * s.a) += pull;
      Eigen::Map<Vector3d>(f + 3L * s.b) -= pull;
    }
  }
};

}  // namespace hmax::plain
