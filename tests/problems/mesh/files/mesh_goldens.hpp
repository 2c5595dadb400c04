/// The same small mesh in every format that is read, written down by hand after the manuals of the formats.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/vtu_blocks.hpp"

namespace hmax {

/// Raw values one after the other, in the byte order asked for.
class Bytes {
 public:
  explicit Bytes(bool big = false) : swapped_(big == (std::endian::native == std::endian::little)) {}
  template <class T>
  Bytes& add(std::initializer_list<T> values) {
    for (const T value : values) {
      char bytes[sizeof(T)];
      std::memcpy(bytes, &value, sizeof(T));
      if (swapped_) std::reverse(bytes, bytes + sizeof(T));
      text_.append(bytes, sizeof(T));
    }
    return *this;
  }
  Bytes& ints(std::initializer_list<std::int32_t> values) { return add(values); }
  Bytes& longs(std::initializer_list<std::int64_t> values) { return add(values); }
  Bytes& reals(std::initializer_list<double> values) { return add(values); }
  Bytes& text(const std::string& words) {
    text_ += words;
    return *this;
  }
  [[nodiscard]] const std::string& str() const { return text_; }

 private:
  bool swapped_;
  std::string text_;
};

/// A mesh file in memory; TetGen's has a second part.
struct GoldenMesh {
  std::string name, text, ele_name, ele_text;
  bool has_regions = true;

  [[nodiscard]] MeshFile read() const {
    return ele_name.empty() ? read_mesh(name, text) : read_tetgen(name, text, ele_name, ele_text);
  }
};

/// Five corners of a cube, two tetrahedra of the regions 7 and 9.
inline TetMesh golden_mesh() {
  TetMesh mesh;
  mesh.points.resize(3, 5);
  mesh.points << 0, 0.5, 0, 0, 0.5, 0, 0, 0.5, 0, 0.5, 0, 0, 0, 0.5, 0.5;
  mesh.tetrahedra.resize(4, 2);
  mesh.tetrahedra << 0, 1, 1, 2, 2, 3, 3, 4;
  mesh.regions = {7, 9};
  return mesh;
}

namespace goldens {

/// Nodes 2, 4, 6, 8, 10: numbers need not be consecutive.
inline const std::string gmsh_nodes = "5\n2 0 0 0\n4 0.5 0 0\n6 0 .5 0\n8 0 0 5e-1\n10 0.5 +0.5 0.50\n";

inline std::string gmsh_2_binary(bool big) {
  Bytes file(big);
  file.text("$MeshFormat\n2.2 1 8\n").ints({1}).text("\n$EndMeshFormat\n$Nodes\n5\n");
  file.ints({1}).reals({0, 0, 0}).ints({2}).reals({0.5, 0, 0}).ints({3}).reals({0, 0.5, 0});
  file.ints({4}).reals({0, 0, 0.5}).ints({5}).reals({0.5, 0.5, 0.5});
  file.text("\n$EndNodes\n$Elements\n3\n");
  file.ints({2, 1, 2, /**/ 1, 3, 3, 1, 3, 2});
  file.ints({4, 2, 2, /**/ 2, 7, 1, 1, 2, 3, 4, /**/ 3, 9, 1, 2, 3, 4, 5});
  return file.text("\n$EndElements\n").str();
}

/// In 4.0 numbers of nodes have four bytes, points a box, and tags stand before dimensions.
inline std::string gmsh_40_binary() {
  Bytes file;
  file.text("$MeshFormat\n4 1 8\n").ints({1}).text("\n$EndMeshFormat\n$Entities\n");
  file.longs({1, 0, 0, 2}).ints({1}).reals({0, 0, 0, 0, 0, 0}).longs({0});
  file.ints({1}).reals({0, 0, 0, 1, 1, 1}).longs({1}).ints({7}).longs({0});
  file.ints({2}).reals({0, 0, 0, 1, 1, 1}).longs({1}).ints({9}).longs({2}).ints({5, 6});
  file.text("\n$EndEntities\n$Nodes\n").longs({2, 5}).ints({1, 0, 0}).longs({1}).ints({1}).reals({0, 0, 0});
  file.ints({1, 2, 1}).longs({4});
  file.ints({2}).reals({0.5, 0, 0, 0.1, 0.2}).ints({3}).reals({0, 0.5, 0, 0.1, 0.2});
  file.ints({4}).reals({0, 0, 0.5, 0.1, 0.2}).ints({5}).reals({0.5, 0.5, 0.5, 0.1, 0.2});
  file.text("\n$EndNodes\n$Elements\n").longs({2, 2});
  file.ints({1, 3, 4}).longs({1}).ints({1, 1, 2, 3, 4}).ints({2, 3, 4}).longs({1}).ints({2, 2, 3, 4, 5});
  return file.text("\n$EndElements\n").str();
}

inline std::string gmsh_4_binary() {
  Bytes file;
  file.text("$MeshFormat\n4.1 1 8\n").ints({1}).text("\n$EndMeshFormat\n$Entities\n");
  file.longs({1, 0, 0, 2}).ints({1}).reals({0, 0, 0}).longs({0});
  file.ints({1}).reals({0, 0, 0, 1, 1, 1}).longs({1}).ints({7}).longs({0});
  file.ints({2}).reals({0, 0, 0, 1, 1, 1}).longs({1}).ints({9}).longs({2}).ints({5, 6});
  file.text("\n$EndEntities\n$Nodes\n").longs({2, 5, 1, 5});
  file.ints({0, 1, 0}).longs({1, 1}).reals({0, 0, 0});
  file.ints({2, 1, 1}).longs({4, 2, 3, 4, 5});
  file.reals({0.5, 0, 0, 0.1, 0.2, 0, 0.5, 0, 0.1, 0.2, 0, 0, 0.5, 0.1, 0.2, 0.5, 0.5, 0.5, 0.1, 0.2});
  file.text("\n$EndNodes\n$Elements\n").longs({2, 2, 1, 2});
  file.ints({3, 1, 4}).longs({1, 1, 1, 2, 3, 4}).ints({3, 2, 4}).longs({1, 2, 2, 3, 4, 5});
  return file.text("\n$EndElements\n").str();
}

inline std::string vtk_binary(bool new_cells) {
  Bytes file(true);
  file.text("# vtk DataFile Version 3.0\ntwo\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n");
  file.add<float>({0, 0, 0, 0.5F, 0, 0, 0, 0.5F, 0, 0, 0, 0.5F, 0.5F, 0.5F, 0.5F});
  if (new_cells)
    file.text("\nMETADATA\nINFORMATION 0\n\nCELLS 3 8\nOFFSETS vtktypeint64\n")
        .longs({0, 4, 8})
        .text("\nCONNECTIVITY vtktypeint64\n")
        .longs({0, 1, 2, 3, 1, 2, 3, 4});
  else
    file.text("\nCELLS 2 10\n").ints({4, 0, 1, 2, 3, 4, 1, 2, 3, 4});
  file.text("\nCELL_TYPES 2\n")
      .ints({10, 10})
      .text("\nPOINT_DATA 5\nSCALARS a float 1\nLOOKUP_TABLE default\n");
  file.add<float>({1, 2, 3, 4, 5}).text("\nCELL_DATA 2\nFIELD FieldData 2\nquality 1 2 double\n");
  file.reals({1, 1}).text("\nregion 1 2 int\n").ints({7, 9});
  return file.text("\n").str();
}

/// @param coordinates, connectivity, offsets, types, regions  what stands for each array: its attributes and
///        contents
inline std::string vtu(const std::string& head, const std::vector<std::string>& arrays,
                       const std::string& tail) {
  return "<?xml version=\"1.0\"?>\n<!-- <VTKFile> by hand -->\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
         "byte_order=\"LittleEndian\"" +
         head +
         ">\n<UnstructuredGrid>\n<Piece NumberOfPoints='5' "
         "NumberOfCells='2'>\n<Points>\n<DataArray type=\"Float64\" NumberOfComponents=\"3\" " +
         arrays[0] + "</DataArray>\n</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" " +
         arrays[1] + "</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" " + arrays[2] +
         "</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" " + arrays[3] +
         "</DataArray>\n</Cells>\n<CellData>\n<DataArray type=\"Int16\" Name=\"region\" " + arrays[4] +
         "</DataArray>\n</CellData>\n</Piece>\n</UnstructuredGrid>\n" + tail + "</VTKFile>\n";
}

inline std::string vtu_appended_raw() {
  Bytes data;
  data.longs({120}).reals({0, 0, 0, 0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5, 0.5, 0.5, 0.5});
  data.longs({64, 0, 1, 2, 3, 1, 2, 3, 4}).longs({8}).ints({4, 8}).longs({2}).add<std::uint8_t>({10, 10});
  data.longs({4}).add<std::int16_t>({7, 9});
  const std::string start = "format=\"appended\" offset=\"";
  return vtu(" header_type=\"UInt64\"",
             {start + "0\">", start + "128\">", start + "200\">", start + "216\">", start + "226\">"},
             "<AppendedData encoding=\"raw\">\n  _" + data.str() + "\n</AppendedData>\n");
}

/// Encoded by the base64 of another program.
inline const std::string coordinates_64 =
    "eAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAOA/AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA4D8AAAAAAAAAAAAA"
    "AAAAAAAAAAAAAAAAAAAAAAAAAADgPwAAAAAAAOA/AAAAAAAA4D8AAAAAAADgPw==";
inline const std::string connectivity_64 =
    "QAAAAAAAAAAAAAAAAQAAAAAAAAACAAAAAAAAAAMAAAAAAAAAAQAAAAAAAAACAAAAAAAAAAMAAAAAAAAABAAAAAAAAAA=";
inline const std::string offsets_64 = "CAAAAAQAAAAIAAAA";
inline const std::string types_64 = "AgAAAAoK";
/// Header and values each with a padding of their own.
inline const std::string regions_64 = "BAAAAA==BwAJAA==";

inline std::string vtu_appended_base64() {
  const std::string start = "format=\"appended\" offset=\"";
  std::vector<std::string> tags;
  std::string data;
  for (const std::string* array : {&coordinates_64, &connectivity_64, &offsets_64, &types_64, &regions_64}) {
    tags.push_back(start + std::to_string(data.size()) + "\">");
    data += *array;
  }
  return vtu("", tags, "<AppendedData encoding=\"base64\">_" + data + "</AppendedData>\n");
}

/// Compressed by the zlib of another program: the coordinates in two blocks of 64 bytes, the last one
/// smaller.
inline const std::vector<std::string> zlib_arrays{
    "AgAAAEAAAAA4AAAAEgAAAA8AAAA=eJxjYMAHHtjjlQbKAwAoHgI/eJxjYMAHHtjjogE+BAR9",
    "AQAAAEAAAAAAAAAAFgAAAA==eJxjYIAARijNBKWZCYizQGkAAfAAEQ==",
    "AQAAAACAAAAIAAAADgAAAA==eJxjYWBg4ABiAABIAA0=",
    "AQAAAACAAAACAAAACgAAAA==eJzj4gIAACAAFQ==",
    "AQAAAACAAAAEAAAADAAAAA==eJxjZ+BkAAAAMgAR",
};

inline std::string vtu_zlib() {
  std::vector<std::string> tags;
  for (const std::string& array : zlib_arrays) tags.push_back("format=\"binary\">\n" + array + "\n");
  return vtu(" compressor=\"vtkZLibDataCompressor\"", tags, "");
}

/// Compressed by the xz of another program, with the smallest of dictionaries: damaged files are read often.
inline const std::vector<std::string> lzma_arrays{
    "AQAAAHgAAAAAAAAASAAAAA==/Td6WFoAAAFpIt42AgAhAQAAAAA3J5fW4AB3AA1dAABuFSfEWSHYL7ioTAAAAAAAxUlVuQABJXjCnKuWkEKZDQEA"
    "AAAAAVla",
    "AQAAAEAAAAAAAAAASAAAAA==/Td6WFoAAAFpIt42AgAhAQAAAAA3J5fW4AA/ABBdAABqfrsUbxtBDgFyUTnMrOUAfGqkvAABKEARWgcLkEKZDQEA"
    "AAAAAVla",
    "AQAAAAgAAAAAAAAAPAAAAA==/Td6WFoAAAFpIt42AgAhAQAAAAA3J5fWAQAHBAAAAAgAAAAAfPncJAABHAhEYCrIkEKZDQEAAAAAAVla",
    "AQAAAAIAAAAAAAAAOAAAAA==/Td6WFoAAAFpIt42AgAhAQAAAAA3J5fWAQABCgoAAABrE+NbAAEWAtBhENKQQpkNAQAAAAABWVo=",
    "AQAAAAQAAAAAAAAAOAAAAA==/Td6WFoAAAFpIt42AgAhAQAAAAA3J5fWAQADBwAJAADsXFFtAAEYBGvp8KWQQpkNAQAAAAABWVo="};

inline std::string vtu_lzma() {
  std::vector<std::string> tags;
  for (const std::string& array : lzma_arrays) tags.push_back("format=\"binary\">\n" + array + "\n");
  return vtu(" compressor=\"vtkLZMADataCompressor\"", tags, "");
}

/// Blocks of LZ4 with literals alone: a token with their count, beyond 14 in further bytes.
inline std::string vtu_lz4_raw() {
  Bytes data;
  const auto add = [&](const std::string& bytes) {
    std::string block(1, static_cast<char>(std::min<std::size_t>(bytes.size(), 15) << 4));
    if (bytes.size() >= 15) block += static_cast<char>(bytes.size() - 15);
    block += bytes;
    data.longs({1, 32768, static_cast<std::int64_t>(bytes.size()), static_cast<std::int64_t>(block.size())});
    data.text(block);
    return std::to_string(data.str().size());
  };
  const std::string start = "format=\"appended\" offset=\"";
  std::vector<std::string> tags{start + "0\">"};
  for (const std::string& bytes :
       {Bytes().reals({0, 0, 0, 0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5, 0.5, 0.5, 0.5}).str(),
        Bytes().longs({0, 1, 2, 3, 1, 2, 3, 4}).str(), Bytes().ints({4, 8}).str(),
        Bytes().add<std::uint8_t>({10, 10}).str(), Bytes().add<std::int16_t>({7, 9}).str()})
    tags.push_back(start + add(bytes) + "\">");
  tags.pop_back();
  return vtu(" header_type=\"UInt64\" compressor=\"vtkLZ4DataCompressor\"", tags,
             "<AppendedData encoding=\"raw\">\n_" + data.str() + "\n</AppendedData>\n");
}

}  // namespace goldens

/// Files of Gmsh.
inline std::vector<GoldenMesh> gmsh_goldens() {
  using namespace goldens;
  return {
      {"v1.msh",
       "$NOD\n" + gmsh_nodes +
           "$ENDNOD\n$ELM\n4\n1 15 0 1 1 2\n2 2 3 1 3 2 6 4\n3 4 7 1 4 2 4 6 8\n4 4 9 1 4 4 6 8 10\n$ENDELM\n",
       "", ""},
      {"v2.msh",
       "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 7 \"lobe\"\n$EndPhysicalNames\n$Nodes\n" +
           gmsh_nodes +
           "$EndNodes\n$Elements\n3\n1 2 2 3 1 2 6 4\n2 4 2 7 1 2 4 6 8\n3 4 3 9 1 0 4 6 8 10\n$EndElements\n",
       "", ""},
      {"v2_little.msh", gmsh_2_binary(false), "", ""},
      {"v2_big.msh", gmsh_2_binary(true), "", ""},
      {"v41.msh",
       "$MeshFormat\r\n4.1 0 8\r\n$EndMeshFormat\r\n$Entities\n0 0 0 2\n1 0 0 0 1 1 1 1 7 0\n2 0 0 0 1 1 1 2 9 7 3 1 2 3\n$EndEntities\n"
       "$Nodes\n2 5 1 9\n0 1 0 1\n1\n0 0 0\n3 1 0 4\n3\n5\n7\n9\n0.5 0 0\n0 0.5 0\n0 0 0.5\n0.5 0.5 0.5\n$EndNodes\n"
       "$Elements\n3 3 1 3\n2 1 2 1\n1 1 5 3\n3 1 4 1\n2 1 3 5 7\n3 2 4 1\n3 3 5 7 9\n$EndElements\n",
       "", ""},
      {"v41_binary.msh", gmsh_4_binary(), "", ""},
      // Parts of a partitioned mesh have the groups of the whole.
      {"v41_parts.msh",
       "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 2\n1 0 0 0 1 1 1 1 7 0\n2 0 0 0 1 1 1 1 9 0\n$EndEntities\n"
       "$PartitionedEntities\n2\n1\n9 1\n0 0 0 2\n3 3 1 1 1 0 0 0 1 1 1 1 7 2 5 6\n4 3 2 2 1 2 0 0 0 1 1 1 1 9 0\n"
       "$EndPartitionedEntities\n$Nodes\n1 5 1 5\n3 3 0 5\n1\n2\n3\n4\n5\n0 0 0\n0.5 0 0\n0 0.5 0\n0 0 0.5\n0.5 0.5 0.5\n"
       "$EndNodes\n$Elements\n2 2 1 2\n3 3 4 1\n1 1 2 3 4\n3 4 4 1\n2 2 3 4 5\n$EndElements\n",
       "", ""},
      {"v40.msh",
       "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Entities\n1 0 0 2\n1 0 0 0 0 0 0 0\n1 0 0 0 1 1 1 1 7 0\n2 0 0 0 1 1 1 2 9 7 3 1 2 3\n"
       "$EndEntities\n$Nodes\n2 5\n1 0 0 1\n1 0 0 0\n1 2 1 4\n3 0.5 0 0 0.1 0.2\n5 0 0.5 0 0.1 0.2\n7 0 0 0.5 0.1 0.2\n9 0.5 0.5 0.5 nan 0\n"
       "$EndNodes\n$Elements\n3 3\n1 2 2 1\n1 1 5 3\n1 3 4 1\n2 1 3 5 7\n2 3 4 1\n3 3 5 7 9\n$EndElements\n",
       "", ""},
      {"v40_binary.msh", gmsh_40_binary(), "", ""},
      {"v2_parametric.msh",
       "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n5\n1 0 0 0 0 1\n2 0.5 0 0 1 1 0.5\n3 0 0.5 0 2 1 0.1 0.2\n"
       "4 0 0 0.5 2 1 0.1 0.2\n5 0.5 0.5 0.5 3 1\n$EndParametricNodes\n$Elements\n2\n1 4 2 7 1 1 2 3 4\n2 4 2 9 1 2 3 4 5\n"
       "$EndElements\n",
       "", ""}};
}

/// Files of VTK that need no library to decompress.
inline std::vector<GoldenMesh> vtk_goldens() {
  using namespace goldens;
  const std::string binary = "format=\"binary\">\n";
  const std::string ascii = "format=\"ascii\">\n";
  return {
      {"old.vtk",
       "# vtk DataFile Version 2.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 0.5 0 0 0 0.5 0\n0 0 0.5 0.5 0.5 0.5\n"
       "CELLS 3 14\n3 0 2 1\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 3\n5 10 10\nCELL_DATA 3\nSCALARS region int 1\nLOOKUP_TABLE default\n1 7 9\n",
       "", ""},
      {"new.vtk",
       "# vtk DataFile Version 5.1\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 0.5 0 0 0 0.5 0\n0 0 0.5 0.5 0.5 0.5\n"
       "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 2 3 4\nCELL_TYPES 2\n10\n10\n",
       "", "", false},
      // A field of the whole file stands first; keywords are not as they should be, nor are values that
      // nobody needs.
      {"field.vtk",
       "# vtk datafile version 2.0\ntwo\nascii\ndataset unstructured_grid\nField FieldData 3\ntext 1 2 string\ntwo%20words\n\n"
       "bits 1 9 bit\n0 1 0 1 0 1 0 1\n0\nTIME 1 1 Double\nnan\nPoints 5 Float\n0 0 0 0.5 0 0 0 0.5 0\n0 0 0.5 0.5 0.5 0.5\n"
       "cells 2 10\n4 0 1 2 3\n4 1 2 3 4\nCell_Types 2\n10 10\npoint_data 5\nscalars u float 1\nlookup_table default\n"
       "0 1.#IND -nan(ind) none 4\nCell_Data 2\nScalars region float 1\nLookup_Table default\n7.0 9.0\n",
       "", ""},
      {"old_binary.vtk", vtk_binary(false), "", ""},
      {"new_binary.vtk", vtk_binary(true), "", ""},
      {"ascii.vtu",
       vtu("",
           {ascii + "0 0 0 0.5 0 0 0 0.5 0 0 0 0.5\n0.5 0.5 0.5\n", ascii + "0 1 2 3 1 2 3 4", ascii + "4 8",
            ascii + "10 10", ascii + "7 9"},
           ""),
       "", ""},
      {"base64.vtu",
       vtu("",
           {binary + coordinates_64, binary + connectivity_64, binary + offsets_64, binary + types_64 + "\n",
            binary + regions_64},
           ""),
       "", ""},
      {"appended_raw.vtu", vtu_appended_raw(), "", ""},
      {"appended_base64.vtu", vtu_appended_base64(), "", ""}};
}

/// Files of TetGen, Medit and Vega.
inline std::vector<GoldenMesh> text_goldens() {
  return {
      {"zero.node",
       "# by hand\n5 3 0 1\n0 0 0 0 1\n1 0.5 0 0 1\n2 0 0.5 0 1 # a remark\n3 0 0 0.5 1\n4 0.5 0.5 0.5 1\n",
       "zero.ele", "2 4 1\n0 0 1 2 3 7\n1 1 2 3 4 9\n"},
      {"one.node", "5 3 1 0\n1 0 0 0 9.5\n2 0.5 0 0 9.5\n3 0 0.5 0 9.5\n4 0 0 0.5 9.5\n5 0.5 0.5 0.5 9.5\n",
       "one.ele", "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n", false},
      {"extra.node",
       "5 3 1 1\n1 0 0 0 x 0 8 8\n2 0.5 0 0 x 0 8 8\n3 0 0.5 0 x 0 8 8\n4 0 0 0.5 x 0 8 8\n5 0.5 0.5 0.5 x 0 8 8\n",
       "extra.ele", "2 4 2\n1 1 2 3 4 7 x 5\n2 2 3 4 5 9 x 5\n# by another program"},
      {"no_end.mesh",
       "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n0.5 0 0 0\n0 0.5 0 0\n0 0 0.5 0\n0.5 0.5 0.5 0\n"
       "Normals\n2\nnan 0 inf\n1e-400 x 2\ntetrahedra\n2\n1 2 3 4 7.0\n2 3 4 5 9.0\n",
       "", ""},
      {"ghs3d.mesh",
       "MeshVersionFormatted 2\n\nDimension\n3\n\nVertices\n5\n0 0 0 1\n0.5D+00 0 0 1\n0 5.d-1 0 1\n0 0 0.5 1\n0.5 0.5 0.5 1\n\nTriangles\n1\n1 3 2 4\n\n"
       "RequiredVertices\n2\n1 2\nTetrahedra\n2\n1 2 3 4 7\n2 3 4 5 9\n\nEnd\n",
       "", ""},
      {"one.veg",
       "# by hand\n*VERTICES\n5 3 0 0\n1 0 0 0\n2 0.5 0 0\n3 0 0.5 0\n4 0 0 0.5\n5 0.5 0.5 0.5\n\n*ELEMENTS\nTET\n2 4 0\n"
       "1 1 2 3 4\n2 2 3 4 5\n\n*MATERIAL soft\nENU, 1000, 5000, 0.45\n*SET lobe\n1,2\n*SET tip\n2\n"
       "*REGION\nlobe, soft\n*REGION\ntip, soft\n",
       "", "", false}};
}

inline std::vector<GoldenMesh> golden_meshes() {
  using namespace goldens;
  std::vector<GoldenMesh> all = gmsh_goldens();
  for (const std::vector<GoldenMesh>& some : {vtk_goldens(), text_goldens()})
    all.insert(all.end(), some.begin(), some.end());
  if (block_compressor("vtkZLibDataCompressor")->decompress) all.push_back({"zlib.vtu", vtu_zlib(), "", ""});
  if (block_compressor("vtkLZMADataCompressor")->decompress) all.push_back({"lzma.vtu", vtu_lzma(), "", ""});
  if (block_compressor("vtkLZ4DataCompressor")->decompress) all.push_back({"lz4.vtu", vtu_lz4_raw(), "", ""});
  return all;
}

/// `text` with its first `old` replaced.
inline std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const std::size_t at = text.find(old);
  if (at == std::string::npos) throw std::invalid_argument("'" + old + "' is not in the text");
  return text.replace(at, old.size(), by);
}

}  // namespace hmax
