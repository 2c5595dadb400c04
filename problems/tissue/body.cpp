#include "problems/tissue/body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <Eigen/Dense>

#include "core/sort_unique.hpp"
#include "problems/digits.hpp"
#include "problems/mesh/at.hpp"
#include "problems/mesh/ten_node.hpp"
#include "problems/tissue/forces/fibres.hpp"
#include "problems/tissue/spring_sets.hpp"

namespace hmax {
namespace {

using Eigen::Vector3d;

double volume_of(const Eigen::Matrix3Xd& x, const TetMesh::Tetrahedra& tetrahedra, Eigen::Index t) {
  Eigen::Matrix3d edges;
  for (Eigen::Index a = 1; a < 4; ++a) edges.col(a - 1) = x.col(tetrahedra(a, t)) - x.col(tetrahedra(0, t));
  return edges.determinant() / 6;
}

void require(bool good, double value, const char* what, const char* rule) {
  if (!good)
    throw std::invalid_argument(std::string(what) + " is " + shortest_digits(value) + " but must be " + rule);
}

MeshEdges both(const MeshEdges& a, const MeshEdges& b) {
  MeshEdges all(2, a.cols() + b.cols());
  all << a, b;
  return all;
}

/// f -= C v of a symmetric C in blocks of 3 x 3, by its columns, which are its rows. The three of a point
/// have one pattern, and their sums do not wait for one another.
void subtract_product(const TissueBody::DofMatrix& C, Eigen::Ref<const Eigen::VectorXd> v,
                      Eigen::Ref<Eigen::VectorXd> f) {
  for (Eigen::Index j = 0; j < C.cols(); j += 3) {
    const int from = C.outerIndexPtr()[j], count = C.outerIndexPtr()[j + 1] - from;
    const int* const rows = C.innerIndexPtr() + from;
    const double* const values = C.valuePtr() + from;
    Vector3d sum = Vector3d::Zero();
    for (int p = 0; p < count; ++p)
      sum += v[rows[p]] * Vector3d(values[p], values[count + p], values[2 * count + p]);
    f.segment<3>(j) -= sum;
  }
}

/// The least p with K <= p D, D the 3 x 3 blocks of K on its diagonal: at most their number. Of ten nodes it
/// is less than half of that; of four it is nearly four.
double over_diagonal_blocks(const Eigen::Ref<const Eigen::MatrixXd>& K) {
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(K.rows(), K.cols());
  for (Eigen::Index a = 0; a < K.rows(); a += 3) D.block<3, 3>(a, a) = K.block<3, 3>(a, a);
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(K, D, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

/// The mesh with the elements that a model takes, of ten nodes or four.
TetMesh with_elements_of(const TissueModel& model, TetMesh mesh) {
  if (model.has_ten_nodes && !mesh.has_ten_nodes() && mesh.tetrahedron_count() > 0)
    throw std::invalid_argument(std::string(model.id) +
                                " takes a mesh of tetrahedra of ten nodes and this one has four; make them "
                                "with ten_node_mesh()");
  if (!model.has_ten_nodes) mesh.ten_node.resize(10, 0);
  return mesh;
}

void check_profile(const TimeProfile& profile) {
  require(profile.kind != TimeProfile::Kind::ramp || profile.rise > 0, profile.rise, "the rise of a ramp",
          "positive");
  require(std::isfinite(profile.start) && std::isfinite(profile.omega), profile.omega,
          "the frequency of a time profile", "finite, as must be its start");
  require(profile.fall >= profile.start, profile.fall, "the fall of a ramp", "at its start or later");
  if (profile.kind == TimeProfile::Kind::samples && !profile.curve)
    throw std::invalid_argument("a time profile of samples has no curve");
}

}  // namespace

TissueBody::TissueBody(const TetMesh& mesh, TissueSettings settings, std::shared_ptr<const MeshOrigin> origin)
    : mesh_(with_elements_of(settings.model, mesh)),
      origin_(std::move(origin)),
      settings_(std::move(settings)) {
  number_free_points();
  distribute_mass();
  build_elastic_parts();
  raise_masses();
  build_rayleigh_damping();
  size_ = (mesh_.points.rowwise().maxCoeff() - mesh_.points.rowwise().minCoeff()).norm();
}

void TissueBody::offset(State& X) const {
  X.setZero(dim());
  if (!needs_positions()) return;
  for (std::size_t i = 0; i < free_points_.size(); ++i)
    X.segment<3>(3 * static_cast<Eigen::Index>(i)) = mesh_.points.col(free_points_[i]).cwiseAbs();
}

void TissueBody::check_points(std::span<const Index> points, const char* what) const {
  for (const Index i : points)
    if (i < 0 || i >= mesh_.point_count())
      throw std::invalid_argument(std::string(what) + " names the point " + std::to_string(i) +
                                  ", but the mesh has the points 0 to " +
                                  std::to_string(mesh_.point_count() - 1));
}

void TissueBody::check_elastic_supports() const {
  for (const ElasticSupport& support : settings_.elastic_supports) {
    check_points(support.points, "an elastic support");
    check_stiffness(support);
  }
}

void TissueBody::number_free_points() {
  check_elastic_supports();
  std::vector<bool> held(at(mesh_.point_count()), false);
  const std::vector<Support>& supports = settings_.supports;
  for (std::size_t end = 1; end <= supports.size(); ++end)
    if (end == supports.size() || supports[end].points != supports[end - 1].points)
      support_ends_.push_back(end);
  for (const Support& support : supports) {
    check_points(support.points, "a support");
    check_profile(support.profile);
    for (const Index i : support.points) held[at(i)] = true;
    if (!support.travel.isZero(0)) steady_from_ = std::max(steady_from_, support.profile.steady_from());
  }
  for (const PressingForce& load : settings_.forces) {
    check_points(load.points, "a force");
    check_profile(load.profile);
    if (load.points.empty())
      throw std::invalid_argument("a force acts on no point; name the points it presses");
    if (!load.shares.empty() && load.shares.size() != load.points.size())
      throw std::invalid_argument("a force has " + std::to_string(load.points.size()) + " points but " +
                                  std::to_string(load.shares.size()) + " shares; give each point one");
    steady_from_ = std::max(steady_from_, load.profile.steady_from());
  }
  for (const SphereTool& tool : settings_.tools) {
    check_profile(tool.profile);
    require(tool.radius > 0, tool.radius, "the radius of a tool", "positive");
    require(tool.stiffness >= 0, tool.stiffness, "the stiffness of a tool", "zero or more");
    require(tool.damping >= 0, tool.damping, "the damping of a tool", "zero or more");
    tools_damp_ = tools_damp_ || tool.damping != 0;
    if (!tool.travel.isZero(0)) steady_from_ = std::max(steady_from_, tool.profile.steady_from());
  }
  // Loads carry the shares of their points as fractions of one.
  for (PressingForce& load : settings_.forces) {
    if (load.shares.empty()) load.shares.assign(load.points.size(), 1);
    double sum = 0;
    for (const double share : load.shares) sum += share;
    require(sum > 0 && std::isfinite(sum), sum, "the sum of the shares of a force", "positive and finite");
    for (double& share : load.shares) share /= sum;
  }
  for (Index i = 0; i < mesh_.point_count(); ++i)
    if (!held[at(i)]) free_points_.push_back(i);
  if (free_points_.empty())
    throw std::invalid_argument("every point of the mesh is supported; leave some of them free");

  std::vector<double> springs(at(mesh_.point_count()), 0);
  for (const ElasticSupport& support : settings_.elastic_supports)
    for (std::size_t i = 0; i < support.points.size(); ++i)
      springs[at(support.points[i])] += support.stiffness[i];
  for (std::size_t i = 0; i < free_points_.size(); ++i)
    if (const double k = springs[at(free_points_[i])]; k > 0)
      anchors_.push_back({free_points_[i], 3 * static_cast<Eigen::Index>(i), k});
}

std::vector<double> TissueBody::breakpoints(double t0, double t1) const {
  std::vector<double> times;
  for (const Support& support : settings_.supports)
    if (!support.travel.isZero(0)) support.profile.add_breakpoints(times);
  for (const PressingForce& load : settings_.forces) load.profile.add_breakpoints(times);
  for (const SphereTool& tool : settings_.tools)
    if (!tool.travel.isZero(0)) tool.profile.add_breakpoints(times);
  std::erase_if(times, [&](double t) { return !(t > t0 && t < t1); });
  sort_unique(times);
  return times;
}

void TissueBody::distribute_mass() {
  auto& materials = settings_.materials;
  const Index regions =
      mesh_.regions.empty() ? 1 : *std::max_element(mesh_.regions.begin(), mesh_.regions.end()) + 1;
  if (materials.size() == 1) materials.resize(at(regions), materials.front());
  if (materials.size() < at(regions))
    throw std::invalid_argument("the mesh has " + std::to_string(regions) + " regions but there are " +
                                std::to_string(materials.size()) +
                                " materials; give one for each, or one for all");
  for (const TissueMaterial& material : materials) {
    lame(material.young, material.poisson);
    require(material.density > 0 && std::isfinite(material.density), material.density, "the density",
            "positive and finite");
  }

  point_mass_ = Eigen::VectorXd::Zero(mesh_.point_count());
  for (Eigen::Index e = 0; e < mesh_.element_count(); ++e) {
    const double volume = mesh_.has_ten_nodes() ? ten_node_volume(ten_places(mesh_, e))
                                                : volume_of(mesh_.points, mesh_.tetrahedra, e);
    const double mass = materials[at(mesh_.region(mesh_.first_part(e)))].density * volume;
    const std::span<const Index> points = mesh_.element(e);
    for (std::size_t a = 0; a < points.size(); ++a) point_mass_[points[a]] += mass * mass_share(mesh_, a);
  }
  if (Eigen::Index lightest = 0; !(point_mass_.minCoeff(&lightest) > 0))
    throw std::invalid_argument("point " + std::to_string(lightest) +
                                " of the mesh has no mass; remove points that are in no tetrahedron");
  if (settings_.equal_masses)
    point_mass_.setConstant(point_mass_.sum() / static_cast<double>(point_mass_.size()));
  if (settings_.total_mass) {
    require(*settings_.total_mass > 0 && std::isfinite(*settings_.total_mass), *settings_.total_mass,
            "the total mass", "positive and finite");
    point_mass_ *= *settings_.total_mass / point_mass_.sum();
  }
}

void TissueBody::raise_masses() {
  heavy_mass_ = point_mass_;
  require(settings_.mass_step >= 0 && std::isfinite(settings_.mass_step), settings_.mass_step,
          "the step that masses are raised for", "zero or more and finite");
  if (settings_.mass_step > 0) {
    // The largest eigenvalue of M^-1 K is at most that of sum_e p_e K_e(a, a) / m_a at one of the points a,
    // with p_e the number of points of element e, or less; the step is 2 / sqrt of it.
    std::vector<Eigen::Matrix3d> blocks(at(mesh_.point_count()), Eigen::Matrix3d::Zero());
    visit_rest_stiffness([&](std::span<const Index> points, const Eigen::Ref<const Eigen::MatrixXd>& K) {
      const double p = mesh_.has_ten_nodes() && points.size() == 10 ? over_diagonal_blocks(K)
                                                                    : static_cast<double>(points.size());
      for (std::size_t a = 0; a < points.size(); ++a)
        blocks[at(points[a])] +=
            p * K.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(a));
    });
    const double kappa = 4 / (settings_.mass_step * settings_.mass_step);
    for (const Index i : free_points_) {
      const Vector3d stiffest =
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(blocks[at(i)], Eigen::EigenvaluesOnly).eigenvalues();
      point_mass_[i] = std::max(point_mass_[i], stiffest[2] / kappa);
    }
  }
  mass_.resize(3 * static_cast<Eigen::Index>(free_points_.size()));
  for (std::size_t i = 0; i < free_points_.size(); ++i)
    mass_.segment<3>(3 * static_cast<Eigen::Index>(i)).setConstant(point_mass_[free_points_[i]]);
}

void TissueBody::build_elastic_parts() {
  const bool springs = settings_.model.is_of_springs();
  const EdgeTable edges = edge_table(mesh_);
  const bool skin = settings_.skin.kind != SkinSettings::Kind::none;
  const bool on_surface = springs || skin || !settings_.tools.empty();
  const MeshSurface surface = on_surface ? surface_of(mesh_) : MeshSurface{};
  MeshEdges pairs = acting_pairs(settings_.model, mesh_, edges);
  if (springs && settings_.springs.surface_bending > 0) pairs = both(pairs, bending_pairs(surface));
  if (springs && settings_.springs.second_ring > 0) pairs = both(pairs, second_ring_pairs(mesh_));

  std::vector<Index> free(at(mesh_.point_count()), -1);
  for (std::size_t i = 0; i < free_points_.size(); ++i) free[at(free_points_[i])] = static_cast<Index>(i);
  pattern_ = BlockPattern(std::move(free), pairs);

  std::vector<Lame> coefficients;
  std::vector<Fibre> fibres;
  for (const TissueMaterial& material : settings_.materials) {
    coefficients.push_back(lame(material.young, material.poisson));
    fibres.push_back({material.fibre_young, {material.fibre_x, material.fibre_y, material.fibre_z}});
    if (springs && material.fibre_young != 0)
      throw std::invalid_argument("fibres lie in finite elements, and " + std::string(settings_.model.id) +
                                  " has none; leave fibre_E out or choose another model");
  }
  if (springs)
    springs_.emplace_back(mesh_.points, tissue_springs(mesh_, edges, surface, settings_),
                          settings_.springs.law, pattern_);
  else
    elements_ = with_fibres(settings_.model.make_elements(mesh_, coefficients, pattern_), mesh_, fibres,
                            settings_.model.is_linear, pattern_);
  const SkinSettings& s = settings_.skin;
  if (skin) {
    lame(s.young, s.poisson);
    require(s.thickness > 0, s.thickness, "the thickness of the skin", "positive");
  }
  if (s.kind == SkinSettings::Kind::membrane)
    membrane_.emplace(mesh_.points, surface.triangles, s.young, s.poisson, s.thickness, pattern_);
  if (s.kind == SkinSettings::Kind::springs)
    springs_.emplace_back(mesh_.points, skin_springs(mesh_, surface, s), LinearSpring{}, pattern_);
  for (const SpringSet& set : springs_) has_dampers_ = has_dampers_ || set.has_dampers();
  for (const SphereTool& tool : settings_.tools)
    contacts_.emplace_back(mesh_.points, surface.triangles, tool);
}

void TissueBody::build_rayleigh_damping() {
  const double alpha = settings_.alpha, beta = settings_.beta;
  require(std::isfinite(alpha), alpha, "the Rayleigh coefficient alpha", "finite");
  require(std::isfinite(beta), beta, "the Rayleigh coefficient beta", "finite");
  if (beta != 0) {
    pattern_.shape(rayleigh_);
    write_elastic_stiffness(rest(), rayleigh_.valuePtr());
    rayleigh_ *= beta;
    for (Eigen::Index i = 0; i < dofs(); ++i) rayleigh_.coeffRef(i, i) += alpha * mass_[i];
  }
  // A support that moves with velocity w drags its neighbours with -beta K0 w.
  for (const Support& support : settings_.supports) {
    Dofs drag = Dofs::Zero(dofs());
    if (beta != 0 && !support.travel.isZero(0) && support.profile.kind != TimeProfile::Kind::steady) {
      std::vector<bool> moved(at(mesh_.point_count()), false);
      for (const Index i : support.points) moved[at(i)] = true;
      visit_rest_stiffness([&](std::span<const Index> points, const Eigen::Ref<const Eigen::MatrixXd>& K) {
        for (std::size_t a = 0; a < points.size(); ++a)
          for (std::size_t b = 0; b < points.size(); ++b)
            if (const Index row = pattern_.free()[at(points[a])]; row >= 0 && moved[at(points[b])])
              drag.segment<3>(Eigen::Index{3} * row) +=
                  beta * K.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(b)) *
                  support.travel;
      });
    }
    support_drag_.push_back(std::move(drag));
  }
}

TissueBody::Scratch& TissueBody::scratch() {
  thread_local Scratch rows;
  return rows;
}

/// Calls visit(point, sum) with the sum of `of` over supports of the same points.
template <class Of, class Visit>
void TissueBody::for_moved_supports(const Of& of, const Visit& visit) const {
  const std::vector<Support>& supports = settings_.supports;
  std::size_t s = 0;
  for (const std::size_t end : support_ends_) {
    const std::vector<Index>& points = supports[s].points;
    Vector3d sum = of(supports[s]);
    while (++s < end) sum += of(supports[s]);
    for (const Index i : points) visit(i, sum);
  }
}

template <class Visit>
void TissueBody::visit_displacements(double t, Eigen::Ref<const Dofs> q, const Visit& visit) const {
  for_moved_supports(
      [&](const Support& support) -> Vector3d { return support.profile.value(t) * support.travel; }, visit);
  for (std::size_t i = 0; i < free_points_.size(); ++i)
    visit(free_points_[i], q.segment<3>(3 * static_cast<Eigen::Index>(i)));
}

void TissueBody::displace(double t, Eigen::Ref<const Dofs> q, NodeRows& u) const {
  u.resize(at(mesh_.point_count()));
  visit_displacements(t, q, [&](Index i, const auto& moved) { as_vector(u[at(i)]) = moved; });
}

void TissueBody::place(double t, Eigen::Ref<const Dofs> q, Scratch& rows) const {
  if (elements_) displace(t, q, rows.u);
  if (!needs_positions()) return;
  rows.x.resize(at(mesh_.point_count()));
  visit_displacements(
      t, q, [&](Index i, const auto& moved) { as_vector(rows.x[at(i)]) = mesh_.points.col(i) + moved; });
}

TissueBody::Scratch TissueBody::rest() const {
  Scratch rows;
  rows.u.assign(at(mesh_.point_count()), {});
  rows.x = node_rows(mesh_.points);
  return rows;
}

void TissueBody::move(double t, Eigen::Ref<const Dofs> v, NodeRows& rows) const {
  rows.resize(at(mesh_.point_count()));
  for_moved_supports(
      [&](const Support& support) -> Vector3d { return support.profile.rate(t) * support.travel; },
      [&](Index i, const Vector3d& velocity) { as_vector(rows[at(i)]) = velocity; });
  for (std::size_t i = 0; i < free_points_.size(); ++i)
    as_vector(rows[at(free_points_[i])]) = v.segment<3>(3 * static_cast<Eigen::Index>(i));
}

void TissueBody::total_force(double t, Eigen::Ref<const Dofs> q, Eigen::Ref<const Dofs> v,
                             Eigen::Ref<Dofs> f) const {
  Scratch& rows = scratch();
  place(t, q, rows);
  rows.f.assign(at(mesh_.point_count()), {});
  if (needs_velocities()) move(t, v, rows.v);

  if (elements_) elements_->add_force(rows.u, rows.f);
  for (const SpringSet& set : springs_) {
    set.add_force(rows.x, rows.f);
    if (set.has_dampers()) set.add_damper_force(rows.x, rows.v, rows.f);
  }
  if (membrane_) membrane_->add_force(rows.x, rows.f);
  for (const PressingForce& load : settings_.forces) {
    const Vector3d force = load.profile.value(t) * load.force;
    for (std::size_t i = 0; i < load.points.size(); ++i)
      as_vector(rows.f[at(load.points[i])]) += load.shares[i] * force;
  }
  for (const ToolContact& contact : contacts_) contact.add_force(t, rows.x, rows.v, rows.f);

  const bool proportional = settings_.beta != 0;
  for (std::size_t i = 0; i < free_points_.size(); ++i) {
    const Index point = free_points_[i];
    const auto dof = 3 * static_cast<Eigen::Index>(i);
    const double mass = point_mass_[point];
    f.segment<3>(dof) = as_vector(rows.f[at(point)]) + heavy_mass_[point] * settings_.gravity;
    if (!proportional) f.segment<3>(dof) -= settings_.alpha * mass * v.segment<3>(dof);
  }
  for (const Anchor& anchor : anchors_)
    f.segment<3>(anchor.dof) -= anchor.stiffness * q.segment<3>(anchor.dof);
  if (!proportional) return;
  if (!v.isZero(0)) subtract_product(rayleigh_, v, f);
  for (std::size_t s = 0; s < support_drag_.size(); ++s)
    if (const double rate = settings_.supports[s].profile.rate(t); rate != 0) f -= rate * support_drag_[s];
}

void TissueBody::force(double t, const Dofs& q, const Dofs& v, Dofs& f) const { total_force(t, q, v, f); }

void TissueBody::rhs(double t, const State& y, State& dydt) const {
  const Eigen::Index n = dofs();
  dydt.head(n) = y.tail(n);
  total_force(t, y.head(n), y.tail(n), dydt.tail(n));
  dydt.tail(n).array() /= mass_.array();
}

void TissueBody::write_elastic_stiffness(const Scratch& rows, double* values) const {
  if (elements_)
    elements_->write_stiffness(rows.u, pattern_, values);
  else
    std::fill_n(values, pattern_.entries(), 0.0);
  for (const SpringSet& set : springs_) set.add_stiffness(rows.x, pattern_, values);
  if (membrane_) membrane_->add_stiffness(rows.x, pattern_, values);
  for (const auto& [point, dof, k] : anchors_)
    pattern_.add(values, pattern_.slot(point, point), point,
                 Eigen::Matrix3d(k * Eigen::Matrix3d::Identity()));
}

void TissueBody::stiffness(double t, const Dofs& q, const Dofs& v, DofMatrix& K) const {
  Scratch& rows = scratch();
  place(t, q, rows);
  pattern_.shape(K);
  write_elastic_stiffness(rows, K.valuePtr());
  if (needs_velocities()) move(t, v, rows.v);
  for (const SpringSet& set : springs_)
    if (set.has_dampers()) set.add_damper_stiffness(rows.x, rows.v, pattern_, K.valuePtr());
  for (const ToolContact& contact : contacts_)
    contact.add_stiffness(t, rows.x, rows.v, pattern_, K.valuePtr());
}

void TissueBody::damping(double t, const Dofs& q, const Dofs& v, DofMatrix& C) const {
  pattern_.shape(C);
  if (settings_.beta != 0) {
    std::copy_n(rayleigh_.valuePtr(), pattern_.entries(), C.valuePtr());
  } else {
    std::fill_n(C.valuePtr(), pattern_.entries(), 0.0);
    for (Eigen::Index i = 0; i < dofs(); ++i) C.coeffRef(i, i) = settings_.alpha * mass_[i];
  }
  if (!needs_velocities()) return;
  Scratch& rows = scratch();
  place(t, q, rows);
  move(t, v, rows.v);
  for (const SpringSet& set : springs_)
    if (set.has_dampers()) set.add_damping(rows.x, pattern_, C.valuePtr());
  for (const ToolContact& contact : contacts_) contact.add_damping(t, rows.x, rows.v, pattern_, C.valuePtr());
}

std::vector<ToolContact::Reach> TissueBody::tool_reaches(double t, const State& y) const {
  Scratch& rows = scratch();
  place(t, y.head(dofs()), rows);
  std::vector<ToolContact::Reach> reaches;
  for (const ToolContact& contact : contacts_) reaches.push_back(contact.reach(t, rows.x));
  return reaches;
}

double TissueBody::energy(double t, const Dofs& q) const {
  Scratch& rows = scratch();
  place(t, q, rows);
  displace(t, q, rows.u);
  double sum = elements_ ? elements_->energy(rows.u) : 0;
  for (const SpringSet& set : springs_) sum += set.energy(rows.x);
  if (membrane_) sum += membrane_->energy(rows.x);
  for (const Index i : free_points_) sum -= heavy_mass_[i] * settings_.gravity.dot(as_vector(rows.u[at(i)]));
  for (const PressingForce& load : settings_.forces)
    for (std::size_t i = 0; i < load.points.size(); ++i)
      sum -= load.profile.value(t) * load.shares[i] * load.force.dot(as_vector(rows.u[at(load.points[i])]));
  for (const Anchor& anchor : anchors_) sum += anchor.stiffness / 2 * q.segment<3>(anchor.dof).squaredNorm();
  for (const ToolContact& contact : contacts_) sum += contact.energy(t, rows.x);
  return sum;
}

double TissueBody::kinetic_energy(const Dofs& v) const { return mass_.dot(v.cwiseAbs2()) / 2; }

double TissueBody::bound_of(const DofMatrix& matrix) const {
  thread_local Dofs columns, rows;
  columns.setZero(dofs());
  rows.setZero(dofs());
  for (Eigen::Index j = 0; j < dofs(); ++j)
    for (DofMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      const double a = std::abs(entry.value()) / std::sqrt(mass_[j] * mass_[entry.row()]);
      columns[j] += a;
      rows[entry.row()] += a;
    }
  return bound_of_sums(columns.maxCoeff(), rows.maxCoeff());
}

double TissueBody::spectral_radius(double t, const State& y) const {
  DofMatrix matrix;  // not kept: of a large body it is tens of megabytes
  thread_local Dofs q, v;
  q = y.head(dofs());
  v = y.tail(dofs());
  stiffness(t, q, v, matrix);
  const double k = bound_of(matrix);
  damping(t, q, v, matrix);
  return radius_of_bounds(k, bound_of(matrix));
}

Eigen::Matrix3Xd TissueBody::positions(double t, const Dofs& q) const {
  Eigen::Matrix3Xd x(3, mesh_.point_count());
  visit_displacements(t, q, [&](Index i, const auto& moved) { x.col(i) = mesh_.points.col(i) + moved; });
  return x;
}

Eigen::VectorXd TissueBody::energy_densities(double t, const Dofs& q) const {
  if (!elements_)
    throw std::invalid_argument(
        "springs have no energy density in a tetrahedron; use a model of finite elements");
  Scratch& rows = scratch();
  place(t, q, rows);
  Eigen::VectorXd density(mesh_.tetrahedron_count());
  elements_->write_energy_densities(rows.u, density);
  return density;
}

Eigen::VectorXd TissueBody::point_energy_densities(double t, const Dofs& q) const {
  const Eigen::VectorXd density = energy_densities(t, q);
  Eigen::VectorXd energy = Eigen::VectorXd::Zero(mesh_.point_count()), volume = energy;
  for (Eigen::Index e = 0; e < mesh_.tetrahedron_count(); ++e) {
    const double v = volume_of(mesh_.points, mesh_.tetrahedra, e);
    for (const Index corner : mesh_.tetrahedra.col(e)) {
      energy[corner] += v * density[e];
      volume[corner] += v;
    }
  }
  return energy.cwiseQuotient(volume);
}

bool TissueBody::admits(const State& y) const {
  constexpr double most = 1e4;
  if (dofs() == 0) return true;
  const auto q = y.head(dofs()).reshaped(3, dofs() / 3);
  Eigen::Vector3d low = q.rowwise().minCoeff(), high = q.rowwise().maxCoeff();
  // What is held stays where it is, or moves within the size of a body.
  if (free_points_.size() < static_cast<std::size_t>(mesh_.points.cols())) {
    low = low.cwiseMin(0.0);
    high = high.cwiseMax(0.0);
  }
  return (high - low).norm() <= most * size_;
}

std::pair<double, Eigen::Index> TissueBody::least_volume(double t, const Dofs& q) const {
  const Eigen::Matrix3Xd x = positions(t, q);
  std::pair<double, Eigen::Index> least{std::numeric_limits<double>::infinity(), -1};
  for (Eigen::Index e = 0; e < mesh_.tetrahedron_count(); ++e)
    if (const double ratio = volume_of(x, mesh_.tetrahedra, e) / volume_of(mesh_.points, mesh_.tetrahedra, e);
        !(ratio >= least.first))
      least = {ratio, e};
  return least;
}

void TissueBody::visit_rest_stiffness(const StiffnessVisitor& visit) const {
  const Scratch still = rest();
  if (elements_) elements_->visit_stiffness(still.u, visit);
  for (const SpringSet& set : springs_)
    for (std::size_t i = 0; i < set.size(); ++i) {
      const Eigen::Matrix3d B = set.stiffness(still.x, i);
      Eigen::Matrix<double, 6, 6> K;
      K << B, -B, -B, B;
      visit(set.spring(i).points, K);
    }
  if (membrane_)
    for (std::size_t i = 0; i < membrane_->size(); ++i)
      visit(membrane_->points(i), membrane_->stiffness(still.x, i));
  for (const auto& [point, dof, k] : anchors_)
    visit(std::span(&point, 1), Eigen::Matrix3d(k * Eigen::Matrix3d::Identity()));
}

}  // namespace hmax
