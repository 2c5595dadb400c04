/// `hmax reproduce tissue`: springs and finite elements on the phantom and the liver, at rest and in motion,
/// in one folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "cli/reproduce/tissue_study.hpp"

namespace hmax {

/// Writes pictures, figures, tables and a report (README.md, index.html) into `folder`.
/// @param progress  told the share that is done and what comes next; may throw to stop
/// @throws InputError when the folder cannot be written
TissueStudy reproduce_tissue(const std::filesystem::path& folder, const TissueOptions& options,
                             const std::function<void(double, const std::string&)>& progress);

}  // namespace hmax
