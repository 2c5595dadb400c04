# hmax_folder(NAME [LINKS target...] [PRIVATE target...] [SOURCES generated_file...]):
# the library hmax::NAME made of the sources of this folder.
# LINKS are what the headers of the folder include, PRIVATE what only its sources include. Headers are a file set with
# the project as base, so that "NAME/file.hpp" is found in the build tree and under include/hmax once installed.
function(hmax_folder name)
  cmake_parse_arguments(FOLDER "" "" "LINKS;PRIVATE;SOURCES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp")
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.hpp")
  # What has a library or a program of its own is no part of this one.
  list(FILTER sources EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/(micro|odeint|sundials)/")
  list(FILTER headers EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/(micro|odeint|sundials)/")
  list(APPEND sources ${FOLDER_SOURCES})
  set(target hmax_${name})
  if(sources)
    add_library(${target} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE ${FOLDER_PRIVATE} $<BUILD_INTERFACE:hmax_warnings>)
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_link_libraries(${target} ${scope} ${FOLDER_LINKS} hmax_flags)
  target_compile_features(${target} ${scope} cxx_std_20)
  target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}" FILES ${headers})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  add_library(hmax::${name} ALIAS ${target})
endfunction()
