#include "studies/thigh/echography.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "core/numbers.hpp"

namespace hmax {
namespace {

constexpr int layers = 4;
const VoxelSpec small{.between = layers, .edge = 0.08 / 64};

const ThighAnatomy& anatomy() {
  static const ThighAnatomy it(true_thigh());
  return it;
}

/// An image along the bone whose pixels are the voxels of a layer, `below` voxels from the skin.
SliceFrame of_voxels(double x, Eigen::Index from = 0, int pixels = 64) {
  return {.corner = {x, static_cast<double>(from) * small.edge, 0},
          .right = small.edge * Eigen::Vector3d::UnitY(),
          .down = small.edge * Eigen::Vector3d::UnitZ(),
          .pixels = pixels};
}

std::uint8_t voxel(const VoxelMap& map, Eigen::Index i, Eigen::Index j, Eigen::Index k) {
  return map.grey[static_cast<std::size_t>((i * map.counts[1] + j) * map.counts[2] + k)];
}

TEST(VoxelThigh, HasItsTissuesWhereTheSpringsHaveTheirBone) {
  const Thigh thigh = true_thigh();
  for (const Eigen::Index point : {0, 19, 63}) {
    const Eigen::Vector3d at = anatomy().place(point);
    EXPECT_NEAR(anatomy().bone_depth(at.x(), at.y()) * thigh.b[point], 6, 1e-12) << point;
  }
  const Eigen::Vector3d vein = anatomy().vein(0.05), radius(0, 0, ThighAnatomy::vein_radius);
  EXPECT_EQ(anatomy().at(vein), Tissue::vein);
  EXPECT_EQ(anatomy().at(vein + 0.99 * radius), Tissue::vein);
  EXPECT_EQ(anatomy().at(vein - 1.01 * radius), Tissue::muscle);
  EXPECT_EQ(anatomy().at({vein.x(), vein.y(), 0.001}), Tissue::skin);
  EXPECT_EQ(anatomy().at({vein.x(), vein.y(), 0.079}), Tissue::bone);
}

/// Amplitudes of many scatterers have the mean sqrt(pi / 2) and the variance (2 - pi / 2) of sigma^2.
TEST(VoxelThigh, HasSpeckleOfTheRayleighDistributionAndTheSameBitsEverywhere) {
  const VoxelMap map = thigh_voxels(anatomy(), small);
  double sum = 0, squares = 0, count = 0;
  for (Eigen::Index i = 0; i < map.counts[0]; ++i)
    for (Eigen::Index j = 0; j < map.counts[1]; ++j)
      for (Eigen::Index k = 4; k < 12; ++k) {  // muscle, above the vein
        const double grey = voxel(map, i, j, k);
        sum += grey;
        squares += grey * grey;
        ++count;
      }
  const double mean = sum / count, spread = std::sqrt(squares / count - mean * mean) / mean;
  EXPECT_NEAR(mean, 80, 1);
  EXPECT_NEAR(spread, std::sqrt(4 / std::numbers::pi - 1), 0.03);
  // splitmix64 of 0 is 0xe220a8397b1dcdaf: bytes af cd 1d 7b and 39 a8 20 e2.
  const double x = 0xaf + 0xcd + 0x1d + 0x7b - 510, y = 0x39 + 0xa8 + 0x20 + 0xe2 - 510;
  EXPECT_EQ(map.grey[0], std::lround(170 * std::hypot(x, y) / 185.24));
}

TEST(Slice, ThroughAVoxelLayerIsThisLayer) {
  const VoxelMap map = thigh_voxels(anatomy(), small);
  for (const Eigen::Index i : {0, 3, 28}) {
    const auto grey = slice(map, of_voxels(static_cast<double>(i) * map.spacing[0], 7));
    for (int k = 0; k < 64; ++k)
      for (int j = 0; j < 64; ++j)
        ASSERT_EQ(grey[static_cast<std::size_t>(64 * k + j)], voxel(map, i, 7 + j, k)) << j << ' ' << k;
  }
}

TEST(Slice, OfTheImagesIsThatOfTheVoxelsUnderPointsAndLinearBetween) {
  const VoxelMap map = thigh_voxels(anatomy(), small), images = probe_images(map, layers);
  EXPECT_EQ(images.counts[0], 8);
  const double apart = point_distances().x();
  EXPECT_EQ(slice(images, of_voxels(3 * apart)), slice(map, of_voxels(3 * apart)));
  const auto low = slice(map, of_voxels(3 * apart)), high = slice(map, of_voxels(4 * apart));
  const auto between = slice(images, of_voxels(3.25 * apart));
  for (std::size_t i = 0; i < low.size(); ++i)
    ASSERT_NEAR(between[i], 0.75 * low[i] + 0.25 * high[i], 0.5 + 1e-9) << i;
}

TEST(Slice, TurnsAndTiltsAndIsBlackOutside) {
  VoxelMap ramp;  // grey = 10 (x + 2 y + 3 z) in steps of 10 mm: trilinear interpolation is exact
  ramp.counts = {4, 4, 4};
  ramp.spacing = Eigen::Vector3d::Constant(0.01);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) ramp.grey.push_back(static_cast<std::uint8_t>(10 * (i + 2 * j + 3 * k)));
  SliceFrame frame = probe_frame({0.015, 0.015, 0}, 0.02, 0.5, 0.3);
  const auto grey = slice(ramp, frame);
  for (const int row : {0, 77, 255})
    for (const int column : {0, 128, 200}) {
      const double a = (column - 128) * 0.02 / 256, d = row * 0.02 / 256;
      const Eigen::Vector3d x(0.015 + a * std::sin(0.5) + d * std::sin(0.3) * std::cos(0.5),
                              0.015 + a * std::cos(0.5) - d * std::sin(0.3) * std::sin(0.5),
                              d * std::cos(0.3));
      EXPECT_NEAR(grey[static_cast<std::size_t>(256 * row + column)], 1000 * (x.x() + 2 * x.y() + 3 * x.z()),
                  0.5 + 1e-6);
    }
  frame.corner.x() = 0.031;
  frame.right = frame.down = 1e-5 * Eigen::Vector3d::UnitZ();
  EXPECT_EQ(std::ranges::max(slice(ramp, frame)), 0);
}

/// Of a step of g grey values between layers of images half is missed on average where it is halfway.
TEST(Slice, HasTheGapErrorOfALayerThatNoImageShows) {
  VoxelMap map;
  map.counts = {5, 2, 2};
  map.spacing = Eigen::Vector3d::Constant(0.01);
  for (const int grey : {0, 100, 100, 0, 0})
    map.grey.insert(map.grey.end(), 4, static_cast<std::uint8_t>(grey));
  const GapError error = gap_error(map, probe_images(map, 2), 2);  // images 0, 100, 0 hold 50 and 50
  EXPECT_DOUBLE_EQ(error.at_points, 0);
  EXPECT_DOUBLE_EQ(error.halfway, 50);
  EXPECT_DOUBLE_EQ(error.all, std::sqrt(2 * 50 * 50 / 5.0));
}

/// The skin of a block of depth D goes by a + b x; below, everything by a share that falls with the depth.
TEST(LinearRule, IsExactForALinearDisplacementAndInvertsIt) {
  const double D = 0.08;
  const auto skin = [](double x, double) { return 0.01 + 0.05 * x; };
  const Deformation rule = linear_rule(skin, [&](double, double) { return D; });
  GridField field{.lines = {{{0, 0.1, 0.2}, {0, 0.14}, {0, 0.02, 0.08}}}, .u = Eigen::Matrix3Xd::Zero(3, 18)};
  Eigen::Index column = 0;
  for (const double x : field.lines[0])
    for (int j = 0; j < 2; ++j)
      for (const double z : field.lines[2]) field.u(2, column++) = skin(x, 0) * (1 - z / D);
  const Deformation exact = deformation_of(field);
  const RuleError error = rule_error(anatomy(), {0.084, 0.06, 0}, 0.08, rule, exact);
  EXPECT_LT(error.vein_most, 1e-15);
  EXPECT_LT(error.bone_most, 1e-15);
  for (const Eigen::Vector3d& at :
       {Eigen::Vector3d(0.03, 0.05, 0.02), {0.19, 0.1, 0.079}, {0.1, 0.01, 0.03}}) {
    const Eigen::Vector3d now = at + rule.displacement(at);
    EXPECT_LT((rule.source(now) - at).norm(), 1e-15);
    EXPECT_LT((exact.source(now) - at).norm(), 1e-8);
  }
  EXPECT_EQ(rule.displacement({0, 0, 0.09}), Eigen::Vector3d::Zero());
  EXPECT_LT(rule.source({0.1, 0, 0.014}).z(), 0);  // above the skin there is no tissue
}

TEST(RuleError, IsTheDistanceOfAShift) {
  const auto shifted = [](const Eigen::Vector3d& by) {
    return Deformation{[by](const Eigen::Vector3d&) { return by; }, {}};
  };
  const RuleError error =
      rule_error(anatomy(), {0.084, 0.06, 0}, 0.08, shifted({0.003, 0, 0}), shifted({0, 0, 0.004}));
  for (const double each : {error.vein_mean, error.vein_most, error.bone_mean, error.bone_most})
    EXPECT_NEAR(each, 0.005, 1e-12);
}

/// Of a rigid shift by whole voxels and an affine stretch: closed forms of what a pixel shows.
TEST(Slice, ShowsVoxelsWhereARigidOrAffineMotionBringsThem) {
  const VoxelMap map = thigh_voxels(anatomy(), small);
  const SliceFrame frame = of_voxels(3 * map.spacing[0], 10);
  const GridField shift{.lines = {{{0, 1}, {0, 1}, {0, 1}}},
                        .u = small.edge * Eigen::Vector3d(0, 3, 5).replicate(1, 8)};
  const auto moved = slice(map, frame, deformation_of(shift).source);
  for (int k = 0; k < 64; ++k)
    for (int j = 0; j < 64; ++j)
      ASSERT_EQ(moved[static_cast<std::size_t>(64 * k + j)], k < 5 ? 0 : voxel(map, 3, 7 + j, k - 5));
  GridField stretch = shift;  // u = z in depth: every second pixel shows a voxel
  for (Eigen::Index i = 0; i < 8; ++i) stretch.u.col(i) << 0, 0, static_cast<double>(i % 2);
  const auto stretched = slice(map, frame, deformation_of(stretch).source);
  for (int k = 0; k < 64; k += 2)
    for (int j = 0; j < 64; ++j)
      ASSERT_EQ(stretched[static_cast<std::size_t>(64 * k + j)], voxel(map, 3, 10 + j, k / 2));
}

TEST(PressedBlock, FollowsTheProbeAndHoldsItsBone) {
  const PressedBlock block(anatomy(), {.depth = 0.008});
  const GridField field = block.pressed();
  const Eigen::Vector3d middle(anatomy().vein(0.06).x(), 0.06, 0);
  EXPECT_NEAR(field.at(middle).z(), 0.008, 1e-12);
  EXPECT_LT(field.at({0, 0.14, 0}).norm(), 0.002);
  const double bone = anatomy().bone_depth(middle.x(), middle.y());
  EXPECT_LT(field.at({middle.x(), middle.y(), bone + 0.01}).norm(), 1e-4);
  // What was brought somewhere comes from where it was.
  const Deformation deformation = deformation_of(field);
  for (double z = 0.001; z < 0.05; z += 0.007)
    for (const double aside : {0.0, 0.01, 0.03}) {
      const Eigen::Vector3d at = middle + Eigen::Vector3d(aside, aside, z);
      EXPECT_LT((deformation.source(at + field.at(at)) - at).norm(), 1e-7) << z << ' ' << aside;
    }
}

/// A method of first order halves its error with its step. The Jacobian of rest does not suffice.
TEST(FrameErrors, HalveWithTheStep) {
  const PressedBlock block(anatomy(), {});
  std::map<int, FrameError> moving;
  for (const FrameError& error : frame_errors(anatomy(), block, 0.01)) {
    EXPECT_DOUBLE_EQ(error.h, 0.01 / error.steps);
    if (!error.constant) moving[error.steps] = error;
    EXPECT_EQ(error.constant, !error.within(1e-3)) << error.steps;
  }
  ASSERT_EQ(moving.size(), 5U);
  EXPECT_NEAR(moving[8].vein / moving[16].vein, 2, 0.2);
  EXPECT_NEAR(moving[4].vein / moving[8].vein, 2, 0.4);
  EXPECT_LT(moving[1].bone, 0.1 * moving[1].vein);
}

TEST(ChosenSlice, RefusesWhatItDoesNotHave) {
  EXPECT_THROW(chosen_slice({.x = 0.3}), InputError);
  EXPECT_THROW(chosen_slice({.y = std::numeric_limits<double>::quiet_NaN()}), InputError);
  EXPECT_THROW(chosen_slice({.angle = std::numeric_limits<double>::quiet_NaN()}), InputError);
  EXPECT_THROW(chosen_slice({.tilt = std::numeric_limits<double>::infinity()}), InputError);
  EXPECT_THROW(chosen_slice({.rule = "cubic"}), InputError);
  EXPECT_THROW(chosen_slice({.rule = "elements", .depth = 0.05}), InputError);
}

}  // namespace
}  // namespace hmax
