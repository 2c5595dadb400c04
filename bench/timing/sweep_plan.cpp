/// What a sweep will measure, checked before anything runs, and the store it may write to.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "bench/timing/sweep.hpp"
#include "catalogue/device/device.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/methods/tableau_file.hpp"
#include "catalogue/models/model.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "problems/tissue/body.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Name of the note in which a store keeps the sweep it was made by.
constexpr const char* sweep_note = "sweep";

/// Limit of the output kept in memory at a time: 1.6 GB.
constexpr double largest_output = 2e8;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

ChosenMethods methods_of(const SweepSpec& spec, const std::vector<Problem>& problems) {
  const bool is_default = spec.methods.empty() && spec.tableaux.empty();
  ChosenMethods chosen = chosen_methods(is_default ? study_methods() : spec.methods, problems);
  if (spec.place) {
    std::vector<LeftOut> not_there;
    spec.place(problems, chosen.methods, not_there);
    std::erase_if(chosen.methods, [](const Method& method) { return !method.device; });
    std::ranges::move(not_there, std::back_inserter(chosen.left_out));
  }
  if (is_default) chosen.left_out.clear();  // nobody has named them
  for (const fs::path& file : spec.tableaux) chosen.methods.push_back(make_method(read_tableau(file)));
  return chosen;
}

/// Adds the methods of a plan that no block runs.
void name_methods_without_block(SweepPlan& plan) {
  std::set<std::size_t> run;
  for (const SweepBlock& block : plan.blocks) run.insert(block.methods.begin(), block.methods.end());
  for (std::size_t m = 0; m < plan.methods.size(); ++m) {
    if (run.contains(m)) continue;
    const Method& method = plan.methods[m];
    add_once(
        plan.left_out,
        LeftOut{method.id, method.adaptive() ? "chooses its steps itself, and these runs have fixed steps"
                                             : "has no error estimate, which these runs need"});
  }
}

template <class Wanted>
std::vector<std::size_t> indices_of(const std::vector<Method>& methods, const Wanted& wanted) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < methods.size(); ++i)
    if (wanted(methods[i])) indices.push_back(i);
  return indices;
}

void check_settings(const SweepSpec& spec) {
  if (spec.problems.empty())
    throw InputError("a sweep needs at least one problem; `hmax list problems` shows them");
  if (spec.repeats < 9 && !spec.explore)
    throw InputError(
        fmt::format("a sweep takes the median and quartiles of at least 9 repetitions, not of {}; give "
                    "--repeats 9 or more",
                    spec.repeats));
  if (spec.repeats > 10'000)
    throw InputError(fmt::format(
        "{} repetitions are more than the limit of 10000; give --repeats 9 or a few more", spec.repeats));
  if (!spec.h.empty() && !spec.fixed && !spec.sampled)
    throw InputError("steps need a reading; give --fixed, --sampled or both");
  if (spec.h.empty() && spec.tolerances.empty() && spec.unsteered_h.empty())
    throw InputError("a sweep needs steps or tolerances; give --h or --rtol");
}

std::vector<SweepBlock> blocks_of(const SweepSpec& spec, const std::vector<Problem>& problems,
                                  const std::vector<Method>& methods) {
  const auto adaptive = indices_of(methods, [](const Method& m) { return m.adaptive(); });
  const auto steppable = indices_of(methods, [](const Method& m) { return m.fixed_step; });
  const auto unsteered = indices_of(methods, [](const Method& m) { return !m.adaptive(); });
  std::vector<SweepBlock> blocks;
  for (std::size_t p = 0; p < problems.size(); ++p) {
    const RunSpec base{.t_end = spec.t_end.value_or(problems[p].t_end),
                       .control = spec.control,
                       .max_steps = spec.max_steps};
    const auto add = [&](std::string mode, const RunSpec& run, const std::vector<std::size_t>& chosen) {
      if (!chosen.empty())
        blocks.push_back({.problem = p, .mode = std::move(mode), .run = run, .methods = chosen});
    };
    for (const double h : spec.h) {
      RunSpec run = base;
      run.h = h;
      if (spec.fixed) add("fixed", run, steppable);
      // An output interval of zero would mean no output: what is no step is refused as one in both readings.
      if (!(h > 0) || !std::isfinite(h)) check(run, methods.front(), problems[p]);
      run = base;
      run.adaptive = true;
      run.rtol = spec.sampled_tolerance.rtol;
      run.atol = spec.sampled_tolerance.atol;
      run.every = h;
      if (spec.sampled) add("sampled", run, adaptive);
    }
    for (const double h : spec.unsteered_h) {
      RunSpec run = base;
      run.h = h;
      add("fixed", run, unsteered);
    }
    for (const Tolerance& tolerance : spec.tolerances) {
      RunSpec run = base;
      run.adaptive = true;
      run.rtol = tolerance.rtol;
      run.atol = tolerance.atol;
      add("adaptive", run, adaptive);
    }
  }
  return blocks;
}

/// @throws InputError  of methods none of which runs as is asked for
void refuse_without_block(const SweepSpec& spec) {
  if (spec.fixed)
    throw InputError(
        "all of these methods choose their steps themselves; give --sampled in place of --fixed, or --rtol in place "
        "of --h");
  throw InputError(
      "none of these methods has the error estimate that --sampled needs; give --fixed, or choose a method "
      "whose error_order in `hmax list methods` is not 0");
}

void check_block(const SweepBlock& block, const std::vector<Problem>& problems,
                 const std::vector<Method>& methods) {
  const Problem& problem = problems[block.problem];
  for (const std::size_t m : block.methods) check(block.run, methods[m], problem);
  if (block.run.every == 0) return;
  const double numbers = block.run.t_end / block.run.every * static_cast<double>(problem.y0.size()) *
                         static_cast<double>(block.methods.size());
  if (numbers > largest_output)
    throw InputError(
        fmt::format("output of {} every {} s to t = {} s by {} methods would keep {:.3g} numbers in memory, "
                    "more than the limit of {:.0e}; take a larger --h, fewer --methods, or --fixed",
                    problem.id, to_text(block.run.every), to_text(block.run.t_end), block.methods.size(),
                    numbers, largest_output));
}

/// A number that changes with a mesh, in hexadecimal: files are told apart by what is in them
/// [fowler2019fnv].
std::string mesh_in_digits(const TetMesh& mesh) {
  std::uint64_t hash = 14695981039346656037ULL;
  const auto add = [&](const auto& matrix) {
    for (const std::byte byte :
         std::as_bytes(std::span(matrix.data(), static_cast<std::size_t>(matrix.size()))))
      hash = (hash ^ std::to_integer<std::uint64_t>(byte)) * 1099511628211ULL;
  };
  add(mesh.points);
  add(mesh.tetrahedra);
  return fmt::format("{:016x}", hash);
}

std::string canonical_text(const SweepSpec& spec, const std::vector<Problem>& problems,
                           const std::vector<Method>& methods) {
  json problem_list = json::array(), method_list = json::array(), tolerances = json::array();
  for (std::size_t i = 0; i < problems.size(); ++i) {
    const Problem& problem = problems[i];
    json entry{HMAX_KEYS(problem, id, material),
               {"parameters", describe(problem.parameters)},
               {"y0", start_in_words(problem)},
               {"t_end", spec.t_end.value_or(problem.t_end)}};
    if (const std::string& name = spec.problems[i].name; problem_kind(name) == ProblemKind::formulas)
      entry["text"] = text_of(name);
    if (problem.body) entry["mesh"] = mesh_in_digits(problem.body->mesh());
    problem_list.push_back(std::move(entry));
  }
  const std::size_t catalogued = methods.size() - spec.tableaux.size();
  for (std::size_t i = 0; i < methods.size(); ++i) {
    if (i < catalogued)
      method_list.push_back(methods[i].id);
    else
      method_list.push_back(json{{"id", methods[i].id}, {"text", text_of(spec.tableaux[i - catalogued])}});
  }
  json readings = json::array();
  if (spec.fixed && !spec.h.empty()) readings.push_back("fixed");
  if (spec.sampled && !spec.h.empty()) readings.push_back("sampled");
  for (const Tolerance& tolerance : spec.tolerances)
    tolerances.push_back(json::array({tolerance.rtol, tolerance.atol}));
  const DeviceFacts* device = methods.front().device.get();
  json text{{"problems", problem_list},
            {"methods", method_list},
            {"device", device ? device->name : "cpu"},
            {"driver", device ? device->driver : ""},
            HMAX_KEYS(spec, h, unsteered_h),
            {"readings", readings},
            HMAX_KEYS(spec.sampled_tolerance, rtol, atol),
            {"tolerances", tolerances},
            {"control", to_string(spec.control)},
            HMAX_KEYS(spec, repeats, max_steps, min_sample_s)};
  // Measured sweeps have none, like those of an earlier hmax.
  if (spec.explore) text["explore"] = true;
  return text.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void refuse_duplicates(const SweepPlan& plan) {
  std::set<RowKey> seen;
  for (const SweepBlock& block : plan.blocks)
    for (const std::size_t m : block.methods) {
      const RowKey key = row_key(plan, block, m);
      if (!seen.insert(key).second)
        throw InputError(
            fmt::format("{} with {} would be measured twice at {} = {}; give every problem, method, step and "
                        "tolerance once",
                        key.problem, key.method, key.mode == "adaptive" ? "rtol" : "h",
                        to_text(key.mode == "adaptive" ? key.rtol : key.h)));
    }
}

/// "h was [2.0] and is [1.0]", or only "h differs" where that would fill the screen.
std::string difference(const std::string& stored, const std::string& asked) {
  constexpr std::size_t longest = 100;
  const json before = json::parse(stored, nullptr, false), now = json::parse(asked);
  if (!before.is_object()) return "its description cannot be read";
  if (before.contains("explore") != now.contains("explore"))
    return before.contains("explore") ? "it was explored" : "it was measured, not explored";
  for (const auto& [key, value] : now.items()) {
    const std::string was = before.contains(key) ? before[key].dump() : "absent", is = value.dump();
    if (was == is) continue;
    return was.size() + is.size() <= longest ? fmt::format("{} was {} and is {}", key, was, is)
                                             : fmt::format("its {} differ", key);
  }
  return "it has settings unknown to this hmax";
}

}  // namespace

std::vector<std::string> study_methods() {
  return {"explicit_runge_kutta", "rosenbrock_23", "adams_pece", "trapezoidal"};
}

std::int64_t SweepPlan::rows() const {
  std::int64_t rows = 0;
  for (const SweepBlock& block : blocks) rows += static_cast<std::int64_t>(block.methods.size());
  return rows;
}

double expected_cost(const SweepPlan& plan, const SweepBlock& block,
                     const std::vector<std::size_t>& methods) {
  // Of two numbers, a stage or a point; sparse models grow with their numbers.
  const double each = 15e-9 * std::max(1.0, static_cast<double>(plan.problems[block.problem].y0.size()) / 2);
  double total = 0;
  for (const std::size_t m : methods) {
    double run = 0;
    if (block.mode == "fixed") run = block.run.t_end / block.run.h * plan.methods[m].stages * each;
    if (block.mode == "sampled") run = block.run.t_end / block.run.every * each;
    // Short runs with all that is around them, and runs whose evaluations nobody knows before, as they were
    // measured.
    const bool is_known = block.mode == "fixed" && plan.methods[m].stages > 0;
    const double counted = std::max(run, is_known ? 1e-3 : 5e-3);
    total +=
        plan.spec.repeats_runs() ? std::max(run, plan.spec.min_sample_s) * (plan.spec.repeats + 2) : counted;
  }
  return total;
}

SweepPlan shard_of(SweepPlan plan, Shard shard) {
  if (shard.index < 1 || shard.index > shard.count)
    throw InputError(fmt::format("shard {} of {} does not exist; shards count from 1 to {}", shard.index,
                                 shard.count, std::max(1, shard.count)));
  double total = 0, before = 0;
  for (const SweepBlock& block : plan.blocks) total += expected_cost(plan, block, block.methods);
  std::vector<SweepBlock> own;
  for (const SweepBlock& block : plan.blocks) {
    const double cost = expected_cost(plan, block, block.methods);
    // The shard in whose stretch of the cost the middle of the block lies.
    const double middle = (before + cost / 2) / total;
    if (std::min(shard.count, 1 + static_cast<int>(middle * shard.count)) == shard.index)
      own.push_back(block);
    before += cost;
  }
  plan.blocks = std::move(own);
  return plan;
}

RowKey row_key(const SweepPlan& plan, const SweepBlock& block, std::size_t method) {
  const Problem& problem = plan.problems[block.problem];
  const RunSpec& run = block.run;
  const DeviceFacts* device = plan.methods[method].device.get();
  return {.problem = problem.id,
          .material = problem.material,
          .parameters = describe(problem.parameters),
          .y0 = start_in_words(problem),
          .method = plan.methods[method].id,
          .mode = block.mode,
          .control = control_of(plan.methods[method], run),
          .device = device ? device->name : "",
          .precision = device ? "double" : "",
          .h = run.adaptive ? run.every : run.h,
          .rtol = run.rtol,
          .atol = run.atol,
          .t_end = run.t_end};
}

SweepPlan plan_sweep(const SweepSpec& spec) {
  check_settings(spec);
  SweepPlan plan{.spec = spec};
  for (const SweepProblem& problem : spec.problems)
    plan.problems.push_back(make_problem(problem.name, problem.settings));
  ChosenMethods chosen = methods_of(spec, plan.problems);
  plan.methods = std::move(chosen.methods);
  plan.left_out = std::move(chosen.left_out);
  if (!spec.tolerances.empty() && spec.unsteered_h.empty() &&
      std::ranges::none_of(plan.methods, &Method::adaptive))
    throw InputError(
        "tolerances need a method with an error estimate; choose one whose error_order in `hmax list "
        "methods` is not 0, or give --h");
  plan.blocks = blocks_of(spec, plan.problems, plan.methods);
  if (plan.blocks.empty()) refuse_without_block(spec);
  for (SweepBlock& block : plan.blocks) {
    check_block(block, plan.problems, plan.methods);
    if (block.run.adaptive) block.run.max_steps = std::min(block.run.max_steps, adaptive_attempts);
  }
  refuse_duplicates(plan);
  if (!spec.methods.empty() || !spec.tableaux.empty()) name_methods_without_block(plan);
  plan.canonical = canonical_text(spec, plan.problems, plan.methods);
  return plan;
}

bool can_resume(const SweepPlan& plan, const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return true;
  const Store store = Store::open_existing(file);
  const auto notes = store.notes();
  const auto made_by = notes.find(sweep_note);
  return store.size() == 0 || (made_by != notes.end() && made_by->second == plan.canonical);
}

Store open_sweep_store(const SweepPlan& plan, const fs::path& file, bool resume) {
  Store store = Store::open_or_create(file);
  const std::int64_t rows = store.size();
  if (rows == 0) {
    store.note(sweep_note, plan.canonical);
    return store;
  }
  if (!resume)
    throw InputError(fmt::format(
        "the store '{}' holds {} rows already; give --resume to continue that sweep, or another --out",
        file.string(), rows));
  const auto notes = store.notes();
  const auto made_by = notes.find(sweep_note);
  if (made_by == notes.end())
    throw InputError(
        fmt::format("the store '{}' was not made by a sweep; give another --out", file.string()));
  if (made_by->second != plan.canonical)
    throw InputError(fmt::format(
        "the store '{}' was made by another sweep: {}; give the same sweep to --resume, or another --out",
        file.string(), difference(made_by->second, plan.canonical)));
  return store;
}

void require_publishable_build() {
  if (fingerprint().debug_build)
    throw InputError(
        "a debug build is not measured for --publish; build with `cmake --preset release`, or leave "
        "--publish out");
}

void mark_published(Store& store) {
  for (const Session& session : store.sessions())
    if (session.fingerprint.debug_build)
      throw InputError(
          fmt::format("the store '{}' holds rows of a debug build and cannot be published; measure again "
                      "with another --out",
                      store.file().string()));
  if (const auto rows = store.rows(); std::ranges::any_of(rows, &Row::explored))
    throw InputError(fmt::format(
        "the store '{}' holds explored rows, whose times are approximate, and cannot be published; "
        "go on with --resume in one process, without --explore",
        store.file().string()));
  store.note("published", "yes");
}

}  // namespace hmax
