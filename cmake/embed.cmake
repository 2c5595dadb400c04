# Compiles files into a library, so that they need no path after installation.
#   hmax_embed(SOURCE header.hpp FUNCTION folder/*.ext)
# sets SOURCE to a C++ source that defines  std::span<const EmbeddedText> FUNCTION()  of header.hpp, in the order of the
# names (core/embedded_text.hpp).
function(hmax_embed source header function pattern)
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

std::span<const EmbeddedText> @function@() {
  static constexpr EmbeddedText texts[] = {
@texts@  };
  return texts;
}

}  // namespace hmax
]] @ONLY)
  set(${source} "${output}" PARENT_SCOPE)
endfunction()
