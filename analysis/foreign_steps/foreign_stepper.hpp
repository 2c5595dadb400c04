/// An engine that advances a state of its own, of which only the steps are known.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace hmax {

/// A part of a scene that has a stiffness or a damping, in its own units; 0 where it has none.
struct ScenePart {
  std::string kind, name;  ///< "joint", "elbow"
  double stiffness = 0, damping = 0;
};

/// A state is a vector of shape (dim). What else the next steps depend on, such as the start of an iteration
/// or a cache of contacts, is hidden in the engine, and is kept in numbered slots.
class ForeignStepper {
 public:
  virtual ~ForeignStepper() = default;

  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual Eigen::Index dim() const = 0;
  /// Steps are computed in float.
  [[nodiscard]] virtual bool is_single_precision() const { return false; }
  /// False: the state is all that is kept.
  [[nodiscard]] virtual bool has_hidden_state() const = 0;
  /// First index of each four numbers of the state that are a unit quaternion.
  [[nodiscard]] virtual std::vector<Eigen::Index> quaternions() const { return {}; }
  /// Sizes of noticeable changes of the state, shape (dim); empty where they are not known.
  [[nodiscard]] virtual Eigen::VectorXd scales() const { return {}; }
  /// An entry (i, j) where number i after a step depends on number j before it, shape (dim, dim); values do
  /// not matter. Empty where it is not known.
  [[nodiscard]] virtual Eigen::SparseMatrix<double> pattern() const { return {}; }

  /// The step size that the scene asks for [s].
  [[nodiscard]] virtual std::optional<double> own_step() const { return {}; }
  /// Those that can be scaled.
  [[nodiscard]] virtual std::vector<ScenePart> parts() const { return {}; }
  /// From now on a part has these factors of its stiffness and damping in the scene.
  virtual void scale_part(std::size_t /*part*/, double /*stiffness*/, double /*damping*/) {}

  virtual Eigen::VectorXd state() = 0;
  virtual void set_state(const Eigen::VectorXd& y) = 0;
  /// Advances by `count` steps of size h [s]. @returns false where a step says that it cannot be done
  virtual bool step(double h, std::int64_t count) = 0;
  virtual void save(int slot) = 0;
  virtual void restore(int slot) = 0;

  /// The state after `count` steps from y, with what is hidden as in the slot; NaN where a step cannot be
  /// done.
  virtual Eigen::VectorXd after(int slot, const Eigen::VectorXd& y, double h, std::int64_t count);
  /// One step from what is in the slot, which then holds its end. @returns the state there, NaN where it
  /// cannot be done
  virtual Eigen::VectorXd advance(int slot, double h);
};

/// Coordinates of states near others: differences of the numbers, and three for each quaternion, in the frame
/// that it turns. Along a motion the frames go with it.
class StateCoordinates {
 public:
  /// @throws std::invalid_argument  where quaternions overlap or lie outside of a state
  StateCoordinates(Eigen::Index dim, const std::vector<Eigen::Index>& quaternions);

  [[nodiscard]] Eigen::Index size() const { return size_; }
  /// The state at the coordinates x near y: quaternions q + B(q) x, normalised, with B(q) = q i, q j, q k.
  [[nodiscard]] Eigen::VectorXd at(const Eigen::VectorXd& y, const Eigen::VectorXd& x) const;
  /// The coordinates of z near y; q and -q are one rotation.
  [[nodiscard]] Eigen::VectorXd of(const Eigen::VectorXd& y, const Eigen::VectorXd& z) const;
  /// Numbers of the state as coordinates: those of a quaternion have its largest.
  [[nodiscard]] Eigen::VectorXd scales(const Eigen::VectorXd& of_state) const;
  /// The pattern of a step in coordinates, shape (size, size). @param of_state  as ForeignStepper::pattern(),
  /// not empty
  [[nodiscard]] Eigen::SparseMatrix<double> pattern(const Eigen::SparseMatrix<double>& of_state) const;
  /// Index in the state of a coordinate; of a quaternion its first one.
  [[nodiscard]] Eigen::Index component(Eigen::Index coordinate) const {
    return owner_[static_cast<std::size_t>(coordinate)];
  }

 private:
  Eigen::Index size_ = 0;
  std::vector<Eigen::Index> owner_;  ///< shape (size)
  std::vector<bool> turns_;          ///< shape (size): of a quaternion
};

}  // namespace hmax
