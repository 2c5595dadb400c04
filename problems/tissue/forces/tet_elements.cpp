#include "problems/tissue/forces/tet_elements.hpp"

#include "problems/tissue/forces/kernels/element_stiffness.hpp"
#include "problems/tissue/forces/kernels/one_element.hpp"

namespace hmax {

Eigen::Matrix3d edge_vectors(const NodeRows& u, const std::array<TetMesh::Index, 4>& points) {
  Eigen::Matrix3d Ds;
  for (std::size_t a = 1; a < 4; ++a)
    Ds.col(static_cast<Eigen::Index>(a) - 1) =
        as_vector(u[static_cast<std::size_t>(points[a])]) - as_vector(u[static_cast<std::size_t>(points[0])]);
  return Ds;
}

namespace {

/// @param make_parts, block_of  of a law in element_stiffness.hpp
template <class Parts, class MakeParts, class BlockOf>
ElementStiffness stiffness_of(const NodeRows& u, const std::array<TetMesh::Index, 4>& points,
                              const RestShape& rest, const Lame& lame, const MakeParts& make_parts,
                              const BlockOf& block_of) {
  double U[3][3];
  edge_vectors(u, points, U);
  Parts parts;
  rest.write_rows(parts.g + 1);
  make_parts(U, rest.volume * lame.lambda / 2, rest.volume * lame.mu, parts);
  return symmetric_stiffness<4>([&](int a, int b, double(*block)[3]) { block_of(parts, a, b, block); });
}

}  // namespace

ElementStiffness kernel_stiffness(TetLaw law, const NodeRows& u, const std::array<TetMesh::Index, 4>& points,
                                  const RestShape& rest, const Lame& lame) {
  using Lanes = OneElement<double>;
  using namespace kernel_loops;
  // Lambdas, since functions behind pointers are not compiled into the loops.
  if (law == TetLaw::corotational)
    return stiffness_of<CorotationalParts<Lanes>>(u, points, rest, lame,
                                                  corotational_parts<Lanes, double, double>,
                                                  [](const auto& parts, int a, int b, double(*block)[3]) {
                                                    corotational_stiffness(parts, a, b, block);
                                                  });
  return stiffness_of<NeoHookeanParts<Lanes>>(
      u, points, rest, lame, neo_hookean_parts<Lanes, double>,
      [](const auto& parts, int a, int b, double(*block)[3]) { neo_hookean_stiffness(parts, a, b, block); });
}

void subtract_pull(const RestShape& rest, const std::array<TetMesh::Index, 4>& points,
                   const Eigen::Matrix3d& stress, NodeRows& f) {
  const Eigen::Matrix3d pull = rest.volume * stress * rest.gradients.transpose();
  for (std::size_t a = 1; a < 4; ++a)
    as_vector(f[static_cast<std::size_t>(points[a])]) -= pull.col(static_cast<Eigen::Index>(a) - 1);
  as_vector(f[static_cast<std::size_t>(points[0])]) += pull.rowwise().sum();
}

}  // namespace hmax
