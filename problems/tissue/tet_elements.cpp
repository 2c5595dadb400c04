#include "problems/tissue/tet_elements.hpp"

#include <Eigen/Dense>

namespace hmax {
namespace {

template <class Points>
Eigen::Matrix3d edges(const NodeRows& x, const Points& points) {
  Eigen::Matrix3d Ds;
  for (std::size_t a = 1; a < 4; ++a)
    Ds.col(static_cast<Eigen::Index>(a) - 1) =
        as_vector(x[static_cast<std::size_t>(points[a])]) - as_vector(x[static_cast<std::size_t>(points[0])]);
  return Ds;
}

}  // namespace

template <class Law>
TetElements<Law>::TetElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern) {
  elements_.reserve(static_cast<std::size_t>(mesh.tetrahedron_count()));
  slots_.reserve(elements_.capacity());
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    Element e;
    for (Eigen::Index a = 0; a < 4; ++a) e.points[static_cast<std::size_t>(a)] = mesh.tetrahedra(a, t);
    Eigen::Matrix3d rest;
    for (Eigen::Index a = 1; a < 4; ++a)
      rest.col(a - 1) = mesh.points.col(mesh.tetrahedra(a, t)) - mesh.points.col(mesh.tetrahedra(0, t));
    e.gradients = rest.inverse();
    e.volume = rest.determinant() / 6;
    e.lame = lame[static_cast<std::size_t>(mesh.region(t))];
    elements_.push_back(e);
    slots_.push_back(pattern.slots(e.points));
  }
}

template <class Law>
Law TetElements<Law>::law(const NodeRows& x, const Element& e) {
  return Law(edges(x, e.points) * e.gradients, e.lame);
}

template <class Law>
double TetElements<Law>::energy(const NodeRows& x) const {
  double sum = 0;
  for (const Element& e : elements_) sum += e.volume * law(x, e).energy();
  return sum;
}

template <class Law>
double TetElements<Law>::energy_density(const NodeRows& x, std::size_t element) const {
  return law(x, elements_[element]).energy();
}

template <class Law>
void TetElements<Law>::add_force(const NodeRows& x, NodeRows& f) const {
  for (const Element& e : elements_) {
    const Eigen::Matrix3d pull = e.volume * law(x, e).stress() * e.gradients.transpose();
    for (std::size_t a = 1; a < 4; ++a)
      as_vector(f[static_cast<std::size_t>(e.points[a])]) -= pull.col(static_cast<Eigen::Index>(a) - 1);
    as_vector(f[static_cast<std::size_t>(e.points[0])]) += pull.rowwise().sum();
  }
}

template <class Law>
typename TetElements<Law>::Stiffness TetElements<Law>::stiffness(const NodeRows& x,
                                                                 std::size_t element) const {
  const Element& e = elements_[element];
  const Law at = law(x, e);
  Stiffness K;
  for (Eigen::Index b = 1; b < 4; ++b)
    for (Eigen::Index c = 0; c < 3; ++c) {
      // Point b moves along axis c: dF = e_c g_b^T.
      Eigen::Matrix3d dF = Eigen::Matrix3d::Zero();
      dF.row(c) = e.gradients.row(b - 1);
      const Eigen::Matrix3d pull = e.volume * at.differential(dF) * e.gradients.transpose();
      auto column = K.col(3 * b + c);
      column.template head<3>() = -pull.rowwise().sum();
      for (Eigen::Index a = 1; a < 4; ++a) column.template segment<3>(3 * a) = pull.col(a - 1);
    }
  for (Eigen::Index c = 0; c < 3; ++c) K.col(c) = -(K.col(3 + c) + K.col(6 + c) + K.col(9 + c));
  return K;
}

template <class Law>
void TetElements<Law>::add_stiffness(const NodeRows& x, const BlockPattern& pattern, double* values) const {
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Stiffness K = stiffness(x, t);
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
