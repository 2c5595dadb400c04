/// Subcommands and their options. The commands do not see CLI11 itself, which costs a source 7 s of
/// compilation.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
class Option;
}  // namespace CLI

namespace hmax {

class Console;

/// A subcommand with its --json flag and its examples, which a test runs.
/// @param examples  whole command lines, one each
CLI::App& add_command(CLI::App& parent, Console& console, const std::string& name,
                      const std::string& description, const std::vector<std::string>& examples);
/// What the subcommand does, after parsing.
void set_callback(CLI::App& command, std::function<void()> callback);
/// A subcommand that does `function` with options, which are returned beside it and live as long.
template <class Options>
std::pair<CLI::App&, Options&> add_command(CLI::App& parent, Console& console, const std::string& name,
                                           const std::string& description,
                                           const std::vector<std::string>& examples,
                                           void (*function)(const Options&, Console&)) {
  CLI::App& command = add_command(parent, console, name, description, examples);
  const auto options = std::make_shared<Options>();
  set_callback(command, [options, function, &console] { function(*options, console); });
  return {command, *options};
}
/// A subcommand that is there for its own subcommands.
CLI::App& add_group(CLI::App& parent, const std::string& name, const std::string& description);
/// One of the subcommands must be given.
void require_subcommand(CLI::App& command);
/// One more line of --help, below the examples.
void add_footer(CLI::App& command, const std::string& line);
/// Titles of --help for options that many commands have; docs/reference/model_options.md and
/// docs/reference/cli.md describe them once.
constexpr std::string_view model_group = "Model", common_group = "Common";

/// While it lives, --help lists the options that are added to the command under a title of their own.
class HelpGroup {
 public:
  HelpGroup(CLI::App& command, std::string_view title);
  ~HelpGroup();
  HelpGroup(const HelpGroup&) = delete;
  HelpGroup& operator=(const HelpGroup&) = delete;

 private:
  CLI::App& command_;
  std::string before_;
};

/// An option with a value; without dashes in its name, an argument. Further names follow after commas.
/// @param type  what --help shows for the value, "FILE"; nothing when empty
CLI::Option* add_text(CLI::App& command, const std::string& name, std::string& text,
                      const std::string& description, const std::string& type = "TEXT");
/// The same whose value `read` takes while the command line is parsed.
CLI::Option* add_text(CLI::App& command, const std::string& name,
                      const std::function<void(const std::string&)>& read, const std::string& description,
                      const std::string& type = "TEXT");
/// An option that may be repeated, with one value each time.
CLI::Option* add_repeated(CLI::App& command, const std::string& name, std::vector<std::string>& texts,
                          const std::string& description, const std::string& type);
/// An option with several values, between commas or one after the other.
CLI::Option* add_list(CLI::App& command, const std::string& name, std::vector<std::string>& texts,
                      const std::string& description, const std::string& type);
/// All the arguments that are left.
CLI::Option* add_arguments(CLI::App& command, const std::string& name, std::vector<std::string>& texts,
                           const std::string& description);
/// An option that holds a number.
CLI::Option* add_number(CLI::App& command, const std::string& name, std::optional<double>& value,
                        const std::string& description);
/// An option that holds a whole number from `least` to `most`.
CLI::Option* add_count(CLI::App& command, const std::string& name, int& count, int least, int most,
                       const std::string& description);

/// An option without a value, which sets `flag`.
void add_flag(CLI::App& command, const std::string& name, bool& flag, const std::string& description);
/// The same which calls `callback` while the command line is parsed.
void add_flag(CLI::App& command, const std::string& name, std::function<void()> callback,
              const std::string& description);

/// The option must be given.
void require(CLI::Option* option);
/// --help shows the value that the option has now.
void show_default(CLI::Option* option);
/// The option may be given without its value, and then has this one.
void set_implicit_value(CLI::Option* option, const std::string& value);
/// Whether the command line has the option.
bool is_given(const CLI::Option* option);

}  // namespace hmax
