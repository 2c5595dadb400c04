#include "bench/timing/sweep_file.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "catalogue/methods/catalogue.hpp"
#include "catalogue/models/matrix_problem.hpp"
#include "catalogue/models/mesh_choice.hpp"
#include "catalogue/models/problems.hpp"
#include "core/errors.hpp"
#include "problems/oscillator/liver_materials.hpp"
#include "results/json.hpp"

namespace hmax {

namespace {

constexpr std::array<std::string_view, 2> tables{"sweep", "set"};
constexpr std::array<std::string_view, 15> keys{"problems", "materials", "methods", "tableaux", "h",
                                                "readings", "rtol",      "atol",    "control",  "t_end",
                                                "repeats",  "max_steps", "y0",      "unit",     "out"};

/// The keys of [sweep] as values of the kind that is wanted, or an error that names the line.
class Reader {
 public:
  explicit Reader(const TomlDocument& document) : document_(document) {}

  std::optional<std::string> word(const std::string& key) const {
    const Json* value = find(key);
    if (!value) return std::nullopt;
    if (!value->is_string()) document_.fail(place(key), fmt::format("{} must be one name in quotes", key));
    return value->get<std::string>();
  }

  std::optional<std::vector<std::string>> words(const std::string& key) const {
    const Json* value = find(key);
    if (!value) return std::nullopt;
    std::vector<std::string> words;
    const Json list = listed(*value);
    for (const Json& entry : list) {
      if (!entry.is_string())
        document_.fail(place(key),
                       fmt::format("{0} must be names in quotes, such as {0} = [\"a\", \"b\"]", key));
      words.push_back(entry.get<std::string>());
    }
    if (words.empty())
      document_.fail(place(key), fmt::format("{} is empty; name at least one, or leave the key out", key));
    return words;
  }

  std::optional<double> number(const std::string& key) const {
    const Json* value = find(key);
    if (!value) return std::nullopt;
    if (!value->is_number())
      document_.fail(place(key), fmt::format("{} must be a number (a decimal point, no quotes)", key));
    return value->get<double>();
  }

  std::optional<std::vector<double>> numbers(const std::string& key) const {
    const Json* value = find(key);
    if (!value) return std::nullopt;
    std::vector<double> numbers;
    const Json list = listed(*value);
    for (const Json& entry : list) {
      if (!entry.is_number())
        document_.fail(place(key), fmt::format("{0} must be numbers, such as {0} = [0.1, 0.01]", key));
      numbers.push_back(entry.get<double>());
    }
    if (numbers.empty())
      document_.fail(place(key),
                     fmt::format("{} is empty; give at least one number, or leave the key out", key));
    return numbers;
  }

  std::optional<std::int64_t> count(const std::string& key) const {
    const Json* value = find(key);
    if (!value) return std::nullopt;
    if (!value->is_number_integer() || value->get<std::int64_t>() < 1)
      document_.fail(place(key), fmt::format("{} must be a whole number of at least 1", key));
    return value->get<std::int64_t>();
  }

  /// Runs `action`; its InputError gets the line of `key`.
  template <class Action>
  void at(const std::string& key, Action&& action) const {
    try {
      action();
    } catch (const InputError& error) {
      document_.fail(place(key), error.what());
    }
  }

 private:
  static std::string place(const std::string& key) { return "/sweep/" + key; }
  const Json* find(const std::string& key) const {
    if (!document_.root.contains("sweep")) return nullptr;
    const Json& sweep = document_.root.at("sweep");
    return sweep.contains(key) ? &sweep.at(key) : nullptr;
  }
  /// One value stands for a list of it.
  static Json listed(const Json& value) { return value.is_array() ? value : Json::array({value}); }

  const TomlDocument& document_;
};

/// Names of files are meant relative to the file that names them.
void seek_beside(const std::string& sweep_file, std::vector<std::string>& names) {
  const auto beside = [&](const std::string& file) {
    return (std::filesystem::path(sweep_file).parent_path() / file).string();
  };
  for (std::string& name : names) {
    const ProblemKind kind = problem_kind(name);
    if (kind == ProblemKind::formulas) name = beside(name);
    if (kind == ProblemKind::matrices)
      name = matrices_beside(name, std::filesystem::path(sweep_file).parent_path().string());
    if (kind != ProblemKind::body) continue;
    // A mesh that is no file has a name.
    const std::size_t mesh = name.find('@') + 1;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(beside(name.substr(mesh)), ignored))
      name = name.substr(0, mesh) + beside(name.substr(mesh));
  }
}

std::vector<std::string> expanded(const std::vector<std::string>& materials) {
  if (std::ranges::find(materials, "all") == materials.end()) return materials;
  if (materials.size() > 1)
    throw InputError("the material 'all' includes every material; give it alone, or give names");
  std::vector<std::string> all;
  for (const LiverMaterial& material : liver_materials()) all.emplace_back(material.id);
  return all;
}

void set_readings(SweepSpec& spec, const std::vector<std::string>& readings) {
  for (const std::string& reading : readings)
    if (std::ranges::find(reading_names, reading) == reading_names.end())
      throw InputError(
          fmt::format("unknown reading '{}' of a step; {}", reading, suggestion(reading, reading_names)));
  const auto asked = [&](std::string_view name) {
    return std::ranges::find(readings, name) != readings.end();
  };
  spec.fixed = asked(reading_names[0]);
  spec.sampled = asked(reading_names[1]);
}

void set_tolerances(SweepSpec& spec, const SweepRequest& request) {
  if (!request.rtol) {
    if (request.atol) spec.sampled_tolerance.atol = *request.atol;
    return;
  }
  const auto tolerance = [&](double rtol) { return Tolerance{rtol, request.atol.value_or(rtol)}; };
  if (request.h || request.readings) {
    if (request.rtol->size() > 1)
      throw InputError(
          "several tolerances are swept only without steps; give one --rtol, or leave out --h, --fixed and "
          "--sampled");
    spec.sampled_tolerance = tolerance(request.rtol->front());
    return;
  }
  spec.h.clear();
  for (const double rtol : *request.rtol) spec.tolerances.push_back(tolerance(rtol));
}

}  // namespace

SweepRequest sweep_from(const TomlDocument& document) {
  reject_unknown_keys(document, "", tables);
  reject_unknown_keys(document, "/sweep", keys);
  if (std::ranges::all_of(document.root, [](const Json& table) { return table.empty(); }))
    throw InputError(fmt::format(
        "{} asks for nothing; name problems, methods and h under [sweep], as docs/reference/sweep.md shows",
        document.name));
  const Reader read(document);
  SweepRequest request;
  request.problems = read.words("problems");
  request.materials = read.words("materials");
  request.methods = read.words("methods");
  request.tableaux = read.words("tableaux");
  request.readings = read.words("readings");
  request.h = read.numbers("h");
  request.rtol = read.numbers("rtol");
  request.atol = read.number("atol");
  request.control = read.word("control");
  request.t_end = read.number("t_end");
  request.repeats = read.count("repeats");
  request.max_steps = read.count("max_steps");
  request.y0 = read.numbers("y0");
  read.at("unit", [&] {
    if (const auto unit = read.word("unit")) request.unit = unit_in_metres(*unit);
  });
  request.out = read.word("out");
  if (document.root.contains("set")) {
    const Json& set = document.root.at("set");
    if (!set.is_object()) document.fail("/set", "'set' must be a table: write [set]");
    for (const auto& [name, value] : set.items()) {
      if (!value.is_number())
        document.fail("/set/" + name, fmt::format("{} must be a number (a decimal point, no quotes)", name));
      request.parameters.emplace_back(name, value.get<double>());
    }
  }
  if (request.problems) seek_beside(document.name, *request.problems);
  if (request.tableaux) seek_beside(document.name, *request.tableaux);

  // Names are looked up here, where their line is still known.
  read.at("problems", [&] {
    for (const std::string& name : request.problems.value_or(std::vector<std::string>{}))
      make_problem(name, {.unit = request.unit});
  });
  read.at("materials", [&] {
    for (const std::string& id : expanded(request.materials.value_or(std::vector<std::string>{})))
      make_problem("liver_benchmark", {.material = id});
  });
  read.at("methods", [&] { choose_methods(request.methods.value_or(std::vector<std::string>{}), {}); });
  read.at("control", [&] {
    if (request.control) controllers_from(*request.control);
  });
  read.at("readings", [&] {
    SweepSpec unused;
    if (request.readings) set_readings(unused, *request.readings);
  });
  return request;
}

SweepRequest read_sweep(const std::filesystem::path& path) { return sweep_from(read_toml(path)); }

SweepRequest merged(const SweepRequest& file, const SweepRequest& flags) {
  SweepRequest both = file;
  const auto override = [](auto& value, const auto& flag) {
    if (flag) value = flag;
  };
  override(both.problems, flags.problems);
  override(both.materials, flags.materials);
  override(both.methods, flags.methods);
  override(both.tableaux, flags.tableaux);
  override(both.readings, flags.readings);
  override(both.h, flags.h);
  override(both.rtol, flags.rtol);
  override(both.atol, flags.atol);
  override(both.control, flags.control);
  override(both.t_end, flags.t_end);
  override(both.repeats, flags.repeats);
  override(both.max_steps, flags.max_steps);
  override(both.y0, flags.y0);
  override(both.unit, flags.unit);
  override(both.out, flags.out);
  both.parameters.insert(both.parameters.end(), flags.parameters.begin(), flags.parameters.end());
  return both;
}

SweepSpec spec_from(const SweepRequest& request) {
  SweepSpec spec;
  const std::vector<std::string> own_material{""};
  spec.problems.clear();
  for (const std::string& name : request.problems.value_or(std::vector<std::string>{"liver_forced"}))
    for (const std::string& material : request.materials ? expanded(*request.materials) : own_material)
      spec.problems.push_back({name,
                               {.material = material,
                                .parameters = request.parameters,
                                .y0 = request.y0.value_or(std::vector<double>{}),
                                .unit = request.unit}});
  if (request.unit && std::ranges::none_of(spec.problems, [](const SweepProblem& each) {
        return problem_kind(each.name) == ProblemKind::body;
      }))
    throw InputError("a unit is of a mesh file, and no problem of this sweep has a mesh; leave it out");
  if (request.methods) spec.methods = *request.methods;
  if (request.tableaux) spec.tableaux.assign(request.tableaux->begin(), request.tableaux->end());
  if (request.h) spec.h = *request.h;
  if (request.readings) set_readings(spec, *request.readings);
  set_tolerances(spec, request);
  if (request.control) spec.control = controllers_from(*request.control);
  if (!spec.sampled && spec.tolerances.empty() && (request.rtol || request.atol || request.control))
    throw InputError(
        "tolerances and --control steer adaptive runs, and this sweep has only fixed steps; leave them out, "
        "or add --sampled");
  spec.t_end = request.t_end;
  if (request.repeats)
    spec.repeats =
        static_cast<int>(std::min<std::int64_t>(*request.repeats, std::numeric_limits<int>::max()));
  if (request.max_steps) spec.max_steps = *request.max_steps;
  return spec;
}

}  // namespace hmax
