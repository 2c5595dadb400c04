/// A report while it is made: the values, figures, tables and links of its text.
#pragma once

#include <filesystem>
#include <string>

#include "cli/reproduce/report_text.hpp"
#include "plots/draw.hpp"
#include "results/json.hpp"
#include "results/table.hpp"

namespace hmax {

class ReportPage {
 public:
  /// @param text  its name in cli/reproduce/texts
  ReportPage(std::string text, std::filesystem::path into)
      : folder(std::move(into)), text_(std::move(text)) {}

  /// Draws {{figure name}}. @throws InputError  as draw()
  void draw(const Figure& figure, const std::string& name);
  /// {{figure name}} by the name of its files.
  void show(const FigureFiles& figure);
  /// {{table name}}
  void show(const std::string& name, const Table& table);
  /// {{link name}} with these words, to a file of the folder. Without words the link is called as the file.
  void link(const std::string& name, const std::string& file, const std::string& words = {});
  /// Writes numbers for programs, under this name in an object, and links them: {{link file}}.
  void write_numbers(const std::string& file, const std::string& name, const Json& numbers);
  /// {{link rows.html}}, which vanishes where the folder has no such page.
  void link_to_rows();

  /// The text, filled. @throws std::logic_error  as filled()
  [[nodiscard]] std::string text() const { return filled(report_text(text_), values, pieces_); }
  /// Writes README.md and index.html. @returns the index.html
  [[nodiscard]] std::filesystem::path write() const;

  const std::filesystem::path folder;
  Json values = Json::object();

 private:
  std::string text_;
  ReportPieces pieces_;
};

}  // namespace hmax
