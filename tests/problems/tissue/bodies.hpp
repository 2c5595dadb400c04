/// Bodies of every model and with every load, and derivatives by differences, for the tests of tissue models.
#pragma once

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include "problems/mesh/mesh_generators.hpp"
#include "problems/mesh/refine.hpp"
#include "problems/mesh/topology.hpp"
#include "problems/tissue/body.hpp"

namespace hmax::tissue_tests {

/// A box of 3 x 2 x 2 cells whose points are moved at random: no two tetrahedra are equal. Two regions.
inline TetMesh uneven_box(double size = 0.1) {
  TetMesh mesh = box_mesh({1.5 * size, size, size}, {3, 2, 2});
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> by(-0.05 * size, 0.05 * size);
  for (double& x : mesh.points.reshaped()) x += by(random);
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) mesh.regions.push_back(t % 3 == 0 ? 1 : 0);
  return mesh;
}

/// A mesh with the elements that a model takes.
inline TetMesh mesh_for(const TissueModel& model, const TetMesh& mesh) {
  return model.has_ten_nodes ? ten_node_mesh(mesh) : mesh;
}

/// The middles of the edges moved at random: no side is straight.
inline void bend_sides(TetMesh& mesh, double by) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> to(-by, by);
  const TetMesh::Index corners = mesh.ten_node.topRows<4>().maxCoeff() + 1;
  for (double& x : mesh.points.rightCols(mesh.point_count() - corners).reshaped()) x += to(random);
}

/// uneven_box() for a model; elements of ten nodes have curved sides.
inline TetMesh uneven_box_for(const TissueModel& model) {
  TetMesh mesh = mesh_for(model, uneven_box());
  if (model.has_ten_nodes) bend_sides(mesh, 0.002);
  return mesh;
}

inline std::vector<TissueMaterial> two_materials() { return {{5300, 0.45, 1060}, {9000, 0.3, 1000}}; }

/// Entries uniform in (-size, size).
inline Eigen::VectorXd random_vector(Eigen::Index n, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> by(-size, size);
  return Eigen::VectorXd::NullaryExpr(n, [&] { return by(random); });
}

struct NamedSettings {
  std::string name;
  TissueSettings settings;
};

/// Every elastic part once, free of supports.
inline std::vector<NamedSettings> elastic_settings() {
  std::vector<NamedSettings> all;
  const auto add = [&](std::string name, const auto& change) {
    TissueSettings settings;
    settings.materials = two_materials();
    change(settings);
    all.push_back({std::move(name), std::move(settings)});
  };
  for (const TissueModel& model : tissue_models())
    add(std::string(model.id), [&](TissueSettings& s) { s.model = model; });
  for (const TissueModel& model : tissue_models())
    if (!model.is_of_springs())
      add("fibres in " + std::string(model.id), [&](TissueSettings& s) {
        s.model = model;
        s.materials[0].fibre_young = 2e4;
        s.materials[0].fibre_x = 1;
        s.materials[0].fibre_y = -2;
        s.materials[1].fibre_young = 6e3;
        s.materials[1].fibre_z = 0.5;
      });
  const auto springs = [&](std::string name, SpringLaw law) {
    add(std::move(name), [&](TissueSettings& s) {
      s.model = tissue_model("mass_spring");
      s.springs.law = law;
    });
  };
  springs("cubic springs", CubicSpring{4});
  springs("exponential springs", ExponentialSpring{3});
  springs("springs of a table", TableSpring({-0.2, -0.05, 0.06, 0.3}, {-0.15, -0.05, 0.06, 0.5}));
  add("all sets of springs", [](TissueSettings& s) {
    s.model = tissue_model("mass_spring");
    s.springs.stiffness = 120;
    s.springs.surface_bending = 0.3;
    s.springs.second_ring = 0.2;
    s.springs.doubled_skin = 5;
  });
  for (const auto kind : {SkinSettings::Kind::membrane, SkinSettings::Kind::springs})
    add(kind == SkinSettings::Kind::membrane ? "skin of triangles" : "skin of springs",
        [&](TissueSettings& s) {
          s.skin.kind = kind;
          s.skin.young = 5e6;
        });
  return all;
}

/// The same on uneven_box_for() with supports that move, gravity, loads, a tool in contact and every damping.
inline std::vector<NamedSettings> loaded_settings() {
  std::vector<NamedSettings> all = elastic_settings();
  for (NamedSettings& named : all) {
    TissueSettings& s = named.settings;
    s.alpha = 3;
    s.beta = 0.02;
    s.gravity = {0, 0, -9.81};
    s.springs.damper = 0.3;
    s.springs.damper_time = 0.002;
    s.supports = {{points_in_box(uneven_box_for(s.model), {-1, -1, -1}, {0.01, 1, 1}),
                   {0.002, 0, 0.001},
                   {TimeProfile::Kind::ramp, 0, 2}}};
    s.elastic_supports = {{{9, 20, 35}, {40, 300, 20}}, {{20, 2}, {10, 50}}};
    s.forces = {{{30, 31, 32}, {0.1, -0.2, 0.05}, {1, 2, 1}, {TimeProfile::Kind::sine, 0.1, 1, 3}}};
    SphereTool tool;
    tool.radius = 0.05;
    tool.start = {0.16, 0.05, 0.12};
    tool.travel = {0, 0, -0.01};
    tool.profile = {TimeProfile::Kind::ramp, 0, 2};
    tool.stiffness = 1e7;
    tool.damping = 0.7;
    s.tools = {tool};
  }
  return all;
}

/// Column j of the derivative of `call` at x by central differences with the step d.
template <class Call>
Eigen::VectorXd difference(const Call& call, Eigen::VectorXd x, Eigen::Index j, double d) {
  const double middle = x[j];
  x[j] = middle + d;
  const Eigen::VectorXd plus = call(x);
  x[j] = middle - d;
  return (plus - call(x)) / (2 * d);
}

inline Eigen::VectorXd force(const TissueBody& body, double t, const Eigen::VectorXd& q,
                             const Eigen::VectorXd& v) {
  Eigen::VectorXd f(body.dofs());
  body.force(t, q, v, f);
  return f;
}
inline Eigen::MatrixXd stiffness(const TissueBody& body, double t, const Eigen::VectorXd& q,
                                 const Eigen::VectorXd& v) {
  Eigen::SparseMatrix<double> K;
  body.stiffness(t, q, v, K);
  return K;
}
inline Eigen::MatrixXd damping(const TissueBody& body, double t, const Eigen::VectorXd& q,
                               const Eigen::VectorXd& v) {
  Eigen::SparseMatrix<double> C;
  body.damping(t, q, v, C);
  return C;
}

/// A quarter of each triangle at x = length would weigh its corners by their area: what a constant traction
/// does.
inline std::vector<double> area_shares(const TetMesh& mesh, const std::vector<TetMesh::Index>& points) {
  std::vector<double> shares(points.size(), 0);
  const auto place = [&](TetMesh::Index i) {
    return std::find(points.begin(), points.end(), i) - points.begin();
  };
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  const MeshSurface surface = surface_of(mesh);
  for (const auto& triangle : surface.triangles.colwise()) {
    const std::array at{place(triangle[0]), place(triangle[1]), place(triangle[2])};
    if (std::find(at.begin(), at.end(), count) != at.end()) continue;
    const Eigen::Vector3d u = mesh.points.col(triangle[1]) - mesh.points.col(triangle[0]),
                          w = mesh.points.col(triangle[2]) - mesh.points.col(triangle[0]);
    for (const auto corner : at) shares[static_cast<std::size_t>(corner)] += u.cross(w).norm() / 6;
  }
  return shares;
}

/// The displacement at which all forces balance, by Newton's method from rest.
inline Eigen::VectorXd equilibrium(const TissueBody& body) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(body.dofs()), f(body.dofs());
  const Eigen::VectorXd still = q;
  Eigen::SparseMatrix<double> K;
  for (int i = 0; i < 30; ++i) {
    body.force(0, q, still, f);
    body.stiffness(0, q, still, K);
    const Eigen::VectorXd change = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(K).solve(f);
    q += change;
    if (change.norm() <= 1e-12 * (1e-3 + q.norm())) break;
  }
  return q;
}

}  // namespace hmax::tissue_tests
