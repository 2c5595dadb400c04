/// The input files of CalculiX and Abaqus, .inp: keywords with parameters, and lines of numbers and names
/// with commas between them. Case does not matter; ** begins a remark.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_text.hpp"

namespace hmax {

/// A line of values and where it stands.
struct InpLine {
  std::int64_t place = 0;
  std::vector<std::string_view> fields;  ///< without blanks around them
};

/// A keyword with its parameters, in upper case, and the lines below it.
struct InpCard {
  std::string keyword;                            ///< "SOLID SECTION"
  std::map<std::string, std::string> parameters;  ///< empty where one has no value
  std::int64_t place = 0;
  std::vector<InpLine> lines;

  /// The value of a parameter; nothing where it is not given.
  [[nodiscard]] std::optional<std::string> parameter(const std::string& name) const;
};

/// A whole file, which must live as long as this.
class InpFile {
 public:
  /// @throws std::invalid_argument  for lines before the first keyword and a last line without an end
  InpFile(const std::string& name, std::string_view bytes);

  [[nodiscard]] const std::string& name() const { return text_.name(); }
  [[nodiscard]] const std::vector<InpCard>& cards() const { return cards_; }
  /// A value of a line. @throws std::invalid_argument  naming the line, where it is missing or no number
  [[nodiscard]] double number(const InpLine& line, std::size_t field, const char* what) const;
  [[nodiscard]] std::int64_t integer(const InpLine& line, std::size_t field, const char* what) const;
  /// Throws "NAME, line N: `text`".
  [[noreturn]] void fail(std::int64_t place, const std::string& text) const { at(place).fail(text); }
  /// The file, for errors at a line.
  [[nodiscard]] MeshText at(std::int64_t place) const;

 private:
  [[nodiscard]] MeshText value(const InpLine& line, std::size_t field, const char* what) const;

  MeshText text_;
  std::vector<InpCard> cards_;
};

/// The names of the groups of points that *BOUNDARY fixes in directions 1 to 3, and of those that it holds
/// in any other way.
inline constexpr std::string_view held_points = "*BOUNDARY", otherwise_held_points = "*BOUNDARY, otherwise";

/// What a file says of its mesh. Regions are the sets of *SOLID SECTION, in their order from 1, or without
/// any those of *ELEMENT; groups are node sets, held_points and otherwise_held_points.
struct InpMesh {
  MeshFile mesh;
  std::vector<const InpCard*> sections;  ///< of the regions; empty where the file has none
  std::map<std::string, std::vector<std::size_t>> element_sets;
};

/// @throws std::invalid_argument  one sentence with file, line and remedy
InpMesh inp_mesh(const InpFile& file);

/// In upper case, as the names of a file are compared.
std::string upper(std::string_view text);

}  // namespace hmax
