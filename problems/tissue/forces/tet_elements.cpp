#include "problems/tissue/forces/tet_elements.hpp"

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

Eigen::Matrix3d edge_vectors(const NodeRows& u, const std::array<TetMesh::Index, 4>& points) {
  Eigen::Matrix3d Ds;
  for (std::size_t a = 1; a < 4; ++a)
    Ds.col(static_cast<Eigen::Index>(a) - 1) =
        as_vector(u[static_cast<std::size_t>(points[a])]) - as_vector(u[static_cast<std::size_t>(points[0])]);
  return Ds;
}

template <class Law>
TetElements<Law>::TetElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern) {
  elements_.reserve(static_cast<std::size_t>(mesh.tetrahedron_count()));
  slots_.reserve(elements_.capacity());
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    std::array<Index, 4> points;
    for (Eigen::Index a = 0; a < 4; ++a) points[static_cast<std::size_t>(a)] = mesh.tetrahedra(a, t);
    elements_.push_back({points, RestShape(mesh, points), lame[static_cast<std::size_t>(mesh.region(t))]});
    slots_.push_back(pattern.slots(points));
  }
}

template <class Law>
Law TetElements<Law>::law(const NodeRows& u, const Element& e) {
  return Law(edge_vectors(u, e.points) * e.rest.gradients, e.lame);
}

template <class Law>
double TetElements<Law>::energy(const NodeRows& u) const {
  double sum = 0;
  for (const Element& e : elements_) sum += e.rest.volume * law(u, e).energy();
  return sum;
}

template <class Law>
double TetElements<Law>::energy_density(const NodeRows& u, std::size_t element) const {
  return law(u, elements_[element]).energy();
}

template <class Law>
void TetElements<Law>::add_force(const NodeRows& u, NodeRows& f) const {
  for (const Element& e : elements_) {
    const Eigen::Matrix3d pull = e.rest.volume * law(u, e).stress() * e.rest.gradients.transpose();
    for (std::size_t a = 1; a < 4; ++a)
      as_vector(f[static_cast<std::size_t>(e.points[a])]) -= pull.col(static_cast<Eigen::Index>(a) - 1);
    as_vector(f[static_cast<std::size_t>(e.points[0])]) += pull.rowwise().sum();
  }
}

template <class Law>
typename TetElements<Law>::Stiffness TetElements<Law>::stiffness(const NodeRows& u,
                                                                 std::size_t element) const {
  const Element& e = elements_[element];
  const Law at = law(u, e);
  Stiffness K;
  for (Eigen::Index b = 1; b < 4; ++b)
    for (Eigen::Index c = 0; c < 3; ++c) {
      // Point b moves along axis c: dF = e_c g_b^T.
      Eigen::Matrix3d dF = Eigen::Matrix3d::Zero();
      dF.row(c) = e.rest.gradients.row(b - 1);
      const Eigen::Matrix3d pull = e.rest.volume * at.differential(dF) * e.rest.gradients.transpose();
      auto column = K.col(3 * b + c);
      column.template head<3>() = -pull.rowwise().sum();
      for (Eigen::Index a = 1; a < 4; ++a) column.template segment<3>(3 * a) = pull.col(a - 1);
    }
  for (Eigen::Index c = 0; c < 3; ++c) K.col(c) = -(K.col(3 + c) + K.col(6 + c) + K.col(9 + c));
  return K;
}

template <class Law>
void TetElements<Law>::add_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Stiffness K = stiffness(u, t);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = 0; b < 4; ++b)
        pattern.add(
            values, slots_[t][4 * a + b], elements_[t].points[b],
            K.template block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b)));
  }
}

template class TetElements<SmallStrain>;
template class TetElements<GreenStrain>;
template class TetElements<Corotational>;
template class TetElements<StableNeoHookean>;

}  // namespace hmax
