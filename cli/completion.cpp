/// hmax completion: what a shell needs to know to complete command lines of hmax.
#include <array>
#include <functional>
#include <map>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/timing/sweep_file.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_choice.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "problems/mesh/files/mesh_names.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "problems/tissue/tissue_model.hpp"
#include "results/exports.hpp"

namespace hmax {

namespace {

using Words = std::vector<std::string>;

constexpr std::array<std::string_view, 3> shells{"bash", "zsh", "fish"};

Words mesh_names() {
  Words names;
  for (const NamedMesh& mesh : named_meshes()) names.push_back(mesh.name);
  return names;
}

/// The values an option takes, by its name; an option that is not here and takes a value takes a file or a
/// number.
std::map<std::string, Words> values_of_options() {
  Words method_names, materials, models;
  for (const Method& method : methods()) {
    method_names.push_back(method.id);
    method_names.insert(method_names.end(), method.aliases.begin(), method.aliases.end());
  }
  for (const LiverMaterial& material : liver_materials()) materials.emplace_back(material.id);
  for (const TissueModel& model : tissue_models()) models.emplace_back(model.id);
  return {{"--problem", problem_ids()},
          {"--problems", problem_ids()},
          {"--method", method_names},
          {"--methods", method_names},
          {"--material", materials},
          {"--materials", materials},
          {"--control", Words(controller_names.begin(), controller_names.end())},
          {"--readings", Words(reading_names.begin(), reading_names.end())},
          {"--format", Words(export_formats.begin(), export_formats.end())},
          {"--mesh", mesh_names()},
          {"--model", models},
          {"--load", Words(tissue_loads().begin(), tissue_loads().end())},
          {"--unit", {"m", "cm", "mm"}},
          {"--of", {"runs", "limits", "advice"}},
          {"--colour", {"displacement", "energy_density"}},
          {"--device", {"cpu", "gpu"}},
          {"--precision", {"double", "single"}}};
}

/// What stands without dashes after a command, where that is known.
Words operands_of(const CLI::App& command) {
  if (command.get_name() == "list") return Words(list_topics.begin(), list_topics.end());
  if (command.get_name() == "completion") return Words(shells.begin(), shells.end());
  Words words;
  if (command.get_name() == "mesh") words = mesh_names();
  for (const CLI::App* each : command.get_subcommands({})) words.push_back(each->get_name());
  return words;
}

Words options_of(const CLI::App& command) {
  Words words;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) words.push_back("--" + name);
  return words;
}

/// The options of all commands after which a value stands that is not known, such as a file or a number.
Words options_with_values(const CLI::App& app) {
  const auto known = values_of_options();
  std::map<std::string, bool> all;  // whether the name has a value wherever it is an option
  const std::function<void(const CLI::App&)> look = [&](const CLI::App& command) {
    for (const CLI::Option* option : command.get_options())
      for (const std::string& name : option->get_lnames()) {
        bool& has_value = all.try_emplace("--" + name, true).first->second;
        has_value = has_value && option->get_items_expected_min() > 0;
      }
    for (const CLI::App* each : command.get_subcommands({})) look(*each);
  };
  look(app);
  Words words;
  for (const auto& [name, has_value] : all)
    if (has_value && !known.contains(name)) words.push_back(name);
  return words;
}

std::string joined_words(const Words& words) { return fmt::format("{}", fmt::join(words, " ")); }

std::vector<const CLI::App*> commands_of(const CLI::App& app) { return app.get_subcommands({}); }

/// What may stand after a command.
std::string words_after(const CLI::App& command) {
  return joined_words(operands_of(command)) + " " + joined_words(options_of(command));
}

/// Cases of a shell over "NUMBER:COMMAND:SUBCOMMAND", the number of the word that is completed, from the
/// second on.
/// @param format  of one case, whose pattern and words it takes
std::string cases_of_commands(const CLI::App& app, fmt::format_string<std::string, std::string> format) {
  std::string text;
  for (const CLI::App* command : commands_of(app)) {
    const std::string& name = command->get_name();
    if (!commands_of(*command).empty())
      text += fmt::format(format, "2:" + name + ":*", words_after(*command));
    for (const CLI::App* each : commands_of(*command))
      text += fmt::format(format, "*:" + name + ":" + each->get_name(), words_after(*each));
    text += fmt::format(format, "*:" + name + ":*", words_after(*command));
  }
  return text;
}

std::string bash(const CLI::App& app) {
  std::string text = R"(# source <(hmax completion bash)
_hmax() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} words=
  case $previous in
)";
  for (const auto& [option, values] : values_of_options())
    text += fmt::format("    {}) words=\"{}\" ;;\n", option, joined_words(values));
  text += fmt::format("    {}) return ;;\n", fmt::join(options_with_values(app), "|"));
  text += R"(  esac
  if [[ -z $words ]]; then
    case ${COMP_CWORD}:${COMP_WORDS[1]}:${COMP_WORDS[2]} in
)";
  text += fmt::format("      1:*) words=\"{}\" ;;\n", words_after(app));
  text += cases_of_commands(app, "      {}) words=\"{}\" ;;\n");
  return text + R"(    esac
  fi
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}
complete -o bashdefault -o default -F _hmax hmax
)";
}

std::string zsh(const CLI::App& app) {
  std::string text = R"(#compdef hmax
# source <(hmax completion zsh)
_hmax() {
  case ${words[CURRENT-1]} in
)";
  for (const auto& [option, values] : values_of_options())
    text +=
        fmt::format("    {}) compadd -- {}; _files -g '*.toml'; return ;;\n", option, joined_words(values));
  text += fmt::format("    {}) _files; return ;;\n", fmt::join(options_with_values(app), "|"));
  text += R"(  esac
  case $((CURRENT - 1)):${words[2]}:${words[3]} in
)";
  text += fmt::format("    1:*) compadd -- {} ;;\n", words_after(app));
  text += cases_of_commands(app, "    {}) compadd -- {}; _files ;;\n");
  return text + R"(  esac
}
compdef _hmax hmax
)";
}

/// A text in single quotes of fish.
std::string fish_quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find_first_of("'\\", at)) != std::string::npos; at += 2)
    text.insert(at, "\\");
  return "'" + text + "'";
}

/// Lines of fish for what stands after a command.
/// @param condition  that the command is there
std::string fish_lines(const CLI::App& command, const std::string& condition) {
  const auto values = values_of_options();
  const std::string here = fmt::format("complete -c hmax -n '{}'", condition);
  std::string text;
  if (const Words operands = operands_of(command); !operands.empty())
    text += fmt::format("{} -f -a '{}'\n", here, joined_words(operands));
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) {
      text += fmt::format("{} -l {} -d {}", here, name, fish_quoted(option->get_description()));
      if (const auto known = values.find("--" + name); known != values.end())
        text += fmt::format(" -r -a '{}'", joined_words(known->second));
      else if (option->get_items_expected_max() > 0)
        text += " -r";
      text += "\n";
    }
  return text;
}

std::string fish(const CLI::App& app) {
  std::string text = "# hmax completion fish | source\n";
  for (const CLI::App* command : commands_of(app)) {
    text += fmt::format("complete -c hmax -n __fish_use_subcommand -f -a {} -d {}\n", command->get_name(),
                        fish_quoted(command->get_description()));
    const std::string here = "__fish_seen_subcommand_from " + command->get_name();
    text += fish_lines(*command, here);
    for (const CLI::App* each : commands_of(*command))
      text += fish_lines(*each, here + "; and __fish_seen_subcommand_from " + each->get_name());
  }
  return text;
}

}  // namespace

void add_completion(CLI::App& app, Console& console) {
  CLI::App& command = add_command(app, console, "completion", "Print the completion script of a shell",
                                  {"hmax completion bash", "hmax completion zsh", "hmax completion fish"});
  auto shell = std::make_shared<std::string>();
  require(add_text(command, "shell", *shell, fmt::format("One of {}", fmt::join(shells, ", ")), ""));
  set_callback(command, [shell, &app, &console] {
    const std::string chosen = parse_choice("the shell", *shell, shells);
    const std::string text = chosen == "bash" ? bash(app) : chosen == "zsh" ? zsh(app) : fish(app);
    console.show({{"shell", chosen}, {"script", text}}, text);
  });
}

}  // namespace hmax
