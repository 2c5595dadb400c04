/// Equilibria of a planar field: where Newton's method arrives, judged by the field around them.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "analysis/dynamics/phase_plane.hpp"

namespace hmax {

/// How often f turns around zero while y goes once around the border of the window, counter-clockwise: the
/// sum of the indices of all zeros inside [strogatz2015nonlinear] section 6.8. The border is halved until f
/// turns by less than pi / 4 from one look to the next; nothing where f is zero or not finite on it. (1 / 2
/// pi) of the total change of the angle of f. Zero does not say that there are no zeros inside: a saddle (-1)
/// and a node (+1) cancel.
/// @param slides  whether f is a field: where it jumps it turns the shorter way, as for motions that slide
///                along the jump [filippov1988differential]. Where another function jumps there is no degree.
/// @return  an integer; the indices of nodes, foci and centres are +1, of saddles -1
std::optional<int> degree_around(const std::function<Eigen::Vector2d(const Eigen::Vector2d&)>& f,
                                 const Window& window, bool slides = false);

/// The equilibria in a window that Newton's method finds, each once.
///
/// No size of f decides what is one. Around a point that Newton's method reaches boxes grow from rounding
/// upwards, each 8 times as large as the one before, and Newton's steps start from the border of each. The
/// window gives the sizes of the boxes, and rounding may hide no more than a quarter of it:
///   - one step leads into the inner quarter, in two boxes of a row: a simple zero;
///   - some steps lead into the box before: an isolated zero of higher order, or one that rounding hides,
///     `degenerate`;
///   - neither in any box: it is not isolated if it is a zero at all, such as a point of a line of them.
/// The smallest box tells how well the point is known, the largest what else is the same point. Where J
/// jumps from one side of the smallest to the other the zero is a kink, and has the type of the piecewise
/// linear field around it.
class Equilibria {
 public:
  /// @throws std::invalid_argument when the window is empty or not finite
  Equilibria(const PlanarField& field, const Window& window);
  Equilibria(const Equilibria&) = delete;

  /// Newton's method from `start`; what it reaches in the window is kept if it is new.
  /// @param leash  in sizes of the window: how far from the start it may stray before it is given up
  void take(const Eigen::Vector2d& start, double leash = std::numeric_limits<double>::infinity());
  Eigen::Vector2d rhs(const Eigen::Vector2d& y) { return field_.rhs(y); }
  /// Newton's method from the centres of 15 x 15 cells.
  void take_grid();

  /// By how much J differs between points of the border of a box of half widths r, as a share of itself.
  double change_of_slopes(const Eigen::Vector2d& y, const Eigen::Vector2d& r);
  /// Whether a known equilibrium lies in this box.
  [[nodiscard]] bool holds(const Window& box) const;
  /// Whether an equilibrium is known that is the only one in all of this box.
  [[nodiscard]] bool covers(const Window& box) const;
  [[nodiscard]] bool isolated() const { return isolated_; }
  /// Nothing where one of them has no index.
  [[nodiscard]] std::optional<int> index_sum() const;
  /// By first then second component.
  [[nodiscard]] std::vector<Equilibrium> points() const;
  [[nodiscard]] std::size_t count() const { return known_.size(); }
  /// Evaluations of f and J.
  [[nodiscard]] std::int64_t evaluations() const { return evaluations_; }

 private:
  /// Half widths of the smallest and the largest box of a ladder that Newton's steps return to.
  struct Boxes {
    Eigen::Vector2d inner, outer;
    bool from_rounding;  ///< no smaller one has been tried
  };
  struct Known {
    Equilibrium point;
    Eigen::Vector2d reach;  ///< half widths of the box in which there is no other
  };

  std::optional<Eigen::Vector2d> step(const Eigen::Vector2d& y);
  bool returns(const Eigen::Vector2d& y, const Eigen::Vector2d& r, const Eigen::Vector2d& to, int steps);
  std::optional<Boxes> boxes(const Eigen::Vector2d& y, int steps);
  Eigen::Vector2d bend(const Eigen::Vector2d& y, const Eigen::Vector2d& r);
  Eigen::Vector2d rounding(const Eigen::Vector2d& y, const Eigen::Vector2d& small,
                           const Eigen::Vector2d& large);
  bool is_simple(const Eigen::Vector2d& y, const Boxes& found);
  bool is_hidden_zero(const Eigen::Vector2d& y, const Boxes& found);
  bool has_neighbours(const Eigen::Vector2d& y, const Eigen::Vector2d& r);
  double ratio_of_units(const Eigen::Vector2d& y, const Eigen::Vector2d& r);
  bool is_kink(const Eigen::Vector2d& y, const Eigen::Vector2d& r);
  void judge_kink(const Boxes& found, Equilibrium& e);
  void judge(Eigen::Vector2d y, bool arrived);
  [[nodiscard]] bool is_known(const Eigen::Vector2d& y) const;

  PlanarField field_;
  Window window_;
  Eigen::Vector2d size_;
  std::vector<Known> known_;
  bool isolated_ = true;
  std::int64_t evaluations_ = 0;
};

}  // namespace hmax
