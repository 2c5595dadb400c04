/// What a problem is: a model with all its numbers fixed, where it starts and when it ends.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "problems/any_system.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// A problem in the highest precision it is written in, for orders that double is too coarse to see.
using ExtendedSystem = BasicAnySystem<long double>;

/// Time and states as users count them. Runs begin at time 0, and positions precede velocities; a file of
/// formulas may count otherwise: what is read from users and shown to them goes through here.
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

class TissueBody;    // problems/tissue/body.hpp
struct MatrixModel;  // problems/matrices/matrix_model.hpp

/// What the model of a problem is made of. What depends on it is asked of catalogue/models/model.hpp.
enum class ModelKind {
  oscillator,  ///< of the liver, one mass
  equations,   ///< the test set, formulas, right-hand sides of a program
  body,        ///< tissue on a mesh
  matrices,    ///< of a user
  plugin       ///< a shared library, in a process of its own
};

/// A problem with all its numbers fixed.
struct Problem {
  std::string id;                                            ///< catalogue id, or the name of a user's file
  std::string material{};                                    ///< empty when it has none
  std::string note{};                                        ///< one line: where it comes from
  std::vector<std::pair<std::string, double>> parameters{};  ///< name, value; in the order of the model
  std::vector<std::string> states{};  ///< names of the components of y; of a body they have none
  std::vector<std::string> units{};   ///< of the components of y; empty where they are not known
  std::vector<std::string> idle{};    ///< names of `parameters` that change nothing here
  UserView shown{};                   ///< how users count its time and states
  Eigen::VectorXd y0{};
  double t_end = 0;  ///< default end time [s]
  bool has_exact_solution = false;
  bool stiff = false;  ///< by its nature: explicit methods need tiny steps for stability alone
  /// The solution from y0 as the problem itself knows it, shape (dim); null where it does not, and for the
  /// oscillator, whose reference knows better.
  std::function<Eigen::Vector<long double, Eigen::Dynamic>(long double t)> exact = nullptr;
  /// Two numbers on the stack are worth a type of their own; everything else is called through a pointer.
  std::variant<Oscillator, AnySystem> system;
  /// The same system in long double, where it is written in it: tissue is not.
  std::optional<ExtendedSystem> extended = std::nullopt;
  std::shared_ptr<const TissueBody> body = nullptr;       ///< null of other kinds
  bool support_by_default = false;                        ///< of a body: the user chose no support
  bool material_by_default = false;                       ///< of a body: the user gave no stiffness
  std::shared_ptr<const MatrixModel> matrices = nullptr;  ///< null of other kinds
  bool is_plugin = false;
  /// The same problem made once more, for a thread of its own: some systems have one workspace.
  std::function<Problem()> again = nullptr;

  [[nodiscard]] ModelKind kind() const {
    if (body) return ModelKind::body;
    if (matrices) return ModelKind::matrices;
    if (is_plugin) return ModelKind::plugin;
    return std::holds_alternative<Oscillator>(system) ? ModelKind::oscillator : ModelKind::equations;
  }
};

/// What a user may change of a problem.
struct ProblemSettings {
  std::string material{};                                    ///< empty: the problem's own
  std::vector<std::pair<std::string, double>> parameters{};  ///< --set name=value
  std::vector<double> y0{};                                  ///< empty: the problem's own
  std::optional<double> unit = std::nullopt;                 ///< of a mesh file: metres in one of its units
  /// Of formulas: the time at which runs begin, and at which they end, before it to go backwards [s].
  std::optional<double> t0 = std::nullopt, t_end = std::nullopt;
};

}  // namespace hmax
