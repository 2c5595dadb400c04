#include "cli/bodies/body_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "cli/shared/options.hpp"
#include "core/errors.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/mesh/topology.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

constexpr std::array<std::string_view, 2> values{"displacement", "energy_density"};

SpacePoint space_point(const Eigen::Vector3d& x) { return {x(0), x(1), x(2)}; }

/// The direction of --from, or that of all pictures.
SpacePoint towards_viewer(const std::string& from) {
  if (from.empty()) return BodyPicture{}.towards;
  const std::vector<double> n = parse_numbers("--from", from);
  const double length = n.size() == 3 ? std::hypot(n[0], n[1], n[2]) : 0;
  if (!(length > 0 && std::isfinite(length)))
    throw InputError(fmt::format(
        "--from {} is no direction; write three numbers that are not all 0, like 1,-1,0.5", from));
  return {n[0], n[1], n[2]};
}

void require_value(const TissueBody& body, BodyValue value) {
  if (value == BodyValue::energy_density && body.settings().model.is_of_springs())
    throw InputError("springs have no energy density; take --colour displacement, or finite elements");
}

/// A round number at or above.
double rounded_up(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double factor : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
    if (factor * power >= value * (1 - 1e-12)) return factor * power;
  return 10 * power;
}

}  // namespace

std::vector<SpacePoint> space_points(const Eigen::Matrix3Xd& x) {
  std::vector<SpacePoint> points;
  points.reserve(static_cast<std::size_t>(x.cols()));
  for (Eigen::Index i = 0; i < x.cols(); ++i) points.push_back(space_point(x.col(i)));
  return points;
}

std::vector<TriangleCorners> surface_triangles(const TetMesh& mesh) {
  const MeshSurface surface = surface_of(mesh);
  std::vector<TriangleCorners> triangles;
  triangles.reserve(static_cast<std::size_t>(surface.triangles.cols()));
  for (const auto& t : surface.triangles.colwise()) triangles.push_back({t(0), t(1), t(2)});
  return triangles;
}

std::vector<std::int32_t> held_points(const TissueBody& body) {
  std::vector<std::int32_t> held;
  for (const Support& support : body.settings().supports)
    held.insert(held.end(), support.points.begin(), support.points.end());
  for (const ElasticSupport& support : body.settings().elastic_supports)
    held.insert(held.end(), support.points.begin(), support.points.end());
  return held;
}

std::string how_held(const TissueBody& body) {
  if (body.settings().elastic_supports.empty()) return "fixed";
  return body.settings().supports.empty() ? "held by springs" : "fixed or held by springs";
}

BodyView body_view(const TissueBody& body, double t, const Eigen::VectorXd& q, BodyValue value) {
  require_value(body, value);
  const TetMesh& mesh = body.mesh();
  const Eigen::Matrix3Xd x = body.positions(t, q);
  BodyView view{.points = space_points(x),
                .triangles = surface_triangles(mesh),
                .rest = space_points(mesh.points),
                .held = held_points(body),
                .held_as = how_held(body)};
  if (value == BodyValue::energy_density) {
    const Eigen::VectorXd density = body.point_energy_densities(t, q);
    view.values.assign(density.begin(), density.end());
  } else {
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      view.values.push_back(1000 * (x.col(i) - mesh.points.col(i)).norm());
  }

  const TissueSettings& settings = body.settings();
  for (const SphereTool& tool : settings.tools) {
    const Eigen::Vector3d back =
        tool.travel.norm() > 0 ? Eigen::Vector3d(-tool.travel) : Eigen::Vector3d(0, 0, 1);
    view.tools.push_back({space_point(Eigen::Vector3d(tool.pose(t).centre)), tool.radius, space_point(back)});
  }
  const Eigen::Vector3d middle = x.rowwise().mean();
  for (const PressingForce& force : settings.forces) {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    for (const TetMesh::Index i : force.points) at += x.col(i) / static_cast<double>(force.points.size());
    view.arrows.push_back({.point = space_point(at),
                           .direction = space_point(force.force),
                           .leaves = force.force.dot(at - middle) > 0});
  }
  return view;
}

BodyColours colours_of(BodyValue value, const std::vector<BodyView>& views) {
  std::vector<double> all;
  for (const BodyView& view : views)
    std::ranges::copy_if(view.values, std::back_inserter(all), [](double x) { return std::isfinite(x); });
  BodyColours colours{.quantity =
                          value == BodyValue::displacement ? "displacement [mm]" : "energy density [J/m³]"};
  if (all.empty()) return colours;
  std::ranges::sort(all);
  const double most = all.back(), usual = all[all.size() - 1 - all.size() / 50];
  const bool cut = value == BodyValue::energy_density && most > 1.5 * usual && usual > 0;
  const double high = cut ? rounded_up(usual) : most;
  colours.range = Range{0, high > 0 ? high : 1};
  return colours;
}

BodyView mesh_view(const TetMesh& mesh) {
  std::vector<double> worst(static_cast<std::size_t>(mesh.point_count()), 1);
  for (Eigen::Index e = 0; e < mesh.tetrahedron_count(); ++e) {
    const double quality = mean_ratio(corners_of(mesh, e));
    for (const TetMesh::Index corner : mesh.tetrahedra.col(e)) {
      double& at = worst[static_cast<std::size_t>(corner)];
      at = std::min(at, quality);
    }
  }
  BodyView view{.points = space_points(mesh.points), .triangles = surface_triangles(mesh)};
  for (const TriangleCorners& t : view.triangles) {
    double value = 1;
    for (const std::int32_t corner : t) value = std::min(value, worst[static_cast<std::size_t>(corner)]);
    view.values.push_back(value);
  }
  return view;
}

BodyColours mesh_quality_colours() {
  return {
      .quantity = "mean ratio of the worst tetrahedron nearby [1]", .range = Range{0, 1}, .low_is_bad = true};
}

void PictureChoice::add_to(CLI::App& command, const std::string& description, bool of_body) {
  add_text(command, "--picture", file, description, "FILE.svg");
  if (of_body)
    add_text(command, "--colour", colour,
             "Coloured quantity of the picture: displacement or energy_density; displacement by default",
             "NAME");
  add_text(command, "--from", from, "Direction from which the picture looks, z is up; 0.45,-1,0.5 by default",
           "X,Y,Z");
}

void PictureChoice::check() const {
  if (!wanted()) {
    if (!colour.empty() || !from.empty())
      throw InputError(fmt::format("--{} is for pictures; add --picture FILE.svg, or leave it out",
                                   colour.empty() ? "from" : "colour"));
    return;
  }
  if (!file.ends_with(".svg"))
    throw InputError(fmt::format("the picture {} would be an SVG; let its name end in .svg", file));
  (void)value();
  (void)towards_viewer(from);
  check_writable(file);
}

void PictureChoice::check(const TissueBody& body) const { require_value(body, value()); }

BodyValue PictureChoice::value() const {
  if (colour.empty()) return BodyValue::displacement;
  return parse_choice("--colour", colour, values) == values[0] ? BodyValue::displacement
                                                               : BodyValue::energy_density;
}

void PictureChoice::write(BodyPicture picture) const {
  picture.towards = towards_viewer(from);
  write_picture(file, picture);
}

void write_picture(const std::filesystem::path& file, const BodyPicture& picture) {
  write_file(file, bodies_svg(picture));
}

}  // namespace hmax
