/// hmax stability predict
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "catalogue/methods/choice/formulas.hpp"
#include "catalogue/models/problems.hpp"
#include "cli/bodies/body_words.hpp"
#include "cli/scene.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/device_option.hpp"
#include "cli/shared/mpirun.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "cli/stability/limit_answer.hpp"
#include "cli/stability/operating_point.hpp"
#include "cli/stability/stability.hpp"
#include "core/errors.hpp"
#include "limits/along/motion_run.hpp"
#include "limits/distributed/distributed_engine.hpp"
#include "limits/distributed/distributed_problem.hpp"
#include "limits/distributed/limits_from_ends.hpp"
#include "limits/distributed/query_distributed.hpp"
#include "problems/matrices/exchanged.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

/// What --along looks along.
constexpr std::array<std::string_view, 3> path_names{"motion", "load", "none"};

/// What computes eigenvalues: hmax itself, or PETSc with SLEPc.
constexpr std::array<std::string_view, 2> engine_names{"hmax", "petsc"};

struct PredictOptions {
  ProblemChoice problem;
  DeviceChoice device;
  MethodsChoice methods;
  std::string materials, along, out, jacobian, linear;
  bool verify = false;
  std::string engine;
  OperatingPointChoice at;
  std::optional<double> t_end;
  const CLI::Option* jobs = nullptr;
};

/// --jacobian and --linear; nothing where none of them is given.
/// @throws InputError  for words that are none, and where nothing would change
std::optional<StepChoices> step_options(const PredictOptions& options, const std::vector<Method>& methods) {
  if (options.jacobian.empty() && options.linear.empty()) return std::nullopt;
  StepChoices chosen;
  if (!options.jacobian.empty()) chosen.jacobian = jacobian_update_from(options.jacobian);
  if (!options.linear.empty()) chosen.linear = linear_solve_from(options.linear);
  if (chosen.jacobian.every == JacobianUpdate::automatic) chosen.jacobian = StepChoices{}.jacobian;
  if (chosen.linear.by == LinearSolve::By::automatic) chosen.linear = StepChoices{}.linear;
  if (std::ranges::none_of(methods, takes_step_options))
    throw InputError(
        "--jacobian and --linear apply to linearly implicit methods, and no method given is one; remove them, or add "
        "one like linearly_implicit_euler");
  if (!options.along.empty() && options.along != path_names[2])
    throw InputError(fmt::format(
        "--along {} holds for the exact Jacobian of each state and cannot be combined with --jacobian and "
        "--linear; remove one of them",
        options.along));
  return chosen;
}

/// The question that the options ask of problems like this one.
LimitQuestion question_of(const PredictOptions& options, const std::vector<Method>& methods,
                          const Problem& problem) {
  std::string path = options.along;
  if (!path.empty()) path = parse_choice("--along", path, path_names);
  std::vector<std::string> names;
  if (!options.methods.names.empty()) names = parse_names("--methods", options.methods.names);
  return with_path({.at = options.at.of(problem),
                    .verify = options.verify,
                    .t_end = options.t_end,
                    .options = step_options(options, methods),
                    .named = named_one_by_one(names, methods)},
                   path, problem);
}

/// Ids of a list; all: both ends of the mass range of every material.
std::vector<std::string> materials_of(const PredictOptions& options) {
  if (options.materials.empty()) return {options.problem.material};
  if (!options.problem.material.empty())
    throw InputError("--material and --materials are both given; choose one of them");
  std::vector<std::string> ids;
  for (const std::string& name : parse_names("--materials", options.materials)) {
    if (name != "all") {
      ids.push_back(name);
      continue;
    }
    for (const LiverMaterial& material : liver_materials())
      for (const char* end : {":light", ":heavy"}) ids.push_back(std::string(material.id) + end);
  }
  return ids;
}

/// @throws InputError  where --verify names a formula without code
void require_code(const std::vector<Method>& methods) {
  for (const Method& method : methods)
    if (!method.bind)
      throw InputError(fmt::format(
          "{} is a formula that nothing in hmax steps with, so there are no runs to verify it by; "
          "leave out --verify, or name methods of `hmax list methods`",
          method.id));
}

/// @throws InputError  for options that --engine petsc does not have
void refuse_beside_engine(const PredictOptions& options) {
  const auto refuse = [](bool given, std::string_view option, std::string_view remedy) {
    if (given) throw InputError(fmt::format("--engine petsc does not take {}; {}", option, remedy));
  };
  constexpr std::string_view remove = "remove it, or leave out --engine";
  refuse(!options.out.empty(), "--out", "keep what --json prints");
  refuse(options.device.is_gpu(), "--device gpu", remove);
  refuse(!options.along.empty() && options.along != path_names[2], "--along", remove);
  const bool is_body =
      options.problem.body.is_given() || problem_kind(options.problem.problem) == ProblemKind::body;
  refuse(!options.materials.empty(), "--materials", "take one with --material, or leave out --engine");
  refuse(!is_body && !options.problem.material.empty(), "materials of matrices", remove);
  refuse(!options.jacobian.empty() || !options.linear.empty(), "--jacobian and --linear", remove);
  refuse(!options.problem.y0.empty(), "--y0", remove);
  refuse(!is_body && !options.at.at.empty(), "--at of matrices", remove);
  refuse(is_given(options.jobs), "--jobs", "start it with mpirun -n N");
  if (is_body && options.at.at != "rest")
    throw InputError(
        fmt::format("--engine petsc takes a body at rest alone; {} --at rest, or leave out --engine",
                    options.at.at.empty() ? "add" : "write"));
}

std::string words_of(const StructureEnds& ends, const DistributedEngine& engine) {
  return fmt::format(
      "{} unknowns on {} {}, {} entries of stiffness, {}; {}\nfastest mode {:.6g} rad/s, residual {:.1g} ({}, {} restarts)\n",
      ends.unknowns, engine.ranks(), engine.ranks() == 1 ? "process" : "processes", ends.entries,
      ends.coupled_mass ? "a mass that couples unknowns" : "a mass for each unknown", engine.version(),
      std::sqrt(std::max(ends.kappa_max, 0.0)), ends.residual, ends.solver, ends.iterations);
}

/// The step of a scene beside the limit of its own integrator.
struct SceneAnswer {
  const Scene& scene;
  const LimitRow& row;
  double limit;  ///< [s]; infinite or not a number where there is none

  SceneAnswer(const Scene& read, const LimitRow& of_integrator)
      : scene(read),
        row(of_integrator),
        limit(row.lacks_equilibrium() ? LimitRow::none : row.known_limit()) {}

  /// Nothing where it is not known.
  [[nodiscard]] std::optional<bool> is_within() const {
    if (!scene.step || std::isnan(limit)) return std::nullopt;
    // Without a limit of small motions that of others tells only which steps are too long.
    if (std::isnan(row.h_max) && *scene.step <= limit) return std::nullopt;
    return *scene.step <= limit;
  }

  [[nodiscard]] std::string why_not_judged() const {
    if (row.lacks_equilibrium())
      return "the equilibrium under its load was not found; --at rest goes without it";
    if (row.bound == name_of(Bound::model)) return "the model itself grows, whatever the step is";
    return row.note.empty() ? "its limit is not known" : row.note;
  }

  [[nodiscard]] std::string in_words() const {
    const std::string of = fmt::format("with {} ({})", scene.integrator, scene.method);
    const std::string with =
        scene.step ? fmt::format("the step of {:.4g} s {}", *scene.step, of) : "no step given, " + of;
    if (row.bound == name_of(Bound::every_step) && !row.lacks_equilibrium())
      return fmt::format("every step {} grows, however small; take another integrator\n", of);
    if (std::isinf(limit)) return with + " has no limit of stability\n";
    const std::optional<bool> within = is_within();
    if (std::isnan(limit) || (scene.step && !within))
      return fmt::format("{} is not judged: {}\n", with, why_not_judged());
    if (!scene.step) return fmt::format("{} is stable up to {:.4g} s\n", with, limit);
    if (*within) return fmt::format("{} is below the limit, {} s\n", with, limit_beside(limit, *scene.step));
    const bool grows = row.bound == name_of(Bound::stability) && !(*scene.step < row.h_unstable);
    return fmt::format("{} is {}: at most {} s\n", with, grows ? "unstable" : "above the limit",
                       limit_beside(limit, *scene.step));
  }

  [[nodiscard]] Json to_json() const {
    const auto or_null = [](bool given, const auto& value) { return given ? Json(value) : Json(nullptr); };
    const std::optional<bool> within = is_within();
    return {HMAX_KEYS(scene, integrator, method),
            {"h", or_null(scene.step.has_value(), scene.step.value_or(0))},
            {"h_max", or_null(std::isfinite(limit), limit)},
            {"within", or_null(within.has_value(), within.value_or(false))}};
  }
};

/// Nothing without a scene, and where a stop came before its row.
std::optional<SceneAnswer> answer_of(const Scene* scene, const LimitAnswer& answer) {
  if (!scene || answer.models.empty() || answer.models.front().rows.empty()) return std::nullopt;
  return SceneAnswer(*scene, answer.models.front().rows.front());
}

/// The scene whose own integrator is asked for, since no other method is; null where there is none.
const Scene* take_integrator(PredictOptions& options) {
  const MeshOptions& body = options.problem.body;
  if (body.scene.empty() || !options.methods.names.empty() || !options.methods.tableau.empty())
    return nullptr;
  static_cast<void>(options.problem.id());  // which refuses a second model
  const Scene& scene = body.read();
  if (scene.method.empty())
    throw InputError(fmt::format("{} has no integrator; name a method with --methods", body.scene));
  if (materials_of(options).size() > 1)
    throw InputError(
        "the step of a scene is judged for one material; give one with --material, or name methods with --methods");
  options.methods.names = scene.method;
  return &scene;
}

/// Predicts, verifies where that is asked for, and prints limits of matrices, and of bodies at rest, that lie
/// in pieces on many processes; called by all ranks.
/// @throws InputError  for models other than symmetric matrices and bodies, and where none of the methods can
/// be verified
void print_distributed_limits(DistributedEngine& engine, const PredictOptions& options, const Scene* scene,
                              Console& console) {
  const ProblemChoice& choice = options.problem;
  const bool verified = options.verify;
  DistributedProblem asked;
  engine.together([&] { asked = distributed_problem(choice.id(), choice.settings()); });
  choice.body.remark_scene(console);
  for (const std::string& sentence : asked.remarks) console.remark(sentence);
  if (asked.body)
    for (const std::string& sentence : unusual_values(*asked.body)) console.remark(sentence);
  // Before minutes are spent on eigenvalues: whatever they are, the methods are the same.
  StructureEnds any;
  any.kappa_max = 1;
  const std::vector<Method> chosen = options.methods.methods({pair_with_ends(choice.id(), any)}, console);
  if (verified) require_steps(chosen);
  const std::unique_ptr<DistributedModel> model = engine.read(std::move(asked.structure));
  const StructureEnds& ends = model->ends();
  if (ends.look_exchanged) console.remark(exchanged_matrices);
  std::vector<Problem> pair{pair_with_ends(choice.id(), ends)};
  if (asked.body) pair[0].parameters = asked.parameters;
  pair[0].material = choice.material;
  const LimitQuestion question{.at = AskedState::rest, .verify = verified};
  const LimitAnswer answer = query_distributed(engine, *model, pair[0], asked.body, chosen, verified,
                                               [] { return interrupt_flag().load(); });
  if (answer.stopped) throw Interrupted{};
  judge(answer, question, console);
  const std::optional<SceneAnswer> of_scene = answer_of(scene, answer);
  if (console.json) {
    Json document = answer_json(answer, pair);
    if (of_scene) document["scene"] = of_scene->to_json();
    console.print_json(document);
  } else {
    console.print(words_of(answer, question, pair, console,
                           (asked.body ? in_words(*asked.body) + "\n" : "") + words_of(ends, engine)));
    if (of_scene) console.print(of_scene->in_words());
  }
  console.flush();
}

void predict_by_engine(PredictOptions options, Console& console) {
  // First of all: while it is open rank 0 alone prints, errors too.
  const std::unique_ptr<DistributedEngine> engine = open_distributed_engine();
  refuse_beside_engine(options);
  const Scene* const scene = take_integrator(options);
  print_distributed_limits(*engine, options, scene, console);
}

void print(const LimitAnswer& answer, const LimitQuestion& question, const std::vector<Problem>& problems,
           const std::optional<Store>& store, const std::optional<SceneAnswer>& scene, Console& console) {
  if (console.json) {
    Json document = answer_json(answer, problems);
    if (scene) document["scene"] = scene->to_json();
    if (store) {
      document["store"] = store->file().string();
      document["looked_up"] = answer.looked_up;
    }
    return console.print_json(document);
  }
  console.print(words_of(answer, question, problems, console));
  if (scene) console.print(scene->in_words());
  if (!store || answer.stopped) return;  // what a stop leaves is told at the end
  std::size_t rows = 0;
  for (const ModelLimits& model : answer.models) rows += model.rows.size();
  console.print(fmt::format("{} limits in {}: {} computed, {} looked up\n", rows, store->file().string(),
                            rows - answer.looked_up, answer.looked_up));
}

/// What an interrupted query leaves.
Interrupted interrupted_with(const LimitAnswer& answer, const std::optional<Store>& store) {
  std::size_t printed = 0;
  for (const ModelLimits& model : answer.models) printed += model.rows.size();
  const std::size_t kept = answer.looked_up + answer.stored;
  if (!store && printed > 0) return {"the rows so far are printed"};
  if (kept == printed)
    return Interrupted::with_store(store ? store->file().string() : "", static_cast<std::int64_t>(printed));
  return {fmt::format("the rows so far are printed, {} of {} are kept in {}", kept, printed,
                      store->file().string())};
}

void predict_rows(PredictOptions options, Console& console) {
  const Scene* const scene = take_integrator(options);
  if (!options.out.empty()) refuse_copies("hmax stability predict --out");
  std::vector<Problem> problems;
  for (const std::string& material : materials_of(options)) {
    ProblemChoice choice = options.problem;
    choice.material = material;
    problems.push_back(choice.make());
  }
  std::vector<Method> methods = options.methods.methods(problems, console);
  const LimitQuestion question = question_of(options, methods, problems.front());
  options.device.check({});
  if (options.device.is_gpu() && !options.verify)
    throw InputError("--device gpu is for the runs of --verify; give both, or leave it out");
  // Runs of the others stay on the processor: what they show is the same, bit by bit.
  if (std::vector<LeftOut> others; options.device.is_gpu())
    static_cast<void>(options.device.place(problems, methods, others));
  if (options.verify) require_code(methods);
  for (const Problem& problem : problems) remark_unusual(console, problem);
  options.problem.remark_idle(console, problems.front(), std::ranges::any_of(methods, takes_step_options));
  std::optional<Store> store;
  if (!options.out.empty()) store = Store::open_or_create(store_path(options.out));
  const LimitAnswer answer = [&] {
    LimitProgress progress(console, question);
    // A user's tableau may change under its name.
    LimitStore kept{.store = store ? &*store : nullptr, .looks_up = options.methods.tableau.empty()};
    return query_limits(question, problems, methods, kept, console.json, progress);
  }();
  warn_of_states(answer, problems, console);
  judge(answer, question, console);
  print(answer, question, problems, store, answer_of(scene, answer), console);
  if (answer.stopped) throw interrupted_with(answer, store);
}

void predict(const PredictOptions& options, Console& console) {
  if (!options.engine.empty() && parse_choice("--engine", options.engine, engine_names) == engine_names[1])
    predict_by_engine(options, console);
  else
    predict_rows(options, console);
}

}  // namespace

void add_stability_predict(CLI::App& stability, Console& console) {
  const auto [command, options] = add_command(
      stability, console, "predict",
      "Predict the largest stable step of methods on a model, and the mode that limits it",
      {"hmax stability predict --problem liver_benchmark --materials all --methods rk4,ode45",
       "hmax stability predict --problem liver_benchmark --methods explicit_runge_kutta,structural --verify --json",
       "hmax stability predict --problem liver_forced --methods rk4,symplectic_euler --along --verify",
       "hmax stability predict --mesh phantom --load press --methods rk4 --along load",
       "hmax stability predict --mesh phantom --methods rosenbrock --jacobian frozen --verify"},
      predict);
  options.problem.add_to(command);
  add_text(command, "--materials", options.materials,
           "Ids of `hmax list materials`; all: both ends of the mass range of each", "A,B");
  options.methods.add_to(command);
  add_flag(command, "--verify", options.verify,
           "Verify each limit by integration on both sides of it; exit 1 when one is wrong, or none "
           "could be verified");
  add_text(
      command, "--engine", options.engine,
      "What finds the eigenvalues of --matrices, and of a mesh --at rest: hmax, or petsc, which under `mpirun -n N` "
      "distributes the rows over N processes; hmax by default",
      "hmax|petsc");
  options.device.add_to(command, "the steps of --verify");
  options.at.add_to(command);
  add_text(
      command, "--jacobian", options.jacobian,
      "Jacobian of linearly implicit methods: exact, every:K steps, or frozen, that of the initial state; "
      "exact by default",
      "POLICY");
  add_text(command, "--linear", options.linear,
           "Linear solver of linearly implicit methods on bodies: direct, cg:TOLERANCE or "
           "cg:TOLERANCE,ITERATIONS; direct by default",
           "SOLVER");
  set_implicit_value(
      add_text(
          command, "--along", options.along,
          "Also the smallest limit along the motion from the initial state, at " + in_words(motion_shares) +
              " of the size of the motion, and the largest step that runs of it show to be safe (of large models with --verify), or the limit of a "
              "body while its load grows; "
              "motion for models that are not known to be linear and for loads that change with time, else none, by default",
          "motion|load|none"),
      std::string(path_names[0]));
  add_number(
      command, "--t-end", options.t_end,
      "End of the motion of --along [s]; the problem's own, and at least a period of its load, by default");
  add_text(command, "--out", options.out,
           "Store of the limits; those that it has are looked up: a file that ends in .sqlite, or a name "
           "under results/runs; none by default",
           "STORE");
  options.jobs = add_jobs(command);
}

}  // namespace hmax
