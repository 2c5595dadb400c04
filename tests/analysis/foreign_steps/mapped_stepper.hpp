/// An engine whose step is a function.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include <Eigen/Core>

#include "analysis/foreign_steps/foreign_stepper.hpp"

namespace hmax {

/// y -> map(y, h), in double or rounded to float.
class Mapped : public ForeignStepper {
 public:
  using Map = Eigen::VectorXd (*)(const Eigen::VectorXd& y, double h);
  Mapped(Map map, Eigen::VectorXd y, bool single = false) : map_(map), y_(std::move(y)), single_(single) {}
  std::string name() const override { return "mapped"; }
  Eigen::Index dim() const override { return y_.size(); }
  bool is_single_precision() const override { return single_; }
  bool has_hidden_state() const override { return false; }
  Eigen::VectorXd state() override { return y_; }
  void set_state(const Eigen::VectorXd& y) override { y_ = rounded(y); }
  bool step(double h, std::int64_t count) override {
    for (; count > 0; --count) y_ = rounded(map_(y_, h));
    return true;
  }
  void save(int) override { saved_ = y_; }
  void restore(int) override { y_ = saved_; }

 private:
  Eigen::VectorXd rounded(const Eigen::VectorXd& y) const {
    return single_ ? Eigen::VectorXd(y.cast<float>().cast<double>()) : y;
  }
  Map map_;
  Eigen::VectorXd y_, saved_;
  bool single_;
};

}  // namespace hmax
