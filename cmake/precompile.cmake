# Headers that most sources of a target begin with are parsed once for all of them.
# CMAKE_DISABLE_PRECOMPILE_HEADERS=ON (preset dev) builds without, which shows that every source includes what it uses.

# ccache reads a source with such headers only after this option, and with
# CCACHE_SLOPPINESS=pch_defines,time_macros in the environment.
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES ccache AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  set(HMAX_PRECOMPILE_OPTIONS -fpch-preprocess)
endif()
# g++ no longer takes what was parsed before for headers of the system, and sees overlaps in "literal" + std::string
# where there are none.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
  list(APPEND HMAX_PRECOMPILE_OPTIONS -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()

# hmax_precompile(TARGET header...): call it after the properties of the sources are set. Sources with compile options of
# their own cannot share what was parsed with others, and are left out. hmax_precompile(TARGET REUSE_FROM OTHER) takes what
# was parsed for another target, which needs the same options and definitions.
function(hmax_precompile target)
  if(NOT TARGET ${target})
    return()
  endif()
  if("${ARGV1}" STREQUAL "REUSE_FROM")
    target_precompile_headers(${target} REUSE_FROM ${ARGV2})
  else()
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
  target_compile_options(${target} PRIVATE ${HMAX_PRECOMPILE_OPTIONS})
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_source_file_property(options "${source}" COMPILE_OPTIONS)
    if(options)
      set_source_files_properties("${source}" PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
endfunction()
