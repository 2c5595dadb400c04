# Targets outside the default build, each where its program is found:
#   docs  all pages as a site, BUILD/site/html, by mkdocs
#   api   the headers of the library, BUILD/api/html, by Doxygen
#   As a script: cmake -DSOURCE=... -DSITE=... [-DPROGRAM=hmax] [-DPYTHON=... -DMODULES=...] -P cmake/site.cmake
#   copies the pages, so that links between folders hold, and makes the pages of examples: with PROGRAM an answer of
#   `hmax advise`, with PYTHON the reference of the package in MODULES and, where matplotlib is, a tour of it.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  find_program(HMAX_MKDOCS NAMES mkdocs)
  mark_as_advanced(HMAX_MKDOCS)
  if(HMAX_MKDOCS)
    set(HMAX_SITE_MAKERS "-DPROGRAM=$<TARGET_FILE:hmax>")
    if(TARGET hmax_python)
      list(APPEND HMAX_SITE_MAKERS "-DPYTHON=${Python3_EXECUTABLE}" "-DMODULES=${PROJECT_BINARY_DIR}/python")
    endif()
    add_custom_target(docs
      COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}" "-DSITE=${PROJECT_BINARY_DIR}/site" ${HMAX_SITE_MAKERS} -P "${CMAKE_CURRENT_LIST_FILE}"
      COMMAND "${HMAX_MKDOCS}" build --quiet --strict --clean --config-file "${PROJECT_BINARY_DIR}/site/mkdocs.yml"
      COMMENT "Building ${PROJECT_BINARY_DIR}/site/html/index.html"
      VERBATIM)
    add_dependencies(docs hmax)
    if(TARGET hmax_python)
      add_dependencies(docs hmax_python)
    endif()
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

# Pages of examples. The list of all pages names those that could be made.
set(examples_folder "${SITE}/source/docs/examples")
set(made "")
if(PROGRAM)
  file(MAKE_DIRECTORY "${examples_folder}")
  execute_process(COMMAND "${PROGRAM}" advise --mesh liver --material liver:male_normal --load press --rate 100
                          --methods symplectic_euler,rk4,central_difference,newmark,linearly_implicit_euler --output "${examples_folder}/liver_advice.html"
                  RESULT_VARIABLE status OUTPUT_QUIET)
  if(NOT status MATCHES "^[01]$")  # 1: no method suits on this machine
    message(FATAL_ERROR "hmax advise ended with ${status}")
  endif()
  string(APPEND made "- [An answer of `hmax advise`](examples/liver_advice.html): the liver pressed, at 100 Hz, with the body in three dimensions.\n")
endif()
if(PYTHON)
  # The page of the sources has the signatures only.
  execute_process(COMMAND "${CMAKE_COMMAND}" -E env "PYTHONPATH=${MODULES}" "${PYTHON}" "${SOURCE}/scripts/python-reference"
                  OUTPUT_FILE "${SITE}/source/docs/reference/python.md" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${PYTHON}" -c "import matplotlib" RESULT_VARIABLE lacks_matplotlib OUTPUT_QUIET ERROR_QUIET)
endif()
if(PYTHON AND NOT lacks_matplotlib)
  file(MAKE_DIRECTORY "${examples_folder}")
  execute_process(COMMAND "${CMAKE_COMMAND}" -E env "PYTHONPATH=${MODULES}" "${PYTHON}" "${SOURCE}/scripts/notebook"
                          "${SOURCE}/python/examples/python_tour.py" "${examples_folder}/python_tour.html"
                  COMMAND_ERROR_IS_FATAL ANY)
  string(APPEND made "- [A tour of the Python package](examples/python_tour.html), with its figures.\n")
endif()
if(made)
  file(APPEND "${SITE}/source/docs/README.md" "\n**Examples**: made by the hmax that built this site.\n\n${made}")
endif()
