/// `hmax reproduce tissue`: springs and finite elements on the phantom and the liver, at rest and in motion,
/// in one folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace hmax {

/// The outcome in numbers.
struct TissueStudy {
  std::filesystem::path report;   ///< the README.md
  double force_ratio = 0;         ///< cost of the forces on the liver, finite elements over springs
  double step_ratio = 0;          ///< the same of a step of linearly implicit Euler
  double deflection_springs = 0;  ///< largest displacement of the liver under the same load [m]
  double deflection_elements = 0;
  int unsolved = 0;  ///< static ways that did not converge
};

/// Writes pictures, figures, tables and a README.md into `folder`.
/// @param machine   one line: where it was done
/// @param progress  told the share that is done and what comes next; may throw to stop
/// @throws InputError when the folder cannot be written
TissueStudy reproduce_tissue(const std::filesystem::path& folder, const std::string& machine,
                             const std::function<void(double, const std::string&)>& progress);

}  // namespace hmax
