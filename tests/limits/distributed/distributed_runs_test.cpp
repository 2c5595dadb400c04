/// Runs of rows that are dealt out, with threads in the place of processes.
#include "limits/distributed/distributed_runs.hpp"

#include <algorithm>
#include <barrier>
#include <cmath>
#include <complex>
#include <limits>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "catalogue/methods/catalogue.hpp"
#include "limits/distributed/limits_from_ends.hpp"
#include "limits/predict.hpp"
#include "problems/matrices/matrix_model.hpp"

namespace hmax {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What the processes share: a chain with walls at both ends, masses of one.
struct Chain {
  explicit Chain(int ranks, Eigen::Index unknowns, StructureEnds of_damping)
      : K(MatrixXd::Zero(unknowns, unknowns)), x(unknowns), ends(of_damping), meeting(ranks) {
    K.diagonal().setConstant(2);
    K.diagonal(1).setConstant(-1);
    K.diagonal(-1).setConstant(-1);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> all(K);
    ends.unknowns = unknowns;
    ends.kappa_max = all.eigenvalues()[unknowns - 1];
    shape = all.eigenvectors().col(unknowns - 1);
    sums.resize(static_cast<std::size_t>(ranks));
    goings.resize(static_cast<std::size_t>(ranks), Going::on);
  }

  MatrixXd K, C;  ///< C of general damping
  VectorXd x, shape;
  StructureEnds ends;
  std::barrier<> meeting;
  std::vector<std::vector<double>> sums;
  std::vector<Going> goings;
};

/// The rows of one of them.
class Rows final : public DistributedModel {
 public:
  Rows(Chain& chain, std::size_t rank) : chain_(chain), rank_(rank) {
    const auto ranks = static_cast<Eigen::Index>(chain.sums.size()), own = static_cast<Eigen::Index>(rank);
    begin_ = chain.x.size() * own / ranks;
    count_ = chain.x.size() * (own + 1) / ranks - begin_;
    for (Eigen::Index i = 0; i < count_; ++i)
      noise_.push_back(std::sin(3.0 * static_cast<double>((begin_ + i) * (begin_ + i) + 1)));
  }

  [[nodiscard]] const StructureEnds& ends() const override { return chain_.ends; }
  [[nodiscard]] std::size_t rows() const override { return noise_.size(); }
  [[nodiscard]] std::span<const double> fastest_shape() const override {
    return {chain_.shape.data() + begin_, rows()};
  }
  [[nodiscard]] std::span<const double> noise() const override { return noise_; }
  void stiffness_times(const double* x, double* out) override {
    std::copy_n(x, count_, chain_.x.data() + begin_);
    chain_.meeting.arrive_and_wait();
    const VectorXd own = chain_.K.middleRows(begin_, count_) * chain_.x;
    chain_.meeting.arrive_and_wait();
    std::copy_n(own.data(), count_, out);
  }
  void mass_times(const double* x, double* out) override { std::copy_n(x, count_, out); }
  void reduced_stiffness_times(const double* x, double* out) override {
    stiffness_times(x, out);
    if (count_ > 0 && ++products_ == breaks_at) out[0] = std::numeric_limits<double>::infinity();
  }
  std::unique_ptr<StructureOperator::Inverse> inverse_of_sum(double a, double b) override {
    return std::make_unique<SumInverse>(*this, a, b);
  }
  SumEnd largest_of_sum(double a, double b, double /*tolerance*/) override {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> all(MatrixXd(a * chain_.C + b * chain_.K));
    const VectorXd u = all.eigenvectors().rightCols(1);
    return {.value = all.eigenvalues()[u.size() - 1],
            .residual = 0,
            .gamma = u.dot(chain_.C * u),
            .kappa = u.dot(chain_.K * u),
            .converged = true};
  }
  std::vector<std::complex<double>> largest_damped(std::size_t most) override {
    const Eigen::Index n = chain_.K.rows();
    MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
    A.topRightCorner(n, n).setIdentity();
    A.bottomRows(n) << -chain_.K, -chain_.C;
    const Eigen::VectorXcd values = Eigen::EigenSolver<MatrixXd>(A, false).eigenvalues();
    std::vector<Complex> upper;
    for (const Complex lambda : values)
      if (lambda.imag() >= 0) upper.push_back(lambda);
    std::ranges::sort(upper, [](Complex a, Complex b) { return std::abs(a) > std::abs(b); });
    std::vector<Complex> pairs;
    for (const Complex lambda : std::span(upper).first(std::min(most, upper.size()))) {
      pairs.push_back(lambda);
      if (lambda.imag() != 0) pairs.push_back(std::conj(lambda));
    }
    return pairs;
  }
  void add_up(std::span<double> numbers) override {
    chain_.sums[rank_].assign(numbers.begin(), numbers.end());
    chain_.meeting.arrive_and_wait();
    std::vector<double> all(numbers.size(), 0.0);
    for (const std::vector<double>& each : chain_.sums)
      for (std::size_t i = 0; i < all.size(); ++i) all[i] += each[i];
    chain_.meeting.arrive_and_wait();
    std::ranges::copy(all, numbers.begin());
  }
  double largest(double own) override {
    chain_.sums[rank_].assign(1, own);
    chain_.meeting.arrive_and_wait();
    double all = own;
    for (const std::vector<double>& each : chain_.sums) all = std::max(all, each.front());
    chain_.meeting.arrive_and_wait();
    return all;
  }
  Going together(Going going) override {
    chain_.goings[rank_] = going;
    chain_.meeting.arrive_and_wait();
    const Going all = *std::ranges::min_element(chain_.goings);
    chain_.meeting.arrive_and_wait();
    return all;
  }

  int breaks_at = 0;  ///< the product whose first row is not finite

 private:
  /// (a I + b K)^-1, which each process has in full.
  class SumInverse final : public StructureOperator::Inverse {
   public:
    SumInverse(Rows& rows, double a, double b)
        : rows_(rows),
          factors_(MatrixXd(b * rows.chain_.K) +
                   a * MatrixXd::Identity(rows.chain_.x.size(), rows.chain_.x.size())) {}
    int apply(double* x) override {
      Chain& chain = rows_.chain_;
      std::copy_n(x, rows_.count_, chain.x.data() + rows_.begin_);
      chain.meeting.arrive_and_wait();
      const VectorXd all = factors_.solve(chain.x);
      chain.meeting.arrive_and_wait();
      std::copy_n(all.data() + rows_.begin_, rows_.count_, x);
      return 1;
    }

   private:
    Rows& rows_;
    Eigen::PartialPivLU<MatrixXd> factors_;
  };

  Chain& chain_;
  std::size_t rank_;
  Eigen::Index begin_ = 0, count_ = 0;
  std::vector<double> noise_;
  int products_ = 0;
};

StructureEnds damped(double alpha, double beta) {
  StructureEnds ends;
  ends.alpha = alpha;
  ends.beta = beta;
  return ends;
}

/// The row of a method as each of so many processes has it, with `share` of the predicted limit in place of
/// it.
std::vector<Prediction> verified(const std::string& method, int ranks, const StructureEnds& of_damping = {},
                                 double share = 1, int breaks_at = 0, Eigen::Index unknowns = 40) {
  Chain chain(ranks, unknowns, of_damping);
  std::vector<Prediction> rows(static_cast<std::size_t>(ranks));
  std::vector<std::thread> processes;
  for (std::size_t rank = 0; rank < rows.size(); ++rank)
    processes.emplace_back([&, rank] {
      const Method stepped = find_method(method);
      const Problem pair = pair_with_ends("chain", chain.ends);
      Rows own(chain, rank);
      const Linearised near = linearised(pair, own);
      rows[rank] = predict(stepped, near);
      if (share != 1) rows[rank].h_max = share * *rows[rank].h_max;
      if (rank == 0) own.breaks_at = breaks_at;
      verify(rows[rank], stepped, near, own, [] { return false; });
    });
  for (std::thread& process : processes) process.join();
  return rows;
}

TEST(DistributedRuns, ShowTheLimitOnAnyNumberOfProcesses) {
  for (const char* method :
       {"rk4", "symplectic_euler", "velocity_verlet", "central_difference", "adams_bashforth_2"})
    for (const int ranks : {1, 3})
      for (const Prediction& row : verified(method, ranks, damped(0.1, 0))) {
        ASSERT_TRUE(row.observed) << method << row.note;
        EXPECT_TRUE(row.observed->confirms()) << method << row.note;
        EXPECT_NEAR(row.observed->gap, 0, 1e-3) << method;
      }
}

TEST(DistributedRuns, ShowTheLimitOfMethodsThatSolveEquations) {
  for (const char* method : {"newmark:beta=0.1", "newmark:beta=0.2", "explicit_newmark"})
    for (const int ranks : {1, 3})
      for (const Prediction& row : verified(method, ranks, damped(0.1, 0.01))) {
        ASSERT_TRUE(row.observed) << method << row.note;
        EXPECT_TRUE(row.observed->confirms()) << method << row.note;
        EXPECT_NEAR(row.observed->gap, 0, 1e-3) << method;
      }
}

TEST(DistributedRuns, ShowThatNoStepOfMethodsWithoutALimitGrows) {
  for (const char* method :
       {"newmark", "hht_alpha", "generalized_alpha", "implicit_euler", "trapezoidal", "implicit_midpoint",
        "tr_bdf2", "sdirk_4", "linearly_implicit_euler", "rosenbrock_23", "rodas_4"})
    for (const Prediction& row : verified(method, 2, damped(0.1, 0.01))) {
      EXPECT_EQ(row.bound, Bound::accuracy) << method;
      ASSERT_TRUE(row.observed) << method << row.note;
      EXPECT_TRUE(row.observed->agrees) << method << row.note;
    }
}

TEST(DistributedRuns, DoNotSolveComplexEquations) {
  for (const Prediction& row : verified("radau_iia_5", 2)) {
    EXPECT_FALSE(row.observed);
    EXPECT_NE(row.note.find("its equations are no real numbers"), std::string::npos) << row.note;
  }
}

TEST(DistributedRuns, ShowTheLimitOfStrongDamping) {
  for (const char* method : {"rk4", "symplectic_euler", "rk2_heun"})
    for (const Prediction& row : verified(method, 2, damped(0, 3))) {
      ASSERT_TRUE(row.observed) << method << row.note;
      EXPECT_TRUE(row.observed->confirms()) << method << row.note;
    }
}

TEST(DistributedRuns, ContradictAWrongLimitAndFindTheRightOne) {
  for (const auto& [method, share] : {std::pair{"rk4", 1.1},
                                      {"symplectic_euler", 1.1},
                                      {"symplectic_euler", 0.9},
                                      {"newmark:beta=0.1", 1.1}}) {
    const std::vector<Prediction> rows = verified(method, 2, {}, share);
    for (const Prediction& row : rows) {
      ASSERT_TRUE(row.observed) << row.note;
      EXPECT_TRUE(row.observed->contradicts()) << method << share;
      EXPECT_NEAR(row.observed->h_max * share / *row.h_max, 1, 1e-2) << method << share;
    }
    EXPECT_EQ(rows[0].observed->h_max, rows[1].observed->h_max);
  }
}

TEST(DistributedRuns, EndTogetherWhereOneProcessEndsEarly) {
  const std::vector<Prediction> rows = verified("rk4", 3, {}, 1, 5);
  for (const Prediction& row : rows) {
    ASSERT_TRUE(row.observed);
    EXPECT_EQ(row.observed->steps, rows[0].observed->steps);
  }
}

TEST(DistributedRuns, TakeAtLeastOneRowOfEachProcess) {
  for (const Prediction& row : verified("rk4", 3, {}, 1, 0, 2)) {
    EXPECT_FALSE(row.observed);
    EXPECT_NE(row.note.find("fewer"), std::string::npos) << row.note;
  }
}

/// A damper at every seventh body.
MatrixXd dampers(Eigen::Index unknowns, double strength) {
  MatrixXd C = MatrixXd::Zero(unknowns, unknowns);
  for (Eigen::Index i = 3; i < unknowns; i += 7) C(i, i) = strength;
  return C;
}

/// The prediction from all modes of matrices that are here.
Prediction from_all_modes(const Method& method, const MatrixXd& K, const MatrixXd& C) {
  MatrixModel model;
  model.K = K.sparseView();
  model.C = C.sparseView();
  model.facts.damped = true;
  model.mass = VectorXd::Ones(K.rows());
  for (Eigen::Index i = 0; i < K.rows(); ++i) model.unknowns.push_back(i);
  Problem problem{
      .id = "chain", .y0 = VectorXd::Zero(2 * K.rows()), .t_end = 1, .system = system_of(model, 0, 0)};
  return predict(method, linearised(problem));
}

TEST(DistributedLimits, AreThoseOfAllModesWhereDampingCouplesThem) {
  for (const double strength : {0.05, 1.0, 20.0}) {
    StructureEnds general;
    general.general_damping = true;
    general.gamma_max = strength;
    Chain chain(1, 40, general);
    chain.C = dampers(40, strength);
    Rows rows(chain, 0);
    const Linearised near = linearised(pair_with_ends("chain", chain.ends), rows);
    for (const char* id :
         {"rk4", "rk2_heun", "symplectic_euler", "velocity_verlet", "explicit_newmark", "newmark"}) {
      const Method method = find_method(id);
      const Prediction row = predict(method, near), all = from_all_modes(method, chain.K, chain.C);
      ASSERT_TRUE(all.h_max) << id << all.note;
      if (!row.unstable_from) {
        EXPECT_EQ(row.bound, all.bound) << id << strength;
        EXPECT_EQ(std::isfinite(*row.h_max), std::isfinite(*all.h_max)) << id << strength;
        if (std::isfinite(*all.h_max)) {
          EXPECT_NEAR(*row.h_max / *all.h_max, 1, 1e-9) << id << strength;
        }
        continue;
      }
      EXPECT_LE(row.h_max.value_or(0), *all.h_max * (1 + 1e-9)) << id << strength;
      EXPECT_GE(*row.unstable_from, *all.h_max * (1 - 1e-9)) << id << strength;
    }
  }
}

TEST(DistributedLimits, OfDampingThatCouplesModesAreNotVerified) {
  StructureEnds general;
  general.general_damping = true;
  general.gamma_max = 1;
  Chain chain(1, 40, general);
  chain.C = dampers(40, 1);
  Rows rows(chain, 0);
  const Method method = find_method("symplectic_euler");
  const Linearised near = linearised(pair_with_ends("chain", chain.ends), rows);
  Prediction row = predict(method, near);
  ASSERT_EQ(row.bound, Bound::stability);
  verify(row, method, near, rows, [] { return false; });
  EXPECT_FALSE(row.observed);
  EXPECT_NE(row.note.find("couples the modes"), std::string::npos);
}

TEST(DistributedRuns, StepMethodsOfHmaxAlone) {
  EXPECT_EQ(why_not_stepped(find_method("rk4")), "");
  EXPECT_EQ(why_not_stepped(find_method("newmark")), "");
  EXPECT_NE(why_not_stepped(find_method("imex_euler")).find("declared to be stiff"), std::string::npos);
}

}  // namespace
}  // namespace hmax
