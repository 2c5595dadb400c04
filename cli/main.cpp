/// The program `hmax`: the application, and the one place where exceptions become exit codes.
#include <algorithm>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/last_resort.hpp"
#include "cli/shared/mpirun.hpp"
#include "core/errors.hpp"
#include "core/instructions/instruction_set.hpp"
#include "core/own_files.hpp"
#include "core/process/heap.hpp"
#include "results/build_info.hpp"
#include "results/patience.hpp"

namespace hmax {

namespace {

constexpr const char* overview =
    R"(hmax benchmarks ODE integrators and analyses their stability on soft-tissue models.

  hmax list methods      the integrators
  hmax list problems     what they integrate
  hmax run --problem liver_forced --method ode45 --rtol 1e-6 --atol 1e-9
                         one run: where it ends and what it costs
  hmax --help            all commands; `hmax COMMAND --help` shows examples
)";

/// The deepest subcommand that was recognised.
const CLI::App& reached(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : reached(*chosen.back());
}

std::string command_line_of(const CLI::App& command) {
  return command.get_parent() ? command_line_of(*command.get_parent()) + " " + command.get_name() : "hmax";
}

/// One sentence for the first argument that nothing expected.
std::string unexpected(const CLI::App& app) {
  const CLI::App& command = reached(app);
  const std::string name = command_line_of(command);
  std::string wrong = app.remaining(true).front();
  std::vector<std::string> known;
  const bool option = wrong.starts_with('-');
  if (option) {
    wrong = wrong.substr(0, wrong.find('='));
    for (const CLI::Option* each : command.get_options())
      for (const std::string& long_name : each->get_lnames()) known.push_back("--" + long_name);
  } else {
    for (const CLI::App* each : command.get_subcommands({})) known.push_back(each->get_name());
  }
  const char* what = option ? "unknown option" : known.empty() ? "unexpected argument" : "unknown command";
  return fmt::format("{} '{}'{}; {}", what, wrong, name == "hmax" ? "" : " of `" + name + "`",
                     suggestion(wrong, known, "`" + name + " --help` shows what there is"));
}

/// The first option of one value that has several.
const CLI::Option* repeated(const CLI::App& command) {
  const auto options = command.get_options();
  const auto found = std::ranges::find_if(options, [](const CLI::Option* each) {
    return each->get_items_expected_max() == 1 && each->count() > 1;
  });
  return found == options.end() ? nullptr : *found;
}

/// An error of the parser as one sentence.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) && !app.remaining(true).empty()) return unexpected(app);
  if (const CLI::Option* option = repeated(reached(app)))
    return fmt::format("{} is given {} times; give it once", option->get_name(), option->count());
  // "--h: 1 required NUMBER missing"
  const std::string what = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) && what.ends_with(" missing"))
    return fmt::format("{} has no value; give it one, as `{} --help` shows", what.substr(0, what.find(':')),
                       command_line_of(reached(app)));
  return fmt::format("{}; `{} --help` shows an example", what, command_line_of(reached(app)));
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* each : app.get_subcommands({})) names.push_back(each->get_name());
  return names;
}

/// The parser takes whatever follows an option for its value, another option or nothing too.
void refuse_missing_values(const CLI::App& app, int argc, char** argv) {
  const CLI::App* command = &app;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::vector<const CLI::App*> below = command->get_subcommands({});
    if (const auto next = std::ranges::find(below, word, &CLI::App::get_name); next != below.end()) {
      command = *next;
      continue;
    }
    const std::string name = word.substr(0, word.find('='));
    const CLI::Option* option = word.starts_with("--") ? command->get_option_no_throw(name) : nullptr;
    if (!option || option->get_items_expected_min() == 0) continue;
    const bool joined = name != word;
    if (!joined && ++i == argc) continue;
    const std::string value = joined ? word.substr(name.size() + 1) : argv[i];
    if (value.empty())
      throw InputError(fmt::format("{} has an empty value; give it one, or leave it out", name));
    if (joined) continue;
    if (value.starts_with("--") && command->get_option_no_throw(value.substr(0, value.find('='))))
      throw InputError(
          fmt::format("{} is followed by the option {} where its value should be; give it one, "
                      "or write {}={} if that is meant",
                      word, value, word, value));
  }
}

/// A wrong environment is refused by every command, whether its kernels run or not.
void check_environment() {
  try {
    instruction_sets();
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

Exit run(int argc, char** argv) {
  check_environment();
  allow_replacing(Replacing::own);
  constexpr int ten_minutes = 600'000;
  set_patience({.milliseconds = ten_minutes, .tell = [](std::string_view text) { tell({"note: ", text}); }});
  Console console;
  CLI::App app("Benchmarks of numerical integrators and their stability on soft-tissue models.", "hmax");
  app.set_version_flag("--version", fmt::format("hmax {}", build_info().version));
  app.add_flag("--json", console.json, "Print one JSON document on standard output");
  app.require_subcommand(0, 1);
  app.footer("`hmax COMMAND --help` shows the options of a command and examples.");

  for (const auto add :
       {add_advise,    add_list,    add_run,   add_static, add_fidelity,  add_order,     add_sweep,
        add_precision, add_check,   add_probe, add_phase,  add_stability, add_mesh,      add_reproduce,
        add_export,    add_compare, add_merge, add_report, add_doctor,    add_completion})
    add(app, console);

  try {
    refuse_missing_values(app, argc, argv);
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) {
      if (console.json)
        console.print_json({{"version", build_info().version}, {"commands", command_names(app)}});
      else
        console.print(overview);
    }
  } catch (const CLI::CallForHelp&) {
    console.print(app.help());
  } catch (const CLI::CallForVersion& version) {
    console.print(fmt::format("{}\n", version.what()));
  } catch (const CLI::ParseError& error) {
    throw InputError(explain(app, error));
  }
  console.flush();
  return console.exit_code;
}

}  // namespace

}  // namespace hmax

int main(int argc, char** argv) {
  using hmax::Exit;
  hmax::open_closed_streams();
  hmax::install_interrupt_handler();
  hmax::keep_freed_memory();
  try {
    return static_cast<int>(hmax::run(argc, argv));
  } catch (const hmax::InputError& error) {
    hmax::leave_error_to_rank_0();
    hmax::tell({error.what()});
    return static_cast<int>(Exit::usage);
  } catch (const hmax::Interrupted& interrupted) {
    hmax::tell({"interrupted", interrupted.kept.empty() ? "" : "; ", interrupted.kept});
    return static_cast<int>(Exit::interrupted);
  } catch (const std::bad_alloc&) {
    hmax::tell({"out of memory; take fewer points or a smaller problem"});
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::resource_unavailable_try_again) {
      hmax::tell({"the system allows no further thread; raise its limit (ulimit -u) or end other programs"});
      return static_cast<int>(Exit::usage);
    }
    hmax::tell({"internal error, please report it: ", error.what()});
  } catch (const std::exception& error) {
    hmax::tell({"internal error, please report it: ", error.what()});
  }
  return static_cast<int>(Exit::internal);
}
