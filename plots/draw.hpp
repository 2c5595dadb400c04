/// The one function that draws a figure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plots/figure.hpp"

namespace hmax {

/// What `draw` left behind.
struct FigureFiles {
  std::filesystem::path base;  ///< directory / name without extension
  std::vector<std::filesystem::path>
      made{};             ///< every file that exists now: .gp, .dat, and .svg, .png, .pdf when drawn
  std::string problem{};  ///< empty when drawn; otherwise one sentence with the remedy
  std::string alt = {};   ///< what is seen, in words
  bool drawn() const { return problem.empty(); }
};

/// Writes name.gp and name.dat into `directory` (made when missing) and lets gnuplot draw name.svg, name.png,
/// name.pdf. `gnuplot name.gp` in that directory draws them again. The same figure gives the same bytes: no
/// dates, no absolute paths. Several threads may draw figures of different names.
/// @param name  letters, digits, '_', '-'
/// @throws InputError when the name has other characters, a figure has no panel, or a file cannot be written
FigureFiles draw(const Figure& figure, const std::filesystem::path& directory, const std::string& name);

/// Throws what `draw` would throw now because files are there that it must not replace: for callers whose
/// figure takes long to compute.
/// @throws InputError
void check_figure_files(const std::filesystem::path& directory, const std::string& name);

/// The text of name.gp and of name.dat, what `draw` writes.
struct FigureSource {
  std::string script, data;
};
FigureSource source_of(const Figure& figure, const std::string& name);

}  // namespace hmax
