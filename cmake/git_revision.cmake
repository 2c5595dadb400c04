# Run at build time: writes OUTPUT only when the revision or its cleanness changed, so that one file is recompiled then.
# Outside a git checkout (an unpacked archive, or no git) the revision is "unknown".
find_program(GIT git)
set(revision "unknown")
set(dirty "false")
if(GIT)
  execute_process(COMMAND "${GIT}" --no-optional-locks -C "${SOURCE_DIR}" rev-parse --show-prefix HEAD
                  OUTPUT_VARIABLE answer RESULT_VARIABLE failed ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  # A prefix other than nothing means that the sources lie inside somebody else's checkout.
  if(NOT failed AND answer MATCHES "^\n([0-9a-f]+)$")
    set(revision "${CMAKE_MATCH_1}")
    execute_process(COMMAND "${GIT}" --no-optional-locks -C "${SOURCE_DIR}" status --porcelain --untracked-files=no
                    OUTPUT_VARIABLE changes ERROR_QUIET)
    if(NOT changes STREQUAL "")
      set(dirty "true")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT [[
/// Written by cmake/git_revision.cmake at every build.
#define HMAX_GIT_REVISION "@revision@"
#define HMAX_GIT_DIRTY @dirty@
]])
