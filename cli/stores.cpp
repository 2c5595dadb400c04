/// hmax export, hmax compare and hmax merge: measured rows out of their stores, and into one.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/shared/commands.hpp"
#include "cli/shared/mpirun.hpp"
#include "cli/shared/named_stores.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "results/compare.hpp"
#include "results/compare_limits.hpp"
#include "results/exports.hpp"
#include "results/json.hpp"
#include "results/merge/merge_stores.hpp"
#include "results/store.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

Fingerprint last_fingerprint(const Store& store) {
  const auto sessions = store.sessions();
  return sessions.empty() ? Fingerprint{} : sessions.back().fingerprint;
}

/// JSON lines as the objects of one array.
Json array_of_lines(const std::string& lines) {
  Json document = Json::array();
  for (std::size_t begin = 0, end; (end = lines.find('\n', begin)) != std::string::npos; begin = end + 1)
    document.push_back(Json::parse(lines.begin() + static_cast<std::ptrdiff_t>(begin),
                                   lines.begin() + static_cast<std::ptrdiff_t>(end)));
  return document;
}

/// What a store holds.
constexpr std::array<std::string_view, 3> kinds{"runs", "limits", "advice"};

struct ExportOptions {
  std::string store, of{kinds[0]}, format{export_formats[0]}, output;
};

/// What is written: a text, its opening, and how many rows it has.
struct Exported {
  std::string text;
  std::string_view opening;
  std::size_t rows;
};

/// Rows that are written as csv or jsonl.
/// @param header  the first names of columns
template <class Record>
Exported exported(const std::vector<Record>& rows, std::string_view format, std::string_view header) {
  if (format == "csv") return {rows_to_csv(rows), header, rows.size()};
  return {rows_to_jsonl(rows), "{\"problem\":\"", rows.size()};
}

Exported exported_rows(const Store& store, std::string_view kind, std::string_view format) {
  constexpr std::string_view header = "problem,material,parameters,y0,model,";
  if (kind != kinds[0] && format == "gbench")
    throw InputError(fmt::format("--format is '{}', but {} are written as csv or jsonl", format,
                                 kind == kinds[1] ? "limits" : "rows of advice"));
  if (kind == kinds[1]) return exported(store.limits(), format, header);
  if (kind == kinds[2]) return exported(store.advice(), format, header);
  const std::vector<Row> rows = store.rows();
  if (format != "gbench") return exported(rows, format, "problem,material,method,mode,h,rtol,");
  return {rows_to_google_benchmark(rows, last_fingerprint(store)),
          "{\n  \"context\": {\n    \"executable\": \"hmax\"", rows.size()};
}

/// What a store has where it has nothing of a kind.
std::string remark_on_none(const Store& store, std::string_view kind) {
  std::string others;
  for (const std::string_view other : kinds)
    if (exported_rows(store, other, "jsonl").rows > 0)
      others += fmt::format("{}--of {}", others.empty() ? "; " : " or ", other);
  return fmt::format("'{}' holds no {}{}", store.file().string(), kind,
                     others.empty() ? "" : others + " writes what it has");
}

void export_rows(const ExportOptions& options, Console& console) {
  const std::string& output = options.output;
  const std::string format = parse_choice("--format", options.format, export_formats);
  const std::string kind = parse_choice("--of", options.of, kinds);
  const Store store = open_store(options.store);
  const Exported out = exported_rows(store, kind, format);
  if (!output.empty()) {
    write_file(output, out.text, out.opening);
    if (console.json)
      console.print_json(
          Json{{"store", store.file().string()}, {"format", format}, {"rows", out.rows}, {"output", output}});
    else
      console.print(fmt::format("{} rows in {}\n", out.rows, output));
  } else if (console.json && format != "gbench") {
    // One document whatever the format.
    console.print_json(array_of_lines(exported_rows(store, kind, "jsonl").text));
  } else {
    console.print(out.text);
  }
  if (out.rows == 0) console.remark(remark_on_none(store, kind));
}

Json to_json(const RowComparison& row) {
  const bool there = !row.key.device.empty();
  const auto of = [](bool clock, double seconds) { return clock ? Json(seconds) : Json(); };
  return {{"row", benchmark_name(row.key)},
          HMAX_KEYS(row.key, problem, material, method, mode),
          {"h", row.key.mode == "adaptive" ? Json() : Json(row.key.h)},
          {"rtol", row.key.mode == "fixed" ? Json() : Json(row.key.rtol)},
          {"t_end", row.key.t_end},
          {"verdict", to_string(row.verdict)},
          {"cpu_median_a_s", of(!there, row.median_a)},
          {"cpu_median_b_s", of(!there, row.median_b)},
          {"device", row.key.device},
          {"device_median_a_s", of(there, row.median_a)},
          {"device_median_b_s", of(there, row.median_b)},
          HMAX_KEYS(row, ratio, relative_ratio, p, noise_floor, changes)};
}

Json names(const std::vector<RowKey>& keys) {
  Json list = Json::array();
  for (const RowKey& key : keys) list.push_back(benchmark_name(key));
  return list;
}

Json to_json(const LimitComparison& limits) {
  Json changed = Json::array();
  for (const LimitChange& each : limits.changed)
    changed.push_back({{"limit", each.name}, {"changes", each.changes}});
  return {{"compared", limits.compared},
          {"changed", std::move(changed)},
          HMAX_KEYS(limits, only_in_a, only_in_b)};
}

/// Empty where neither store has limits.
std::string words_of(const LimitComparison& limits) {
  const std::size_t alone = limits.only_in_a.size() + limits.only_in_b.size();
  if (limits.compared + alone == 0) return {};
  std::string text = fmt::format("{} limits in both: {} the same, {} changed\n", limits.compared,
                                 limits.compared - limits.changed.size(), limits.changed.size());
  for (const LimitChange& each : limits.changed)
    text += fmt::format("  {}: {}\n", each.name, fmt::join(each.changes, "; "));
  if (alone > 0)
    text += fmt::format("limits only in A: {}, only in B: {}\n", limits.only_in_a.size(),
                        limits.only_in_b.size());
  return text;
}

struct CompareOptions {
  std::string a, b;
  bool all = false;
};

void compare_stores(const CompareOptions& options, Console& console) {
  const auto& [a, b, all] = options;
  const Store store_a = open_store(a), store_b = open_store(b);
  const std::vector<Row> rows_a = store_a.rows(), rows_b = store_b.rows();
  Comparison found = compare(rows_a, rows_b);
  // Nothing is known of the machine of a store in which nothing was measured yet.
  if (!store_a.sessions().empty() && !store_b.sessions().empty())
    for (const std::string& difference : differences(last_fingerprint(store_a), last_fingerprint(store_b)))
      found.remarks.push_back("Measured under different conditions: " + difference + ".");
  const std::size_t outside = found.rows.size() - found.count(TimingVerdict::same);
  const LimitComparison limits = compare_limits(store_a.limits(), store_b.limits());
  const bool nothing_shared = found.rows.empty() && limits.compared == 0;
  if (outside > 0 || !limits.changed.empty() || nothing_shared) console.exit_code = Exit::failed;

  if (console.json) {
    Json rows = Json::array();
    for (const RowComparison& row : found.rows) rows.push_back(to_json(row));
    return console.print_json(Json{{"a", store_a.file().string()},
                                   {"b", store_b.file().string()},
                                   {"compared", found.rows.size()},
                                   {"same", found.count(TimingVerdict::same)},
                                   {"faster", found.count(TimingVerdict::faster)},
                                   {"slower", found.count(TimingVerdict::slower)},
                                   {"changed", found.count(TimingVerdict::changed)},
                                   HMAX_KEYS(found, common_ratio, scatter, remarks),
                                   {"only_in_a", names(found.only_in_a)},
                                   {"only_in_b", names(found.only_in_b)},
                                   {"rows", rows},
                                   {"limits", to_json(limits)}});
  }
  TextTable table({"row", "B is", "A [s]", "B [s]", "B/A", "p", "changes"});
  for (const RowComparison& row : found.rows) {
    if (row.verdict == TimingVerdict::same && !all) continue;
    table.add({benchmark_name(row.key), std::string(to_string(row.verdict)), short_number(row.median_a, 3),
               short_number(row.median_b, 3), short_number(row.ratio, 3), short_number(row.p, 2),
               row.changes.empty() ? "" : row.changes.front()});
  }
  if (outside > 0 || all) console.print(table.text(console) + "\n");
  console.print(
      fmt::format("{} rows in both: {} the same within the noise, {} faster, {} slower, {} changed\n",
                  found.rows.size(), found.count(TimingVerdict::same), found.count(TimingVerdict::faster),
                  found.count(TimingVerdict::slower), found.count(TimingVerdict::changed)));
  if (!found.only_in_a.empty() || !found.only_in_b.empty())
    console.print(
        fmt::format("only in A: {}, only in B: {}\n", found.only_in_a.size(), found.only_in_b.size()));
  console.print(words_of(limits));
  for (const std::string& remark : found.remarks) console.print(remark + "\n");
}

struct MergeOptions {
  std::string out;
  std::vector<std::string> inputs;
};

void merge(const MergeOptions& options, Console& console) {
  refuse_copies("hmax merge");
  const auto& interrupted = interrupt_flag();
  // A wrong name is found before anything is written.
  std::vector<std::filesystem::path> files;
  for (const std::string& input : options.inputs) files.push_back(open_store(input).file());
  Store store = Store::open_or_create(store_path(options.out));
  Merger merger(store);
  {
    Progress progress(console, "merge");
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (interrupted) throw Interrupted::with_store(store.file().string(), merger.summary().added);
      progress.update(static_cast<double>(i) / static_cast<double>(files.size()),
                      files[i].filename().string());
      merger.add(files[i]);
    }
  }
  const MergeSummary& summary = merger.summary();
  if (!summary.conflicts.empty()) console.exit_code = Exit::failed;
  if (console.json) {
    Json conflicts = Json::array();
    for (const MergeConflict& each : summary.conflicts)
      conflicts.push_back({{"row", each.name}, {"input", each.file.string()}, {"changes", each.changes}});
    return console.print_json(Json{{"store", store.file().string()},
                                   {"inputs", files.size()},
                                   {"rows", store.size()},
                                   HMAX_KEYS(summary, added, doubled),
                                   {"conflicts", conflicts}});
  }
  console.print(fmt::format("{} stores in {}: {} rows added, {} were there already\n", files.size(),
                            store.file().string(), summary.added, summary.doubled));
  if (summary.conflicts.empty()) return;
  console.print(fmt::format("{} conflicts, the first result is kept:\n", summary.conflicts.size()));
  for (const MergeConflict& each : summary.conflicts)
    console.print(
        fmt::format("  {} of {}: {}\n", each.name, each.file.string(), fmt::join(each.changes, "; ")));
}

}  // namespace

void add_export(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "export", "Export the rows of a store",
      {"hmax export study --format csv --output study.csv", "hmax export livers --of limits --format csv",
       "hmax export results/runs/study.sqlite --format gbench"},
      export_rows);
  require(add_text(command, "store", options.store, "File of the store, or its name under results/runs", ""));
  add_text(command, "--format", options.format,
           fmt::format("{} (Google Benchmark's JSON); {} by default", fmt::join(export_formats, ", "),
                       options.format),
           "NAME");
  add_text(
      command, "--of", options.of,
      "runs, which `hmax sweep` measured; limits of `hmax stability predict --out`; advice of `hmax advise "
      "--out`; runs by default",
      "NAME");
  add_text(command, "--output", options.output, "File to write; standard output by default", "FILE");
  add_force(command);
}

void add_compare(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "compare",
      "Find the differences between two stores that are larger than the noise; exit 1 if there are any",
      {"hmax compare before after", "hmax compare before.sqlite after.sqlite --json"}, compare_stores);
  require(add_text(command, "A", options.a, "Store to compare with: its file, or its name under results/runs",
                   ""));
  require(add_text(command, "B", options.b,
                   "Store that is compared: its file, or its name under results/runs", ""));
  add_flag(command, "--all", options.all, "Also show the rows without a difference");
}

void add_merge(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "merge",
      "Put several stores into one, such as those of the shards of a sweep; exit 1 if two differ in more than time",
      {"hmax merge whole shard_1 shard_2 shard_3", "hmax merge whole.sqlite shards/*.sqlite"}, merge);
  require(add_text(command, "OUT", options.out,
                   "Store to write or to add to: a name under results/runs, or a file that ends in .sqlite",
                   ""));
  require(add_arguments(command, "IN", options.inputs,
                        "Stores to read: their files, or names under results/runs"));
}

}  // namespace hmax
