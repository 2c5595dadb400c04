/// hmax report: result stores as one page of HTML.
#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "cli/shared/commands.hpp"
#include "cli/shared/named_stores.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "plots/pages/store_report.hpp"
#include "results/build_info.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

namespace {

struct ReportOptions {
  std::vector<std::string> stores;
  std::string output;
};

ReportedStore content_of(const Store& store) { return reported_store(store, store.file().generic_string()); }

/// The stores that are named, each once.
/// @throws InputError  where one is none
std::vector<ReportedStore> named_stores(const std::vector<std::string>& names) {
  std::vector<ReportedStore> stores;
  for (const std::string& name : names) {
    ReportedStore content = content_of(open_store(name));
    if (std::ranges::find(stores, content.name, &ReportedStore::name) == stores.end())
      stores.push_back(std::move(content));
  }
  return stores;
}

/// Every store of results/runs. Files there that are none are told, and left out.
std::vector<ReportedStore> all_stores(Console& console) {
  std::vector<ReportedStore> stores;
  for (const std::filesystem::path& file : stored_files()) {
    try {
      stores.push_back(content_of(Store::open_existing(file)));
    } catch (const InputError& error) {
      console.remark(fmt::format("left out: {}", error.what()));
    }
  }
  return stores;
}

/// Leaves out stores without rows. @throws InputError  where no row is left
void leave_out_empty(std::vector<ReportedStore>& stores, Console& console) {
  std::string empty;
  for (const ReportedStore& store : stores)
    if (store.size() == 0) empty += fmt::format("{}'{}'", empty.empty() ? "" : ", ", store.name);
  std::erase_if(stores, [](const ReportedStore& store) { return store.size() == 0; });
  if (stores.empty())
    throw InputError(fmt::format("no rows to report{}; `hmax sweep --out NAME` stores some",
                                 empty.empty() ? "" : " in " + empty));
  if (!empty.empty()) console.remark(fmt::format("left out, without rows: {}", empty));
}

Json to_json(const ReportOptions& options, const std::vector<ReportedStore>& stores) {
  Json list = Json::array();
  std::size_t rows = 0;
  for (const ReportedStore& store : stores) {
    rows += store.size();
    list.push_back({{"store", store.name},
                    {"runs", store.runs.size()},
                    {"limits", store.limits.size()},
                    {"advice", store.advice.size()}});
  }
  return {{"report", options.output}, {"stores", std::move(list)}, {"rows", rows}};
}

void report(const ReportOptions& options, Console& console) {
  check_page_name(options.output, "report.html");
  check_writable(options.output);
  std::vector<ReportedStore> stores =
      options.stores.empty() ? all_stores(console) : named_stores(options.stores);
  leave_out_empty(stores, console);
  const StoreReport page = store_report(stores, build_info().version);
  write_file(options.output, page.html);
  if (page.left_out > 0)
    console.remark(fmt::format(
        "{} rows are left out, since the page would be larger than 5 MB; name fewer stores", page.left_out));
  const Json document = to_json(options, stores);
  console.show(document, fmt::format("{} rows of {} {} in {}\n", document.at("rows").get<std::size_t>(),
                                     stores.size(), stores.size() == 1 ? "store" : "stores", options.output));
}

}  // namespace

void add_report(CLI::App& app, Console& console) {
  const auto [command, options] = add_command(
      app, console, "report", "Write result stores as one page of HTML: advice, runs, limits",
      {"hmax report --output report.html", "hmax report study limits.sqlite --output report.html --json"},
      report);
  add_arguments(
      command, "store", options.stores,
      "Files of stores, or their names under results/runs; every store in results/runs and its folders by default");
  require(add_text(command, "--output", options.output, "Page to write, a file that ends in .html", "FILE"));
  add_force(command);
}

}  // namespace hmax
