/// Runs of rows that are dealt out, with threads in the place of processes.
#include <algorithm>
#include <barrier>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "bench/catalogue/catalogue.hpp"
#include "bench/distributed/distributed_runs.hpp"
#include "bench/distributed/limits_from_ends.hpp"
#include "bench/limits/predict.hpp"

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

  MatrixXd K;
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
    for (Eigen::Index i = 0; i < count_; ++i) noise_.push_back(std::sin(3.0 * static_cast<double>((begin_ + i) * (begin_ + i) + 1)));
  }

  [[nodiscard]] const StructureEnds& ends() const override { return chain_.ends; }
  [[nodiscard]] std::size_t rows() const override { return noise_.size(); }
  [[nodiscard]] std::span<const double> fastest_shape() const override { return {chain_.shape.data() + begin_, rows()}; }
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
  void add_up(std::span<double> numbers) override {
    chain_.sums[rank_].assign(numbers.begin(), numbers.end());
    chain_.meeting.arrive_and_wait();
    std::vector<double> all(numbers.size(), 0.0);
    for (const std::vector<double>& each : chain_.sums)
      for (std::size_t i = 0; i < all.size(); ++i) all[i] += each[i];
    chain_.meeting.arrive_and_wait();
    std::ranges::copy(all, numbers.begin());
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

/// The row of a method as each of so many processes has it, with `share` of the predicted limit in place of it.
std::vector<Prediction> verified(const std::string& method, int ranks, const StructureEnds& of_damping = {},
                                 double share = 1, int breaks_at = 0, Eigen::Index unknowns = 40) {
  Chain chain(ranks, unknowns, of_damping);
  std::vector<Prediction> rows(static_cast<std::size_t>(ranks));
  std::vector<std::thread> processes;
  for (std::size_t rank = 0; rank < rows.size(); ++rank)
    processes.emplace_back([&, rank] {
      const Method stepped = find_method(method);
      const Problem pair = pair_with_ends("chain", chain.ends);
      const Linearised near = linearised(pair, chain.ends);
      rows[rank] = predict(stepped, near);
      if (share != 1) rows[rank].h_max = share * *rows[rank].h_max;
      Rows own(chain, rank);
      if (rank == 0) own.breaks_at = breaks_at;
      verify(rows[rank], stepped, near, own, [] { return false; });
    });
  for (std::thread& process : processes) process.join();
  return rows;
}

TEST(DistributedRuns, ShowTheLimitOnAnyNumberOfProcesses) {
  for (const char* method : {"rk4", "symplectic_euler", "velocity_verlet", "central_difference", "adams_bashforth_2"})
    for (const int ranks : {1, 3})
      for (const Prediction& row : verified(method, ranks, damped(0.1, 0))) {
        ASSERT_TRUE(row.observed) << method << row.note;
        EXPECT_TRUE(row.observed->confirms()) << method << row.note;
        EXPECT_NEAR(row.observed->gap, 0, 1e-3) << method;
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
  for (const auto& [method, share] : {std::pair{"rk4", 1.1}, {"symplectic_euler", 1.1}, {"symplectic_euler", 0.9}}) {
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

TEST(DistributedRuns, StepExplicitMethodsOfHmaxAlone) {
  EXPECT_EQ(why_not_stepped(find_method("rk4")), "");
  EXPECT_NE(why_not_stepped(find_method("newmark")).find("newmark solves equations"), std::string::npos);
  EXPECT_NE(why_not_stepped(find_method("radau_iia_5")).find("equations"), std::string::npos);
}

}  // namespace
}  // namespace hmax
