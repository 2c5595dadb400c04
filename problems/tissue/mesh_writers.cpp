#include "problems/tissue/mesh_writers.hpp"

#include <bit>
#include <charconv>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "problems/tissue/base64.hpp"

namespace hmax {

namespace {

template <class Number>
void append(std::string& text, Number value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

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

/// The arrays of a .vtu, in place or behind the tags.
class VtuArrays {
 public:
  explicit VtuArrays(VtuEncoding encoding) : encoding_(encoding) {}

  template <class Number>
  void add(std::string& text, std::string_view name, const Number* values, std::size_t count,
           Eigen::Index components) {
    constexpr std::string_view type = std::is_same_v<Number, double>         ? "Float64"
                                      : std::is_same_v<Number, std::int32_t> ? "Int32"
                                      : std::is_same_v<Number, std::int64_t> ? "Int64"
                                                                             : "UInt8";
    text += "<DataArray type=\"" + std::string(type) + "\" Name=\"" + escaped(name) +
            "\" NumberOfComponents=\"" + std::to_string(components) + "\"";
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
          append(text, int{values[i]});
        else
          append(text, values[i]);
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

}  // namespace

std::string msh_text(const TetMesh& mesh) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n";
  text.reserve(static_cast<std::size_t>(64 * mesh.point_count() + 48 * mesh.tetrahedron_count()) + 128);
  append(text, mesh.point_count());
  for (Eigen::Index i = 0; i < mesh.point_count(); ++i) {
    text += '\n';
    append(text, i + 1);
    for (int k = 0; k < 3; ++k) {
      text += ' ';
      append(text, mesh.points(k, i));
    }
  }
  text += "\n$EndNodes\n$Elements\n";
  append(text, mesh.tetrahedron_count());
  for (Eigen::Index t = 0; t < mesh.tetrahedron_count(); ++t) {
    text += '\n';
    append(text, t + 1);
    text += " 4 2 ";
    append(text, mesh.region(t));
    text += ' ';
    append(text, mesh.region(t));
    for (int i = 0; i < 4; ++i) {
      text += ' ';
      append(text, mesh.tetrahedra(i, t) + 1);
    }
  }
  return text + "\n$EndElements\n";
}

std::string vtu_text(const TetMesh& mesh, const MeshFields& fields, VtuEncoding encoding) {
  static_assert(std::endian::native == std::endian::little || std::endian::native == std::endian::big);
  const std::string order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"" + order +
      "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
      std::to_string(mesh.point_count()) + "\" NumberOfCells=\"" + std::to_string(mesh.tetrahedron_count()) +
      "\">\n";
  const auto cells = static_cast<std::size_t>(mesh.tetrahedron_count());
  VtuArrays arrays(encoding);
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
  add_fields(text, arrays, fields.points, mesh.point_count(), "points");
  text += "</PointData>\n<CellData>\n";
  if (!mesh.regions.empty()) arrays.add(text, "region", mesh.regions.data(), cells, 1);
  add_fields(text, arrays, fields.tetrahedra, mesh.tetrahedron_count(), "tetrahedra");
  text += "</CellData>\n</Piece>\n</UnstructuredGrid>\n";
  if (encoding == VtuEncoding::raw)
    text += "<AppendedData encoding=\"raw\">\n_" + arrays.appended() + "\n</AppendedData>\n";
  return text + "</VTKFile>\n";
}

std::string pvd_text(std::span<const std::pair<double, std::string>> frames) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
  for (const auto& [time, file] : frames) {
    text += "<DataSet timestep=\"";
    append(text, time);
    text += "\" file=\"" + escaped(file) + "\"/>\n";
  }
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace hmax
