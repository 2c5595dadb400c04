#include "catalogue/models/body_summary.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "problems/mesh/ten_node.hpp"

namespace hmax {

namespace {

/// What lies outside is a slip in units rather than a body: E and densities from fat and inflated lung to
/// instruments of steel, fibres up to bone, skins up to soft ligaments, sizes from an insect to a man.
struct Usual {
  const char *name, *unit, *hint;
  double least, most;
};
constexpr Usual usual_young{"E", "Pa", "5.5 kPa are 5500 Pa", 50, 5e11};
constexpr Usual usual_fibres{"fibre_E", "Pa", "20 kPa are 20000 Pa", 50, 5e10};
constexpr Usual usual_density{"rho", "kg/m^3", "1.06 g/cm^3 are 1060 kg/m^3", 50, 1e4};
constexpr Usual usual_density_from_mass{"the density that mass and mesh make", "kg/m^3",
                                        "check --unit of the mesh, and the mass of the material", 50, 1e4};
constexpr Usual usual_skin{"E of the skin", "Pa", "skin is a factor of E, such as 1000", 50, 3e8};
constexpr Usual usual_size{"the longest side of the body", "m", "state the unit of the mesh with --unit",
                           5e-4, 3};
constexpr Usual usual_gravity{"gravity", "m/s^2", "9810 mm/s^2 are 9.81 m/s^2", 1e-2, 1e3};

std::string rounded(double value) { return fmt::format("{:.4g}", value); }

std::string rounded(const BodySummary::Span& span) {
  return span[0] == span[1] ? rounded(span[0]) : fmt::format("{} to {}", rounded(span[0]), rounded(span[1]));
}

void judge(const Usual& usual, double value, std::vector<std::string>& sentences) {
  if (value >= usual.least && value <= usual.most) return;
  sentences.push_back(fmt::format("{} is {} {}, usual are {} to {} {}; {}", usual.name, rounded(value),
                                  usual.unit, rounded(usual.least), rounded(usual.most), usual.unit,
                                  usual.hint));
}

/// What a body of this size cannot stand: to be moved, or touched by a tool, of more than its length; a force
/// that would strain it by more than 1.
void judge_loads(const BodySummary& summary, std::vector<std::string>& sentences) {
  const double longest = summary.size.maxCoeff(), crushing = summary.young[1] * longest * longest;
  const auto too_much = [&](const char* name, double value, const char* unit, double most, const char* why) {
    if (value > most)
      sentences.push_back(fmt::format(
          "{} is {} {}, more than {} ({} {}); give {}", name, rounded(value), unit, why, rounded(most), unit,
          std::string_view(unit) == "m" ? "metres: 10 mm are 0.01 m" : "newtons: 500 mN are 0.5 N"));
  };
  too_much("depth", summary.travel, "m", longest, "the longest side of the body");
  too_much("tool_radius", summary.tool_radius, "m", longest, "the longest side of the body");
  // Where E is a slip, E is what is wrong and not the force.
  if (summary.young[0] >= usual_young.least)
    too_much("force", summary.force, "N", crushing, "E times the square of its longest side");
}

void judge_added_mass(const BodySummary& summary, std::vector<std::string>& sentences) {
  const double share = summary.added_mass / summary.mass;
  if (share > usual_added_mass)
    sentences.push_back(fmt::format(
        "mass_step adds {} kg to a body of {} kg ({:.3g} %), and frequencies of slow modes fall by up to {:.2g} %; take a smaller "
        "mass_step, or an implicit method",
        rounded(summary.added_mass), rounded(summary.mass), 100 * share, 100 * slowed_by(share)));
}

void judge_locking(const BodySummary& summary, std::vector<std::string>& sentences) {
  if (!summary.locks || summary.poisson[1] < locking_from) return;
  const auto other = std::ranges::find(tissue_models(), true, &TissueModel::resists_locking);
  sentences.push_back(fmt::format(
      "nu is {}, and linear tetrahedra lock from {} on: they are too stiff by volumetric locking; take --model {}, or nu 0.45",
      rounded(summary.poisson[1]), rounded(locking_from), other->id));
}

/// Where a number is a slip, the slip is what is wrong.
void judge_compression(const BodySummary& summary, std::vector<std::string>& sentences) {
  if (!sentences.empty() || summary.skin > 0 || summary.most_compression <= 0 ||
      summary.weight_compression <= summary.most_compression)
    return;
  const auto other = std::ranges::find(tissue_models(), true, &TissueModel::resists_crushing);
  sentences.push_back(fmt::format(
      "this model carries at most {} Pa of compression; the weight above the support needs {} Pa; "
      "--model {} restores inverted elements",
      rounded(summary.most_compression), rounded(summary.weight_compression), other->id));
}

/// rho g L of the part above the points that are fixed or that springs hold.
double weight_above(const TetMesh& mesh, const std::vector<TetMesh::Index>& held, double density,
                    const Eigen::Vector3d& gravity) {
  if (held.empty() || gravity.isZero(0)) return 0;
  const Eigen::RowVectorXd potential = -gravity.transpose() * mesh.points;  // g times the height
  return density * (potential.maxCoeff() - potential(held).maxCoeff());
}

}  // namespace

double slowed_by(double added_share) { return 1 - 1 / std::sqrt(1 + added_share); }

BodySummary summary_of(const TetMesh& mesh, const TissueSettings& settings) {
  const auto region_count = [](const TetMesh& of) {
    return of.regions.empty() ? std::size_t{1} : static_cast<std::size_t>(std::ranges::max(of.regions)) + 1;
  };
  const std::vector<TissueMaterial>& materials = settings.materials;
  const auto span = [&](double TissueMaterial::*what) {
    const auto [least, most] = std::ranges::minmax(materials, {}, what);
    return BodySummary::Span{least.*what, most.*what};
  };
  // Points that are fixed, and those that are fixed or that springs hold; each once, rising.
  std::set<TetMesh::Index> fixed, held;
  for (const Support& support : settings.supports) fixed.insert(support.points.begin(), support.points.end());
  held = fixed;
  for (const ElasticSupport& support : settings.elastic_supports)
    for (std::size_t i = 0; i < support.points.size(); ++i)
      if (support.stiffness.at(i) > 0) held.insert(support.points[i]);
  BodySummary summary{.young = span(&TissueMaterial::young),
                      .poisson = span(&TissueMaterial::poisson),
                      .density = span(&TissueMaterial::density),
                      .fibre_young = span(&TissueMaterial::fibre_young),
                      .regions = std::max(materials.size(), region_count(mesh)),
                      .size = mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff(),
                      .points = mesh.point_count(),
                      .held = static_cast<Eigen::Index>(fixed.size()),
                      .on_springs = static_cast<Eigen::Index>(held.size() - fixed.size()),
                      .gravity = settings.gravity};
  for (const SphereTool& tool : settings.tools) {
    summary.travel = std::max(summary.travel, tool.travel.norm());
    summary.tool_radius = std::max(summary.tool_radius, tool.radius);
  }
  for (const Support& support : settings.supports)
    summary.travel = std::max(summary.travel, support.travel.norm());
  for (const PressingForce& load : settings.forces)
    summary.force = std::max(summary.force, load.force.norm());
  if (settings.skin.kind != SkinSettings::Kind::none) summary.skin = settings.skin.young;
  summary.of_elements = !settings.model.is_of_springs();
  summary.locks = summary.of_elements && !settings.model.resists_locking;
  if (!summary.of_elements) {
    summary.poisson.fill(poisson_of_springs);
    summary.spring = settings.springs.stiffness;
  }
  double volume = 0, mass = 0;
  for (Eigen::Index e = 0; e < mesh.element_count(); ++e) {
    const double of_element = element_volume(mesh, e);
    volume += of_element;
    mass += of_element *
            materials[materials.size() == 1 ? 0 : static_cast<std::size_t>(mesh.region(mesh.first_part(e)))]
                .density;
  }
  summary.mass = settings.total_mass.value_or(mass);
  summary.from_mass = settings.total_mass.has_value();
  if (summary.from_mass) summary.density.fill(summary.mass / volume);
  summary.most_compression = settings.model.most_compression * summary.young[0];
  summary.weight_compression =
      weight_above(mesh, {held.begin(), held.end()}, summary.density[1], settings.gravity);
  return summary;
}

BodySummary summary_of(const TissueBody& body) {
  BodySummary summary = summary_of(body.mesh(), body.settings());
  const Eigen::VectorXd added = body.added_mass();
  summary.added_mass = added.sum();
  summary.heavier = (added.array() > 0).count();
  return summary;
}

std::string in_words(const BodySummary& summary) {
  const Eigen::Vector3d mm = 1000 * summary.size;
  const std::string added =
      summary.heavier > 0
          ? fmt::format("; mass_step adds {} kg to {} of them, {:.3g} % of the mass",
                        rounded(summary.added_mass), summary.heavier, 100 * summary.added_mass / summary.mass)
          : "";
  const std::string on_springs =
      summary.on_springs > 0 ? fmt::format(", {} held by springs", summary.on_springs) : "";
  const std::string fibres =
      summary.fibre_young[1] > 0 ? fmt::format(", fibres of {} Pa", rounded(summary.fibre_young)) : "";
  const std::string stiffness =
      summary.spring > 0 ? fmt::format("springs of {} N/m", rounded(summary.spring))
                         : fmt::format("E {} Pa, nu {}", rounded(summary.young), rounded(summary.poisson));
  return fmt::format("{}, {} kg/m^3{}{}; {} kg in a box of {} x {} x {} mm; {} of {} nodes fixed{}{}",
                     stiffness, rounded(summary.density),
                     summary.regions > 1 ? fmt::format(" in {} regions", summary.regions) : "", fibres,
                     rounded(summary.mass), rounded(mm.x()), rounded(mm.y()), rounded(mm.z()), summary.held,
                     summary.points, on_springs, added);
}

std::vector<std::string> unusual_values(const BodySummary& summary) {
  std::vector<std::string> sentences;
  for (const double E : summary.young)
    if (sentences.empty()) judge(usual_young, E, sentences);
  if (summary.fibre_young[1] > 0) judge(usual_fibres, summary.fibre_young[1], sentences);
  const std::size_t before = sentences.size();
  for (const double rho : summary.density)
    if (sentences.size() == before)
      judge(summary.from_mass ? usual_density_from_mass : usual_density, rho, sentences);
  if (summary.skin > 0) judge(usual_skin, summary.skin, sentences);
  judge(usual_size, summary.size.maxCoeff(), sentences);
  if (const double g = summary.gravity.norm(); g > 0) judge(usual_gravity, g, sentences);
  judge_loads(summary, sentences);
  judge_added_mass(summary, sentences);
  judge_locking(summary, sentences);
  judge_compression(summary, sentences);
  return sentences;
}

}  // namespace hmax
