/// A file that is being written beside the one that it will replace.
#pragma once

#include <filesystem>
#include <string_view>

namespace hmax {

/// Made with a name that nobody can foresee and that nobody else has; removed unless it has replaced its
/// file, by a signal that ends the program too (remove_part_file()). One at a time.
class PartFile {
 public:
  /// @throws std::system_error when it cannot be made
  explicit PartFile(const std::filesystem::path& file);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// @throws std::system_error when there is no room
  void write(std::string_view text);
  /// Moves it to the place of its file. @throws std::system_error
  void replace();

 private:
  std::filesystem::path file_, part_;
  int descriptor_;
};

/// For handlers of signals: removes the file that is being written, if there is one.
void remove_part_file() noexcept;

}  // namespace hmax
