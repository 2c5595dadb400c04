/// The stiffness that steps show which rest elsewhere at each size, against their closed form.
#include "limits/fidelity/steps_stiffness.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/says.hpp"

namespace hmax {
namespace {

/// x'' = g - k x by implicit Euler, half of whose correction is made: at rest x = g (2 / k + h^2).
class HalfCorrected final : public ForeignStepper {
 public:
  explicit HalfCorrected(double k, double g = 10, double x = 0) : k_(k), g_(g), y_(x, 0.0) {}
  [[nodiscard]] std::string name() const override { return "half"; }
  [[nodiscard]] Eigen::Index dim() const override { return 2; }
  [[nodiscard]] bool has_hidden_state() const override { return false; }
  Eigen::VectorXd state() override { return y_; }
  void set_state(const Eigen::VectorXd& y) override { y_ = y; }
  bool step(double h, std::int64_t count) override {
    for (std::int64_t i = 0; i < count; ++i) {
      const double aim = y_[0] + h * y_[1] + h * h * g_;
      const double x = aim - 0.5 * h * h * k_ * aim / (1 + h * h * k_);
      y_ << x, (x - y_[0]) / h;
    }
    return true;
  }
  void save(int slot) override { slots_.at(static_cast<std::size_t>(slot)) = y_; }
  void restore(int slot) override { y_ = slots_.at(static_cast<std::size_t>(slot)); }

 private:
  double k_, g_;
  Eigen::Vector2d y_;
  std::array<Eigen::VectorXd, 3> slots_;
};

std::unique_ptr<ForeignStepper> with(double c) { return std::make_unique<HalfCorrected>(100 * c); }

/// Small steps sag by d = 20 / k but for h0, and steps of c k by d / c + 10 (h^2 - h0^2).
TEST(StepsStiffness, IsThatOfTheSagAndHasItsCeiling) {
  const double h0 = 1e-3;
  for (const double h : {0.01, 0.1}) {
    const double more = 10 * (h * h - h0 * h0) / 0.2;
    const StepsStiffness seen = stiffness_of_steps(with, h0, h);
    EXPECT_NEAR(seen.shown, 1 / (1 + more), 1e-4) << h;
    EXPECT_NEAR(seen.ceiling, 1 / more, 1e-3 / more) << h;
  }
}

TEST(StepsStiffness, OfTheStepsOfTheModelIsAll) {
  const StepsStiffness seen = stiffness_of_steps(with, 1e-3, 1e-3);
  EXPECT_NEAR(seen.shown, 1, 1e-6);
  EXPECT_TRUE(std::isinf(seen.ceiling));
}

TEST(StepsStiffness, RefusesWhatDoesNotDependOnIt) {
  EXPECT_TRUE(
      says(error_of<InputError>([] { stiffness_of_steps([](double) { return with(1); }, 1e-3, 0.1); }),
           "does not depend on the stiffness"));
  // Without a load what is left of the start is rounding.
  EXPECT_TRUE(says(error_of<InputError>([] {
                     stiffness_of_steps(
                         [](double c) { return std::make_unique<HalfCorrected>(100 * c, 0, 1); }, 1e-3, 0.1);
                   }),
                   "load the body"));
}

}  // namespace
}  // namespace hmax
