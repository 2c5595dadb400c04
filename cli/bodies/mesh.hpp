/// What the commands of `hmax mesh` share.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "catalogue/models/mesh_choice.hpp"
#include "cli/bodies/body_picture.hpp"
#include "cli/shared/options.hpp"
#include "core/errors.hpp"

namespace hmax {

struct MeshCommand {
  std::string mesh, output, unit, times = "1", slivers = "5", near, merge;
  bool fix = false, renumber = false;
  std::string matrices;  ///< folder
  // Of SOFA's scenes, and of matrices.
  std::string model, material, gravity;
  std::string load, method;  ///< of scenes alone
  std::vector<std::string> set;
  std::vector<std::string> supports;  ///< of `mesh check` too
  std::optional<double> h;
  const CLI::Option* jobs = nullptr;  ///< of matrices
  PictureChoice picture;

  [[nodiscard]] std::optional<double> metres() const {
    return unit.empty() ? std::nullopt : std::optional(unit_in_metres(unit));
  }
};

/// The unit of a mesh that was opened: stated, or that of meshes by name.
std::optional<double> unit_of(const OpenedMesh& opened, const MeshCommand& options);

/// What is to be said of tetrahedra of second order.
std::string second_order_in_words(const MeshFile& file);

void add_mesh_argument(CLI::App& command, MeshCommand& options);
void add_unit(CLI::App& command, MeshCommand& options);

/// make, refine and convert
void add_mesh_writers(CLI::App& group, Console& console);

/// Runs a subcommand; what lower floors refuse is bad input.
template <void (*run)(const MeshCommand&, Console&)>
void with_sentences(const MeshCommand& options, Console& console) {
  try {
    run(options, console);
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

}  // namespace hmax
