# Targets outside the default build, each where its program is found:
#   docs  all pages as a site, BUILD/site/html, by mkdocs
#   api   the headers of the library, BUILD/api/html, by Doxygen
#   As a script: cmake -DSOURCE=... -DSITE=... -P cmake/site.cmake   copies the pages, so that links between folders hold.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  find_program(HMAX_MKDOCS NAMES mkdocs)
  mark_as_advanced(HMAX_MKDOCS)
  if(HMAX_MKDOCS)
    add_custom_target(docs
      COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}" "-DSITE=${PROJECT_BINARY_DIR}/site" -P "${CMAKE_CURRENT_LIST_FILE}"
      COMMAND "${HMAX_MKDOCS}" build --quiet --strict --clean --config-file "${PROJECT_BINARY_DIR}/site/mkdocs.yml"
      COMMENT "Building ${PROJECT_BINARY_DIR}/site/html/index.html"
      VERBATIM)
  endif()
  find_program(HMAX_DOXYGEN NAMES doxygen)
  mark_as_advanced(HMAX_DOXYGEN)
  if(HMAX_DOXYGEN)
    set(HMAX_API_FOLDERS "")
    foreach(folder core integrators problems results analysis catalogue limits bench advice studies plots)
      string(APPEND HMAX_API_FOLDERS " \"${PROJECT_SOURCE_DIR}/${folder}\"")
    endforeach()
    configure_file("${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in" "${PROJECT_BINARY_DIR}/Doxyfile" @ONLY)
    add_custom_target(api
      COMMAND "${CMAKE_COMMAND}" -E make_directory "${PROJECT_BINARY_DIR}/api"
      COMMAND "${HMAX_DOXYGEN}" "${PROJECT_BINARY_DIR}/Doxyfile"
      COMMENT "Building ${PROJECT_BINARY_DIR}/api/html/index.html"
      VERBATIM)
  endif()
  return()
endif()

file(REMOVE_RECURSE "${SITE}/source")
file(COPY "${SOURCE}/docs/mkdocs.yml" DESTINATION "${SITE}")
file(GLOB pages RELATIVE "${SOURCE}" "${SOURCE}/*.md" "${SOURCE}/LICENSE" "${SOURCE}/CITATION.cff")
file(GLOB folders RELATIVE "${SOURCE}" "${SOURCE}/[a-z]*")
foreach(folder IN LISTS folders)
  if(IS_DIRECTORY "${SOURCE}/${folder}" AND NOT folder MATCHES "^build")
    file(GLOB_RECURSE found RELATIVE "${SOURCE}" "${SOURCE}/${folder}/*.md")
    list(FILTER found EXCLUDE REGEX "^results/runs/")
    list(APPEND pages ${found})
  endif()
endforeach()
file(COPY "${SOURCE}/docs/images" DESTINATION "${SITE}/source/docs")
file(GLOB examples "${SOURCE}/examples/*.cpp")
file(COPY ${examples} DESTINATION "${SITE}/source/examples")
foreach(page IN LISTS pages)
  file(READ "${SOURCE}/${page}" text)
  # mkdocs takes no name behind the language of a block: it is shown above.
  string(REGEX REPLACE "```toml ([a-z0-9_.]+)\n" "`\\1`:\n\n```toml\n" text "${text}")
  file(WRITE "${SITE}/source/${page}" "${text}")
endforeach()
