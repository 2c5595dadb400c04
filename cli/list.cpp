/// hmax list methods | problems | models | materials

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/problems.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/options.hpp"
#include "core/errors.hpp"
#include "limits/documents/method_json.hpp"
#include "limits/documents/number_json.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "problems/tissue/materials.hpp"
#include "problems/tissue/tissue_model.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

/// All words, or the first two and the last of more than six.
std::string abbreviated(const std::vector<std::string>& words) {
  if (words.size() <= 6) return fmt::format("{}", fmt::join(words, ","));
  return fmt::format("{},{},...,{}", words[0], words[1], words.back());
}

void list_problems(Console& console) {
  Json document = Json::array();
  TextTable table({"problem", "states", "y0", "t_end [s]", "exact", "parameters"});
  std::string notes;
  for (const std::string& id : problem_ids()) {
    const Problem problem = make_problem(id);
    document.push_back({{"id", id},
                        {"dimension", problem.y0.size()},
                        {"parameters", parameters_json(problem.parameters)},
                        {"y0", std::vector<double>(problem.y0.begin(), problem.y0.end())},
                        HMAX_KEYS(problem, t_end, has_exact_solution, states, note)});
    std::vector<std::string> y0;
    for (const double value : problem.y0) y0.push_back(short_number(value));
    table.add({id, abbreviated(problem.states), abbreviated(y0), short_number(problem.t_end),
               problem.has_exact_solution ? "yes" : "no", describe(problem.parameters)});
    notes += fmt::format("{}: {}\n", id, problem.note);
  }
  console.show(document, table.text(console) + "\n" + notes +
                             "\nA system of your own: --problem FILE.toml, see docs/howto/own_model.md.\n");
}

void list_methods(Console& console) {
  Json document = Json::array();
  TextTable table({"method", "order", "error order", "stages", "aliases", "source"});
  for (const Method& method : methods()) {
    document.push_back(method_json(method));
    table.add({method.id, method.has_variable_order() ? "variable" : std::to_string(method.order),
               method.adaptive() ? std::to_string(method.error_order) : "-",
               method.stages > 0 ? std::to_string(method.stages) : "varies",
               fmt::format("{}", fmt::join(method.aliases, ",")), method.source});
  }
  if (console.json) return console.print_json(document);
  console.print(table.text(console));
  console.print(
      "\nMethods with an error order also run adaptively (--rtol, --atol). Sources are keys of "
      "references.bib.\n");
  for (const Method& method : methods())
    if (!method.note.empty()) console.print(fmt::format("{}: {}\n", method.id, method.note));
  console.print("A method of your own: --tableau FILE.toml, see docs/howto/own_method.md.\n");
}

void list_models(Console& console) {
  Json document = Json::array();
  TextTable table({"model", "forces"});
  for (const TissueModel& model : tissue_models()) {
    document.push_back({HMAX_KEYS(model, id, note, is_linear),
                        {"is_of_springs", model.is_of_springs()},
                        HMAX_KEYS(model, resists_inversion, resists_locking)});
    table.add({std::string(model.id), std::string(model.note)});
  }
  console.show(
      document,
      table.text(console) +
          fmt::format("\nModels of a body on a mesh: `--mesh liver --model {0}`, or `--problem {0}@liver`.\n",
                      tissue_models().front().id));
}

void list_materials(Console& console) {
  Json document = Json::array();
  TextTable table({"material", "k1 [N/m]", "c [N s/m]", "m low [kg]", "m high [kg]", "m middle [kg]"});
  for (const LiverMaterial& material : liver_materials()) {
    document.push_back(
        {{"id", material.id},
         {"parameters",
          {{"k1", material.stiffness},
           {"c", material.damping},
           {"m", material.mass_middle()},
           {"m_low", material.mass_low},
           {"m_high", material.mass_high}}},
         {"source", "benchmark table of the liver oscillator study, docs/reference/facts.md"}});
    table.add({std::string(material.id), short_number(material.stiffness), short_number(material.damping),
               short_number(material.mass_low), short_number(material.mass_high),
               short_number(material.mass_middle())});
  }
  TextTable tissues({"material", "E [kPa]", "range", "nu", "rho [kg/m3]", "source", "measured"});
  for (const PublishedTissue& tissue : published_tissues()) {
    const double E = tissue.material.young, nu = tissue.material.poisson, rho = tissue.material.density;
    document.push_back({{"id", tissue.id},
                        {"parameters", {{"E", E}, {"nu", nu}, {"rho", rho}}},
                        {"E_range", {tissue.young_low, tissue.young_high}},
                        HMAX_KEYS(tissue, source, note)});
    tissues.add({std::string(tissue.id), short_number(E / 1000),
                 fmt::format("{} to {}", short_number(tissue.young_low / 1000),
                             short_number(tissue.young_high / 1000)),
                 short_number(nu), short_number(rho), std::string(tissue.source), std::string(tissue.note)});
  }
  if (console.json) return console.print_json(document);
  console.print(table.text(console));
  console.print(
      "\nThe middle of the mass range is used; ':light' and ':heavy' after the id take its ends.\n"
      "The study prints the stiffness in kPa and the damping in N/m^2 and computes with the bare numbers; "
      "docs/reference/facts.md\nsays why no claim is made that these are a liver's.\n");
  console.print(fmt::format(
      "\nOf bodies on meshes: --material tissue:liver, or of regions too: --material "
      "tissue:liver,tumour=tissue:fibroadenoma\n\n{}\nThe range of E is one standard deviation, or that of the "
      "study. nu is 0.45 where the study measures none; densities are\nthose of schneider2000correlation, "
      "where the note says nothing else. Sources: references.bib.\n",
      tissues.text(console)));
}

void list_topic(const std::string& what, Console& console) {
  if (what.empty())
    throw InputError(fmt::format("say what to list, {} or {}; for instance `hmax list {}`",
                                 fmt::join(list_topics.begin(), list_topics.end() - 1, ", "),
                                 list_topics.back(), list_topics.front()));
  const std::string chosen = parse_choice("what to list", what, list_topics);
  if (chosen == "problems") return list_problems(console);
  if (chosen == "methods") return list_methods(console);
  if (chosen == "models") return list_models(console);
  list_materials(console);
}

}  // namespace

void add_list(CLI::App& app, Console& console) {
  const auto [command, what] =
      add_command(app, console, "list", "List the methods, problems, mesh models or materials",
                  {"hmax list methods", "hmax list problems --json", "hmax list materials"}, list_topic);
  add_text(command, "what", what, fmt::format("One of {}", fmt::join(list_topics, ", ")), "");
}

}  // namespace hmax
