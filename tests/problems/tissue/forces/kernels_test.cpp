#include "problems/tissue/forces/kernels/kernels.hpp"

#include <tuple>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "problems/mesh/mesh_generators.hpp"
#include "problems/mesh/renumber.hpp"
#include "problems/tissue/forces/green_elements.hpp"
#include "problems/tissue/forces/point_strips.hpp"
#include "problems/tissue/forces/springs.hpp"
#include "problems/tissue/forces/tet_blocks.hpp"
#include "problems/tissue/forces/tet_elements.hpp"
#include "tests/core/jobs.hpp"
#include "tests/problems/tissue/bodies.hpp"

namespace hmax {
namespace {

/// The first tetrahedra of an uneven box, deformed, with every fifth point supported.
struct Parts {
  explicit Parts(Eigen::Index tetrahedra = 72) : Parts(tissue_tests::uneven_box(), tetrahedra) {}
  Parts(TetMesh whole, Eigen::Index tetrahedra) : mesh(std::move(whole)) {
    mesh.tetrahedra = mesh.tetrahedra.leftCols(tetrahedra).eval();
    if (!mesh.regions.empty()) mesh.regions.resize(static_cast<std::size_t>(tetrahedra));
    std::vector<TetMesh::Index> free;
    for (TetMesh::Index i = 0, next = 0; i < mesh.point_count(); ++i)
      free.push_back(i % 5 == 2 ? -1 : next++);
    pattern = BlockPattern(free, edges_of(mesh));
    x.resize(static_cast<std::size_t>(mesh.point_count()));
    u.resize(x.size());
    const Eigen::VectorXd by = tissue_tests::random_vector(mesh.points.size(), 0.01, 5);
    for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
      as_vector(u[static_cast<std::size_t>(i)]) = by.segment<3>(3 * i);
      as_vector(x[static_cast<std::size_t>(i)]) = mesh.points.col(i) + by.segment<3>(3 * i);
    }
  }
  TetMesh mesh;
  BlockPattern pattern;
  NodeRows u, x;  // displacements, positions
  std::vector<Lame> materials{lame(5300, 0.45), lame(9000, 0.3)};

  template <class Elements>
  [[nodiscard]] NodeRows forces(const Elements& elements) const {
    NodeRows f(x.size());
    elements.add_force(std::is_same_v<Elements, SpringSet> ? x : u, f);
    return f;
  }
  [[nodiscard]] Eigen::VectorXd stiffness(const Elements& elements) const {
    Eigen::VectorXd values(pattern.entries());
    elements.write_stiffness(u, pattern, values.data());
    return values;
  }
};

/// The same mesh, in whose numbers neighbours are far apart. @param mesh  a number of points that 7 does not
/// divide
TetMesh with_mixed_points(const TetMesh& mesh) {
  const auto points = static_cast<TetMesh::Index>(mesh.point_count()),
             tetrahedra = static_cast<TetMesh::Index>(mesh.tetrahedron_count());
  Renumbering mixed;
  for (TetMesh::Index i = 0; i < points; ++i) mixed.points.push_back(i * 7 % points);
  for (TetMesh::Index i = 0; i < tetrahedra; ++i) mixed.tetrahedra.push_back(i);
  return renumbered(mesh, mixed);
}

/// What springs of a law add to each point, one after the other. @param law  the pull over the stiffness
template <class Law>
NodeRows plain_forces(const Parts& parts, const std::vector<SpringSet::Spring>& springs, const Law& law) {
  NodeRows plain(parts.x.size());
  for (const auto& spring : springs) {
    const auto a = static_cast<std::size_t>(spring.points[0]), z = static_cast<std::size_t>(spring.points[1]);
    const Eigen::Vector3d d = as_vector(parts.x[z]) - as_vector(parts.x[a]);
    const double L =
        (parts.mesh.points.col(spring.points[1]) - parts.mesh.points.col(spring.points[0])).norm();
    const Eigen::Vector3d pull = spring.stiffness * L * law.phi((d.norm() - L) / L) * d.normalized();
    as_vector(plain[a]) += pull;
    as_vector(plain[z]) -= pull;
  }
  return plain;
}

double distance(const NodeRows& a, const NodeRows& b) {
  double largest = 0, scale = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, (as_vector(a[i]) - as_vector(b[i])).norm());
    scale = std::max(scale, as_vector(b[i]).norm());
  }
  return largest / scale;
}

bool same_bits(const NodeRows& a, const NodeRows& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (as_vector(a[i]) != as_vector(b[i])) return false;
  return true;
}

TEST(TissueKernels, GreenForcesAgreeWithThePlainElementsForEveryNumberOfTetrahedra) {
  for (const Eigen::Index count : {1, 2, 7, 8, 9, 16, 17, 65, 72}) {
    const Parts parts(count);
    const auto plain = parts.forces(TetElements<GreenStrain>(parts.mesh, parts.materials, parts.pattern));
    for (const TissueKernels* kernels : available_tissue_kernels()) {
      const GreenElements fast(parts.mesh, parts.materials, parts.pattern, *kernels);
      EXPECT_LT(distance(parts.forces(fast), plain), 1e-13) << kernels->name << ", " << count;
    }
  }
}

/// A law without its kernel.
template <class Law>
struct Plain {
  Plain(const Eigen::Matrix3d& H, const Lame& lame) : law(H, lame) {}
  [[nodiscard]] double energy() const { return law.energy(); }
  [[nodiscard]] Eigen::Matrix3d stress() const { return law.stress(); }
  [[nodiscard]] Eigen::Matrix3d differential(const Eigen::Matrix3d& dF) const { return law.differential(dF); }
  Law law;
};

template <class Law>
void expect_those_of_plain_elements(const Parts& parts) {
  const TetElements<Plain<Law>> elements(parts.mesh, parts.materials, parts.pattern);
  const TetElements<Law> own(parts.mesh, parts.materials, parts.pattern);
  const auto plain = parts.forces(elements);
  EXPECT_LT(distance(parts.forces(own), plain), 1e-13);
  const Eigen::VectorXd K = parts.stiffness(elements);
  EXPECT_LT((parts.stiffness(own) - K).norm(), 1e-13 * K.norm());
  const auto first = parts.forces(TetBlocks(parts.mesh, parts.materials, Law::kernel));
  for (const TissueKernels* kernels : available_tissue_kernels()) {
    const TetBlocks blocks(parts.mesh, parts.materials, Law::kernel, *kernels);
    EXPECT_LT(distance(parts.forces(blocks), plain), 1e-13) << kernels->name;
    EXPECT_TRUE(same_bits(parts.forces(blocks), first)) << kernels->name;
  }
}

TEST(TissueKernels, OtherLawsAgreeWithThePlainElementsWithTheSameBits) {
  for (const Eigen::Index count : {1, 9, 72}) {
    Parts parts(count);
    expect_those_of_plain_elements<SmallStrain>(parts);
    expect_those_of_plain_elements<StableNeoHookean>(parts);
    expect_those_of_plain_elements<Corotational>(parts);
    for (NodeRow& u : parts.u) as_vector(u) *= 20;  // elements invert
    expect_those_of_plain_elements<StableNeoHookean>(parts);
    expect_those_of_plain_elements<Corotational>(parts);
  }
}

TEST(TissueKernels, GreenEnergiesAgreeWithThePlainElements) {
  const Parts parts;
  const TetElements<GreenStrain> plain(parts.mesh, parts.materials, parts.pattern);
  const GreenElements fast(parts.mesh, parts.materials, parts.pattern);
  EXPECT_NEAR(fast.energy(parts.u) / plain.energy(parts.u), 1, 1e-13);
  Eigen::VectorXd W_fast(parts.mesh.tetrahedron_count()), W_plain = W_fast;
  fast.write_energy_densities(parts.u, W_fast);
  plain.write_energy_densities(parts.u, W_plain);
  for (Eigen::Index i = 0; i < W_fast.size(); ++i) EXPECT_NEAR(W_fast[i] / W_plain[i], 1, 1e-11);
}

TEST(TissueKernels, GreenStiffnessAgreesWithThePlainElementsForEveryNumberOfTetrahedra) {
  for (const Eigen::Index count : {1, 2, 7, 8, 9, 17, 72}) {
    const Parts parts(count);
    const TetElements<GreenStrain> plain(parts.mesh, parts.materials, parts.pattern);
    Eigen::SparseMatrix<double> expected, K;
    parts.pattern.clear(expected);
    plain.add_stiffness(parts.u, parts.pattern, expected.valuePtr());
    for (const TissueKernels* kernels : available_tissue_kernels()) {
      const GreenElements fast(parts.mesh, parts.materials, parts.pattern, *kernels);
      parts.pattern.shape(K);
      fast.write_stiffness(parts.u, parts.pattern, K.valuePtr());
      EXPECT_LT(Eigen::MatrixXd(K - expected).cwiseAbs().maxCoeff(),
                1e-13 * Eigen::MatrixXd(expected).cwiseAbs().maxCoeff())
          << kernels->name << ", " << count;
      EXPECT_EQ(Eigen::MatrixXd(K), Eigen::MatrixXd(K).transpose()) << "symmetric to the last bit";
    }
  }
}

TEST(TissueKernels, GreenStiffnessAgreesWhereItIsWrittenColumnsAfterColumns) {
  // A long box, in which sums are finished soon, and one whose points are numbered at random.
  TetMesh box = box_mesh({0.1, 0.1, 0.1}, {40, 4, 4});
  for (const TetMesh& mesh : {renumbered(box, local_order(box)), with_mixed_points(box)}) {
    const Parts parts(mesh, mesh.tetrahedron_count());
    Eigen::SparseMatrix<double> expected, K;
    parts.pattern.clear(expected);
    TetElements<GreenStrain>(parts.mesh, parts.materials, parts.pattern)
        .add_stiffness(parts.u, parts.pattern, expected.valuePtr());
    const GreenElements fast(parts.mesh, parts.materials, parts.pattern);
    parts.pattern.shape(K);
    for (int repetition = 0; repetition < 2; ++repetition) {
      K.coeffs().setConstant(7);
      fast.write_stiffness(parts.u, parts.pattern, K.valuePtr());
      EXPECT_LT((K - expected).norm(), 1e-13 * expected.norm());
      EXPECT_EQ(Eigen::SparseMatrix<double>(K.transpose()).coeffs().matrix(), K.coeffs().matrix());
    }
  }
}

TEST(TissueKernels, SpringForcesAgreeWithThePlainLaws) {
  const Parts parts;
  const MeshEdges edges = edges_of(parts.mesh);
  for (const double b : {0.0, 7.5}) {
    std::vector<SpringSet::Spring> springs;
    for (Eigen::Index e = 0; e < edges.cols(); ++e)
      springs.push_back({{edges(0, e), edges(1, e)}, 10 + static_cast<double>(e)});
    const CubicSpring law{b};
    const NodeRows plain = plain_forces(parts, springs, law);
    for (const TissueKernels* kernels : available_tissue_kernels()) {
      const SpringSet set(parts.mesh.points, springs, b == 0 ? SpringLaw(LinearSpring{}) : SpringLaw(law),
                          parts.pattern, *kernels);
      EXPECT_LT(distance(parts.forces(set), plain), 1e-13) << kernels->name;
    }
  }
}

TEST(TissueKernels, EveryInstructionSetGivesForcesAndStiffnessOfTheSameBits) {
  const Parts parts;
  const MeshEdges edges = edges_of(parts.mesh);
  std::vector<SpringSet::Spring> springs;
  for (const auto& edge : edges.colwise()) springs.push_back({{edge[0], edge[1]}, 100});
  const auto all = available_tissue_kernels();
  const TissueKernels& first = *all.front();
  const auto with = [&](const TissueKernels& kernels) {
    return GreenElements(parts.mesh, parts.materials, parts.pattern, kernels);
  };
  const auto stiffness = [&](const TissueKernels& kernels) {
    Eigen::SparseMatrix<double> K;
    parts.pattern.shape(K);
    with(kernels).write_stiffness(parts.u, parts.pattern, K.valuePtr());
    return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(K.valuePtr(), K.nonZeros()));
  };
  for (const TissueKernels* kernels : all) {
    EXPECT_TRUE(same_bits(parts.forces(with(*kernels)), parts.forces(with(first)))) << kernels->name;
    EXPECT_EQ(stiffness(*kernels), stiffness(first)) << kernels->name;
    const SpringSet here(parts.mesh.points, springs, CubicSpring{2}, parts.pattern, *kernels);
    const SpringSet there(parts.mesh.points, springs, CubicSpring{2}, parts.pattern, first);
    EXPECT_TRUE(same_bits(parts.forces(here), parts.forces(there))) << kernels->name;
  }
}

TEST(TissueKernels, EverySpringActsOnceWhateverTheNumbersOfSpringsAtItsPoints) {
  // Points at which none, one or many springs begin, some of them more than once, for every instruction set.
  const Parts parts;
  const auto points = static_cast<TetMesh::Index>(parts.x.size());
  for (const TetMesh::Index count : {1, 5, 8, 9, 40, 300}) {
    std::vector<SpringSet::Spring> springs;
    for (TetMesh::Index i = 0; i < count; ++i)
      springs.push_back({{(i * i) % 11, 11 + (7 * i) % (points - 11)}, 10.0 + static_cast<double>(i)});
    const NodeRows plain = plain_forces(parts, springs, LinearSpring{});
    // The pattern has no such pairs, and none is needed: points that are supported are in no pair.
    const BlockPattern none(std::vector<TetMesh::Index>(parts.x.size(), -1), MeshEdges(2, 0));
    for (const TissueKernels* kernels : available_tissue_kernels()) {
      const SpringSet set(parts.mesh.points, springs, LinearSpring{}, none, *kernels);
      EXPECT_LT(distance(parts.forces(set), plain), 1e-12) << kernels->name << ", " << count;
    }
  }
}

/// Many elements, numbered along the box or at random, and what threads compute of them.
struct ManyElements {
  explicit ManyElements(const TetMesh& mesh) : parts(mesh, mesh.tetrahedron_count()) {
    const MeshEdges edges = edges_of(parts.mesh);
    // Springs take less time than elements: each one three times.
    for (int i = 0; i < 3; ++i)
      for (const auto& edge : edges.colwise()) springs.push_back({{edge[0], edge[1]}, 100});
  }
  static TetMesh mesh(bool at_random) {
    const TetMesh box = box_mesh({0.6, 0.1, 0.1}, {60, 14, 14});
    if (!at_random) return renumbered(box, local_order(box));
    return with_mixed_points(box);
  }
  Parts parts;
  std::vector<SpringSet::Spring> springs;
};

TEST(TissueKernels, ForcesAndStiffnessHaveTheSameBitsForAnyNumberOfThreads) {
  for (const bool at_random : {false, true}) {
    const ManyElements many(ManyElements::mesh(at_random));
    const Parts& parts = many.parts;
    const GreenElements green(parts.mesh, parts.materials, parts.pattern);
    const SpringSet springs(parts.mesh.points, many.springs, LinearSpring{}, parts.pattern);
    Eigen::SparseMatrix<double> K;
    parts.pattern.shape(K);
    const auto computed = [&](std::size_t threads) {
      const Jobs limit(threads);
      NodeRows elastic(parts.x.size(), {1, 2, 3, 0}), pulls = elastic;
      // Twice: the first leaves its rows behind.
      for (int i = 0; i < 2; ++i) {
        green.add_force(parts.u, elastic);
        springs.add_force(parts.x, pulls);
        K.coeffs().setConstant(7);
        green.write_stiffness(parts.u, parts.pattern, K.valuePtr());
      }
      return std::tuple(elastic, pulls, Eigen::VectorXd(K.coeffs()));
    };
    const auto [elastic, pulls, stiffness] = computed(1);
    for (const std::size_t threads : {2, 5}) {
      const auto [other_elastic, other_pulls, other_stiffness] = computed(threads);
      EXPECT_TRUE(same_bits(elastic, other_elastic)) << threads;
      EXPECT_TRUE(same_bits(pulls, other_pulls)) << threads;
      EXPECT_EQ(stiffness, other_stiffness) << threads;
    }
  }
}

TEST(PointStrips, HoldAllThatActsOnThem) {
  PointStrips groups;
  // Group i has the blocks 2 i and 2 i + 1, which act on the points 10 i to 10 i + 24, but for one far point.
  constexpr int count = 40, points = 10 * count + 20;
  const auto lowest = [](int i) { return i == 30 ? 285 : 10 * i; };
  const auto highest = [](int i) { return i == 12 ? 155 : 10 * i + 24; };
  for (int i = 0; i < count; ++i)
    groups.add_group(2 * static_cast<std::size_t>(i) + 2, lowest(i), highest(i));
  ASSERT_EQ(groups.blocks(), 80U);
  for (const std::size_t most : {2, 3, 5, 8}) {
    const auto strips = groups.divide(points, most);
    ASSERT_EQ(strips.size(), most);
    EXPECT_EQ(strips.back().last, points);
    for (std::size_t s = 0; s < strips.size(); ++s) {
      EXPECT_EQ(strips[s].first, s == 0 ? 0 : strips[s - 1].last);
      EXPECT_LT(strips[s].end - strips[s].begin, 80 / most + 16);
      for (int i = 0; i < count; ++i) {
        const auto block = 2 * static_cast<std::size_t>(i);
        const bool taken = strips[s].begin <= block && block + 2 <= strips[s].end;
        const bool acts = highest(i) >= strips[s].first && lowest(i) < strips[s].last;
        EXPECT_TRUE(taken || !acts) << s << ", " << i;
        if (!taken) continue;
        EXPECT_LE(strips[s].lowest, lowest(i));
        EXPECT_GE(strips[s].highest, highest(i));
      }
    }
  }
  // Nothing acts on the points below 50, and the first half of the groups begins there.
  PointStrips above;
  for (int i = 0; i < 40; ++i) above.add_group(static_cast<std::size_t>(i) + 1, i < 20 ? 50 : 50 + i, 60 + i);
  const auto of_above = above.divide(110, 4);
  EXPECT_EQ(of_above.front().first, 0);
  EXPECT_EQ(of_above.front().begin, 0U);
  EXPECT_GE(of_above.front().end, 20U);
  EXPECT_LE(of_above.front().highest, 99);
  // Where each group acts on all points a thread would have to compute all.
  PointStrips mixed;
  for (std::size_t i = 0; i < 40; ++i) mixed.add_group(i + 1, 0, 99);
  EXPECT_EQ(mixed.divide(100, 4).size(), 1U);
}

TEST(TissueKernels, PointsThatCoincideMeetNoForceOfTheirSpring) {
  const Parts parts;
  NodeRows x(parts.x.size()), f(parts.x.size());
  const SpringSet set(parts.mesh.points, {{{0, 1}, 100}}, LinearSpring{}, parts.pattern);
  set.add_force(x, f);
  EXPECT_EQ(as_vector(f[0]), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace hmax
