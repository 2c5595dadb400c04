/// hmax export and hmax compare: measured rows out of their stores.
#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/input/suggest.hpp"
#include "cli/shared/commands.hpp"
#include "cli/shared/outputs.hpp"
#include "results/compare.hpp"
#include "results/errors.hpp"
#include "results/exports.hpp"
#include "results/store.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A store by the path of its file, or by its name under results/runs.
Store open_store(const std::string& name) {
  std::error_code error;
  const fs::path named = fs::path("results/runs") / (name + ".sqlite");
  const bool plain = name.find('/') == std::string::npos && !fs::exists(name, error);
  if (!plain) return Store::open_existing(name);
  if (fs::exists(named, error)) return Store::open_existing(named);
  std::vector<std::string> known;
  for (const auto& entry : fs::directory_iterator("results/runs", error))
    if (entry.path().extension() == ".sqlite") known.push_back(entry.path().stem().string());
  throw InputError(fmt::format("there is no store '{}', neither as a file nor under results/runs; {}", name,
                               suggestion(name, known, "`hmax sweep --out NAME` makes one")));
}

Fingerprint last_fingerprint(const Store& store) {
  const auto sessions = store.sessions();
  return sessions.empty() ? Fingerprint{} : sessions.back().fingerprint;
}

void export_rows(const std::string& name, const std::string& asked_format, const std::string& output,
                 Console& console) {
  std::vector<std::string_view> names;
  for (const ExportFormat& each : export_formats()) names.push_back(each.name);
  const std::string format = parse_choice("--format", asked_format, names);
  const auto chosen = std::ranges::find(export_formats(), format, &ExportFormat::name);
  if (!output.empty()) check_writable(output, chosen->opening);
  const Store store = open_store(name);
  const std::vector<Row> rows = store.rows();
  const std::string text = chosen->text(rows, last_fingerprint(store));
  if (!output.empty()) {
    write_file(output, text, chosen->opening);
    if (console.json)
      console.print_json(Json{
          {"store", store.file().string()}, {"format", format}, {"rows", rows.size()}, {"output", output}});
    else
      console.print(fmt::format("{} rows in {}\n", rows.size(), output));
  } else if (console.json && format != "gbench") {
    // One document whatever the format: the objects of the lines in an array.
    Json document = Json::array();
    const std::string lines = rows_to_jsonl(rows);
    for (std::size_t begin = 0, end; (end = lines.find('\n', begin)) != std::string::npos; begin = end + 1)
      document.push_back(Json::parse(lines.begin() + static_cast<std::ptrdiff_t>(begin),
                                     lines.begin() + static_cast<std::ptrdiff_t>(end)));
    console.print_json(document);
  } else {
    console.print(text);
  }
}

Json to_json(const RowComparison& row) {
  return {{"row", benchmark_name(row.key)},
          {"problem", row.key.problem},
          {"material", row.key.material},
          {"method", row.key.method},
          {"mode", row.key.mode},
          {"h", row.key.h},
          {"rtol", row.key.rtol},
          {"t_end", row.key.t_end},
          {"verdict", to_string(row.verdict)},
          {"cpu_median_a_s", row.median_a},
          {"cpu_median_b_s", row.median_b},
          {"ratio", row.ratio},
          {"relative_ratio", row.relative_ratio},
          {"p", row.p},
          {"noise_floor", row.noise_floor},
          {"changes", row.changes}};
}

Json names(const std::vector<RowKey>& keys) {
  Json list = Json::array();
  for (const RowKey& key : keys) list.push_back(benchmark_name(key));
  return list;
}

void compare_stores(const std::string& a, const std::string& b, bool all, Console& console) {
  const Store store_a = open_store(a), store_b = open_store(b);
  const std::vector<Row> rows_a = store_a.rows(), rows_b = store_b.rows();
  Comparison found = compare(rows_a, rows_b);
  for (const std::string& difference : differences(last_fingerprint(store_a), last_fingerprint(store_b)))
    found.remarks.push_back("Measured under different conditions: " + difference + ".");
  const std::size_t outside = found.rows.size() - found.count(Verdict::same);
  if (outside > 0) console.exit_code = Exit::failed;

  if (console.json) {
    Json rows = Json::array();
    for (const RowComparison& row : found.rows) rows.push_back(to_json(row));
    return console.print_json(Json{{"a", store_a.file().string()},
                                   {"b", store_b.file().string()},
                                   {"compared", found.rows.size()},
                                   {"same", found.count(Verdict::same)},
                                   {"faster", found.count(Verdict::faster)},
                                   {"slower", found.count(Verdict::slower)},
                                   {"changed", found.count(Verdict::changed)},
                                   {"common_ratio", found.common_ratio},
                                   {"scatter", found.scatter},
                                   {"remarks", found.remarks},
                                   {"only_in_a", names(found.only_in_a)},
                                   {"only_in_b", names(found.only_in_b)},
                                   {"rows", rows}});
  }
  TextTable table({"row", "B is", "A [s]", "B [s]", "B/A", "p", "changes"});
  for (const RowComparison& row : found.rows) {
    if (row.verdict == Verdict::same && !all) continue;
    table.add({benchmark_name(row.key), std::string(to_string(row.verdict)), short_number(row.median_a, 3),
               short_number(row.median_b, 3), short_number(row.ratio, 3), short_number(row.p, 2),
               row.changes.empty() ? "" : row.changes.front()});
  }
  if (outside > 0 || all) console.print(table.text(console) + "\n");
  console.print(
      fmt::format("{} rows in both: {} the same within the noise, {} faster, {} slower, {} changed\n",
                  found.rows.size(), found.count(Verdict::same), found.count(Verdict::faster),
                  found.count(Verdict::slower), found.count(Verdict::changed)));
  if (!found.only_in_a.empty() || !found.only_in_b.empty())
    console.print(
        fmt::format("only in A: {}, only in B: {}\n", found.only_in_a.size(), found.only_in_b.size()));
  for (const std::string& remark : found.remarks) console.print(remark + "\n");
}

}  // namespace

void add_export(CLI::App& app, Console& console) {
  CLI::App& command = add_command(app, console, "export", "Write the rows of a store for other programs",
                                  {"hmax export study --format csv --output study.csv",
                                   "hmax export results/runs/study.sqlite --format gbench"});
  struct Options {
    std::string store, format{export_formats().front().name}, output;
  };
  auto options = std::make_shared<Options>();
  command.add_option("store", options->store, "Its file, or its name under results/runs")
      ->required()
      ->type_name("");
  std::string formats;
  for (const ExportFormat& each : export_formats())
    formats += fmt::format("{}{}{}", formats.empty() ? "" : ", ", each.name,
                           each.description.empty() ? "" : fmt::format(" ({})", each.description));
  command.add_option("--format", options->format, fmt::format("{}; {} by default", formats, options->format))
      ->type_name("NAME");
  command.add_option("--output", options->output, "Write to a file instead of standard output")
      ->type_name("FILE");
  add_force(command);
  command.callback(
      [options, &console] { export_rows(options->store, options->format, options->output, console); });
}

void add_compare(CLI::App& app, Console& console) {
  CLI::App& command =
      add_command(app, console, "compare",
                  "Say which differences between two stores are outside the noise; exit 1 if any",
                  {"hmax compare before after", "hmax compare before.sqlite after.sqlite --json"});
  struct Options {
    std::string a, b;
    bool all = false;
  };
  auto options = std::make_shared<Options>();
  command.add_option("A", options->a, "The store to compare with: its file, or its name under results/runs")
      ->required()
      ->type_name("");
  command.add_option("B", options->b, "The store that is judged")->required()->type_name("");
  command.add_flag("--all", options->all, "Also show the rows that are the same");
  command.callback([options, &console] { compare_stores(options->a, options->b, options->all, console); });
}

}  // namespace hmax
