#include "problems/tissue/forces/green_elements.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Dense>

#include "core/sort_unique.hpp"
#include "problems/mesh/at.hpp"
#include "problems/tissue/forces/tet_elements.hpp"

namespace hmax {
namespace {

using Eigen::Matrix3d;
constexpr std::size_t lanes = TetBlock::lanes;
constexpr std::size_t batch_windows = 8;  // whose elements come before what they finish is written
constexpr std::size_t least_stiffness =
    800;  // elements for a thread, some 50 us: parallel_for() takes 5 to 20

}  // namespace

struct GreenElements::Element {
  Matrix3d gradients, H;  // Bm, du/dX
  double half_lambda, mu;
  [[nodiscard]] double volume() const { return 1 / (6 * std::abs(gradients.determinant())); }
  /// V (lambda/2 tr(E)^2 + mu E:E), E = (H + H^T + H^T H) / 2.
  [[nodiscard]] double energy() const {
    const Matrix3d C = H + H.transpose() + H.transpose() * H;
    return half_lambda * C.trace() * C.trace() / 4 + mu * C.squaredNorm() / 4;
  }
  [[nodiscard]] ElementStiffness stiffness() const;
};

GreenElements::GreenElements(const TetMesh& mesh, std::span<const Lame> lame, const BlockPattern& pattern,
                             const TissueKernels& kernels)
    : blocks_(mesh, lame, TetLaw::green, kernels) {
  slots_.resize(blocks_.blocks().size());
  for (std::size_t n = 0; n < slots_.size(); ++n)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::array<Index, 4> points = blocks_.corners_at(n * lanes + lane);
      for (std::size_t a = 0, pair = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b, ++pair)
          slots_[n].block[pair][lane] = pattern.pair(points[a], points[b]);
    }
  make_batches(pattern);
  place_rim(pattern);
}

void GreenElements::make_batches(const BlockPattern& pattern) {
  const std::span<const TetBlock> blocks = blocks_.blocks();
  // Elements come in the order of their lowest points: all that is left of that of the next one is finished.
  constexpr std::size_t size = batch_windows * TetBlocks::window;
  Index oldest = 0, needed = 0, columns = 0, point = 0, last = 0, highest = 0;
  for (std::size_t begin = 0; begin < blocks.size(); begin += size) {
    const std::size_t end = std::min(begin + size, blocks.size());
    for (std::size_t n = begin; n < end; ++n) {
      for (const auto& pair : slots_[n].block) last = std::max(last, *std::max_element(pair, pair + lanes));
      for (const auto& rows : blocks[n].rows)
        for (const Index row : rows) highest = std::max(highest, pattern.free()[at(row / 4)]);
    }
    ring_ = std::max(ring_, last + 1 - needed);
    if (end == blocks.size())
      columns = pattern.columns();
    else
      for (; point < blocks[end].rows[0][0] / 4; ++point)
        if (pattern.stride(point) > 0) ++columns;
    // A block is written in both columns that it belongs to.
    while (oldest < columns && pattern.last_row(oldest) < columns) ++oldest;
    needed = pattern.first_pair(oldest);
    batches_.push_back({end, columns, highest});
  }
  for (TetSlots& slots : slots_)
    for (auto& pair : slots.block)
      for (Index& block : pair)
        if (block >= 0) block %= ring_;
}

void GreenElements::place_rim(const BlockPattern& pattern) {
  // Pairs of one free and one supported point, each once, in the order of their columns; pairs of two
  // supported ones share a block after them.
  std::vector<std::array<Index, 2>> pairs;
  const auto in_order = [&](Index a, Index b) {
    return pattern.stride(a) > 0 ? std::array{pattern.free()[at(a)], b}
                                 : std::array{pattern.free()[at(b)], a};
  };
  const auto each_missing = [&](const auto& visit) {
    for (std::size_t n = 0; n < slots_.size(); ++n)
      for (std::size_t lane = 0; lane < lanes; ++lane) {
        const std::array<Index, 4> points = blocks_.corners_at(n * lanes + lane);
        for (std::size_t a = 0, pair = 0; a < 4; ++a)
          for (std::size_t b = a + 1; b < 4; ++b, ++pair)
            if (slots_[n].block[pair][lane] < 0)
              visit(in_order(points[a], points[b]), slots_[n].block[pair][lane]);
      }
  };
  each_missing([&](const std::array<Index, 2>& pair, Index) {
    if (pair[0] >= 0) pairs.push_back(pair);
  });
  sort_unique(pairs);
  for (const auto& pair : pairs) rim_.push_back(pair[0]);
  each_missing([&](const std::array<Index, 2>& pair, Index& block) {
    const auto found = pair[0] >= 0 ? std::lower_bound(pairs.begin(), pairs.end(), pair) : pairs.end();
    block = ring_ + static_cast<Index>(found - pairs.begin());
  });
}

GreenElements::Element GreenElements::element(const NodeRows& u, std::size_t place) const {
  const TetBlock& block = blocks_.blocks()[place / lanes];
  const std::size_t lane = place % lanes;
  Element e;
  for (std::size_t k = 0; k < 9; ++k)
    e.gradients(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)) =
        block.gradients[k][lane];
  e.H = edge_vectors(u, blocks_.corners_at(place)) * e.gradients;
  e.half_lambda = block.half_lambda[lane];
  e.mu = block.mu[lane];
  return e;
}

double GreenElements::energy(const NodeRows& u) const {
  double sum = 0;
  for (const Index place : blocks_.places()) sum += element(u, at(place)).energy();
  return sum;
}

void GreenElements::write_energy_densities(const NodeRows& u, Eigen::Ref<Eigen::VectorXd> W) const {
  const std::span<const Index> places = blocks_.places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Element e = element(u, at(places[i]));
    W[static_cast<Eigen::Index>(i)] = e.energy() / e.volume();
  }
}

std::vector<GreenElements::Strip> GreenElements::stiffness_strips(std::size_t count) const {
  std::vector<Strip> strips;
  Index first = 0;
  std::size_t batch = 0, longest = 0;
  for (std::size_t part = 1; part <= count; ++part) {
    while (batches_[batch].end < slots_.size() * part / count) ++batch;
    const Index last = batches_[batch].columns;
    if (last == first) continue;
    const auto begin = std::partition_point(batches_.begin(), batches_.end(),
                                            [&](const Batch& b) { return b.highest < first; });
    strips.push_back({first, last, at(begin - batches_.begin())});
    longest = std::max(longest, batch + 1 - strips.back().batch);
    first = last;
  }
  if (4 * longest > 3 * batches_.size()) strips.clear();
  return strips;
}

void GreenElements::write_stiffness(const NodeRows& u, const BlockPattern& pattern, double* values) const {
  // The calling thread keeps them from call to call.
  thread_local std::vector<BlockPattern::Pairs> kept(1);
  std::vector<BlockPattern::Pairs>& own = kept;
  const std::size_t most = pieces() / least_stiffness, count = most > 1 ? std::min(threads(), most) : 1;
  std::vector<Strip> strips;
  if (count > 1) strips = stiffness_strips(count);
  if (strips.size() < 2) return write_strip(u, pattern, {0, pattern.columns(), 0}, own.front(), values);
  if (own.size() < strips.size()) own.resize(strips.size());
  parallel_for(strips.size(),
               [&](std::size_t i, std::size_t) { write_strip(u, pattern, strips[i], own[i], values); });
}

void GreenElements::write_strip(const NodeRows& u, const BlockPattern& pattern, const Strip& strip,
                                BlockPattern::Pairs& pairs, double* values) const {
  // All rows are zero before and after.
  const std::size_t blocks = at(ring_) + rim_.size() + 1;
  if (pairs.rows.size() < 3 * blocks) pairs.rows.assign(3 * blocks, {});
  pairs.ring = ring_;
  auto batch = batches_.begin() + static_cast<std::ptrdiff_t>(strip.batch);
  std::size_t begin = strip.batch == 0 ? 0 : (batch - 1)->end;
  Index columns = strip.batch == 0 ? 0 : std::min((batch - 1)->columns, strip.first);
  pattern.begin(columns, pairs);
  // Nothing is allocated while rows are not zero.
  Index widest = 0;
  for (Index from = columns; const Batch& each : std::span(batches_).subspan(strip.batch)) {
    widest = std::max(widest, each.columns - from);
    from = std::max(from, each.columns);
  }
  pairs.diagonal.reserve(9 * at(widest));
  auto on_rim = static_cast<std::size_t>(std::lower_bound(rim_.begin(), rim_.end(), columns) - rim_.begin());
  for (; columns < strip.last; ++batch) {
    blocks_.kernels().green_stiffness(blocks_.blocks().data() + begin, slots_.data() + begin,
                                      batch->end - begin, &u.front().x, &pairs.rows.front().x);
    pairs.diagonal.assign(9 * at(batch->columns - columns), 0.0);
    for (; on_rim < rim_.size() && rim_[on_rim] < batch->columns; ++on_rim)
      for (std::size_t c = 0; c < 3; ++c) {
        NodeRow& row = pairs.rows[3 * (at(ring_) + on_rim) + c];
        Eigen::Map<Eigen::Vector3d>(&pairs.diagonal[9 * at(rim_[on_rim] - columns) + 3 * c]) -=
            as_vector(row);
        row = {};
      }
    if (batch->columns <= strip.first)
      pattern.skip(columns, batch->columns, pairs);
    else
      pattern.write(columns, batch->columns, pairs, values);
    columns = batch->columns;
    begin = batch->end;
  }
  // Left are pairs of two supported points, and those with the columns of a later strip.
  const std::size_t left = strip.last < pattern.columns() ? 0 : blocks - 1;
  std::fill_n(pairs.rows.begin() + static_cast<std::ptrdiff_t>(3 * left), 3 * (blocks - left), NodeRow{});
}

ElementStiffness GreenElements::Element::stiffness() const {
  // As TissueKernels::green_stiffness has it.
  const Matrix3d F = Matrix3d::Identity() + H, B = F * F.transpose();
  Eigen::Matrix<double, 3, 4> g;
  g << -gradients.colwise().sum().transpose(), gradients.transpose();
  const Eigen::Matrix<double, 3, 4> h = F * g;
  const double c = half_lambda * (B.trace() - 3) - mu;
  ElementStiffness K;
  for (Eigen::Index a = 0; a < 4; ++a)
    for (Eigen::Index b = 0; b < 4; ++b) {
      const double k = g.col(a).dot(g.col(b));
      K.block<3, 3>(3 * a, 3 * b) = 2 * half_lambda * h.col(a) * h.col(b).transpose() +
                                    mu * h.col(b) * h.col(a).transpose() + mu * k * B +
                                    (c * k + mu * h.col(a).dot(h.col(b))) * Matrix3d::Identity();
    }
  return K;
}

void GreenElements::visit_stiffness(const NodeRows& u, const StiffnessVisitor& visit) const {
  for (const Index place : blocks_.places())
    visit(blocks_.corners_at(at(place)), element(u, at(place)).stiffness());
}

}  // namespace hmax
