/// hmax doctor and hmax info: what this build was made of, and on which machine it runs.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/device/device.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/shown_text.hpp"
#include "core/errors.hpp"
#include "core/instructions/instruction_set.hpp"
#include "core/ranks/module.hpp"
#include "core/ranks/ranks.hpp"
#include "limits/distributed/distributed_engine.hpp"
#include "plots/gnuplot.hpp"
#include "results/build_info.hpp"
#include "results/fingerprint.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

Json to_json(const Part& part) {
  return {{"name", part.name},
          {"version", json_or_null(part.version)},
          {"present", !part.version.empty()},
          HMAX_KEYS(part, needed_for, debian_package)};
}

/// The optional parts as they are now: gnuplot is looked for when it is used, the others were when hmax was
/// configured.
std::vector<Part> optional_parts() {
  std::vector<Part> parts = build_info().optional_parts;
  for (Part& part : parts) {
    if (part.name != "gnuplot") continue;
    if (!gnuplot_available())
      part.version.clear();
    else if (part.version.empty())
      part.version = "unknown";
  }
  return parts;
}

/// A part of hmax that is a file of its own and a target of the build.
struct Module {
  std::string target, needed_for;
  bool built = false;
  std::string broken;  ///< why it cannot be used though it is built; empty where it can
};

/// Whether a folder has a file that begins so.
bool has_file(const std::filesystem::path& folder, std::string_view beginning) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (entry.path().filename().string().starts_with(beginning)) return true;
  return false;
}

bool is_build_tree() { return std::filesystem::exists(program_prefix() / "CMakeCache.txt"); }

/// Opens a module as commands do. @returns why it cannot be opened; empty where it can
std::string why_not_opened(const std::string& file, const char* symbol) {
  try {
    symbol_of_module(file.c_str(), symbol);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

/// Has Python import the package of a build tree. @returns why it cannot; empty where it can
std::string why_not_imported(const std::filesystem::path& folder) {
  const std::string command =
      "PYTHONPATH=" + shell_word(folder.string()) + " '" HMAX_PYTHON "' -c 'import hmax' 2>&1";
  std::FILE* const python = popen(command.c_str(), "r");
  if (!python) return "Python cannot be started; install it again";
  std::string last;
  std::array<char, 1024> line;
  while (std::fgets(line.data(), static_cast<int>(line.size()), python)) last = line.data();
  if (pclose(python) == 0) return {};
  while (last.ends_with('\n')) last.pop_back();
  return fmt::format("the Python module cannot be imported: {}; build or install hmax again", last);
}

/// The modules for which the libraries were there when hmax was configured. Where an installation has its
/// Python module is known to Python alone.
std::vector<Module> modules() {
  std::vector<Module> modules;
  const auto add = [&](const char* target, const char* needed_for, const char* symbol) {
    const std::string file = std::string(target) + ".so";
    const bool built = std::filesystem::exists(module_file(file.c_str()));
    modules.push_back({target, needed_for, built, built ? why_not_opened(file, symbol) : ""});
  };
  if (has_mpi()) add("hmax_mpi", "sweeps under mpirun", make_ranks_symbol);
  if (has_distributed_engine()) add("hmax_petsc", "--engine petsc", make_engine_symbol);
  if (has_gpu_module()) add("hmax_cuda", "--device gpu", make_device_symbol);
  const std::vector<Part> parts = optional_parts();
  const auto is_there = [&](std::string_view name) {
    const auto part = std::ranges::find(parts, name, &Part::name);
    return part != parts.end() && !part->version.empty();
  };
  if (is_there("MuJoCo")) add("hmax_mujoco", "scenes of MuJoCo", "hmax_plugin_get");
  if (is_there("Bullet")) add("hmax_bullet", "scenes of Bullet", "hmax_plugin_get");
  if (is_there("minizip")) add("hmax_fmi", "units of FMI 2.0", "hmax_plugin_get");
  if (is_build_tree() && is_there("pybind11")) {
    const std::filesystem::path folder = program_prefix() / "python";
    const bool built = has_file(folder / "hmax", "_core");
    modules.push_back({"hmax_python", "the Python module", built, built ? why_not_imported(folder) : ""});
  }
  return modules;
}

/// The modules that are not there, and how to get them, and those that cannot be used; empty where all can.
std::string modules_for_people(const Console& console) {
  std::string missing, targets, broken;
  for (const Module& module : modules()) {
    if (!module.broken.empty()) broken += console.strong("Broken: ") + module.broken + "\n";
    if (module.built) continue;
    missing += fmt::format("{}{} ({})", missing.empty() ? "" : ", ", module.target, module.needed_for);
    targets += " " + module.target;
  }
  if (missing.empty()) return broken;
  return broken + console.strong("Not built: " + missing) +
         (is_build_tree()
              ? fmt::format("; cmake --build {} --target{}\n", program_prefix().string(), targets)
              : "; install the packages hmax-modules and hmax-engines, or hmax from a build that has them\n");
}

/// Whether there is a module that could use a card.
bool has_module_for_cards() {
  return has_gpu_module() && why_not_opened("hmax_cuda.so", make_device_symbol).empty();
}

/// The card, where there is one and a module that can use it.
std::optional<DeviceFacts> card() {
  if (!has_module_for_cards()) return {};
  try {
    return open_gpu()->facts();
  } catch (const InputError&) {
    return {};
  }
}

Json report() {
  const BuildInfo& build = build_info();
  Json usable = Json::array(), not_built = Json::array(), broken = Json::array();
  for (const Module& module : modules()) {
    if (!module.broken.empty())
      broken.push_back({{"name", module.target}, {"why", module.broken}});
    else
      (module.built ? usable : not_built).push_back(module.target);
  }
  const std::optional<DeviceFacts> gpu = card();
  Json libraries = Json::array(), optional = Json::array(), missing = Json::array();
  for (const Part& part : build.libraries) libraries.push_back(to_json(part));
  for (const Part& part : optional_parts()) {
    optional.push_back(to_json(part));
    if (part.version.empty()) missing.push_back(part.name);
  }
  return {HMAX_KEYS(build, version, compiler, build_type, flags, git_revision, git_dirty, sanitized),
          {"libraries", libraries},
          {"optional", optional},
          {"missing", missing},
          {"modules", usable},
          {"modules_not_built", not_built},
          {"modules_broken", broken},
          {"gpu", gpu ? Json{{"device", gpu->name}, HMAX_KEYS(*gpu, clock_mhz, driver)} : Json()},
          {"fingerprint", Json::parse(to_json(fingerprint()))}};
}

std::string parts_for_people(const Console& console) {
  TextTable table({"part", "version", "for"});
  for (const Part& part : build_info().libraries) table.add({part.name, part.version, part.needed_for});
  std::string packages;
  bool rebuild = false;
  for (const Part& part : optional_parts()) {
    const bool missing = part.version.empty();
    table.add({part.name, missing ? "missing" : part.version, part.needed_for});
    if (!missing) continue;
    packages += " " + part.debian_package;
    rebuild = rebuild || part.name != "gnuplot";
  }
  std::vector<std::string_view> sets;
  for (const InstructionSet set : instruction_sets()) sets.push_back(to_string(set));
  std::string text = fmt::format("{}\nInstruction set of the kernels: {}; HMAX_KERNELS chooses of {}\n",
                                 table.text(console), sets.front(), fmt::join(sets, ", "));
  if (const std::optional<DeviceFacts> gpu = card())
    text += fmt::format("GPU: {}, {}\n", gpu->name, gpu->driver);
  else if (has_module_for_cards())
    text += "GPU: the module for CUDA opens, and finds no card\n";
  const std::string unusable = modules_for_people(console);
  text += unusable;
  if (packages.empty()) return text + (unusable.empty() ? "Nothing is missing.\n" : "");
  return text + console.strong("To add what is missing: apt install" + packages) +
         (rebuild ? ", then configure and build again.\n" : "\n");
}

std::string machine_for_people() {
  const Fingerprint print = fingerprint();
  const BuildInfo& build = build_info();
  std::string text;
  for (const auto& [name, value] : std::initializer_list<std::pair<const char*, std::string>>{
           {"hmax", build.version},
           HMAX_KEYS(print, git, compiler),
           {"instruction set", print.instruction_set},
           {"flags", print.flags},
           {"build type", print.build_type},
           HMAX_KEYS(print, cpu, cores, caches, governor, virtualisation, kernel, load)})
    text += fmt::format("{:<15} {}\n", name, value);
  if (print.debug_build)
    text += "This is a debug or sanitized build: its times are marked and never published.\n";
  return text;
}

}  // namespace

void add_doctor(CLI::App& app, Console& console) {
  CLI::App& doctor =
      add_command(app, console, "doctor",
                  "Show the optional parts of this build, and how to add missing ones", {"hmax doctor"});
  set_callback(doctor, [&console] {
    if (console.json) return console.print_json(report());
    console.print(parts_for_people(console));
  });
  CLI::App& info = add_command(app, console, "info", "Show the build and the machine that times depend on",
                               {"hmax info --json"});
  set_callback(info, [&console] {
    if (console.json) return console.print_json(report());
    console.print(machine_for_people());
  });
}

}  // namespace hmax
