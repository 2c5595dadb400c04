#include "cli/run/checkpoint_option.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "cli/shared/options.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/part_file.hpp"
#include "core/text/digest.hpp"
#include "limits/rows/model_digest.hpp"
#include "results/build_info.hpp"
#include "results/fingerprint.hpp"

namespace hmax {

namespace {

bool is_same_file(const std::string& a, const std::string& b) {
  namespace fs = std::filesystem;
  return !b.empty() && fs::weakly_canonical(fs::absolute(behind_links(a))) ==
                           fs::weakly_canonical(fs::absolute(behind_links(b)));
}

std::string digest_of_file(const std::string& name) {
  std::ifstream in(name, std::ios::binary);
  Digest digest;
  digest.add(std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()));
  return digest.text();
}

/// All that the bits of the answer depend on, in the order in which differences are told.
std::vector<RunFact> facts_of(const CheckpointedRun& run) {
  const auto& [problem, method, spec, tableau, output, every, jobs] = run;
  const BuildInfo& build = build_info();
  const Fingerprint here = fingerprint();
  std::vector<RunFact> facts{
      {"hmax", fmt::format("{} ({})", build.version, build.git_revision.substr(0, 12))},
      {"the digest of the program", here.program},
      {"the problem", problem.id},
      {"the material", problem.material},
      {"the set of parameters", describe(problem.parameters)},
      {"--t-start", to_text(problem.shown.t0)},
      {"--t-end", to_text(problem.shown.time(spec.t_end))},
      {"the digest of the model and its start", model_digest(problem)},
      {"the method", method.id}};
  if (!method.parameters.empty())
    facts.push_back({"the method's set of parameters", describe(method.parameters)});
  if (!tableau.empty()) facts.push_back({"the digest of the tableau", digest_of_file(tableau)});
  if (spec.adaptive) {
    facts.push_back({"--rtol", to_text(spec.rtol)});
    facts.push_back({"--atol", to_text(spec.atol)});
    facts.push_back({"--control", control_of(method, spec)});
    facts.push_back({"--h0", spec.h_first > 0 ? to_text(spec.h_first) : "not given"});
    facts.push_back({"--h-max", std::isfinite(spec.h_max) ? to_text(spec.h_max) : "not given"});
  } else {
    facts.push_back({"--h", to_text(spec.h)});
  }
  facts.push_back({"--jacobian", to_string(spec.jacobian)});
  facts.push_back({"--linear", to_string(spec.linear_solve)});
  facts.push_back({"--newton-tolerance", to_text(spec.newton.tolerance)});
  facts.push_back({"--newton-iterations", std::to_string(spec.newton.iterations)});
  facts.push_back({"--max-steps", std::to_string(spec.max_steps)});
  facts.push_back({"--jobs", jobs});
  if (!output.empty()) {
    facts.push_back({"--output", output});
    facts.push_back({"--every", to_text(every)});
  }
  return facts;
}

/// Where the run goes on, on standard error, in the time of the user.
void tell(Console& console, const RunCheckpoint& checkpoint, const std::string& file,
          const CheckpointedRun& run) {
  const bool has_output = !run.output.empty();
  const bool finished = checkpoint.has_finished(reported_part);
  if (finished && (!has_output || checkpoint.has_finished(output_part)))
    console.note(fmt::format("the run is finished in {}; remove that file to run again", file));
  else if (const double t = checkpoint.resumes_at(finished ? output_part : reported_part); t >= 0)
    console.note(fmt::format("the run goes on at t = {} s from {}",
                             short_number(run.problem.shown.time(t), 10), file));
}

}  // namespace

void CheckpointChoice::add_to(CLI::App& command) {
  add_text(command, "--checkpoint", file,
           "Save the state of the run to FILE now and then, at its end, on Ctrl-C and on SIGTERM; the same "
           "command goes on from there, with the same bits",
           "FILE");
  add_number(command, "--checkpoint-every", every, "Time between two checkpoints [s]; 60 by default");
}

void CheckpointChoice::check(const std::string& output, const std::string& picture) const {
  if (file.empty()) {
    if (every) throw InputError("--checkpoint-every needs a file; add --checkpoint FILE");
    return;
  }
  if (every && !(*every >= 0 && std::isfinite(*every)))
    throw InputError(fmt::format("--checkpoint-every is {} but must be a number of seconds, not below 0",
                                 to_text(*every)));
  for (const auto& [option, other] : {std::pair{"--output", output}, {"--picture", picture}})
    if (is_same_file(file, other))
      throw InputError(fmt::format("--checkpoint and {} are one file, {}; give two names", option, file));
}

std::unique_ptr<RunCheckpoint> CheckpointChoice::open(const CheckpointedRun& run, const StopFlag* stop,
                                                      Console& console) const {
  if (file.empty()) return nullptr;
  CheckpointOptions options{.file = file,
                            .every = every.value_or(60),
                            .facts = facts_of(run),
                            .stop = [stop] { return stop->is_set(); },
                            .remark = [&console](const std::string& text) { console.remark(text); }};
  if (console.shows_progress())
    options.progress = [t_end = run.spec.t_end, progress = std::make_shared<Progress>(console, "run")](
                           double t) { progress->update(t / t_end); };
  auto checkpoint = std::make_unique<RunCheckpoint>(std::move(options));
  tell(console, *checkpoint, file, run);
  return checkpoint;
}

std::string without_checkpoints(const Method& method) {
  if (method.is_foreign())
    return fmt::format(
        "{} keeps its state inside {}, where it cannot be saved; leave --checkpoint out, or take a method "
        "of hmax",
        method.id, method.engine);
  return fmt::format(
      "the state of {} cannot be saved; leave --checkpoint out, or take another method, such as "
      "dop_853",
      method.id);
}

}  // namespace hmax
