#include "plots/figure.hpp"

#include <algorithm>
#include <atomic>

namespace hmax {
namespace {

constexpr double page_width = 900;   // at which a README shows a figure
constexpr double slide_width = 600;  // the same text is half as large again beside it
constexpr int most_slide_columns = 2;

std::atomic<FigureStyle>& chosen_style() {
  static std::atomic<FigureStyle> style = FigureStyle::page;
  return style;
}

}  // namespace

double figure_width() { return figure_style() == FigureStyle::slide ? slide_width : page_width; }

int columns_of(int asked) {
  const int columns = std::max(1, asked);
  return figure_style() == FigureStyle::slide ? std::min(columns, most_slide_columns) : columns;
}

void set_figure_style(FigureStyle style) { chosen_style() = style; }
FigureStyle figure_style() { return chosen_style(); }

double panel_width(int columns) { return figure_width() / columns_of(columns) - left_margin - right_margin; }

std::string title_of(const std::string& problem) {
  // A file of formulas may lie in a folder with an @.
  const std::size_t at = problem.ends_with(".toml") ? std::string::npos : problem.find('@');
  const std::size_t folder = problem.rfind('/');
  if (folder == std::string::npos || (at != std::string::npos && folder < at)) return problem;
  return problem.substr(0, at == std::string::npos ? 0 : at + 1) + problem.substr(folder + 1);
}

}  // namespace hmax
