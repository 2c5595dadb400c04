/// A place for files that nobody keeps.
#pragma once

#include <filesystem>

namespace hmax {

/// A folder that lives as long as this object.
class TemporaryFolder {
 public:
  /// @throws InputError  when none can be made
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace hmax
