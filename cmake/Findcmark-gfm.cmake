# Finds cmark-gfm and its extensions, which come without a configuration for CMake: cmark-gfm_FOUND, cmark-gfm_VERSION,
# cmark-gfm_INCLUDE_DIRS, cmark-gfm_LIBRARIES.
find_path(CMARK_GFM_INCLUDE_DIR cmark-gfm-core-extensions.h)
find_library(CMARK_GFM_LIBRARY cmark-gfm)
find_library(CMARK_GFM_EXTENSIONS_LIBRARY cmark-gfm-extensions)
mark_as_advanced(CMARK_GFM_INCLUDE_DIR CMARK_GFM_LIBRARY CMARK_GFM_EXTENSIONS_LIBRARY)
if(CMARK_GFM_INCLUDE_DIR AND EXISTS "${CMARK_GFM_INCLUDE_DIR}/cmark-gfm_version.h")
  file(STRINGS "${CMARK_GFM_INCLUDE_DIR}/cmark-gfm_version.h" cmark-gfm_VERSION REGEX "define CMARK_GFM_VERSION_STRING ")
  string(REGEX REPLACE ".*\"(.*)\".*" "\\1" cmark-gfm_VERSION "${cmark-gfm_VERSION}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(cmark-gfm VERSION_VAR cmark-gfm_VERSION
  REQUIRED_VARS CMARK_GFM_EXTENSIONS_LIBRARY CMARK_GFM_LIBRARY CMARK_GFM_INCLUDE_DIR)
set(cmark-gfm_INCLUDE_DIRS "${CMARK_GFM_INCLUDE_DIR}")
set(cmark-gfm_LIBRARIES "${CMARK_GFM_EXTENSIONS_LIBRARY}" "${CMARK_GFM_LIBRARY}")
