#include "catalogue/models/tissue_problem.hpp"

#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

#include <fmt/format.h>

#include "analysis/spectrum/linear_model.hpp"
#include "analysis/spectrum/modal_motion.hpp"
#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "core/errors.hpp"
#include "core/size_limits.hpp"
#include "problems/linearity.hpp"
#include "problems/mesh/files/mesh_import.hpp"
#include "problems/tissue/body.hpp"

namespace hmax {

namespace {

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
  /// Loads and moving supports are forces b(t).
  [[nodiscard]] Linearity linearity() const {
    return has_linear_forces(*body) ? Linearity::linear : Linearity::nonlinear;
  }
  [[nodiscard]] const Dofs& mass() const { return body->mass(); }
  void rhs(double t, const State& y, State& dydt) const { body->rhs(t, y, dydt); }
  void force(double t, const Dofs& q, const Dofs& v, Dofs& f) const { body->force(t, q, v, f); }
  void stiffness(double t, const Dofs& q, const Dofs& v, DofMatrix& K) const { body->stiffness(t, q, v, K); }
  void damping(double t, const Dofs& q, const Dofs& v, DofMatrix& C) const { body->damping(t, q, v, C); }
  [[nodiscard]] bool admits(const State& y) const { return body->admits(y); }
  void offset(State& X) const { body->offset(X); }
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
  void stiffness_stiff(DofMatrix& K) const { K = rest().first; }
  void damping_stiff(DofMatrix& C) const { C = rest().second; }

 private:
  /// K and C at rest: the stiff part of a body is its motion at small strain. Made when somebody asks.
  [[nodiscard]] const std::pair<DofMatrix, DofMatrix>& rest() const {
    std::call_once(at_rest_->made, [&] {
      const Dofs zero = Dofs::Zero(dofs());
      body->stiffness(0, zero, zero, at_rest_->matrices.first);
      body->damping(0, zero, zero, at_rest_->matrices.second);
      // Most of C is zero, but has the pattern of K.
      at_rest_->matrices.second.prune(0.0);
      at_rest_->matrices.second.data().squeeze();
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

/// The exact motion of linear tissue under a load that does not change: the modes of small bodies.
ModalMotion modal_motion(const TissueBody& body) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.dofs());
  Eigen::VectorXd force = zero;
  TissueBody::DofMatrix K, C;
  body.force(0, zero, zero, force);
  body.stiffness(0, zero, zero, K);
  body.damping(0, zero, zero, C);
  return {mechanical_part(body.mass(), K, C), force, body.y0()};
}

}  // namespace

std::string tissue_id(std::string_view model, std::string_view mesh, std::string_view load) {
  return fmt::format("{}{}@{}", model.empty() ? tissue_models().front().id : model,
                     load.empty() || load == tissue_loads().front() ? "" : fmt::format("/{}", load), mesh);
}

bool has_linear_forces(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  return settings.model.is_linear && settings.tools.empty() && settings.skin.kind == SkinSettings::Kind::none;
}

Problem make_tissue_problem(const std::string& name, const ProblemSettings& settings) {
  const TissueId id(name);
  if (!settings.y0.empty())
    throw InputError("--y0 is not for tissue, which starts at rest; choose what moves it with --load");

  TissueParameters parameters = tissue_parameters(id, settings);
  const LoadedMesh loaded = load_mesh(id.mesh, settings.unit, element_nodes(id));
  const TetMesh& mesh = loaded.mesh;
  // What is listed makes the body again.
  std::erase_if(parameters.of_regions,
                [&, all = parameters](const auto& set) { return is_overridden(set, all, loaded); });
  auto body =
      std::make_shared<const TissueBody>(mesh, tissue_settings(id, parameters, loaded), loaded.origin);
  Problem problem{.id = tissue_id(id.model, id.mesh, id.load),
                  .material = settings.material,
                  .note = fmt::format("{} points, {} tetrahedra{}, {} degrees of freedom", mesh.point_count(),
                                      body->mesh().element_count(),
                                      body->mesh().has_ten_nodes() ? " of ten nodes" : "", body->dofs()),
                  .parameters = named_values(parameters),
                  .idle = idle_parameters(id, parameters),
                  .y0 = body->y0(),
                  .t_end = 1,
                  .system = AnySystem(SharedBody{body}),
                  .body = body,
                  .support_by_default = has_default_support(settings),
                  .material_by_default = has_default_material(settings)};
  const bool is_linear = has_linear_forces(*body);
  if (is_linear && body->is_autonomous() && body->dofs() <= most_modal_dofs) {
    problem.has_exact_solution = true;
    problem.exact = states_of([body] { return modal_motion(*body); });
  }
  return problem;
}

const TissueSettings& settings_of(const Problem& body) { return body.body->settings(); }

double largest_displacement(const Eigen::VectorXd& q) {
  return q.size() == 0 ? 0 : std::sqrt(q.reshaped(3, q.size() / 3).colwise().squaredNorm().maxCoeff());
}

std::int64_t tetrahedron_number(const Problem& problem, Eigen::Index tetrahedron) {
  return problem.body->origin() ? problem.body->origin()->tetrahedron_number(tetrahedron) : tetrahedron + 1;
}

std::int64_t point_number(const Problem& problem, Eigen::Index point) {
  return problem.body->origin() ? problem.body->origin()->point_number(point) : point + 1;
}

Problem with_body(const Problem& problem, std::shared_ptr<const TissueBody> body) {
  Problem changed = problem;
  changed.body = std::move(body);
  changed.system = AnySystem(SharedBody{changed.body});
  return changed;
}

Problem with_settings(const Problem& problem, TissueSettings settings) {
  const TissueBody& body = *problem.body;
  return with_body(problem,
                   std::make_shared<const TissueBody>(body.mesh(), std::move(settings), body.origin()));
}

Problem after_ramps(const Problem& problem) {
  if (!problem.body || problem.body->is_autonomous()) return problem;
  return with_settings(problem, after_ramps(problem.body->settings()));
}

}  // namespace hmax
