#include "cli/reproduce/report_page.hpp"

#include <fmt/format.h>

#include "core/own_files.hpp"
#include "plots/pages/report.hpp"
#include "results/table.hpp"

namespace hmax {

void ReportPage::draw(const Figure& figure, const std::string& name) {
  show(hmax::draw(figure, folder, name));
}

void ReportPage::show(const FigureFiles& figure) {
  pieces_["figure " + figure.base.filename().string()] = figure_markdown(figure, folder);
}

void ReportPage::show(const std::string& name, const Table& table) {
  std::string text = markdown_table(table);
  text.pop_back();
  pieces_["table " + name] = std::move(text);
}

void ReportPage::link(const std::string& name, const std::string& file, const std::string& words) {
  pieces_["link " + name] = fmt::format("[{}]({})", markdown_text(words.empty() ? file : words), file);
}

void ReportPage::write_numbers(const std::string& file, const std::string& name, const Json& numbers) {
  write_file(folder / file, Json{{"made", own_mark}, {name, numbers}}.dump(2) + "\n");
  link(file, file);
}

void ReportPage::link_to_rows() {
  pieces_["link rows.html"] = std::filesystem::exists(folder / "rows.html")
                                  ? "[Every row, with figures to hover over](rows.html)."
                                  : "";
}

std::filesystem::path ReportPage::write() const { return write_report(text(), folder); }

}  // namespace hmax
