#include "problems/tissue/forces/tet_blocks.hpp"

#include <algorithm>
#include <cmath>

#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/rest_shape.hpp"

namespace hmax {
namespace {

constexpr std::size_t least_forces =
    4'000;  // elements for a thread, some 50 us: parallel_for() takes 5 to 20

/// The corners of each tetrahedron in ascending order, then its number, in the order of the corners.
std::vector<std::array<TetMesh::Index, 5>> in_order(const TetMesh& mesh) {
  std::vector<std::array<TetMesh::Index, 5>> order(at(mesh.tetrahedron_count()));
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    std::array<TetMesh::Index, 5>& p = order[at(t)];
    for (Eigen::Index a = 0; a < 4; ++a) p[at(a)] = mesh.tetrahedra(a, t);
    std::sort(p.begin(), p.end() - 1);
    p[4] = static_cast<TetMesh::Index>(t);
  }
  std::sort(order.begin(), order.end());
  return order;
}

/// @param volume_scale  0 of unused lanes
void fill_lane(const TetMesh& mesh, const std::array<TetMesh::Index, 4>& points, const Lame& lame,
               double volume_scale, TetBlock& block, std::size_t lane) {
  const RestShape rest(mesh, points);
  for (std::size_t a = 0; a < 4; ++a) block.rows[a][lane] = 4 * points[a];
  for (std::size_t k = 0; k < 9; ++k)
    block.gradients[k][lane] =
        rest.gradients(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3));
  const double volume = volume_scale * std::abs(rest.volume);
  block.half_lambda[lane] = volume * lame.lambda / 2;
  block.mu[lane] = volume * lame.mu;
}

}  // namespace

TetBlocks::TetBlocks(const TetMesh& mesh, std::span<const Lame> lame, TetLaw law,
                     const TissueKernels& kernels)
    : law_(law), kernels_(&kernels) {
  constexpr std::size_t lanes = TetBlock::lanes;
  const std::vector<std::array<Index, 5>> order = in_order(mesh);
  const std::size_t count = order.size();
  blocks_.resize((count + lanes - 1) / lanes);
  places_.resize(count);
  for (std::size_t begin = 0; begin < blocks_.size(); begin += window) {
    const std::size_t width = std::min(window, blocks_.size() - begin);
    Index lowest = static_cast<Index>(mesh.point_count()), highest = 0;
    for (std::size_t n = begin; n < begin + width; ++n)
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::size_t wanted = begin * lanes + lane * width + (n - begin),
                          i = std::min(wanted, count - 1);
        const Index tetrahedron = order[i][4];
        if (wanted < count) places_[at(tetrahedron)] = static_cast<Index>(n * lanes + lane);
        std::array<Index, 4> points;
        std::copy_n(order[i].begin(), 4, points.begin());
        fill_lane(mesh, points, lame[at(mesh.region(tetrahedron))], wanted < count ? 1 : 0, blocks_[n], lane);
        lowest = std::min(lowest, points[0]), highest = std::max(highest, points[3]);
      }
    strips_.add_group(begin + width, lowest, highest);
  }
}

void TetBlocks::add_force(const NodeRows& u, NodeRows& f) const {
  add_by_strips(strips_, places_.size() / least_forces, f,
                [&](std::size_t begin, std::size_t end, double* rows) {
                  kernels_->force[static_cast<std::size_t>(law_)](blocks_.data() + begin, end - begin,
                                                                  &u.front().x, rows);
                });
}

std::array<TetBlocks::Index, 4> TetBlocks::corners_at(std::size_t place) const {
  constexpr std::size_t lanes = TetBlock::lanes;
  std::array<Index, 4> p;
  for (std::size_t a = 0; a < 4; ++a) p[a] = blocks_[place / lanes].rows[a][place % lanes] / 4;
  return p;
}

}  // namespace hmax
