#include "studies/thigh/echography.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>

#include <Eigen/LU>
#include <fmt/format.h>

#include "bench/timing/timing.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/equilibria/body_balance.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "core/errors.hpp"
#include "core/parallel_for.hpp"
#include "problems/mesh/mesh_generators.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

constexpr double image_width = 0.08;                        // [m]
constexpr double probe_length = 0.05, probe_width = 0.016;  // [m]

/// Where lines of a grid stand from 0 to `length`: `fine` apart around the middle, further apart elsewhere.
std::vector<double> graded(double length, double middle, double half, double fine, double coarse) {
  std::vector<double> lines;
  const auto add = [&](double to, double apart) {
    const double from = lines.back();
    const auto cells = static_cast<int>(std::ceil((to - from) / apart - 1e-9));
    for (int i = 1; i <= cells; ++i) lines.push_back(i == cells ? to : from + (to - from) * i / cells);
  };
  lines.push_back(0);
  add(middle - half, coarse);
  add(middle + half, fine);
  add(length, coarse);
  return lines;
}

/// The interval of `lines` that holds x, and where in it; clamped.
std::pair<Eigen::Index, double> place_in(const std::vector<double>& lines, double x) {
  const auto upper = std::upper_bound(lines.begin() + 1, lines.end() - 1, x);
  const double low = *(upper - 1), share = (x - low) / (*upper - low);
  return {upper - 1 - lines.begin(), std::clamp(share, 0.0, 1.0)};
}

Eigen::Vector3d middle_of(const ThighAnatomy& anatomy) { return {anatomy.vein(0.06).x(), 0.06, 0}; }

/// Around the vein cells are of 8 mm; half as large ones move the distances of rules by a few percent.
std::array<std::vector<double>, 3> lines_of(const ThighAnatomy& anatomy) {
  const Eigen::Vector3d &size = anatomy.size(), at = middle_of(anatomy);
  std::array<std::vector<double>, 3> lines{graded(size.x(), at.x(), 0.016, 0.008, 0.03),
                                           graded(size.y(), at.y(), probe_length / 2, 0.0125, 0.0175),
                                           graded(size.z(), 0.024, 0.008, 0.008, 0.014)};
  lines[2].insert(lines[2].begin() + 1, ThighAnatomy::skin_thickness);
  return lines;
}

/// Boxes between the lines, each cut into tetrahedra of the tissue at their middles.
TetMesh mesh_between(const std::array<std::vector<double>, 3>& lines, const ThighAnatomy& anatomy,
                     bool one_tissue) {
  Eigen::Vector3i cells;
  for (int k = 0; k < 3; ++k) cells[k] = static_cast<int>(lines[static_cast<std::size_t>(k)].size()) - 1;
  TetMesh mesh = box_mesh(cells.cast<double>(), cells);
  for (auto x : mesh.points.colwise())
    for (int k = 0; k < 3; ++k)
      x[k] = lines[static_cast<std::size_t>(k)][static_cast<std::size_t>(std::lround(x[k]))];
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const TetMesh::Index i : mesh.tetrahedra.col(t)) centre += mesh.points.col(i) / 4;
    mesh.regions.push_back(static_cast<TetMesh::Index>(one_tissue ? Tissue::muscle : anatomy.at(centre)));
  }
  return mesh;
}

TissueSettings settings_of(const TetMesh& mesh, const ThighAnatomy& anatomy, const ThighPress& press) {
  const Eigen::Vector3d at = middle_of(anatomy), &size = anatomy.size();
  const Eigen::Vector3d half(probe_width / 2 + 1e-6, probe_length / 2 + 1e-6, 1e-6), over(1, 1, 1e-6);
  TissueSettings settings{.model = tissue_model("fem_neo_hookean"), .alpha = press.damping};
  settings.materials = {{.young = 40e3}, {.young = 8e3}, {.young = 1.5e3}, {.young = 10e6}};
  const Eigen::Vector3d foot(0, 0, size.z());
  settings.supports = {{.points = points_in_box(mesh, foot - over, size + over)},
                       {.points = points_in_box(mesh, at - half, at + half),
                        .travel = {0, 0, press.depth},
                        .profile = {.kind = TimeProfile::Kind::ramp, .rise = press.rise}}};
  return settings;
}

}  // namespace

Deformation linear_rule(const std::function<double(double, double)>& skin,
                        const std::function<double(double, double)>& reach) {
  return {.displacement =
              [=](const Eigen::Vector3d& rest) {
                const double share = 1 - rest.z() / reach(rest.x(), rest.y());
                return Eigen::Vector3d(0, 0, skin(rest.x(), rest.y()) * std::clamp(share, 0.0, 1.0));
              },
          .source =
              [=](const Eigen::Vector3d& now) {
                const double D = reach(now.x(), now.y()), w = skin(now.x(), now.y());
                const double d = now.z() < D ? (now.z() - w) / (1 - w / D) : now.z();
                return Eigen::Vector3d(now.x(), now.y(), d);
              }};
}

Eigen::Vector3d GridField::at(const Eigen::Vector3d& x) const {
  const auto [i, r] = place_in(lines[0], x.x());
  const auto [j, s] = place_in(lines[1], x.y());
  const auto [k, t] = place_in(lines[2], x.z());
  const auto ny = static_cast<Eigen::Index>(lines[1].size()), nz = static_cast<Eigen::Index>(lines[2].size());
  const auto row = [&, k = k, t = t](Eigen::Index a, Eigen::Index b) -> Eigen::Vector3d {
    const Eigen::Index first = (a * ny + b) * nz + k;
    return (1 - t) * u.col(first) + t * u.col(first + 1);
  };
  return (1 - r) * ((1 - s) * row(i, j) + s * row(i, j + 1)) +
         r * ((1 - s) * row(i + 1, j) + s * row(i + 1, j + 1));
}

Deformation deformation_of(GridField field) {
  const auto shared = std::make_shared<const GridField>(std::move(field));
  const auto source = [shared](const Eigen::Vector3d& now) {
    constexpr double step = 1e-5, enough = 1e-8;  // [m]
    Eigen::Vector3d rest = now - shared->at(now);
    for (int k = 0; k < 30; ++k) {
      const Eigen::Vector3d u = shared->at(rest), miss = rest + u - now;
      if (miss.norm() < enough) break;
      Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
      for (int axis = 0; axis < 3; ++axis)
        F.col(axis) += (shared->at(rest + step * Eigen::Vector3d::Unit(axis)) - u) / step;
      rest -= F.inverse() * miss;
    }
    return rest;
  };
  return {.displacement = [shared](const Eigen::Vector3d& rest) { return shared->at(rest); },
          .source = source};
}

PressedBlock::PressedBlock(const ThighAnatomy& anatomy, const ThighPress& press) : lines_(lines_of(anatomy)) {
  const TetMesh mesh = mesh_between(lines_, anatomy, press.one_tissue);
  const auto body = std::make_shared<const TissueBody>(mesh, settings_of(mesh, anatomy, press));
  problem_ = with_body(make_problem("fem_neo_hookean@phantom", {}), body);
  problem_.y0 = body->y0();
}

GridField PressedBlock::field(double t, const Eigen::VectorXd& q) const {
  const TissueBody& body = *problem_.body;
  return {lines_, body.positions(t, q) - body.mesh().points};
}

GridField PressedBlock::pressed() const {
  const StaticSolution found = found_equilibrium(problem_, 1, {.load_steps = 4}, thread_cpu_seconds);
  if (!found.converged)
    throw std::runtime_error("the pressed thigh: " + cause_of(problem_, found) + "; this is a defect");
  return field(equilibrium_time(problem_), found.q);
}

RuleError rule_error(const ThighAnatomy& anatomy, const Eigen::Vector3d& probe, double width,
                     const Deformation& rule, const Deformation& truth) {
  constexpr double apart = 0.001;  // [m]
  std::array<double, 2> sum{}, most{};
  std::array<int, 2> count{};
  const auto add = [&](std::size_t what, const Eigen::Vector3d& at) {
    const double off = (rule.displacement(at) - truth.displacement(at)).norm();
    sum[what] += off;
    most[what] = std::max(most[what], off);
    ++count[what];
  };
  const auto half = static_cast<int>(width / 2 / apart),
             radius = static_cast<int>(anatomy.vein_radius / apart);
  for (int j = -half; j <= half; ++j) {
    const double y = probe.y() + j * apart;
    for (int i = -radius; i <= radius; ++i) {
      for (int k = -radius; k <= radius; ++k)
        if (const Eigen::Vector3d at = anatomy.vein(y) + apart * Eigen::Vector3d(i, 0, k);
            anatomy.at(at) == Tissue::vein)
          add(0, at);
      const double x = probe.x() + i * apart;
      add(1, {x, y, anatomy.bone_depth(x, y)});
    }
  }
  return {{}, sum[0] / count[0], most[0], sum[1] / count[1], most[1]};
}

namespace {

/// Where places of the vein and the bone are, frame by frame; empty where the run did not reach its end.
using Followed = std::vector<Eigen::Matrix3Xd>;

Followed followed(const PressedBlock& block, const Eigen::Matrix3Xd& places, double frame, double h,
                  bool constant) {
  const Problem& problem = block.problem();
  Followed frames;
  const RunSpec spec{.t_end = 20 * frame,
                     .h = h,
                     .jacobian = {.every = constant ? JacobianUpdate::frozen : 1},
                     .every = frame};
  const Runner runner = find_method("linearly_implicit_euler").bind(problem);
  const RunRecord record = runner.run(spec, [&](double t, const Eigen::Ref<const Eigen::VectorXd>& y) {
    const GridField field = block.field(t, y.head(problem.body->dofs()));
    Eigen::Matrix3Xd& at = frames.emplace_back(places);
    for (auto place : at.colwise()) place += field.at(place);
  });
  if (record.outcome != Outcome::reached_end) frames.clear();
  return frames;
}

}  // namespace

std::vector<FrameError> frame_errors(const ThighAnatomy& anatomy, const PressedBlock& block, double frame) {
  const Eigen::Vector3d at = middle_of(anatomy);
  constexpr int each = 11;  // of the vein, then as many of the bone
  Eigen::Matrix3Xd places(3, 2 * each);
  for (int i = 0; i < each; ++i) {
    const double y = at.y() + probe_length * (i / (each - 1.0) - 0.5);
    places.col(i) = anatomy.vein(y);
    places.col(each + i) << at.x(), y, anatomy.bone_depth(at.x(), y);
  }
  std::vector<FrameError> errors;
  std::vector<Followed> runs;
  for (const auto& [steps, constant] : std::initializer_list<std::pair<int, bool>>{
           {1, true}, {16, true}, {1, false}, {2, false}, {4, false}, {8, false}, {16, false}}) {
    runs.push_back(followed(block, places, frame, frame / steps, constant));
    errors.push_back({.steps = steps, .constant = constant, .h = frame / steps});
  }
  const Followed &last = runs.back(), &before = runs[runs.size() - 2];
  for (std::size_t i = 0; i < runs.size(); ++i) {
    FrameError& error = errors[i];
    error.reached_end = !runs[i].empty();
    if (!error.reached_end || last.size() != runs[i].size() || before.size() != last.size())
      error.vein = error.bone = std::numeric_limits<double>::quiet_NaN();
    else
      for (std::size_t k = 0; k < last.size(); ++k) {
        const Eigen::VectorXd off = (runs[i][k] - 2 * last[k] + before[k]).colwise().norm();
        error.vein = std::max(error.vein, off.head(each).maxCoeff());
        error.bone = std::max(error.bone, off.tail(each).maxCoeff());
      }
  }
  return errors;
}

namespace {

double skin_of(const GridField& field, double x, double y) { return field.at({x, y, 0}).z(); }

/// The linear rule with the skin of a field, to the foot of the image or to the bone.
Deformation rule_of(const GridField& field, const ThighAnatomy& anatomy, bool to_the_bone) {
  const auto reach = [anatomy, to_the_bone](double x, double y) {
    return to_the_bone ? anatomy.bone_depth(x, y) : anatomy.size().z();
  };
  return linear_rule([field](double x, double y) { return skin_of(field, x, y); }, reach);
}

/// Draws where a deformation has vein and bone into an image along the bone.
void outline(EchoImage& image, const ThighAnatomy& anatomy, const SliceFrame& frame,
             const Deformation& truth) {
  const double pixel = frame.right.norm(), x = frame.corner.x(), r = anatomy.vein_radius;
  const auto shown = [&](const Eigen::Vector3d& rest) {
    const Eigen::Vector3d from = (rest + truth.displacement(rest) - frame.corner) / (pixel * pixel);
    return std::array{from.dot(frame.right), from.dot(frame.down)};
  };
  std::vector<std::array<double, 2>> lower;
  for (int i = 0; i < frame.pixels; i += 2) {
    const double y = frame.corner.y() + i * pixel, aside = x - anatomy.vein(y).x();
    image.bone.push_back(shown({x, y, anatomy.bone_depth(x, y)}));
    if (std::abs(aside) > r) continue;
    const double depth = anatomy.vein(y).z(), half = std::sqrt(r * r - aside * aside);
    image.vein.push_back(shown({x, y, depth - half}));
    lower.push_back(shown({x, y, depth + half}));
  }
  image.vein.insert(image.vein.end(), lower.rbegin(), lower.rend());
  if (!image.vein.empty()) image.vein.push_back(image.vein.front());
}

double seconds_of(const std::function<void()>& once) {
  const OneThread alone;
  const std::array task{repeated(once)};
  return time_interleaved(task, {.repetitions = 7, .min_sample_s = 2e-2}).front().least();
}

}  // namespace

Echography echography(const std::function<void(const std::string&)>& progress) {
  progress("echography, voxels");
  const ThighAnatomy anatomy(true_thigh());
  VoxelSpec spec;
  const VoxelMap voxels = thigh_voxels(anatomy, spec), images = probe_images(voxels, spec.between);
  Echography study;
  study.pixel = spec.edge;
  study.image_distance = point_distances().x();
  study.bytes = static_cast<double>(voxels.grey.size());
  study.gaps = gap_error(voxels, images, spec.between);
  spec.speckle = false;
  const VoxelMap tissues = thigh_voxels(anatomy, spec);
  study.tissue_gaps = gap_error(tissues, probe_images(tissues, spec.between), spec.between);

  progress("echography, equilibrium");
  const Eigen::Vector3d at = middle_of(anatomy);
  ThighPress plain = study.press;
  plain.one_tissue = true;
  const PressedBlock block(anatomy, study.press);
  const GridField field = block.pressed();
  const Deformation truth = deformation_of(field), linear = rule_of(field, anatomy, false),
                    to_bone = rule_of(field, anatomy, true),
                    uniform = deformation_of(PressedBlock(anatomy, plain).pressed());
  const auto judge = [&](const char* name, const Deformation& rule) {
    study.rules.push_back(rule_error(anatomy, at, image_width, rule, truth));
    study.rules.back().rule = name;
  };
  judge("linear, to the foot of the image", linear);
  judge("linear, to the bone", to_bone);
  judge("finite elements, muscle alone", uniform);

  progress("echography, slices");
  const SliceFrame along = probe_frame(at, image_width),
                   across = probe_frame(at, image_width, std::numbers::pi / 2);
  const auto add = [&](const char* name, const char* title, const VoxelMap& map, const SliceFrame& frame,
                       const Source& source = {}) {
    study.images.push_back({name, title, slice(map, frame, source), {}, {}});
    if (source) outline(study.images.back(), anatomy, frame, truth);
  };
  add("across", "Across the bone: voxels", voxels, across);
  add("filled", "The same from the 64 images, gaps filled", images, across);
  add("along", "Along the bone, in a row of points: images = voxels", images, along);
  add("linear", "Pressed, linear to the foot of the image", images, along, linear.source);
  add("to_bone", "Pressed, linear to the bone", images, along, to_bone.source);
  add("elements", "Pressed, finite elements with regions", images, along, truth.source);
  study.slice_seconds = seconds_of([&] { slice(images, along, truth.source); });

  progress("echography, frames");
  const Runner runner = find_method("linearly_implicit_euler").bind(block.problem());
  constexpr int steps = 20;
  study.step_seconds =
      seconds_of([&] {
        runner.repeat({.t_end = steps * study.frame, .h = study.frame, .jacobian = {.every = 1}}, 1);
      }) /
      steps;
  study.steps = frame_errors(anatomy, block, study.frame);
  for (const FrameError& error : study.steps)
    if (error.within(study.pixel)) study.largest_step = std::max(study.largest_step, error.h);
  return study;
}

std::vector<std::uint8_t> chosen_slice(const SliceChoice& choice) {
  const ThighAnatomy anatomy(true_thigh());
  const Eigen::Vector3d at(choice.x, choice.y, 0), &size = anatomy.size();
  if (!((at.array() >= 0) && (at.array() <= size.array())).all())
    throw InputError(fmt::format("the skin has no point {:g},{:g} mm; take one from 0,0 to {:.0f},{:.0f} mm",
                                 1e3 * at.x(), 1e3 * at.y(), 1e3 * size.x(), 1e3 * size.y()));
  if (!(choice.depth > 0 && choice.depth <= 0.02))
    throw InputError(
        fmt::format("the probe presses by {:g} mm; give more than 0 and at most 20 mm", 1e3 * choice.depth));
  if (!(std::isfinite(choice.angle) && std::isfinite(choice.tilt)))
    throw InputError("the angles of the slice are not finite; give degrees");
  constexpr std::array<std::string_view, 4> rules{"rest", "linear", "bone", "elements"};
  if (std::ranges::find(rules, choice.rule) == rules.end())
    throw InputError(fmt::format("there is no rule '{}'; take rest, linear, bone or elements", choice.rule));
  Source source;
  if (choice.rule != "rest") {
    const GridField field = PressedBlock(anatomy, {.depth = choice.depth}).pressed();
    source = choice.rule == "elements" ? deformation_of(field).source
                                       : rule_of(field, anatomy, choice.rule == "bone").source;
  }
  const VoxelSpec spec;
  VoxelMap map = thigh_voxels(anatomy, spec);
  if (choice.of_images) map = probe_images(map, spec.between);
  return slice(map, probe_frame(at, image_width, choice.angle, choice.tilt), source);
}

}  // namespace hmax
