# Makes results/build_info.cpp, which says what this build was made of, and keeps its git revision fresh.
# Included by results/CMakeLists.txt, which compiles HMAX_BUILD_INFO_SOURCES.
function(hmax_initialisers output entries)
  set(text "")
  foreach(entry IN LISTS entries)
    string(REPLACE "|" "\", \"" entry "${entry}")
    string(APPEND text "\n          {\"${entry}\"},")
  endforeach()
  set(${output} "${text}" PARENT_SCOPE)
endfunction()
hmax_initialisers(HMAX_LIBRARIES_INITIALISER "${HMAX_LIBRARIES}")
hmax_initialisers(HMAX_OPTIONAL_PARTS_INITIALISER "${HMAX_OPTIONAL_PARTS}")

set(HMAX_SANITIZED false)
if(HMAX_SANITIZE)
  set(HMAX_SANITIZED true)
endif()
string(TOUPPER "${CMAKE_BUILD_TYPE}" config)
get_target_property(options hmax_flags INTERFACE_COMPILE_OPTIONS)
string(JOIN " " HMAX_FLAGS ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${config}} ${options})
string(REPLACE "\\" "\\\\" HMAX_FLAGS "${HMAX_FLAGS}")
string(REPLACE "\"" "\\\"" HMAX_FLAGS "${HMAX_FLAGS}")

configure_file("${CMAKE_CURRENT_SOURCE_DIR}/build_info.cpp.in" "${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp" @ONLY)

set(revision_header "${CMAKE_CURRENT_BINARY_DIR}/git_revision.hpp")
add_custom_target(hmax_git_revision
  COMMAND "${CMAKE_COMMAND}" "-DSOURCE_DIR=${PROJECT_SOURCE_DIR}" "-DOUTPUT=${revision_header}" -P "${PROJECT_SOURCE_DIR}/cmake/git_revision.cmake"
  BYPRODUCTS "${revision_header}"
  COMMENT "git revision")
set(HMAX_BUILD_INFO_SOURCES "${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp" "${revision_header}")
