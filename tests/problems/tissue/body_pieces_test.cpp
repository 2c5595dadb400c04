/// Rows of a body that are made in pieces.
#include "problems/tissue/body_pieces.hpp"

#include <gtest/gtest.h>

#include "problems/mesh/renumber.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Matrices of a body as one or as many pieces have them.
struct Whole {
  MatrixXd K, C;
  VectorXd mass;
};

/// Those of a TissueBody, with its points in the order of the pieces.
Whole of_body(const TetMesh& mesh, TissueSettings settings) {
  settings.alpha = settings.beta = 0;
  const TissueBody body(mesh, settings);
  std::vector<TetMesh::Index> place(static_cast<std::size_t>(mesh.point_count()), -1);
  for (std::size_t i = 0; i < body.free_points().size(); ++i)
    place[static_cast<std::size_t>(body.free_points()[i])] = static_cast<TetMesh::Index>(i);
  std::vector<Eigen::Index> order;
  for (const TetMesh::Index point : local_order(mesh).points)
    if (const TetMesh::Index at = place[static_cast<std::size_t>(point)]; at >= 0)
      for (int axis = 0; axis < 3; ++axis) order.push_back(3 * at + axis);
  const VectorXd still = VectorXd::Zero(body.dofs());
  TissueBody::DofMatrix K, C;
  body.stiffness(0, still, still, K);
  body.damping(0, still, still, C);
  return {MatrixXd(K)(order, order), MatrixXd(C)(order, order), body.mass()(order)};
}

/// Those of pieces of at most `most` points.
Whole of_pieces(const BodyPieces& body, TetMesh::Index most) {
  Whole whole{MatrixXd(body.dofs(), body.dofs()), MatrixXd::Zero(body.dofs(), body.dofs()),
              VectorXd(body.dofs())};
  for (TetMesh::Index begin = 0; begin < body.free_points(); begin += most) {
    const TetMesh::Index end = std::min(begin + most, body.free_points());
    const BodyPieces::Piece piece = body.piece(begin, end);
    whole.K.middleRows(3 * begin, 3 * (end - begin)) = MatrixXd(piece.stiffness);
    if (body.has_dampers()) whole.C.middleRows(3 * begin, 3 * (end - begin)) = MatrixXd(piece.damping);
    whole.mass.segment(3 * begin, 3 * (end - begin)) = piece.mass;
  }
  return whole;
}

void expect_equal(const Whole& one, const Whole& other, const std::string& name) {
  EXPECT_LE((one.K - other.K).norm(), 1e-13 * one.K.norm()) << name;
  EXPECT_LE((one.C - other.C).norm(), 1e-13 * one.C.norm()) << name;
  EXPECT_LE((one.mass - other.mass).norm(), 1e-13 * one.mass.norm()) << name;
}

bool is_relative(const TissueSettings& settings) {
  return settings.springs.surface_bending > 0 || settings.springs.second_ring > 0;
}

TEST(BodyPieces, MakeTheMatricesOfEveryModel) {
  for (auto& [name, settings] : tissue_tests::elastic_settings()) {
    if (is_relative(settings)) continue;
    const TetMesh mesh = tissue_tests::uneven_box_for(settings.model);
    settings.supports.push_back({.points = {0, 5, 7}});
    settings.elastic_supports = {{.points = {5, 20, 3}, .stiffness = {9, 300, 40}}};
    settings.springs.damper_time = 0.01;
    const BodyPieces pieces(mesh, settings);
    for (const TetMesh::Index most : {1, 4, 1000})
      expect_equal(of_body(mesh, settings), of_pieces(pieces, most), name);
  }
}

TEST(BodyPieces, HaveTheMassesOfTheWhole) {
  const TetMesh mesh = tissue_tests::uneven_box();
  TissueSettings settings;
  settings.materials = tissue_tests::two_materials();
  settings.total_mass = 1.5;
  expect_equal(of_body(mesh, settings), of_pieces(BodyPieces(mesh, settings), 5), "a mass");
  settings.equal_masses = true;
  expect_equal(of_body(mesh, settings), of_pieces(BodyPieces(mesh, settings), 5), "equal parts of a mass");
  settings.total_mass.reset();
  expect_equal(of_body(mesh, settings), of_pieces(BodyPieces(mesh, settings), 5), "equal masses");
  settings.equal_masses = false;
  settings.mass_step = 0.01;
  expect_equal(of_body(mesh, settings), of_pieces(BodyPieces(mesh, settings), 5), "raised masses");
}

TEST(BodyPieces, CountTheNeighboursOfTheirPoints) {
  const TetMesh::Index begin = 3, end = 11;
  for (const char* model : {"fem_green", "fem_nodal_pressure", "fem_quadratic"}) {
    TissueSettings settings{.model = tissue_model(model)};
    settings.supports.push_back({.points = {0, 5, 7}});
    const BodyPieces body(tissue_tests::uneven_box_for(settings.model), settings);
    const BodyPieces::Neighbours counts = body.neighbours(begin, end);
    const BodyPieces::Rows rows = body.piece(begin, end).stiffness;
    for (TetMesh::Index point = begin; point < end; ++point) {
      int inside = 0, outside = 0;
      for (BodyPieces::Rows::InnerIterator entry(rows, 3 * (point - begin)); entry; ++entry)
        ++(entry.col() >= 3 * begin && entry.col() < 3 * end ? inside : outside);
      EXPECT_EQ(3 * counts.inside.at(static_cast<std::size_t>(point - begin)), inside);
      EXPECT_EQ(3 * counts.outside.at(static_cast<std::size_t>(point - begin)), outside) << model;
    }
  }
}

TEST(BodyPieces, KnowRayleighDampingByItsNumbers) {
  TissueSettings settings;
  settings.alpha = 2;
  settings.beta = 0.01;
  const BodyPieces body(tissue_tests::uneven_box(), settings);
  EXPECT_EQ(body.alpha(), 2);
  EXPECT_EQ(body.beta(), 0.01);
  EXPECT_FALSE(body.has_dampers());
}

TEST(BodyPieces, RefuseWhatNoPieceKnows) {
  const TetMesh mesh = tissue_tests::uneven_box();
  TissueSettings settings;
  settings.model = tissue_model("mass_spring");
  settings.springs.second_ring = 0.5;
  EXPECT_THROW(BodyPieces(mesh, settings), std::invalid_argument);
  settings.springs.second_ring = 0;
  settings.supports.push_back({.points = {1000}});
  EXPECT_THROW(BodyPieces(mesh, settings), std::invalid_argument);
  settings.supports.front().points.clear();
  for (TetMesh::Index point = 0; point < mesh.point_count(); ++point)
    settings.supports.front().points.push_back(point);
  EXPECT_THROW(BodyPieces(mesh, settings), std::invalid_argument);
}

}  // namespace
}  // namespace hmax
