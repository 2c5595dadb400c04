/// Parts of scenes that are not understood; for the sources of the readers only.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "catalogue/scenes/scene.hpp"

namespace hmax {

/// The parts of a list, which may be empty.
std::vector<std::string_view> between_commas(std::string_view text);

/// What the user leaves out of a scene by its keywords.
class IgnoredParts {
 public:
  /// @throws InputError  for an empty part
  explicit IgnoredParts(std::string_view list);
  /// Refuses a part that is not understood, or notes that it is left out.
  /// @param where  "FILE, line N: "; @param what  "*CLOAD is forces at single points, which bodies have not"
  void refuse(const std::string& part, const std::string& where, const std::string& what);
  /// Adds what was left out to the notes of the scene.
  /// @throws InputError  for parts of which nothing had to be left out
  void finish(const std::string& file, Scene& scene) const;

 private:
  std::set<std::string> parts_, left_out_;
};

/// E, nu and density of a material in units of the file. @throws InputError  naming `where` for one that no
/// isotropic elastic solid has
void require_elastic(const std::string& where, double young, double poisson, double density);

/// Adds them for one region of a body; of the whole body without its name.
void add_material(Scene& scene, const std::string& region, const SceneUnits& units, double young,
                  double poisson, double density);

}  // namespace hmax
