#include "problems/tissue/positional_body.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "problems/mesh/at.hpp"
#include "problems/tissue/positional/colouring.hpp"

namespace hmax {
namespace {

using Index = TetMesh::Index;

std::vector<Lame> coefficients(const TissueBody& body) {
  std::vector<Lame> all;
  for (const TissueMaterial& material : body.settings().materials)
    all.push_back(lame(material.young, material.poisson));
  return all;
}

}  // namespace

struct PositionalBody::Parts {
  Eigen::VectorXd weight;  ///< [N], shape (dofs)
  std::vector<Index> free;
  DofMatrix damping;            ///< alpha M + beta K0; empty where it is alpha M
  std::vector<double> anchors;  ///< k [N/m] of each free point
  /// The dead loads of each free point, by their numbers, with its shares.
  std::vector<std::vector<std::pair<std::size_t, double>>> pressed;
  std::vector<std::unique_ptr<const PointForces>> forces;
  TissueConstraints constraints;
  Colours point_colours, constraint_colours;
  std::shared_ptr<const Eigen::SparseMatrix<double>> weights;

  explicit Parts(const TissueBody& body) : free(body.free_numbers()) {
    const Eigen::VectorXd heavy = body.point_mass() - body.added_mass();
    weight.resize(body.dofs());
    for (std::size_t i = 0; i < body.free_points().size(); ++i)
      weight.segment<3>(3 * static_cast<Eigen::Index>(i)) =
          heavy[body.free_points()[i]] * body.settings().gravity;
  }

  void add_point_forces(const TissueBody& body) {
    const TissueModel& model = body.settings().model;
    const auto points = static_cast<Index>(body.free_points().size());
    if (model.point_law)
      forces.push_back(point_forces_of_law(*model.point_law, point_tetrahedra(body), points));
    for (const SpringSet& set : body.spring_sets())
      forces.push_back(point_forces_of_springs(point_springs(body, set), set.law(), points));
    pressed.resize(body.free_points().size());
    const std::vector<PressingForce>& loads = body.settings().forces;
    for (std::size_t load = 0; load < loads.size(); ++load)
      for (std::size_t i = 0; i < loads[load].points.size(); ++i)
        if (const Index point = free[at(loads[load].points[i])]; point >= 0)
          pressed[at(point)].emplace_back(load, loads[load].shares[i]);
    anchors.assign(body.free_points().size(), 0);
    for_each_anchor(body, [&](Index point, double stiffness) { anchors[at(point)] += stiffness; });
    if (body.settings().beta != 0) {
      const Eigen::VectorXd still = Eigen::VectorXd::Zero(body.dofs());
      body.damping(0, still, still, damping);
    }
    // Points of one piece act on each other.
    std::vector<std::vector<std::int32_t>> neighbours(body.free_points().size());
    for (const auto& part : forces)
      for (const std::vector<Index>& piece : part->pieces())
        for (const Index a : piece)
          for (const Index b : piece)
            if (a >= 0 && b >= 0) neighbours[at(a)].push_back(b);
    point_colours = greedy_colours(neighbours);
  }

  [[nodiscard]] std::vector<PointTetrahedron> point_tetrahedra(const TissueBody& body) const {
    std::vector<PointTetrahedron> all;
    for_each_tetrahedron(body, [&](const std::array<Index, 4>& points, const RestShape& rest,
                                   const Lame& lame) {
      PointTetrahedron& made = all.emplace_back();
      Eigen::Map<Eigen::Matrix<double, 3, 4>>(made.slopes[0]) << -rest.gradients.colwise().sum().transpose(),
          rest.gradients.transpose();
      made.lambda = lame.lambda * rest.volume, made.mu = lame.mu * rest.volume;
      std::ranges::copy(points, made.point);
    });
    return all;
  }

  [[nodiscard]] std::vector<PointSpring> point_springs(const TissueBody& body, const SpringSet& set) const {
    std::vector<PointSpring> all;
    for (std::size_t i = 0; i < set.size(); ++i) {
      const auto& [a, b] = set.spring(i).points;
      const Eigen::Vector3d d = body.mesh().points.col(b) - body.mesh().points.col(a);
      all.push_back({{d[0], d[1], d[2]}, d.norm(), set.spring(i).stiffness, {free[at(a)], free[at(b)]}});
    }
    return all;
  }

  /// Pairs of points with the weight of their difference; of what is held the other is -1.
  void add_weights(const TissueBody& body) {
    std::vector<Eigen::Triplet<double>> entries;
    const auto couple = [&](Index a, Index b, double k) {
      if (a >= 0) entries.emplace_back(a, a, k);
      if (b >= 0) entries.emplace_back(b, b, k);
      if (a >= 0 && b >= 0) {
        entries.emplace_back(a, b, -k);
        entries.emplace_back(b, a, -k);
      }
    };
    for (const SpringSet& set : body.spring_sets())
      for (std::size_t i = 0; i < set.size(); ++i) {
        const auto& [a, b] = set.spring(i).points;
        couple(free[at(a)], free[at(b)], set.spring(i).stiffness);
      }
    if (!body.settings().model.is_of_springs())
      for_each_tetrahedron(
          body, [&](const std::array<Index, 4>& points, const RestShape& rest, const Lame& lame) {
            Eigen::Matrix<double, 4, 3> slopes;
            slopes << -rest.gradients.colwise().sum(), rest.gradients;
            const Eigen::Matrix4d products = slopes * slopes.transpose();
            const double modulus = (2 * lame.mu + 1.5 * lame.lambda) * rest.volume;
            // |sum_a u_a g_a^T|^2 = -sum_(a < b) g_a.g_b |u_a - u_b|^2, since the slopes add up to 0.
            for (std::size_t a = 0; a < 4; ++a)
              for (std::size_t b = 0; b < a; ++b)
                couple(points[a], points[b],
                       -modulus * products(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)));
          });
    for_each_anchor(body, [&](Index point, double stiffness) { couple(point, -1, stiffness); });
    const auto points = static_cast<Eigen::Index>(body.free_points().size());
    Eigen::SparseMatrix<double> W(points, points);
    W.setFromTriplets(entries.begin(), entries.end());
    weights = std::make_shared<const Eigen::SparseMatrix<double>>(std::move(W));
  }

  /// visit(free points, rest shape, coefficients) of each.
  template <class Visit>
  void for_each_tetrahedron(const TissueBody& body, const Visit& visit) const {
    const TetMesh& mesh = body.mesh();
    const std::vector<Lame> lame = coefficients(body);
    for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
      std::array<Index, 4> corners, points;
      for (std::size_t a = 0; a < 4; ++a) {
        corners[a] = mesh.tetrahedra(static_cast<Eigen::Index>(a), t);
        points[a] = free[at(corners[a])];
      }
      visit(points, RestShape(mesh, corners), lame[at(mesh.region(t))]);
    }
  }

  /// visit(free point, k [N/m]) of each spring that holds one.
  template <class Visit>
  void for_each_anchor(const TissueBody& body, const Visit& visit) const {
    for (const ElasticSupport& support : body.settings().elastic_supports)
      for (std::size_t i = 0; i < support.points.size(); ++i)
        if (const Index point = free[at(support.points[i])]; point >= 0 && support.stiffness[i] > 0)
          visit(point, support.stiffness[i]);
  }

  [[nodiscard]] TissueConstraints constraints_of(const TissueBody& body) const {
    TissueConstraints made;
    const TetMesh& mesh = body.mesh();
    for (const SpringSet& set : body.spring_sets())
      for (std::size_t i = 0; i < set.size(); ++i) {
        const auto& [a, b] = set.spring(i).points;
        const Eigen::Vector3d d = mesh.points.col(b) - mesh.points.col(a);
        made.add(TissueConstraints::Spring{{free[at(a)], free[at(b)]}, d, d.norm(), set.spring(i).stiffness});
      }
    if (!body.settings().model.is_of_springs())
      for_each_tetrahedron(body,
                           [&](const std::array<Index, 4>& points, const RestShape& rest, const Lame& lame) {
                             made.add(TissueConstraints::Tetrahedron(points, rest, lame));
                           });
    for_each_anchor(body, [&](Index point, double stiffness) {
      made.add(TissueConstraints::Anchor{point, stiffness});
    });
    return made;
  }
};

std::string PositionalBody::why_no_pieces(const TissueBody& body) {
  const TissueSettings& settings = body.settings();
  if (!settings.tools.empty())
    return "moves points by elastic forces and loads alone, and a tool touches the body; take another load";
  if (std::ranges::any_of(settings.supports,
                          [](const Support& support) { return !support.travel.isZero(0); }))
    return "takes supports that stand still, and one of them moves; take another load";
  if (settings.skin.kind != SkinSettings::Kind::none)
    return "does not have the forces of a skin; leave the skin out";
  if (std::ranges::any_of(settings.materials,
                          [](const TissueMaterial& each) { return each.fibre_young != 0; }))
    return "does not have the forces of fibres; leave fibre_E out";
  if (std::ranges::any_of(body.spring_sets(), &SpringSet::has_dampers))
    return "does not have the dampers of springs; leave damper out and set alpha, or beta where the "
           "method has it";
  return {};
}

std::string PositionalBody::why_not(const TissueBody& body, PositionalVerbs verbs) {
  if (verbs == PositionalVerbs::forces) return {};
  const TissueModel& model = body.settings().model;
  if (std::string why = why_no_pieces(body); !why.empty()) return why;
  if (verbs != PositionalVerbs::constraints && !model.is_of_springs() && !model.point_law)
    return "moves points of linear tetrahedra and of springs, and " + std::string(model.id) +
           " has others; take another model";
  if (verbs == PositionalVerbs::constraints) {
    if (!model.is_of_springs() && !model.has_constraints)
      return "has the constraints of fem_neo_hookean and of mass_spring, and none of " +
             std::string(model.id) + "; take one of the two";
    if (model.is_of_springs() && !std::holds_alternative<LinearSpring>(body.settings().springs.law))
      return "has constraints of springs with a linear law alone; leave cubic, exponential and phi out";
  }
  return {};
}

TissueConstraints PositionalBody::constraints_of(const TissueBody& body) {
  return Parts(body).constraints_of(body);
}

PointPieces PositionalBody::pieces_of(const TissueBody& body) {
  Parts parts(body);
  parts.add_point_forces(body);
  PointPieces made{.tetrahedra = {}, .springs = {}, .colours = std::move(parts.point_colours)};
  if (!body.settings().model.is_of_springs()) made.tetrahedra = parts.point_tetrahedra(body);
  if (!body.spring_sets().empty()) made.springs = parts.point_springs(body, body.spring_sets().front());
  return made;
}

PositionalBody::PositionalBody(std::shared_ptr<const TissueBody> body, PositionalVerbs verbs)
    : body_(std::move(body)) {
  if (const std::string why = why_not(*body_, verbs); !why.empty())
    throw std::invalid_argument("the method " + why);
  auto parts = std::make_shared<Parts>(*body_);
  if (verbs == PositionalVerbs::points) parts->add_point_forces(*body_);
  if (verbs == PositionalVerbs::constraints) {
    parts->constraints = parts->constraints_of(*body_);
    parts->constraint_colours = parts->constraints.colours();
  }
  if (verbs == PositionalVerbs::weights) parts->add_weights(*body_);
  parts_ = std::move(parts);
}

void PositionalBody::loads(double t, Dofs& f) const {
  f = parts_->weight;
  for (const PressingForce& load : body_->settings().forces) {
    const double factor = load.profile.value(t);
    for (std::size_t i = 0; i < load.points.size(); ++i)
      if (const Index point = parts_->free[at(load.points[i])]; point >= 0)
        f.segment<3>(3 * static_cast<Eigen::Index>(point)) += factor * load.shares[i] * load.force;
  }
}

const std::shared_ptr<const Eigen::SparseMatrix<double>>& PositionalBody::weights() const {
  return parts_->weights;
}

const Colours& PositionalBody::point_colours() const { return parts_->point_colours; }
const Colours& PositionalBody::constraint_colours() const { return parts_->constraint_colours; }

void PositionalBody::point_force(double t, const Dofs& q, const Dofs& v, std::int32_t point,
                                 PointForce& at_point) const {
  const Eigen::Index first = 3 * static_cast<Eigen::Index>(point);
  const Parts& parts = *parts_;
  at_point.f = parts.weight.segment<3>(first);
  at_point.K.setZero();
  at_point.C.setZero();
  for (const auto& part : parts.forces) part->add(q, point, at_point.f, at_point.K);
  for (const auto& [number, share] : parts.pressed[at(point)]) {
    const PressingForce& load = body_->settings().forces[number];
    at_point.f += load.profile.value(t) * share * load.force;
  }
  const double anchor = parts.anchors[at(point)];
  at_point.f -= anchor * q.segment<3>(first);
  at_point.K.diagonal().array() += anchor;
  if (parts.damping.size() == 0) {
    const double c = mass_damping() * mass()[first];
    at_point.f -= c * v.segment<3>(first);
    at_point.C.diagonal().setConstant(c);
    return;
  }
  // Columns of a symmetric matrix are its rows.
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (DofMatrix::InnerIterator entry(parts.damping, first + axis); entry; ++entry) {
      at_point.f[axis] -= entry.value() * v[entry.row()];
      if (entry.row() / 3 == point) at_point.C(entry.row() - first, axis) = entry.value();
    }
}

void PositionalBody::constraints(const Dofs& q, std::span<const std::int32_t> numbers,
                                 std::span<CompliantConstraint> at_q) const {
  parts_->constraints.evaluate(q, numbers, at_q);
}

}  // namespace hmax
