/// hmax stability frozen
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/shared/options.hpp"
#include "cli/stability/limit_words.hpp"
#include "cli/stability/stability.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "limits/steps/linearly_implicit.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

struct FrozenOptions {
  std::string methods, ratios = "1.1,1.25,1.5,2,3,4,8", every;
};

Json to_json(const ToleratedRatios& ratios) {
  return {{"least", ratios.least}, {"most", number_or_word(ratios.most)}};
}

std::string words_of(const ToleratedRatios& ratios) {
  return fmt::format("{} to {}", short_number(ratios.least, 4), step_words(ratios.most));
}

void frozen(const FrozenOptions& options, Console& console) {
  if (options.methods.empty())
    throw InputError("no method is given; name one with --method, like linearly_implicit_euler");
  const std::vector<double> ratios = parse_numbers("--ratios", options.ratios);
  for (const double ratio : ratios)
    if (!(ratio > 0 && ratio <= 1e6))
      throw InputError(fmt::format("--ratios has {}, but a ratio k / k0 lies between 0 and 1e6, like 1.5",
                                   to_text(ratio)));
  const std::int64_t steps = options.every.empty() ? 0 : parse_count("--every", options.every, 1);
  if (steps > 1000)
    throw InputError(fmt::format("--every {} is more than 1000 steps with one Jacobian; give fewer", steps));
  std::vector<std::string> header{"method", "decay", "spring"};
  for (const double ratio : ratios) header.push_back("k/k0 " + short_number(ratio));
  TextTable table(std::move(header));
  Json documents = Json::array();
  const auto& interrupted = interrupt_flag();
  for (const Formula& formula : formulas_of(options.methods, console)) {
    if (interrupted) throw Interrupted{};
    const std::optional<LinearlyImplicitMethod> method = linearly_implicit_method(formula.id);
    if (!method)
      throw InputError(
          fmt::format("{} does not step with a Jacobian that may be an old one; methods that do "
                      "are {}",
                      formula.id, fmt::join(linearly_implicit_ids(), ", ")));
    const ToleratedRatios decay = tolerated_decay(*formula.amplification),
                          spring = tolerated_stiffness(*method);
    Json exits = Json::array(), refreshed = Json::array();
    std::vector<std::string> cells{formula.id, words_of(decay), words_of(spring)},
        with_every{fmt::format("  every {}", steps), "", ""};
    for (const double ratio : ratios) {
      const double exit = frozen_spring_exit(*method, ratio);
      exits.push_back(number_or_word(exit));
      cells.push_back(step_words(exit));
      if (steps == 0) continue;
      const double period = stiffening_exit(*method, ratio, static_cast<int>(steps));
      refreshed.push_back(number_or_word(period));
      with_every.push_back(step_words(period));
    }
    Json document{{"method", formula.id},
                  {"decay", to_json(decay)},
                  {"spring", to_json(spring)},
                  {"ratios", ratios},
                  {"omega0_h", exits}};
    if (steps > 0) document["every"] = {{"steps", steps}, {"omega0_h", refreshed}};
    documents.push_back(std::move(document));
    table.add(std::move(cells));
    if (steps > 0) table.add(std::move(with_every));
  }
  if (console.json) return console.print_json(documents.size() == 1 ? documents.front() : documents);
  console.print(table.text(console));
  console.print(
      "\nThe Jacobian was taken where the stiffness was k0. decay, spring: ratios of the true rate or stiffness "
      "to\nthe old one at which every step is stable. k/k0: the largest stable omega0 h on an undamped spring, "
      "omega0^2 = k0/m.\n");
  if (steps > 0)
    console.print(fmt::format(
        "every {0}: the stiffness rises to that ratio within {0} steps, then the Jacobian is updated.\n",
        steps));
}

}  // namespace

void add_stability_frozen(CLI::App& stability, Console& console) {
  const auto [command, options] = add_command(
      stability, console, "frozen",
      "Show the stiffening up to which a method with a frozen Jacobian is stable",
      {"hmax stability frozen --method linearly_implicit_euler",
       "hmax stability frozen --method linearly_implicit_euler,rosenbrock_23 --every 5 --ratios 1.5,3 --json"},
      frozen);
  add_text(command, "--method,--methods", options.methods,
           "Ids of `hmax list methods`, or the family rosenbrock", "A,B");
  add_text(command, "--ratios", options.ratios,
           fmt::format("True stiffness relative to that of the Jacobian; {} by default", options.ratios),
           "NUMBERS");
  add_text(command, "--every", options.every,
           "Also with a Jacobian that is updated every K steps while the stiffness rises", "K");
}

}  // namespace hmax
