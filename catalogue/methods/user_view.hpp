/// Time and states as users count them.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace hmax {

/// Runs begin at time 0, and positions precede velocities. A file of formulas may count otherwise: what is
/// read from users and shown to them goes through here.
struct UserView {
  double t0 = 0;         ///< when runs begin [s]
  double direction = 1;  ///< -1: runs go back in time
  std::vector<Eigen::Index>
      order{};  ///< order[i] is the place of component i of y in what users see; empty: i

  [[nodiscard]] double time(double own) const { return t0 + direction * own; }
  [[nodiscard]] double own_time(double t) const { return direction * (t - t0); }
  /// @param y  shape (dim)
  [[nodiscard]] Eigen::VectorXd state(const Eigen::Ref<const Eigen::VectorXd>& y) const {
    Eigen::VectorXd shown = y;
    for (std::size_t i = 0; i < order.size(); ++i) shown[order[i]] = y[static_cast<Eigen::Index>(i)];
    return shown;
  }
  [[nodiscard]] Eigen::VectorXd own_state(const Eigen::VectorXd& shown) const {
    Eigen::VectorXd y = shown;
    for (std::size_t i = 0; i < order.size(); ++i) y[static_cast<Eigen::Index>(i)] = shown[order[i]];
    return y;
  }
  /// Words of the components, such as names.
  template <class Words>
  [[nodiscard]] Words in_order(const Words& own) const {
    Words shown = own;
    for (std::size_t i = 0; i < order.size(); ++i) shown[static_cast<std::size_t>(order[i])] = own[i];
    return shown;
  }
};

}  // namespace hmax
