/// Lattices of masses on springs, free, held or resting on a penalty floor, by several methods; and their
/// limits from dense eigenvalues.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "analysis/foreign_steps/foreign_stepper.hpp"
#include "core/dense_solvers.hpp"

namespace hmax {

enum class LatticeSupport { free, held, touching };
enum class Scheme { symplectic_euler, explicit_euler, implicit_euler, newmark };

struct Lattice {
  struct Spring {
    Eigen::Index a, b;
    double k, length;
  };
  LatticeSupport support = LatticeSupport::free;
  Scheme scheme = Scheme::symplectic_euler;
  double alpha = 0, beta = 0;  ///< damping alpha M + beta K
  double newmark_beta = 0.25;
  double floor = 0, gravity = 0;
  Eigen::VectorXd x, mass;  ///< (x, y, z) of each node in equilibrium, and its mass for each of them
  std::vector<bool> held;   ///< shape (nodes)
  std::vector<Spring> springs;
  bool tells_pattern = false;

  using Sparse = Eigen::SparseMatrix<double>;

  [[nodiscard]] Eigen::VectorXd force(const Eigen::VectorXd& at) const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(at.size());
    for (const Spring& s : springs) {
      const Eigen::Vector3d d = at.segment<3>(3 * s.b) - at.segment<3>(3 * s.a);
      const double l = d.norm();
      const Eigen::Vector3d pull = s.k * (l - s.length) / l * d;
      f.segment<3>(3 * s.a) += pull;
      f.segment<3>(3 * s.b) -= pull;
    }
    for (Eigen::Index i = 0; i < at.size() / 3; ++i) {
      f[3 * i + 2] -= gravity * mass[3 * i] + std::min(0.0, floor * at[3 * i + 2]);
      if (held[static_cast<std::size_t>(i)]) f.segment<3>(3 * i).setZero();
    }
    return f;
  }

  /// -d force / d x: k (L / l n n^T + (1 - L / l) I) of each spring, and the floor where it is touched.
  [[nodiscard]] Sparse stiffness(const Eigen::VectorXd& at) const {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](Eigen::Index i, Eigen::Index j, const Eigen::Matrix3d& A) {
      if (held[static_cast<std::size_t>(i)] || held[static_cast<std::size_t>(j)]) return;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) entries.emplace_back(3 * i + r, 3 * j + c, A(r, c));
    };
    for (const Spring& s : springs) {
      const Eigen::Vector3d d = at.segment<3>(3 * s.b) - at.segment<3>(3 * s.a);
      const double l = d.norm(), ratio = s.length / l;
      const Eigen::Matrix3d A =
          s.k * (ratio * d * d.transpose() / (l * l) + (1 - ratio) * Eigen::Matrix3d::Identity());
      add(s.a, s.a, A);
      add(s.b, s.b, A);
      add(s.a, s.b, -A);
      add(s.b, s.a, -A);
    }
    for (Eigen::Index i = 0; i < at.size() / 3; ++i)
      if (floor > 0 && at[3 * i + 2] < 0) entries.emplace_back(3 * i + 2, 3 * i + 2, floor);
    Sparse K(at.size(), at.size());
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
  }

  [[nodiscard]] std::string name() const {
    const std::array supports{"free", "held", "touching"};
    const std::array schemes{"symplectic Euler", "explicit Euler", "implicit Euler", "Newmark"};
    return std::string(supports[static_cast<std::size_t>(support)]) + ", " +
           schemes[static_cast<std::size_t>(scheme)];
  }

  /// Squared frequencies of all modes; those of rigid motions are 0, to what is left of the forces of the
  /// equilibrium.
  [[nodiscard]] Eigen::VectorXd squared_frequencies() const {
    std::vector<Eigen::Index> moves;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (!held[static_cast<std::size_t>(i / 3)]) moves.push_back(i);
    const Eigen::MatrixXd K = stiffness(x);
    const auto n = static_cast<Eigen::Index>(moves.size());
    Eigen::MatrixXd A(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) {
        const Eigen::Index a = moves[static_cast<std::size_t>(i)], b = moves[static_cast<std::size_t>(j)];
        A(i, j) = K(a, b) / std::sqrt(mass[a] * mass[b]);
      }
    Eigen::VectorXd found =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A, Eigen::EigenvaluesOnly).eigenvalues();
    const double largest = found.maxCoeff();
    return found.unaryExpr([largest](double w2) { return std::abs(w2) < 1e-8 * largest ? 0.0 : w2; });
  }

  /// One step of (x, v) for a unit mass of stiffness w2 and damping alpha + beta w2.
  [[nodiscard]] Eigen::Matrix2d block(double w2, double h) const {
    const double c = alpha + beta * w2;
    Eigen::Matrix2d J;
    switch (scheme) {
      case Scheme::symplectic_euler:
        J << 1 - h * h * w2, h * (1 - h * c), -h * w2, 1 - h * c;
        break;
      case Scheme::explicit_euler:
        J << 1, h, -h * w2, 1 - h * c;
        break;
      case Scheme::implicit_euler: {
        const double of_x = -h * w2 / (1 + h * c + h * h * w2),
                     of_v = -h * (c + h * w2) / (1 + h * c + h * h * w2);
        J << 1 + h * of_x, h * (1 + of_v), of_x, 1 + of_v;
        break;
      }
      case Scheme::newmark: {
        const double left = 1 + h / 2 * c + newmark_beta * h * h * w2;
        const double of_x = -h * w2 / left, of_v = -h * (c + h / 2 * w2) / left;
        J << 1 + h / 2 * of_x, h * (1 + of_v / 2), of_x, 1 + of_v;
        break;
      }
    }
    return J;
  }

  static double radius(const Eigen::Matrix2d& J) {
    const double half = J.trace() / 2, product = J.determinant(), under = half * half - product;
    return under < 0 ? std::sqrt(product) : std::abs(half) + std::sqrt(under);
  }

  /// The first step size at which a mode grows; infinity without one up to `most`.
  [[nodiscard]] double limit(const Eigen::VectorXd& w2, double least, double most) const {
    const auto grows = [&](double h) {
      for (const double each : w2)
        if (radius(block(each, h)) > 1 + 1e-8) return true;
      return false;
    };
    const double ratio = std::pow(most / least, 1.0 / 2000);
    for (double low = least; low < most; low *= ratio) {
      if (!grows(low * ratio)) continue;
      double high = low * ratio;
      for (int k = 0; k < 40; ++k) {
        const double middle = (low + high) / 2;
        (grows(middle) ? high : low) = middle;
      }
      return high;
    }
    return std::numeric_limits<double>::infinity();
  }

  /// The matrix of a step of all numbers.
  [[nodiscard]] Eigen::MatrixXd step_matrix(double h) const {
    using Eigen::MatrixXd;
    const Eigen::Index m = x.size();
    MatrixXd K = MatrixXd(stiffness(x)), C = beta * K;
    C.diagonal() += alpha * mass;
    const MatrixXd one = MatrixXd::Identity(m, m), M = mass.asDiagonal();
    MatrixXd J(2 * m, 2 * m);
    const auto from = [&](const MatrixXd& of_x, const MatrixXd& of_v, double share, double kept) {
      J << one + share * h * of_x, h * (one + kept * of_v), of_x, one + of_v;
    };
    switch (scheme) {
      case Scheme::symplectic_euler:
        from(-h * M.inverse() * K, -h * M.inverse() * C, 1, 1);
        break;
      case Scheme::explicit_euler:
        from(-h * M.inverse() * K, -h * M.inverse() * C, 0, 0);
        break;
      case Scheme::implicit_euler: {
        const MatrixXd left = (M + h * C + h * h * K).inverse();
        from(-h * left * K, -h * left * (C + h * K), 1, 1);
        break;
      }
      case Scheme::newmark: {
        const MatrixXd left = (M + h / 2 * C + newmark_beta * h * h * K).inverse();
        from(-h * left * K, -h * left * (C + h / 2 * K), 0.5, 0.5);
        break;
      }
    }
    // What is held neither moves nor has a multiplier of its own.
    for (Eigen::Index i = 0; i < m; ++i)
      if (held[static_cast<std::size_t>(i / 3)])
        for (const Eigen::Index k : {i, m + i}) J.row(k).setZero(), J.col(k).setZero();
    return J;
  }
};

/// y = (x, v). Forces are those of the springs and the floor as they are; damping and the matrices of
/// implicit steps are of the equilibrium.
class LatticeStepper final : public ForeignStepper {
 public:
  explicit LatticeStepper(Lattice lattice)
      : lattice_(std::move(lattice)), m_(lattice_.x.size()), K_(lattice_.stiffness(lattice_.x)), y_(2 * m_) {
    y_ << lattice_.x, Eigen::VectorXd::Zero(m_);
  }
  [[nodiscard]] std::string name() const override { return lattice_.name(); }
  [[nodiscard]] Eigen::Index dim() const override { return 2 * m_; }
  [[nodiscard]] bool has_hidden_state() const override { return false; }
  [[nodiscard]] Lattice::Sparse pattern() const override {
    const bool is_explicit =
        lattice_.scheme == Scheme::symplectic_euler || lattice_.scheme == Scheme::explicit_euler;
    if (!lattice_.tells_pattern || !is_explicit) return {};
    std::vector<Eigen::Triplet<double>> entries;
    const auto couple = [&](Eigen::Index one, Eigen::Index other) {
      for (const Eigen::Index r : {3 * one, m_ + 3 * one})
        for (const Eigen::Index c : {3 * other, m_ + 3 * other})
          for (Eigen::Index k = 0; k < 9; ++k) entries.emplace_back(r + k / 3, c + k % 3, 1);
    };
    for (Eigen::Index i = 0; i < m_ / 3; ++i) couple(i, i);
    for (const Lattice::Spring& s : lattice_.springs) {
      couple(s.a, s.b);
      couple(s.b, s.a);
    }
    Lattice::Sparse found(2 * m_, 2 * m_);
    found.setFromTriplets(entries.begin(), entries.end());
    return found;
  }
  Eigen::VectorXd state() override { return y_; }
  void set_state(const Eigen::VectorXd& y) override { y_ = y; }
  void save(int slot) override { slots_.at(static_cast<std::size_t>(slot)) = y_; }
  void restore(int slot) override { y_ = slots_.at(static_cast<std::size_t>(slot)); }
  bool step(double h, std::int64_t count) override {
    for (; count > 0; --count) {
      if (!once(h)) return false;
      ++steps;
    }
    return true;
  }
  std::int64_t steps = 0;

 private:
  bool once(double h) {
    Eigen::VectorXd x = y_.head(m_), v = y_.tail(m_);
    const Eigen::VectorXd damping = lattice_.alpha * lattice_.mass.cwiseProduct(v) + lattice_.beta * (K_ * v);
    const Eigen::VectorXd f = lattice_.force(x) - damping;
    Eigen::VectorXd change;
    switch (lattice_.scheme) {
      case Scheme::symplectic_euler:
      case Scheme::explicit_euler:
        change = h * f.cwiseQuotient(lattice_.mass);
        break;
      case Scheme::implicit_euler:
        change = factor(h, h, h * h).solve(h * (f - h * (K_ * v)));
        break;
      case Scheme::newmark:
        change = factor(h, h / 2, lattice_.newmark_beta * h * h).solve(h * (f - h / 2 * (K_ * v)));
        break;
    }
    for (Eigen::Index i = 0; i < m_; ++i)
      if (lattice_.held[static_cast<std::size_t>(i / 3)]) change[i] = v[i] = 0;
    const double share = lattice_.scheme == Scheme::explicit_euler ? 0
                         : lattice_.scheme == Scheme::newmark      ? 0.5
                                                                   : 1;
    for (Eigen::Index i = 0; i < m_; ++i)
      if (!lattice_.held[static_cast<std::size_t>(i / 3)]) x[i] += h * (v[i] + share * change[i]);
    y_ << x, v + change;
    return y_.allFinite();
  }
  using Factor = Eigen::SimplicialLDLT<Lattice::Sparse>;
  const Factor& factor(double h, double of_damping, double of_stiffness) {
    std::unique_ptr<Factor>& found = factors_[h];
    if (found) return *found;
    Lattice::Sparse A = (of_damping * lattice_.beta + of_stiffness) * K_;
    Lattice::Sparse M(m_, m_);
    M.setIdentity();
    M.diagonal() = (1 + of_damping * lattice_.alpha) * lattice_.mass;
    return *(found = std::make_unique<Factor>(A + M));
  }

  Lattice lattice_;
  Eigen::Index m_;
  Lattice::Sparse K_;
  Eigen::VectorXd y_;
  std::array<Eigen::VectorXd, 3> slots_;
  std::map<double, std::unique_ptr<Factor>> factors_;
};

/// Newton's method for force = 0; horizontal motions on the floor are free, so that the matrix is a little
/// stiffer.
/// @returns false where it does not converge, or a node hardly touches the floor
inline bool settle(Lattice& lattice) {
  double largest = 0;
  for (const Lattice::Spring& s : lattice.springs) largest = std::max(largest, s.k);
  Lattice::Sparse shift(lattice.x.size(), lattice.x.size());
  shift.setIdentity();
  const double weight = lattice.gravity * lattice.mass.maxCoeff();
  for (int k = 0; k < 40; ++k) {
    const Eigen::VectorXd f = lattice.force(lattice.x);
    if (f.cwiseAbs().maxCoeff() < 1e-10 * weight) break;
    const Lattice::Sparse A = lattice.stiffness(lattice.x) + 1e-7 * largest * shift;
    lattice.x += Eigen::SimplicialLDLT<Lattice::Sparse>(A).solve(f);
    if (!lattice.x.allFinite()) return false;
  }
  if (!(lattice.force(lattice.x).cwiseAbs().maxCoeff() < 1e-8 * weight)) return false;
  double deepest = 0, least = 1;
  for (Eigen::Index i = 0; i < lattice.x.size() / 3; ++i) deepest = std::max(deepest, -lattice.x[3 * i + 2]);
  for (Eigen::Index i = 0; i < lattice.x.size() / 3; ++i)
    least = std::min(least, std::abs(lattice.x[3 * i + 2]) / deepest);
  return deepest > 0 && least > 0.01;
}

/// About `numbers` numbers, at least 48.
inline Lattice random_lattice(std::mt19937_64& random, LatticeSupport support, Scheme scheme,
                              double numbers) {
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution(from, to)(random);
  };
  // A softer floor and less weight, until all of the lowest nodes touch and nothing tips over. So little
  // weight that the rounding of the springs is no small part of it never settles.
  constexpr double softest = 4096;
  for (double softer = 1;; softer = softer < softest ? 4 * softer : 1) {
    Lattice found;
    found.support = support;
    found.scheme = scheme;
    const int side = std::max(2, static_cast<int>(std::cbrt(numbers / 6)));
    const std::array<int, 3> n{side, side,
                               std::max(2, static_cast<int>(std::lround(numbers / (6.0 * side * side))))};
    const Eigen::Index nodes = static_cast<Eigen::Index>(n[0]) * n[1] * n[2];
    found.x.resize(3 * nodes);
    found.mass.resize(3 * nodes);
    found.held.assign(static_cast<std::size_t>(nodes), false);
    const double spacing = std::pow(10, uniform(-2.5, 0)), jitter = uniform(0, 0.15),
                 stiffness = std::pow(10, uniform(0, 5)), mass = std::pow(10, uniform(-4, 1)),
                 spread = uniform(1, 5);
    Eigen::Index node = 0;
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i, ++node) {
          const double up = k == 0 ? 0 : jitter;
          found.x.segment<3>(3 * node) =
              spacing * Eigen::Vector3d(i + uniform(-jitter, jitter), j + uniform(-jitter, jitter),
                                        k + uniform(-up, up));
          found.mass.segment<3>(3 * node).setConstant(mass * std::pow(spread, uniform(0, 1)));
          if (support == LatticeSupport::held && k == 0) found.held[static_cast<std::size_t>(node)] = true;
        }
    for (Eigen::Index a = 0; a < nodes; ++a)
      for (Eigen::Index b = a + 1; b < nodes; ++b) {
        const double l = (found.x.segment<3>(3 * a) - found.x.segment<3>(3 * b)).norm();
        if (l < 1.8 * spacing)
          found.springs.push_back({a, b, stiffness * std::pow(spread, uniform(0, 1)), l});
      }
    found.tells_pattern = uniform(0, 1) < 0.5;
    if (support == LatticeSupport::touching) {
      found.floor = stiffness * uniform(0.2, 2) / softer;
      found.gravity =
          uniform(0.002, 0.02) / softer * spacing * stiffness / (found.mass.sum() / 3 / (n[0] * n[1]));
      if (!settle(found)) continue;
    }
    const Eigen::VectorXd w2 = found.squared_frequencies();
    if (w2.minCoeff() < 0) continue;  // it would tip over
    const double top = std::sqrt(w2.maxCoeff()), kind = uniform(0, 1);
    // By the damping ratio of the fastest mode.
    if (scheme == Scheme::explicit_euler || kind < 0.4) found.beta = 2 * uniform(0.02, 0.6) / top;
    if ((scheme == Scheme::explicit_euler && kind < 0.3) || kind > 0.7)
      found.alpha = 2 * uniform(0.01, 0.3) * top;
    if (scheme == Scheme::newmark)
      found.newmark_beta = std::array{0.25, 0.1, 0.0}[static_cast<std::size_t>(uniform(0, 3))];
    return found;
  }
}

}  // namespace hmax
