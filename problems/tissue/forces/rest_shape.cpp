#include "problems/tissue/forces/rest_shape.hpp"

#include <Eigen/Dense>

namespace hmax {

RestShape::RestShape(const TetMesh& mesh, const std::array<TetMesh::Index, 4>& points) {
  Eigen::Matrix<long double, 3, 3> Dm;
  for (std::size_t a = 1; a < 4; ++a)
    Dm.col(static_cast<Eigen::Index>(a) - 1) =
        mesh.points.col(points[a]).cast<long double>() - mesh.points.col(points[0]).cast<long double>();
  gradients = Dm.inverse().cast<double>();
  volume = static_cast<double>(Dm.determinant() / 6);
}

}  // namespace hmax
