# Build type, language level and the flags that every number of hmax depends on.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, RelWithDebInfo or Debug" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
# The libraries also go into a module of Python. Hidden names are called directly there, as in a program.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

# Below this heap size [kB] g++ collects no garbage, which saves compile time. It changes no code, so no interface has it.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(--param=ggc-min-heapsize=400000)
endif()

# The proofs of tableaux take more steps than clang++ allows by default.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  add_compile_options(-fconstexpr-steps=100000000)
endif()

# Interface targets carried by every library of the house.
add_library(hmax_flags INTERFACE)
# Contraction to fused multiply-add changes the last bits from compiler to compiler: same input, same output bits.
target_compile_options(hmax_flags INTERFACE -ffp-contract=off)
if(HMAX_SANITIZE)
  target_compile_options(hmax_flags INTERFACE -fsanitize=${HMAX_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(hmax_flags INTERFACE -fsanitize=${HMAX_SANITIZE})
  foreach(kind address thread)  # g++ says so itself
    if(HMAX_SANITIZE MATCHES ${kind} AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      string(TOUPPER ${kind} name)
      target_compile_definitions(hmax_flags INTERFACE __SANITIZE_${name}__=1)
    endif()
  endforeach()
endif()
if(HMAX_FUZZ)  # which branches an input takes, and numbers beyond the integers that they become
  target_compile_options(hmax_flags INTERFACE -fsanitize=fuzzer-no-link,float-cast-overflow -fno-sanitize-recover=float-cast-overflow)
  target_link_options(hmax_flags INTERFACE -fsanitize=float-cast-overflow)
endif()

# g++ 12 sees overlapping copies in "literal" + std::string where there are none, hence -Wno-restrict. What a name of a batch
# shadows stands in another source.
add_library(hmax_warnings INTERFACE)
target_compile_options(hmax_warnings INTERFACE -Wall -Wextra -Wpedantic $<$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wshadow>
                                               -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
                                               $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(HMAX_WARNINGS_AS_ERRORS)
  target_compile_options(hmax_warnings INTERFACE -Werror)
endif()
