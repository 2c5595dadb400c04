# Compiles files into a library, so that they need no path after installation.
#   hmax_embed(SOURCE header.hpp TYPE FUNCTION folder/*.ext)
# sets SOURCE to a C++ source that defines  std::span<const TYPE> FUNCTION()  of header.hpp: pairs of a name without
# extension and a text, in the order of the names.
function(hmax_embed source header type function pattern)
  file(GLOB files CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/${pattern}")
  list(SORT files)
  set(texts "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    get_filename_component(name "${file}" NAME_WE)
    file(READ "${file}" text)
    string(APPEND texts "    {\"${name}\", R\"text(${text})text\"},\n")
  endforeach()
  set(output "${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp")
  file(CONFIGURE OUTPUT "${output}" CONTENT [[
#include "@header@"

namespace hmax {

std::span<const @type@> @function@() {
  static constexpr @type@ texts[] = {
@texts@  };
  return texts;
}

}  // namespace hmax
]] @ONLY)
  set(${source} "${output}" PARENT_SCOPE)
endfunction()
