/// Any system behind one type: what a human chooses by name has its verbs called through a pointer.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "core/mass_matrix.hpp"
#include "core/structure_operator.hpp"
#include "problems/linearity.hpp"

namespace hmax {

class FormulaProgram;

/// A system of any dimension with every verb a problem of the house may have; which ones it really has, it
/// answers at run time. Cheap to copy: copies share one system. For two numbers on the stack the call through
/// a pointer costs more than the arithmetic, so the oscillator is bound by its own type.
/// @tparam RealT  the type it computes in: double or long double
template <class RealT>
class BasicAnySystem {
 public:
  using Real = RealT;
  using State = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Jacobian =
      std::variant<Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>, Eigen::SparseMatrix<Real>>;
  using Dofs = State;
  using DofMatrix = Jacobian;

  /// @param system  a struct with State, dim(), rhs(t, y, dydt) and any of the optional verbs of
  ///                integrators/system.hpp; its states may be of fixed size and of another real type
  template <class S>
  requires(!std::is_same_v<std::remove_cvref_t<S>, BasicAnySystem>) explicit BasicAnySystem(S system)
      : self_(std::make_shared<const Model<S>>(std::move(system))) {}

  [[nodiscard]] Eigen::Index dim() const { return self_->facts.dim; }
  void rhs(Real t, const State& y, State& dydt) const { self_->rhs(inside(t), y, dydt); }

  [[nodiscard]] bool has_jacobian() const { return self_->facts.has_jacobian; }
  void jacobian(Real t, const State& y, Jacobian& J) const { self_->jacobian(inside(t), y, J); }
  [[nodiscard]] bool has_sparsity() const { return self_->facts.has_sparsity; }
  void sparsity(Eigen::SparseMatrix<Real>& pattern) const { self_->sparsity(pattern); }
  [[nodiscard]] bool is_autonomous() const { return self_->facts.is_autonomous; }
  [[nodiscard]] bool has_time_derivative() const { return self_->facts.has_time_derivative; }
  void time_derivative(Real t, const State& y, State& dfdt) const {
    self_->time_derivative(inside(t), y, dfdt);
  }
  [[nodiscard]] bool has_spectral_radius() const { return self_->facts.has_spectral_radius; }
  [[nodiscard]] Real spectral_radius(Real t, const State& y) const {
    return self_->spectral_radius(inside(t), y);
  }
  [[nodiscard]] bool admits(const State& y) const { return self_->admits(y); }
  /// How f depends on the state; unknown where the system does not say.
  [[nodiscard]] Linearity linearity() const { return self_->facts.linearity; }
  [[nodiscard]] bool is_linear() const { return linearity() == Linearity::linear; }
  /// Times in the open interval (t0, t1) where f or its derivatives jump whatever the state, in increasing
  /// order; empty where the system knows none.
  [[nodiscard]] std::vector<double> breakpoints(double t0, double t1) const {
    return self_->breakpoints(t0, t1);
  }
  /// From here on verbs of time t are those of the time in [from, to] that is nearest to t: on one side of a
  /// breakpoint. Copies that were made before are not changed.
  void confine(Real from, Real to) {
    from_ = from;
    to_ = to;
  }
  /// The time of that interval that is nearest to t.
  [[nodiscard]] Real inside(Real t) const { return std::clamp(t, from_, to_); }
  [[nodiscard]] bool has_offset() const { return self_->facts.has_offset; }
  void offset(State& X) const { self_->offset(X); }

  /// 0 when the system is of first order only.
  [[nodiscard]] Eigen::Index dofs() const { return self_->facts.dofs; }
  [[nodiscard]] bool has_sparse_matrices() const { return self_->facts.has_sparse_matrices; }
  /// @throws std::invalid_argument  where M couples unknowns
  [[nodiscard]] Dofs mass() const { return mass_matrix().lumped(); }
  [[nodiscard]] MassMatrix<Real> mass_matrix() const { return self_->mass_matrix(); }
  void force(Real t, const Dofs& q, const Dofs& v, Dofs& f) const { self_->force(inside(t), q, v, f); }
  void stiffness(Real t, const Dofs& q, const Dofs& v, DofMatrix& K) const {
    self_->stiffness(inside(t), q, v, K);
  }
  void damping(Real t, const Dofs& q, const Dofs& v, DofMatrix& C) const {
    self_->damping(inside(t), q, v, C);
  }

  /// Null where the system has matrices, or is of first order.
  [[nodiscard]] std::shared_ptr<const StructureOperator> structure_operator() const {
    return self_->facts.structure_operator;
  }
  /// Those that f(t, y) is given by, in the order of the state; null where it is not.
  [[nodiscard]] std::shared_ptr<const FormulaProgram> formulas() const { return self_->facts.formulas; }
  /// See integrators/system.hpp; without a call where the system has all unknowns.
  [[nodiscard]] Real largest_of_all(Real own) const {
    return self_->facts.is_part ? self_->largest_of_all(own) : own;
  }

  [[nodiscard]] bool has_split() const { return self_->facts.has_split; }
  [[nodiscard]] bool has_linear_stiff_part() const { return self_->facts.has_linear_stiff_part; }
  void rhs_stiff(Real t, const State& y, State& dydt) const { self_->rhs_stiff(inside(t), y, dydt); }
  void rhs_nonstiff(Real t, const State& y, State& dydt) const { self_->rhs_nonstiff(inside(t), y, dydt); }
  void jacobian_stiff(Real t, const State& y, Jacobian& J) const { self_->jacobian_stiff(inside(t), y, J); }
  [[nodiscard]] bool has_stiff_structure() const { return self_->facts.has_stiff_structure; }
  void stiffness_stiff(DofMatrix& K) const { self_->stiffness_stiff(K); }
  void damping_stiff(DofMatrix& C) const { self_->damping_stiff(C); }

 private:
  /// What a system answers once.
  struct Facts {
    Eigen::Index dim = 0, dofs = 0;
    bool has_jacobian = false, has_sparsity = false, is_autonomous = false, has_time_derivative = false,
         has_spectral_radius = false, has_offset = false, has_sparse_matrices = false, has_split = false,
         has_linear_stiff_part = false, has_stiff_structure = false,
         is_part = false;  ///< of a system whose other unknowns are elsewhere
    Linearity linearity = Linearity::unknown;
    std::shared_ptr<const StructureOperator> structure_operator{};
    std::shared_ptr<const FormulaProgram> formulas{};
  };

  struct Interface {
    explicit Interface(Facts known) : facts(std::move(known)) {}
    Interface(const Interface&) = delete;
    Interface& operator=(const Interface&) = delete;
    virtual ~Interface() = default;
    const Facts facts;
    virtual void rhs(Real, const State&, State&) const = 0;
    virtual void jacobian(Real, const State&, Jacobian&) const = 0;
    virtual void sparsity(Eigen::SparseMatrix<Real>&) const = 0;
    virtual void time_derivative(Real, const State&, State&) const = 0;
    virtual Real spectral_radius(Real, const State&) const = 0;
    virtual bool admits(const State&) const = 0;
    virtual std::vector<double> breakpoints(double, double) const = 0;
    virtual void offset(State&) const = 0;
    virtual MassMatrix<Real> mass_matrix() const = 0;
    virtual void force(Real, const Dofs&, const Dofs&, Dofs&) const = 0;
    virtual void stiffness(Real, const Dofs&, const Dofs&, DofMatrix&) const = 0;
    virtual void damping(Real, const Dofs&, const Dofs&, DofMatrix&) const = 0;
    virtual Real largest_of_all(Real) const = 0;
    virtual void rhs_stiff(Real, const State&, State&) const = 0;
    virtual void rhs_nonstiff(Real, const State&, State&) const = 0;
    virtual void jacobian_stiff(Real, const State&, Jacobian&) const = 0;
    virtual void stiffness_stiff(DofMatrix&) const = 0;
    virtual void damping_stiff(DofMatrix&) const = 0;
  };

  /// Calls call(in..., out) with the vectors of the system, converting where they differ from ours.
  template <class Vector, class Call>
  static void through(const State& y, State& out, const Call& call) {
    if constexpr (std::is_same_v<Vector, State>) {
      call(y, out);
    } else {
      // Number by number: g++ 12 warns of a packet that a vector of one number does not have.
      Vector own;
      own.resize(y.size());
      for (Eigen::Index i = 0; i < own.size(); ++i) own[i] = static_cast<typename Vector::Scalar>(y[i]);
      Vector result = own;
      call(own, result);
      for (Eigen::Index i = 0; i < result.size(); ++i) out[i] = static_cast<Real>(result[i]);
    }
  }
  template <class Vector, class Call>
  static void through(const Dofs& q, const Dofs& v, Dofs& out, const Call& call) {
    if constexpr (std::is_same_v<Vector, Dofs>) {
      call(q, v, out);
    } else {
      const Vector own_v = v.template cast<typename Vector::Scalar>();
      through<Vector>(q, out, [&](const Vector& own_q, Vector& result) { call(own_q, own_v, result); });
    }
  }
  /// Calls call(J) with the matrix type of the system, dense or sparse.
  template <class Matrix, class Call>
  static void matrix_through(Jacobian& out, const Call& call) {
    if constexpr (std::is_same_v<Matrix, Jacobian>) {
      call(out);
    } else if constexpr (std::is_base_of_v<Eigen::SparseMatrixBase<Matrix>, Matrix>) {
      if (!std::holds_alternative<Eigen::SparseMatrix<Real>>(out)) out.template emplace<1>();
      if constexpr (std::is_same_v<typename Matrix::Scalar, Real>) {
        call(std::get<1>(out));
      } else {
        Matrix own = std::get<1>(out).template cast<typename Matrix::Scalar>();
        call(own);
        std::get<1>(out) = own.template cast<Real>();
      }
    } else {
      if (!std::holds_alternative<Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>>(out))
        out.template emplace<0>();
      if constexpr (std::is_same_v<Matrix, Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>>) {
        call(std::get<0>(out));
      } else {
        Matrix own;
        call(own);
        // Into a corner of the same fixed size: copied number by number, not in packets longer than the
        // matrix.
        auto& dense = std::get<0>(out);
        dense.resize(own.rows(), own.cols());
        dense.template topLeftCorner<Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime>(
            own.rows(), own.cols()) = own.template cast<Real>();
      }
    }
  }

  template <class S>
  class Model final : public Interface {
    using Own = typename S::State;
    using OwnReal = typename Eigen::NumTraits<typename Own::Scalar>::Real;
    // Matrices that S may lack are named in the bodies: Clang 14 takes an unknown type of a parameter for an
    // error where GCC takes it for no.
    static constexpr bool differentiable = requires(const S& s, const Own& y) {
      s.jacobian(OwnReal{}, y, std::declval<typename S::Jacobian&>());
    };
    static constexpr bool time_differentiable = requires(const S& s, Own& out) {
      s.time_derivative(OwnReal{}, out, out);
    };
    static constexpr bool patterned = requires(const S& s, Eigen::SparseMatrix<OwnReal>& pattern) {
      s.sparsity(pattern);
    };
    static constexpr bool bounded = requires(const S& s, const Own& y) { s.spectral_radius(OwnReal{}, y); };
    static constexpr bool with_offset = requires(const S& s, Own& X) { s.offset(X); };
    static constexpr bool second_order = requires { typename S::Dofs; };
    static constexpr bool split = requires(const S& s, Own& out) { s.rhs_stiff(OwnReal{}, out, out); };
    static constexpr bool split_structure = requires(const S& s) {
      s.stiffness_stiff(std::declval<typename S::DofMatrix&>());
    };
    static constexpr bool part = requires(const S& s) { s.largest_of_all(OwnReal{}); };

    static Facts facts_of(const S& system) {
      Facts facts{.dim = system.dim(),
                  .has_jacobian = differentiable,
                  .has_sparsity = patterned,
                  .has_time_derivative = time_differentiable,
                  .has_spectral_radius = bounded,
                  .has_offset = with_offset,
                  .has_split = split,
                  .is_part = part};
      if constexpr (requires { system.is_autonomous(); })
        facts.is_autonomous = system.is_autonomous();
      else if constexpr (requires { S::autonomous; })
        facts.is_autonomous = S::autonomous;
      if constexpr (second_order) {
        facts.dofs = system.dofs();
        facts.has_sparse_matrices =
            std::is_base_of_v<Eigen::SparseMatrixBase<typename S::DofMatrix>, typename S::DofMatrix>;
      }
      facts.has_stiff_structure = split_structure && facts.has_sparse_matrices;
      if constexpr (requires { system.has_stiff_structure(); })
        facts.has_stiff_structure = system.has_stiff_structure();
      if constexpr (requires { S::linear_stiff_part; }) facts.has_linear_stiff_part = S::linear_stiff_part;
      if constexpr (requires { system.linearity(); }) facts.linearity = system.linearity();
      if constexpr (requires { system.formulas(); }) facts.formulas = system.formulas();
      if constexpr (requires { system.structure_operator(); })
        facts.structure_operator = system.structure_operator();
      return facts;
    }

   public:
    explicit Model(S system) : Interface(facts_of(system)), system_(std::move(system)) {}

    void rhs(Real t, const State& y, State& dydt) const override {
      through<Own>(y, dydt, [&](const Own& in, Own& out) { system_.rhs(static_cast<OwnReal>(t), in, out); });
    }
    void jacobian(Real t, const State& y, Jacobian& J) const override {
      if constexpr (differentiable) {
        const Own& own = y.template cast<typename Own::Scalar>();
        matrix_through<typename S::Jacobian>(
            J, [&](auto& matrix) { system_.jacobian(static_cast<OwnReal>(t), own, matrix); });
      }
    }
    void sparsity(Eigen::SparseMatrix<Real>& pattern) const override {
      if constexpr (patterned) {
        Eigen::SparseMatrix<OwnReal> own;
        system_.sparsity(own);
        pattern = own.template cast<Real>();
      }
    }
    void time_derivative(Real t, const State& y, State& dfdt) const override {
      if constexpr (time_differentiable)
        through<Own>(y, dfdt, [&](const Own& in, Own& out) {
          system_.time_derivative(static_cast<OwnReal>(t), in, out);
        });
    }
    Real spectral_radius(Real t, const State& y) const override {
      if constexpr (bounded)
        return static_cast<Real>(
            system_.spectral_radius(static_cast<OwnReal>(t), Own(y.template cast<typename Own::Scalar>())));
      else
        return Real{0};
    }
    bool admits(const State& y) const override {
      if constexpr (!requires(const Own& own) { system_.admits(own); })
        return true;
      else if constexpr (std::is_same_v<Own, State>)
        return system_.admits(y);
      else
        return system_.admits(Own(y.template cast<typename Own::Scalar>()));
    }
    std::vector<double> breakpoints(double t0, double t1) const override {
      if constexpr (requires { system_.breakpoints(t0, t1); })
        return system_.breakpoints(t0, t1);
      else
        return {};
    }
    void offset(State& X) const override {
      if constexpr (with_offset) through<Own>(X, X, [&](const Own&, Own& out) { system_.offset(out); });
    }

    MassMatrix<Real> mass_matrix() const override {
      if constexpr (second_order)
        return mass_of(system_).template cast<Real>();
      else
        return {};
    }
    void force(Real t, const Dofs& q, const Dofs& v, Dofs& f) const override {
      if constexpr (second_order)
        through<typename S::Dofs>(q, v, f, [&](const auto& own_q, const auto& own_v, auto& out) {
          system_.force(static_cast<OwnReal>(t), own_q, own_v, out);
        });
    }
    void stiffness(Real t, const Dofs& q, const Dofs& v, DofMatrix& K) const override {
      if constexpr (second_order)
        dof_matrix(q, v, K, [&](const auto& own_q, const auto& own_v, auto& matrix) {
          system_.stiffness(static_cast<OwnReal>(t), own_q, own_v, matrix);
        });
    }
    void damping(Real t, const Dofs& q, const Dofs& v, DofMatrix& C) const override {
      if constexpr (second_order)
        dof_matrix(q, v, C, [&](const auto& own_q, const auto& own_v, auto& matrix) {
          system_.damping(static_cast<OwnReal>(t), own_q, own_v, matrix);
        });
    }

    Real largest_of_all(Real own) const override {
      if constexpr (part)
        return static_cast<Real>(system_.largest_of_all(static_cast<OwnReal>(own)));
      else
        return own;
    }

    void rhs_stiff(Real t, const State& y, State& dydt) const override {
      if constexpr (split)
        through<Own>(y, dydt,
                     [&](const Own& in, Own& out) { system_.rhs_stiff(static_cast<OwnReal>(t), in, out); });
    }
    void rhs_nonstiff(Real t, const State& y, State& dydt) const override {
      if constexpr (split)
        through<Own>(y, dydt, [&](const Own& in, Own& out) {
          system_.rhs_nonstiff(static_cast<OwnReal>(t), in, out);
        });
    }
    void jacobian_stiff(Real t, const State& y, Jacobian& J) const override {
      if constexpr (split) {
        const Own& own = y.template cast<typename Own::Scalar>();
        matrix_through<typename S::Jacobian>(
            J, [&](auto& matrix) { system_.jacobian_stiff(static_cast<OwnReal>(t), own, matrix); });
      }
    }
    void stiffness_stiff(DofMatrix& K) const override {
      if constexpr (split_structure)
        matrix_through<typename S::DofMatrix>(K, [&](auto& matrix) { system_.stiffness_stiff(matrix); });
    }
    void damping_stiff(DofMatrix& C) const override {
      if constexpr (split_structure)
        matrix_through<typename S::DofMatrix>(C, [&](auto& matrix) { system_.damping_stiff(matrix); });
    }

   private:
    template <class Call>
    static void dof_matrix(const Dofs& q, const Dofs& v, DofMatrix& out, const Call& call) {
      using OwnDofs = typename S::Dofs;
      const OwnDofs& own_q = q.template cast<typename OwnDofs::Scalar>();
      const OwnDofs& own_v = v.template cast<typename OwnDofs::Scalar>();
      matrix_through<typename S::DofMatrix>(out, [&](auto& matrix) { call(own_q, own_v, matrix); });
    }

    S system_;
  };

  std::shared_ptr<const Interface> self_;
  /// See confine().
  Real from_ = -std::numeric_limits<Real>::infinity(), to_ = std::numeric_limits<Real>::infinity();
};

using AnySystem = BasicAnySystem<double>;

}  // namespace hmax
