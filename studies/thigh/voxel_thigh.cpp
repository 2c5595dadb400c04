#include "studies/thigh/voxel_thigh.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace hmax {

namespace {

/// Vigna's splitmix64 of a place.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// The amplitude of many scatterers relative to its mean: the length of a vector of two sums of four bytes,
/// which are nearly normal.
double speckle_of(std::uint64_t place) {
  std::uint64_t bytes = mixed(place);
  double sum[2] = {-510, -510};
  for (double& each : sum)
    for (int k = 0; k < 4; ++k, bytes >>= 8) each += static_cast<double>(bytes & 255);
  constexpr double mean = 185.24;  // sqrt(pi / 2) times the standard deviation of such a sum
  return std::sqrt(sum[0] * sum[0] + sum[1] * sum[1]) / mean;
}

std::uint8_t rounded(double grey) { return static_cast<std::uint8_t>(std::clamp(grey + 0.5, 0.0, 255.0)); }

constexpr std::array<double, 4> grey_of{170, 80, 14, 215};  // of skin, muscle, vein, bone

/// The interval of a regular grid that holds s, and where in it; clamped.
std::pair<Eigen::Index, double> interval_of(double s, Eigen::Index count) {
  const auto i = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::floor(s)), 0, count - 2);
  return {i, std::clamp(s - static_cast<double>(i), 0.0, 1.0)};
}

}  // namespace

ThighAnatomy::ThighAnatomy(const Thigh& thigh)
    : around_(thigh.around), along_(thigh.along), depths_(tissue_depths(thigh)) {
  const Eigen::Vector2d apart = point_distances();
  size_ = {apart.x() * static_cast<double>(around_ - 1), apart.y() * static_cast<double>(along_ - 1), 0.08};
}

Eigen::Vector3d ThighAnatomy::place(Eigen::Index point) const {
  const Eigen::Vector2d apart = point_distances();
  const Eigen::Index around = point / along_, along = point % along_;
  return {apart.x() * static_cast<double>(around), apart.y() * static_cast<double>(along), 0};
}

double ThighAnatomy::bone_depth(double x, double y) const {
  const Eigen::Vector2d apart = point_distances();
  const auto [i, s] = interval_of(x / apart.x(), around_);
  const auto [j, t] = interval_of(y / apart.y(), along_);
  const double* const first = depths_.data() + i * along_ + j;
  return (1 - s) * ((1 - t) * first[0] + t * first[1]) +
         s * ((1 - t) * first[along_] + t * first[along_ + 1]);
}

Eigen::Vector3d ThighAnatomy::vein(double y) const {
  const Eigen::Vector3d middle = place(along_ * (around_ / 2 - 1) + along_ / 2 - 1);
  return {middle.x() + 0.15 * (y - middle.y()), y, 0.024};
}

Tissue ThighAnatomy::at(const Eigen::Vector3d& x) const {
  if (x.z() >= bone_depth(x.x(), x.y())) return Tissue::bone;
  if (x.z() < skin_thickness) return Tissue::skin;
  const Eigen::Vector3d from = x - vein(x.y());
  return from.squaredNorm() < vein_radius * vein_radius ? Tissue::vein : Tissue::muscle;
}

double VoxelMap::at(const Eigen::Vector3d& x) const {
  std::array<Eigen::Index, 3> first{};
  std::array<double, 3> share{};
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    const double s = x[k] / spacing[k];
    if (!(s >= -1e-6 && s <= static_cast<double>(counts[axis] - 1) + 1e-6)) return 0;
    std::tie(first[axis], share[axis]) = interval_of(s, counts[axis]);
  }
  const Eigen::Index row = counts[2], layer = counts[1] * row;
  const std::uint8_t* const g = grey.data() + first[0] * layer + first[1] * row + first[2];
  const auto between = [](double a, double b, double t) { return a + t * (b - a); };
  const auto in_row = [&](Eigen::Index o) { return between(g[o], g[o + 1], share[2]); };
  const auto in_layer = [&](Eigen::Index o) { return between(in_row(o), in_row(o + row), share[1]); };
  return between(in_layer(0), in_layer(layer), share[0]);
}

VoxelMap thigh_voxels(const ThighAnatomy& anatomy, const VoxelSpec& spec) {
  VoxelMap map;
  map.spacing = {point_distances().x() / spec.between, spec.edge, spec.edge};
  for (int k = 0; k < 3; ++k)
    map.counts[static_cast<std::size_t>(k)] =
        static_cast<Eigen::Index>(std::llround(anatomy.size()[k] / map.spacing[k])) + 1;
  map.grey.reserve(static_cast<std::size_t>(map.counts[0] * map.counts[1] * map.counts[2]));
  for (Eigen::Index i = 0; i < map.counts[0]; ++i)
    for (Eigen::Index j = 0; j < map.counts[1]; ++j)
      for (Eigen::Index k = 0; k < map.counts[2]; ++k) {
        const Eigen::Vector3d at(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
        const double grey = grey_of[static_cast<std::size_t>(anatomy.at(at.cwiseProduct(map.spacing)))];
        map.grey.push_back(rounded(spec.speckle ? grey * speckle_of(map.grey.size()) : grey));
      }
  return map;
}

VoxelMap probe_images(const VoxelMap& voxels, int between) {
  VoxelMap images = voxels;
  images.counts[0] = (voxels.counts[0] - 1) / between + 1;
  images.spacing[0] *= between;
  images.grey.clear();
  const auto layer = static_cast<std::ptrdiff_t>(voxels.counts[1] * voxels.counts[2]);
  for (Eigen::Index i = 0; i < images.counts[0]; ++i) {
    const auto from = voxels.grey.begin() + layer * i * between;
    images.grey.insert(images.grey.end(), from, from + layer);
  }
  return images;
}

GapError gap_error(const VoxelMap& voxels, const VoxelMap& images, int between) {
  const auto layer = static_cast<std::size_t>(voxels.counts[1] * voxels.counts[2]);
  std::array<double, 3> sum{}, count{};
  for (Eigen::Index i = 0; i < voxels.counts[0]; ++i) {
    const auto [row, share] =
        interval_of(static_cast<double>(i) / static_cast<double>(between), images.counts[0]);
    const std::uint8_t* const low = images.grey.data() + static_cast<std::size_t>(row) * layer;
    const std::uint8_t* const truth = voxels.grey.data() + static_cast<std::size_t>(i) * layer;
    double squares = 0;
    for (std::size_t p = 0; p < layer; ++p) {
      const double difference = low[p] + share * (low[p + layer] - low[p]) - truth[p];
      squares += difference * difference;
    }
    const auto add = [&](std::size_t where) {
      sum[where] += squares;
      count[where] += static_cast<double>(layer);
    };
    if (i % between == 0) add(0);
    if (i % between == between / 2) add(1);
    add(2);
  }
  const auto root = [&](std::size_t where) { return std::sqrt(sum[where] / count[where]); };
  return {root(0), root(1), root(2)};
}

SliceFrame probe_frame(const Eigen::Vector3d& at, double width, double angle, double tilt) {
  SliceFrame frame;
  const double pixel = width / frame.pixels;
  const Eigen::Vector3d right(std::sin(angle), std::cos(angle), 0),
      across(std::cos(angle), -std::sin(angle), 0);
  frame.right = pixel * right;
  frame.down = pixel * (std::cos(tilt) * Eigen::Vector3d::UnitZ() + std::sin(tilt) * across);
  frame.corner = at - frame.pixels / 2 * frame.right;
  return frame;
}

std::vector<std::uint8_t> slice(const VoxelMap& map, const SliceFrame& frame, const Source& source) {
  constexpr int stride = 8;
  const int n = frame.pixels, nodes = (n + stride - 1) / stride + 1;
  Eigen::Matrix3Xd above(3, nodes), below(3, nodes), at(3, nodes);
  const auto ask = [&](int row, Eigen::Matrix3Xd& into) {
    for (int i = 0; i < nodes; ++i) {
      const Eigen::Vector3d x = frame.corner + i * stride * frame.right + row * stride * frame.down;
      into.col(i) = source ? source(x) : x;
    }
  };
  std::vector<std::uint8_t> grey;
  grey.reserve(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  ask(0, below);
  for (int row = 0; row < n; ++row) {
    if (row % stride == 0) {
      above.swap(below);
      ask(row / stride + 1, below);
    }
    at = above + (row % stride) / double(stride) * (below - above);
    for (int i = 0; i < n; ++i) {
      const int node = i / stride;
      const double share = (i % stride) / double(stride);
      grey.push_back(rounded(map.at(at.col(node) + share * (at.col(node + 1) - at.col(node)))));
    }
  }
  return grey;
}

}  // namespace hmax
