/// hmax probe: the largest stable step of an engine or of a scene of one, from its steps alone.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/dynamics/growth.hpp"
#include "analysis/foreign_steps/step_probe.hpp"
#include "catalogue/plugin/plugin_sources.hpp"
#include "catalogue/plugin/plugin_stepper.hpp"
#include "cli/scene.hpp"
#include "cli/shared/choices.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/work_limit.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "limits/documents/method_json.hpp"
#include "limits/documents/number_json.hpp"
#include "limits/fidelity/steps_stiffness.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

struct ProbeOptions {
  std::string scene, keyframe, plugin, example, stiffness;
  ProblemChoice body;  ///< of a scene of Bullet
  std::optional<double> h0, h1, motion, timeout, time_limit;
  bool no_runs = false;
};

/// About what a step costs that crosses to another process and back [s].
constexpr double call_seconds = 1e-5;

std::string length_in_words(double h) {
  return std::isnan(h) ? "-" : std::isinf(h) ? "beyond h1" : short_number(h, 7) + " s";
}

std::string multiplier_in_words(std::complex<double> mu) {
  if (!std::isfinite(mu.real()) || !std::isfinite(mu.imag())) return "-";
  const double imaginary = std::abs(mu.imag());
  return imaginary < 1e-6 * std::abs(mu)
             ? short_number(mu.real())
             : fmt::format("{} ± {}i", short_number(mu.real()), short_number(imaginary));
}

/// "12 % away" from where steps of h0 settle.
std::string rest_in_words(const StepSpectrum& row) {
  if (!row.settles || !*row.settles) return row.settles ? "no" : "-";
  constexpr double rounding = 1e-6;
  return !(row.settled_moves > rounding) ? "yes" : short_number(100 * row.settled_moves, 3) + " % away";
}

std::string table_of(const ProbedLimit& found, const Console& console) {
  TextTable table({"h [s]", found.state == ProbedState::motion ? "mean growth of a step" : "spectral radius",
                   "growing multiplier", "", "settles", "slowest mode [rad/s]", "damping ratio"});
  for (const StepSpectrum& row : found.rows) {
    const ShownMode* mode = row.modes.empty() ? nullptr : &row.modes.front();
    table.add({short_number(row.h, 7),
               std::isinf(row.spectral_radius) ? "infinite" : short_number(row.spectral_radius, 8),
               row.grows ? multiplier_in_words(row.multiplier) : "-", row.grows ? "grows" : "",
               rest_in_words(row), mode ? short_number(mode->omega_shown, 4) : "-",
               mode ? short_number(mode->zeta_shown, 2) : "-"});
  }
  return table.text(console);
}

/// What the growing motion is like from step to step.
std::string critical_in_words(const ProbedLimit& found) {
  if (!found.critical) return "";
  std::string text;
  if (std::isfinite(std::abs(found.critical->multiplier)))
    text = ": " + motion_in_words(found.critical->multiplier) + " grows";
  if (!found.moving.empty())
    text += fmt::format("{} numbers {} of the state move most", text.empty() ? ":" : ";",
                        fmt::join(found.moving, ", "));
  return text;
}

/// Where the number behind NAME= stands in the argument of a plugin: its first character, and how many.
/// @throws InputError  where there is none, or it is not positive
std::pair<std::size_t, std::size_t> place_of_number(const std::string& argument, const std::string& name) {
  const std::string sign = name + "=";
  for (std::size_t at = argument.find(sign); at != argument.npos; at = argument.find(sign, at + 1)) {
    if (at > 0 && (std::isalnum(static_cast<unsigned char>(argument[at - 1])) || argument[at - 1] == '_'))
      continue;
    const std::size_t begin = at + sign.size(),
                      end = std::min(argument.find_first_of(",;:& ", begin), argument.size());
    const std::optional<double> value = to_number(argument.substr(begin, end - begin));
    if (value && *value > 0 && std::isfinite(*value)) return {begin, end - begin};
  }
  throw InputError(fmt::format(
      "--stiffness {0}: the argument of the plugin has no {0}=NUMBER that is positive; give for instance "
      "--plugin FILE.so:NAME:{0}=5000",
      name));
}

/// The stiffness that steps show, in units of the parameter: at h1, or at the largest step that does not
/// grow.
struct ProbedStiffness {
  double value = 0;  ///< that was entered
  StepsStiffness shown;
};

std::optional<ProbedStiffness> stiffness_of(const ProbeOptions& options, double h0, const ProbedLimit& found,
                                            const std::function<void(double, std::string_view)>& watch,
                                            const PluginSettings& settings) {
  if (options.stiffness.empty() || std::isnan(found.h_max)) return std::nullopt;
  const PluginName plugin = parse_plugin(options.plugin);
  const auto [begin, count] = place_of_number(plugin.argument, options.stiffness);
  const double value = *to_number(plugin.argument.substr(begin, count));
  double h = h0;
  for (const StepSpectrum& row : found.rows)
    if (!row.grows) h = std::max(h, row.h);
  const auto with = [&, begin = begin, count = count](double c) {
    PluginName scaled = plugin;
    scaled.argument.replace(begin, count, to_text(c * value));
    return std::make_unique<PluginStepper>(scaled, settings);
  };
  return ProbedStiffness{value, stiffness_of_steps(with, h0, h, watch)};
}

std::string in_words(const ProbedStiffness& stiffness, const std::string& name) {
  const auto in_digits = [&](double share) { return short_number(share * stiffness.value, 4); };
  const StepsStiffness& seen = stiffness.shown;
  std::string text = fmt::format("stiffness {}={} ", name, short_number(stiffness.value));
  text += std::isnan(seen.shown)
              ? fmt::format("settles nowhere at {} s", short_number(seen.h, 7))
              : fmt::format("shows {} at {} s", in_digits(seen.shown), short_number(seen.h, 7));
  if (std::isinf(seen.ceiling))
    text += ", and all that is entered";
  else if (!std::isnan(seen.ceiling))
    text += ", and at most " + in_digits(seen.ceiling) + " whatever is entered";
  return text + "\n";
}

Json to_json(const ProbedStiffness& stiffness, const std::string& name) {
  return {{"parameter", name},
          {"value", stiffness.value},
          {"h", stiffness.shown.h},
          {"shown", number_or_word(stiffness.shown.shown * stiffness.value)},
          {"ceiling", number_or_word(stiffness.shown.ceiling * stiffness.value)}};
}

std::string in_words(const ProbeOptions& options, const ProbedLimit& found, const std::string& note,
                     const Console& console) {
  const std::string from =
      options.scene.empty()
          ? std::filesystem::path(options.plugin.substr(0, options.plugin.find(':'))).filename().string()
          : note;
  std::string text = fmt::format("{} {} {}: {} numbers, ", found.model, options.scene.empty() ? "of" : "in",
                                 from, found.dim);
  text += found.state == ProbedState::equilibrium ? "in equilibrium"
          : found.state == ProbedState::motion
              ? fmt::format("along the motion to {} s", short_number(*options.motion))
              : "at its initial state";
  text += "\n\n" + table_of(found, console) + "\n";
  text +=
      fmt::format("h_max     {}{}\n", console.strong(length_in_words(found.h_max)), critical_in_words(found));
  if (!options.no_runs) {
    text += "observed  " + length_in_words(found.observed);
    if (std::isfinite(found.gap)) text += fmt::format(", gap {} %", short_number(100 * found.gap, 2));
    if (found.steps > 0) text += fmt::format(", in runs of {} steps", found.steps);
    text += "\n";
  }
  for (const std::string& remark : found.status) text += remark + "\n";
  return text;
}

void write_examples(const ProbeOptions& options, Console& console) {
  if (!options.plugin.empty() || !options.scene.empty())
    throw InputError("--example writes files and probes nothing; leave out the scene and --plugin");
  Json files = Json::array();
  std::string text;
  for (const std::filesystem::path& file : write_plugin_examples(options.example)) {
    files.push_back(file.string());
    text += file.string() + "\n";
  }
  console.show({{"files", files}}, text);
}

/// What is asked of, and between which step sizes: those of a scene are derived from its own.
struct Question {
  SceneName scene;
  PluginName plugin;
  PluginSettings settings;
};

/// From a hundredth to a hundred times the step size that the scene asks for, where none are given.
ProbeSettings sizes_of(const ProbeOptions& options, const std::optional<double>& own) {
  if (!own && (!options.h0 || !options.h1))
    throw InputError("give the step sizes to look at, like --h0 1e-4 --h1 0.1");
  if (options.motion && !(*options.motion > 0 && std::isfinite(*options.motion)))
    throw InputError(fmt::format("--motion {} is no length of time; give it in seconds, like 2",
                                 to_text(*options.motion)));
  const double h0 = options.h0 ? *options.h0 : *own / 100, h1 = options.h1 ? *options.h1 : 100 * *own;
  ProbeSettings settings;
  settings.h0 = h0;
  settings.h1 = options.motion && !options.h1 ? std::min(h1, *options.motion) : h1;
  settings.motion = options.motion;
  settings.observe = !options.no_runs;
  settings.most_seconds = time_limit_of(options.time_limit);
  if (options.motion && settings.h0 > 0)
    refuse_endless(
        {.asked = fmt::format("--motion {} with --h0 {}", to_text(*options.motion), to_text(settings.h0)),
         .count = *options.motion / settings.h0,
         .seconds_each = call_seconds,
         .most_seconds = time_limit_of(options.time_limit),
         .remedy = "take a shorter --motion or a larger --h0, or raise --time-limit"});
  return settings;
}

/// @throws InputError  for options that do not belong together
Question question_of(const ProbeOptions& options) {
  if (!options.plugin.empty() && !options.scene.empty())
    throw InputError("a scene and --plugin are given, and one is probed; remove one");
  if (options.plugin.empty() && options.scene.empty())
    throw InputError(
        "give a scene of MuJoCo (model.xml), a robot (robot.urdf) or a body (body.vtk) for Bullet, a unit of FMI 2.0 "
        "(unit.fmu), the library of your stepper with --plugin FILE.so, or --example FOLDER to begin with one");
  if (options.h0 && options.h1) sizes_of(options, {});  // refused before anything is opened
  Question question{.scene = {options.scene, options.keyframe, !options.motion, options.body},
                    .plugin = {},
                    .settings = {}};
  if (options.scene.empty()) {
    if (!options.keyframe.empty())
      throw InputError("--keyframe is one of a scene; give it in ARGUMENT of --plugin");
    const MeshOptions& body = options.body.body;
    if (!body.unit.empty() || !body.model.empty() || !body.supports.empty() ||
        !options.body.material.empty() || !options.body.set.empty())
      throw InputError("--unit, --model, --material, --set and --support are of a scene; remove them");
    question.plugin = parse_plugin(options.plugin);
    if (!options.stiffness.empty() && options.motion)
      throw InputError("--stiffness is asked of a state of rest; remove --motion");
  } else {
    if (!options.stiffness.empty())
      throw InputError("--stiffness is asked of a --plugin; what a scene shows is told without it");
    question.plugin = plugin_of(question.scene);
  }
  // A scene comes to rest in one call.
  question.settings.patience = options.timeout.value_or(options.scene.empty() ? 10 : 60);
  return question;
}

/// What was found.
struct Answer {
  std::string note;
  ProbedLimit limit;
  std::optional<OwnStep> own;
  std::optional<ProbedStiffness> stiffness;
};

void print(const ProbeOptions& options, const Answer& answer, Console& console) {
  if (answer.limit.contradiction) console.exit_code = Exit::failed;
  if (console.json) {
    Json document = probe_json(answer.limit);
    if (!options.scene.empty()) document["engine"] = answer.note;
    if (answer.own) document.update(own_step_json(*answer.own));
    if (!options.stiffness.empty())
      document["stiffness"] = answer.stiffness ? to_json(*answer.stiffness, options.stiffness) : Json();
    return console.print_json(document);
  }
  console.print(in_words(options, answer.limit, answer.note, console) +
                (answer.own ? in_words(*answer.own, answer.limit) : "") +
                (answer.stiffness ? in_words(*answer.stiffness, options.stiffness) : ""));
}

Answer answer_of(const ProbeOptions& options, Question question, Console& console) {
  const std::atomic<bool>& interrupted = interrupt_flag();
  const auto leave = [&] {
    if (interrupted) throw Interrupted{};
  };
  question.settings.watch = leave;
  PluginStepper engine(question.plugin, question.settings);
  if (!options.stiffness.empty()) place_of_number(question.plugin.argument, options.stiffness);
  Progress progress(console, "probe");
  const auto watch = progress.watcher();
  ProbeSettings settings = sizes_of(options, engine.own_step());
  settings.watch = watch;
  Answer answer{.note = engine.note(), .limit = probe_steps(engine, settings), .own = {}, .stiffness = {}};
  if (!options.scene.empty()) answer.limit.model = std::filesystem::path(options.scene).filename().string();
  answer.own = examine_own_step(engine, answer.limit, watch);
  answer.stiffness = stiffness_of(options, settings.h0, answer.limit, watch, question.settings);
  return answer;
}

void probe(const ProbeOptions& options, Console& console) {
  if (!options.example.empty()) return write_examples(options, console);
  const Question question = question_of(options);
  print(options, answer_of(options, question, console), console);
}

/// What a scene of Bullet takes beside its file.
void add_body(CLI::App& command, ProblemChoice& body) {
  const HelpGroup group(command, "Bullet");
  add_repeated(
      command, "--support", body.body.supports,
      "Points of a body that are fixed, as `hmax stability predict --help` has them; or the base of a robot, by "
      "its name; nothing by default",
      "SET");
  add_text(command, "--unit", body.body.unit, "Unit of the mesh of a body: m, cm, mm or a number of metres",
           "UNIT");
  add_text(command, "--model", body.body.model,
           "Force of a body: fem_neo_hookean or fem_corotational; fem_neo_hookean by default", "ID");
  add_text(command, "--material", body.material, "Material of a body, an id of `hmax list materials`", "ID");
  add_repeated(command, "--set", body.set, "Change a parameter of a body: E, nu, rho, mass, beta, g, ...",
               "NAME=VALUE");
}

}  // namespace

void add_probe(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "probe", "Find the largest stable step of a scene, or of your own step function",
      {"hmax probe model.xml --keyframe home", "hmax probe --example probe_example",
       "hmax probe robot.urdf --support base_link",
       "hmax probe body.vtk --unit m --set E=20000 --support 'z<0.01'",
       "hmax probe --plugin ./plugin_stepper.so --h0 1e-4 --h1 0.1",
       "hmax probe --plugin ./engine.so:bar:E=5000 --h0 1e-4 --h1 0.01 --stiffness E",
       "hmax probe --plugin ./engine.so:scene:ball.xml --h0 1e-4 --h1 0.01 --motion 2 --json"},
      probe);
  add_text(
      command, "scene", options.scene,
      "A scene of MuJoCo, a robot.urdf or a body.vtk, .vtu or .msh for Bullet, or a unit of FMI 2.0 (unit.fmu); h0 and "
      "h1 are a hundredth and a hundred times its timestep",
      "model.xml");
  add_text(command, "--keyframe", options.keyframe,
           "The scene settles from this keyframe, or begins --motion there", "NAME|NUMBER");
  add_body(command, options.body);
  add_text(command, "--plugin", options.plugin, "A shared library with a stepper, see hmax/plugin.h",
           "FILE.so[:NAME[:ARGUMENT]]");
  add_number(command, "--h0", options.h0, "The smallest step size [s]");
  add_number(command, "--h1", options.h1, "The largest step size [s]");
  add_number(command, "--motion", options.motion,
             "Growth of neighbours along the motion of this length [s], instead of one step at the start");
  add_number(command, "--timeout,--patience", options.timeout,
             "Timeout of one call of the plugin [s], 60 of a scene; 10 by default");
  add_time_limit(command, options.time_limit);
  add_text(command, "--stiffness", options.stiffness,
           "A stiffness that stands as NAME=NUMBER in ARGUMENT: how much of it steps show, and at most",
           "NAME");
  add_flag(command, "--no-runs", options.no_runs, "Do not run the engine on both sides of the limit");
  add_text(command, "--example", options.example,
           "Write the header and two examples into this folder, and end", "FOLDER");
}

}  // namespace hmax
