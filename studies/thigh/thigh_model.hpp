/// A thigh of springs: points of its skin, linear springs between them, and under each point the soft tissue
/// as one non-linear spring on the bone. Two probes press it.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// A linear spring of the skin between two points.
struct SkinSpring {
  Eigen::Index i = 0, j = 0;
  bool along = false;    ///< the bone; else around it
  double stiffness = 0;  ///< k [N/m]
};

/// A half cylinder of around * along points. Point n = row * along + column moves on its line to the bone by
/// u_n [m], positive inwards. The force that holds it there is
///   r_i(u) = a_i (exp(b_i u_i) - 1) + sum_j k_ij (u_i - u_j)  [N].
/// All a, b, k > 0 make r the gradient of a convex energy: there is one equilibrium.
struct Thigh {
  Eigen::Index around = 0, along = 0;
  Eigen::VectorXd a, b;  ///< of the tissue, shape (points) [N], [1/m]
  std::vector<SkinSpring> skin;

  [[nodiscard]] Eigen::Index points() const { return around * along; }

  /// r(u), shape (points) [N].
  [[nodiscard]] Eigen::VectorXd forces(const Eigen::VectorXd& u) const;
  /// f -= r(u), both of shape (points) [N].
  void subtract_forces(const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> f) const;

  /// K = dr/du, shape (points, points) [N/m], always of one pattern.
  [[nodiscard]] Eigen::SparseMatrix<double> stiffness(const Eigen::VectorXd& u) const;
};

/// A thigh of which everything is known. Soft tissue of 33 to 77 mm with E = 4 to 12 kPa, a = E A / 6 and b =
/// 6 / depth for an area A of skin: its force has the slope E A / depth at rest and grows e-fold with each
/// sixth of the depth. A skin under a tension of 25 N/m. Depths, E and tension are assumptions; nothing was
/// measured.
/// @throws std::invalid_argument  for less than two points in a direction
Thigh true_thigh(Eigen::Index around = 8, Eigen::Index along = 8);

/// Between neighbours around and along the bone, on the skin [m].
Eigen::Vector2d point_distances();

/// Of soft tissue over the bone under each point of true_thigh(), shape (points) [m].
Eigen::VectorXd tissue_depths(const Thigh& thigh);

/// What presses the skin.
enum class Probe {
  indentor,  ///< one point
  surface,   ///< a point and its neighbours along the bone, as long as the probe of an echograph
  across,    ///< the same, turned by a right angle
};

/// @throws std::invalid_argument  for a point that the thigh does not have
std::vector<Eigen::Index> pressed_points(const Thigh& thigh, Eigen::Index point, Probe probe);

/// The equilibrium of a thigh under a probe.
struct PressedThigh {
  double depth = 0;       ///< of the pressed points [m]
  double force = 0;       ///< on the probe [N]; NaN where a force is beyond the range of numbers
  Eigen::VectorXd u;      ///< shape (points) [m]
  Eigen::VectorXd slope;  ///< du / d depth, shape (points) [1]
};

/// Presses `pressed` points to each of the depths [m], which increase, by Newton's method. It starts from the
/// last depth along the slope. r is convex and its derivative an M-matrix, so that the iterates converge
/// without a line search [ortega1970iterative, 13.3].
/// @throws std::invalid_argument  for parameters that are not positive, and depths that do not increase from
/// 0
std::vector<PressedThigh> press(const Thigh& thigh, std::span<const Eigen::Index> pressed,
                                std::span<const double> depths);

/// Derivatives of PressedThigh::force with respect to each a, each b and each k of the skin, shape
/// (2 points + springs). The points in equilibrium do not contribute to the first order, so that
/// dF/dp = slope . dr/dp.
Eigen::VectorXd force_gradient(const Thigh& thigh, const PressedThigh& at);

}  // namespace hmax
