#include "problems/mesh/mesh_generators.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "problems/digits.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/refine.hpp"

namespace hmax {

namespace {

using Index = TetMesh::Index;

void require_size(const char* what, double value) {
  // Volumes, masses and the squares of rates that follow from them must stay numbers.
  constexpr double least = 1e-12, most = 1e12;
  if (!(value >= least && value <= most))
    throw std::invalid_argument(std::string("the ") + what + " of a mesh is " + shortest_digits(value) +
                                " m; give a positive length from " + shortest_digits(least) + " to " +
                                shortest_digits(most) + " m");
}

void require_resolution(double tetrahedra, int cells) {
  if (cells < 1)
    throw std::invalid_argument("a mesh of " + std::to_string(cells) +
                                " cells has no tetrahedra; give n = 1 or more");
  if (tetrahedra > double(most_tetrahedra))
    throw std::invalid_argument("n = " + std::to_string(cells) + " makes more than " +
                                std::to_string(most_tetrahedra) + " tetrahedra; give a smaller n");
}

/// The ways to add three unit steps one after the other, even ones first.
constexpr std::array<std::array<int, 3>, 6> orders{
    {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};

/// The corners on the way from `from` by three unit steps.
std::array<Eigen::Vector3i, 4> walk(const Eigen::Vector3i& from, const std::array<int, 3>& order) {
  std::array<Eigen::Vector3i, 4> corners{from, from, from, from};
  for (std::size_t step = 0; step < 3; ++step)
    for (std::size_t later = step + 1; later < 4; ++later) ++corners[later](order[step]);
  return corners;
}

/// The corners of an icosahedron on the unit sphere, shape (3, 12).
Eigen::Matrix<double, 3, 12> icosahedron() {
  Eigen::Matrix<double, 3, 12> corners;
  const double golden = (1 + std::sqrt(5.0)) / 2;
  int column = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double a : {1.0, -1.0})
      for (const double b : {golden, -golden}) {
        Eigen::Vector3d corner = Eigen::Vector3d::Zero();
        corner((axis + 1) % 3) = a;
        corner((axis + 2) % 3) = b;
        corners.col(column++) = corner.normalized();
      }
  return corners;
}

/// Its faces: the triples of neighbours, whose distance is 1.05 radii.
std::vector<std::array<int, 3>> icosahedron_faces(const Eigen::Matrix<double, 3, 12>& corners) {
  const auto near = [&](int i, int j) { return (corners.col(i) - corners.col(j)).norm() < 1.2; };
  std::vector<std::array<int, 3>> faces;
  for (int i = 0; i < 12; ++i)
    for (int j = i + 1; j < 12; ++j)
      for (int k = j + 1; k < 12; ++k)
        if (near(i, j) && near(j, k) && near(i, k)) faces.push_back({i, j, k});
  return faces;
}

}  // namespace

TetMesh box_mesh(const Eigen::Vector3d& size, const Eigen::Vector3i& cells) {
  require_size("length", size(0));
  require_size("width", size(1));
  require_size("height", size(2));
  require_resolution(6 * cells.cast<double>().prod(), cells.minCoeff());
  const Eigen::Vector3i points = cells.array() + 1;
  const auto point = [&](const Eigen::Vector3i& at) {
    return static_cast<Index>(at(2) + points(2) * (at(1) + points(1) * at(0)));
  };
  TetMesh mesh;
  mesh.points.resize(3, Eigen::Index{points(0)} * points(1) * points(2));
  mesh.tetrahedra.resize(4, Eigen::Index{6} * cells(0) * cells(1) * cells(2));
  Eigen::Index column = 0;
  // i / n is exactly 1 at the far faces.
  for (int i = 0; i < points(0); ++i)
    for (int j = 0; j < points(1); ++j)
      for (int k = 0; k < points(2); ++k)
        mesh.points.col(column++) =
            size.cwiseProduct(Eigen::Vector3d(i, j, k).cwiseQuotient(cells.cast<double>()));
  column = 0;
  for (int i = 0; i < cells(0); ++i)
    for (int j = 0; j < cells(1); ++j)
      for (int k = 0; k < cells(2); ++k)
        for (std::size_t order = 0; order < orders.size(); ++order) {
          auto corners = walk({i, j, k}, orders[order]);
          if (order >= 3) std::swap(corners[1], corners[2]);
          for (int c = 0; c < 4; ++c)
            mesh.tetrahedra(c, column) = point(corners[static_cast<std::size_t>(c)]);
          ++column;
        }
  return mesh;
}

TetMesh beam_mesh(double length, double width, double height, int n) {
  require_resolution(24 * std::pow(n, 3), n);
  return box_mesh({length, width, height}, {4 * n, n, n});
}

TetMesh cube_mesh(double edge, int n) {
  require_size("edge", edge);
  return box_mesh({edge, edge, edge}, {n, n, n});
}

namespace {

/// A ball in the making: tetrahedra of the centre and a face of the icosahedron, each cut by a lattice of n +
/// 1 shells.
class BallMesher {
 public:
  BallMesher(double radius, int n) : radius_(radius), n_(n), corners_(icosahedron()) {
    const auto faces = icosahedron_faces(corners_);
    const auto shell_points = [](Eigen::Index k) { return 10 * k * k + 2; };
    Eigen::Index points = 1;
    for (int k = 1; k <= n; ++k) points += shell_points(k);
    mesh_.points.resize(3, points);
    mesh_.points.col(0).setZero();
    mesh_.tetrahedra.resize(4, static_cast<Eigen::Index>(faces.size()) * n * n * n);
    const auto size = static_cast<std::size_t>(n) + 1;
    lattice_.resize(size * size * size);
    for (const auto& face : faces) {
      add_points(face);
      add_tetrahedra();
    }
  }
  [[nodiscard]] TetMesh mesh() && { return std::move(mesh_); }

 private:
  /// The point at n >= s0 >= s1 >= s2 >= 0 with the weights n - s0, s0 - s1, s1 - s2, s2 of the centre and
  /// the face. The corners have one order in all tetrahedra, hence neighbours cut their common face alike.
  Index& at(const Eigen::Vector3i& s) {
    const auto size = static_cast<std::size_t>(n_) + 1;
    return lattice_[(static_cast<std::size_t>(s(0)) * size + static_cast<std::size_t>(s(1))) * size +
                    static_cast<std::size_t>(s(2))];
  }

  /// Fills the lattice of a face with points that are there already, and new ones.
  void add_points(const std::array<int, 3>& face) {
    for (int a = 0; a <= n_; ++a)
      for (int b = 0; b <= a; ++b)
        for (int c = 0; c <= b; ++c) {
          const std::array<int, 3> weights{a - b, b - c, c};
          std::array<std::array<int, 2>, 3> key{};
          for (std::size_t i = 0; i < 3; ++i)
            if (weights[i] > 0) key[i] = {face[i] + 1, weights[i]};
          std::ranges::sort(key);
          Index& point = at({a, b, c});
          if (a == 0) {
            point = 0;
            continue;
          }
          const auto [entry, fresh] = known_.try_emplace(key, next_);
          point = entry->second;
          if (!fresh) continue;
          ++next_;
          Eigen::Vector3d direction = Eigen::Vector3d::Zero();
          for (std::size_t i = 0; i < 3; ++i) direction += weights[i] * corners_.col(face[i]);
          mesh_.points.col(point) = radius_ * a / n_ * direction.normalized();
        }
  }

  /// Those between the points of the lattice.
  void add_tetrahedra() {
    for (int a = 0; a < n_; ++a)
      for (int b = 0; b <= a; ++b)
        for (int c = 0; c <= b; ++c)
          for (const auto& order : orders) {
            const auto way = walk({a, b, c}, order);
            const bool inside = std::ranges::all_of(
                way, [&](const Eigen::Vector3i& s) { return n_ >= s(0) && s(0) >= s(1) && s(1) >= s(2); });
            if (!inside) continue;
            for (int i = 0; i < 4; ++i) mesh_.tetrahedra(i, column_) = at(way[static_cast<std::size_t>(i)]);
            if (signed_volume(corners_of(mesh_, column_)) < 0)
              std::swap(mesh_.tetrahedra(1, column_), mesh_.tetrahedra(2, column_));
            ++column_;
          }
  }

  double radius_;
  int n_;
  Eigen::Matrix<double, 3, 12> corners_;
  TetMesh mesh_;
  // A point of shell k has whole weights at corners of the icosahedron that sum up to k: neighbouring
  // tetrahedra find it by them.
  std::map<std::array<std::array<int, 2>, 3>, Index> known_;
  Index next_ = 1;
  Eigen::Index column_ = 0;
  std::vector<Index> lattice_;
};

}  // namespace

TetMesh ball_mesh(double radius, int n) {
  require_size("radius", radius);
  require_resolution(20 * std::pow(n, 3), n);
  return BallMesher(radius, n).mesh();
}

}  // namespace hmax
