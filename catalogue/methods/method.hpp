/// What a problem and a method are, whatever their names: facts, and one erased call that runs a whole
/// integration.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "catalogue/methods/run.hpp"
#include "catalogue/methods/user_view.hpp"
#include "problems/any_system.hpp"
#include "problems/oscillator/oscillator.hpp"

namespace hmax {

/// A problem in the highest precision it is written in, for orders that double is too coarse to see.
using ExtendedSystem = BasicAnySystem<long double>;

class TissueBody;    // problems/tissue/body.hpp
struct DeviceFacts;  // catalogue/device/device.hpp
struct MatrixModel;  // problems/matrices/matrix_model.hpp

/// A problem with all its numbers fixed.
struct Problem {
  std::string id;                                            ///< catalogue id, or the name of a user's file
  std::string material{};                                    ///< empty when it has none
  std::string note{};                                        ///< one line: where it comes from
  std::vector<std::pair<std::string, double>> parameters{};  ///< name, value; in the order of the model
  std::vector<std::string> states{};                         ///< names of the components of y
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
  std::shared_ptr<const TissueBody> body = nullptr;  ///< of tissue, whose states have no names
  std::vector<std::int64_t>
      tetrahedron_numbers{};  ///< of it, as users know them (catalogue/models/equilibria/body_balance.hpp)
  std::vector<std::string> idle{};                        ///< names of `parameters` that change nothing here
  UserView shown{};                                       ///< how users count its time and states
  std::shared_ptr<const MatrixModel> matrices = nullptr;  ///< of matrices of a user
  bool support_by_default = false;  ///< of a body: the user chose neither its fixed points nor their end
  bool runs_elsewhere = false;      ///< in a process of its own, which keeps a core busy beside the caller's
  /// The same problem made once more, for a thread of its own: some systems have one workspace.
  std::function<Problem()> again = nullptr;
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
