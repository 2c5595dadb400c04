/// Files that are read as a whole.
#pragma once

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

namespace hmax {

/// The bytes of a file, which is noted as an input, without the mark by which Windows tells UTF-8.
/// @param what  it should be, for errors: "a mesh file"
/// @throws std::invalid_argument  naming the file, where it does not exist, is a folder or a device, cannot
/// be read, or needs more memory than there is
std::string read_whole(const std::filesystem::path& file, std::string_view what);

/// Of a file that needs more memory than there is. @throws std::invalid_argument  naming it and its size
[[noreturn]] void refuse_too_large(const std::filesystem::path& file);

/// read() of a file, which is named where the memory for its contents runs out.
/// @throws std::invalid_argument  as refuse_too_large(), and what `read` throws
template <class Read>
auto within_memory(const std::filesystem::path& file, const Read& read) {
  try {
    return read();
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {  // of a container that could never be so large
  }
  refuse_too_large(file);
}

}  // namespace hmax
