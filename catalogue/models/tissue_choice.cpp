#include "catalogue/models/tissue_choice.hpp"

#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "catalogue/models/idle_parameters.hpp"
#include "catalogue/models/support_sets.hpp"
#include "core/input_error.hpp"
#include "core/numbers.hpp"
#include "core/text/split.hpp"
#include "problems/mesh/files/mesh_names.hpp"
#include "problems/mesh/mesh_quality.hpp"
#include "problems/tissue/contact.hpp"
#include "problems/tissue/held_end.hpp"
#include "problems/tissue/materials.hpp"
#include "problems/tissue/surface_place.hpp"

namespace hmax {

namespace {

constexpr std::array<std::string_view, 5> loads{"gravity", "press", "pull", "tool", "breathing"};

void require_known(std::string_view what, const std::string& word, std::span<const std::string_view> known) {
  if (std::ranges::find(known, word) != known.end()) return;
  throw input_error("unknown {} '{}'; {}", what, word,
                    suggestion(word, std::vector<std::string>(known.begin(), known.end())));
}

/// One number that users may set.
struct Named {
  std::string_view name;
  double TissueParameters::*value;
  std::string_view unit;     ///< 1 of shares, directions and switches
  bool everybody = true;     ///< shown of every body, else where it is not the default
  std::string_view of = {};  ///< its readers (catalogue/models/idle_parameters.hpp)
};
constexpr std::array<Named, 47> all_named{{
    {"E", &TissueParameters::E, "Pa"},
    {"nu", &TissueParameters::nu, "1"},
    {"rho", &TissueParameters::rho, "kg/m³"},
    {"mass", &TissueParameters::mass, "kg"},
    {"alpha", &TissueParameters::alpha, "1/s"},
    {"beta", &TissueParameters::beta, "s"},
    {"damper", &TissueParameters::damper, "s", true, only_springs},
    {"g", &TissueParameters::g, "m/s²", true, "gravity"},
    {"force", &TissueParameters::force, "N", true, "press pull"},
    {"depth", &TissueParameters::depth, "m", true, "tool breathing"},
    {"support", &TissueParameters::support, "1"},
    {"axis", &TissueParameters::axis, "1"},
    {"equal_masses", &TissueParameters::equal_masses, "1"},
    {"gx", &TissueParameters::gx, "m/s²", false, "gravity"},
    {"gy", &TissueParameters::gy, "m/s²", false, "gravity"},
    {"gz", &TissueParameters::gz, "m/s²", false, "gravity"},
    {"period", &TissueParameters::period, "s", false, "breathing"},
    {"tool_radius", &TissueParameters::tool_radius, "m", false, "tool"},
    {"tool_stiffness", &TissueParameters::tool_stiffness, "Pa/m^1.5", false, "tool"},
    {"tool_damping", &TissueParameters::tool_damping, "s/m", false, "tool"},
    {"tool_x", &TissueParameters::tool_x, "m", false, "tool"},
    {"tool_y", &TissueParameters::tool_y, "m", false, "tool"},
    {"tool_z", &TissueParameters::tool_z, "m", false, "tool"},
    {"tool_dx", &TissueParameters::tool_dx, "1", false, "tool"},
    {"tool_dy", &TissueParameters::tool_dy, "1", false, "tool"},
    {"tool_dz", &TissueParameters::tool_dz, "1", false, "tool"},
    {"support_stiffness", &TissueParameters::support_stiffness, "Pa/m", false},
    {"mass_step", &TissueParameters::mass_step, "s", false},
    {"inclusion", &TissueParameters::inclusion, "1", false},
    {"fibre_E", &TissueParameters::fibre_E, "Pa", false, only_elements},
    {"fibre_x", &TissueParameters::fibre_x, "1", false, only_elements},
    {"fibre_y", &TissueParameters::fibre_y, "1", false, only_elements},
    {"fibre_z", &TissueParameters::fibre_z, "1", false, only_elements},
    {"skin", &TissueParameters::skin, "1", false},
    {"skin_thickness", &TissueParameters::skin_thickness, "m", false},
    {"k", &TissueParameters::k, "N/m", false, only_springs},
    {"cubic", &TissueParameters::cubic, "1", false, only_springs},
    {"exponential", &TissueParameters::exponential, "1", false, only_springs},
    {"bending", &TissueParameters::bending, "1", false, only_springs},
    {"second_ring", &TissueParameters::second_ring, "1", false, only_springs},
    {"doubled_skin", &TissueParameters::doubled_skin, "1", false, only_springs},
    {"xmin", &TissueParameters::xmin, "m", false},
    {"xmax", &TissueParameters::xmax, "m", false},
    {"ymin", &TissueParameters::ymin, "m", false},
    {"ymax", &TissueParameters::ymax, "m", false},
    {"zmin", &TissueParameters::zmin, "m", false},
    {"zmax", &TissueParameters::zmax, "m", false},
}};

/// Squares of rates and of forces must stay numbers, whatever masses and stiffnesses come together.
void require_computable(std::string_view name, double value) {
  constexpr double least = 1e-30, most = 1e30;
  const double size = std::abs(value);
  if (size == 0 || (size >= least && size <= most)) return;
  throw input_error(
      "{} is {}, and computing with it would leave the range of numbers; give it in SI units, between {} and {}",
      name, to_text(value), to_text(least), to_text(most));
}

/// What has a value in each region.
struct NamedOfRegion {
  std::string_view name;
  double TissueMaterial::*value;
};
constexpr std::array<NamedOfRegion, 7> named_of_region{{{"E", &TissueMaterial::young},
                                                        {"nu", &TissueMaterial::poisson},
                                                        {"rho", &TissueMaterial::density},
                                                        {"fibre_E", &TissueMaterial::fibre_young},
                                                        {"fibre_x", &TissueMaterial::fibre_x},
                                                        {"fibre_y", &TissueMaterial::fibre_y},
                                                        {"fibre_z", &TissueMaterial::fibre_z}}};
constexpr std::string_view table_name = "phi";

/// "E:tumour=8000", "phi:0.1=0.14", "support:capsule=1" and "force_z:capsule=0.5". @returns false when the
/// name is not of that kind
bool take_indexed(TissueParameters& parameters, const std::string& name, double value, const TissueId& id) {
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos) return false;
  const std::string what = name.substr(0, colon), index = name.substr(colon + 1);
  const auto number = to_number(index);
  if (what == table_name) {
    require_read(name, only_springs, id);
    if (!number || !std::isfinite(*number))
      throw input_error("'{}' in {} is no strain; write it like phi:0.1=0.14", index, name);
    parameters.table.emplace_back(*number, value);
    return true;
  }
  if (what == support_name) {
    if (value != 1)
      throw input_error("{} is {}, but a set of points is held with 1; leave it out to set it free", name,
                        to_text(value));
    parameters.supports.push_back(index);
    return true;
  }
  if (const auto axis = std::ranges::find(nodal_force_names, what); axis != nodal_force_names.end()) {
    parameters.nodal_forces.push_back({static_cast<int>(axis - nodal_force_names.begin()), index, value});
    return true;
  }
  const auto it = std::ranges::find(named_of_region, what, &NamedOfRegion::name);
  if (it == named_of_region.end())
    throw input_error("'{}' has no value for each region; E, nu, rho and fibre_E do, like E:3=8000", what);
  if (value != 0) require_read(name, std::ranges::find(all_named, what, &Named::name)->of, id);
  parameters.of_regions.push_back({it->value, index, value});
  return true;
}

/// @throws InputError  for a parameter that the user has changed and that changes nothing beside the others
void require_acting(const TissueId& id, const TissueParameters& parameters, const ProblemSettings& settings) {
  for (const auto& [name, value] : settings.parameters) {
    const auto named = std::ranges::find(all_named, name, &Named::name);
    // What is listed of a body makes it again; springs have no nu of their own that could be listed.
    const bool unchanged = named != all_named.end() && value == TissueParameters{}.*(named->value);
    // A share of 0 is none, beside whatever is held instead.
    if ((unchanged && name != "nu") || (name == "support" && value == 0)) continue;
    if (const std::string why = why_idle(id, parameters, name); !why.empty()) throw InputError(why);
  }
}

TetMesh::Index region_count(const TetMesh& mesh) {
  return mesh.regions.empty() ? 1 : std::ranges::max(mesh.regions) + 1;
}

/// "tissue:liver,tumour=tissue:fibroadenoma" in its parts: a region, empty of the whole body, and a material.
/// @throws InputError  for an empty part
std::vector<std::pair<std::string, std::string>> materials_in(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> parts;
  if (text.empty()) return parts;
  for (const std::string_view part : split(text, ",")) {
    // No material has '=' in its name; a region may.
    const std::size_t equals = part.rfind('=');
    const bool of_region = equals != std::string::npos;
    const std::string_view region = trimmed(of_region ? part.substr(0, equals) : ""),
                           material = trimmed(of_region ? part.substr(equals + 1) : part);
    if (material.empty() || (of_region && region.empty()))
      throw input_error(
          "--material '{}' has an empty part; write it like tissue:liver,tumour=tissue:fibroadenoma", text);
    parts.emplace_back(region, material);
  }
  return parts;
}

/// @throws InputError  for one that does not exist
const PublishedTissue& tissue_called(const std::string& id, const std::string& region) {
  if (const PublishedTissue* tissue = find_published_tissue(id)) return *tissue;
  if (find_published_tissue("tissue:" + id))
    throw input_error("unknown material '{}'; did you mean tissue:{}?", id, id);
  std::vector<std::string> known;
  for (const PublishedTissue& each : published_tissues()) known.emplace_back(each.id);
  throw input_error("unknown material '{}'{}; {}", id,
                    region.empty() ? "" : fmt::format(" of the region {}", region), suggestion(id, known));
}

/// @throws InputError  for a material that does not exist, and for a second one of the whole body
void take_material_of_body(const std::string& text, TissueParameters& parameters) {
  bool is_taken = false;
  for (const auto& [region, id] : materials_in(text)) {
    if (!region.empty()) continue;
    if (is_taken)
      throw input_error("--material {} names two materials of the whole body; write the second as REGION={}",
                        text, id);
    is_taken = true;
    if (id.starts_with("tissue:") || find_published_tissue("tissue:" + id)) {
      const TissueMaterial& material = tissue_called(id, region).material;
      parameters.E = material.young;
      parameters.nu = material.poisson;
      parameters.rho = material.density;
      continue;
    }
    // The oscillators' names of the same materials serve as well.
    const TissueSettings made = with_tissue_material({}, id.starts_with("liver:") ? id : "liver:" + id);
    parameters.E = made.materials.front().young;
    parameters.nu = made.materials.front().poisson;
    parameters.mass = made.total_mass.value();
    parameters.alpha = made.alpha;
  }
}

/// E, nu and rho of regions that have a material, without what would not act.
/// @throws InputError  for a material that does not exist, and for a second one of a region
void take_materials_of_regions(const std::string& text, const TissueId& id, TissueParameters& parameters) {
  std::vector<std::string> taken;
  for (const auto& [region, name] : materials_in(text)) {
    if (region.empty()) continue;
    if (std::ranges::find(taken, region) != taken.end())
      throw input_error("--material {} names two materials of the region {}; leave one out", text, region);
    taken.push_back(region);
    const TissueMaterial& material = tissue_called(name, region).material;
    for (const NamedOfRegion& each : named_of_region) {
      const bool acts = each.value == &TissueMaterial::density   ? parameters.mass == 0
                        : each.value == &TissueMaterial::poisson ? !id.is_of_springs()
                                                                 : material.*each.value != 0;
      if (acts) parameters.of_regions.push_back({each.value, region, material.*each.value, true});
    }
  }
}

/// @throws InputError  when what is asked for is not that of the model, the mesh or the load
void require_sensible(const TissueId& id, const TissueParameters& p, const TetMesh& mesh) {
  const auto refuse_negative = [](std::string_view name, double value) {
    if (value < 0) throw input_error("{} is {} but must not be negative", name, to_text(value));
  };
  for (const auto& [name, value] :
       std::initializer_list<std::pair<std::string_view, double>>{{"alpha", p.alpha},
                                                                  {"beta", p.beta},
                                                                  {"damper", p.damper},
                                                                  {"k", p.k},
                                                                  {"cubic", p.cubic},
                                                                  {"exponential", p.exponential},
                                                                  {"bending", p.bending},
                                                                  {"second_ring", p.second_ring},
                                                                  {"doubled_skin", p.doubled_skin},
                                                                  {"inclusion", p.inclusion},
                                                                  {"fibre_E", p.fibre_E},
                                                                  {"skin", p.skin},
                                                                  {"support_stiffness", p.support_stiffness},
                                                                  {"tool_radius", p.tool_radius},
                                                                  {"tool_stiffness", p.tool_stiffness},
                                                                  {"tool_damping", p.tool_damping}})
    refuse_negative(name, value);
  if ((p.cubic != 0) + (p.exponential != 0) + !p.table.empty() > 1)
    throw InputError("cubic, exponential and phi are laws of the same springs; choose one of them");
  for (const auto& [name, value] : {std::pair("skin_thickness", p.skin_thickness), {"period", p.period}})
    if (!(value > 0)) throw input_error("{} is {} but must be positive", name, to_text(value));
  if (p.skin_thickness != TissueParameters{}.skin_thickness && p.skin == 0)
    throw InputError(
        "skin_thickness is that of a skin; give its stiffness too, like skin=1000, or leave it out");
  if (p.inclusion != 0 && region_count(mesh) < 2)
    throw input_error(
        "inclusion is for meshes of several regions, and {} has one; `hmax mesh info` counts them", id.mesh);
  if (id.load == "breathing" && p.holds_nothing())
    throw InputError(
        "breathing moves the held end, and with support = 0 nothing is held; give support a share");
  if (p.support_stiffness == 0) return;
  if (id.load == "breathing")
    throw InputError(
        "support_stiffness is of supports that stand still, and breathing moves them; leave it out or take another load");
  if (p.holds_nothing())
    throw InputError("support_stiffness is of supports, and nothing is held; name points with --support");
}

/// @throws InputError  when there are none
std::vector<TetMesh::Index> points_of_box(const TissueParameters& p, const TetMesh& mesh) {
  std::vector<TetMesh::Index> points =
      points_in_box(mesh, {p.xmin, p.ymin, p.zmin}, {p.xmax, p.ymax, p.zmax});
  if (points.empty())
    throw InputError(
        "no point of the mesh lies in the box from xmin, ymin, zmin to xmax, ymax, zmax; give a larger one, in metres");
  return points;
}

/// The points that are held, by springs or not; none where nothing is.
/// @throws InputError  for sets that are unknown or empty, and where nothing is left to move
std::vector<TetMesh::Index> supported_points(const TissueParameters& p, const LoadedMesh& loaded) {
  if (!p.supports.empty())
    return p.support_stiffness > 0 ? union_of_sets(p.supports, loaded) : points_of_sets(p.supports, loaded);
  if (p.has_box()) return points_of_box(p, loaded.mesh);
  return p.support > 0 ? points_of_end(loaded.mesh, HeldEnd(p.axis).towards, p.support)
                       : std::vector<TetMesh::Index>{};
}

/// @throws InputError  as supported_points(), and where springs have no surface to stand on
void set_supports(const TissueParameters& p, const LoadedMesh& loaded, TissueSettings& settings) {
  std::vector<TetMesh::Index> points = supported_points(p, loaded);
  if (points.empty()) return;
  if (p.support_stiffness == 0) {
    settings.supports.push_back({.points = std::move(points)});
    return;
  }
  settings.elastic_supports.push_back(on_foundation(loaded.mesh, points, p.support_stiffness));
  if (settings.elastic_supports.front().points.empty())
    throw input_error(
        "support_stiffness acts on the surface, and no triangle of the surface has its three corners among the {} "
        "supported points; hold more points, or leave support_stiffness out",
        points.size());
}

/// @throws InputError  for a law that does not rise through (0, 0), std::invalid_argument for repeated
/// strains
TableSpring law_of_table(std::vector<std::pair<double, double>> points) {
  if (const auto rest = std::ranges::find(points, 0.0, [](const auto& point) { return point.first; });
      rest == points.end())
    points.emplace_back(0, 0);
  else if (rest->second != 0)
    throw input_error("{}:0 is {}, but a spring of its own length has no tension; leave it out", table_name,
                      to_text(rest->second));
  std::ranges::sort(points);
  std::vector<double> strain, phi;
  for (const auto& [s, value] : points) {
    if (s <= -1)
      throw input_error("{}:{} is a strain at which a spring has no length; give it above -1", table_name,
                        to_text(s));
    // Else it would be slack, or shorten by itself, and have no stable length.
    if (!phi.empty() && !(value > phi.back()))
      throw input_error(
          "the law of springs does not rise from strain {} to {}; give {} values that do, through (0, 0)",
          to_text(strain.back()), to_text(s), table_name);
    strain.push_back(s);
    phi.push_back(value);
  }
  return {std::move(strain), std::move(phi)};
}

/// The pressure of a tool of radius R that indents a body by a depth is a share of E; it shall push the tool
/// into the surface by no more than a twentieth of the depth or so.
/// @param young  of the stiffest region
double default_tool_stiffness(double young, double depth, double radius) {
  const double reach = depth != 0 ? std::abs(depth) : radius;
  return 500 * young / (reach * std::sqrt(reach));
}

/// Beside a sphere that is 1e4 times as large as the body the surface departs from a plane by a hundred
/// thousandth of the body's size; beyond, depths and the places of the tool are differences of radii.
/// @throws InputError  for larger ones
void require_round(double radius, double size) {
  constexpr double most = 1e4;
  if (radius > most * size)
    throw input_error(
        "tool_radius is {} m, and contacts of spheres of more than {:.3g} m with a body of {:.3g} m may be lost to rounding; "
        "give that or less, which touches as a plane does",
        to_text(radius), most * size, size);
}

/// A sphere that touches the body, or where the user places it its starting point, with its front and moves
/// on from there.
/// @throws InputError  when a tool meets nothing, or starts inside the body
SphereTool tool_of(const TissueParameters& p, const TetMesh& mesh, const HeldEnd& end, double young) {
  const Eigen::Vector3d given(p.tool_x, p.tool_y, p.tool_z), direction(p.tool_dx, p.tool_dy, p.tool_dz);
  const bool placed = given.allFinite(), directed = !direction.isZero(0);
  if (!placed && given.array().isFinite().any())
    throw InputError("tool_x, tool_y and tool_z are one point; give all three or none");
  const HeldEnd way = directed ? HeldEnd(direction.normalized()) : end;
  const double size = diagonal_of(mesh);
  SphereTool tool{.radius = p.tool_radius > 0 ? p.tool_radius : 0.05 * size};
  require_round(tool.radius, size);
  tool.stiffness =
      p.tool_stiffness > 0 ? p.tool_stiffness : default_tool_stiffness(young, p.depth, tool.radius);
  tool.damping = p.tool_damping;
  tool.travel = p.depth * way.towards;
  tool.profile = {.kind = TimeProfile::Kind::ramp, .start = 0, .rise = 0.5};
  const MeshSurface surface = surface_of(mesh);
  const auto gap_from = [&](const Eigen::Vector3d& start) {
    SphereTool probe = tool;
    probe.start = start;
    probe.travel = (p.depth != 0 ? std::abs(p.depth) : tool.radius) * way.towards;
    return ToolContact(mesh.points, surface.triangles, probe).gap();
  };
  if (placed) {
    tool.start = given - tool.radius * way.towards;
  } else {
    // From far outside up to where it touches, less rounding.
    const Eigen::Vector3d tip = mesh.points.col(faced_point(mesh, surface, way, tool.radius));
    tool.start = tip - (tool.radius + 2 * size) * way.towards;
    const double gap = gap_from(tool.start);
    tool.start += ((std::isfinite(gap) ? gap : 2 * size) - 1e-12 * tool.radius) * way.towards;
  }
  const Eigen::Vector3d front = tool.start + tool.radius * way.towards;
  const std::string which = fmt::format(
      "a tool of radius {} m that starts at {}, {}, {} and moves {} m along {}, {}, {}", to_text(tool.radius),
      to_text(front(0)), to_text(front(1)), to_text(front(2)), to_text(p.depth), to_text(way.towards(0)),
      to_text(way.towards(1)), to_text(way.towards(2)));
  if (p.depth < 0 || !(gap_from(tool.start) <= p.depth + 1e-8 * tool.radius))
    throw InputError(
        which +
        " meets nothing of the body; place it nearer, turn it, or give a larger depth or tool_radius");
  // A sphere rests on the samples of a triangle a little deeper than on the triangle.
  const double resting = 0.05 * std::min(p.depth > 0 ? p.depth : tool.radius, tool.radius);
  const SurfacePlace place = place_beside(mesh.points, surface.triangles, tool.start);
  const bool meets_point = std::ranges::any_of(surface.points, [&](TetMesh::Index i) {
    return (mesh.points.col(i) - tool.start).norm() < (1 - 1e-6) * tool.radius;
  });
  if (place.inside || meets_point || place.distance < tool.radius - resting)
    throw InputError(which + " starts inside the body; place its front on the surface or before it");
  return tool;
}

/// A dead load for each of p.nodal_forces. @throws InputError  for points that the mesh does not have
std::vector<PressingForce> nodal_forces(const TissueParameters& p, const LoadedMesh& loaded) {
  std::vector<std::string> sets;
  for (const auto& each : p.nodal_forces) sets.push_back(each.set);
  std::vector<std::vector<TetMesh::Index>> points = points_of_each(sets, loaded);
  std::vector<PressingForce> forces;
  for (const auto& [axis, set, value] : p.nodal_forces) {
    PressingForce& force = forces.emplace_back();
    force.points = std::move(points[forces.size() - 1]);
    force.force[axis] = value * static_cast<double>(force.points.size());
  }
  return forces;
}

/// The region 0, 1, ... that a user calls by its name or, where none has this name, by its number.
/// @throws InputError  when the mesh does not have it, or several have this name
std::size_t region_of(const LoadedMesh& loaded, const std::string& called) {
  const MeshOrigin& origin = *loaded.origin;
  std::vector<std::string> known;
  std::vector<std::size_t> named, numbered;
  for (std::size_t i = 0; i < origin.regions.size(); ++i) {
    known.push_back(origin.file.region_in_words(origin.regions[i]));
    if (std::to_string(origin.regions[i]) == called) numbered.push_back(i);
    if (const auto name = origin.file.names.find(origin.regions[i]);
        name != origin.file.names.end() && name->second == called)
      named.push_back(i);
  }
  if (named.size() > 1)
    throw input_error("{} regions of {} are called '{}'; give the number of one", named.size(), loaded.name,
                      called);
  if (!named.empty()) return named.front();
  if (numbered.empty())
    throw input_error("{} has no region {}; it has {}", loaded.name, called, fmt::join(known, ", "));
  return numbered.front();
}

/// @throws InputError  for a region that the mesh does not have, and for one that has the same property twice
void set_materials_of_regions(const TissueParameters& p, const LoadedMesh& loaded,
                              std::vector<TissueMaterial>& materials) {
  if (p.of_regions.empty()) return;
  materials.resize(static_cast<std::size_t>(region_count(loaded.mesh)), materials.front());
  std::vector<std::pair<double TissueMaterial::*, std::size_t>> taken;
  for (const TissueParameters::OfRegion& set : p.of_regions) {
    if (is_overridden(set, p, loaded)) continue;
    const auto& [what, called, value, from_material] = set;
    const std::pair property(what, region_of(loaded, called));
    if (std::ranges::find(taken, property) != taken.end())
      throw input_error("{}:{} is set twice, once perhaps by the number of the region; leave one out",
                        std::ranges::find(named_of_region, what, &NamedOfRegion::value)->name, called);
    taken.push_back(property);
    materials[property.second].*what = value;
  }
}

}  // namespace

bool is_overridden(const TissueParameters::OfRegion& set, const TissueParameters& p,
                   const LoadedMesh& loaded) {
  return set.from_material && std::ranges::any_of(p.of_regions, [&](const TissueParameters::OfRegion& other) {
           return !other.from_material && other.what == set.what &&
                  region_of(loaded, other.region) == region_of(loaded, set.region);
         });
}

std::vector<std::string_view> tissue_model_ids() {
  std::vector<std::string_view> ids;
  for (const TissueModel& model : tissue_models()) ids.push_back(model.id);
  return ids;
}
std::span<const std::string_view> tissue_loads() { return loads; }

TissueId::TissueId(const std::string& id) {
  const std::size_t at = id.find('@');
  model = id.substr(0, at);
  mesh = id.substr(at + 1);
  const std::size_t slash = model.find('/');
  load = slash == std::string::npos ? std::string(loads.front()) : model.substr(slash + 1);
  model.resize(std::min(slash, model.size()));
  require_known("model", model, tissue_model_ids());
  require_known("load", load, loads);
}

ElementNodes element_nodes(const TissueId& id) {
  return tissue_model(id.model).has_ten_nodes ? ElementNodes::ten : ElementNodes::four;
}

TissueParameters tissue_parameters(const TissueId& id, const ProblemSettings& settings) {
  TissueParameters parameters;
  if (const NamedMesh* const named = find_named_mesh(parse_mesh_request(id.mesh).name))
    parameters.axis = named->held_axis;
  take_material_of_body(settings.material, parameters);
  for (const auto& [parameter, value] : settings.parameters) {
    if (!std::isfinite(value))
      throw input_error("{} is {}, which is not a finite number", parameter, to_text(value));
    require_computable(parameter, value);
    if (take_indexed(parameters, parameter, value, id)) continue;
    const auto it = std::ranges::find(all_named, parameter, &Named::name);
    if (it == all_named.end()) {
      std::vector<std::string> known;
      for (const Named& each : all_named) known.emplace_back(each.name);
      for (const std::string_view each : nodal_force_names) known.push_back(fmt::format("{}:SET", each));
      throw input_error("unknown parameter '{}' of tissue; {}", parameter, suggestion(parameter, known));
    }
    if (value != TissueParameters{}.*(it->value)) require_read(parameter, it->of, id);
    parameters.*(it->value) = value;
  }
  take_materials_of_regions(settings.material, id, parameters);
  const auto is_set = [&](std::string_view name) {
    return std::ranges::find(settings.parameters, name, &std::pair<std::string, double>::first) !=
           settings.parameters.end();
  };
  if (std::ranges::any_of(gravity_names, is_set) && !is_set("g")) parameters.g = 0;
  if (std::ranges::any_of(tool_direction_names, is_set) && parameters.tool_dx == 0 &&
      parameters.tool_dy == 0 && parameters.tool_dz == 0)
    throw InputError(
        "tool_dx, tool_dy and tool_dz are all 0, which is no direction; give a vector like 0,-1,0");
  if (!parameters.supports.empty() && !is_set(support_name)) parameters.support = 0;
  if (!parameters.supports.empty() && (parameters.support != 0 || parameters.has_box()))
    throw InputError(
        "--support names the sets of points that are held; give a box as such a set too, and leave out support, "
        "the share of an end");
  if (!(parameters.support >= 0 && parameters.support < 1))
    throw input_error("support is {} but must be a share of the body, at least 0 and below 1",
                      to_text(parameters.support));
  if (const double axis = std::abs(parameters.axis); axis != 1 && axis != 2 && axis != 3)
    throw input_error(
        "axis is {} but must be 1, 2 or 3 for the low end along x, y or z, or -1, -2 or -3 for the high one",
        to_text(parameters.axis));
  if (!(parameters.mass_step >= 0))
    throw input_error("mass_step is {} s but must be a step, or 0 for the masses as they are",
                      to_text(parameters.mass_step));
  if (parameters.equal_masses != 0 && parameters.equal_masses != 1)
    throw input_error(
        "equal_masses is {} but must be 1, the same mass at every point, or 0, by the volume around it",
        to_text(parameters.equal_masses));
  require_acting(id, parameters, settings);
  return parameters;
}

std::vector<std::pair<std::string, double>> named_values(const TissueParameters& parameters) {
  std::vector<std::pair<std::string, double>> values;
  for (const Named& each : all_named)
    if (const double value = parameters.*each.value;
        each.everybody || value != TissueParameters{}.*each.value)
      values.emplace_back(each.name, value);
  for (const auto& [what, region, value, from_material] : parameters.of_regions)
    values.emplace_back(
        fmt::format("{}:{}", std::ranges::find(named_of_region, what, &NamedOfRegion::value)->name, region),
        value);
  for (const std::string& set : parameters.supports)
    values.emplace_back(fmt::format("{}:{}", support_name, set), 1);
  for (const auto& [axis, set, value] : parameters.nodal_forces)
    values.emplace_back(fmt::format("{}:{}", nodal_force_names.at(static_cast<std::size_t>(axis)), set),
                        value);
  for (const auto& [strain, phi] : parameters.table)
    values.emplace_back(fmt::format("{}:{}", table_name, to_text(strain)), phi);
  return values;
}

std::string_view unit_of_tissue_parameter(std::string_view name) {
  const std::string_view what = name.substr(0, name.find(':'));
  if (std::ranges::find(nodal_force_names, what) != nodal_force_names.end()) return "N";
  const auto* const named = std::ranges::find(all_named, what, &Named::name);
  return named == all_named.end() ? "1" : named->unit;
}

std::vector<std::string> idle_parameters(const TissueId& id, const TissueParameters& parameters) {
  // What is switched on by a number says nothing where that is 0.
  constexpr std::array<std::string_view, 2> switches{"mass", "equal_masses"};
  std::vector<std::string> idle;
  for (const auto& [name, value] : named_values(parameters)) {
    const auto named = std::ranges::find(all_named, name, &Named::name);
    const bool read = named == all_named.end() || is_read(named->of, id);
    const bool off = value == 0 && std::ranges::find(switches, name) != switches.end();
    if (!read || off || !why_idle(id, parameters, name).empty()) idle.push_back(name);
  }
  return idle;
}

bool has_default_material(const ProblemSettings& settings) {
  return settings.material.empty() && std::ranges::none_of(settings.parameters, [](const auto& parameter) {
           const std::string_view what =
               std::string_view(parameter.first).substr(0, parameter.first.find(':'));
           return what == "E" || what == "k";
         });
}

bool has_default_support(const ProblemSettings& settings) {
  constexpr std::array<std::string_view, 8> chosen{
      "axis", "support_stiffness", "xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  return std::ranges::none_of(settings.parameters, [&](const auto& parameter) {
    const auto& [name, value] = parameter;
    if (name == "support_stiffness" && value == 0) return false;  // as by default
    return std::ranges::find(chosen, name) != chosen.end() ||
           name.starts_with(fmt::format("{}:", support_name)) || (name == support_name && value == 0);
  });
}

TissueSettings tissue_settings(const TissueId& id, const TissueParameters& p, const LoadedMesh& loaded) {
  const TetMesh& mesh = loaded.mesh;
  require_sensible(id, p, mesh);
  TissueSettings settings{.model = tissue_model(id.model),
                          .materials = {{.young = p.E,
                                         .poisson = p.nu,
                                         .density = p.rho,
                                         .fibre_young = p.fibre_E,
                                         .fibre_x = p.fibre_x,
                                         .fibre_y = p.fibre_y,
                                         .fibre_z = p.fibre_z}},
                          .alpha = p.alpha,
                          .beta = p.beta};
  if (p.mass != 0) settings.total_mass = p.mass;
  settings.equal_masses = p.equal_masses != 0;
  settings.mass_step = p.mass_step;
  settings.springs = {.stiffness = p.k,
                      .damper_time = p.damper,
                      .surface_bending = p.bending,
                      .second_ring = p.second_ring,
                      .doubled_skin = p.doubled_skin};
  if (p.cubic != 0) settings.springs.law = CubicSpring{p.cubic};
  if (p.exponential != 0) settings.springs.law = ExponentialSpring{p.exponential};
  if (!p.table.empty()) settings.springs.law = law_of_table(p.table);
  if (p.skin != 0)
    settings.skin = {.kind = id.is_of_springs() ? SkinSettings::Kind::springs : SkinSettings::Kind::membrane,
                     .young = p.skin * p.E,
                     .thickness = p.skin_thickness};
  if (p.inclusion != 0) {
    settings.materials.resize(static_cast<std::size_t>(region_count(mesh)), settings.materials.front());
    for (std::size_t region = 1; region < settings.materials.size(); ++region)
      settings.materials[region].young *= p.inclusion;
  }
  set_materials_of_regions(p, loaded, settings.materials);
  const HeldEnd end(p.axis);
  set_supports(p, loaded, settings);

  if (id.load == "gravity") {
    settings.gravity = {p.gx, p.gy, p.gz - p.g};
  } else if (id.load == "breathing") {
    // The end that hangs on the diaphragm goes to and fro with it.
    settings.supports.front().travel = p.depth * end.towards;
    settings.supports.front().profile = {.kind = TimeProfile::Kind::sine,
                                         .omega = 2 * std::numbers::pi / p.period};
  } else if (id.load == "tool") {
    const double young = std::ranges::max(settings.materials, {}, &TissueMaterial::young).young;
    settings.tools.push_back(tool_of(p, mesh, end, young));
  } else {
    settings.forces.push_back(pressing_force(id.load == "press" ? p.force : -p.force, mesh, end));
  }
  std::ranges::move(nodal_forces(p, loaded), std::back_inserter(settings.forces));
  return settings;
}

}  // namespace hmax
