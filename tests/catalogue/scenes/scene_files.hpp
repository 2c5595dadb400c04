/// Scenes of other programs in a folder of their own, and the bodies that hmax makes of them.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "catalogue/models/problems.hpp"
#include "catalogue/models/tissue_problem.hpp"
#include "catalogue/scenes/scene.hpp"
#include "core/errors.hpp"
#include "problems/tissue/body.hpp"
#include "tests/problems/mesh/files/mesh_goldens.hpp"
#include "tests/results/scratch.hpp"
#include "tests/says.hpp"

namespace hmax {

class SceneFiles : public ::testing::Test {
 protected:
  /// @param name  of the file, with the ending of its format
  /// @param text  of a scene that tests change
  SceneFiles(std::string name, std::string units, std::string text)
      : whole(std::move(text)), name_(std::move(name)), units_(std::move(units)) {}

  [[nodiscard]] std::string changed(const std::string& what, const std::string& by) const {
    return replaced(whole, what, by);
  }

  Scene read(const std::string& text, const std::string& ignored = "") {
    return read_in(units_, text, ignored);
  }
  Scene read_in(const std::string& units, const std::string& text, const std::string& ignored = "") {
    write_text(folder / name_, text);
    return read_scene((folder / name_).string(), units, ignored);
  }
  std::string error(const std::string& text, const std::string& ignored = "") {
    return error_of<InputError>([&] { read(text, ignored); });
  }
  /// In one sentence that says what is `named` and where it stands.
  /// @param place  in the file
  void expect_refused(const std::string& what, const std::string& by, const std::string& named,
                      const std::string& place = "") {
    const std::string told = error(changed(what, by)) + " ";
    EXPECT_TRUE(says(told, named));
    EXPECT_TRUE(says(told, name_ + place));
    EXPECT_EQ(told.find('\n'), std::string::npos) << told;
  }
  std::shared_ptr<const TissueBody> body(const Scene& scene) {
    return make_problem(tissue_id(scene.model, (folder / name_).string(), ""), scene.settings).body;
  }
  /// The value of a parameter; NaN where it is not given.
  static double value(const Scene& scene, const std::string& name) {
    for (const auto& [each, value] : scene.settings.parameters)
      if (each == name) return value;
    return std::numeric_limits<double>::quiet_NaN();
  }
  /// Wherever a file is damaged, it is refused in one sentence or is a scene.
  /// @param damage  of the text at one place, in several ways
  /// @returns how many were refused
  template <class Damage>
  std::size_t refused(const std::string& text, std::size_t stride, const Damage& damage) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < text.size(); i += stride)
      for (const std::string& damaged : damage(i)) {
        const std::string told = error(damaged);
        EXPECT_EQ(told.find('\n'), std::string::npos) << told;
        count += told.empty() ? 0 : 1;
      }
    return count;
  }

  Scratch folder;
  const std::string whole;

 private:
  std::string name_, units_;
};

}  // namespace hmax
