#include "cli/shared/options.hpp"

#include <utility>

#include <CLI/CLI.hpp>

#include "cli/shared/console.hpp"

namespace hmax {

CLI::App& add_command(CLI::App& parent, Console& console, const std::string& name,
                      const std::string& description, const std::vector<std::string>& examples) {
  CLI::App& command = *parent.add_subcommand(name, description);
  add_flag(command, "--json", console.json, "Print one JSON document on standard output");
  std::string footer = examples.size() > 1 ? "Examples:" : "Example:";
  for (const std::string& example : examples) footer += "\n  " + example;
  command.footer(footer);
  return command;
}

CLI::App& add_group(CLI::App& parent, const std::string& name, const std::string& description) {
  CLI::App& group = *parent.add_subcommand(name, description);
  require_subcommand(group);
  return group;
}

void require_subcommand(CLI::App& command) { command.require_subcommand(1); }

void add_footer(CLI::App& command, const std::string& line) {
  command.footer(command.get_footer() + "\n" + line);
}

HelpGroup::HelpGroup(CLI::App& command, std::string_view title)
    : command_(command), before_(command.option_defaults()->get_group()) {
  command.option_defaults()->group(std::string(title));
}
HelpGroup::~HelpGroup() { command_.option_defaults()->group(before_); }

void set_callback(CLI::App& command, std::function<void()> callback) {
  command.callback(std::move(callback));
}

CLI::Option* add_text(CLI::App& command, const std::string& name, std::string& text,
                      const std::string& description, const std::string& type) {
  return command.add_option(name, text, description)->type_name(type);
}

CLI::Option* add_text(CLI::App& command, const std::string& name,
                      const std::function<void(const std::string&)>& read, const std::string& description,
                      const std::string& type) {
  return command.add_option_function<std::string>(name, read, description)->type_name(type);
}

CLI::Option* add_repeated(CLI::App& command, const std::string& name, std::vector<std::string>& texts,
                          const std::string& description, const std::string& type) {
  return command.add_option(name, texts, description)->type_name(type)->take_all()->allow_extra_args(false);
}

CLI::Option* add_list(CLI::App& command, const std::string& name, std::vector<std::string>& texts,
                      const std::string& description, const std::string& type) {
  const auto read = [&texts, name](const std::vector<std::string>& lists) {
    texts.clear();
    for (const std::string& list : lists)
      for (std::string& each : parse_names(name, list)) texts.push_back(std::move(each));
  };
  return command.add_option_function<std::vector<std::string>>(name, read, description)->type_name(type);
}

CLI::Option* add_arguments(CLI::App& command, const std::string& name, std::vector<std::string>& texts,
                           const std::string& description) {
  return command.add_option(name, texts, description)->type_name("");
}

CLI::Option* add_number(CLI::App& command, const std::string& name, std::optional<double>& value,
                        const std::string& description) {
  const std::string first = name.substr(0, name.find(','));
  return add_text(
      command, name, [&value, first](const std::string& text) { value = parse_number(first, text); },
      description, "NUMBER");
}

CLI::Option* add_count(CLI::App& command, const std::string& name, int& count, int least, int most,
                       const std::string& description) {
  return command.add_option(name, count, description)->check(CLI::Range(least, most))->type_name("NUMBER");
}

void add_flag(CLI::App& command, const std::string& name, bool& flag, const std::string& description) {
  command.add_flag(name, flag, description);
}

void add_flag(CLI::App& command, const std::string& name, std::function<void()> callback,
              const std::string& description) {
  command.add_flag_callback(name, std::move(callback), description);
}

void require(CLI::Option* option) { option->required(); }

void show_default(CLI::Option* option) { option->capture_default_str(); }

void set_implicit_value(CLI::Option* option, const std::string& value) {
  option->expected(0, 1)->default_str(value);
}

bool is_given(const CLI::Option* option) { return option->count() > 0; }

}  // namespace hmax
