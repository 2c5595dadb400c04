#include "problems/mesh/files/vtu_blocks.hpp"

#include <algorithm>
#include <array>
#include <limits>

#if HMAX_HAVE_ZLIB
#include <zlib.h>
#endif
#if HMAX_HAVE_LZ4
#include <lz4.h>
#endif

namespace hmax {

namespace {

using Decompress = bool (*)(std::string_view block, char* bytes, std::size_t size);

#if HMAX_HAVE_ZLIB
bool inflate_block(std::string_view block, char* bytes, std::size_t size) {
  uLongf written = size;
  return uncompress(reinterpret_cast<Bytef*>(bytes), &written, reinterpret_cast<const Bytef*>(block.data()),
                    block.size()) == Z_OK &&
         written == size;
}
constexpr Decompress zlib = inflate_block;
#else
constexpr Decompress zlib = nullptr;
#endif

#if HMAX_HAVE_LZ4
bool decode_lz4_block(std::string_view block, char* bytes, std::size_t size) {
  constexpr std::size_t most = std::numeric_limits<int>::max();
  return block.size() <= most && size <= most &&
         LZ4_decompress_safe(block.data(), bytes, static_cast<int>(block.size()), static_cast<int>(size)) ==
             static_cast<int>(size);
}
constexpr Decompress lz4 = decode_lz4_block;
#else
constexpr Decompress lz4 = nullptr;
#endif

constexpr std::array<BlockCompressor, 2> compressors{
    {{"vtkZLibDataCompressor", "zlib1g-dev", 1032, zlib}, {"vtkLZ4DataCompressor", "liblz4-dev", 255, lz4}}};

}  // namespace

const BlockCompressor* block_compressor(std::string_view vtk_name) {
  const auto* const known = std::ranges::find(compressors, vtk_name, &BlockCompressor::vtk_name);
  return known == compressors.end() ? nullptr : known;
}

}  // namespace hmax
