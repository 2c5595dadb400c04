#include "bench/tissue_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <ranges>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "analysis/linear_model.hpp"
#include "analysis/modal_motion.hpp"
#include "bench/mesh_choice.hpp"
#include "bench/suggest.hpp"
#include "problems/tissue/body.hpp"
#include "problems/tissue/materials.hpp"
#include "problems/tissue/topology.hpp"
#include "results/errors.hpp"
#include "results/numbers.hpp"

namespace hmax {

namespace {

constexpr std::array<std::string_view, 5> models{"fem_green", "fem_cauchy", "fem_corotational",
                                                 "fem_neo_hookean", "mass_spring"};
constexpr std::array<std::string_view, 5> loads{"gravity", "press", "pull", "tool", "breathing"};

/// "fem_green/press@liver" in its parts; the load may be missing.
struct TissueId {
  std::string model, load, mesh;

  explicit TissueId(const std::string& id) {
    const std::size_t at = id.find('@');
    model = id.substr(0, at);
    mesh = id.substr(at + 1);
    const std::size_t slash = model.find('/');
    load = slash == std::string::npos ? std::string(loads.front()) : model.substr(slash + 1);
    model.resize(std::min(slash, model.size()));
  }
};

void require_known(std::string_view what, const std::string& word, std::span<const std::string_view> known) {
  if (std::ranges::find(known, word) != known.end()) return;
  throw InputError(fmt::format("unknown {} '{}'; {}", what, word,
                               suggestion(word, std::vector<std::string>(known.begin(), known.end()))));
}

constexpr double infinity = std::numeric_limits<double>::infinity();

/// What a user may set of a body on a mesh.
struct TissueParameters {
  double E = TissueMaterial{}.young, nu = TissueMaterial{}.poisson, rho = TissueMaterial{}.density;
  double mass = 0;             ///< of the whole body [kg]; 0: by the density
  double alpha = 0, beta = 0;  ///< Rayleigh [1/s], [s]
  double damper = 0;           ///< of springs: c / k [s]
  double g = 9.81;             ///< along -z [m/s^2], under the load gravity
  double force = 0.5;          ///< towards the held end or away from it, of press and pull [N]
  double depth = 0.01;      ///< that the tool moves into the body in its first half second, or that the held
                            ///< end moves to and fro, of breathing [m]
  double period = 4;        ///< of breathing [s]
  double support = 0.1;     ///< share of the body along the axis that is held
  double axis = 3;          ///< 1, 2, 3: held at its low end along x, y, z; -1, -2, -3: at its high end
  double equal_masses = 0;  ///< 1: every point has the same mass
  // What a body has only when it is asked for.
  double inclusion = 0;                    ///< E of every region of the mesh but the first, over E
  double skin = 0, skin_thickness = 1e-4;  ///< E of a skin over E, [m]
  double k = 0;                            ///< of the springs on the edges; 0: from E [N/m]
  double cubic = 0, exponential = 0;       ///< b of such springs
  double bending = 0, second_ring = 0, doubled_skin = 0;  ///< further springs, relative to the edges
  /// Box whose points are held, instead of a share of an end [m].
  double xmin = -infinity, xmax = infinity, ymin = -infinity, ymax = infinity, zmin = -infinity,
         zmax = infinity;

  [[nodiscard]] bool has_box() const {
    return std::ranges::any_of(std::array{-xmin, xmax, -ymin, ymax, -zmin, zmax},
                               [](double side) { return side < infinity; });
  }
};
constexpr std::array<std::pair<std::string_view, double TissueParameters::*>, 29> parameter_names{{
    {"E", &TissueParameters::E},
    {"nu", &TissueParameters::nu},
    {"rho", &TissueParameters::rho},
    {"mass", &TissueParameters::mass},
    {"alpha", &TissueParameters::alpha},
    {"beta", &TissueParameters::beta},
    {"damper", &TissueParameters::damper},
    {"g", &TissueParameters::g},
    {"force", &TissueParameters::force},
    {"depth", &TissueParameters::depth},
    {"support", &TissueParameters::support},
    {"axis", &TissueParameters::axis},
    {"equal_masses", &TissueParameters::equal_masses},
    {"period", &TissueParameters::period},
    {"inclusion", &TissueParameters::inclusion},
    {"skin", &TissueParameters::skin},
    {"skin_thickness", &TissueParameters::skin_thickness},
    {"k", &TissueParameters::k},
    {"cubic", &TissueParameters::cubic},
    {"exponential", &TissueParameters::exponential},
    {"bending", &TissueParameters::bending},
    {"second_ring", &TissueParameters::second_ring},
    {"doubled_skin", &TissueParameters::doubled_skin},
    {"xmin", &TissueParameters::xmin},
    {"xmax", &TissueParameters::xmax},
    {"ymin", &TissueParameters::ymin},
    {"ymax", &TissueParameters::ymax},
    {"zmin", &TissueParameters::zmin},
    {"zmax", &TissueParameters::zmax},
}};
/// Of those the ones that every body has, first.
constexpr std::size_t common_parameters = 13;

/// Squares of rates and of forces must stay numbers, whatever masses and stiffnesses come together.
void require_computable(std::string_view name, double value) {
  constexpr double least = 1e-30, most = 1e30;
  const double size = std::abs(value);
  if (size == 0 || (size >= least && size <= most)) return;
  throw InputError(fmt::format(
      "{} is {}, and computing with it would leave the range of numbers; give it in SI units, between {} and {}",
      name, to_text(value), to_text(least), to_text(most)));
}

TetMesh::Index region_count(const TetMesh& mesh) {
  return mesh.regions.empty() ? 1 : std::ranges::max(mesh.regions) + 1;
}

/// One end of a mesh along an axis, to which loads are opposite.
struct HeldEnd {
  Eigen::Vector3d towards = Eigen::Vector3d::Zero();  ///< unit vector that points from the free end to it

  explicit HeldEnd(double axis) { towards[static_cast<int>(std::abs(axis)) - 1] = axis > 0 ? -1 : 1; }
  explicit HeldEnd(Eigen::Vector3d direction) : towards(std::move(direction)) {}

  /// Points within `share` of the extent of the mesh from the held end.
  [[nodiscard]] std::vector<TetMesh::Index> points(const TetMesh& mesh, double share) const {
    const Eigen::RowVectorXd along = towards.transpose() * mesh.points;
    const double far = along.maxCoeff(), reach = share * (far - along.minCoeff());
    std::vector<TetMesh::Index> held;
    for (TetMesh::Index i = 0; i < mesh.point_count(); ++i)
      if (along[i] >= far - reach) held.push_back(i);
    return held;
  }

  /// The middle one of the points that are farthest from it.
  [[nodiscard]] TetMesh::Index opposite(const TetMesh& mesh) const {
    std::vector<TetMesh::Index> far = HeldEnd(-towards).points(mesh, 0.02);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const TetMesh::Index i : far) middle += mesh.points.col(i) / static_cast<double>(far.size());
    return *std::ranges::min_element(
        far, {}, [&](TetMesh::Index i) { return (mesh.points.col(i) - middle).squaredNorm(); });
  }
};

/// A body shared by everybody who looks at it, with the Jacobian of its first-order form.
struct SharedBody {
  using State = TissueBody::State;
  using Dofs = TissueBody::Dofs;
  using DofMatrix = TissueBody::DofMatrix;
  using Jacobian = Eigen::SparseMatrix<double>;

  std::shared_ptr<const TissueBody> body;
  static constexpr bool linear_stiff_part = true;

  explicit SharedBody(std::shared_ptr<const TissueBody> shared) : body(std::move(shared)) {}

  [[nodiscard]] Eigen::Index dim() const { return body->dim(); }
  [[nodiscard]] Eigen::Index dofs() const { return body->dofs(); }
  [[nodiscard]] bool is_autonomous() const { return body->is_autonomous(); }
  [[nodiscard]] const Dofs& mass() const { return body->mass(); }
  void rhs(double t, const State& y, State& dydt) const { body->rhs(t, y, dydt); }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const { body->force(t, q, v, f); }
  void stiffness(double t, const Dofs& q, const Dofs& v, DofMatrix& K) const { body->stiffness(t, q, v, K); }
  void damping(double t, const Dofs& q, const Dofs& v, DofMatrix& C) const { body->damping(t, q, v, C); }
  [[nodiscard]] double spectral_radius(double t, const State& y) const { return body->spectral_radius(t, y); }

  /// J = ( 0, I; -M^-1 K, -M^-1 C ), shape (2 n, 2 n).
  void jacobian(double t, const State& y, Jacobian& J) const {
    const Eigen::Index n = dofs();
    DofMatrix K, C;
    const Dofs q = y.head(n), v = y.tail(n);
    body->stiffness(t, q, v, K);
    body->damping(t, q, v, C);
    pack(K, C, J);
  }

  /// f = (v, -M^-1 (K0 q + C0 v)) + the rest, which holds loads and what is not linear.
  void rhs_stiff(double, const State& y, State& dydt) const {
    const Eigen::Index n = dofs();
    const auto& [K, C] = rest();
    dydt.head(n) = y.tail(n);
    dydt.tail(n).noalias() = -(K * y.head(n));
    dydt.tail(n).noalias() -= C * y.tail(n);
    dydt.tail(n).array() /= mass().array();
  }
  void rhs_nonstiff(double t, const State& y, State& dydt) const {
    State stiff(y.size());
    rhs_stiff(t, y, stiff);
    body->rhs(t, y, dydt);
    dydt -= stiff;
  }
  void jacobian_stiff(double, const State&, Jacobian& J) const { pack(rest().first, rest().second, J); }

 private:
  /// K and C at rest: the stiff part of a body is its motion at small strain. Made when somebody asks.
  [[nodiscard]] const std::pair<DofMatrix, DofMatrix>& rest() const {
    std::call_once(at_rest_->made, [&] {
      const Dofs zero = Dofs::Zero(dofs());
      body->stiffness(0, zero, zero, at_rest_->matrices.first);
      body->damping(0, zero, zero, at_rest_->matrices.second);
    });
    return at_rest_->matrices;
  }

  void pack(const DofMatrix& K, const DofMatrix& C, Jacobian& J) const {
    const Eigen::Index n = dofs();
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(n + K.nonZeros() + C.nonZeros()));
    for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(i, n + i, 1);
    const auto put = [&](const DofMatrix& matrix, Eigen::Index column) {
      for (Eigen::Index j = 0; j < n; ++j)
        for (DofMatrix::InnerIterator entry(matrix, j); entry; ++entry)
          entries.emplace_back(n + entry.row(), column + j, -entry.value() / mass()[entry.row()]);
    };
    put(K, 0);
    put(C, n);
    J.resize(2 * n, 2 * n);
    J.setFromTriplets(entries.begin(), entries.end());
  }

  struct AtRest {
    std::once_flag made;
    std::pair<DofMatrix, DofMatrix> matrices;
  };
  std::shared_ptr<AtRest> at_rest_ = std::make_shared<AtRest>();
};

/// @throws InputError  when what is asked for is not that of the model, the mesh or the load
void require_sensible(const TissueId& id, const TissueParameters& p, const TetMesh& mesh) {
  const auto refuse_negative = [](std::string_view name, double value) {
    if (value < 0) throw InputError(fmt::format("{} is {} but must not be negative", name, to_text(value)));
  };
  const std::array<std::pair<std::string_view, double>, 6> of_springs{{{"k", p.k},
                                                                       {"cubic", p.cubic},
                                                                       {"exponential", p.exponential},
                                                                       {"bending", p.bending},
                                                                       {"second_ring", p.second_ring},
                                                                       {"doubled_skin", p.doubled_skin}}};
  for (const auto& [name, value] : of_springs) {
    refuse_negative(name, value);
    if (value != 0 && id.model != "mass_spring")
      throw InputError(
          fmt::format("{} is of springs, and {} has none; leave it out or take mass_spring", name, id.model));
  }
  if (p.cubic != 0 && p.exponential != 0)
    throw InputError("cubic and exponential are two laws of the same springs; choose one of them");
  refuse_negative("inclusion", p.inclusion);
  refuse_negative("skin", p.skin);
  for (const auto& [name, value] : {std::pair("skin_thickness", p.skin_thickness), {"period", p.period}})
    if (!(value > 0)) throw InputError(fmt::format("{} is {} but must be positive", name, to_text(value)));
  if (p.inclusion != 0 && region_count(mesh) < 2)
    throw InputError(fmt::format(
        "inclusion is for meshes of several regions, and {} has one; `hmax mesh info` counts them", id.mesh));
  if (id.load == "breathing" && p.support == 0 && !p.has_box())
    throw InputError(
        "breathing moves the held end, and with support = 0 nothing is held; give support a share");
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

TissueSettings settings_of(const TissueId& id, const TissueParameters& p, const TetMesh& mesh) {
  TissueSettings settings{.model = tissue_model(id.model),
                          .materials = {{.young = p.E, .poisson = p.nu, .density = p.rho}},
                          .alpha = p.alpha,
                          .beta = p.beta};
  if (p.mass != 0) settings.total_mass = p.mass;
  settings.equal_masses = p.equal_masses != 0;
  settings.springs = {.stiffness = p.k,
                      .damper_time = p.damper,
                      .surface_bending = p.bending,
                      .second_ring = p.second_ring,
                      .doubled_skin = p.doubled_skin};
  if (p.cubic != 0) settings.springs.law = CubicSpring{p.cubic};
  if (p.exponential != 0) settings.springs.law = ExponentialSpring{p.exponential};
  if (p.skin != 0)
    settings.skin = {
        .kind = id.model == "mass_spring" ? SkinSettings::Kind::springs : SkinSettings::Kind::membrane,
        .young = p.skin * p.E,
        .thickness = p.skin_thickness};
  if (p.inclusion != 0) {
    settings.materials.resize(static_cast<std::size_t>(region_count(mesh)), settings.materials.front());
    for (TissueMaterial& other : settings.materials | std::views::drop(1)) other.young *= p.inclusion;
  }
  const HeldEnd end(p.axis);
  if (p.has_box())
    settings.supports.push_back({.points = points_of_box(p, mesh)});
  else if (p.support > 0)
    settings.supports.push_back({.points = end.points(mesh, p.support)});

  const MeshSurface surface = surface_of(mesh);
  const Eigen::Vector3d tip = mesh.points.col(end.opposite(mesh));
  const double size = (mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff()).norm();
  if (id.load == "gravity") {
    settings.gravity = {0, 0, -p.g};
  } else if (id.load == "breathing") {
    // The end that hangs on the diaphragm goes to and fro with it.
    settings.supports.front().travel = p.depth * end.towards;
    settings.supports.front().profile = {.kind = TimeProfile::Kind::sine,
                                         .omega = 2 * std::numbers::pi / p.period};
  } else if (id.load == "tool") {
    // A sphere that begins where it touches the free end and moves towards the held one.
    SphereTool tool{.points = surface.points, .radius = 0.05 * size};
    tool.start = tip - tool.radius * end.towards;
    tool.travel = p.depth * end.towards;
    tool.profile = {.kind = TimeProfile::Kind::ramp, .start = 0, .rise = 0.5};
    settings.tools.push_back(tool);
  } else {
    // The patch of the surface around the free end.
    PressingForce force{.points = {}, .force = (id.load == "press" ? p.force : -p.force) * end.towards};
    for (const TetMesh::Index i : surface.points)
      if ((mesh.points.col(i) - tip).norm() <= 0.15 * size) force.points.push_back(i);
    settings.forces.push_back(force);
  }
  return settings;
}

/// The exact motion of linear tissue under a load that does not change: the modes of small bodies.
std::function<Eigen::Vector<long double, Eigen::Dynamic>(long double)> exact_motion(
    std::shared_ptr<const TissueBody> body) {
  struct Once {
    std::once_flag flag;
    std::optional<ModalMotion> motion;
  };
  return
      [body, once = std::make_shared<Once>()](long double t) -> Eigen::Vector<long double, Eigen::Dynamic> {
        std::call_once(once->flag, [&] {
          const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body->dofs());
          Eigen::VectorXd force = zero;
          TissueBody::DofMatrix K, C;
          body->force(0, zero, zero, force);
          body->stiffness(0, zero, zero, K);
          body->damping(0, zero, zero, C);
          once->motion.emplace(mechanical_part(body->mass(), K, C), force, body->y0());
        });
        return once->motion->at(static_cast<double>(t)).cast<long double>();
      };
}

/// Beyond this the eigenvectors of a dense matrix take minutes.
constexpr Eigen::Index most_modal_dofs = 1500;

}  // namespace

std::span<const std::string_view> tissue_models() { return models; }
std::span<const std::string_view> tissue_loads() { return loads; }

std::string tissue_id(std::string_view model, std::string_view mesh, std::string_view load) {
  return fmt::format("{}{}@{}", model.empty() ? models.front() : model,
                     load.empty() || load == loads.front() ? "" : fmt::format("/{}", load), mesh);
}

bool is_tissue_id(std::string_view id) { return id.find('@') != std::string_view::npos; }

Problem make_tissue_problem(const std::string& name, const ProblemSettings& settings) {
  const TissueId id(name);
  require_known("model", id.model, models);
  require_known("load", id.load, loads);
  if (!settings.y0.empty())
    throw InputError("--y0 is not for tissue, which starts at rest; choose what moves it with --load");

  TissueParameters parameters;
  // A beam is clamped, a liver hangs from the diaphragm, everything else stands.
  if (id.mesh.starts_with("beam")) parameters.axis = 1;
  if (id.mesh.starts_with("liver")) parameters.axis = -3;
  if (!settings.material.empty()) {
    // The oscillators' names of the same materials serve as well.
    const TissueSettings made = with_tissue_material(
        {}, settings.material.starts_with("liver:") ? settings.material : "liver:" + settings.material);
    parameters.E = made.materials.front().young;
    parameters.nu = made.materials.front().poisson;
    parameters.mass = made.total_mass.value();
    parameters.alpha = made.alpha;
  }
  for (const auto& [parameter, value] : settings.parameters) {
    const auto it =
        std::ranges::find(parameter_names, parameter, [](const auto& known) { return known.first; });
    if (it == parameter_names.end()) {
      std::vector<std::string> known;
      for (const auto& [each, member] : parameter_names) known.emplace_back(each);
      throw InputError(
          fmt::format("unknown parameter '{}' of tissue; {}", parameter, suggestion(parameter, known)));
    }
    if (!std::isfinite(value))
      throw InputError(fmt::format("{} is {}, which is not a finite number", parameter, to_text(value)));
    require_computable(parameter, value);
    parameters.*(it->second) = value;
  }
  if (!(parameters.support >= 0 && parameters.support < 1))
    throw InputError(fmt::format("support is {} but must be a share of the body, at least 0 and below 1",
                                 to_text(parameters.support)));
  if (const double axis = std::abs(parameters.axis); axis != 1 && axis != 2 && axis != 3)
    throw InputError(fmt::format(
        "axis is {} but must be 1, 2 or 3 for the low end along x, y or z, or -1, -2 or -3 for the high one",
        to_text(parameters.axis)));
  if (parameters.equal_masses != 0 && parameters.equal_masses != 1)
    throw InputError(fmt::format(
        "equal_masses is {} but must be 1, the same mass at every point, or 0, by the volume around it",
        to_text(parameters.equal_masses)));

  const LoadedMesh loaded = load_mesh(id.mesh, settings.unit);
  const TetMesh& mesh = loaded.mesh;
  require_sensible(id, parameters, mesh);
  auto body = std::make_shared<const TissueBody>(mesh, settings_of(id, parameters, mesh));
  Problem problem{.id = tissue_id(id.model, id.mesh, id.load),
                  .material = settings.material,
                  .note = fmt::format("{} points, {} tetrahedra, {} degrees of freedom", mesh.point_count(),
                                      mesh.tetrahedron_count(), body->dofs()),
                  .parameters = {},
                  .states = {},
                  .y0 = body->y0(),
                  .t_end = 1,
                  .system = AnySystem(SharedBody{body}),
                  .body = body,
                  .tetrahedron_numbers = loaded.numbers};
  for (std::size_t i = 0; i < parameter_names.size(); ++i) {
    const auto& [each, member] = parameter_names[i];
    if (i < common_parameters || parameters.*member != TissueParameters{}.*member)
      problem.parameters.emplace_back(each, parameters.*member);
  }
  if (id.model == "fem_cauchy" && body->is_autonomous() && body->dofs() <= most_modal_dofs) {
    problem.has_exact_solution = true;
    problem.exact = exact_motion(body);
  }
  return problem;
}

std::string start_in_words(const Problem& problem) { return problem.body ? "rest" : describe(problem.y0); }

}  // namespace hmax
