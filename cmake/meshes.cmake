# Compiles the meshes of problems/meshes into hmax::problems, so that they need no path after installation.
file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/problems/meshes/*.msh")
list(SORT files)
set(HMAX_MESH_TEXTS "")
foreach(file IN LISTS files)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  get_filename_component(name "${file}" NAME_WE)
  file(READ "${file}" text)
  string(APPEND HMAX_MESH_TEXTS "    {\"${name}\", R\"msh(${text})msh\"},\n")
endforeach()
set(HMAX_MESH_SOURCES "${CMAKE_CURRENT_BINARY_DIR}/mesh_texts.cpp")
file(CONFIGURE OUTPUT "${HMAX_MESH_SOURCES}" CONTENT [[
#include "problems/tissue/mesh_names.hpp"

namespace hmax {

std::span<const MeshTextFile> mesh_texts() {
  static constexpr MeshTextFile texts[] = {
@HMAX_MESH_TEXTS@  };
  return texts;
}

}  // namespace hmax
]] @ONLY)
