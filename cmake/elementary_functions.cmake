# One set of elementary functions for every program, whatever the processor: that of musl, taken from its static library.
# glibc holds several variants of sin, exp, pow, ... and uses the one that suits the processor; their last bits differ, and with
# them the steps that a controller takes. The x87 instructions behind glibc's powl differ between makers of processors.
#
# hmax_elementary holds those functions alone, in one object, and stands before libm on every command line of the linker.
# Shared libraries, as SUNDIALS, call the functions of the program too.
string(REGEX REPLACE "gnu$" "musl" triplet "${CMAKE_LIBRARY_ARCHITECTURE}")
find_file(HMAX_MUSL libc.a PATHS "/usr/lib/${triplet}" NO_DEFAULT_PATH)
mark_as_advanced(HMAX_MUSL)
set(HMAX_HAVE_MUSL FALSE)
if(HMAX_MUSL AND CMAKE_OBJCOPY)
  set(HMAX_HAVE_MUSL TRUE)
  file(STRINGS "${HMAX_MUSL}" HMAX_MUSL_VERSION REGEX "^[0-9]+\\.[0-9]+\\.[0-9]+$" LIMIT_COUNT 1)
endif()
hmax_optional(musl HMAX_HAVE_MUSL "${HMAX_MUSL_VERSION}" musl-dev "the same last digits on every processor")
if(NOT HMAX_HAVE_MUSL)
  return()
endif()

foreach(name sin cos tan sincos asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 expm1 log log2 log10 log1p pow cbrt
             hypot erf erfc cabs carg cexp clog cpow csqrt csin ccos ctan csinh ccosh ctanh casin cacos catan casinh cacosh catanh)
  list(APPEND names ${name} ${name}f)
endforeach()
list(APPEND names powl)  # the only one in long double that musl computes without x87 functions
list(TRANSFORM names PREPEND "-Wl,--undefined=" OUTPUT_VARIABLE wanted)
list(TRANSFORM names PREPEND "--keep-global-symbol=" OUTPUT_VARIABLE kept)
set(object "${PROJECT_BINARY_DIR}/elementary_functions.o")
add_custom_command(OUTPUT "${object}"
  COMMAND "${CMAKE_CXX_COMPILER}" -r -nostdlib ${wanted} "${HMAX_MUSL}" -o "${object}"
  COMMAND "${CMAKE_OBJCOPY}" ${kept} "${object}"
  DEPENDS "${HMAX_MUSL}"
  COMMENT "elementary functions of musl ${HMAX_MUSL_VERSION}"
  VERBATIM)
set_source_files_properties("${object}" PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
add_library(hmax_elementary STATIC "${object}")
set_target_properties(hmax_elementary PROPERTIES LINKER_LANGUAGE CXX EXPORT_NAME elementary)
target_link_libraries(hmax_flags INTERFACE hmax_elementary)
