#include "problems/mesh/files/vtu_blocks.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#if HMAX_HAVE_ZLIB
#include <zlib.h>
#endif
#if HMAX_HAVE_LZ4
#include <lz4.h>
#endif
#if HMAX_HAVE_LZMA
#include <lzma.h>
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

#if HMAX_HAVE_LZMA
bool decode_lzma_block(std::string_view block, char* bytes, std::size_t size) {
  std::uint64_t most_memory = std::uint64_t{80} << 20;  // a dictionary of 64 MiB, that of `xz -9`
  std::size_t read = 0, written = 0;
  return lzma_stream_buffer_decode(&most_memory, 0, nullptr,
                                   reinterpret_cast<const std::uint8_t*>(block.data()), &read, block.size(),
                                   reinterpret_cast<std::uint8_t*>(bytes), &written, size) == LZMA_OK &&
         written == size;
}
constexpr Decompress lzma = decode_lzma_block;
#else
constexpr Decompress lzma = nullptr;
#endif

// xz makes 7000 zeros out of a byte.
constexpr std::array<BlockCompressor, 3> compressors{{{"vtkZLibDataCompressor", "zlib1g-dev", 1032, zlib},
                                                      {"vtkLZ4DataCompressor", "liblz4-dev", 255, lz4},
                                                      {"vtkLZMADataCompressor", "liblzma-dev", 10000, lzma}}};

}  // namespace

const BlockCompressor* block_compressor(std::string_view vtk_name) {
  const auto* const known = std::ranges::find(compressors, vtk_name, &BlockCompressor::vtk_name);
  return known == compressors.end() ? nullptr : known;
}

}  // namespace hmax
