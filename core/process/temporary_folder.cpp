#include "core/process/temporary_folder.hpp"

#include <stdlib.h>
#include <string>
#include <system_error>

#include "core/input_error.hpp"

namespace hmax {

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  const std::filesystem::path place = std::filesystem::temp_directory_path(error);
  std::string name = (place / "hmax_XXXXXX").string();
  if (error || !mkdtemp(name.data()))
    throw input_error(
        "no folder for temporary files can be made{}; set TMPDIR to a place that can be written",
        error ? "" : " in " + place.string());
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace hmax
