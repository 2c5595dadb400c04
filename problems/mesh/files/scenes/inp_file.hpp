/// The input files of CalculiX and Abaqus, .inp: keywords with parameters, and lines of numbers and names
/// with commas between them. Case does not matter; ** begins a remark. *INCLUDE stands for the lines of
/// another file. A file may have one *PART with one *INSTANCE where it is.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {

/// A line of values and where it stands: its place among the lines of all files together, from 1.
struct InpLine {
  std::int64_t place = 0;
  std::vector<std::string_view> fields;  ///< without blanks around them
  bool goes_on = false;                  ///< it ends with a comma
};

/// A keyword with its parameters, in upper case, and the lines below it.
struct InpCard {
  std::string keyword;                            ///< "SOLID SECTION"
  std::map<std::string, std::string> parameters;  ///< empty where one has no value
  std::int64_t place = 0;
  std::vector<InpLine> lines;
  bool is_in_part = false;

  /// The value of a parameter; nothing where it is not given.
  [[nodiscard]] std::optional<std::string> parameter(const std::string& name) const;
  /// The first one that is not in a list, or is an OP that removes what stands before, or a SYSTEM that is
  /// not rectangular; null where there is none.
  [[nodiscard]] const std::string* unknown_parameter(std::string_view known) const;
};

/// A whole file, which must live as long as this, with those that it includes from its folder.
class InpFile {
 public:
  /// @throws std::invalid_argument  for lines before the first keyword, a last line without an end that is no
  ///                                *END, files that are not there, and several parts or instances
  InpFile(const std::string& name, std::string_view bytes);

  [[nodiscard]] const std::string& name() const { return text_.name(); }
  [[nodiscard]] const std::vector<InpCard>& cards() const { return cards_; }
  /// "PART-1-1." before the names and numbers of the part, where sets and loads outside of it name them;
  /// empty where there are no parts.
  [[nodiscard]] const std::string& prefix() const { return prefix_; }
  /// The line of the file itself, or of its *INCLUDE.
  [[nodiscard]] std::int64_t own_line(std::int64_t place) const;
  /// The line in its own file.
  [[nodiscard]] std::int64_t line(std::int64_t place) const;
  /// A value of a line. @throws std::invalid_argument  naming the line, where it is missing or no number
  [[nodiscard]] double number(const InpLine& line, std::size_t field, const char* what) const;
  [[nodiscard]] std::int64_t integer(const InpLine& line, std::size_t field, const char* what) const;
  /// Throws "NAME, line N: `text`".
  [[noreturn]] void fail(std::int64_t place, const std::string& text) const { at(place).fail(text); }
  /// The file, for errors at a line.
  [[nodiscard]] MeshText at(std::int64_t place) const;

 private:
  /// Places from `first` on are the lines from `line` on of a file.
  struct Stretch {
    std::int64_t first, line;
    MeshText text;
    std::int64_t own_line;  ///< of the first *INCLUDE on the way to it; 0 of the file itself
  };

  void read(MeshText lines, std::string_view bytes, std::int64_t own_line, int depth);
  void include(std::int64_t place, std::int64_t own_line, int depth);
  void find_part();
  [[nodiscard]] const Stretch& stretch(std::int64_t place) const;
  [[nodiscard]] MeshText value(const InpLine& line, std::size_t field, const char* what) const;

  MeshText text_;
  std::vector<InpCard> cards_;
  std::vector<Stretch> stretches_;
  std::vector<std::unique_ptr<const std::string>> included_;
  std::int64_t place_ = 0;  ///< of the line that was read last
  bool goes_on_ = false;    ///< a keyword whose parameters are continued on the next line
  std::string input_;       ///< of the last *INCLUDE, in its own case
  std::string prefix_;
};

/// The names of the groups of points that *BOUNDARY fixes in directions 1 to 3, and of those that it holds
/// in any other way, also besides that.
inline constexpr std::string_view held_points = "*BOUNDARY", otherwise_held_points = "*BOUNDARY, otherwise";

/// What a file says of its mesh. Regions are the sets of *SOLID SECTION, in their order from 1, or without
/// any those of *ELEMENT; groups are node sets, held_points and otherwise_held_points.
struct InpMesh {
  MeshFile mesh;
  const InpLine* otherwise_held = nullptr;  ///< of *BOUNDARY, the first line of such a point
  std::vector<const InpCard*> sections;     ///< of the regions; empty where the file has none
  std::map<std::string, std::vector<std::size_t>> element_sets;
};

/// The parameters of a *BOUNDARY that is read: what is fixed at 0 does not move, whatever its amplitude.
inline constexpr std::string_view boundary_parameters = "OP|AMPLITUDE|TYPE";

/// @throws std::invalid_argument  one sentence with file, line and remedy
InpMesh inp_mesh(const InpFile& file);

}  // namespace hmax
