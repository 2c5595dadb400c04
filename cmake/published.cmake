# Compiles the CSV files of results/published into hmax::results, so that they need no path after installation.
file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/results/published/*.csv")
list(SORT files)
set(HMAX_PUBLISHED_TABLES "")
foreach(file IN LISTS files)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  get_filename_component(name "${file}" NAME_WE)
  file(READ "${file}" text)
  string(APPEND HMAX_PUBLISHED_TABLES "    {\"${name}\", R\"csv(${text})csv\"},\n")
endforeach()
set(HMAX_PUBLISHED_SOURCES "${CMAKE_CURRENT_BINARY_DIR}/published_texts.cpp")
file(CONFIGURE OUTPUT "${HMAX_PUBLISHED_SOURCES}" CONTENT [[
#include "results/published_texts.hpp"

namespace hmax {

std::span<const PublishedText> published_texts() {
  static constexpr PublishedText texts[] = {
@HMAX_PUBLISHED_TABLES@  };
  return texts;
}

}  // namespace hmax
]] @ONLY)
