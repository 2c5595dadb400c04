#include "cli/reproduce/rows_page.hpp"

#include "plots/pages/store_report.hpp"
#include "results/build_info.hpp"
#include "results/table.hpp"

namespace hmax {

RowsPage write_rows_page(const std::filesystem::path& folder, const std::vector<std::string>& stores) {
  std::vector<ReportedStore> contents;
  for (const std::string& name : stores)
    contents.push_back(reported_store(Store::open_existing(folder / name), name));
  const StoreReport page = store_report(contents, build_info().version);
  const std::filesystem::path file = folder / "rows.html";
  write_file(file, page.html);
  return {.file = file, .left_out = page.left_out};
}

}  // namespace hmax
