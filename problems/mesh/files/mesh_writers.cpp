#include "problems/mesh/files/mesh_writers.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string_view>

#include "core/own_files.hpp"
#include "core/text/base64.hpp"
#include "problems/digits.hpp"

namespace hmax {

namespace {

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  return result;
}

std::string xml_head() { return "<?xml version=\"1.0\"?>\n<!-- " + std::string(own_mark) + " -->\n"; }

/// The arrays of a .vtu, in place or behind the tags.
class VtuArrays {
 public:
  explicit VtuArrays(VtuEncoding encoding) : encoding_(encoding) {}

  /// @param counted  the tag tells how many there are, as field data need it
  template <class Number>
  void add(std::string& text, std::string_view name, const Number* values, std::size_t count,
           Eigen::Index components, bool counted = false) {
    constexpr std::string_view type = std::is_same_v<Number, double>         ? "Float64"
                                      : std::is_same_v<Number, std::int32_t> ? "Int32"
                                      : std::is_same_v<Number, std::int64_t> ? "Int64"
                                                                             : "UInt8";
    text += "<DataArray type=\"" + std::string(type) + "\" Name=\"" + escaped(name) +
            "\" NumberOfComponents=\"" + std::to_string(components) + "\"";
    if (counted) text += " NumberOfTuples=\"" + std::to_string(count) + "\"";
    const auto bytes = static_cast<std::uint64_t>(count * sizeof(Number));
    const std::string_view header(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    const std::string_view content(reinterpret_cast<const char*>(values), bytes);
    if (encoding_ == VtuEncoding::raw) {
      text += " format=\"appended\" offset=\"" + std::to_string(appended_.size()) + "\"/>\n";
      appended_.append(header).append(content);
      return;
    }
    text += encoding_ == VtuEncoding::ascii ? " format=\"ascii\">\n" : " format=\"binary\">\n";
    if (encoding_ == VtuEncoding::base64)
      text += encode_base64(std::string(header).append(content));
    else
      for (std::size_t i = 0; i < count; ++i) {
        if (i > 0) text += (i % 12 == 0 ? '\n' : ' ');
        if constexpr (sizeof(Number) == 1)
          append_digits(text, int{values[i]});
        else
          append_digits(text, values[i]);
      }
    text += "\n</DataArray>\n";
  }

  [[nodiscard]] const std::string& appended() const { return appended_; }

 private:
  VtuEncoding encoding_;
  std::string appended_;
};

void add_fields(std::string& text, VtuArrays& arrays, const std::vector<MeshField>& fields,
                Eigen::Index columns, const char* of) {
  for (const MeshField& field : fields) {
    if (field.values.cols() != columns)
      throw std::invalid_argument("the field '" + field.name + "' has " +
                                  std::to_string(field.values.cols()) + " columns for " +
                                  std::to_string(columns) + " " + of + "; give one for each");
    arrays.add(text, field.name, field.values.data(), static_cast<std::size_t>(field.values.size()),
               field.values.rows());
  }
}

/// True for numbers that count from 0 or from 1, as every format does by itself.
bool counts(const std::vector<std::int64_t>& numbers) {
  const std::int64_t first = numbers.empty() ? 0 : numbers.front();
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] != first + static_cast<std::int64_t>(i)) return false;
  return first == 0 || first == 1;
}

/// The same numbers, or 1, 2, ... where one of them is below 1, or where `parts` share them.
std::vector<std::int64_t> from_one_on(std::vector<std::int64_t> numbers, bool parts = false) {
  if (parts || std::ranges::any_of(numbers, [](std::int64_t number) { return number < 1; }))
    std::iota(numbers.begin(), numbers.end(), 1);
  return numbers;
}

/// Counts from 1 and leaves out what is taken.
class FreeNumbers {
 public:
  explicit FreeNumbers(std::vector<std::int64_t> taken) : taken_(std::move(taken)) {
    std::ranges::sort(taken_);
  }
  std::int64_t next() {
    for (++last_; at_ < taken_.size() && taken_[at_] <= last_; ++at_)
      if (taken_[at_] == last_) ++last_;
    return last_;
  }

 private:
  std::vector<std::int64_t> taken_;
  std::size_t at_ = 0;
  std::int64_t last_ = 0;
};

void add_physical_names(std::string& text, const MeshFile& file) {
  std::string names;
  std::size_t count = 0;
  const auto add = [&](int dimension, std::int64_t number, const std::string& name) {
    if (name.empty()) return;
    std::string plain = name;
    std::ranges::replace(plain, '"', '\'');
    names += std::to_string(dimension) + " " + std::to_string(number) + " \"" + plain + "\"\n";
    ++count;
  };
  for (const MeshGroup& group : file.groups) add(group.dimension, group.number, group.name);
  for (const auto& [region, name] : file.names) add(3, region, name);
  if (count > 0) text += "$PhysicalNames\n" + std::to_string(count) + "\n" + names + "$EndPhysicalNames\n";
}

/// What points and cells do not hold: groups, and the names of regions as VTK writes strings, each letter a
/// number and 0 behind the last one.
void add_field_data(std::string& text, VtuArrays& arrays, const MeshFile& file) {
  text += "<FieldData>\n";
  for (const MeshGroup& group : file.groups)
    arrays.add(text,
               std::string(group_kinds[static_cast<std::size_t>(group.dimension)]) + ":" +
                   std::to_string(group.number) + (group.name.empty() ? "" : " " + group.name),
               group.corners.data(), group.corners.size(), 1, true);
  if (!file.names.empty()) {
    text += "<DataArray type=\"String\" Name=\"region_names\" NumberOfTuples=\"" +
            std::to_string(file.names.size()) + "\" format=\"ascii\">\n";
    for (const auto& [region, name] : file.names) {
      for (const char c : std::to_string(region) + " " + name)
        text += std::to_string(static_cast<unsigned char>(c)) + " ";
      text += "0\n";
    }
    text += "</DataArray>\n";
  }
  text += "</FieldData>\n";
}

}  // namespace

std::string msh_text(const MeshFile& file) {
  const TetMesh& mesh = file.mesh;
  const std::vector<std::int64_t> points = from_one_on(file.point_numbers),
                                  numbers = from_one_on(file.numbers, file.mesh.has_ten_nodes());
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\n";
  text.append(own_mark).append("\n$EndComments\n");
  text.reserve(static_cast<std::size_t>(64 * mesh.point_count() + 48 * mesh.tetrahedron_count()) + 128);
  add_physical_names(text, file);
  text += "$Nodes\n";
  append_digits(text, mesh.point_count());
  for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
    text += '\n';
    append_digits(text, points[static_cast<std::size_t>(i)]);
    for (int k = 0; k < 3; ++k) {
      text += ' ';
      append_digits(text, mesh.points(k, i));
    }
  }
  std::size_t elements = numbers.size();
  for (const MeshGroup& group : file.groups)
    elements += group.corners.size() / (static_cast<std::size_t>(group.dimension) + 1);
  text += "\n$EndNodes\n$Elements\n";
  append_digits(text, elements);
  const auto add = [&](std::int64_t number, std::string_view kind, std::int64_t group, const auto& corners) {
    text += '\n';
    append_digits(text, number);
    text += kind;
    append_digits(text, group);
    text += ' ';
    append_digits(text, group);
    for (const TetMesh::Index corner : corners) {
      text += ' ';
      append_digits(text, points[static_cast<std::size_t>(corner)]);
    }
  };
  FreeNumbers free(numbers);
  for (const MeshGroup& group : file.groups) {
    constexpr std::array<std::string_view, 3> kinds{" 15 2 ", " 1 2 ", " 2 2 "};
    const std::size_t size = static_cast<std::size_t>(group.dimension) + 1;
    for (std::size_t begin = 0; begin < group.corners.size(); begin += size)
      add(free.next(), kinds[size - 1], group.number, std::span(group.corners).subspan(begin, size));
  }
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t)
    add(numbers[static_cast<std::size_t>(t)], " 4 2 ", mesh.region(t), mesh.tetrahedra.col(t));
  return text + "\n$EndElements\n";
}

std::string vtu_text(const MeshFile& file, const MeshFields& fields, VtuEncoding encoding) {
  static_assert(std::endian::native == std::endian::little || std::endian::native == std::endian::big);
  const TetMesh& mesh = file.mesh;
  const std::string order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  std::string text = xml_head() + "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"" + order +
                     "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n";
  VtuArrays arrays(encoding);
  if (!file.groups.empty() || !file.names.empty()) add_field_data(text, arrays, file);
  text += "<Piece NumberOfPoints=\"" + std::to_string(mesh.point_count()) + "\" NumberOfCells=\"" +
          std::to_string(mesh.tetrahedron_count()) + "\">\n";
  const auto cells = static_cast<std::size_t>(mesh.tetrahedron_count());
  text += "<Points>\n";
  arrays.add(text, "points", mesh.points.data(), static_cast<std::size_t>(mesh.points.size()), 3);
  text += "</Points>\n<Cells>\n";
  arrays.add(text, "connectivity", mesh.tetrahedra.data(), 4 * cells, 1);
  std::vector<std::int64_t> offsets(cells);
  for (std::size_t t = 0; t < cells; ++t) offsets[t] = static_cast<std::int64_t>(4 * (t + 1));
  arrays.add(text, "offsets", offsets.data(), cells, 1);
  constexpr std::uint8_t vtk_tetra = 10;
  arrays.add(text, "types", std::vector<std::uint8_t>(cells, vtk_tetra).data(), cells, 1);
  text += "</Cells>\n<PointData>\n";
  if (!counts(file.point_numbers))
    arrays.add(text, "GlobalNodeId", file.point_numbers.data(), file.point_numbers.size(), 1);
  add_fields(text, arrays, fields.points, mesh.point_count(), "points");
  text += "</PointData>\n<CellData>\n";
  if (!mesh.regions.empty()) arrays.add(text, "region", mesh.regions.data(), cells, 1);
  if (!counts(file.numbers)) arrays.add(text, "GlobalElementId", file.numbers.data(), cells, 1);
  add_fields(text, arrays, fields.tetrahedra, mesh.tetrahedron_count(), "tetrahedra");
  text += "</CellData>\n</Piece>\n</UnstructuredGrid>\n";
  if (encoding == VtuEncoding::raw)
    text += "<AppendedData encoding=\"raw\">\n_" + arrays.appended() + "\n</AppendedData>\n";
  return text + "</VTKFile>\n";
}

std::string msh_text(const TetMesh& mesh) { return msh_text(counted_from_one(mesh)); }

std::string pvd_text(std::span<const std::pair<double, std::string>> frames) {
  std::string text = xml_head() + "<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
  for (const auto& [time, file] : frames) {
    text += "<DataSet timestep=\"";
    append_digits(text, time);
    text += "\" file=\"" + escaped(file) + "\"/>\n";
  }
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace hmax
