/// What a method is, whatever its name: facts, and one erased call that runs a whole integration.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "catalogue/methods/problem.hpp"
#include "catalogue/methods/run.hpp"

namespace hmax {

struct DeviceFacts;    // catalogue/device/device.hpp
struct Amplification;  // analysis/amplification/amplification.hpp

/// Numbers by name, in a fixed order.
using Parameters = std::vector<std::pair<std::string, double>>;

/// The engine of methods that are no foreign library's.
inline constexpr std::string_view own_engine = "hmax";

/// Whether a method of positions and velocities starts a step from an acceleration that is not that of its
/// state: then a step depends on the one before.
enum class CarriedAcceleration { none, damped_only, always };

/// A method, its facts as users see them, and how it is bound to a problem. Nothing else may ask for the id
/// or the family to learn what a method does.
struct Method {
  std::string id;
  std::vector<std::string> aliases{};
  std::string family{};  ///< id of its family (families.hpp), set where the catalogue takes it
  int order = 0;         ///< 0 with !fixed_step: chosen in the run
  int error_order = 0;   ///< err = O(h^error_order), of the lowest order where that is chosen in the run; 0:
                         ///< no error estimate, fixed steps only
  int stages = 0;        ///< 0: chosen in the run
  bool is_explicit = true, needs_jacobian = false, a_stable = false, l_stable = false;
  std::string engine{own_engine};   ///< or the library that runs it, with its version
  std::string source{};             ///< bibliography key
  bool fixed_step = true;           ///< false: only adaptive runs
  bool own_control = false;         ///< steers adaptive runs by rules of its own, not by RunSpec::control
  bool needs_second_order = false;  ///< positions and velocities, M q'' = F
  bool needs_split = false;         ///< a declared stiff part
  bool linearly_implicit = false;   ///< solves linear equations alone, with one Jacobian a step
  bool stages_by_radius = false;    ///< chooses its stages by a spectral radius
  bool dense_equations = false;     ///< solves its equations with dense matrices alone
  bool first_same_as_last = false;  ///< the last stage of a step is the first of the next
  int order_undamped = 0;           ///< where forces do not depend on velocities; 0: the same
  int steps_back = 0;  ///< steps before the current one whose derivatives it reads; 0: a one-step method
  CarriedAcceleration carried_acceleration = CarriedAcceleration::none;
  bool keeps_start = false;  ///< a matrix of the state where the run began
  std::string note{};        ///< what the facts above do not tell; often empty
  /// What else keeps it from a problem, "takes ..."; empty words where nothing does, null where nothing ever
  /// does.
  std::function<std::string(const Problem&)> unsuited{};
  std::function<Runner(const Problem&)> bind{};
  std::shared_ptr<const DeviceFacts> device{};  ///< that runs it, in times of its own; null: the processor
  /// Null for methods that only run adaptively, and for those whose steps couple all points of a body.
  std::shared_ptr<const Amplification> amplification{};

  /// Of a method whose steps are of equal parts, the method of one; null: steps are whole.
  std::shared_ptr<const Method> part{};
  double parts = 1;
  /// The method whose steps tell what limits those of this one.
  [[nodiscard]] const Method& analysed() const { return part ? *part : *this; }

  /// Numbers of the method itself that a user may set, `newmark:beta=0.25,gamma=0.5`, with their values;
  /// `with` makes the method of other values and throws InputError for values that make no method.
  Parameters parameters{};
  std::function<Method(const Parameters&)> with{};

  /// The value of one of `parameters`; nothing where the method has none of that name.
  [[nodiscard]] std::optional<double> parameter(std::string_view name) const;
  [[nodiscard]] bool adaptive() const { return error_order > 0; }
  /// By Newton's method: linearly implicit ones solve linear equations. Explicit positions do not exclude it,
  /// since forces may depend on the velocity that a step ends with.
  [[nodiscard]] bool solves_nonlinear_equations() const { return needs_jacobian && !linearly_implicit; }
  /// A method that chooses its order as it runs has no order of its own.
  [[nodiscard]] bool has_variable_order() const { return order == 0 && !fixed_step; }
  /// How far a measured order may be from `order`: multistep methods and high orders show theirs only at
  /// steps that are close to rounding.
  [[nodiscard]] double order_tolerance() const { return steps_back > 0 || order >= 6 ? 0.2 : 0.1; }
  /// A foreign library runs it, by rules of its own.
  [[nodiscard]] bool is_foreign() const { return engine != own_engine; }
};

/// Whether `method` can be run on `problem` at all: positions and velocities, or a stiff part, are there if
/// it needs them.
bool suits(const Method& method, const Problem& problem);

/// Adaptive runs cannot tell beforehand how many steps they will take. One that has not ended after this many
/// attempts ends as too_many_steps unless the user sets another limit, so that a problem that oscillates
/// faster and faster, or an end time beyond all reach, does not look like a hang.
inline constexpr std::int64_t adaptive_attempts = 20'000'000;

/// Whether a problem has positions and velocities, and whether it declares a stiff part.
bool is_second_order(const Problem& problem);
bool has_split(const Problem& problem);

/// f(t, y), shape (dim). @param y  shape (dim)
Eigen::VectorXd rhs_of(const Problem& problem, double t, const Eigen::VectorXd& y);

/// Whether no acceleration of a problem with positions and velocities depends on the velocities, as nine
/// states show to the last bit.
bool is_undamped(const Problem& problem);

/// The order that a method has on a problem.
int order_on(const Method& method, const Problem& problem);

/// Whether a step of `method` on `problem` depends on steps before it, and not on its state alone.
bool depends_on_past(const Method& method, const Problem& problem);

/// The control of a run as people and stores read it: none, own, or the word of RunSpec::control.
std::string control_of(const Method& method, const RunSpec& spec);

/// Throws InputError unless `spec` can be run with `method` on a problem of this length: h, tolerances and
/// t_end positive and finite, an adaptive run only with an error estimate, no more steps than spec.max_steps,
/// a right-hand side that is finite at the start.
void check(const RunSpec& spec, const Method& method, const Problem& problem);

/// "m=1.45 c=2 k1=0.7": shortest digits that read back equal.
std::string describe(const std::vector<std::pair<std::string, double>>& parameters);

/// The same of the parameters that act on the problem, for people; "no parameters" where it has none.
std::string describe_acting(const Problem& problem);

/// "0.5,1": shortest digits that read back equal.
std::string describe(const Eigen::VectorXd& y);

/// Whether runs on a model of so many states are not worth their time: those of methods that factor a dense
/// matrix in every step.
bool is_too_slow(const Method& method, Eigen::Index states);

}  // namespace hmax
