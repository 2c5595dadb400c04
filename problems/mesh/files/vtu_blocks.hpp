/// Compressed blocks of VTK's XML files; for the sources of the readers only.
#pragma once

#include <cstddef>
#include <string_view>

namespace hmax {

/// A compressor as VTK names it.
struct BlockCompressor {
  std::string_view vtk_name;  ///< "vtkZLibDataCompressor"
  std::string_view package;   ///< of Debian, with which hmax reads it
  std::size_t most;           ///< no byte stands for more bytes than this
  bool (*decompress)(std::string_view block, char* bytes, std::size_t size);  ///< null: built without it
};

/// Null for one that nobody reads.
const BlockCompressor* block_compressor(std::string_view vtk_name);

}  // namespace hmax
